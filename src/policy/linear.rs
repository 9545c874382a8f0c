//! Linear classifiers over sparse binary features.

use super::{Classifier, Outputs};
use crate::space::{Action, Actions, Features, NO_ROW, Sight};
use serde::{Deserialize, Serialize};

/// What the columns of a linear classifier stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Columns {
    /// One per action: its score.
    Actions,
    /// One per pair of actions i < j, (0,1), (0,2), ..., (1,2), ...: positive where i is better. An action's score is how many of the
    /// legal others it beats.
    Pairs,
    /// One per match of a balanced single-elimination tournament: where actions i..k split before j, column j-1, positive where the winner
    /// of i..j is better than that of j..k. The champion's score is 1, all others' 0.
    Tree,
    /// One per bit of the action's number: [`Outputs::Bits`].
    Bits,
}

impl Columns {
    /// How many columns `actions` actions need.
    pub fn count(self, actions: usize) -> usize {
        match self {
            Columns::Actions => actions,
            Columns::Pairs => actions * actions.saturating_sub(1) / 2,
            Columns::Tree => actions.saturating_sub(1),
            Columns::Bits => Outputs::Bits.count(actions),
        }
    }

    /// The column of the pair i < j.
    #[inline]
    pub fn pair(actions: usize, i: usize, j: usize) -> usize {
        i * actions - i * (i + 1) / 2 + (j - i - 1)
    }
}

/// Rows of weights, one for each feature that has any, each contiguous over the columns and padded to eight.
#[derive(Clone, Debug, PartialEq)]
pub struct Weights {
    columns: usize,
    stride: usize,
    /// The row of a feature; 0 when it has none.
    index: Vec<u32>,
    /// Row r, column c at r * stride + c. Row 0 is all zero.
    rows: Vec<f32>,
}

impl Weights {
    /// No weights, for `features` features.
    pub fn new(features: usize, columns: usize) -> Self {
        let stride = columns.next_multiple_of(8).max(8);
        Weights { columns, stride, index: vec![0; features], rows: vec![0.0; stride] }
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
    #[inline]
    pub fn row_mut(&mut self, feature: u32) -> &mut [f32] {
        let start = self.make_place(feature) * self.stride;
        &mut self.rows[start..start + self.stride]
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
        self.index[feature as usize] = self.len() as u32 + 1;
        self.rows.resize(self.rows.len() + self.stride, 0.0);
    }

    /// Takes up the room that `rows` more rows will need.
    pub fn reserve(&mut self, rows: usize) {
        self.rows.reserve_exact(rows * self.stride);
    }

    /// The same weights for features in other numbers: feature i is the one that was `old[i]`, and those not in `old` are no more.
    pub fn renumber(mut self, old: &[u32]) -> Self {
        self.index = old.iter().map(|feature| self.index[*feature as usize]).collect();
        self
    }

    /// Adds these features' rows to `scores`, in the order given.
    #[inline]
    pub fn add_to(&self, features: &[u32], scores: &mut [f32]) {
        match self.stride {
            8 => self.add_fixed::<8>(features, scores),
            16 => self.add_fixed::<16>(features, scores),
            24 => self.add_fixed::<24>(features, scores),
            32 => self.add_fixed::<32>(features, scores),
            _ => {
                for &feature in features {
                    if let Some(row) = self.row(feature) {
                        scores.iter_mut().zip(row).for_each(|(sum, w)| *sum += w);
                    }
                }
            }
        }
    }

    /// The same with the sums held in registers.
    #[inline]
    fn add_fixed<const N: usize>(&self, features: &[u32], scores: &mut [f32]) {
        let Some(scores) = scores.first_chunk_mut::<N>() else { return };
        let mut sums = *scores;
        for &feature in features {
            let row = self.index[feature as usize] as usize;
            if row != 0
                && let Some(row) = self.rows[row * N..].first_chunk::<N>()
            {
                for c in 0..N {
                    sums[c] += row[c];
                }
            }
        }
        *scores = sums;
    }

    /// The rows changed by `change`, which gets the place and the weights of each. Those that come out all zero are left out.
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
        self.rows.truncate(kept * stride);
        self.rows.shrink_to_fit();
        self
    }
}

/// A linear classifier: an action's score is a sum of weights over the features at hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// How many actions there are.
    pub actions: usize,
    /// What the columns of the weights are.
    pub columns: Columns,
    /// The weights.
    pub weights: Weights,
}

impl Linear {
    /// The classifier whose weights are the weighted mean of these: its scores are the mean of theirs, at the cost of one. `None` when
    /// there is none, or their scores are counts of pairs, which such a mean does not give.
    pub fn mean(members: &[(f64, Linear)]) -> Option<Linear> {
        let first = &members.first()?.1;
        if members.iter().any(|(_, m)| m.columns != Columns::Actions) {
            return None;
        }
        let mut weights = Weights::new(first.weights.features(), first.weights.columns);
        for (share, member) in members {
            for feature in 0..member.weights.features() as u32 {
                if let Some(row) = member.weights.row(feature) {
                    weights.row_mut(feature).iter_mut().zip(row).for_each(|(sum, w)| *sum += *share as f32 * w);
                }
            }
        }
        Some(Linear { actions: first.actions, columns: Columns::Actions, weights })
    }
}

