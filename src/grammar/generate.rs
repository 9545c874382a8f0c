//! Sentences drawn from a grammar.

use std::io::Write;

use rand::Rng;

use super::{Grammar, Tag, Word};
use crate::seed::{Purpose, Seed};

/// A tagged sentence: `tags[t]` is the tag of `words[t]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sentence {
    /// The words.
    pub words: Vec<Word>,
    /// Their tags.
    pub tags: Vec<Tag>,
}

/// Rows of weighted choices, one after the other: row r is `offsets[r]..offsets[r + 1]`.
#[derive(Clone, Debug)]
pub(super) struct Wheel {
    offsets: Vec<usize>,
    choices: Vec<usize>,
    /// The sum of the shares up to and including each choice, within its row.
    upto: Vec<f64>,
}

impl Wheel {
    pub(super) fn new() -> Self {
        Wheel { offsets: vec![0], choices: Vec::new(), upto: Vec::new() }
    }

    /// Adds a row with at least one choice of positive share.
    pub(super) fn push(&mut self, row: impl IntoIterator<Item = (usize, f64)>) {
        let mut sum = 0.0;
        for (choice, share) in row.into_iter().filter(|&(_, share)| share > 0.0) {
            sum += share;
            self.choices.push(choice);
            self.upto.push(sum);
        }
        self.offsets.push(self.choices.len());
    }

    /// Draws from a row.
    fn draw(&self, row: usize, rng: &mut impl Rng) -> usize {
        let (first, last) = (self.offsets[row], self.offsets[row + 1] - 1);
        if first == last {
            return self.choices[first];
        }
        // One of 2⁵³ equally spaced numbers below 1, times a total that rounding may have left a little off 1.
        let unit = (rng.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64);
        let point = unit * self.upto[last];
        let at = self.upto[first..last].partition_point(|&upto| upto <= point);
        self.choices[first + at]
    }
}

/// All that is drawn from while a sentence is made.
#[derive(Clone, Debug)]
pub(super) struct Wheels {
    /// One row: the first nonterminal.
    pub(super) start: Wheel,
    /// Row a: the arms of a.
    pub(super) arm: Wheel,
    /// Row k: the words of arm k.
    pub(super) word: Wheel,
    /// Row k: what follows a word of k; the number of nonterminals stands for the end.
    pub(super) next: Wheel,
}

impl Grammar {
    /// One sentence. Same seed, same bits.
    pub fn sentence(&self, seed: Seed) -> Sentence {
        let mut rng = seed.rng();
        let mut sentence = Sentence { words: Vec::new(), tags: Vec::new() };
        let mut a = self.wheels.start.draw(0, &mut rng);
        while a < self.tag_of.len() {
            let k = self.wheels.arm.draw(a, &mut rng);
            sentence.words.push(Word(self.wheels.word.draw(k, &mut rng) as u32));
            sentence.tags.push(self.tag_of[a]);
            a = self.wheels.next.draw(k, &mut rng);
        }
        sentence
    }

    /// `count` sentences. Sentence i depends on `seed` and i alone, so a shorter run gives the first sentences of a
    /// longer.
    pub fn generate(&self, count: usize, seed: Seed) -> Vec<Sentence> {
        (0..count as u64).map(|i| self.sentence(seed.child(Purpose::Sentence, i))).collect()
    }

    /// Writes sentences in CoNLL columns: one word a line, a space and its tag; one empty line after every sentence.
    ///
    /// # Errors
    ///
    /// Whatever `out` refuses.
    pub fn write(&self, sentences: &[Sentence], out: &mut impl Write) -> std::io::Result<()> {
        for sentence in sentences {
            for (&word, &tag) in sentence.words.iter().zip(&sentence.tags) {
                writeln!(out, "{} {}", self.word_name(word), self.tag_name(tag))?;
            }
            writeln!(out)?;
        }
        Ok(())
    }
}
