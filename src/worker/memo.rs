//! What is left of a run, remembered.

use super::Ledger;
use crate::seed::Seed;

/// What roll-outs with the same randomness and the same policy found out about the states they passed: states of the same step and
/// the same [`signature`](crate::space::Space::signature) have the same future, so it need not be run twice.
///
/// Only the computing is saved: a remembered future is billed as if it had been run.
#[derive(Clone, Debug, Default)]
pub struct Memo {
    run: Option<Seed>,
    /// A table of open addressing with a power of two of places, at most half of them taken.
    keys: Vec<Key>,
    rests: Vec<Rest>,
    /// Places taken in this era; what was taken in another is free.
    taken: usize,
    era: u32,
    /// Scratch for the roll-out that is under way.
    pub(super) trail: Vec<Passed>,
}

/// A state that is remembered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Key {
    signature: u64,
    t: u32,
    era: u32,
}

impl Key {
    /// Where the search for it begins in a table of this many places: the upper bits of a product are the well mixed ones.
    #[inline]
    fn start(self, places: usize) -> usize {
        let mixed = (self.signature ^ u64::from(self.t) << 48).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (mixed >> (64 - places.trailing_zeros())) as usize
    }
}

/// What comes after a state.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rest {
    pub cost: f64,
    pub bill: Ledger,
}

/// A state that a roll-out came to: what the step there cost, its signature, and the bill before anything is decided in it.
pub(super) type Passed = (f64, Option<u64>, Ledger);

/// Places of the smallest table.
const PLACES: usize = 256;

impl Memo {
    /// Forgets everything unless it belongs to `run`.
    pub(super) fn belong_to(&mut self, run: Seed) {
        if self.run == Some(run) {
            return;
        }
        self.run = Some(run);
        self.taken = 0;
        self.era = self.era.wrapping_add(1);
        if self.era == 0 || self.keys.is_empty() {
            self.era = 1;
            self.keys = vec![Key::default(); PLACES];
            self.rests = vec![Rest::default(); PLACES];
        }
    }

    /// What is known to come after the state with this signature at step `t`.
    #[inline]
    pub(super) fn find(&self, t: usize, signature: u64) -> Option<Rest> {
        self.place(Key { signature, t: t as u32, era: self.era }).ok().map(|place| self.rests[place])
    }

    /// Remembers what comes after it.
    #[inline]
    pub(super) fn keep(&mut self, t: usize, signature: u64, rest: Rest) {
        if 2 * self.taken >= self.keys.len() {
            self.grow();
        }
        let key = Key { signature, t: t as u32, era: self.era };
        let place = self.place(key).unwrap_or_else(|free| {
            self.taken += 1;
            free
        });
        self.keys[place] = key;
        self.rests[place] = rest;
    }

    /// Where `key` is, or the free place where it belongs.
    #[inline]
    fn place(&self, key: Key) -> Result<usize, usize> {
        let mut place = key.start(self.keys.len());
        loop {
            let found = self.keys[place];
            if found == key {
                return Ok(place);
            }
            if found.era != key.era {
                return Err(place);
            }
            place = (place + 1) & (self.keys.len() - 1);
        }
    }

    /// Makes the table twice as large.
    #[cold]
    fn grow(&mut self) {
        let (keys, rests) = (std::mem::take(&mut self.keys), std::mem::take(&mut self.rests));
        self.rests = vec![Rest::default(); 2 * keys.len()];
        self.keys = vec![Key::default(); 2 * keys.len()];
        for (key, rest) in keys.into_iter().zip(rests).filter(|(key, _)| key.era == self.era) {
            if let Err(place) = self.place(key) {
                self.keys[place] = key;
                self.rests[place] = rest;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashMap;

    proptest! {
        /// A memo remembers what a map of the standard library does, over runs and growth.
        #[test]
        fn remembers_what_a_map_would(steps in prop::collection::vec((0..3u64, 0..40usize, 0..30u64, 0..9u32), 0..1500)) {
            let (mut memo, mut map, mut run) = (Memo::default(), HashMap::new(), None);
            for (number, t, signature, cost) in steps {
                // Few runs are begun, so that some of them become long.
                let next = if cost == 0 { Some(number) } else { run.or(Some(number)) };
                if next != run {
                    map.clear();
                    run = next;
                }
                memo.belong_to(Seed::new(run.unwrap_or(0)));
                prop_assert_eq!(memo.find(t, signature).map(|rest| rest.cost), map.get(&(t, signature)).copied());
                memo.keep(t, signature, Rest { cost: f64::from(cost), bill: Ledger::default() });
                map.insert((t, signature), f64::from(cost));
            }
        }
    }
}
