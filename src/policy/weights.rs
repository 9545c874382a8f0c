//! The weights of linear classifiers: a row a feature.

use super::Columns;
use crate::space::{Actions, FeatureTable};
use std::ops::Range;

/// Rows of weights, one for each feature that has any, each contiguous over the columns and padded to eight.
#[derive(Clone, Debug)]
pub struct Weights {
    columns: usize,
    stride: usize,
    /// The row of a feature; 0 when it has none.
    index: Vec<u32>,
    /// The rows of the features below this are in their order, the first of them at 1: nothing has to be looked up. That is what a model is read as.
    straight: u32,
    /// Row r, column c at r * stride + c. Row 0 is all zero.
    rows: Vec<f32>,
    /// Whether it is known how far rows can move one column against another.
    pub(super) measured: bool,
    /// How far each of them can, at most; infinite where it was not measured, empty where none was or no dynamic feature is ever seen.
    reach: Vec<f32>,
    /// The first dynamic feature, and how many of them a view has at most.
    beyond: (u32, usize),
    /// How far any row of these reached since they were measured, at most.
    furthest: f32,
    /// How many of these are changed and not measured again.
    unmeasured: usize,
    /// How often a row was handed out to be changed.
    pub(super) version: u64,
}

/// Equal weights: whether they were measured, and how they came about, does not count.
impl PartialEq for Weights {
    fn eq(&self, other: &Self) -> bool {
        self.columns == other.columns && self.index == other.index && self.rows == other.rows
    }
}

/// What rounding can add, at most, to a sum of up to [`MOST_ADDED`] numbers for each unit of what is added.
pub(super) const ROUNDING: f32 = 1e-4;
/// Rows of as many columns are summed up whole.
const WIDEST: usize = 1 << 19;
/// More features than this are not weighed against a margin.
pub(super) const MOST_ADDED: usize = 400;

/// How far `row` can move one column against another: the range of its weights and zero, and what rounding makes of it. Not a number where that
/// is not finite.
fn reach(row: &[f32]) -> f32 {
    let (mut low, mut high, mut odd) = ([0f32; 8], [0f32; 8], [0f32; 8]);
    for part in row.as_chunks::<8>().0 {
        for c in 0..8 {
            low[c] = if part[c] < low[c] { part[c] } else { low[c] };
            high[c] = if part[c] > high[c] { part[c] } else { high[c] };
            odd[c] += part[c] * 0.0;
        }
    }
    let range = high.into_iter().fold(0.0, f32::max) - low.into_iter().fold(0.0, f32::min);
    let reach = range * (1.0 + ROUNDING) + odd.into_iter().sum::<f32>();
    if reach.is_finite() { reach } else { f32::NAN }
}

/// The larger one, or the one that is not a number.
fn further(a: f32, b: f32) -> f32 {
    if b <= a || a.is_nan() { a } else { b }
}

/// More bytes than this are not taken up before they are needed.
const MOST_RESERVED: usize = 1 << 30;

/// Takes up room for `more` elements, if that is not too much and there is any: memory that nobody writes to costs nothing, and what grows there need not
/// be moved.
pub(crate) fn reserve_some<T>(list: &mut Vec<T>, more: usize) {
    // Where there is no such room the list grows step by step.
    let _ = list.try_reserve_exact(more.min(MOST_RESERVED / size_of::<T>()));
}

impl Weights {
    /// No weights, for `features` features.
    pub fn new(features: usize, columns: usize) -> Self {
        let stride = columns.next_multiple_of(8).max(8);
        let (index, rows) = (vec![0; features], vec![0.0; stride]);
        Weights {
            columns,
            stride,
            index,
            straight: 0,
            rows,
            measured: false,
            reach: Vec::new(),
            beyond: (0, 0),
            furthest: 0.0,
            unmeasured: 0,
            version: 0,
        }
    }

    /// How many columns a row has, padding left out.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The length of a row, padding included: a multiple of eight.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// How many features there are, with weights or without.
    pub fn features(&self) -> usize {
        self.index.len()
    }

