//! What learners learn from.

use crate::space::{Action, Actions, Gather, Store, View};
use std::collections::HashMap;

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
    costs: Vec<f32>,
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
            costs: Vec::new(),
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
            Target::Costs(costs) => {
                self.costs.extend_from_slice(costs);
                Kept::CostsFrom(self.costs.len() - costs.len())
            }
        });
    }

    /// The costs of the last example, where it is one of costs: for what becomes known only after the state was left.
    pub fn last_costs_mut(&mut self) -> Option<&mut [f32]> {
        match self.targets.last()? {
            Kept::CostsFrom(start) => Some(&mut self.costs[*start..]),
            Kept::Label(_) => None,
        }
    }

    /// Forgets them all, but not what was legal in them: the same is likely to be so in the next.
    pub(crate) fn clear(&mut self) {
        self.views = Default::default();
        self.legal.clear();
        self.targets.clear();
        self.costs.clear();
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
            Kept::CostsFrom(start) => Target::Costs(&self.costs[start..start + self.legal(i).len()]),
        }
    }
}

impl<V: View> Examples<V> {
    /// Appends a copy of all of `other`.
    pub fn extend_from(&mut self, other: &Self) {
        let numbers: Vec<u32> = other.sets.lists.iter().map(|kept| self.sets.number(kept.actions())).collect();
        self.views.extend_from(&other.views);
        self.legal.extend(other.legal.iter().map(|set| numbers[*set as usize]));
        let shift = self.costs.len();
        self.targets.extend(other.targets.iter().map(|kept| match kept {
            Kept::CostsFrom(start) => Kept::CostsFrom(start + shift),
            label => *label,
        }));
        self.costs.extend_from_slice(&other.costs);
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
