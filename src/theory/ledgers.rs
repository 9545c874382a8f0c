//! Predicted ledgers: what each trainer will cost, before it runs.
//!
//! Episodes differ in length. Write L for an episode's length, S for the sum of L over the episodes, p_n for the
//! expert's share after n rounds ((1-alpha)^n or (1-beta)^n), N for the rounds, k for the roll-outs per action, A_t
//! for the number of legal actions at step t.
//!
//! | trainer | labels | expert acts | roll-outs | roll-out acts | steps |
//! |---|---|---|---|---|---|
//! | supervised, N rounds | N S | N S | 0 | 0 | N S |
//! | forward | S | 0 | 0 | 0 | sum L(L-1)/2 |
//! | SMILe | N S | S (1-p_N)/alpha | 0 | 0 | N S |
//! | SMILe reusing by 4.2, R1 | S + sum over n of sum L (1-(1-alpha)^L) | see below | 0 | 0 | as labels |
//! | SMILe reusing by 4.3, R2, ageing | S + sum over n of sum L (1-(1-alpha p_{n-1})^L) | see below | 0 | 0 | as labels |
//! | SEARN | 0 | S (1-p_N)/beta | N k sum A_t | k (1-p_N)/beta sum A_t (L-t) | N (S + k sum A_t (L-t+1)) |
//! | SEARN, shortcut | N S | S (1-p_N)/beta | 0 | 0 | N S |
//! | CPI, a fixed rate | 0 | (1-p_N)/rate sum (L-1)/2 | N k sum C | k (1-p_N)/rate sum R | N (sum (L-1)/2 + k sum (C+R)) |
//! | DAgger | N S | S sum beta_i | 0 | 0 | N S |
//! | DAgger, online, without a schedule | N S | 0 | 0 | 0 | N S |
//! | AggreVaTe, one deviation | 0 | (N + sum beta_i) sum (L-1)/2 | 0 | 0 | N S |
//! | AggreVaTe, shortcut | N S | S sum beta_i | 0 | 0 | N S |
//! | AggreVaTe, roll-outs | 0 | S sum beta_i | N sum A_t | N sum A_t (L-t) | N (S + sum A_t (L-t+1)) |
//! | LOLS | 0 | S | N sum A_t | (1 + beta (N-1)) sum A_t (L-t) | N (S + sum A_t (L-t+1)) |
//! | LOLS, online | 0 | 0 | N sum A_t | N beta sum A_t (L-t) | N (S + sum A_t (L-t+1)) |
//! | stacking, both stages supervised | 2 S | 2 S | 0 | 0 | 3 S |
//! | early update, a beam of w | S | S | 0 | 0 | at most S + N (w+1) S |
//!
//! beta_i is the expert's share in round i of DAgger and AggreVaTe, and beta the probability that LOLS rolls out with the expert. C and R are the means of
//! A_t and of A_t (L-t) over the steps of an episode: CPI rolls out from one step of each, drawn with equal chances. What CPI runs to measure an
//! advantage comes on top, and it may end early. Early update stops a search when the right path is lost; the resets are at most N w S.
//!
//! Forward training counts an episode's steps up to [`Forward::longest`] only.
//!
//! Sums over n are over the rounds but the first, n = 1, ..., N-1. With q for (1-alpha) or (1-alpha p_{n-1}), the expert acts S + sum over n of
//! p_n sum L (1-q^(L-1)) times in all, where an episode that is kept or run anew in pieces ([`Smile::piece`]) counts as so many episodes; for Algorithm 4.2 as printed the last term is (L-1)(1-q^L). What 4.3 and R2 run when their
//! trajectories run dry comes on top.
//!
//! Steps t count from 1 here. Labels, roll-outs and steps are exact wherever episode lengths and A_t do not depend on
//! what is done; acts are expectations, exact where p is 0 or 1. SEARN's A_t is taken along the expert's own
//! trajectories: exact where all actions are always legal, an estimate where rules such as IOB2's let the number vary.
//!
//! The expert is counted when it is *drawn*, in roll-outs too. Counting every step at which a mixture with an expert
//! in it acts, as Ross & Bagnell (2010) do for SEARN, gives N for (1-p_N)/beta.