    /// How many features have weights.
    pub fn len(&self) -> usize {
        self.rows.len() / self.stride - 1
    }

    /// Whether no feature has weights.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The weights of `feature` and their padding, if it has any.
    #[inline]
    pub fn row(&self, feature: u32) -> Option<&[f32]> {
        self.place(feature).map(|place| self.at(place))
    }

    /// The row at `place`.
    #[inline]
    pub(crate) fn at(&self, place: usize) -> &[f32] {
        &self.rows[place * self.stride..(place + 1) * self.stride]
    }

    /// The weights of `feature` and their padding; zeros are made for it when it has none.
    #[inline(always)] // A learner's change of a row is little more than this.
    pub fn row_mut(&mut self, feature: u32) -> &mut [f32] {
        let place = self.make_place(feature);
        self.version += 1;
        if let Some(reach) = self.reach.get_mut(place) {
            let before = std::mem::replace(reach, f32::INFINITY);
            self.unmeasured += usize::from(feature >= self.beyond.0 && before != f32::INFINITY);
        }
        &mut self.rows[place * self.stride..(place + 1) * self.stride]
    }

    /// Measures how far each row can move one column against another: from now on classifiers decide by what they have summed up already where the
    /// rest cannot change it. Rows that are changed after this count as unmeasured until [`Weights::measure_row`].
    pub(crate) fn measure(&mut self, table: &FeatureTable) {
        self.beyond = table.beyond();
        self.measure_all();
    }

    fn measure_all(&mut self) {
        (self.measured, self.furthest, self.unmeasured, self.reach) = (true, 0.0, 0, Vec::new());
        if self.beyond.1 == 0 {
            return;
        }
        self.reach = self.rows.chunks_exact(self.stride).map(reach).collect();
        let dynamic = &self.index[(self.beyond.0 as usize).min(self.index.len())..];
        self.furthest = dynamic.iter().map(|place| self.reach[*place as usize]).fold(0.0, further);
    }

    /// Measures the row of `feature` again, if the weights are measured.
    #[inline]
    pub(crate) fn measure_row(&mut self, feature: u32) {
        let place = self.index[feature as usize] as usize;
        if let Some(kept) = self.reach.get_mut(place) {
            let before = std::mem::replace(kept, reach(&self.rows[place * self.stride..(place + 1) * self.stride]));
            if feature >= self.beyond.0 {
                self.furthest = further(self.furthest, *kept);
                self.unmeasured -= usize::from(before == f32::INFINITY);
            }
        }
    }

    /// How far these features together can move one column against another, at most.
    #[inline]
    pub(super) fn reach(&self, features: &[u32]) -> f32 {
        let reach = |feature: &u32| self.reach.get(self.index[*feature as usize] as usize);
        features.iter().map(|feature| reach(feature).copied().unwrap_or(f32::INFINITY)).sum()
    }

    /// How far all dynamic features of a view together can move one column against another, at most, whichever they are.
    #[inline]
    pub(super) fn most(&self) -> f32 {
        let known = self.unmeasured == 0 && self.beyond.1 <= MOST_ADDED;
        if known { self.beyond.1 as f32 * self.furthest } else { f32::INFINITY }
    }

    /// Which of the rows is that of `feature`, counted from 1 in the order in which they were made.
    #[inline]
    pub(crate) fn place(&self, feature: u32) -> Option<usize> {
        match self.index[feature as usize] {
            0 => None,
            place => Some(place as usize),
        }
    }

    /// The same; a row of zeros is made when there is none.
    #[inline]
    pub(crate) fn make_place(&mut self, feature: u32) -> usize {
        if self.index[feature as usize] == 0 {
            self.add(feature);
        }
        self.index[feature as usize] as usize
    }

    /// Adds a row of zeros for `feature`.
    #[cold]
    fn add(&mut self, feature: u32) {
        let place = self.len() as u32 + 1;
        self.index[feature as usize] = place;
        self.straight += u32::from(feature == self.straight && place == feature + 1);
        self.rows.resize(self.rows.len() + self.stride, 0.0);
        if !self.reach.is_empty() {
            self.reach.push(0.0);
        }
    }

