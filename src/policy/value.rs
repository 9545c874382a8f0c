//! A predicted value, and the action nearest to it.

use super::{Classifier, Linear, LinearMemory};
use crate::space::{Features, Sight};

/// For continuous actions: a space cuts an interval into classes, action a of k is the value low + (high - low) a / (k - 1), and this classifier
/// predicts a value and takes the legal action nearest to it, the lowest of equals. Scores are distances with the sign turned.
#[derive(Clone, Debug, PartialEq)]
pub struct Valued {
    /// One column: the predicted value.
    pub(crate) value: Linear,
    /// The values of the lowest and the highest action.
    pub(crate) interval: (f32, f32),
    pub(crate) actions: usize,
}

/// The value of action `a` of `k`.
pub(crate) fn value_of((low, high): (f32, f32), a: usize, k: usize) -> f32 {
    low + (high - low) * a as f32 / (k - 1).max(1) as f32
}

impl Valued {
    /// The value predicted at `sight`, as it is: it may lie between two actions, or outside the interval.
    pub fn predict(&self, sight: &Sight<'_, Features>, memory: &mut ValuedMemory) -> f32 {
        self.value.scores(sight, &mut memory.value).first().copied().unwrap_or(0.0)
    }
}

/// A thread's scratch for a [`Valued`].
#[derive(Default)]
pub struct ValuedMemory {
    value: LinearMemory,
    scores: Vec<f32>,
}

impl Classifier<Features> for Valued {
    type Memory = ValuedMemory;

    fn scores<'m>(&self, sight: &Sight<'_, Features>, memory: &'m mut ValuedMemory) -> &'m [f32] {
        let value = self.predict(sight, memory);
        memory.scores.clear();
        let distance = |a| -(value_of(self.interval, a, self.actions) - value).abs();
        memory.scores.extend((0..self.actions).map(distance));
        &memory.scores
    }
}
