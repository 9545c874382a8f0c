//! Actions and sets of legal actions.

use serde::{Deserialize, Serialize};

/// One of a space's actions, numbered from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Action(pub u32);

impl Action {
    /// The action as an index.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// The actions that are legal in a state.
#[derive(Clone, Copy, Debug)]
pub enum Actions<'a> {
    /// Actions 0 to n-1.
    All(u32),
    /// These, in ascending order.
    Only(&'a [Action]),
}

impl<'a> Actions<'a> {
    /// No action: the episode is over.
    pub const NONE: Actions<'static> = Actions::All(0);

    /// How many.
    #[inline]
    pub fn len(self) -> usize {
        match self {
            Actions::All(n) => n as usize,
            Actions::Only(list) => list.len(),
        }
    }

    /// Whether the episode is over.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// The action at `place` in ascending order.
    #[inline]
    pub fn nth(self, place: usize) -> Action {
        match self {
            Actions::All(_) => Action(place as u32),
            Actions::Only(list) => list[place],
        }
    }

    /// Where `action` stands in ascending order, if it is legal.
    #[inline]
    pub fn place(self, action: Action) -> Option<usize> {
        match self {
            Actions::All(n) => (action.0 < n).then_some(action.index()),
            Actions::Only(list) => list.binary_search(&action).ok(),
        }
    }

    /// Whether `action` is among them.
    #[inline]
    pub fn contains(self, action: Action) -> bool {
        self.place(action).is_some()
    }

    /// All of them, ascending.
    #[inline]
    pub fn iter(self) -> impl ExactSizeIterator<Item = Action> + 'a {
        (0..self.len()).map(move |place| self.nth(place))
    }

    /// The legal action with the highest score, the lowest of equals. `scores[a]`, one for each action of the space. An
    /// incomparable score (NaN) never wins against a number.
    #[inline]
    pub fn best(self, scores: &[f32]) -> Action {
        self.best_by(|a| scores[a.index()])
    }

    /// The same by what `score` says.
    #[inline]
    pub(crate) fn best_by(self, score: impl Fn(Action) -> f32) -> Action {
        let (mut best, mut high) = (Action(0), f32::NEG_INFINITY);
        // Written so that it takes no branch, and nothing is guessed wrong.
        let mut meet = |a: Action| {
            let score = score(a);
            best = if score > high { a } else { best };
            high = if score > high { score } else { high };
        };
        match self {
            Actions::All(n) => (0..n).for_each(|a| meet(Action(a))),
            Actions::Only(list) => list.iter().for_each(|a| meet(*a)),
        }
        self.or_lowest(best, high, score)
    }

    /// The same action and its score, and the highest score of all others: negative infinity where there are none, and no less than what it is where some
    /// cannot be compared.
    #[inline]
    pub(crate) fn best_two_by(self, score: impl Fn(Action) -> f32) -> (Action, f32, f32) {
        let (mut best, mut high, mut second) = (Action(0), f32::NEG_INFINITY, f32::NEG_INFINITY);
        // Written so that it takes no branch, and nothing is guessed wrong.
        let mut meet = |a: Action| {
            let score = score(a);
            let lower = if score < high { score } else { high };
            second = if lower > second { lower } else { second };
            best = if score > high { a } else { best };
            high = if score > high { score } else { high };
        };
        match self {
            Actions::All(n) => (0..n).for_each(|a| meet(Action(a))),
            Actions::Only(list) => list.iter().for_each(|a| meet(*a)),
        }
        best = self.or_lowest(best, high, &score);
        high = if high == f32::NEG_INFINITY && !self.is_empty() { score(best) } else { high };
        (best, high, second)
    }

    /// The `best` one, whose score is `high`, or, where no score is higher than negative infinity, the lowest that has this one.
    #[inline]
    fn or_lowest(self, best: Action, high: f32, score: impl Fn(Action) -> f32) -> Action {
        if high > f32::NEG_INFINITY || self.is_empty() {
            return best;
        }
        self.iter().find(|a| score(*a) == high).unwrap_or(self.nth(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The best, its score and the next best score are those of a list in order, for scores of any kind.
        #[test]
        fn best_two_are_those_of_a_list_in_order(
            legal in prop::collection::btree_set(0..40u32, 1..40),
            scores in prop::collection::vec(
                prop_oneof![-2..3i8, Just(99), Just(-99)].prop_map(|n| match n { 99 => f32::NAN, -99 => f32::NEG_INFINITY, n => f32::from(n) }),
                40,
            ),
            all: bool,
        ) {
            let list: Vec<Action> = legal.iter().map(|a| Action(*a)).collect();
            let legal = if all { Actions::All(list.len() as u32) } else { Actions::Only(&list) };
            // Those that cannot be compared come last; of equals the lowest comes first.
            let mut ranked: Vec<Action> = legal.iter().collect();
            let score = |a: Action| scores[a.index()];
            ranked.sort_by(|a, b| score(*a).is_nan().cmp(&score(*b).is_nan()).then(score(*b).partial_cmp(&score(*a)).unwrap_or(a.cmp(b))));
            let (best, high, second) = legal.best_two_by(score);
            prop_assert_eq!((best, high.to_bits()), (ranked[0], score(ranked[0]).to_bits()));
            let next = ranked.get(1).map_or(f32::NEG_INFINITY, |a| score(*a)).max(f32::NEG_INFINITY);
            prop_assert!(second >= next);
            prop_assert!(second == next || legal.iter().any(|a| score(a).is_nan()));
        }
    }

    #[test]
    fn ties_go_to_the_lowest() {
        assert_eq!(Actions::All(3).best(&[1.0, 2.0, 2.0]), Action(1));
        assert_eq!(Actions::Only(&[Action(0), Action(2)]).best(&[1.0, 2.0, 1.0]), Action(0));
        assert_eq!(Actions::All(2).best(&[f32::NAN, f32::NAN]), Action(0));
        assert_eq!(Actions::All(2).best(&[f32::NAN, 0.0]), Action(1));
        assert_eq!(Actions::All(3).best(&[f32::NEG_INFINITY, -2.0, -1.0]), Action(2));
        assert_eq!(Actions::All(3).best(&[f32::NAN, f32::NEG_INFINITY, -f32::NAN]), Action(1));
        assert_eq!(Actions::All(2).best(&[-0.0, 0.0]), Action(0));
    }

    #[test]
    fn places() {
        let some = Actions::Only(&[Action(1), Action(4)]);
        assert_eq!(some.place(Action(4)), Some(1));
        assert!(!some.contains(Action(2)));
        assert_eq!(some.iter().collect::<Vec<_>>(), [Action(1), Action(4)]);
        assert!(Actions::NONE.is_empty());
    }
}