    /// Takes over the rows of `other`, which has as many columns and no feature that is not here: these have none yet.
    pub(crate) fn start_from(&mut self, other: &Weights) {
        self.index[..other.index.len()].copy_from_slice(&other.index);
        self.rows.clear();
        self.rows.extend_from_slice(&other.rows);
        self.straighten();
        self.version += 1;
    }

    /// Takes up the room that `rows` more rows will need.
    pub fn reserve(&mut self, rows: usize) {
        self.rows.reserve_exact(rows * self.stride);
    }

    /// The same for the rows of all features, as [`reserve_some`] does it.
    pub(crate) fn reserve_all(&mut self) {
        let rows = self.features();
        reserve_some(&mut self.rows, rows * self.stride);
    }

    /// The same weights for features in other numbers: feature i is the one that was `old[i]`, and those not in `old` are no more. Where
    /// `old[i]` is the number of no feature, feature i is new and has no weights. They are not measured.
    pub fn renumber(mut self, old: &[u32]) -> Self {
        self.index = old.iter().map(|feature| self.index.get(*feature as usize).copied().unwrap_or(0)).collect();
        self.straighten();
        (self.measured, self.reach) = (false, Vec::new());
        self
    }

    /// Counts the features whose rows are in their order.
    fn straighten(&mut self) {
        self.straight = self.index.iter().zip(1..).take_while(|(place, next)| **place == *next).count() as u32;
    }

    /// Adds these features' rows to `scores`, in the order given.
    #[inline]
    pub fn add_to(&self, features: &[u32], scores: &mut [f32]) {
        self.add_parts([(features, 0)], 0, scores);
    }

    /// The columns of the scores of `legal` actions, in whole blocks of eight; all of them, unless half are enough. Only what is needed is fetched
    /// then: where actions come in kinds that are never legal together, most of a row is not.
    #[inline]
    pub(crate) fn span(&self, columns: Columns, legal: Actions<'_>) -> Range<usize> {
        let Actions::Only([first, ..]) = legal else { return 0..self.stride };
        let last = legal.nth(legal.len() - 1);
        let span = first.index() / 8 * 8..(last.index() + 1).next_multiple_of(8).min(self.stride);
        let narrow = columns == Columns::Actions && 2 * span.len() <= self.stride && self.stride < WIDEST;
        if narrow { span } else { 0..self.stride }
    }

    /// Adds the part of these features' rows that begins at column `from` to `scores`, in the order given; each list comes with what is added to its numbers.
    #[inline]
    pub(crate) fn add_parts<const K: usize>(&self, parts: [(&[u32], u32); K], from: usize, scores: &mut [f32]) {
        match scores.len() {
            8 => self.add_fixed::<8>(&parts, from, scores),
            16 => self.add_fixed::<16>(&parts, from, scores),
            24 => self.add_fixed::<24>(&parts, from, scores),
            32 => self.add_fixed::<32>(&parts, from, scores),
            _ => {
                for (features, more) in parts {
                    for row in features.iter().filter_map(|feature| self.row(feature + more)) {
                        scores.iter_mut().zip(&row[from..]).for_each(|(sum, w)| *sum += w);
                    }
                }
            }
        }
    }

    /// Writes the sums of these rows to `scores`, one a column, in the order given; those outside of `span` are zero.
    #[inline]
    pub(crate) fn sum_parts<const K: usize>(&self, parts: [(&[u32], u32); K], span: Range<usize>, scores: &mut [f32]) {
        match scores.first_chunk_mut::<24>() {
            Some(scores) if span == (0..24) => *scores = self.added(parts, 0, [0.0; 24]),
            _ => {
                scores.fill(0.0);
                self.add_parts(parts, span.start, &mut scores[span]);
            }
        }
    }

