//! The other common view: so many numbers, such as the pixels of an image.

use super::{Gather, Store, View};

/// What a policy sees of one state: numbers, as many in every state ([`Width`]). Learners do best where they are of about the same size, such as
/// within [-1, 1].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dense(pub Vec<f32>);

/// How many numbers each view of a space has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Width(pub usize);

impl View for Dense {
    type Shared = Width;
    type Store = DenseRows;
}

/// Remembered numbers: row after row in one array, 4 bytes each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DenseRows {
    rows: usize,
    values: Vec<f32>,
}

impl DenseRows {
    /// View number `i`. Views must all have been of one width.
    #[inline]
    pub fn get(&self, i: usize) -> &[f32] {
        let width = self.values.len() / self.rows.max(1);
        &self.values[i * width..(i + 1) * width]
    }
}

impl Gather for DenseRows {
    fn absorb(&mut self, later: Self) {
        if self.rows == 0 {
            *self = later;
        } else {
            self.extend_from(&later);
        }
    }
}

impl Store<Dense> for DenseRows {
    fn push(&mut self, view: &Dense) {
        self.rows += 1;
        self.values.extend_from_slice(&view.0);
    }

    fn recall(&self, i: usize, view: &mut Dense) {
        view.0.clear();
        view.0.extend_from_slice(self.get(i));
    }

    fn extend_from(&mut self, other: &Self) {
        self.rows += other.rows;
        self.values.extend_from_slice(&other.values);
    }

    fn len(&self) -> usize {
        self.rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_back_in_order() {
        let (mut first, mut second) = (DenseRows::default(), DenseRows::default());
        first.push(&Dense(vec![1.0, 2.0]));
        second.push(&Dense(vec![3.0, 4.0]));
        first.extend_from(&second);
        first.absorb(second);
        let mut empty = DenseRows::default();
        empty.absorb(first);
        assert_eq!(empty.len(), 3);
        assert_eq!([empty.get(0), empty.get(1), empty.get(2)], [[1.0, 2.0], [3.0, 4.0], [3.0, 4.0]]);
    }
}
