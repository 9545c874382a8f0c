//! A net of one hidden layer over sparse binary features.

use super::{Classifier, Columns, Linear, LinearMemory, Weights};
use crate::space::{Features, Sight};

/// A net with one hidden layer: h = σ(b + W x), an action's score is c_a + v_a·h. Its input is the sparse binary features at hand, so the hidden layer
/// is a [`Linear`] whose columns are units, and the sums over the static part are remembered as there.
#[derive(Clone, Debug, PartialEq)]
pub struct Neural {
    /// What goes into each unit of the hidden layer, but for the bias: `weights[feature, unit]`.
    pub(crate) input: Linear,
    /// The units' biases b, the actions' biases c, then `v[action, unit]`.
    pub(crate) dense: Vec<f32>,
}

impl Neural {
    /// How many numbers a net of `units` units and `actions` actions has beside those of the input.
    pub(crate) fn size(units: usize, actions: usize) -> usize {
        units + actions + units * actions
    }

    /// How many units the hidden layer has.
    pub fn units(&self) -> usize {
        self.input.actions
    }

    /// How many actions there are.
    pub fn actions(&self) -> usize {
        (self.dense.len() - self.units()) / (1 + self.units())
    }
}

/// 1 / (1 + e^-x).
#[inline]
pub(crate) fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + (-x).exp())
}

/// Turns sums over the input into what the units give, and those into `scores[action]`.
pub(crate) fn forward(dense: &[f32], sums: &mut [f32], scores: &mut [f32]) {
    let units = sums.len();
    let (biases, rest) = dense.split_at(units);
    let (offsets, outputs) = rest.split_at(scores.len());
    sums.iter_mut().zip(biases).for_each(|(h, bias)| *h = sigmoid(*h + bias));
    for ((score, offset), v) in scores.iter_mut().zip(offsets).zip(outputs.chunks_exact(units.max(1))) {
        *score = offset + dot(v, sums);
    }
}

/// The inner product, summed up in eight parts: the order of addition is fixed and can still be done at once.
#[inline]
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut parts = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for i in 0..8 {
            parts[i] += a[i] * b[i];
        }
    }
    parts.iter().sum::<f32>() + a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f32>()
}

/// A thread's scratch for a net.
#[derive(Default)]
pub struct NeuralMemory {
    input: LinearMemory,
    units: Vec<f32>,
    scores: Vec<f32>,
}

impl NeuralMemory {
    /// One score for each of `actions` actions, from the weights of `units` units and the `dense` ones.
    pub(crate) fn scores<'m>(
        &'m mut self,
        (input, dense): (&Weights, &[f32]),
        (units, actions): (usize, usize),
        sight: &Sight<'_, Features>,
    ) -> &'m [f32] {
        self.units.clear();
        self.units.extend_from_slice(self.input.scores(Columns::Actions, units, input, sight));
        self.scores.resize(actions, 0.0);
        forward(dense, &mut self.units, &mut self.scores);
        &self.scores
    }
}

impl Classifier<Features> for Neural {
    type Memory = NeuralMemory;

    fn scores<'m>(&self, sight: &Sight<'_, Features>, memory: &'m mut NeuralMemory) -> &'m [f32] {
        memory.scores((&self.input.weights, &self.dense), (self.units(), self.actions()), sight)
    }
}