    /// The same with the sums held in registers.
    fn add_fixed<const N: usize>(&self, parts: &[(&[u32], u32)], from: usize, scores: &mut [f32]) {
        let Some(scores) = scores.first_chunk_mut::<N>() else { return };
        *scores = self.added(parts.iter().copied(), from, *scores);
    }

    /// Writes `sums` and these whole rows, added to them in the order given, to `scores`.
    #[inline]
    pub(super) fn add_onto(&self, sums: &[f32], part: (&[u32], u32), scores: &mut [f32]) {
        match (sums.first_chunk::<24>(), scores.first_chunk_mut::<24>()) {
            (Some(sums), Some(scores)) if self.stride == 24 => *scores = self.added([part], 0, *sums),
            _ => {
                scores.copy_from_slice(sums);
                self.add_parts([part], 0, scores);
            }
        }
    }

    /// The sums and the part of these rows that begins at column `from`.
    #[inline(always)]
    pub(super) fn added<'a, const N: usize>(
        &self,
        parts: impl IntoIterator<Item = (&'a [u32], u32)>,
        from: usize,
        mut sums: [f32; N],
    ) -> [f32; N] {
        for (features, more) in parts {
            for feature in features.iter().map(|feature| feature + more) {
                let row = match feature < self.straight {
                    true => feature as usize + 1,
                    // A feature without weights has the row of zeros: adding it costs less than a guess whether it is one.
                    false => self.index[feature as usize] as usize,
                };
                if let Some(row) = self.rows[row * self.stride + from..].first_chunk::<N>() {
                    for c in 0..N {
                        sums[c] += row[c];
                    }
                }
            }
        }
        sums
    }

    /// The rows changed by `change`, which gets the place and the weights of each. Those that come out all zero are left out. They are measured if they were.
    pub(crate) fn map_rows(mut self, mut change: impl FnMut(usize, &mut [f32])) -> Weights {
        let stride = self.stride;
        let mut moved = vec![0; self.len() + 1];
        let mut kept = 1;
        for (place, to) in moved.iter_mut().enumerate().skip(1) {
            let row = place * stride..(place + 1) * stride;
            change(place, &mut self.rows[row.clone()]);
            if self.rows[row.clone()].iter().any(|w| *w != 0.0) {
                self.rows.copy_within(row, kept * stride);
                *to = kept as u32;
                kept += 1;
            }
        }
        self.index.iter_mut().for_each(|place| *place = moved[*place as usize]);
        self.straighten();
        self.rows.truncate(kept * stride);
        self.rows.shrink_to_fit();
        if self.measured {
            self.measure_all();
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// In whatever order rows were made, however features were numbered anew and rows left out: what is added up are the rows.
        #[test]
        fn sums_are_those_of_the_rows(
            in_order in 0..6u32,
            made in prop::collection::vec(0..12u32, 0..20),
            old in prop::collection::vec(0..15u32, 0..12),
            zero in 0..12usize,
            features in prop::collection::vec(0..12u32, 0..8),
        ) {
            let mut weights = Weights::new(12, 3);
            let check = |weights: &Weights| {
                let features = features.iter().filter(|f| (**f as usize) < weights.features());
                let mut expected = vec![0.0; 8];
                for row in features.clone().filter_map(|f| weights.row(*f)) {
                    expected.iter_mut().zip(row).for_each(|(sum, w)| *sum += w);
                }
                let mut sums = vec![0.0; 8];
                weights.add_to(&features.copied().collect::<Vec<u32>>(), &mut sums);
                prop_assert_eq!(sums, expected);
                Ok(())
            };
            for feature in (0..in_order).chain(made.iter().copied()) {
                weights.row_mut(feature)[feature as usize % 3] += 1.0 + feature as f32;
                check(&weights)?;
            }
            // A feature keeps its row, so no two may claim one.
            let mut old = old;
            old.sort_unstable();
            old.dedup();
            check(&weights.clone().renumber(&old))?;
            let fewer = weights.map_rows(|place, row| if place == zero { row.fill(0.0) });
            check(&fewer)?;
            check(&fewer.renumber(&old))?;
        }
    }
}
