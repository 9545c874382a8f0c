//! One visit to one state.

use super::Ledger;
use super::memo::{Arrivals, Billed, Memo, Standing};
use crate::policy::Policy;
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Actions, CostToGo, Expert, Front, Problem, SharedOf, Sight, Space, StateOf, View, ViewOf};

/// Whose bill a visit goes on.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    RollIn,
    RollOut,
}

/// What is written over from visit to visit.
#[derive(Default)]
pub(super) struct Looks<V> {
    /// What can be seen of the state at hand.
    view: V,
    /// What is told at a glance of states that roll-outs have come to, [`ABREAST`] of them at a time.
    front: Vec<V>,
}

impl<V: View> Looks<V> {
    /// Asks `drive` what to do in these states, wherever a glance is enough.
    #[inline]
    fn glance<P: Problem<Space: Space<View = V>>>(
        &mut self,
        problem: &P,
        states: &[Standing<StateOf<P>>],
        seed: Seed,
        drive: &mut impl Drive<P>,
        actions: &mut [Option<Action>; ABREAST],
    ) {
        let space = problem.space();
        self.front.resize_with(ABREAST, V::default);
        let mut legal = [Actions::NONE; ABREAST];
        for ((standing, view), legal) in states.iter().zip(&mut self.front).zip(&mut legal) {
            if !space.glance(&standing.state, view) {
                return;
            }
            *legal = space.legal(&standing.state);
        }
        let count = states.len();
        let front = Front::new(space.shared(), seed, &self.front[..count], &legal[..count]);
        drive.act_at_once(&front, &mut actions[..count]);
    }
}

/// How many states of a step are glanced at together.
const ABREAST: usize = 16;

/// Who says what to do in roll-outs.
trait Drive<P: Problem> {
    /// What to do at `visit`.
    fn act(&mut self, visit: &mut Visit<'_, P>) -> Action;

    /// The same for the states of `front`, as [`Policy::act_at_once`] has it.
    fn act_at_once(&mut self, front: &Front<'_, ViewOf<P>>, actions: &mut [Option<Action>]);

    /// Whether it is the expert who does, as [`Policy::leaves_to_expert`] has it.
    fn leaves_to_expert(&mut self, step: Seed) -> bool;
}

/// A function, who is asked at every visit.
struct Asked<F>(F);

impl<P: Problem, F: FnMut(&mut Visit<'_, P>) -> Action> Drive<P> for Asked<F> {
    #[inline]
    fn act(&mut self, visit: &mut Visit<'_, P>) -> Action {
        self.0(visit)
    }

    #[inline]
    fn act_at_once(&mut self, _: &Front<'_, ViewOf<P>>, _: &mut [Option<Action>]) {}

    #[inline]
    fn leaves_to_expert(&mut self, _: Seed) -> bool {
        false
    }
}

/// A policy and its scratch.
struct By<'a, D, M>(&'a D, &'a mut M);

impl<P: Problem, D: Policy<P>> Drive<P> for By<'_, D, D::Memory> {
    #[inline]
    fn act(&mut self, visit: &mut Visit<'_, P>) -> Action {
        self.0.act(visit, self.1)
    }

    #[inline]
    fn act_at_once(&mut self, front: &Front<'_, ViewOf<P>>, actions: &mut [Option<Action>]) {
        self.0.act_at_once(front, self.1, actions);
    }

    #[inline]
    fn leaves_to_expert(&mut self, step: Seed) -> bool {
        self.0.leaves_to_expert(step, self.1)
    }
}

/// A state during a run. Whatever is asked of the expert or of the space through it is billed.
pub struct Visit<'v, P: Problem> {
    problem: &'v P,
    state: &'v StateOf<P>,
    legal: Actions<'v>,
    ledger: &'v mut Ledger,
    looks: &'v mut Looks<ViewOf<P>>,
    looked: bool,
    kind: Kind,
    t: usize,
    run: Seed,
    /// What the run has cost so far.
    pub(super) spent: f64,
    /// The expert's answer, once it has been consulted.
    answer: Option<Option<Action>>,
    labelled: bool,
}

impl<'v, P: Problem> Visit<'v, P> {
    pub(super) fn new(
        problem: &'v P,
        state: &'v StateOf<P>,
        ledger: &'v mut Ledger,
        looks: &'v mut Looks<ViewOf<P>>,
        kind: Kind,
        t: usize,
        run: Seed,
    ) -> Self {
        let legal = problem.space().legal(state);
        let (looked, spent, answer, labelled) = (false, 0.0, None, false);
        Visit { problem, state, legal, ledger, looks, looked, kind, t, run, spent, answer, labelled }
    }

