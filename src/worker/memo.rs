//! What is left of a run, remembered.

use super::Ledger;
use crate::seed::Seed;
use crate::space::Action;

/// What roll-outs with the same randomness and the same policy found out about the states they passed: states of the same step and
/// the same [`signature`](crate::space::Space::signature) have the same future, so it need not be run twice.
///
/// Only the computing is saved: a remembered future is billed as if it had been run.
#[derive(Clone, Debug)]
pub struct Memo<S> {
    run: Option<Seed>,
    /// The number of the run. What was kept in another is no more.
    era: u32,
    /// Which states of each step are known: roll-outs from one state pass few steps before they meet, so few tables are in use at a time.
    steps: Vec<Table>,
    /// What comes after the states that were come to, by their numbers. Number 0 is the end, after which nothing comes.
    rests: Vec<Rest>,
    /// The bills of those for which more was billed than steps and acts of the expert. Number 0 is the bill of the others.
    bills: Vec<Ledger>,
    /// States of this number and above cannot be found again.
    found: usize,
    /// The roll-outs that go on, all of them at the same step.
    pub(super) front: Vec<Standing<S>>,
    /// What each action costs that is tried, and the number of the state that it leads to.
    pub(super) tried: Vec<(f64, u32)>,
    /// What they cost to the end.
    pub(super) costs: Vec<f64>,
}

/// Where a roll-out stands.
#[derive(Clone, Debug)]
pub(super) struct Standing<S> {
    pub state: S,
    /// The number of the state.
    pub number: u32,
    /// What the way to it has cost.
    pub spent: f64,
}

/// What comes after a state: what is decided there and the step after that, and, once it is [settled](Memo::settle), all that follows.
#[derive(Clone, Copy, Debug, Default)]
struct Rest {
    cost: f64,
    steps: u32,
    /// The steps at which the expert acted.
    acts: u32,
    /// The number of the bill of all else.
    bill: u32,
    /// The number of the state that the step leads to.
    next: u32,
}

impl<S> Default for Memo<S> {
    fn default() -> Self {
        let (steps, rests, bills, front, tried, costs) = Default::default();
        Memo { run: None, era: 0, steps, rests, bills, found: 0, front, tried, costs }
    }
}

impl<S> Memo<S> {
    /// Forgets everything unless it belongs to `run`.
    pub(super) fn belong_to(&mut self, run: Seed) {
        if self.run == Some(run) {
            return;
        }
        self.run = Some(run);
        self.rests.clear();
        self.rests.push(Rest::default());
        self.bills.clear();
        self.bills.push(Ledger::default());
        self.found = 1;
        self.era = self.era.wrapping_add(1);
        if self.era == 0 {
            self.steps.clear();
            self.era = 1;
        }
    }

