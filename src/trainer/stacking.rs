//! Stacked sequential learning (Cohen & Carvalho 2005, figure 1).

use super::{Book, Keeper, Run, Supervised, Trained};
use crate::error::{Error, Result};
use crate::learner::{Examples, Learner, Setting};
use crate::policy::{Follow, Greedy, Policy};
use crate::roll::{self, Performance};
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Episode, Features, Imitation, Problem, Second, Silent, Space, Stacked};
use crate::worker::{Ledger, all, sweep};
use serde::{Deserialize, Serialize};

/// Learns twice. A first labeller, trained supervised, labels everything, each part of the data by one that was trained on the other parts, so
/// that its mistakes are those that it will make later; what it says of the steps around is then seen by the second stage, which may be
/// trained by any trainer ([`Stacking::train_by`]). To use it both run, the first to the end before the second begins.
///
/// The first labeller has seen no mistake of its own (no roll-ins with what is learned), but the second sees its mistakes, and what comes
/// after a step as well as what came before: forward training's idea in two steps, for data that can be run through twice.
///
/// ```
/// use rollin::learner::Perceptron;
/// use rollin::tasks::tagging;
/// use rollin::trainer::{Run, Stacking};
///
/// let problem = tagging::doc::problem()?;
/// let trained = Stacking { folds: 2, window: 1 }.train(&problem, &Perceptron::default(), &Run::new(1))?;
/// assert_eq!(trained.ledger.labels, 2 * 15); // once for each stage
/// let (done, _) = trained.policy.perform(&problem, rollin::Seed::new(1));
/// assert_eq!(done.actions.len(), 15);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Stacking {
    /// Parts of the data: K. An episode is in the part of its number modulo K.
    pub folds: usize,
    /// How many steps before and after the one at hand the second stage sees labelled.
    pub window: usize,
}

impl Default for Stacking {
    fn default() -> Self {
        Stacking { folds: 5, window: 2 }
    }
}

/// The widest window.
pub(crate) const MOST_WINDOW: usize = 64;

/// Two policies, of which the second sees what the first did. To act it must know the whole episode, so it is no [`Policy`].
#[derive(Clone, Debug)]
pub struct TwoStage<A, B> {
    /// The first.
    pub first: A,
    /// The second, which acts in the [`Stacked`] space.
    pub second: B,
    /// How many steps before and after the one at hand it sees.
    pub window: usize,
}

/// Two classifiers, each on its own.
pub type Stages<C> = TwoStage<Greedy<C>, Greedy<C>>;

/// A problem whose states show what a first labeller said.
pub type StackedProblem<'s, P> = Imitation<Stacked<'s, <P as Problem>::Space>, Second<'s, <P as Problem>::Expert>>;

/// The first labeller, and what was said of each episode's steps by one that had not seen it: what [`Stacking`] knows between its stages. It is what
/// is kept; the second stage is trained from its beginning.
type FirstStage<C> = (C, Vec<Vec<Action>>);

