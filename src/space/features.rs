//! The commonest view: sparse binary features, split into a static and a dynamic part.
//!
//! The static part depends on the input only. It is computed once, stored once in the space's [`FeatureTable`], and named by
//! the number of its row; a frozen policy scores a row once, however many roll-outs pass over it. The dynamic part
//! depends on the decisions so far and is listed in the view itself.

use super::{Gather, Store, View};

/// The row of a view that has no static part.
pub const NO_ROW: u32 = u32::MAX;

/// The features of one state. All are binary: those listed are 1, the others 0.
#[derive(Clone, Debug)]
pub struct Features {
    /// The static part: a row of the [`FeatureTable`], or [`NO_ROW`].
    pub row: u32,
    /// The dynamic part, as feature numbers below [`FeatureTable::features`].
    pub dynamic: Vec<u32>,
    /// How many of the dynamic features, the first of them, follow from `row` and `key`: views that agree in those two agree in these features and in
    /// the legal actions. What such a part alone decides is then decided once. 0 promises nothing.
    pub near: usize,
    /// What the first `near` dynamic features follow from, beside the row, such as the last action.
    pub key: u32,
}

impl Default for Features {
    fn default() -> Self {
        Features { row: NO_ROW, dynamic: Vec::new(), near: 0, key: 0 }
    }
}

impl View for Features {
    type Shared = FeatureTable;
    type Store = StoredFeatures;
}

/// The static features of a whole corpus: rows of feature numbers, one after the other.
#[derive(Clone, Debug)]
pub struct FeatureTable {
    features: usize,
    starts: Vec<usize>,
    ids: Vec<u32>,
}

impl FeatureTable {
    /// A table with no rows, for features numbered below `features`.
    pub fn new(features: usize) -> Self {
        FeatureTable { features, starts: vec![0], ids: Vec::new() }
    }

    /// A table of rows that lie one after the other in `ids`, row r from `starts[r]` to `starts[r+1]`.
    ///
    /// # Panics
    /// When `starts` does not begin with 0, descend nowhere and end with the length of `ids`.
    pub fn from_rows(features: usize, starts: Vec<usize>, ids: Vec<u32>) -> Self {
        assert!(starts.first() == Some(&0) && starts.last() == Some(&ids.len()) && starts.is_sorted());
        FeatureTable { features, starts, ids }
    }

    /// The same rows where there are `more` further features, numbered after all that are here.
    pub fn widened(&self, more: usize) -> Self {
        FeatureTable { features: self.features + more, ..self.clone() }
    }

    /// How many features there are, static and dynamic together; every feature number is below it.
    pub fn features(&self) -> usize {
        self.features
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// The features of row `row`; none for [`NO_ROW`].
    #[inline]
    pub fn row(&self, row: u32) -> &[u32] {
        if row == NO_ROW {
            return &[];
        }
        &self.ids[self.starts[row as usize]..self.starts[row as usize + 1]]
    }
}

/// Remembered features: 4 bytes for the static part however long its row is, 4 bytes for each dynamic feature.
#[derive(Clone, Debug, Default)]
pub struct StoredFeatures {
    rows: Vec<u32>,
    ends: Vec<usize>,
    dynamic: Vec<u32>,
}

impl StoredFeatures {
    /// View number `i`: its row of the [`FeatureTable`] and its dynamic features.
    #[inline]
    pub fn get(&self, i: usize) -> (u32, &[u32]) {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        (self.rows[i], &self.dynamic[start..self.ends[i]])
    }
}

impl Gather for StoredFeatures {
    fn absorb(&mut self, later: Self) {
        if self.rows.is_empty() {
            *self = later;
        } else {
            self.extend_from(&later);
        }
    }
}

impl Store<Features> for StoredFeatures {
    fn push(&mut self, view: &Features) {
        self.rows.push(view.row);
        self.dynamic.extend_from_slice(&view.dynamic);
        self.ends.push(self.dynamic.len());
    }

    fn recall(&self, i: usize, view: &mut Features) {
        let (row, dynamic) = self.get(i);
        (view.row, view.near) = (row, 0);
        view.dynamic.clear();
        view.dynamic.extend_from_slice(dynamic);
    }

    fn extend_from(&mut self, other: &Self) {
        let shift = self.dynamic.len();
        self.rows.extend_from_slice(&other.rows);
        self.ends.extend(other.ends.iter().map(|end| end + shift));
        self.dynamic.extend_from_slice(&other.dynamic);
    }

    fn len(&self) -> usize {
        self.rows.len()
    }
}
