//! Roll-in, deviation, roll-out: where training examples come from, and what a finished policy does.

use crate::learner::{Examples, Target};
use crate::policy::{Follow, Policy};
use crate::seed::{Purpose, Seed};
use crate::space::{Action, CostToGo, Episode, Gather, Problem, Space, StateOf, ViewOf};
use crate::worker::{Ledger, Memo, Visit, Worker, all, sweep};
use std::cmp::Ordering;

/// What a round of roll-ins brought.
pub struct Round<P: Problem> {
    /// The examples, in the order of the episodes.
    pub examples: Examples<ViewOf<P>>,
    /// The total cost of the roll-ins.
    pub cost: f64,
}

impl<P: Problem> Default for Round<P> {
    fn default() -> Self {
        Round { examples: Examples::default(), cost: 0.0 }
    }
}

impl<P: Problem> Gather for Round<P> {
    fn absorb(&mut self, later: Self) {
        self.examples.absorb(later.examples);
        self.cost += later.cost;
    }
}

/// Asks the expert what it would do at `visit` and makes an example of the answer; a silent expert makes none.
pub fn label<P: Problem>(visit: &mut Visit<'_, P>, examples: &mut Examples<ViewOf<P>>) {
    if let Some(label) = visit.label() {
        visit.record(|sight| examples.push(sight.view, sight.legal, Target::Label(label)));
    }
}

/// Rolls in with `policy` and labels every state it visits with what the expert would do there: D = {(s, pi*(s))}.
pub fn labels<P: Problem, D: Policy<P>>(problem: &P, policy: &D, episodes: &[usize], seed: Seed) -> (Round<P>, Ledger) {
    sweep(problem, episodes, seed, |worker, memory: &mut D::Memory, episode, round: &mut Round<P>| {
        let examples = &mut round.examples;
        let cost = worker.episode(episode, |visit| {
            label(visit, examples);
            Some(policy.act(visit, memory))
        });
        round.cost += cost;
    })
}

/// Rolls in with `policy` as far as step `t` and labels the state there; episodes that end before bring nothing.
pub fn labels_at<P: Problem, D: Policy<P>>(
    problem: &P,
    policy: &D,
    t: usize,
    episodes: &[usize],
    seed: Seed,
) -> (Examples<ViewOf<P>>, Ledger) {
    sweep(problem, episodes, seed, |worker, memory: &mut D::Memory, episode, examples: &mut Examples<_>| {
        worker.episode(episode, |visit| {
            if visit.t() < t {
                return Some(policy.act(visit, memory));
            }
            label(visit, examples);
            None
        });
    })
}

/// How the cost of each action in a state is found.
pub trait Costing<P: Problem, D: Policy<P>>: Sync {
    /// What is kept from state to state of one thread's episodes under one policy. It must not change the costs.
    type Memo: Default;

    /// Writes the cost from here to the end after each legal action at `visit`, in order. `run` is the node of the episode.
    fn costs(
        &self,
        visit: &mut Visit<'_, P>,
        actor: Actor<'_, D, D::Memory, Self::Memo>,
        run: Seed,
        costs: &mut Vec<f64>,
    );
}

/// A policy and the scratch that a thread keeps for it.
pub struct Actor<'a, D, M, N> {
    /// The policy.
    pub policy: &'a D,
    /// Its scratch.
    pub memory: &'a mut M,
    /// What is remembered of roll-outs with it.
    pub memo: &'a mut N,
}

/// Every action is tried and rolled out to the end with the current policy, `samples` times; the mean cost counts. The roll-outs
/// of one number share their randomness over the actions and over the states of an episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RollOut {
    /// Roll-outs per action: k.
    pub samples: usize,
}

impl<P: Problem, D: Policy<P>> Costing<P, D> for RollOut
where
    StateOf<P>: Clone,
{
    /// One for each sample.
    type Memo = Vec<Memo<StateOf<P>>>;

    fn costs(
        &self,
        visit: &mut Visit<'_, P>,
        actor: Actor<'_, D, D::Memory, Self::Memo>,
        run: Seed,
        costs: &mut Vec<f64>,
    ) {
        let Actor { policy, memory, memo } = actor;
        let samples = self.samples as f64;
        if policy.is_expert() && (0..self.samples).all(|_| visit.foresee(costs)) {
            if self.samples != 1 {
                // All samples are alike, but their mean is that of the sum all the same.
                let mean = |cost: f64| std::iter::repeat_n(cost, self.samples).sum::<f64>() / samples;
                costs.iter_mut().for_each(|cost| *cost = mean(*cost));
            }
            return;
        }
        memo.resize_with(self.samples, Memo::default);
        costs.clear();
        costs.resize(visit.legal().len(), 0.0);
        for (k, memo) in memo.iter_mut().enumerate() {
            let sample = visit.roll_outs_by(run.child(Purpose::RollOut, k as u64), memo, policy, memory);
            costs.iter_mut().zip(sample).for_each(|(total, cost)| *total += cost);
        }
        if self.samples != 1 {
            costs.iter_mut().for_each(|total| *total /= samples);
        }
    }
}

