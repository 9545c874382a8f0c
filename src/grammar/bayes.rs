//! Exact labelling of a sentence: forward-backward (Baum et al. 1970) on the automaton.
//!
//! The labelling with the highest expected share of correct tags takes at every position the tag with the largest
//! posterior: the sum over nonterminals that carry it. Its expected accuracy is the mean of these largest posteriors,
//! and no labelling, however made, is better in expectation.

use ndarray::{Array1, Array2, ArrayView1};

use super::wide::Wide;
use super::{Grammar, Sentence, Tag, Word};
use crate::error::{Error, Result};

/// What a sentence's words tell about its tags.
#[derive(Clone, Debug, PartialEq)]
pub struct Posterior {
    /// `table[t, y]`: the probability that word t carries tag y, given all words. Every row sums to 1.
    pub table: Array2<f64>,
    /// The natural logarithm of the sentence's own probability.
    pub log_probability: f64,
}

impl Posterior {
    /// The most probable tag of every word, ties to the lowest.
    pub fn best(&self) -> Vec<Tag> {
        self.table.outer_iter().map(|row| largest(row).0).collect()
    }

    /// How many tags of [`Posterior::best`] are expected to be right.
    pub fn expected_correct(&self) -> f64 {
        self.table.outer_iter().map(|row| largest(row).1).sum()
    }
}

/// The largest entry of a row by tag, ties to the lowest.
pub(super) fn largest(row: ArrayView1<f64>) -> (Tag, f64) {
    let mut best = (Tag(0), f64::NEG_INFINITY);
    for (y, &value) in row.iter().enumerate() {
        if value > best.1 {
            best = (Tag(y as u32), value);
        }
    }
    best
}

impl Grammar {
    /// The posterior of every tag at every word; `None` if the grammar never makes this sentence, as it never makes the
    /// empty one.
    ///
    /// Time and space grow with the number of words; words by the thousand neither underflow nor lose precision that
    /// shows.
    pub fn posterior(&self, words: &[Word]) -> Option<Posterior> {
        if words.is_empty() || words.iter().any(|word| word.0 as usize >= self.words.len()) {
            return None;
        }
        let ahead = self.ahead(words);
        let mut table = Array2::zeros((words.len(), self.tags.len()));
        // behind[a]: the probability of the words so far and of a emitting the next.
        let mut behind: Array1<Wide> = self.start.mapv(Wide::new);
        let mut by_tag = vec![Wide::ZERO; self.tags.len()];
        let mut log_probability = f64::NEG_INFINITY;
        for (t, &word) in words.iter().enumerate() {
            let mut onward = Array1::from_elem(self.start.len(), Wide::ZERO);
            by_tag.fill(Wide::ZERO);
            for (k, share) in self.emitters.of(word) {
                let a = self.owner[k];
                let mass = behind[a].times(Wide::new(share));
                if mass.is_zero() {
                    continue;
                }
                let mut future = Wide::ZERO;
                for (b, &chance) in self.next.row(k).iter().enumerate().filter(|&(_, &chance)| chance > 0.0) {
                    let chance = Wide::new(chance);
                    future = future.plus(chance.times(ahead[[t + 1, b]]));
                    if b < onward.len() {
                        onward[b] = onward[b].plus(mass.times(chance));
                    }
                }
                let y = self.tag_of[a].0 as usize;
                by_tag[y] = by_tag[y].plus(mass.times(future));
            }
            let total = by_tag.iter().fold(Wide::ZERO, |total, &part| total.plus(part));
            if total.is_zero() {
                return None;
            }
            for (y, &part) in by_tag.iter().enumerate() {
                table[[t, y]] = part.over(total);
            }
            log_probability = total.ln();
            behind = onward;
        }
        Some(Posterior { table, log_probability })
    }

    /// `ahead[t, a]`: the probability of the words from t on and then the end, from nonterminal a; the last column is
    /// the sentence's end, which is certain after the last word and impossible before.
    fn ahead(&self, words: &[Word]) -> Array2<Wide> {
        let end = self.start.len();
        let mut ahead = Array2::from_elem((words.len() + 1, end + 1), Wide::ZERO);
        ahead[[words.len(), end]] = Wide::new(1.0);
        for (t, &word) in words.iter().enumerate().rev() {
            for (k, share) in self.emitters.of(word) {
                let mut future = Wide::ZERO;
                for (b, &chance) in self.next.row(k).iter().enumerate().filter(|&(_, &chance)| chance > 0.0) {
                    future = future.plus(Wide::new(chance).times(ahead[[t + 1, b]]));
                }
                let a = self.owner[k];
                ahead[[t, a]] = ahead[[t, a]].plus(Wide::new(share).times(future));
            }
        }
        ahead
    }

    /// The labelling of `words` with the highest expected share of correct tags, ties to the lowest tag; `None` if the
    /// grammar never makes this sentence.
    pub fn label(&self, words: &[Word]) -> Option<Vec<Tag>> {
        Some(self.posterior(words)?.best())
    }

    /// The best expected accuracy that anything can reach on these sentences' words: the mean over all words of the
    /// largest posterior. The sentences' tags are not looked at.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for no sentence at all or one that the grammar never makes.
    pub fn optimum(&self, sentences: &[Sentence]) -> Result<f64> {
        let (mut correct, mut tokens) = (0.0, 0);
        for (i, sentence) in sentences.iter().enumerate() {
            let posterior = self.posterior(&sentence.words).ok_or_else(|| {
                Error::argument("sentences", format!("a list whose sentence {i} is impossible"), "made by the grammar")
            })?;
            correct += posterior.expected_correct();
            tokens += sentence.words.len();
        }
        if tokens == 0 {
            return Err(Error::argument("sentences", "empty", "at least one sentence"));
        }
        Ok(correct / tokens as f64)
    }
}
