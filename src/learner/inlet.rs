//! The input layers of nets in the making: one for sparse binary features, one for dense numbers.

use super::kept::{put_weights, take_full, take_layer};
use super::{Kept, Setting};
use crate::output::Arrays;
use crate::policy::{Columns, Layer, Linear, Rows, Weights};
use crate::seed::{Purpose, Seed};
use crate::space::{Dense, Features, Sight, View};
use rand::RngExt;

/// What is kept of weights beside them: their gradient in the batch, its running mean and that of its square, one behind the other, each as
/// long as the weights.
pub(super) const BESIDE: usize = 3;

/// A view that a net can have for its input.
pub trait Sensed: View {
    /// The input layer.
    type Layer: Layer<Self>;
    /// The same in the making.
    type Inlet: Inlet<Self>;
}

impl Sensed for Features {
    type Layer = Linear;
    type Inlet = Sparse;
}

impl Sensed for Dense {
    type Layer = Rows;
    type Inlet = Full;
}

/// An input layer in the making: its weights and what is kept beside them.
pub trait Inlet<V: Sensed>: Clone + Send + Sync {
    /// A layer of `columns` units for this setting: that of a net that was learned before, or a new one.
    fn begin(setting: Setting<'_, V>, columns: usize, warm: Option<&V::Layer>) -> Self;

    /// The layer as it is now.
    fn layer(&self) -> &V::Layer;

    /// Draws, below `seed`, first weights for what is seen at `sight` for the first time.
    fn meet(&mut self, sight: &Sight<'_, V>, seed: Seed);

    /// Adds to the batch's gradient: `slopes` are those of the loss at what goes into the units, padding included.
    fn learn(&mut self, sight: &Sight<'_, V>, slopes: &[f32]);

    /// Hands weights that may have a gradient to `change`, with what is kept beside them; the next batch begins.
    fn step(&mut self, change: impl FnMut(&mut [f32], &mut [f32]));

    /// What has been learned.
    fn finish(self) -> V::Layer;

    /// Appends all of it to a checkpoint: see [`Kept`].
    fn put(&self, to: &mut Vec<u8>);

    /// A layer of `columns` units for this setting as it was put; `None` when that is not what stands there.
    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>, columns: usize) -> Option<Self>;
}

/// Numbers drawn evenly from ±`scale`.
fn draw(weights: &mut [f32], scale: f32, seed: Seed) {
    let mut rng = seed.rng();
    weights.iter_mut().for_each(|w| *w = scale * (2.0 * rng.random::<f32>() - 1.0));
}

/// Weights of sparse binary features: only those that have been seen have any.
#[derive(Clone, Debug)]
pub struct Sparse {
    layer: Linear,
    /// What is kept beside the weights, row after row as there.
    beside: Vec<f32>,
    /// The features of the batch, each once, in the order of their first occurrence.
    pub(super) touched: Vec<u32>,
    /// The last batch each feature was in, from 1.
    batches: Vec<u32>,
    /// The number of the batch at hand, from 1.
    time: u32,
    /// In which of the examples that are not in the gradient yet each feature is: a bit each.
    seen: Vec<u64>,
    /// The slopes of those examples, one after the other.
    slopes: Vec<f32>,
}

impl Sparse {
    /// A layer with what is kept beside its weights; then what it has touched, the last batches of the features, and the number of this one.
    fn of((layer, beside): (Linear, Vec<f32>), (touched, batches, time): (Vec<u32>, Vec<u32>, u32)) -> Self {
        Sparse { layer, beside, touched, seen: vec![0; batches.len()], batches, time, slopes: Vec::new() }
    }

    /// The weights of `feature` and what is kept beside them.
    pub(super) fn row(&mut self, feature: u32) -> (&mut [f32], &mut [f32]) {
        let weights = &mut self.layer.weights;
        let (place, width) = (weights.make_place(feature), BESIDE * weights.stride());
        if self.beside.len() < (place + 1) * width {
            self.beside.resize((place + 1) * width, 0.0);
        }
        (weights.row_mut(feature), &mut self.beside[place * width..(place + 1) * width])
    }

    /// Adds what was seen of `feature`, with these slopes, to its gradient, so that a row is read and written once and not once an example; gives its
    /// weights and what is kept beside them.
    fn sum_up(&mut self, feature: u32, slopes: &[f32]) -> (&mut [f32], &mut [f32]) {
        let seen = std::mem::take(&mut self.seen[feature as usize]);
        let stride = self.layer.weights.stride();
        let (weights, gradient) = self.row(feature);
        match stride {
            8 => add_rows::<8>(seen, slopes, gradient),
            16 => add_rows::<16>(seen, slopes, gradient),
            32 => add_rows::<32>(seen, slopes, gradient),
            _ => each_bit(seen, |example| {
                let slopes = &slopes[example * stride..(example + 1) * stride];
                gradient.iter_mut().zip(slopes).for_each(|(g, slope)| *g += slope);
            }),
        }
        (weights, gradient)
    }

    /// Adds all that was seen to the gradient.
    pub(super) fn sum_all(&mut self) {
        let mut slopes = std::mem::take(&mut self.slopes);
        for i in 0..self.touched.len() {
            self.sum_up(self.touched[i], &slopes);
        }
        slopes.clear();
        self.slopes = slopes;
    }
}

/// Calls `each` with the number of every bit that is set, in their order.
fn each_bit(mut bits: u64, mut each: impl FnMut(usize)) {
    while bits != 0 {
        each(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

/// Adds the slopes of the examples in `seen` to a row, held in registers.
fn add_rows<const N: usize>(seen: u64, slopes: &[f32], row: &mut [f32]) {
    let Some(row) = row.first_chunk_mut::<N>() else { return };
    let (mut sums, slopes) = (*row, slopes.as_chunks::<N>().0);
    each_bit(seen, |example| (0..N).for_each(|c| sums[c] += slopes[example][c]));
    *row = sums;
}

impl Inlet<Features> for Sparse {
    fn begin(setting: Setting<'_, Features>, columns: usize, warm: Option<&Linear>) -> Self {
        let features = setting.shared.features();
        let layer = Linear { actions: columns, columns: Columns::Actions, weights: Weights::new(features, columns) };
        let mut inlet = Sparse::of((layer, Vec::new()), (Vec::new(), vec![0; features], 1));
        if let Some(warm) = warm {
            for feature in 0..warm.weights.features() as u32 {
                if let Some(row) = warm.weights.row(feature) {
                    inlet.row(feature).0.copy_from_slice(row);
                }
            }
        }
        inlet
    }

    fn layer(&self) -> &Linear {
        &self.layer
    }

    fn meet(&mut self, sight: &Sight<'_, Features>, seed: Seed) {
        for feature in sight.listed().iter() {
            if self.layer.weights.row(feature).is_none() {
                let scale = 1.0 / (sight.listed().len() as f32).sqrt();
                let columns = self.layer.actions;
                let (row, _) = self.row(feature);
                draw(&mut row[..columns], scale, seed.child(Purpose::Learner, u64::from(feature)));
            }
        }
    }

    fn learn(&mut self, sight: &Sight<'_, Features>, slopes: &[f32]) {
        let own = 1 << (self.slopes.len() / slopes.len());
        for feature in sight.listed().iter() {
            let seen = self.seen[feature as usize];
            self.seen[feature as usize] = seen | own;
            if seen & own != 0 {
                // One that stands twice counts twice.
                self.row(feature).1.iter_mut().zip(slopes).for_each(|(g, slope)| *g += slope);
            } else if seen == 0 && std::mem::replace(&mut self.batches[feature as usize], self.time) != self.time {
                self.touched.push(feature);
            }
        }
        self.slopes.extend_from_slice(slopes);
        if own == 1 << (u64::BITS - 1) {
            self.sum_all();
        }
    }

    fn step(&mut self, mut change: impl FnMut(&mut [f32], &mut [f32])) {
        let (mut touched, mut slopes) = (std::mem::take(&mut self.touched), std::mem::take(&mut self.slopes));
        for feature in touched.drain(..) {
            let (weights, beside) = self.sum_up(feature, &slopes);
            change(weights, beside);
        }
        slopes.clear();
        (self.touched, self.slopes) = (touched, slopes);
        self.time += 1;
    }

    fn finish(self) -> Linear {
        Linear { weights: self.layer.weights.map_rows(|_, _| {}), ..self.layer }
    }

    fn put(&self, to: &mut Vec<u8>) {
        let mut whole = self.clone();
        whole.sum_all();
        put_weights(&whole.layer.weights, to);
        Kept::<Features>::put(&whole.beside, to);
        Kept::<Features>::put(&whole.touched, to);
        Kept::<Features>::put(&whole.batches, to);
        Kept::<Features>::put(&whole.time, to);
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, Features>, columns: usize) -> Option<Self> {
        let layer = take_layer(from, setting, columns)?;
        let (beside, (touched, (batches, time))) = <(_, (Vec<u32>, (Vec<u32>, _)))>::take(from, setting)?;
        let features = setting.shared.features();
        let counted = time <= u32::MAX / 2;
        let possible =
            counted && batches.len() == features && touched.iter().all(|feature| (*feature as usize) < features);
        possible.then(|| Sparse::of((layer, beside), (touched, batches, time)))
    }
}

/// Weights of dense numbers.
#[derive(Clone, Debug)]
pub struct Full {
    layer: Rows,
    /// What is kept beside the weights: three times as much.
    beside: Vec<f32>,
    drawn: bool,
    /// What was seen in the batch, and the slopes: example after example. The gradient is summed up row by row at the batch's end, so that each of
    /// its rows is read and written once a batch and not once an example.
    seen: Vec<f32>,
    slopes: Vec<f32>,
}

impl Full {
    /// Adds what was seen to the gradient.
    fn sum_up(&mut self) {
        let stride = self.layer.stride();
        let gradient = &mut self.beside[..self.layer.weights.len()];
        match stride {
            8 => add_products::<8>(&self.seen, &self.slopes, gradient),
            16 => add_products::<16>(&self.seen, &self.slopes, gradient),
            32 => add_products::<32>(&self.seen, &self.slopes, gradient),
            _ => {
                let width = gradient.len() / stride;
                for (seen, slopes) in self.seen.chunks_exact(width.max(1)).zip(self.slopes.chunks_exact(stride)) {
                    for (x, row) in seen.iter().zip(gradient.chunks_exact_mut(stride)) {
                        row.iter_mut().zip(slopes).for_each(|(g, slope)| *g += x * slope);
                    }
                }
            }
        }
        self.seen.clear();
        self.slopes.clear();
    }
}

/// Adds to each row of the gradient the sum over the examples of a number times the slopes, held in registers.
fn add_products<const N: usize>(seen: &[f32], slopes: &[f32], gradient: &mut [f32]) {
    let (rows, slopes) = (gradient.as_chunks_mut::<N>().0, slopes.as_chunks::<N>().0);
    let width = rows.len();
    for (i, row) in rows.iter_mut().enumerate() {
        let mut sums = *row;
        for (x, slopes) in seen.iter().skip(i).step_by(width).zip(slopes) {
            for c in 0..N {
                sums[c] += x * slopes[c];
            }
        }
        *row = sums;
    }
}

#[cfg(test)]
impl Full {
    /// The weights and what is kept beside them.
    pub(super) fn parts(&mut self) -> (&mut [f32], &mut [f32]) {
        self.sum_up();
        (&mut self.layer.weights, &mut self.beside)
    }
}

impl Inlet<Dense> for Full {
    fn begin(setting: Setting<'_, Dense>, columns: usize, warm: Option<&Rows>) -> Self {
        let new = Rows::new(setting.shared.0, columns);
        let warm = warm.filter(|warm| warm.columns == columns && warm.weights.len() == new.weights.len());
        let (layer, drawn) = (warm.cloned().unwrap_or(new), warm.is_some());
        let beside = vec![0.0; BESIDE * layer.weights.len()];
        Full { layer, beside, drawn, seen: Vec::new(), slopes: Vec::new() }
    }

    fn layer(&self) -> &Rows {
        &self.layer
    }

    fn meet(&mut self, sight: &Sight<'_, Dense>, seed: Seed) {
        if !std::mem::replace(&mut self.drawn, true) {
            let (stride, columns) = (self.layer.stride(), self.layer.columns);
            let scale = 1.0 / (sight.view.0.len().max(1) as f32).sqrt();
            for (i, row) in self.layer.weights.chunks_exact_mut(stride).enumerate() {
                draw(&mut row[..columns], scale, seed.child(Purpose::Learner, i as u64));
            }
        }
    }

    fn learn(&mut self, sight: &Sight<'_, Dense>, slopes: &[f32]) {
        self.seen.extend_from_slice(&sight.view.0);
        self.slopes.extend_from_slice(slopes);
    }

    fn step(&mut self, mut change: impl FnMut(&mut [f32], &mut [f32])) {
        self.sum_up();
        change(&mut self.layer.weights, &mut self.beside);
    }

    fn finish(self) -> Rows {
        self.layer
    }

    fn put(&self, to: &mut Vec<u8>) {
        Kept::<Dense>::put(&self.layer.weights, to);
        Kept::<Dense>::put(&self.beside, to);
        Kept::<Dense>::put(&self.drawn, to);
        Kept::<Dense>::put(&self.seen, to);
        Kept::<Dense>::put(&self.slopes, to);
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, Dense>, columns: usize) -> Option<Self> {
        let layer = take_full(from, setting, columns)?;
        let (beside, (drawn, (seen, slopes))) = <(Vec<f32>, (_, (_, _)))>::take(from, setting)?;
        let possible = beside.len() == BESIDE * layer.weights.len();
        possible.then_some(Full { layer, beside, drawn, seen, slopes })
    }
}
