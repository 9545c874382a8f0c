//! Order among things that are done at the same time.

use std::collections::BTreeMap;

/// Takes numbered things in any order and gives them in that of their numbers, from 0 on: what comes too soon waits.
pub(crate) struct InOrder<T> {
    next: usize,
    waiting: BTreeMap<usize, T>,
}

impl<T> Default for InOrder<T> {
    fn default() -> Self {
        InOrder { next: 0, waiting: BTreeMap::new() }
    }
}

impl<T> InOrder<T> {
    /// Takes the thing of this number, each of which comes once.
    pub fn put(&mut self, number: usize, thing: T) {
        self.waiting.insert(number, thing);
    }

    /// The next in order, if it is there.
    pub fn next(&mut self) -> Option<T> {
        let thing = self.waiting.remove(&self.next)?;
        self.next += 1;
        Some(thing)
    }
}
