//! A net of one hidden layer, over sparse binary features or over dense numbers.

use super::{Classifier, Columns, Linear, LinearMemory, Outputs};
use crate::space::{Dense, Features, Sight, View};

/// A net with one hidden layer: h = σ(b + W x), an output is c_o + v_o·h, and [`Outputs`] says what that is for an action. Without hidden units the
/// outputs are c + W x.
///
/// Its input layer goes with what it sees: for the sparse binary features at hand it is a [`Linear`] whose columns are units, so the sums over
/// the static part are remembered as there; for dense numbers it is [`Rows`].
#[derive(Clone, Debug, PartialEq)]
pub struct Neural<I = Linear> {
    /// How many actions there are.
    pub(crate) actions: usize,
    /// What the outputs are.
    pub(crate) outputs: Outputs,
    /// How many hidden units there are.
    pub(crate) units: usize,
    /// What goes into each unit, but for the bias.
    pub(crate) input: I,
    /// The units' biases b, the outputs' biases c, then `v[output, unit]`.
    pub(crate) dense: Vec<f32>,
}

impl<I> Neural<I> {
    /// How many numbers a net of `units` units and `outputs` outputs has beside those of the input.
    pub(crate) fn size(units: usize, outputs: usize) -> usize {
        units + outputs + units * outputs
    }

    /// How many units the hidden layer has.
    pub fn units(&self) -> usize {
        self.units
    }

    /// How many actions there are.
    pub fn actions(&self) -> usize {
        self.actions
    }

    /// What its outputs are.
    pub fn outputs(&self) -> Outputs {
        self.outputs
    }
}

/// The input layer of a net.
pub trait Layer<V: View>: Clone + Send + Sync {
    /// Scratch that a thread keeps between calls.
    type Memory: Default + Send;

    /// Makes `sums` zero, long enough for what goes into each unit and padding.
    fn clear(&self, sums: &mut Vec<f32>);

    /// Adds what goes into each unit at `sight` to `sums`.
    fn add(&self, sight: &Sight<'_, V>, sums: &mut [f32]);

    /// Writes what goes into each unit at `sight` into `sums`, with the help of what was computed before.
    fn sums(&self, sight: &Sight<'_, V>, _memory: &mut Self::Memory, sums: &mut Vec<f32>) {
        self.clear(sums);
        self.add(sight, sums);
    }
}

impl Layer<Features> for Linear {
    type Memory = LinearMemory;

    fn clear(&self, sums: &mut Vec<f32>) {
        sums.clear();
        sums.resize(self.weights.stride(), 0.0);
    }

    #[inline]
    fn add(&self, sight: &Sight<'_, Features>, sums: &mut [f32]) {
        self.weights.add_parts(sight.listed().parts(), 0, sums);
    }

    #[inline]
    fn sums(&self, sight: &Sight<'_, Features>, memory: &mut LinearMemory, sums: &mut Vec<f32>) {
        sums.clear();
        sums.extend_from_slice(memory.scores(Columns::Actions, self.actions, &self.weights, sight));
    }
}

/// Weights of dense input: `weights[input, unit]`, rows padded to eight.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    pub(crate) columns: usize,
    pub(crate) weights: Vec<f32>,
}

impl Rows {
    /// No weights yet for `width` numbers and `columns` units.
    pub(crate) fn new(width: usize, columns: usize) -> Self {
        Rows { columns, weights: vec![0.0; width * Self::padded(columns)] }
    }

    /// The length of a row of `columns` columns.
    fn padded(columns: usize) -> usize {
        columns.next_multiple_of(8).max(8)
    }

    /// The length of a row.
    pub(crate) fn stride(&self) -> usize {
        Self::padded(self.columns)
    }

    /// Adds up rows with the sums held in registers.
    #[inline]
    fn add_fixed<const N: usize>(&self, values: &[f32], sums: &mut [f32]) {
        let Some(sums) = sums.first_chunk_mut::<N>() else { return };
        let mut parts = *sums;
        for (x, row) in values.iter().zip(self.weights.as_chunks::<N>().0) {
            for c in 0..N {
                parts[c] += x * row[c];
            }
        }
        *sums = parts;
    }
}

impl Layer<Dense> for Rows {
    type Memory = ();

    fn clear(&self, sums: &mut Vec<f32>) {
        sums.clear();
        sums.resize(self.stride(), 0.0);
    }

    #[inline]
    fn add(&self, sight: &Sight<'_, Dense>, sums: &mut [f32]) {
        let values = &sight.view.0[..];
        match self.stride() {
            8 => self.add_fixed::<8>(values, sums),
            16 => self.add_fixed::<16>(values, sums),
            32 => self.add_fixed::<32>(values, sums),
            stride => {
                for (x, row) in values.iter().zip(self.weights.chunks_exact(stride)) {
                    sums.iter_mut().zip(row).for_each(|(sum, w)| *sum += x * w);
                }
            }
        }
    }
}

/// 1 / (1 + e^-x).
#[inline]
pub(crate) fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + (-x).exp())
}

/// Turns sums over the input into what the units give, and those into outputs; without units the sums are the outputs but for the bias.
pub(crate) fn forward(dense: &[f32], units: usize, sums: &mut [f32], outputs: &mut [f32]) {
    if units == 0 {
        outputs.iter_mut().zip(dense).zip(&*sums).for_each(|((out, offset), sum)| *out = offset + sum);
        return;
    }
    let (biases, rest) = dense.split_at(units);
    let (offsets, weights) = rest.split_at(outputs.len());
    let sums = &mut sums[..units];
    sums.iter_mut().zip(biases).for_each(|(h, bias)| *h = sigmoid(*h + bias));
    for ((out, offset), v) in outputs.iter_mut().zip(offsets).zip(weights.chunks_exact(units)) {
        *out = offset + dot(v, sums);
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
pub struct NeuralMemory<M = LinearMemory> {
    pub(crate) input: M,
    units: Vec<f32>,
    outputs: Vec<f32>,
    scores: Vec<f32>,
}

impl<M> NeuralMemory<M> {
    /// One score an action, from an input layer, the `dense` weights, and how many hidden units, what outputs and how many actions there are.
    pub(crate) fn scores<'m, V: View, I: Layer<V, Memory = M>>(
        &'m mut self,
        input: &I,
        dense: &[f32],
        (units, code, actions): (usize, Outputs, usize),
        sight: &Sight<'_, V>,
    ) -> &'m [f32] {
        input.sums(sight, &mut self.input, &mut self.units);
        self.outputs.resize(code.count(actions), 0.0);
        forward(dense, units, &mut self.units, &mut self.outputs);
        if code == Outputs::Actions {
            return &self.outputs;
        }
        code.scores(actions, &self.outputs, &mut self.scores);
        &self.scores
    }
}

impl<V: View, I: Layer<V>> Classifier<V> for Neural<I> {
    type Memory = NeuralMemory<I::Memory>;

    fn scores<'m>(&self, sight: &Sight<'_, V>, memory: &'m mut Self::Memory) -> &'m [f32] {
        memory.scores(&self.input, &self.dense, (self.units, self.outputs, self.actions), sight)
    }
}
