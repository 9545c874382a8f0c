//! The supervised approach to imitation (Ross & Bagnell 2010, section 2.1).

use super::{Book, Run, Trained};
use crate::error::Result;
use crate::learner::{Learner, Setting};
use crate::policy::{Follow, Greedy};
use crate::roll;
use crate::seed::Purpose;
use crate::space::{Problem, ViewOf};
use crate::worker::all;
use serde::{Deserialize, Serialize};

/// Learns to replicate the expert on the states that the *expert* reaches. Its regret can grow with the square of the horizon (Theorem
/// 2.1): after a mistake it is in states that it never saw.
///
/// ```
/// use rollin::learner::Perceptron;
/// use rollin::space::{Imitation, doc::{Follow, RealWorld}};
/// use rollin::trainer::{Run, Supervised};
///
/// let problem = Imitation { space: RealWorld, expert: Follow, episodes: 20 };
/// let trained = Supervised::default().train(&problem, &Perceptron::default(), &Run::new(1))?;
/// assert_eq!(trained.ledger.labels, 200); // 20 episodes of 10 steps
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Supervised {}

impl Supervised {
    /// Trains on `problem` with `learner`.
    ///
    /// # Errors
    /// When the problem has no episodes.
    pub fn train<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_>,
    ) -> Result<Trained<Greedy<L::Classifier>>> {
        let mut book = Book::open(problem, run)?;
        let seed = run.seed.child(Purpose::Round, 1);
        let round = book.bill(roll::labels(problem, &Follow, &all(problem), seed));
        let classifier = learner.fit(Setting::of(problem), &round.examples, None, seed.child(Purpose::Learner, 0));
        book.round(1, round.cost);
        Ok(book.close(Greedy(classifier)))
    }
}
