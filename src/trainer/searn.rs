//! SEARN (Daumé, Langford & Marcu 2009), as Ross & Bagnell (2010, section 4) set SMILe against it.

use super::{Book, Keeper, Run, Shuffled, Trained, check_rate, check_rounds};
use crate::error::{Error, Result};
use crate::learner::{Learner, Online, Setting};
use crate::policy::Mixture;
use crate::roll::{self, Costing, RollOut};
use crate::seed::Purpose;
use crate::space::{Problem, StateOf, ViewOf};
use crate::worker::all;
use serde::{Deserialize, Serialize};

/// Episodes that are run before an online learner learns from them: enough for all threads, few enough to be forgotten soon.
const PORTION: usize = 256;

/// Search and learn: at every state that the current mixture (expert included) reaches, every action is tried and rolled out with
/// that mixture; a classifier learns from these costs and takes over the share `beta` of everything.
///
/// Roll-outs put the system back to where it was: states must be `Clone`.
///
/// [`Searn::train`] fits each round's classifier to all examples of the round. [`Searn::train_online`] hands them to an online learner as they come, and
/// keeps none of them: less memory and less time, for one pass over the examples.
///
/// ```
/// use rollin::learner::Csoaa;
/// use rollin::tasks::tagging;
/// use rollin::trainer::{Run, Searn};
///
/// let problem = tagging::doc::problem()?;
/// let searn = Searn { beta: 0.5, rounds: 2, ..Searn::default() };
/// let trained = searn.train(&problem, &Csoaa::default(), &Run::new(1))?;
/// assert_eq!(trained.ledger.resets, trained.ledger.rollouts);
/// let weights: Vec<f64> = trained.policy.members().iter().map(|(weight, _)| *weight).collect();
/// assert_eq!(weights, [1.0 / 3.0, 2.0 / 3.0]); // 1/4, 1/2 without the expert's 1/4
/// let online = searn.train_online(&problem, &Csoaa::default(), &Run::new(1))?;
/// assert_eq!(online.ledger.examples, trained.ledger.examples);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Searn {
    /// The mixing rate, in (0, 1].
    pub beta: f64,
    /// Rounds: N.
    pub rounds: usize,
    /// Roll-outs per action: k.
    pub samples: usize,
    /// Whether each classifier starts from the one before.
    pub warm: bool,
}

impl Default for Searn {
    fn default() -> Self {
        Searn { beta: 0.3, rounds: 5, samples: 1, warm: false }
    }
}

impl Searn {
    /// Trains on `problem` with `learner`, rolling out.
    ///
    /// # Errors
    /// When beta is outside (0, 1], there are no rounds or roll-outs, or the problem has no episodes.
    pub fn train<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<ViewOf<P>, Mixture<L::Classifier>>>,
    ) -> Result<Trained<Mixture<L::Classifier>>>
    where
        StateOf<P>: Clone,
    {
        self.train_by(problem, learner, &self.roll_out()?, run)
    }

    /// Trains on `problem`, rolling out, with an online `learner`, who learns from the states of an episode once, not long after they were passed. It goes through
    /// the episodes in a new order each round: on all threads as far as they are run, one after the other as far as they are learned from.
    ///
    /// # Errors
    /// As [`Searn::train`].
    pub fn train_online<P: Problem, L: Online<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<ViewOf<P>, Mixture<L::Classifier>>>,
    ) -> Result<Trained<Mixture<L::Classifier>>>
    where
        StateOf<P>: Clone,
    {
        let costing = self.roll_out()?;
        self.check()?;
        let mut book = Book::open(problem, run)?;
        let setting = Setting::of(problem);
        let mut policy = book.resume(Mixture::of_expert())?;
        let mut episodes = Shuffled::after(book.done(), problem, run.seed);
        while let Some(i) = book.next(self.rounds) {
            let seed = run.seed.child(Purpose::Round, i as u64);
            let mut course = learner.begin(setting, self.start(&policy));
            learner.seed(&mut course, seed.child(Purpose::Learner, 0));
            let mut cost = 0.0;
            for some in episodes.next().collect::<Vec<usize>>().chunks(PORTION) {
                let round = book.bill(roll::costs(problem, &policy, &costing, some, seed));
                learner.study(&mut course, setting, &round.examples);
                cost += round.cost;
            }
            policy.blend(self.beta, learner.finish(course)); // pi^i = (1-beta) pi^{i-1} + beta h_i
            book.round(self.rounds, cost, &policy)?;
        }
        Ok(book.close(policy.without_expert()))
    }

    /// Trains with another way of finding costs, such as [`roll::Shortcut`]. `samples` is not used.
    ///
    /// # Errors
    /// When beta is outside (0, 1], there are no rounds, or the problem has no episodes.
    pub fn train_by<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        costing: &impl Costing<P, Mixture<L::Classifier>>,
        run: &Run<'_, impl Keeper<ViewOf<P>, Mixture<L::Classifier>>>,
    ) -> Result<Trained<Mixture<L::Classifier>>> {
        self.check()?;
        let mut book = Book::open(problem, run)?;
        let mut policy = book.resume(Mixture::of_expert())?;
        while let Some(i) = book.next(self.rounds) {
            let seed = run.seed.child(Purpose::Round, i as u64);
            let round = book.bill(roll::costs(problem, &policy, costing, &all(problem), seed));
            let (warm, seed) = (self.start(&policy), seed.child(Purpose::Learner, 0));
            let classifier = learner.fit(Setting::of(problem), &round.examples, warm, seed);
            policy.blend(self.beta, classifier); // pi^i = (1-beta) pi^{i-1} + beta h_i
            book.round(self.rounds, round.cost, &policy)?;
        }
        Ok(book.close(policy.without_expert()))
    }

    /// What the next classifier starts from.
    fn start<'a, C>(&self, policy: &'a Mixture<C>) -> Option<&'a C> {
        policy.members().last().map(|(_, classifier)| classifier).filter(|_| self.warm)
    }

    fn roll_out(&self) -> Result<RollOut> {
        match self.samples {
            0 => Err(Error::argument("samples", 0, "at least 1")),
            samples => Ok(RollOut { samples }),
        }
    }

    fn check(&self) -> Result<()> {
        check_rate("beta", self.beta)?;
        check_rounds(self.rounds)
    }
}
