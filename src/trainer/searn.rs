//! SEARN (Daumé, Langford & Marcu 2009), as Ross & Bagnell (2010, section 4) set SMILe against it.

use super::{Book, Keeper, Run, Trained, check_rate, check_rounds};
use crate::error::{Error, Result};
use crate::learner::{Learner, Setting};
use crate::policy::Mixture;
use crate::roll::{self, Costing, RollOut};
use crate::seed::Purpose;
use crate::space::{Problem, StateOf, ViewOf};
use crate::worker::all;
use serde::{Deserialize, Serialize};

/// Search and learn: at every state that the current mixture (expert included) reaches, every action is tried and rolled out with
/// that mixture; a classifier learns from these costs and takes over the share `beta` of everything.
///
/// Roll-outs put the system back to where it was: states must be `Clone`.
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
        if self.samples == 0 {
            return Err(Error::argument("samples", 0, "at least 1"));
        }
        self.train_by(problem, learner, &RollOut { samples: self.samples }, run)
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
        check_rate("beta", self.beta)?;
        check_rounds(self.rounds)?;
        let mut book = Book::open(problem, run)?;
        let mut policy = book.resume(Mixture::of_expert())?;
        while let Some(i) = book.next(self.rounds) {
            let seed = run.seed.child(Purpose::Round, i as u64);
            let round = book.bill(roll::costs(problem, &policy, costing, &all(problem), seed));
            let warm = policy.members().last().map(|(_, classifier)| classifier).filter(|_| self.warm);
            let classifier = learner.fit(Setting::of(problem), &round.examples, warm, seed.child(Purpose::Learner, 0));
            policy.blend(self.beta, classifier); // pi^i = (1-beta) pi^{i-1} + beta h_i
            book.round(self.rounds, round.cost, &policy)?;
        }
        Ok(book.close(policy.without_expert()))
    }
}