/// Every action is tried once and rolled out to the end by the expert or by the current policy: which of them is drawn at each state, for
/// all actions together, so that those who are compared go on alike. With probability 1 this is the expert's cost-to-go, found by trying.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixed {
    /// The probability that the expert rolls out: beta, in [0, 1].
    pub expert: f64,
}

impl Mixed {
    /// Whether the roll-outs from the state at hand are the expert's.
    pub fn is_experts<P: Problem>(&self, visit: &Visit<'_, P>) -> bool {
        visit.seed().child(Purpose::RollOut, 0).unit() < self.expert
    }
}

impl<P: Problem, D: Policy<P>> Costing<P, D> for Mixed
where
    StateOf<P>: Clone,
{
    /// One for those of the policy, one for those of the expert.
    type Memo = [Memo<StateOf<P>>; 2];

    fn costs(
        &self,
        visit: &mut Visit<'_, P>,
        actor: Actor<'_, D, D::Memory, Self::Memo>,
        run: Seed,
        costs: &mut Vec<f64>,
    ) {
        let Actor { policy, memory, memo } = actor;
        let experts = self.is_experts(visit);
        if experts && visit.foresee(costs) {
            return;
        }
        let run = run.child(Purpose::RollOut, 0);
        let memo = &mut memo[usize::from(experts)];
        costs.clear();
        costs.extend(match experts {
            true => visit.roll_outs_by(run, memo, &Follow, &mut ()),
            false => visit.roll_outs_by(run, memo, policy, memory),
        });
    }
}

/// The optimal-expert shortcut: the expert's own cost-to-go stands in for the current policy's, and nothing is rolled out. Exact
/// while the policy is the expert, an approximation after.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shortcut;

impl<P: Problem, D: Policy<P>> Costing<P, D> for Shortcut
where
    P::Expert: CostToGo<P::Space>,
{
    type Memo = ();

    fn costs(&self, visit: &mut Visit<'_, P>, _: Actor<'_, D, D::Memory, ()>, _: Seed, costs: &mut Vec<f64>) {
        visit.costs_to_go(costs);
    }
}

/// Makes an example of the state at `visit` and the `costs` of its legal actions; `shifted` is scratch.
pub(crate) fn record_costs<P: Problem>(
    visit: &mut Visit<'_, P>,
    costs: &[f64],
    shifted: &mut Vec<f32>,
    examples: &mut Examples<ViewOf<P>>,
) {
    // Only differences between actions matter: the cheapest counts 0, so that long episodes lose no precision.
    let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
    shifted.clear();
    shifted.extend(costs.iter().map(|cost| (cost - least) as f32));
    visit.record(|sight| examples.push(sight.view, sight.legal, Target::Costs(shifted)));
}

/// A step of `episode` as `policy` runs it, each with the same chance. Where the space does not tell how many there are, they are counted in a run of
/// their own, which is the one that follows, to the bit.
fn drawn_step<P: Problem, D: Policy<P>>(
    problem: &P,
    worker: &mut Worker<'_, P>,
    policy: &D,
    memory: &mut D::Memory,
    episode: Episode,
) -> usize {
    let length = problem.space().horizon(episode.index).unwrap_or_else(|| {
        let mut steps = 0;
        worker.episode(episode, |visit| {
            steps += 1;
            Some(policy.act(visit, memory))
        });
        steps
    });
    step_of(episode, length)
}

/// A step of an episode of `length` steps, each with the same chance.
pub(crate) fn step_of(episode: Episode, length: usize) -> usize {
    (episode.seed.child(Purpose::Deviation, 0).unit() * length as f64) as usize
}

/// Rolls in with `policy` to a step drawn at random, finds there what each legal action would cost, and abandons the episode: one
/// example an episode.
pub fn costs_once<P: Problem, D: Policy<P>, C: Costing<P, D>>(
    problem: &P,
    policy: &D,
    costing: &C,
    seed: Seed,
) -> (Examples<ViewOf<P>>, Ledger) {
    type Scratch<M, N> = (M, N, Vec<f64>, Vec<f32>);
    sweep(
        problem,
        &all(problem),
        seed,
        |worker, (memory, memo, costs, shifted): &mut Scratch<D::Memory, C::Memo>, episode, examples| {
            let at = drawn_step(problem, worker, policy, memory, episode);
            worker.episode(episode, |visit| {
                if visit.t() < at {
                    return Some(policy.act(visit, memory));
                }
                costing.costs(visit, Actor { policy, memory, memo }, episode.seed, costs);
                record_costs(visit, costs, shifted, examples);
                None
            });
        },
    )
}

