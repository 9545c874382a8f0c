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
//!
//! All of them can be stopped between two rounds ([`Run::stop`]), and go on after they were killed where a [`Checkpoint`] was kept ([`Run::kept`]): the state that
//! a trainer goes on from stands in its signature, as what the [`Keeper`] keeps.

mod aggregate;
mod aggrevate;
mod checkpoint;
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

pub use aggregate::Aggregate;
pub use aggrevate::Aggrevate;
pub use checkpoint::{Checkpoint, Keeper, Keeping};
pub use cpi::{Cpi, Rate};
pub use dagger::{Dagger, Schedule};
pub(crate) use early::Averaged;
pub(crate) use early::MOST_WIDTH;
pub use early::{Beam, EarlyUpdate};
pub use forward::Forward;
pub use lols::{Lols, Regret};
pub use reuse::Reuse;
pub(crate) use reuse::Slots;
pub use searn::Searn;
pub use smile::Smile;
pub(crate) use stacking::MOST_WINDOW;
pub use stacking::Stacking;
pub(crate) use stacking::{Stages, TwoStage};
pub use supervised::Supervised;

use crate::error::{Error, Result};
use crate::learner::Setting;
use crate::seed::{Purpose, Seed};
use crate::space::{Problem, Space, View};
use crate::worker::{Ledger, all};
use rand::seq::SliceRandom;
use serde::Serialize;
use std::time::Instant;

/// One training run: where its randomness comes from, who watches it, who may stop it, and who keeps what it knows after each round.
#[derive(Clone)]
pub struct Run<'a, K = ()> {
    /// The root of all that is random in it.
    pub seed: Seed,
    /// Who is told after each round. Where training goes on from a checkpoint, also of the rounds before.
    pub watch: &'a (dyn Fn(&Progress) + Sync),
    /// Asked before each round but the first: whether training is to end with what it has.
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// The [`Keeper`] of a trainer's state; `()` keeps nothing.
    pub keep: K,
}

impl Run<'_> {
    /// A run from the seed `number` that nobody watches, stops or keeps.
    pub fn new(number: u64) -> Self {
        Run { seed: Seed::new(number), watch: &|_| {}, stop: &|| false, keep: () }
    }
}

impl<'a, K> Run<'a, K> {
    /// The same run, kept by `keep`.
    pub fn kept<L>(self, keep: L) -> Run<'a, L> {
        Run { seed: self.seed, watch: self.watch, stop: self.stop, keep }
    }

    /// A run of its own within this one: from another seed, told to nobody, kept by `keep`.
    pub(crate) fn within<L>(&self, seed: Seed, keep: L) -> Run<'a, L> {
        Run { seed, watch: &|_| {}, stop: self.stop, keep }
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
    /// Whether it was stopped before its end: see [`Run::stop`].
    pub stopped: bool,
}

impl<D> Trained<D> {
    /// The same with the policy replaced by what `change` makes of it.
    pub fn map<E>(self, change: impl FnOnce(D) -> E) -> Trained<E> {
        Trained { policy: change(self.policy), ledger: self.ledger, rounds: self.rounds, stopped: self.stopped }
    }
}

/// The book that a trainer keeps: the bill and the rounds, and after each round its state.
struct Book<'a, V: View, K> {
    run: &'a Run<'a, K>,
    setting: Setting<'a, V>,
    start: Instant,
    /// Seconds that passed in runs before this one.
    before: f64,
    episodes: usize,
    ledger: Ledger,
    rounds: Vec<Progress>,
    stopped: bool,
}

impl<'a, V: View, K> Book<'a, V, K> {
    /// Opens the book on `problem`.
    fn open<P: Problem<Space: Space<View = V>>>(problem: &'a P, run: &'a Run<'_, K>) -> Result<Self> {
        if problem.episodes() == 0 {
            return Err(Error::argument("episodes", 0, "at least 1"));
        }
        Ok(Book {
            run,
            setting: Setting::of(problem),
            start: Instant::now(),
            before: 0.0,
            episodes: problem.episodes(),
            ledger: Ledger::default(),
            rounds: Vec::new(),
            stopped: false,
        })
    }

    /// The state to go on from, with the rounds and the bill before it; `start` where none was kept.
    fn resume<S>(&mut self, start: S) -> Result<S>
    where
        K: Keeper<V, S>,
    {
        let (state, rounds) = self.run.keep.load(self.setting, start)?;
        rounds.iter().for_each(self.run.watch);
        if let Some(last) = rounds.last() {
            (self.ledger, self.before) = (last.ledger, last.seconds);
        }
        self.rounds = rounds;
        Ok(state)
    }

    /// The rounds done.
    fn done(&self) -> usize {
        self.rounds.len()
    }

    /// The number of the next of so many rounds, from 1; none when all are done or training is to stop.
    fn next(&mut self, rounds: usize) -> Option<usize> {
        let left = self.done() < rounds;
        self.stopped = left && self.done() > 0 && (self.run.stop)();
        (left && !self.stopped).then_some(self.done() + 1)
    }

    /// Bills what came with `bill`.
    fn bill<T>(&mut self, (got, bill): (T, Ledger)) -> T {
        self.ledger += bill;
        got
    }

    /// Closes a round whose roll-ins cost `cost` in sum, and after which `state` is known.
    fn round<S>(&mut self, rounds: usize, cost: f64, state: &S) -> Result<()>
    where
        K: Keeper<V, S>,
    {
        self.round_with(rounds, (cost, None), state)
    }

    /// The same, with the regret of these roll-ins.
    fn round_with<S>(&mut self, rounds: usize, (cost, regret): (f64, Option<Regret>), state: &S) -> Result<()>
    where
        K: Keeper<V, S>,
    {
        self.note(rounds, (cost, regret));
        self.run.keep.save(state, &self.rounds)?;
        self.tell();
        Ok(())
    }

    /// Tells of the last round.
    fn tell(&self) {
        self.rounds.last().into_iter().for_each(self.run.watch);
    }

    /// Writes a round down.
    fn note(&mut self, rounds: usize, (cost, regret): (f64, Option<Regret>)) {
        self.rounds.push(Progress {
            round: self.done() + 1,
            rounds,
            cost: cost / self.episodes as f64,
            regret,
            ledger: self.ledger,
            seconds: self.before + self.start.elapsed().as_secs_f64(),
        });
    }

    /// Closes the book.
    fn close<D>(self, policy: D) -> Trained<D> {
        Trained { policy, ledger: self.ledger, rounds: self.rounds, stopped: self.stopped }
    }
}

/// The episodes of an online trainer, in a new order each round, which is the one before, shuffled.
struct Shuffled {
    episodes: Vec<usize>,
    round: u64,
    seed: Seed,
}

impl Shuffled {
    /// Those that come after so many rounds.
    fn after<P: Problem>(rounds: usize, problem: &P, seed: Seed) -> Self {
        let mut shuffled = Shuffled { episodes: all(problem), round: 0, seed };
        (0..rounds).for_each(|_| drop(shuffled.next()));
        shuffled
    }

    /// Those of the next round.
    fn next(&mut self) -> impl Iterator<Item = usize> {
        self.round += 1;
        let seed = self.seed.child(Purpose::Round, self.round);
        self.episodes.shuffle(&mut seed.child(Purpose::Learner, 0).rng());
        self.episodes.iter().copied()
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
