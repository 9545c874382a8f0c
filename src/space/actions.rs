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
        // Score and action in one number: which of two is greater needs no branch, and nothing is guessed wrong.
        let key = |a: u32| (i64::from(ordered(score(Action(a)))) << 32) | i64::from(!a);
        let best = match self {
            Actions::All(n) => (0..n).map(key).max(),
            Actions::Only(list) => list.iter().map(|a| key(a.0)).max(),
        };
        Action(best.map_or(0, |key| !(key as u32)))
    }
}

/// A number that is greater where `score` is, and least where it is not a number.
#[inline]
fn ordered(score: f32) -> i32 {
    // Adding zero makes one of both zeros.
    let bits = (score + 0.0).to_bits() as i32;
    if score.is_nan() { i32::MIN } else { bits ^ ((bits >> 31) as u32 >> 1) as i32 }
}

#[cfg(test)]
mod tests {
    use super::*;

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