use crate::seed::Seed;
use crate::space::{Gather, Problem};
use crate::trainer::{
    Aggrevate, Cpi, Dagger, EarlyUpdate, Forward, Lols, Rate, Reuse, Schedule, Searn, Smile, Supervised,
};
use crate::worker::{Ledger, all, sweep};
use serde::Serialize;
use std::collections::BTreeMap;

/// The sums over a problem's episodes that predictions need, along the expert's own trajectories.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extent {
    /// How many episodes have each length.
    pub lengths: BTreeMap<usize, u64>,
    /// The sum of the numbers of legal actions over all states: A_t.
    pub choices: f64,
    /// The sum of A_t (L-t): what is still to be done after a choice, for every choice.
    pub remainders: f64,
    /// The sum over the episodes of the mean of A_t: C.
    pub mean_choices: f64,
    /// The sum over the episodes of the mean of A_t (L-t): R.
    pub mean_remainders: f64,
}

impl Gather for Extent {
    fn absorb(&mut self, later: Self) {
        for (length, count) in later.lengths {
            *self.lengths.entry(length).or_default() += count;
        }
        self.choices += later.choices;
        self.remainders += later.remainders;
        self.mean_choices += later.mean_choices;
        self.mean_remainders += later.mean_remainders;
    }
}

impl Extent {
    /// Runs the expert once through the problem's episodes; nobody is billed.
    pub fn of<P: Problem>(problem: &P) -> Self {
        let run = |worker: &mut crate::worker::Worker<'_, P>, legal: &mut Vec<f64>, episode, extent: &mut Extent| {
            legal.clear();
            worker.episode(episode, |visit| {
                legal.push(visit.legal().len() as f64);
                Some(visit.expert())
            });
            *extent.lengths.entry(legal.len()).or_default() += 1;
            let choices = legal.iter().sum::<f64>();
            let remainders = legal.iter().rev().enumerate().map(|(rest, n)| rest as f64 * n).sum::<f64>();
            let length = legal.len().max(1) as f64;
            extent.choices += choices;
            extent.remainders += remainders;
            extent.mean_choices += choices / length;
            extent.mean_remainders += remainders / length;
        };
        sweep(problem, &all(problem), Seed::new(0), run).0
    }

    /// The sum of `of(L)` over the episodes.
    pub fn sum(&self, of: impl Fn(f64) -> f64) -> f64 {
        self.lengths.iter().map(|(length, count)| *count as f64 * of(*length as f64)).sum()
    }

    /// S: the sum of the lengths.
    pub fn steps(&self) -> f64 {
        self.sum(|length| length)
    }
}

/// An expected [`Ledger`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Expected {
    /// Expected [`Ledger::labels`].
    pub labels: f64,
    /// Expected [`Ledger::expert_acts`].
    pub expert_acts: f64,
    /// Expected [`Ledger::rollout_acts`].
    pub rollout_acts: f64,
    /// Expected [`Ledger::queries`].
    pub queries: f64,
    /// Expected [`Ledger::rollouts`].
    pub rollouts: f64,
    /// Expected [`Ledger::resets`].
    pub resets: f64,
    /// Expected [`Ledger::steps`].
    pub steps: f64,
    /// Expected [`Ledger::examples`].
    pub examples: f64,
}

impl From<Ledger> for Expected {
    fn from(ledger: Ledger) -> Self {
        Expected {
            labels: ledger.labels as f64,
            expert_acts: ledger.expert_acts as f64,
            rollout_acts: ledger.rollout_acts as f64,
            queries: ledger.queries as f64,
            rollouts: ledger.rollouts as f64,
            resets: ledger.resets as f64,
            steps: ledger.steps as f64,
            examples: ledger.examples as f64,
        }
    }
}

/// The sum of p_0, ..., p_{N-1}: (1-p_N)/rate.
fn shares(rate: f64, rounds: usize) -> f64 {
    (1.0 - (1.0 - rate).powi(rounds as i32)) / rate
}

/// All states of `passes` runs over the problem labelled, the expert driving at `acts` of them.
fn labelled(extent: &Extent, passes: f64, acts: f64) -> Expected {
    let all = passes * extent.steps();
    Expected { labels: all, expert_acts: acts, queries: all, steps: all, examples: all, ..Expected::default() }
}

