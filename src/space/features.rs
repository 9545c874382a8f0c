//! The commonest view: sparse binary features, split into a static, a keyed and a dynamic part.
//!
//! The static part depends on the input only. It is computed once, stored once in the space's [`FeatureTable`], and named by
//! the number of its row; a frozen policy scores a row once, however many roll-outs pass over it. The keyed part depends on one number besides, such as
//! the last action, and stands in the table too. The dynamic part depends on the decisions so far and is listed in the view itself.

use super::{Gather, Sight, Store, View};
use std::ops::Range;

/// The row of a view that has no static part.
pub const NO_ROW: u32 = u32::MAX;

/// The features of one state. All are binary: those that it has are 1, the others 0.
#[derive(Clone, Debug)]
pub struct Features {
    /// The static part: a row of the [`FeatureTable`], or [`NO_ROW`].
    pub row: u32,
    /// What the row's [keyed](FeatureTable::keyed_by) features go by, such as the last action.
    pub key: u32,
    /// The dynamic part, as feature numbers below [`FeatureTable::features`].
    pub dynamic: Vec<u32>,
}

impl Default for Features {
    fn default() -> Self {
        Features { row: NO_ROW, key: 0, dynamic: Vec::new() }
    }
}

/// All features of one view, in the order in which they are summed up.
#[derive(Clone, Copy, Debug)]
pub struct Listed<'a> {
    /// The static part.
    pub fixed: &'a [u32],
    /// The keyed part: these and `key` added.
    pub keyed: &'a [u32],
    /// What is added to the keyed part.
    pub key: u32,
    /// The dynamic part.
    pub dynamic: &'a [u32],
}

impl<'a> Listed<'a> {
    /// The three parts, and what is to be added to the numbers of each.
    #[inline]
    pub fn parts(self) -> [(&'a [u32], u32); 3] {
        [(self.fixed, 0), (self.keyed, self.key), (self.dynamic, 0)]
    }

    /// The numbers of the features.
    pub fn iter(self) -> impl Iterator<Item = u32> + Clone + 'a {
        self.parts()
            .into_iter()
            .flat_map(|(features, more)| features.iter().map(move |feature| feature.wrapping_add(more)))
    }

    /// How many there are.
    pub fn len(self) -> usize {
        self.fixed.len() + self.keyed.len() + self.dynamic.len()
    }

    /// Whether there is none.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }
}

impl<'a> Sight<'a, Features> {
    /// All features of the view.
    #[inline]
    pub fn listed(&self) -> Listed<'a> {
        self.shared.listed(self.view.row, self.view.key, &self.view.dynamic)
    }
}

impl View for Features {
    type Shared = FeatureTable;
    type Store = StoredFeatures;
}

/// The static features of a whole corpus: rows of feature numbers, one after the other; and the keyed ones.
#[derive(Clone, Debug)]
pub struct FeatureTable {
    features: usize,
    bounds: Bounds,
    ids: Vec<u32>,
    /// The same of the keyed part.
    keyed: Bounds,
    firsts: Vec<u32>,
    /// The first feature that is neither static nor keyed, and how many such features a view has at most.
    beyond: (u32, usize),
}

impl FeatureTable {
    /// A table with no rows, for features numbered below `features`.
    pub fn new(features: usize) -> Self {
        FeatureTable::from_rows(features, vec![0], Vec::new())
    }

    /// A table of rows that lie one after the other in `ids`, row r from `starts[r]` to `starts[r+1]`.
    ///
    /// # Panics
    /// When `starts` does not begin with 0, descend nowhere and end with the length of `ids`.
    pub fn from_rows(features: usize, starts: Vec<usize>, ids: Vec<u32>) -> Self {
        let bounds = Bounds::of(starts, &ids);
        let keyed = Bounds::Even { width: 0, rows: bounds.rows() };
        FeatureTable { features, bounds, ids, keyed, firsts: Vec::new(), beyond: (0, 0) }
    }

