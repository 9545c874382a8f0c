//! A stream that is answered block by block, on all threads.

use crate::error::Result;
use crate::ordered::InOrder;
use rayon::Scope;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Gives what `next` reads to `answer`, on all threads, and the answers to `write`, in the order of what was read. One thread reads at a time, and few blocks are
/// held at a time, however long the stream is.
///
/// `next` and `write` run under locks: they must not share out work among the threads themselves, one of which could come back for the same lock.
///
/// # Errors
/// The first in that order, of any of the three. What comes before it is written.
pub fn answered<B: Send, A: Send>(
    next: impl FnMut() -> Option<Result<B>> + Send,
    answer: impl Fn(B) -> Result<A> + Sync,
    write: impl FnMut(A) -> Result<()> + Send,
) -> Result<()> {
    let source = Mutex::new(Source { next, read: 0, going: true });
    let sink = Mutex::new(Sink { write, answers: InOrder::default(), done: Ok(()) });
    let stream = Stream { source, answer, sink };
    let held = 2 * rayon::current_num_threads();
    rayon::scope(|scope| (0..held).for_each(|_| stream.go_on(scope)));
    stream.sink.into_inner().unwrap_or_else(PoisonError::into_inner).done
}

struct Stream<N, F, W, A> {
    source: Mutex<Source<N>>,
    answer: F,
    sink: Mutex<Sink<W, A>>,
}

struct Source<N> {
    next: N,
    /// How many blocks were read.
    read: usize,
    /// Whether there may be more.
    going: bool,
}

struct Sink<W, A> {
    write: W,
    answers: InOrder<Result<A>>,
    done: Result<()>,
}

impl<N, F, W, A, B> Stream<N, F, W, A>
where
    N: FnMut() -> Option<Result<B>> + Send,
    F: Fn(B) -> Result<A> + Sync,
    W: FnMut(A) -> Result<()> + Send,
    A: Send,
    B: Send,
{
    /// Lets some thread answer one more block. For each that is written it goes on with another: nobody waits for anybody, and no more are held than were begun with.
    fn go_on<'s>(&'s self, scope: &Scope<'s>) {
        scope.spawn(|scope| {
            let Some((number, block)) = locked(&self.source).next() else { return };
            let answer = block.and_then(&self.answer);
            let written = locked(&self.sink).take(number, answer);
            (0..written).for_each(|_| self.go_on(scope));
        });
    }
}

impl<B, N: FnMut() -> Option<Result<B>>> Source<N> {
    /// The next block and its number.
    fn next(&mut self) -> Option<(usize, Result<B>)> {
        let block = if self.going { (self.next)() } else { None };
        self.going = matches!(block, Some(Ok(_)));
        self.read += 1;
        Some((self.read - 1, block?))
    }
}

impl<A, W: FnMut(A) -> Result<()>> Sink<W, A> {
    /// Takes the answer to this block and writes what can be written. Returns how many answers that were; none after an error.
    fn take(&mut self, number: usize, answer: Result<A>) -> usize {
        self.answers.put(number, answer);
        let mut written = 0;
        while self.done.is_ok()
            && let Some(answer) = self.answers.next()
        {
            self.done = answer.and_then(&mut self.write);
            written += 1;
        }
        if self.done.is_ok() { written } else { 0 }
    }
}

/// What a thread left that panicked is as good as it was: the panic goes on in the one that waits for all.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use proptest::prelude::*;

    fn fault(at: usize) -> Error {
        Error::argument("block", at, "another")
    }

    proptest! {
        /// Whatever takes longest, all that comes before the first fault is written, in order, and the fault is told.
        #[test]
        fn what_is_written_is_what_one_after_the_other_would_be(
            slow in prop::collection::vec(0..300u64, 0..40),
            unread in 0..60usize,
            unanswered in 0..60usize,
            unwritten in 0..60usize,
            threads in 1..5usize,
        ) {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let (mut blocks, mut written) = (0..slow.len(), Vec::new());
            let failing = |at: usize, bad: usize| if at == bad { Err(fault(at)) } else { Ok(at) };
            let done = pool.install(|| {
                answered(
                    || blocks.next().map(|at| failing(at, unread)),
                    |at| {
                        std::thread::sleep(std::time::Duration::from_micros(slow[at]));
                        failing(at, unanswered)
                    },
                    |at| failing(at, unwritten).map(|at| written.push(at)),
                )
            });
            let first = unread.min(unanswered).min(unwritten);
            prop_assert_eq!(written, (0..first.min(slow.len())).collect::<Vec<_>>());
            prop_assert_eq!(done.map_err(|error| error.to_string()).err(), (first < slow.len()).then(|| fault(first).to_string()));
        }
    }
}