/// How many static rows' scores a thread remembers: longer sentences only cost time.
const SLOTS: usize = 256;

/// A thread's scratch for a linear classifier: the scores of static parts seen before, and sums.
#[derive(Default)]
pub struct LinearMemory {
    rows: Vec<u32>,
    scores: Vec<f32>,
    sums: Vec<f32>,
    votes: Vec<f32>,
}

impl LinearMemory {
    /// The sums over the static part and the dynamic part of `view`, the static part's from memory where it is there.
    #[inline]
    fn sum<'m>(&'m mut self, weights: &Weights, sight: &Sight<'_, Features>) -> &'m [f32] {
        let stride = weights.stride();
        if self.sums.len() != stride {
            *self = LinearMemory {
                rows: vec![NO_ROW; SLOTS],
                scores: vec![0.0; SLOTS * stride],
                sums: vec![0.0; stride],
                votes: Vec::new(),
            };
        }
        let row = sight.view.row;
        if row == NO_ROW {
            self.sums.fill(0.0);
        } else {
            let slot = row as usize % SLOTS;
            let stored = &mut self.scores[slot * stride..(slot + 1) * stride];
            if self.rows[slot] != row {
                stored.fill(0.0);
                weights.add_to(sight.shared.row(row), stored);
                self.rows[slot] = row;
            }
            self.sums.copy_from_slice(stored);
        }
        weights.add_to(&sight.view.dynamic, &mut self.sums);
        &self.sums
    }

    /// One score an action, by weights whose columns stand for `columns`.
    #[inline]
    pub(crate) fn scores<'m>(
        &'m mut self,
        columns: Columns,
        actions: usize,
        weights: &Weights,
        sight: &Sight<'_, Features>,
    ) -> &'m [f32] {
        match columns {
            Columns::Actions => &self.sum(weights, sight)[..actions],
            columns => {
                let mut counts = std::mem::take(&mut self.votes);
                votes(columns, actions, self.sum(weights, sight), sight.legal, &mut counts);
                self.votes = counts;
                &self.votes
            }
        }
    }
}

/// The champion of the legal actions' tournament; every match, its column and the two that meet, is shown to `watch`. Of equals
/// the left one wins.
pub(crate) fn tournament(
    actions: usize,
    columns: &[f32],
    legal: Actions<'_>,
    watch: &mut impl FnMut(usize, Action, Action),
) -> Option<Action> {
    fn winner(
        range: std::ops::Range<usize>,
        columns: &[f32],
        legal: Actions<'_>,
        watch: &mut impl FnMut(usize, Action, Action),
    ) -> Option<Action> {
        if range.len() <= 1 {
            let action = Action(range.start as u32);
            return (!range.is_empty() && legal.contains(action)).then_some(action);
        }
        let middle = range.start.midpoint(range.end);
        let left = winner(range.start..middle, columns, legal, watch);
        let right = winner(middle..range.end, columns, legal, watch);
        match (left, right) {
            (Some(left), Some(right)) => {
                watch(middle - 1, left, right);
                Some(if columns[middle - 1] >= 0.0 { left } else { right })
            }
            (left, right) => left.or(right),
        }
    }
    winner(0..actions, columns, legal, watch)
}

/// The scores of actions from columns that are not theirs: how many legal others each beats in pairs, who is champion of the tree, or the
/// sum over the bits.
pub(crate) fn votes(of: Columns, actions: usize, columns: &[f32], legal: Actions<'_>, votes: &mut Vec<f32>) {
    if of == Columns::Bits {
        return Outputs::Bits.scores(actions, columns, votes);
    }
    votes.clear();
    votes.resize(actions, 0.0);
    if of == Columns::Tree {
        if let Some(champion) = tournament(actions, columns, legal, &mut |_, _, _| {}) {
            votes[champion.index()] = 1.0;
        }
        return;
    }
    for (place, Action(i)) in legal.iter().enumerate() {
        for Action(j) in legal.iter().skip(place + 1) {
            let better = if columns[Columns::pair(actions, i as usize, j as usize)] >= 0.0 { i } else { j };
            votes[better as usize] += 1.0;
        }
    }
}

impl Classifier<Features> for Linear {
    type Memory = LinearMemory;

    #[inline]
    fn scores<'m>(&self, sight: &Sight<'_, Features>, memory: &'m mut LinearMemory) -> &'m [f32] {
        memory.scores(self.columns, self.actions, &self.weights, sight)
    }
}
