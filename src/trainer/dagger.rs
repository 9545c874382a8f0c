//! DAgger (Ross, Gordon & Bagnell 2011).

use super::{Book, Run, Trained, check_rounds};
use crate::error::{Error, Result};
use crate::learner::{Examples, Learner, Online, Setting};
use crate::policy::{Follow, Greedy};
use crate::roll;
use crate::seed::Purpose;
use crate::space::{Gather, Problem, ViewOf};
use crate::worker::all;
use serde::{Deserialize, Serialize};

/// Dataset aggregation: the learner drives, the expert labels every state it reaches, and the learner learns from all labels so far. In the
/// first iteration the expert drives (beta_i = I(i = 1)).
///
/// [`Dagger::train`] fits anew on the whole aggregate after each round. [`Dagger::train_online`] keeps one online learner going, whose
/// iterations are blocks of episodes: the same guarantee, which asks only for a no-regret learner, at one pass's cost a round.
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
    /// Online: episodes per iteration.
    pub block: usize,
}

impl Default for Dagger {
    fn default() -> Self {
        Dagger { rounds: 5, warm: false, block: 64 }
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

    /// Trains on `problem` with an online `learner` that goes on learning from block to block; the expert drives in the first block.
    ///
    /// # Errors
    /// When there are no rounds, blocks are empty or the problem has no episodes.
    pub fn train_online<P: Problem, L: Online<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_>,
    ) -> Result<Trained<Greedy<L::Classifier>>> {
        check_rounds(self.rounds)?;
        if self.block == 0 {
            return Err(Error::argument("block", 0, "at least 1"));
        }
        let mut book = Book::open(problem, run)?;
        let setting = Setting::of(problem);
        let mut course = learner.begin(setting, None);
        let mut episodes = all(problem);
        for i in 1..=self.rounds {
            let seed = run.seed.child(Purpose::Round, i as u64);
            rand::seq::SliceRandom::shuffle(&mut episodes[..], &mut seed.child(Purpose::Learner, 0).rng());
            let mut cost = 0.0;
            for (block, chunk) in episodes.chunks(self.block).enumerate() {
                let round = book.bill(if i == 1 && block == 0 {
                    roll::labels(problem, &Follow, chunk, seed)
                } else {
                    roll::labels(problem, &Greedy(&course), chunk, seed)
                });
                cost += round.cost;
                learner.study(&mut course, setting, &round.examples, 0..round.examples.len());
            }
            book.round(self.rounds, cost);
        }
        Ok(book.close(Greedy(learner.finish(course))))
    }
}
