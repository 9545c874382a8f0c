//! Predicted ledgers: what each trainer will cost, before it runs.
//!
//! Episodes differ in length. Write L for an episode's length, S for the sum of L over the episodes, p_n for the expert's share after n rounds
//! ((1-alpha)^n or (1-beta)^n), N for the rounds, k for the roll-outs per action, A_t for the number of legal actions at step t.
//!
//! | trainer | labels | expert acts | roll-outs | roll-out acts | steps |
//! |---|---|---|---|---|---|
//! | supervised | S | S | 0 | 0 | S |
//! | forward | S | 0 | 0 | 0 | sum L(L-1)/2 |
//! | SMILe | N S | S (1-p_N)/alpha | 0 | 0 | N S |
//! | SEARN | 0 | S (1-p_N)/beta | N k sum A_t | k (1-p_N)/beta sum A_t (L-t) | N (S + k sum A_t (L-t+1)) |
//! | SEARN, shortcut | N S | S (1-p_N)/beta | 0 | 0 | N S |
//! | DAgger | N S | S | 0 | 0 | N S |
//! | DAgger, online | N S | S times the first block's share of the episodes | 0 | 0 | N S |
//!
//! Steps t count from 1 here. Labels, roll-outs and steps are exact wherever episode lengths and A_t do not depend on what is done; acts are
//! expectations, exact where p is 0 or 1. SEARN's A_t is taken along the expert's own trajectories: exact where all actions are always
//! legal, an estimate where rules such as IOB2's let the number vary.
//!
//! The expert is counted when it is *drawn*, in roll-outs too. Counting every step at which a mixture with an expert in it acts, as Ross & Bagnell
//! (2010) do for SEARN, gives N for (1-p_N)/beta.

use crate::policy::Follow;
use crate::seed::Seed;
use crate::space::{Gather, Problem};
use crate::trainer::{Dagger, Searn, Smile};
use crate::worker::{Ledger, all, sweep};
use serde::Serialize;

/// The sums over a problem's episodes that predictions need, along the expert's own trajectories.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// Episodes.
    pub episodes: f64,
    /// S: the sum of the lengths L.
    pub steps: f64,
    /// The sum of L(L-1)/2.
    pub prefixes: f64,
    /// The sum of the numbers of legal actions over all states: A_t.
    pub choices: f64,
    /// The sum of A_t (L-t): what is still to be done after a choice, for every choice.
    pub remainders: f64,
}

impl Gather for Extent {
    fn absorb(&mut self, later: Self) {
        self.episodes += later.episodes;
        self.steps += later.steps;
        self.prefixes += later.prefixes;
        self.choices += later.choices;
        self.remainders += later.remainders;
    }
}

impl Extent {
    /// Runs the expert once through the problem's episodes; nobody is billed.
    pub fn of<P: Problem>(problem: &P) -> Self {
        let run = |worker: &mut crate::worker::Worker<'_, P>, legal: &mut Vec<f64>, episode, extent: &mut Extent| {
            legal.clear();
            worker.roll_in(&Follow, &mut (), episode, |visit| legal.push(visit.legal().len() as f64));
            let length = legal.len() as f64;
            extent.absorb(Extent {
                episodes: 1.0,
                steps: length,
                prefixes: length * (length - 1.0) / 2.0,
                choices: legal.iter().sum(),
                remainders: legal.iter().rev().enumerate().map(|(rest, n)| rest as f64 * n).sum(),
            });
        };
        sweep(problem, &all(problem), Seed::new(0), run).0
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
    let all = passes * extent.steps;
    Expected { labels: all, expert_acts: acts, queries: all, steps: all, examples: all, ..Expected::default() }
}

/// What [`Supervised`](crate::trainer::Supervised) costs.
pub fn supervised(extent: &Extent) -> Expected {
    labelled(extent, 1.0, extent.steps)
}

/// What [`Forward`](crate::trainer::Forward) costs.
pub fn forward(extent: &Extent) -> Expected {
    Expected { steps: extent.prefixes, ..labelled(extent, 1.0, 0.0) }
}

/// What [`Smile`] costs.
pub fn smile(extent: &Extent, smile: &Smile) -> Expected {
    labelled(extent, smile.rounds as f64, extent.steps * shares(smile.alpha, smile.rounds))
}

/// What [`Searn::train`] costs.
pub fn searn(extent: &Extent, searn: &Searn) -> Expected {
    let (n, k, drawn) = (searn.rounds as f64, searn.samples as f64, shares(searn.beta, searn.rounds));
    let (expert_acts, rollout_acts) = (drawn * extent.steps, drawn * k * extent.remainders);
    let rollouts = n * k * extent.choices;
    Expected {
        labels: 0.0,
        expert_acts,
        rollout_acts,
        queries: expert_acts + rollout_acts,
        rollouts,
        resets: rollouts,
        steps: n * (extent.steps + k * (extent.remainders + extent.choices)),
        examples: n * extent.steps,
    }
}

/// What [`Searn::train_by`] costs with the [`Shortcut`](crate::roll::Shortcut).
pub fn searn_shortcut(extent: &Extent, searn: &Searn) -> Expected {
    labelled(extent, searn.rounds as f64, extent.steps * shares(searn.beta, searn.rounds))
}

/// What [`Dagger::train`] costs.
pub fn dagger(extent: &Extent, dagger: &Dagger) -> Expected {
    labelled(extent, dagger.rounds as f64, extent.steps)
}

/// What [`Dagger::train_online`] costs.
pub fn dagger_online(extent: &Extent, dagger: &Dagger) -> Expected {
    let first = (dagger.block as f64 / extent.episodes).min(1.0);
    labelled(extent, dagger.rounds as f64, extent.steps * first)
}
