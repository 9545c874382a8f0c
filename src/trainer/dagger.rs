//! DAgger (Ross, Gordon & Bagnell 2011).

use super::{Book, Run, Trained, check_rounds};
use crate::error::Result;
use crate::learner::{Examples, Learner, Online, Setting, Target};
use crate::policy::{Follow, Greedy};
use crate::roll;
use crate::seed::Purpose;
use crate::space::{Episode, Gather, Problem, ViewOf};
use crate::worker::{Worker, all};
use rand::seq::SliceRandom;
use serde::{Deserialize, Serialize};

/// Dataset aggregation: the learner drives, the expert labels every state it reaches, and the learner learns from all labels so far. In the
/// first iteration the expert drives (beta_i = I(i = 1)).
///
/// [`Dagger::train`] fits anew on the whole aggregate after each round. [`Dagger::train_online`] keeps one online learner going, which is all that
/// the guarantee asks for if it has no regret, at the cost of one pass a round.
///
/// ```
/// use rollin::learner::Perceptron;
/// use rollin::space::{Imitation, doc::{Follow, RealWorld}};
/// use rollin::trainer::{Dagger, Run};
///
/// let problem = Imitation { space: RealWorld, expert: Follow, episodes: 20 };
/// let dagger = Dagger { rounds: 3, ..Dagger::default() };
/// let trained = dagger.train(&problem, &Perceptron::default(), &Run::new(1))?;
/// assert_eq!((trained.ledger.labels, trained.ledger.expert_acts), (3 * 200, 200));
/// let online = dagger.train_online(&problem, &Perceptron::default(), &Run::new(1))?;
/// assert_eq!(online.ledger.labels, 3 * 200);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Dagger {
    /// Rounds over the episodes.
    pub rounds: usize,
    /// Whether each round's classifier starts from the one before; an online learner always does.
    pub warm: bool,
}

impl Default for Dagger {
    fn default() -> Self {
        Dagger { rounds: 5, warm: false }
    }
}

impl Dagger {
    /// Trains on `problem` with `learner`, on the aggregate of all rounds so far.
    ///
    /// # Errors
    /// When there are no rounds or the problem has no episodes.
    pub fn train<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_>,
    ) -> Result<Trained<Greedy<L::Classifier>>> {
        check_rounds(self.rounds)?;
        let mut book = Book::open(problem, run)?;
        let (setting, episodes) = (Setting::of(problem), all(problem));
        let seed = |i: usize| run.seed.child(Purpose::Round, i as u64);
        let mut aggregate = Examples::default();
        let mut warm: Option<L::Classifier> = None;
        let mut round = book.bill(roll::labels(problem, &Follow, &episodes, seed(1)));
        let mut i = 1;
        loop {
            aggregate.absorb(round.examples); // D <- D u D_i
            let learner_seed = seed(i).child(Purpose::Learner, 0);
            let learned = Greedy(learner.fit(setting, &aggregate, warm.as_ref().filter(|_| self.warm), learner_seed));
            book.round(self.rounds, round.cost);
            if i >= self.rounds {
                return Ok(book.close(learned));
            }
            round = book.bill(roll::labels(problem, &learned, &episodes, seed(i + 1)));
            warm = Some(learned.0);
            i += 1;
        }
    }

    /// Trains on `problem` with an online `learner`, which learns at every state it reaches as soon as it has acted there. It drives from the
    /// first step on, through the episodes in a new order each round, one after the other: more threads do not help.
    ///
    /// # Errors
    /// When there are no rounds or the problem has no episodes.
    pub fn train_online<P: Problem, L: Online<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_>,
    ) -> Result<Trained<Greedy<L::Classifier>>> {
        check_rounds(self.rounds)?;
        let mut book = Book::open(problem, run)?;
        let mut course = learner.begin(Setting::of(problem), None);
        let mut episodes = all(problem);
        for i in 1..=self.rounds {
            let seed = run.seed.child(Purpose::Round, i as u64);
            episodes.shuffle(&mut seed.child(Purpose::Learner, 0).rng());
            let mut worker = Worker::new(problem);
            let mut cost = 0.0;
            for &index in &episodes {
                let episode = Episode { index, seed: seed.child(Purpose::Episode, index as u64) };
                cost += worker.episode(episode, |visit| {
                    Some(match visit.label() {
                        Some(label) => {
                            visit.record(|sight| learner.learn(&mut course, sight, Some(Target::Label(label))))
                        }
                        None => learner.learn(&mut course, &visit.sight(), None),
                    })
                });
            }
            book.bill(((), worker.ledger()));
            book.round(self.rounds, cost);
        }
        Ok(book.close(Greedy(learner.finish(course))))
    }
}
