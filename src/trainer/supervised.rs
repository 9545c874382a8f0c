//! The supervised approach to imitation (Ross & Bagnell 2010, section 2.1).

use super::{Aggregate, Book, Keeper, Run, Trained, check_rounds};
use crate::error::Result;
use crate::learner::{Learner, Setting};
use crate::policy::{Follow, Greedy};
use crate::roll;
use crate::seed::Purpose;
use crate::space::{Gather, Problem, ViewOf};
use crate::worker::all;
use serde::{Deserialize, Serialize};

/// Learns to replicate the expert on the states that the *expert* reaches. Its regret can grow with the square of the horizon (Theorem
/// 2.1): after a mistake it is in states that it never saw. Further rounds only bring more of the same: after each, it learns anew from all data so
/// far, so that it can be set against trainers of as many rounds at equal data.
///
/// ```
/// use rollin::learner::Perceptron;
/// use rollin::space::{Imitation, doc::{Follow, RealWorld}};
/// use rollin::trainer::{Run, Supervised};
///
/// let problem = Imitation { space: RealWorld, expert: Follow, episodes: 20 };
/// let trained = Supervised::default().train(&problem, &Perceptron::default(), &Run::new(1))?;
/// assert_eq!(trained.ledger.labels, 200); // 20 episodes of 10 steps
/// let trained = Supervised { rounds: 3 }.train(&problem, &Perceptron::default(), &Run::new(1))?;
/// assert_eq!(trained.ledger.labels, 600);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Supervised {
    /// Rounds in which data are collected and learned from.
    pub rounds: usize,
}

impl Default for Supervised {
    fn default() -> Self {
        Supervised { rounds: 1 }
    }
}

impl Supervised {
    /// Trains on `problem` with `learner`.
    ///
    /// # Errors
    /// When there are no rounds or the problem has no episodes.
    pub fn train<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<ViewOf<P>, Aggregate<ViewOf<P>, L::Classifier>>>,
    ) -> Result<Trained<Greedy<L::Classifier>>> {
        check_rounds(self.rounds)?;
        let mut book = Book::open(problem, run)?;
        let mut data = book.resume(Aggregate::default())?;
        while let Some(i) = book.next(self.rounds) {
            let seed = run.seed.child(Purpose::Round, i as u64);
            let round = book.bill(roll::labels(problem, &Follow, &all(problem), seed));
            data.examples.absorb(round.examples);
            let seed = seed.child(Purpose::Learner, 0);
            data.learned = Some(learner.fit(Setting::of(problem), &data.examples, None, seed));
            book.round(self.rounds, round.cost, &data)?;
        }
        Ok(book.close(data.finish()?))
    }
}