    /// The step, counted from 0.
    pub fn t(&self) -> usize {
        self.t
    }

    /// The node of the seed tree that belongs to this step of this run.
    pub fn seed(&self) -> Seed {
        self.run.child(Purpose::Step, self.t as u64)
    }

    /// What this run has cost before this step; a roll-out counts from where it began.
    pub fn spent(&self) -> f64 {
        self.spent
    }

    /// The state, for those who draw it; trainers have no business with it.
    pub(crate) fn state(&self) -> &'v StateOf<P> {
        self.state
    }

    /// The legal actions; never none.
    pub fn legal(&self) -> Actions<'v> {
        self.legal
    }

    /// What a policy can see here.
    pub fn sight(&mut self) -> Sight<'_, ViewOf<P>> {
        let space = self.problem.space();
        if !self.looked {
            space.look(self.state, &mut self.looks.view);
            self.looked = true;
        }
        Sight { shared: space.shared(), view: &self.looks.view, legal: self.legal }
    }

    /// The little of it that is told [at a glance](Space::glance), where something is and nobody has looked yet.
    pub(crate) fn glance(&mut self) -> Option<Sight<'_, ViewOf<P>>> {
        let space = self.problem.space();
        let told = !self.looked && space.glance(self.state, &mut self.looks.view);
        told.then(|| Sight { shared: space.shared(), view: &self.looks.view, legal: self.legal })
    }

    /// What the space's views share.
    pub fn shared(&self) -> &'v SharedOf<P> {
        self.problem.space().shared()
    }

    /// Asks the expert what it would do here. Billed as one label, however often it is called. `None` from a silent expert.
    pub fn label(&mut self) -> Option<Action> {
        let answer = self.consult();
        if answer.is_some() && !std::mem::replace(&mut self.labelled, true) {
            self.ledger.labels += 1;
        }
        answer
    }

    /// Lets the expert drive for this step. Billed as an act of the expert. A silent expert takes the lowest legal action.
    pub fn expert(&mut self) -> Action {
        let answer = self.consult();
        if answer.is_some() {
            match self.kind {
                Kind::RollIn => self.ledger.expert_acts += 1,
                Kind::RollOut => self.ledger.rollout_acts += 1,
            }
        }
        answer.unwrap_or_else(|| self.legal().nth(0))
    }

    fn consult(&mut self) -> Option<Action> {
        if self.answer.is_none() {
            let seed = self.seed().child(Purpose::Expert, 0);
            let answer = self.problem.expert().answer(self.problem.space(), self.state, seed);
            debug_assert!(answer.is_none_or(|a| self.legal().contains(a)), "the expert's answer is not legal");
            self.ledger.queries += u64::from(answer.is_some());
            self.answer = Some(answer);
        }
        self.answer.flatten()
    }

    /// The expert's own cost-to-go after each legal action in order, where it is known. Billed as one label: the expert is
    /// consulted about this state, and nothing is rolled out.
    pub fn costs_to_go(&mut self, costs: &mut Vec<f64>)
    where
        P::Expert: CostToGo<P::Space>,
    {
        if self.label().is_some() {
            self.problem.expert().costs(self.problem.space(), self.state, costs);
        } else {
            costs.clear();
            costs.resize(self.legal().len(), 0.0);
        }
    }

    /// The same, where the [expert foresees](Expert::foresee) it, billed as one [roll-out](Visit::roll_out) for each legal action in which
    /// the expert acts. Returns whether it does; if not, nothing is billed.
    pub fn foresee(&mut self, costs: &mut Vec<f64>) -> bool {
        let Some(steps) = self.problem.expert().foresee(self.problem.space(), self.state, costs) else { return false };
        let runs = costs.len() as u64;
        let acts = steps - runs;
        self.ledger.rollouts += runs;
        self.ledger.resets += runs;
        self.ledger.steps += steps;
        self.ledger.rollout_acts += acts;
        self.ledger.queries += acts;
        true
    }

    /// Hands what can be seen here to `keep`, which makes an example of it. Billed as one example.
    pub fn record<T>(&mut self, keep: impl FnOnce(&Sight<'_, ViewOf<P>>) -> T) -> T {
        self.ledger.examples += 1;
        keep(&self.sight())
    }

    /// Puts the system back to this state, takes `action` and lets `drive` say what to do to the end. Returns the total cost from
    /// here, added up from the end. Billed as a reset and a roll-out.
    ///
    /// Step t of the roll-out draws its randomness from `run` and t alone, so actions that are compared share it, and so
    /// do roll-outs from different states of one episode that are given the same `run`.
    pub fn roll_out(&mut self, action: Action, run: Seed, mut drive: impl FnMut(&mut Visit<'_, P>) -> Action) -> f64
    where
        StateOf<P>: Clone,
    {
        let space = self.problem.space();
        self.ledger.rollouts += 1;
        self.ledger.resets += 1;
        // The view of the state at hand is overwritten: the next look at it writes it again.
        self.looked = false;
        let mut state = self.state.clone();
        let (mut action, mut spent, mut costs) = (action, 0.0, Vec::new());
        for t in self.t + 1.. {
            self.ledger.steps += 1;
            let cost = space.step(&mut state, action, run.child(Purpose::Step, t as u64 - 1));
            spent += cost;
            costs.push(cost);
            let mut visit = Visit::new(self.problem, &state, self.ledger, self.looks, Kind::RollOut, t, run);
            visit.spent = spent;
            if visit.legal().is_empty() {
                break;
            }
            action = drive(&mut visit);
        }
        costs.into_iter().rev().fold(0.0, |rest, cost| rest + cost)
    }

    /// [Rolls out](Visit::roll_out) every legal action and returns what each costs, in order: costs and bill are the same to the bit, but what is known about
    /// a state is not found out again. All go on step by step, side by side, and those that come to the same state go on as one.
    ///
    /// The `memo` serves roll-outs from all states of an episode that are given the same `run`, as long as the same policy drives.
    pub fn roll_outs<'m>(
        &mut self,
        run: Seed,
        memo: &'m mut Memo<StateOf<P>>,
        drive: impl FnMut(&mut Visit<'_, P>) -> Action,
    ) -> &'m [f64]
    where
        StateOf<P>: Clone,
    {
        self.roll_all_out(run, memo, Asked(drive))
    }

    /// The same where `policy` drives, whose scratch is `memory`: what is plain at a glance is decided for all states of a step together.
    pub fn roll_outs_by<'m, D: Policy<P>>(
        &mut self,
        run: Seed,
        memo: &'m mut Memo<StateOf<P>>,
        policy: &D,
        memory: &mut D::Memory,
    ) -> &'m [f64]
    where
        StateOf<P>: Clone,
    {
        self.roll_all_out(run, memo, By(policy, memory))
    }

    fn roll_all_out<'m>(&mut self, run: Seed, memo: &'m mut Memo<StateOf<P>>, drive: impl Drive<P>) -> &'m [f64]
    where
        StateOf<P>: Clone,
    {
        memo.belong_to(run);
        self.looked = false;
        let mark = memo.mark();
        match self.problem.space().is_trellis() {
            true => self.pass::<true>(run, memo, drive),
            false => self.pass::<false>(run, memo, drive),
        }
        memo.settle(mark);
        *self.ledger += memo.sum_up();
        let tried = memo.tried.len() as u64;
        self.ledger.rollouts += tried;
        self.ledger.resets += tried;
        self.ledger.steps += tried;
        memo.trim(mark);
        &memo.costs
    }

    /// Takes every legal action and goes on from all states that are new, step by step, until none is.
    fn pass<const TRELLIS: bool>(&mut self, run: Seed, memo: &mut Memo<StateOf<P>>, mut drive: impl Drive<P>)
    where
        StateOf<P>: Clone,
    {
        let (problem, space) = (self.problem, self.problem.space());
        let (mut front, mut tried) = (std::mem::take(&mut memo.front), std::mem::take(&mut memo.tried));
        let (mut t, seed) = (self.t + 1, run.child(Purpose::Step, self.t as u64));
        let arrive = |arrivals: &mut Arrivals<'_>, state: &StateOf<P>, action, cost| match TRELLIS {
            true => (arrivals.lead_to(action, cost), true),
            false => arrivals.come_to(space.signature(state)),
        };
        let mut arrivals = memo.arrivals(t);
        tried.clear();
        for action in self.legal.iter() {
            if TRELLIS && let Some(known) = arrivals.led_to(action) {
                tried.push(known);
                continue;
            }
            let mut state = self.state.clone();
            let cost = space.step(&mut state, action, seed);
            let (number, new) = arrive(&mut arrivals, &state, action, cost);
            // All states of a trellis' step are over or none is.
            if new && (TRELLIS && !front.is_empty() || !space.legal(&state).is_empty()) {
                front.push(Standing { state, number, spent: cost });
            }
            tried.push((cost, number));
        }
        while !front.is_empty() {
            let seed = run.child(Purpose::Step, t as u64);
            let (experts, answers) = (drive.leaves_to_expert(seed), seed.child(Purpose::Expert, 0));
            let (mut arrivals, mut going) = (memo.arrivals(t + 1), 0);
            for start in (0..front.len()).step_by(ABREAST) {
                let abreast = start..front.len().min(start + ABREAST);
                let mut actions = [None; ABREAST];
                if !experts {
                    self.looks.glance(problem, &front[abreast.clone()], seed, &mut drive, &mut actions);
                }
                for i in abreast {
                    let Standing { state, number, spent } = &mut front[i];
                    let (action, billed) = match actions[i - start] {
                        Some(action) => (action, Billed::Nothing),
                        None => {
                            let answer = experts.then(|| problem.expert().answer(space, state, answers)).flatten();
                            answer.map(|action| (action, Billed::Act)).unwrap_or_else(|| {
                                let mut bill = Ledger::default();
                                let looks = &mut *self.looks;
                                let mut visit = Visit::new(problem, state, &mut bill, looks, Kind::RollOut, t, run);
                                visit.spent = *spent;
                                (drive.act(&mut visit), Billed::More(bill))
                            })
                        }
                    };
                    if TRELLIS && let Some((cost, next)) = arrivals.led_to(action) {
                        arrivals.go_on(*number, cost, next, billed);
                        continue;
                    }
                    let cost = space.step(state, action, seed);
                    let (next, new) = arrive(&mut arrivals, state, action, cost);
                    arrivals.go_on(*number, cost, next, billed);
                    (*number, *spent) = (next, *spent + cost);
                    if new && !space.legal(state).is_empty() {
                        front.swap(going, i);
                        going += 1;
                    }
                }
            }
            front.truncate(going);
            t += 1;
        }
        (memo.front, memo.tried) = (front, tried);
    }
}
