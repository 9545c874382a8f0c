//! Those who run episodes, and the bill they keep.
//!
//! A trainer never holds the space or the expert. It gets a [`Worker`], which runs episodes and owns all scratch, and at each
//! state a [`Visit`], whose methods count in the [`Ledger`] whatever they do. [`sweep`] runs many episodes on all threads
//! and hands back what was gathered in the order of the episodes.

mod beam;
mod ledger;
mod memo;
mod visit;

pub use beam::Path;
pub use ledger::Ledger;
pub use memo::Memo;
pub use visit::Visit;

use crate::ordered::InOrder;
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Episode, Gather, Problem, Space, StateOf, ViewOf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use visit::{Kind, Looks};

/// Runs episodes of a problem one at a time; owns the scratch that they share.
pub struct Worker<'p, P: Problem> {
    problem: &'p P,
    ledger: Ledger,
    looks: Looks<ViewOf<P>>,
}

impl<'p, P: Problem> Worker<'p, P> {
    /// A worker with an empty bill.
    pub fn new(problem: &'p P) -> Self {
        Worker { problem, ledger: Ledger::default(), looks: Looks::default() }
    }

    /// What has been billed since the worker was new.
    pub fn ledger(&self) -> Ledger {
        self.ledger
    }

    /// Runs `episode`: at each state `drive` says what to do, or abandons the episode with `None`. Returns the total cost.
    pub fn episode(&mut self, episode: Episode, drive: impl FnMut(&mut Visit<'_, P>) -> Option<Action>) -> f64 {
        self.run(episode, drive).0
    }

    /// The same; returns the state in which it ended as well, for those who measure.
    pub(crate) fn run(
        &mut self,
        episode: Episode,
        mut drive: impl FnMut(&mut Visit<'_, P>) -> Option<Action>,
    ) -> (f64, StateOf<P>) {
        let space = self.problem.space();
        let mut state = space.start(episode);
        let mut total = 0.0;
        for t in 0.. {
            let mut visit =
                Visit::new(self.problem, &state, &mut self.ledger, &mut self.looks, Kind::RollIn, t, episode.seed);
            visit.spent = total;
            if visit.legal().is_empty() {
                break;
            }
            let Some(action) = drive(&mut visit) else { break };
            let seed = visit.seed();
            self.ledger.steps += 1;
            total += space.step(&mut state, action, seed);
        }
        (total, state)
    }
}

/// Episodes per shard, the unit of work of a thread, where there are many of them.
const SHARD: usize = 16;

/// Gives the next number, until there is none.
type Take<'a> = dyn FnMut() -> Option<usize> + 'a;

/// Calls `work` on the threads of the current rayon pool, each of which takes numbers below `count`, every one once, until none is left. That this is not
/// generic saves a thread pool's machinery for every kind of sweep.
fn spread(count: usize, work: &(dyn Fn(&mut Take<'_>) + Sync)) {
    let next = AtomicUsize::new(0);
    let work = || work(&mut || Some(next.fetch_add(1, Ordering::Relaxed)).filter(|number| *number < count));
    rayon::scope(|scope| {
        (1..count.min(rayon::current_num_threads())).for_each(|_| scope.spawn(|_| work()));
        work();
    });
}

/// Runs `episodes`, each keyed by `seed` and its number, on all threads of the current rayon pool.
///
/// `run` is given a worker, the thread's memory (scratch that must not influence results) and the gathering to add to. What
/// was gathered comes back in the order of the episodes, with the bill.
pub fn sweep<P, M, G>(
    problem: &P,
    episodes: &[usize],
    seed: Seed,
    run: impl Fn(&mut Worker<'_, P>, &mut M, Episode, &mut G) + Sync,
) -> (G, Ledger)
where
    P: Problem,
    M: Default,
    G: Gather,
{
    // Few episodes are long ones. How they are cut must not depend on the threads, because sums do depend on it.
    let shards: Vec<&[usize]> = episodes.chunks((episodes.len() / SHARD).clamp(1, SHARD)).collect();
    let done = Mutex::new(Gathered::default());
    spread(shards.len(), &|take| {
        let mut worker = Worker::new(problem);
        let mut memory = M::default();
        let mut ready = Vec::new();
        while let Some(shard) = take() {
            worker.ledger = Ledger::default();
            let mut gathered = G::default();
            for &index in shards[shard] {
                let episode = Episode { index, seed: seed.child(Purpose::Episode, index as u64) };
                run(&mut worker, &mut memory, episode, &mut gathered);
            }
            ready.push((shard, gathered, worker.ledger));
            // Nobody waits for another that puts things together: what is ready now is handed over with what is ready next.
            if let Ok(mut done) = done.try_lock() {
                done.put(&mut ready);
            }
        }
        done.lock().unwrap_or_else(PoisonError::into_inner).put(&mut ready);
    });
    let done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    (done.all, done.ledger)
}

/// What shards gathered, put together in their order.
#[derive(Default)]
struct Gathered<G> {
    all: G,
    ledger: Ledger,
    shards: InOrder<(G, Ledger)>,
}

impl<G: Gather> Gathered<G> {
    /// Takes these shards with their numbers, and puts together what is next in order.
    fn put(&mut self, ready: &mut Vec<(usize, G, Ledger)>) {
        ready.drain(..).for_each(|(shard, gathered, bill)| self.shards.put(shard, (gathered, bill)));
        while let Some((gathered, bill)) = self.shards.next() {
            self.all.absorb(gathered);
            self.ledger += bill;
        }
    }
}

/// The numbers of all the problem's episodes.
pub fn all(problem: &impl Problem) -> Vec<usize> {
    (0..problem.episodes()).collect()
}