    /// Where roll-outs come to at step `t`.
    pub(super) fn arrivals(&mut self, t: usize) -> Arrivals<'_> {
        if self.steps.len() <= t {
            self.steps.resize_with(t + 1, Table::default);
        }
        let Memo { era, steps, rests, bills, found, .. } = self;
        let table = &mut steps[t];
        table.begin(*era);
        Arrivals { era: *era, table, rests, bills, found }
    }

    /// How far everything is known so far: what comes later is to be [settled](Memo::settle).
    pub(super) fn mark(&self) -> Mark {
        Mark { rests: self.rests.len(), bills: self.bills.len() }
    }

    /// Settles what comes after the states since `mark`: after each comes what is its own, and then what comes after the next, which was known
    /// before or has a higher number. Costs are added up from the end, as a table of costs-to-go would be.
    pub(super) fn settle(&mut self, mark: Mark) {
        for number in (mark.rests..self.rests.len()).rev() {
            let own = self.rests[number];
            let later = self.rests[own.next as usize];
            let bill = match (own.bill, later.bill) {
                (0, bill) => bill,
                (bill, 0) => bill,
                (bill, more) => {
                    let more = self.bills[more as usize];
                    self.bills[bill as usize] += more;
                    bill
                }
            };
            let (steps, acts) = (later.steps + own.steps, later.acts + own.acts);
            self.rests[number] = Rest { cost: later.cost + own.cost, steps, acts, bill, ..own };
        }
    }

    /// Finds what the actions cost that were tried, and returns the bill of all that came after them.
    pub(super) fn sum_up(&mut self) -> Ledger {
        let Memo { rests, bills, tried, costs, .. } = self;
        let (mut steps, mut acts, mut sum) = (0, 0, Ledger::default());
        costs.clear();
        costs.extend(tried.iter().map(|(cost, number)| {
            let rest = rests[*number as usize];
            steps += u64::from(rest.steps);
            acts += u64::from(rest.acts);
            if rest.bill != 0 {
                sum += bills[rest.bill as usize];
            }
            cost + rest.cost
        }));
        sum.steps += steps;
        sum.rollout_acts += acts;
        sum.queries += acts;
        sum
    }

    /// What comes after a state that is settled: what it costs, and its bill.
    #[cfg(test)]
    fn rest(&self, number: u32) -> (f64, Ledger) {
        let Rest { cost, steps, acts, bill, .. } = self.rests[number as usize];
        let mut bill = if bill == 0 { Ledger::default() } else { self.bills[bill as usize] };
        bill.steps += u64::from(steps);
        bill.rollout_acts += u64::from(acts);
        bill.queries += u64::from(acts);
        (cost, bill)
    }

    /// Forgets what cannot be found again of what is known since `mark`.
    pub(super) fn trim(&mut self, mark: Mark) {
        self.rests.truncate(self.found.max(mark.rests));
        if self.found <= mark.rests {
            self.bills.truncate(mark.bills);
        }
    }
}

/// What a step of a roll-out is billed for besides being one.
pub(super) enum Billed {
    /// Nothing.
    Nothing,
    /// The expert was asked and acted.
    Act,
    /// This.
    More(Ledger),
}

/// The states of one step that are known.
pub(super) struct Arrivals<'m> {
    era: u32,
    table: &'m mut Table,
    rests: &'m mut Vec<Rest>,
    bills: &'m mut Vec<Ledger>,
    found: &'m mut usize,
}

impl Arrivals<'_> {
    /// The number of the state with this signature, and whether it is new: what comes after it is then to be found out, and to be [settled](Memo::settle)
    /// before the next roll-outs. A state without a signature is always new.
    #[inline(always)] // It is called at two places, at each of them for every state.
    pub(super) fn come_to(&mut self, signature: Option<u64>) -> (u32, bool) {
        let number = self.rests.len() as u32;
        if let Some(signature) = signature {
            if let Some(known) = self.table.find_or_keep(State { signature, era: self.era, number, cost: 0.0 }) {
                return (known, false);
            }
            *self.found = self.rests.len() + 1;
        }
        self.rests.push(Rest::default());
        (number, true)
    }

    /// What `action` costs and the number of the state that it leads to, if it was taken before: in a [trellis](crate::space::Space::is_trellis).
    #[inline(always)]
    pub(super) fn led_to(&self, action: Action) -> Option<(f64, u32)> {
        let state = self.table.places.get(action.index()).filter(|state| state.era == self.era)?;
        Some((state.cost, state.number))
    }

    /// The number of the state that `action`, which costs `cost`, leads to for the first time: in a trellis.
    #[inline(always)]
    pub(super) fn lead_to(&mut self, action: Action, cost: f64) -> u32 {
        let (number, signature) = (self.rests.len() as u32, u64::from(action.0));
        if self.table.places.len() <= action.index() {
            self.table.places.resize((action.index() + 1).next_power_of_two(), State::default());
        }
        self.table.places[action.index()] = State { signature, era: self.era, number, cost };
        self.rests.push(Rest::default());
        *self.found = self.rests.len();
        number
    }

    /// Writes down that a step which costs `cost` leads from the state of this number, of the step before, to the `next`, and what else was billed for it.
    #[inline]
    pub(super) fn go_on(&mut self, number: u32, cost: f64, next: u32, billed: Billed) {
        let (acts, bill) = match billed {
            Billed::Nothing => (0, 0),
            Billed::Act => (1, 0),
            Billed::More(bill) => {
                self.bills.push(bill);
                (0, self.bills.len() as u32 - 1)
            }
        };
        self.rests[number as usize] = Rest { cost, steps: 1, acts, bill, next };
    }
}

