//! What learners learn from.

use crate::space::{Action, Actions, Gather, Store, View};
use std::collections::HashMap;
use std::ops::Range;

/// What is to be learned in a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target<'a> {
    /// The expert's action: every other one costs 1.
    Label(Action),
    /// What each legal action costs, in ascending order of the actions; only differences matter.
    Costs(&'a [f32]),
}

/// Examples: views, the actions that were legal in them and what is to be learned there. Costs and labels may stand side by side.
pub struct Examples<V: View> {
    views: V::Store,
    sets: Sets,
    legal: Vec<u32>,
    targets: Vec<Kept>,
    costs: Costs,
}

#[derive(Clone, Copy)]
enum Kept {
    Label(Action),
    CostsFrom(usize),
}

impl<V: View> Default for Examples<V> {
    fn default() -> Self {
        Examples {
            views: Default::default(),
            sets: Sets::default(),
            legal: Vec::new(),
            targets: Vec::new(),
            costs: Costs::default(),
        }
    }
}

impl<V: View> Examples<V> {
    /// Remembers one more.
    pub fn push(&mut self, view: &V, legal: Actions<'_>, target: Target<'_>) {
        self.views.push(view);
        self.legal.push(self.sets.number(legal));
        self.targets.push(match target {
            Target::Label(action) => Kept::Label(action),
            Target::Costs(costs) => Kept::CostsFrom(self.costs.keep(costs)),
        });
    }

    /// The costs of the last example, where it is one of costs: for what becomes known only after the state was left.
    pub fn last_costs_mut(&mut self) -> Option<&mut [f32]> {
        let legal = self.sets.get(*self.legal.last()?).len();
        match self.targets.last_mut()? {
            Kept::CostsFrom(start) => {
                *start = self.costs.own(*start..*start + legal);
                Some(&mut self.costs.all[*start..])
            }
            Kept::Label(_) => None,
        }
    }

    /// Forgets them all, but not what was legal in them: the same is likely to be so in the next.
    pub(crate) fn clear(&mut self) {
        self.views = Default::default();
        self.legal.clear();
        self.targets.clear();
        self.costs.all.clear();
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.targets.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.targets.is_empty()
    }

    /// The views.
    pub fn views(&self) -> &V::Store {
        &self.views
    }

    /// The actions that were legal in example `i`.
    #[inline]
    pub fn legal(&self, i: usize) -> Actions<'_> {
        self.sets.get(self.legal[i])
    }

    /// The sets of actions that were legal, in the order of their first occurrence.
    pub(super) fn sets(&self) -> impl Iterator<Item = Actions<'_>> {
        self.sets.lists.iter().map(Set::actions)
    }

    /// Which of them was that of example `i`.
    pub(super) fn set(&self, i: usize) -> u32 {
        self.legal[i]
    }

    /// Whether the same actions were legal in examples `i` and `j`.
    pub(super) fn same_legal(&self, i: usize, j: usize) -> bool {
        self.legal[i] == self.legal[j]
    }

    /// What is to be learned from example `i`.
    #[inline]
    pub fn target(&self, i: usize) -> Target<'_> {
        match self.targets[i] {
            Kept::Label(action) => Target::Label(action),
            Kept::CostsFrom(start) => Target::Costs(&self.costs.all[start..start + self.legal(i).len()]),
        }
    }
}

impl<V: View> Examples<V> {
    /// Appends a copy of all of `other`.
    pub fn extend_from(&mut self, other: &Self) {
        let numbers: Vec<u32> = other.sets.lists.iter().map(|kept| self.sets.number(kept.actions())).collect();
        self.views.extend_from(&other.views);
        self.legal.extend(other.legal.iter().map(|set| numbers[*set as usize]));
        let shift = self.costs.all.len();
        self.targets.extend(other.targets.iter().map(|kept| match kept {
            Kept::CostsFrom(start) => Kept::CostsFrom(start + shift),
            label => *label,
        }));
        self.costs.all.extend_from_slice(&other.costs.all);
        self.costs.shared = true; // whoever changes it makes a copy first
    }
}

impl<V: View> Gather for Examples<V> {
    fn absorb(&mut self, later: Self) {
        if self.is_empty() {
            *self = later;
        } else {
            self.extend_from(&later);
        }
    }
}

/// Lists of costs, one after the other. Many states have the same: one that was kept not long ago is not kept again.
#[derive(Default)]
struct Costs {
    all: Vec<f32>,
    /// Where a list of this hash was kept last: a guess that is always checked.
    guesses: Vec<usize>,
    /// Whether the last that was asked for may be that of others, too.
    shared: bool,
}

