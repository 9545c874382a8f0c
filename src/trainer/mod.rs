//! Trainers: from a problem and a learner to a policy, with the bill. Each is one short file that reads like the listing it implements.
//!
//! | trainer | source | needs resets | policy |
//! |---|---|---|---|
//! | [`Supervised`] | Ross & Bagnell 2010, section 2.1 | no | one classifier |
//! | [`Forward`] | Ross & Bagnell 2010, Algorithm 3.1 | no | one classifier per step |
//! | [`Smile`] | Ross & Bagnell 2010, Algorithm 4.1 | no | a mixture |
//! | [`Searn`] | Daumé, Langford & Marcu 2009 | yes | a mixture |
//! | [`Cpi`] | Kakade & Langford 2002 | yes | a mixture |
//! | [`Dagger`] | Ross, Gordon & Bagnell 2011 | no | one classifier |
//! | [`Aggrevate`] | Ross & Bagnell 2014 | no; by roll-outs yes | one classifier |
//! | [`Lols`] | Chang et al. 2015 | yes | one classifier |
//! | [`Stacking`] | Cohen & Carvalho 2005 | no | two classifiers, one after the other |
//! | [`EarlyUpdate`] | Collins & Roark 2004 | yes | one classifier with a beam |

mod aggrevate;
mod cpi;
mod dagger;
mod early;
mod forward;
mod lols;
mod reuse;
mod searn;
mod smile;
mod stacking;
mod supervised;

pub use aggrevate::Aggrevate;
pub use cpi::{Cpi, Rate};
pub use dagger::{Dagger, Schedule};
pub(crate) use early::MOST_WIDTH;
pub use early::{Beam, EarlyUpdate};
pub use forward::Forward;
pub use lols::{Lols, Regret};
pub use reuse::Reuse;
pub use searn::Searn;
pub use smile::Smile;
pub(crate) use stacking::MOST_WINDOW;
pub use stacking::{StackedProblem, Stacking, Stages, TwoStage};
pub use supervised::Supervised;

use crate::error::{Error, Result};
use crate::seed::Seed;
use crate::space::Problem;
use crate::worker::Ledger;
use serde::Serialize;
use std::time::Instant;

/// One training run: where its randomness comes from and who watches it.
pub struct Run<'a> {
    /// The root of all that is random in it.
    pub seed: Seed,
    /// Who is told after each round.
    pub watch: &'a (dyn Fn(&Progress) + Sync),
}

impl Run<'_> {
    /// A run from the seed `number` that nobody watches.
    pub fn new(number: u64) -> Self {
        Run { seed: Seed::new(number), watch: &|_| {} }
    }
}

/// How far training has come.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Progress {
    /// The rounds done.
    pub round: usize,
    /// The rounds to do; for forward training, whose rounds end with the longest episode, those known to be needed.
    pub rounds: usize,
    /// The mean cost of an episode in this round's roll-ins; not a number where they were abandoned.
    pub cost: f64,
    /// What the learned policy of this round's roll-ins could have done better, where the trainer's roll-outs show it: [`Lols`].
    pub regret: Option<Regret>,
    /// The bill so far.
    pub ledger: Ledger,
    /// Seconds since training began, by the clock.
    pub seconds: f64,
}

/// What training brought.
#[derive(Clone, Debug)]
pub struct Trained<D> {
    /// The policy. It asks no expert.
    pub policy: D,
    /// The whole bill.
    pub ledger: Ledger,
    /// How it went, round by round.
    pub rounds: Vec<Progress>,
}

impl<D> Trained<D> {
    /// The same with the policy replaced by what `change` makes of it.
    pub fn map<E>(self, change: impl FnOnce(D) -> E) -> Trained<E> {
        Trained { policy: change(self.policy), ledger: self.ledger, rounds: self.rounds }
    }
}

/// The book that a trainer keeps: the bill and the rounds.
struct Book<'a> {
    watch: &'a (dyn Fn(&Progress) + Sync),
    start: Instant,
    episodes: usize,
    ledger: Ledger,
    rounds: Vec<Progress>,
}

impl<'a> Book<'a> {
    /// Opens the book on `problem`.
    fn open<P: Problem>(problem: &P, run: &Run<'a>) -> Result<Self> {
        if problem.episodes() == 0 {
            return Err(Error::argument("episodes", 0, "at least 1"));
        }
        Ok(Book {
            watch: run.watch,
            start: Instant::now(),
            episodes: problem.episodes(),
            ledger: Ledger::default(),
            rounds: Vec::new(),
        })
    }

    /// Bills what came with `bill`.
    fn bill<T>(&mut self, (got, bill): (T, Ledger)) -> T {
        self.ledger += bill;
        got
    }

    /// Closes a round whose roll-ins cost `cost` in sum.
    fn round(&mut self, rounds: usize, cost: f64) {
        self.round_with(rounds, cost, None);
    }

    /// The same, with the regret of these roll-ins.
    fn round_with(&mut self, rounds: usize, cost: f64, regret: Option<Regret>) {
        let progress = Progress {
            round: self.rounds.len() + 1,
            rounds,
            cost: cost / self.episodes as f64,
            regret,
            ledger: self.ledger,
            seconds: self.start.elapsed().as_secs_f64(),
        };
        (self.watch)(&progress);
        self.rounds.push(progress);
    }

    /// Closes the book.
    fn close<D>(self, policy: D) -> Trained<D> {
        Trained { policy, ledger: self.ledger, rounds: self.rounds }
    }
}

/// Refuses a number of rounds below 1.
fn check_rounds(rounds: usize) -> Result<()> {
    if rounds == 0 {
        return Err(Error::argument("rounds", rounds, "at least 1"));
    }
    Ok(())
}

/// Refuses what is no probability.
fn check_chance(name: &'static str, chance: f64) -> Result<()> {
    if !(0.0..=1.0).contains(&chance) {
        return Err(Error::argument(name, chance, "from 0 to 1"));
    }
    Ok(())
}

/// Refuses a mixing rate outside (0, 1].
fn check_rate(name: &'static str, rate: f64) -> Result<()> {
    if !(rate > 0.0 && rate <= 1.0) {
        return Err(Error::argument(name, rate, "above 0 and at most 1"));
    }
    Ok(())
}