/// How much was known at some time.
#[derive(Clone, Copy)]
pub(super) struct Mark {
    rests: usize,
    bills: usize,
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
    number: u32,
    /// In a trellis, what the action costs that leads there.
    cost: f64,
}

/// Places of the smallest table.
const PLACES: usize = 32;

impl Default for Table {
    fn default() -> Self {
        Table { places: vec![State::default(); PLACES], taken: (0, 0) }
    }
}

impl Table {
    /// Begins an era, if that is a new one.
    fn begin(&mut self, era: u32) {
        if self.taken.0 != era {
            self.taken = (era, 0);
        }
    }

    /// The number of the state with the same signature and era, if there is one; else this one is kept.
    #[inline(always)] // It is little more than one comparison, mostly.
    fn find_or_keep(&mut self, state: State) -> Option<u32> {
        let place = match self.place(state) {
            Ok(place) => return Some(self.places[place].number),
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
        // Small numbers have a place each; of a product the upper bits are the well mixed ones.
        let mixed = (state.signature >> 16).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        let mut place = (state.signature ^ mixed) as usize & last;
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
        /// A memo knows the states that a map of the standard library does, over runs and growth, and adds up what comes after them.
        #[test]
        fn remembers_what_a_map_would(
            trials in prop::collection::vec((0..3u64, prop::collection::vec((prop::option::weighted(0.9, 0..300u64), 0..90u32), 1..6)), 0..300),
        ) {
            let (mut memo, mut map, mut run) = (Memo::<()>::default(), HashMap::new(), None);
            for (number, passed) in trials {
                // Few runs are begun, so that some of them become long.
                let next = if passed[0].1 == 0 { Some(number) } else { run.or(Some(number)) };
                if next != run {
                    map.clear();
                    run = next;
                }
                memo.belong_to(Seed::new(run.unwrap_or(0)));
                // A roll-out that passes these states, until it comes to one that is known.
                let (mark, mut way, mut last, mut known) = (memo.mark(), Vec::new(), 0, (0.0, Ledger::default()));
                for (t, (signature, cost)) in passed.into_iter().enumerate() {
                    let key = signature.map(|signature| (t, signature));
                    let (number, new) = memo.arrivals(t).come_to(signature);
                    prop_assert_eq!(!new, key.is_some_and(|key| map.contains_key(&key)));
                    if !new {
                        (last, known) = (number, map[&key.unwrap_or_default()]);
                        prop_assert_eq!(memo.rest(number), known);
                        break;
                    }
                    way.push((number, key, cost));
                }
                // At every third step the expert acts, at every other something else is billed.
                let asked = |cost: u32| Ledger { labels: u64::from(cost), ..Ledger::default() };
                let billed = |cost: u32| match cost % 3 {
                    0 => Billed::Nothing,
                    1 => Billed::Act,
                    _ => Billed::More(asked(cost)),
                };
                let nexts = way.iter().skip(1).map(|(number, ..)| *number).chain([last]);
                for ((number, _, cost), next) in way.iter().zip(nexts) {
                    memo.arrivals(0).go_on(*number, f64::from(*cost), next, billed(*cost));
                }
                memo.settle(mark);
                for (number, key, cost) in way.into_iter().rev() {
                    known.0 += f64::from(cost);
                    match cost % 3 {
                        0 => {}
                        1 => {
                            known.1.rollout_acts += 1;
                            known.1.queries += 1;
                        }
                        _ => known.1 += asked(cost),
                    }
                    known.1.steps += 1;
                    prop_assert_eq!(memo.rest(number), known);
                    map.extend(key.map(|key| (key, known)));
                }
                memo.trim(mark);
            }
        }
    }
}