/// What [`Supervised`] costs.
pub fn supervised(extent: &Extent, supervised: &Supervised) -> Expected {
    let passes = supervised.rounds as f64;
    labelled(extent, passes, passes * extent.steps())
}

/// What [`Forward`] costs.
pub fn forward(extent: &Extent, forward: &Forward) -> Expected {
    let trained = |length: f64| length.min(forward.longest as f64);
    let labels = extent.sum(trained);
    let steps = extent.sum(|l| trained(l) * (trained(l) - 1.0) / 2.0);
    Expected { labels, queries: labels, examples: labels, steps, ..Expected::default() }
}

/// What [`Smile`] costs.
pub fn smile(extent: &Extent, smile: &Smile) -> Expected {
    // In round n: the chance that no step of an episode changes hands is kept(n)^L.
    let kept: fn(f64, f64) -> f64 = match smile.reuse {
        Reuse::None => {
            return labelled(extent, smile.rounds as f64, extent.steps() * shares(smile.alpha, smile.rounds));
        }
        Reuse::Printed42 | Reuse::Coins => |a, _| 1.0 - a,
        Reuse::Printed43 | Reuse::Sites | Reuse::Ageing => |a, before| 1.0 - a * before,
    };
    // The sum over all pieces of all episodes: whole ones, then what is left.
    let piece = smile.piece.map_or(f64::INFINITY, |steps| steps.max(1) as f64);
    let sum = |of: &dyn Fn(f64) -> f64| {
        extent.sum(|l| {
            let whole = (l / piece).floor();
            let (whole, rest) = if whole > 0.0 { (whole * of(piece), l - whole * piece) } else { (0.0, l) };
            whole + if rest > 0.0 { of(rest) } else { 0.0 }
        })
    };
    let (mut labels, mut acts) = (extent.steps(), extent.steps());
    for n in 1..smile.rounds as i32 {
        let (p, before) = ((1.0 - smile.alpha).powi(n), (1.0 - smile.alpha).powi(n - 1));
        let kept = kept(smile.alpha, before);
        labels += sum(&|l| l * (1.0 - kept.powf(l)));
        acts += p * match smile.reuse {
            Reuse::Printed42 => sum(&|l| (l - 1.0) * (1.0 - kept.powf(l))),
            _ => sum(&|l| l * (1.0 - kept.powf(l - 1.0))),
        };
    }
    Expected { labels, expert_acts: acts, queries: labels, steps: labels, examples: labels, ..Expected::default() }
}

/// What [`Searn::train`] and [`Searn::train_online`] cost.
pub fn searn(extent: &Extent, searn: &Searn) -> Expected {
    let (n, k, drawn) = (searn.rounds as f64, searn.samples as f64, shares(searn.beta, searn.rounds));
    let (expert_acts, rollout_acts) = (drawn * extent.steps(), drawn * k * extent.remainders);
    let rollouts = n * k * extent.choices;
    Expected {
        labels: 0.0,
        expert_acts,
        rollout_acts,
        queries: expert_acts + rollout_acts,
        rollouts,
        resets: rollouts,
        steps: n * (extent.steps() + k * (extent.remainders + extent.choices)),
        examples: n * extent.steps(),
    }
}

/// What [`Searn::train_by`] costs with the [`Shortcut`](crate::roll::Shortcut).
pub fn searn_shortcut(extent: &Extent, searn: &Searn) -> Expected {
    labelled(extent, searn.rounds as f64, extent.steps() * shares(searn.beta, searn.rounds))
}

/// What [`Dagger::train`] costs.
pub fn dagger(extent: &Extent, dagger: &Dagger) -> Expected {
    labelled(extent, dagger.rounds as f64, extent.steps() * driven(dagger.schedule.unwrap_or_default(), dagger.rounds))
}

/// What [`Dagger::train_online`] costs.
pub fn dagger_online(extent: &Extent, dagger: &Dagger) -> Expected {
    let driven = dagger.schedule.map_or(0.0, |schedule| driven(schedule, dagger.rounds));
    labelled(extent, dagger.rounds as f64, extent.steps() * driven)
}

/// The sum of beta_1, ..., beta_N.
fn driven(schedule: Schedule, rounds: usize) -> f64 {
    (1..=rounds).map(|i| schedule.share(i)).sum()
}

