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
    /// The number of the run. What was kept in another is no more.
    era: u32,
    /// What is known of the states of each step: roll-outs from one state pass few steps before they meet, so few tables are
    /// in use at a time.
    steps: Vec<Table>,
    /// Scratch for the roll-out that is under way.
    pub(super) trail: Vec<Passed>,
}

/// What comes after a state.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rest {
    pub cost: f64,
    pub bill: Ledger,
}

/// A state that a roll-out came to: what the step there cost, its signature, and the bill before anything is decided in it.
pub(super) type Passed = (f64, Option<u64>, Ledger);

impl Memo {
    /// Forgets everything unless it belongs to `run`.
    pub(super) fn belong_to(&mut self, run: Seed) {
        if self.run == Some(run) {
            return;
        }
        self.run = Some(run);
        self.era = self.era.wrapping_add(1);
        if self.era == 0 {
            self.steps.clear();
            self.era = 1;
        }
    }

    /// What is known to come after the state with this signature at step `t`.
    #[inline]
    pub(super) fn find(&self, t: usize, signature: u64) -> Option<Rest> {
        let table = self.steps.get(t)?;
        table.place(Key { signature, era: self.era }).ok().map(|place| table.rests[place])
    }

    /// Remembers what comes after it.
    #[inline]
    pub(super) fn keep(&mut self, t: usize, signature: u64, rest: Rest) {
        if self.steps.len() <= t {
            self.steps.resize_with(t + 1, Table::default);
        }
        self.steps[t].keep(Key { signature, era: self.era }, rest);
    }
}

/// The states of one step: a table of open addressing with a power of two of places, at most half of them taken.
#[derive(Clone, Debug)]
struct Table {
    keys: Vec<Key>,
    rests: Vec<Rest>,
    /// How many places are taken in the era that was kept last.
    taken: (u32, usize),
}

/// A state that is remembered, and in which era. A place of another era is free.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Key {
    signature: u64,
    era: u32,
}

/// Places of the smallest table.
const PLACES: usize = 32;

impl Default for Table {
    fn default() -> Self {
        Table { keys: vec![Key::default(); PLACES], rests: vec![Rest::default(); PLACES], taken: (0, 0) }
    }
}

impl Table {
    fn keep(&mut self, key: Key, rest: Rest) {
        if self.taken.0 != key.era {
            self.taken = (key.era, 0);
        }
        if 2 * self.taken.1 >= self.keys.len() {
            self.grow(key.era);
        }
        let place = self.place(key).unwrap_or_else(|free| {
            self.taken.1 += 1;
            free
        });
        self.keys[place] = key;
        self.rests[place] = rest;
    }

    /// Where `key` is, or the free place where it belongs.
    #[inline]
    fn place(&self, key: Key) -> Result<usize, usize> {
        let last = self.keys.len() - 1;
        // The upper bits of a product are the well mixed ones.
        let mixed = key.signature.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut place = (mixed >> 32) as usize & last;
        loop {
            let found = self.keys[place];
            if found == key {
                return Ok(place);
            }
            if found.era != key.era {
                return Err(place);
            }
            place = (place + 1) & last;
        }
    }

    /// Makes the table twice as large.
    #[cold]
    fn grow(&mut self, era: u32) {
        let (keys, rests) = (std::mem::take(&mut self.keys), std::mem::take(&mut self.rests));
        self.rests = vec![Rest::default(); 2 * keys.len()];
        self.keys = vec![Key::default(); 2 * keys.len()];
        for (key, rest) in keys.into_iter().zip(rests).filter(|(key, _)| key.era == era) {
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
        fn remembers_what_a_map_would(steps in prop::collection::vec((0..3u64, 0..4usize, 0..300u64, 0..90u32), 0..1500)) {
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