impl Costs {
    /// Where these costs are kept.
    fn keep(&mut self, costs: &[f32]) -> usize {
        let (_, sums) = costs.iter().fold((0.0, 0.0), |(sum, sums): (f32, f32), cost| (sum + cost, sums + sum));
        let hash = u64::from(sums.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.guesses.resize(256, 0);
        let guess = &mut self.guesses[(hash >> 56) as usize];
        let same = |known: &[f32]| known.iter().zip(costs).all(|(a, b)| a.to_bits() == b.to_bits());
        self.shared = self.all.get(*guess..*guess + costs.len()).is_some_and(same);
        if !self.shared {
            *guess = self.all.len();
            self.all.extend_from_slice(costs);
        }
        *guess
    }

    /// Where the costs at this place, the last that were kept, are kept for nobody else.
    fn own(&mut self, place: Range<usize>) -> usize {
        if !std::mem::take(&mut self.shared) {
            return place.start;
        }
        self.all.extend_from_within(place.clone());
        self.all.len() - place.len()
    }
}

/// Sets of legal actions, numbered in the order of their first occurrence: few sets serve many examples.
#[derive(Default)]
struct Sets {
    lists: Vec<Set>,
    numbers: HashMap<Box<[Action]>, u32>,
    /// Where a list at this address was found last: a guess that is always checked.
    guesses: [u32; 32],
}

enum Set {
    All(u32),
    Only(Box<[Action]>),
}

impl Set {
    fn actions(&self) -> Actions<'_> {
        match self {
            Set::All(n) => Actions::All(*n),
            Set::Only(list) => Actions::Only(list),
        }
    }
}

impl Sets {
    fn get(&self, number: u32) -> Actions<'_> {
        self.lists[number as usize].actions()
    }

    fn number(&mut self, actions: Actions<'_>) -> u32 {
        let next = self.lists.len() as u32;
        match actions {
            Actions::All(n) => {
                let known = self.lists.iter().position(|set| matches!(set, Set::All(m) if *m == n));
                known.map(|at| at as u32).unwrap_or_else(|| {
                    self.lists.push(Set::All(n));
                    next
                })
            }
            Actions::Only(list) => {
                let guess = &mut self.guesses[(list.as_ptr() as usize >> 4) % 32];
                if let Some(Set::Only(known)) = self.lists.get(*guess as usize)
                    && **known == *list
                {
                    return *guess;
                }
                *guess = *self.numbers.entry(list.into()).or_insert_with(|| {
                    self.lists.push(Set::Only(list.into()));
                    next
                });
                *guess
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Features;
    use proptest::prelude::*;

    /// What happens to examples.
    #[derive(Clone, Debug)]
    enum Event {
        Label(u32),
        Costs(Vec<f32>),
        /// The last costs change, if the last example has some.
        Change(f32),
        /// All that follows is gathered apart, and put behind what was there.
        Absorb,
    }

    fn events() -> impl Strategy<Value = Vec<Event>> {
        let cost = || prop_oneof![Just(0.0f32), Just(1.0), Just(-0.0), Just(f32::NAN)];
        let event = prop_oneof![
            1 => (0..3u32).prop_map(Event::Label),
            6 => prop::collection::vec(cost(), 1..4).prop_map(Event::Costs),
            2 => cost().prop_map(Event::Change),
            1 => Just(Event::Absorb),
        ];
        prop::collection::vec(event, 0..60)
    }

    proptest! {
        /// Costs that are kept once for many examples are each example's own to the bit, whatever becomes of the others.
        #[test]
        fn targets_are_those_that_were_put_in(events in events()) {
            let (mut examples, mut part, mut expected) = (Examples::<Features>::default(), Examples::default(), Vec::new());
            for event in events {
                match event {
                    Event::Label(label) => {
                        part.push(&Features::default(), Actions::All(3), Target::Label(Action(label)));
                        expected.push(Err(label));
                    }
                    Event::Costs(costs) => {
                        part.push(&Features::default(), Actions::All(costs.len() as u32), Target::Costs(&costs));
                        expected.push(Ok(costs));
                    }
                    Event::Change(by) => {
                        if let Some(costs) = part.last_costs_mut() {
                            costs[0] = by;
                            let Some(Ok(last)) = expected.last_mut() else { panic!("there are no such costs") };
                            last[0] = by;
                        }
                    }
                    Event::Absorb => examples.absorb(std::mem::take(&mut part)),
                }
            }
            examples.absorb(part);
            prop_assert_eq!(examples.len(), expected.len());
            for (i, expected) in expected.iter().enumerate() {
                match (examples.target(i), expected) {
                    (Target::Label(label), Err(expected)) => prop_assert_eq!(label.0, *expected),
                    (Target::Costs(costs), Ok(expected)) => {
                        let bits = |costs: &[f32]| costs.iter().map(|cost| cost.to_bits()).collect::<Vec<u32>>();
                        prop_assert_eq!(bits(costs), bits(expected));
                    }
                    _ => prop_assert!(false, "example {i} is of another kind"),
                }
            }
        }
    }
}