/// Rolls in with `policy`, takes any legal action at one step drawn at random, and leaves the rest to `after`: one example an
/// episode, and nothing is ever put back. The action's cost is what followed, times the number of actions it was drawn from; that of the
/// others, of which nothing is known, is 0. Its expectation is the cost of each action.
pub fn deviations<P: Problem, D: Policy<P>, E: Policy<P>>(
    problem: &P,
    policy: &D,
    after: &E,
    seed: Seed,
) -> (Round<P>, Ledger) {
    type Scratch<M, N> = (M, N, Vec<f32>);
    sweep(
        problem,
        &all(problem),
        seed,
        |worker, (memory, rest, costs): &mut Scratch<D::Memory, E::Memory>, episode, round: &mut Round<P>| {
            let at = drawn_step(problem, worker, policy, memory, episode);
            let mut tried = None;
            let total = worker.episode(episode, |visit| match visit.t().cmp(&at) {
                Ordering::Less => Some(policy.act(visit, memory)),
                Ordering::Greater => Some(after.act(visit, rest)),
                Ordering::Equal => {
                    let legal = visit.legal();
                    let place = (visit.seed().child(Purpose::Deviation, 0).unit() * legal.len() as f64) as usize;
                    costs.clear();
                    costs.resize(legal.len(), 0.0);
                    tried = Some((place, visit.spent()));
                    visit.record(|sight| round.examples.push(sight.view, sight.legal, Target::Costs(costs)));
                    Some(legal.nth(place))
                }
            });
            if let (Some((place, spent)), Some(costs)) = (tried, round.examples.last_costs_mut()) {
                costs[place] = (costs.len() as f64 * (total - spent)) as f32;
            }
            round.cost += total;
        },
    )
}

/// Rolls in with `policy` and finds at every state what each legal action would cost.
pub fn costs<P: Problem, D: Policy<P>, C: Costing<P, D>>(
    problem: &P,
    policy: &D,
    costing: &C,
    episodes: &[usize],
    seed: Seed,
) -> (Round<P>, Ledger) {
    type Scratch<M, N> = (M, N, Vec<f64>, Vec<f32>);
    sweep(
        problem,
        episodes,
        seed,
        |worker, scratch: &mut Scratch<D::Memory, C::Memo>, episode, round: &mut Round<P>| {
            let (memory, memo, costs, shifted) = scratch;
            let examples = &mut round.examples;
            let cost = worker.episode(episode, |visit| {
                costing.costs(visit, Actor { policy, memory, memo }, episode.seed, costs);
                record_costs(visit, costs, shifted, examples);
                Some(policy.act(visit, memory))
            });
            round.cost += cost;
        },
    )
}

/// What a policy did in one run over a problem's episodes.
#[derive(Clone, Debug, Default)]
pub struct Performance {
    /// All actions, episode after episode.
    pub actions: Vec<Action>,
    /// The total cost of each episode.
    pub costs: Vec<f64>,
}

impl Gather for Performance {
    fn absorb(&mut self, later: Self) {
        self.actions.absorb(later.actions);
        self.costs.absorb(later.costs);
    }
}

/// Runs `policy` over the problem's episodes.
pub fn perform<P: Problem, D: Policy<P>>(problem: &P, policy: &D, seed: Seed) -> (Performance, Ledger) {
    perform_from(problem, policy, 0, seed)
}

/// The same for a problem whose episodes are a part of a longer series that starts with its episode number `first`: each draws
/// what it would draw if the whole series were run at once.
pub fn perform_from<P: Problem, D: Policy<P>>(
    problem: &P,
    policy: &D,
    first: usize,
    seed: Seed,
) -> (Performance, Ledger) {
    sweep(problem, &all(problem), seed, |worker, memory: &mut D::Memory, episode, done: &mut Performance| {
        let actions = &mut done.actions;
        let seed = seed.child(Purpose::Episode, (first + episode.index) as u64);
        let episode = Episode { seed, ..episode };
        let cost = worker.episode(episode, |visit| {
            let action = policy.act(visit, memory);
            actions.push(action);
            Some(action)
        });
        done.costs.push(cost);
    })
}
