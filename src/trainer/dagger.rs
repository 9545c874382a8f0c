//! DAgger (Ross, Gordon & Bagnell 2011).

use super::{Aggregate, Book, Keeper, Run, Shuffled, Trained, check_rounds};
use crate::error::{Error, Result};
use crate::learner::{Learner, Online, Setting, Target};
use crate::policy::Greedy;
use crate::roll;
use crate::seed::Purpose;
use crate::space::{Episode, Gather, Problem, ViewOf};
use crate::worker::{Worker, all};
use serde::{Deserialize, Serialize};

/// beta_i: the probability with which the expert drives at a step of round i = 1, 2, ... In the first round it always drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Schedule {
    /// I(i = 1): in the first round only.
    #[default]
    First,
    /// p^(i-1), p in [0, 1).
    Exponential(f64),
    /// 1 - (i-1)/n, until nothing is left after n rounds.
    Linear(usize),
}

impl Schedule {
    /// beta_i.
    pub fn share(self, i: usize) -> f64 {
        let before = i.saturating_sub(1);
        match self {
            Schedule::First => f64::from(u8::from(before == 0)),
            Schedule::Exponential(p) => p.powf(before as f64),
            Schedule::Linear(n) => (1.0 - before as f64 / n as f64).max(0.0),
        }
    }

    /// A schedule from its name, as in `first`, `exponential:0.5` (p) or `linear:3` (n).
    ///
    /// # Errors
    /// When it is none of these, or its number is out of its range.
    pub fn parse(text: &str) -> Result<Self> {
        let unknown = || Error::argument("schedule", text, "first, exponential:P or linear:N");
        let schedule = match text.split_once(':') {
            None if text == "first" => Schedule::First,
            Some(("exponential", p)) => Schedule::Exponential(p.parse().map_err(|_| unknown())?),
            Some(("linear", n)) => Schedule::Linear(n.parse().map_err(|_| unknown())?),
            _ => return Err(unknown()),
        };
        schedule.check().map(|()| schedule)
    }

    /// Refuses a schedule by which the expert would drive for ever, or never begin to.
    pub(super) fn check(self) -> Result<()> {
        match self {
            Schedule::Exponential(p) if !(0.0..1.0).contains(&p) => {
                Err(Error::argument("schedule", format!("exponential with {p}"), "a rate of at least 0 and below 1"))
            }
            Schedule::Linear(0) => Err(Error::argument("schedule", "linear over 0 rounds", "at least 1 round")),
            _ => Ok(()),
        }
    }
}

/// Dataset aggregation: the learner drives, the expert labels every state it reaches, and the learner learns from all labels so far. In round i
/// the expert drives with probability beta_i instead, drawn anew at each step ([`Schedule`]): pi_i = beta_i pi* + (1-beta_i) pihat_i.
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
    /// How much the expert drives in each round. `None` is what suits: in the first round of [`Dagger::train`], [`Schedule::First`], and never in
    /// [`Dagger::train_online`].
    pub schedule: Option<Schedule>,
}

impl Default for Dagger {
    fn default() -> Self {
        Dagger { rounds: 5, warm: false, schedule: None }
    }
}

impl Dagger {
    /// Trains on `problem` with `learner`, on the aggregate of all rounds so far.
    ///
    /// # Errors
    /// When there are no rounds, the schedule has a number out of its range, or the problem has no episodes.
    pub fn train<P: Problem, L: Learner<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<ViewOf<P>, Aggregate<ViewOf<P>, L::Classifier>>>,
    ) -> Result<Trained<Greedy<L::Classifier>>> {
        check_rounds(self.rounds)?;
        let schedule = self.schedule.unwrap_or_default();
        schedule.check()?;
        let mut book = Book::open(problem, run)?;
        let (setting, episodes) = (Setting::of(problem), all(problem));
        let mut data = book.resume(Aggregate::default())?;
        while let Some(i) = book.next(self.rounds) {
            let seed = run.seed.child(Purpose::Round, i as u64);
            let policy = data.policy(schedule.share(i)); // pi_i = beta_i pi* + (1-beta_i) pihat_i
            let round = book.bill(roll::labels(problem, &policy, &episodes, seed));
            data.examples.absorb(round.examples); // D <- D u D_i
            let warm = data.learned.as_ref().filter(|_| self.warm);
            data.learned = Some(learner.fit(setting, &data.examples, warm, seed.child(Purpose::Learner, 0)));
            book.round(self.rounds, round.cost, &data)?;
        }
        Ok(book.close(data.finish()?))
    }

    /// Trains on `problem` with an online `learner`, which learns at every state it reaches as soon as it has acted there. Without a
    /// schedule it drives from the first step on. It goes through the episodes in a new order each round, one after the other: more threads do not help.
    ///
    /// # Errors
    /// When there are no rounds, the schedule has a number out of its range, or the problem has no episodes.
    pub fn train_online<P: Problem, L: Online<ViewOf<P>>>(
        &self,
        problem: &P,
        learner: &L,
        run: &Run<'_, impl Keeper<ViewOf<P>, L::Course>>,
    ) -> Result<Trained<Greedy<L::Classifier>>> {
        self.go_on_online(problem, (learner, None), run)
    }

    /// The same with a learner who starts from a classifier, if there is one: training that was ended goes on, on other episodes.
    ///
    /// # Errors
    /// As [`Dagger::train_online`].
    pub fn go_on_online<P: Problem, L: Online<ViewOf<P>>>(
        &self,
        problem: &P,
        (learner, warm): (&L, Option<&L::Classifier>),
        run: &Run<'_, impl Keeper<ViewOf<P>, L::Course>>,
    ) -> Result<Trained<Greedy<L::Classifier>>> {
        check_rounds(self.rounds)?;
        self.schedule.map_or(Ok(()), Schedule::check)?;
        let mut book = Book::open(problem, run)?;
        let mut course = book.resume(learner.begin(Setting::of(problem), warm))?;
        let mut episodes = Shuffled::after(book.done(), problem, run.seed);
        while let Some(i) = book.next(self.rounds) {
            let seed = run.seed.child(Purpose::Round, i as u64);
            let mut worker = Worker::new(problem);
            let (mut cost, share) = (0.0, self.schedule.map_or(0.0, |schedule| schedule.share(i)));
            for index in episodes.next() {
                let episode = Episode { index, seed: seed.child(Purpose::Episode, index as u64) };
                cost += worker.episode(episode, |visit| {
                    let learned = match visit.label() {
                        Some(label) => {
                            visit.record(|sight| learner.learn(&mut course, sight, Some(Target::Label(label))))
                        }
                        None => learner.learn(&mut course, &visit.sight(), None),
                    };
                    let expert = share > 0.0 && visit.seed().child(Purpose::Member, 0).unit() < share;
                    Some(if expert { visit.expert() } else { learned })
                });
            }
            book.bill(((), worker.ledger()));
            book.round(self.rounds, cost, &course)?;
        }
        Ok(book.close(Greedy(learner.finish(course))))
    }
}
