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
    /// Which states of each step are known: roll-outs from one state pass few steps before they meet, so few tables are in use at a time.
    steps: Vec<Table>,
    /// What comes after the known states, in the order in which they were come to.
    rests: Vec<Rest>,
}

/// What comes after a state.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rest {
    pub cost: f64,
    pub bill: Ledger,
}

impl Memo {
    /// Forgets everything unless it belongs to `run`.
    pub(super) fn belong_to(&mut self, run: Seed) {
        if self.run == Some(run) {
            return;
        }
        self.run = Some(run);
        self.rests.clear();
        self.era = self.era.wrapping_add(1);
        if self.era == 0 {
            self.steps.clear();
            self.era = 1;
        }
    }

    /// How many states are kept.
    pub(super) fn len(&self) -> usize {
        self.rests.len()
    }

    /// What is known to come after the state with this signature at step `t`. If nothing is, it is kept from now on, and what comes after it
    /// must be [settled](Memo::settle) before anything else is asked; `then` is what the step to it cost, and the bill before anything is
    /// decided in it. A state without a signature is kept too, but never found.
    #[inline]
    pub(super) fn come_to(&mut self, t: usize, signature: Option<u64>, then: Rest) -> Option<Rest> {
        if let Some(signature) = signature {
            if self.steps.len() <= t {
                self.steps.resize_with(t + 1, Table::default);
            }
            let state = State { signature, era: self.era, at: self.rests.len() as u32 };
            if let Some(at) = self.steps[t].find_or_keep(state) {
                return Some(self.rests[at as usize]);
            }
        }
        self.rests.push(then);
        None
    }

    /// Settles what comes after the states from number `first` on, which one roll-out passed one after the other. After the last of them came
    /// `later` more steps and `rest`, when the bill was that of `rest`. Returns what the roll-out cost, added up from its end, as a table of
    /// costs-to-go would.
    pub(super) fn settle(&mut self, first: usize, mut later: u64, rest: Rest) -> f64 {
        let Rest { mut cost, bill: after } = rest;
        for passed in self.rests[first..].iter_mut().rev() {
            let then = *passed;
            passed.cost = cost;
            passed.bill = after - then.bill;
            passed.bill.steps += later;
            cost += then.cost;
            later += 1;
        }
        cost
    }
}

/// The states of one step: a table of open addressing with a power of two of places, at most half of them taken.
#[derive(Clone, Debug)]
struct Table {
    places: Vec<State>,
    /// How many places are taken in the era that was kept last.
    taken: (u32, usize),
}

/// A state that is known, in which era, and which number it has. A place of another era is free.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    signature: u64,
    era: u32,
    at: u32,
}

/// Places of the smallest table.
const PLACES: usize = 32;

impl Default for Table {
    fn default() -> Self {
        Table { places: vec![State::default(); PLACES], taken: (0, 0) }
    }
}

impl Table {
    /// The number of the state with the same signature and era, if there is one; else this one is kept.
    #[inline]
    fn find_or_keep(&mut self, state: State) -> Option<u32> {
        if self.taken.0 != state.era {
            self.taken = (state.era, 0);
        }
        let place = match self.place(state) {
            Ok(place) => return Some(self.places[place].at),
            Err(free) => free,
        };
        self.places[place] = state;
        self.taken.1 += 1;
        if 2 * self.taken.1 > self.places.len() {
            self.grow(state.era);
        }
        None
    }

    /// Where the state with the same signature and era is, or the free place where it belongs.
    #[inline]
    fn place(&self, state: State) -> Result<usize, usize> {
        let last = self.places.len() - 1;
        // The upper bits of a product are the well mixed ones.
        let mixed = state.signature.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut place = (mixed >> 32) as usize & last;
        loop {
            let found = self.places[place];
            if found.era != state.era {
                return Err(place);
            }
            if found.signature == state.signature {
                return Ok(place);
            }
            place = (place + 1) & last;
        }
    }

    /// Makes the table twice as large.
    #[cold]
    fn grow(&mut self, era: u32) {
        let places = std::mem::take(&mut self.places);
        self.places = vec![State::default(); 2 * places.len()];
        for state in places.into_iter().filter(|state| state.era == era) {
            if let Err(place) = self.place(state) {
                self.places[place] = state;
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
                let first = memo.len();
                let found = memo.come_to(t, Some(signature), Rest { cost: 1.0, bill: Ledger::default() });
                prop_assert_eq!(found.map(|rest| rest.cost), map.get(&(t, signature)).copied());
                if found.is_none() {
                    let rest = Rest { cost: f64::from(cost), bill: Ledger::default() };
                    prop_assert_eq!(memo.settle(first, 0, rest), f64::from(cost) + 1.0);
                    map.insert((t, signature), f64::from(cost));
                }
            }
        }
    }
}
