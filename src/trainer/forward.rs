//! Forward training (Ross & Bagnell 2010, section 3, Algorithm 3.1).

use super::{Book, Keeper, Run, Trained};
use crate::error::{Error, Result};
use crate::learner::{Learner, Setting};
use crate::policy::Ladder;
use crate::roll;
use crate::seed::Purpose;
use crate::space::{Problem, Space, ViewOf};
use crate::worker::all;
use serde::{Deserialize, Serialize};

/// Trains one classifier per step, in order, each on the states that those before it reach.
///
/// Where episodes differ in length, round i uses those that reach step i, and training ends with the longest episode, or after
/// [`Forward::longest`] steps; a longer episode is finished by the last classifier. A run is stopped once its label is had: the steps after it, which the paper's listing
/// lets the expert drive, bring nothing. So there are as many labels as steps, and L(L-1)/2 steps for an episode of length L (up to the longest), where
/// [`Space::horizon`] tells L; where it does not, an episode is run again though it has ended.
///
/// ```
/// use rollin::learner::Perceptron;
/// use rollin::space::{Imitation, doc::{Follow, RealWorld}};
/// use rollin::trainer::{Forward, Run};
///
/// let problem = Imitation { space: RealWorld, expert: Follow, episodes: 20 };
/// let trained = Forward::default().train(&problem, &Perceptron::default(), &Run::new(1))?;
/// assert_eq!(trained.policy.steps().len(), 10);
/// assert_eq!((trained.ledger.labels, trained.ledger.steps), (200, 20 * 45));
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Forward {
    /// Whether each step's classifier starts from that of the step before.
    pub warm: bool,
    /// Steps that get a classifier of their own; those after are the last one's.
    pub longest: usize,
}

impl Default for Forward {
    fn default() -> Self {
        Forward { warm: false, longest: 256 }
    }
}

impl Forward {
    /// Trains on `problem` with `learner`.
    ///
    /// # Errors
    /// When no step is to get a classifier or the problem has no episodes.
    pub fn train<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<ViewOf<P>, Ladder<L::Classifier>>>,
    ) -> Result<Trained<Ladder<L::Classifier>>> {
        if self.longest == 0 {
            return Err(Error::argument("longest", 0, "at least 1"));
        }
        let mut book = Book::open(problem, run)?;
        let mut policy = book.resume(Ladder::new())?;
        let mut episodes = all(problem);
        let known: Option<Vec<usize>> = episodes.iter().map(|index| problem.space().horizon(*index)).collect();
        let rounds =
            known.and_then(|lengths| lengths.into_iter().max()).map_or(self.longest, |most| most.min(self.longest));
        while let Some(round) = book.next(rounds) {
            let i = round - 1;
            episodes.retain(|index| problem.space().horizon(*index).is_none_or(|length| length > i));
            let seed = run.seed.child(Purpose::Round, round as u64);
            let data = book.bill(roll::labels_at(problem, &policy, i, &episodes, seed));
            if data.is_empty() {
                break;
            }
            let warm = policy.steps().last().filter(|_| self.warm);
            let classifier = learner.fit(Setting::of(problem), &data, warm, seed.child(Purpose::Learner, 0));
            policy.push(classifier);
            let longest = episodes.iter().filter_map(|index| problem.space().horizon(*index)).max();
            book.round(longest.unwrap_or(round).min(self.longest), f64::NAN, &policy)?;
        }
        Ok(book.close(policy.without_expert()))
    }
}