/// All actions at all steps of `passes` runs over the problem rolled out once, the expert driving at `acts` steps of the roll-ins and in a share
/// `shares / passes` of the roll-outs.
fn rolled_out(extent: &Extent, passes: f64, acts: f64, shares: f64) -> Expected {
    let (rollouts, rollout_acts) = (passes * extent.choices, shares * extent.remainders);
    Expected {
        labels: 0.0,
        expert_acts: acts,
        rollout_acts,
        queries: acts + rollout_acts,
        rollouts,
        resets: rollouts,
        steps: passes * (extent.steps() + extent.remainders + extent.choices),
        examples: passes * extent.steps(),
    }
}

/// What [`Cpi::train`] costs with a fixed rate; with [`Rate::Advantage`], a round of it, whose measure of the advantage comes on top.
pub fn cpi(extent: &Extent, cpi: &Cpi) -> Expected {
    let (n, drawn) = match cpi.rate {
        Rate::Fixed(rate) => (cpi.rounds as f64, shares(rate, cpi.rounds)),
        Rate::Advantage => (1.0, 1.0),
    };
    let (k, before) = (cpi.samples as f64, extent.sum(|l| (l - 1.0) / 2.0));
    let (expert_acts, rollout_acts) = (drawn * before, drawn * k * extent.mean_remainders);
    let rollouts = n * k * extent.mean_choices;
    Expected {
        labels: 0.0,
        expert_acts,
        rollout_acts,
        queries: expert_acts + rollout_acts,
        rollouts,
        resets: rollouts,
        steps: n * (before + k * (extent.mean_remainders + extent.mean_choices)),
        examples: n * extent.sum(|_| 1.0),
    }
}

/// What [`Aggrevate::train`] costs: one deviation an episode.
pub fn aggrevate(extent: &Extent, aggrevate: &Aggrevate) -> Expected {
    let n = aggrevate.rounds as f64;
    let acts = (n + driven(aggrevate.schedule, aggrevate.rounds)) * extent.sum(|l| (l - 1.0) / 2.0);
    let (steps, examples) = (n * extent.steps(), n * extent.sum(|_| 1.0));
    Expected { expert_acts: acts, queries: acts, steps, examples, ..Expected::default() }
}

/// What [`Aggrevate::train_by`] costs with the [`Shortcut`](crate::roll::Shortcut).
pub fn aggrevate_shortcut(extent: &Extent, aggrevate: &Aggrevate) -> Expected {
    labelled(extent, aggrevate.rounds as f64, extent.steps() * driven(aggrevate.schedule, aggrevate.rounds))
}

/// What [`Aggrevate::train_by`] costs with roll-outs of the expert.
pub fn aggrevate_rollouts(extent: &Extent, aggrevate: &Aggrevate) -> Expected {
    let n = aggrevate.rounds as f64;
    rolled_out(extent, n, extent.steps() * driven(aggrevate.schedule, aggrevate.rounds), n)
}

/// What [`Lols::train`] costs.
pub fn lols(extent: &Extent, lols: &Lols) -> Expected {
    let n = lols.rounds as f64;
    rolled_out(extent, n, extent.steps(), 1.0 + lols.beta * (n - 1.0))
}

/// What [`Lols::train_online`] costs.
pub fn lols_online(extent: &Extent, lols: &Lols) -> Expected {
    let n = lols.rounds as f64;
    rolled_out(extent, n, 0.0, lols.beta * n)
}

/// What [`Stacking::train`](crate::trainer::Stacking::train) costs.
pub fn stacking(extent: &Extent) -> Expected {
    let both = labelled(extent, 2.0, 2.0 * extent.steps());
    Expected { steps: both.steps + extent.steps(), ..both }
}

/// What [`EarlyUpdate::train`] costs; steps and resets are upper bounds.
pub fn early_update(extent: &Extent, early: &EarlyUpdate) -> Expected {
    let searched = early.rounds as f64 * extent.steps();
    let width = early.width as f64;
    let once = supervised(extent, &Supervised::default());
    let resets = if early.width > 1 { width * searched } else { 0.0 };
    Expected { steps: once.steps + (width + 1.0) * searched, resets, ..once }
}
