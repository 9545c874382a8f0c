//! Words of handwritten letters.

use std::ops::Range;

/// How many letters the alphabet has.
pub const LETTERS: usize = 26;
/// What stands for a letter that is not known.
pub const UNKNOWN: u32 = LETTERS as u32;
/// How many pixels an image has: [`ROWS`] rows of [`COLUMNS`].
pub const PIXELS: usize = ROWS * COLUMNS;
/// Rows of an image.
pub const ROWS: usize = 16;
/// Pixels in a row.
pub const COLUMNS: usize = 8;

/// Words of handwritten letters; [`parse`](super::parse) reads them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Letters {
    /// Where each word ends.
    ends: Vec<u32>,
    folds: Vec<u8>,
    labels: Vec<u32>,
    images: Vec<u128>,
}

impl Letters {
    /// Begins a word in `fold`.
    pub fn begin(&mut self, fold: u8) {
        self.folds.push(fold);
        self.ends.push(self.labels.len() as u32);
    }

    /// Appends a letter, 0 for a or [`UNKNOWN`], to the last word, with its image: the pixel in row r and column c is bit 8 r + c. Nothing where no word has
    /// begun.
    pub fn push(&mut self, label: u32, image: u128) {
        if let Some(end) = self.ends.last_mut() {
            *end += 1;
            self.labels.push(label);
            self.images.push(image);
        }
    }

    /// How many words.
    pub fn words(&self) -> usize {
        self.ends.len()
    }

    /// How many letters, in all words.
    pub fn len(&self) -> usize {
        self.labels.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.labels.is_empty()
    }

    /// The numbers of the letters of word `i`.
    pub fn word(&self, i: usize) -> Range<usize> {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        start as usize..self.ends[i] as usize
    }

    /// The fold of word `i`.
    pub fn fold(&self, i: usize) -> u8 {
        self.folds[i]
    }

    /// What each letter is, 0 for a or [`UNKNOWN`].
    pub fn labels(&self) -> &[u32] {
        &self.labels
    }

    /// The image of each letter.
    pub fn images(&self) -> &[u128] {
        &self.images
    }

    /// Keeps the first `words` words.
    pub fn truncate(&mut self, words: usize) {
        self.split_off(words);
    }

    /// Keeps the first `words` words and gives the rest.
    pub fn split_off(&mut self, words: usize) -> Letters {
        let words = words.min(self.words());
        let kept = if words == 0 { 0 } else { self.ends[words - 1] };
        let ends = self.ends.split_off(words).into_iter().map(|end| end - kept).collect();
        let (labels, images) = (self.labels.split_off(kept as usize), self.images.split_off(kept as usize));
        Letters { ends, folds: self.folds.split_off(words), labels, images }
    }

    /// The words whose folds are `wanted`.
    pub fn of_folds(&self, wanted: impl Fn(u8) -> bool) -> Letters {
        let mut chosen = Letters::default();
        for i in (0..self.words()).filter(|i| wanted(self.folds[*i])) {
            chosen.begin(self.folds[i]);
            for at in self.word(i) {
                chosen.push(self.labels[at], self.images[at]);
            }
        }
        chosen
    }

    /// The same words with every image moved `down` rows and `right` columns; what leaves the frame is lost.
    pub fn moved(&self, down: i32, right: i32) -> Letters {
        Letters { images: self.images.iter().map(|image| moved(*image, down, right)).collect(), ..self.clone() }
    }

    /// Appends all words of `other`.
    pub fn append(&mut self, other: &Letters) {
        let shift = self.labels.len() as u32;
        self.ends.extend(other.ends.iter().map(|end| end + shift));
        self.folds.extend_from_slice(&other.folds);
        self.labels.extend_from_slice(&other.labels);
        self.images.extend_from_slice(&other.images);
    }
}

/// `image` moved `down` rows and `right` columns.
fn moved(image: u128, down: i32, right: i32) -> u128 {
    let mut out = 0;
    for r in 0..ROWS as i32 {
        for c in 0..COLUMNS as i32 {
            let (from, row) = (c - right, r - down);
            if (0..COLUMNS as i32).contains(&from) && (0..ROWS as i32).contains(&row) {
                out |= (image >> (row * COLUMNS as i32 + from) & 1) << (r * COLUMNS as i32 + c);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moving() {
        let corner = 1u128;
        assert_eq!(moved(corner, 1, 2), 1 << 10);
        assert_eq!(moved(corner, -1, 0), 0);
        assert_eq!(moved(1 << 7, 0, 1), 0);
        assert_eq!(moved(0b101 << 8, -1, -1), 0b10);
    }
}