    /// The same table with a keyed part. Of row r, `firsts[starts[r]]` to `firsts[starts[r+1]]` stand for one feature each, whose number is the
    /// one that stands there and [`Features::key`] added. The legal actions, too, must follow from row and key where a row has such features:
    /// what static and keyed features decide is then decided once for all views that share the two.
    ///
    /// Dynamic features are numbered from `dynamic` on, and no view has more of them than `most`: so it is known how much they can change,
    /// whichever they are.
    ///
    /// # Panics
    /// When `starts` does not begin with 0, descend nowhere and end with the length of `firsts`, or has not as many rows as the table.
    pub fn keyed_by(self, starts: Vec<usize>, firsts: Vec<u32>, dynamic: u32, most: usize) -> Self {
        let keyed = Bounds::of(starts, &firsts);
        assert_eq!(keyed.rows(), self.rows(), "a keyed part for every row");
        FeatureTable { keyed, firsts, beyond: (dynamic, most), ..self }
    }

    /// The same rows where there are `more` further features, numbered after all that are here, of which a view may have any.
    pub fn widened(&self, more: usize) -> Self {
        let (dynamic, most) = self.beyond;
        FeatureTable { features: self.features + more, beyond: (dynamic, most + more), ..self.clone() }
    }

    /// How many features there are, of all three parts; every feature number is below it.
    pub fn features(&self) -> usize {
        self.features
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.bounds.rows()
    }

    /// The static features of row `row`; none for [`NO_ROW`].
    #[inline]
    pub fn row(&self, row: u32) -> &[u32] {
        if row == NO_ROW {
            return &[];
        }
        &self.ids[self.bounds.of_row(row as usize)]
    }

    /// The keyed features of row `row`, each as the number that the key is added to.
    #[inline]
    pub fn keyed(&self, row: u32) -> &[u32] {
        if row == NO_ROW {
            return &[];
        }
        &self.firsts[self.keyed.of_row(row as usize)]
    }

    /// All features of a view.
    #[inline]
    pub fn listed<'a>(&'a self, row: u32, key: u32, dynamic: &'a [u32]) -> Listed<'a> {
        Listed { fixed: self.row(row), keyed: self.keyed(row), key, dynamic }
    }

    /// Which features can be dynamic ones, and how many of them a view has at most, as the [keyed part](FeatureTable::keyed_by) says.
    pub(crate) fn beyond(&self) -> (u32, usize) {
        self.beyond
    }
}

/// Where the rows of a table start and end.
#[derive(Clone, Debug)]
enum Bounds {
    /// All are as long.
    Even { width: usize, rows: usize },
    /// Row r goes from number r to number r+1.
    Listed(Vec<usize>),
}

impl Bounds {
    /// Those of the rows of `ids` that start there.
    fn of(starts: Vec<usize>, ids: &[u32]) -> Self {
        assert!(starts.first() == Some(&0) && starts.last() == Some(&ids.len()) && starts.is_sorted());
        let (rows, width) = (starts.len() - 1, starts.get(1).copied().unwrap_or(0));
        match starts.windows(2).all(|bounds| bounds[1] - bounds[0] == width) {
            true => Bounds::Even { width, rows },
            false => Bounds::Listed(starts),
        }
    }

    fn rows(&self) -> usize {
        match self {
            Bounds::Even { rows, .. } => *rows,
            Bounds::Listed(starts) => starts.len() - 1,
        }
    }

    #[inline]
    fn of_row(&self, row: usize) -> Range<usize> {
        match self {
            Bounds::Even { width, .. } => row * width..(row + 1) * width,
            Bounds::Listed(starts) => starts[row]..starts[row + 1],
        }
    }
}

/// Remembered features: 8 bytes for the static and the keyed part, however long they are, 4 bytes for each dynamic feature.
#[derive(Clone, Debug, Default)]
pub struct StoredFeatures {
    rows: Vec<[u32; 2]>,
    ends: Vec<usize>,
    dynamic: Vec<u32>,
}

impl StoredFeatures {
    /// View number `i`: its row of the [`FeatureTable`], its key and its dynamic features.
    #[inline]
    pub fn get(&self, i: usize) -> (u32, u32, &[u32]) {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        let [row, key] = self.rows[i];
        (row, key, &self.dynamic[start..self.ends[i]])
    }

    /// All features of view number `i`, whose row is one of `table`.
    #[inline]
    pub fn listed<'a>(&'a self, i: usize, table: &'a FeatureTable) -> Listed<'a> {
        let (row, key, dynamic) = self.get(i);
        table.listed(row, key, dynamic)
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
        self.rows.push([view.row, view.key]);
        self.dynamic.extend_from_slice(&view.dynamic);
        self.ends.push(self.dynamic.len());
    }

    fn recall(&self, i: usize, view: &mut Features) {
        let (row, key, dynamic) = self.get(i);
        (view.row, view.key) = (row, key);
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
