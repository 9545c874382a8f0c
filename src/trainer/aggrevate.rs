//! AggreVaTe (Ross & Bagnell 2014, Algorithm 1).

use super::{Aggregate, Book, Keeper, Run, Schedule, Trained, check_rounds};
use crate::error::Result;
use crate::learner::{Learner, Setting};
use crate::policy::{Follow, Greedy, Mixture};
use crate::roll::{self, Costing, Round};
use crate::seed::{Purpose, Seed};
use crate::space::{Gather, Problem, ViewOf};
use crate::worker::{Ledger, all};
use serde::{Deserialize, Serialize};

/// Aggregate values to imitate: DAgger with the expert's cost-to-go in place of its label. The learner drives, and learns from all rounds so
/// far how much each action costs when the expert acts ever after, so it imitates most carefully where most is at stake.
///
/// [`Aggrevate::train`] is the published sampling: one step and one action an episode, each uniformly drawn, and the expert drives on from
/// there. Nothing is put back, so states need not be `Clone`; but of one action only the cost is seen, which a learner of costs such as
/// [`Csoaa`](crate::learner::Csoaa) averages out, and a 0-1 learner by its reduction does not.
/// [`Aggrevate::train_by`] knows the cost of every action at every step: where the expert's cost-to-go is known, by
/// [`roll::Shortcut`]; else by roll-outs of the expert, [`roll::Mixed`] with probability 1.
///
/// ```
/// use rollin::learner::Csoaa;
/// use rollin::roll::Shortcut;
/// use rollin::tasks::tagging;
/// use rollin::trainer::{Aggrevate, Run};
///
/// let problem = tagging::doc::problem()?;
/// let trained = Aggrevate { rounds: 3, ..Aggrevate::default() }.train(&problem, &Csoaa::default(), &Run::new(1))?;
/// assert_eq!((trained.ledger.examples, trained.ledger.resets), (3 * 4, 0)); // one for each of four sentences
/// let exact = Aggrevate { rounds: 3, ..Aggrevate::default() }.train_by(&problem, &Csoaa::default(), &Shortcut, &Run::new(1))?;
/// assert_eq!(exact.ledger.labels, exact.ledger.examples);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Aggrevate {
    /// Rounds: N.
    pub rounds: usize,
    /// Whether each round's classifier starts from the one before.
    pub warm: bool,
    /// How much the expert drives in each round's roll-ins.
    pub schedule: Schedule,
}

impl Default for Aggrevate {
    fn default() -> Self {
        Aggrevate { rounds: 5, warm: false, schedule: Schedule::First }
    }
}

impl Aggrevate {
    /// Trains on `problem` with `learner`, from one deviation an episode.
    ///
    /// # Errors
    /// When there are no rounds, the schedule has a number out of its range, or the problem has no episodes.
    pub fn train<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<ViewOf<P>, Aggregate<ViewOf<P>, L::Classifier>>>,
    ) -> Result<Trained<Greedy<L::Classifier>>> {
        // Execute pi_i up to t-1, some action at t, the expert from t+1 to T.
        self.rounds(problem, learner, run, |policy, seed| roll::deviations(problem, policy, &Follow, seed))
    }

    /// Trains on `problem` with `learner`, from the costs of all actions at all steps, found by `costing`.
    ///
    /// # Errors
    /// When there are no rounds, the schedule has a number out of its range, or the problem has no episodes.
    pub fn train_by<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        costing: &impl for<'c> Costing<P, Mixture<&'c L::Classifier>>,
        run: &Run<'_, impl Keeper<ViewOf<P>, Aggregate<ViewOf<P>, L::Classifier>>>,
    ) -> Result<Trained<Greedy<L::Classifier>>> {
        let episodes = all(problem);
        self.rounds(problem, learner, run, |policy, seed| roll::costs(problem, policy, costing, &episodes, seed))
    }

    fn rounds<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<ViewOf<P>, Aggregate<ViewOf<P>, L::Classifier>>>,
        collect: impl Fn(&Mixture<&L::Classifier>, Seed) -> (Round<P>, Ledger),
    ) -> Result<Trained<Greedy<L::Classifier>>> {
        check_rounds(self.rounds)?;
        self.schedule.check()?;
        let mut book = Book::open(problem, run)?;
        let mut data = book.resume(Aggregate::default())?;
        while let Some(i) = book.next(self.rounds) {
            let seed = run.seed.child(Purpose::Round, i as u64);
            // pi_i = beta_i pi* + (1-beta_i) pihat_i
            let round = book.bill(collect(&data.policy(self.schedule.share(i)), seed));
            data.examples.absorb(round.examples); // D <- D u D_i
            let warm = data.learned.as_ref().filter(|_| self.warm);
            let seed = seed.child(Purpose::Learner, 0);
            data.learned = Some(learner.fit(Setting::of(problem), &data.examples, warm, seed));
            book.round(self.rounds, round.cost, &data)?;
        }
        Ok(book.close(data.finish()?))
    }
}