impl Stacking {
    /// Trains both stages on `problem` with `learner`, the second supervised, too.
    ///
    /// # Errors
    /// When there are fewer than two folds, the window is above 64 or the problem has no episodes.
    pub fn train<P: Problem, L: Learner<Features>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<Features, Option<FirstStage<L::Classifier>>>>,
    ) -> Result<Trained<Stages<L::Classifier>>>
    where
        P::Space: Space<View = Features>,
    {
        self.train_by(problem, learner, run, |stacked, run| Supervised::default().train(stacked, learner, run))
    }

    /// Trains the first stage on `problem` with `learner`, and the second by `second`.
    ///
    /// # Errors
    /// When there are fewer than two folds, the window is above 64 or the problem has no episodes, and whatever `second` returns.
    pub fn train_by<P: Problem, L: Learner<Features>, D>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<Features, Option<FirstStage<L::Classifier>>>>,
        second: impl FnOnce(&StackedProblem<'_, P>, &Run<'_>) -> Result<Trained<D>>,
    ) -> Result<Trained<TwoStage<Greedy<L::Classifier>, D>>>
    where
        P::Space: Space<View = Features>,
    {
        if self.folds < 2 {
            return Err(Error::argument("folds", self.folds, "at least 2"));
        }
        if self.window > MOST_WINDOW {
            return Err(Error::argument("window", self.window, format!("at most {MOST_WINDOW}")));
        }
        let mut book = Book::open(problem, run)?;
        // f, and yhat: what was said of each step by those who had not seen it.
        let mut state = book.resume(None)?;
        if book.done() == 0 {
            let (first, cost, bill) = self.first(problem, learner, run.seed.child(Purpose::Round, 1));
            book.bill(((), bill));
            state = Some(first);
            book.round(2, cost, &state)?;
        }
        let (first, said) = state.ok_or_else(|| Error::argument("rounds", 0, "at least 1"))?;
        let space = Stacked::new(problem.space(), self.window, said);
        let stacked = Imitation { space, expert: Second(problem.expert()), episodes: problem.episodes() };
        let later = run.within(run.seed.child(Purpose::Round, 2), ());
        let Trained { policy, ledger, stopped, .. } = second(&stacked, &later)?; // f' = A(S')
        book.bill(((), ledger));
        book.note(2, (f64::NAN, None));
        book.tell();
        let trained = book.close(TwoStage { first: Greedy(first), second: policy, window: self.window });
        Ok(Trained { stopped, ..trained })
    }

    /// The first stage: f, yhat, what the roll-ins cost, and the bill.
    fn first<P: Problem<Space: Space<View = Features>>, L: Learner<Features>>(
        &self,
        problem: &P,
        learner: &L,
        seed: Seed,
    ) -> (FirstStage<L::Classifier>, f64, Ledger) {
        let mut ledger = Ledger::default();
        let mut bill = |of: Ledger| ledger += of;
        let fold = |k: usize| all(problem).into_iter().skip(k).step_by(self.folds).collect::<Vec<_>>();
        let collect = |k: usize| {
            let (round, more) = roll::labels(problem, &Follow, &fold(k), seed);
            bill(more);
            round
        };
        let rounds: Vec<_> = (0..self.folds).map(collect).collect();
        let fit = |parts: &dyn Fn(usize) -> bool, index: u64| {
            let mut examples = Examples::default();
            let kept = rounds.iter().enumerate().filter(|(k, _)| parts(*k));
            kept.for_each(|(_, round)| examples.extend_from(&round.examples));
            learner.fit(Setting::of(problem), &examples, None, seed.child(Purpose::Learner, index))
        };
        // yhat: each part labelled by f_k = A(S - S_k).
        let mut said = vec![Vec::new(); problem.episodes()];
        for k in 0..self.folds {
            let policy = Greedy(fit(&|other| other != k, 1 + k as u64));
            let (labelled, more) = label(problem, &policy, &fold(k), 0, seed.child(Purpose::Evaluation, 0));
            bill(more);
            fold(k).into_iter().zip(labelled).for_each(|(index, actions)| said[index] = actions);
        }
        let first = fit(&|_| true, 0); // f = A(S)
        ((first, said), rounds.iter().map(|round| round.cost).sum(), ledger)
    }
}

impl<A, B> TwoStage<A, B> {
    /// What the second stage does in the problem's episodes.
    pub fn perform<P: Problem>(&self, problem: &P, seed: Seed) -> (Performance, Ledger)
    where
        P::Space: Space<View = Features>,
        A: Policy<P>,
        B: for<'s> Policy<Imitation<Stacked<'s, P::Space>, Silent>>,
    {
        self.perform_from(problem, 0, seed)
    }

    /// The same for a part of a longer series, as [`roll::perform_from`].
    pub fn perform_from<P: Problem>(&self, problem: &P, number: usize, seed: Seed) -> (Performance, Ledger)
    where
        P::Space: Space<View = Features>,
        A: Policy<P>,
        B: for<'s> Policy<Imitation<Stacked<'s, P::Space>, Silent>>,
    {
        let (stacked, bill) = self.stacked(problem, number, seed);
        let stacked = Imitation { space: stacked.space, expert: Silent, episodes: stacked.episodes };
        let (done, second) = roll::perform_from(&stacked, &self.second, number, seed);
        (done, bill + second)
    }

    /// The problem that the second stage has when it performs so: what the first said is in view.
    pub(crate) fn stacked<'p, P: Problem>(
        &self,
        problem: &'p P,
        number: usize,
        seed: Seed,
    ) -> (StackedProblem<'p, P>, Ledger)
    where
        P::Space: Space<View = Features>,
        A: Policy<P>,
    {
        let (said, bill) = label(problem, &self.first, &all(problem), number, seed.child(Purpose::Round, 1));
        let space = Stacked::new(problem.space(), self.window, said);
        (Imitation { space, expert: Second(problem.expert()), episodes: problem.episodes() }, bill)
    }
}

/// What `policy` does in each of these episodes of a series whose first has the number `number`.
fn label<P: Problem, D: Policy<P>>(
    problem: &P,
    policy: &D,
    episodes: &[usize],
    number: usize,
    seed: Seed,
) -> (Vec<Vec<Action>>, Ledger) {
    sweep(problem, episodes, seed, |worker, memory: &mut D::Memory, episode, said: &mut Vec<Vec<Action>>| {
        let seed = seed.child(Purpose::Episode, (number + episode.index) as u64);
        let mut actions = Vec::new();
        worker.episode(Episode { seed, ..episode }, |visit| {
            let action = policy.act(visit, memory);
            actions.push(action);
            Some(action)
        });
        said.push(actions);
    })
}
