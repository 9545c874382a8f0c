//! Weighted right-linear grammars, and what can be known exactly about the text they make.
//!
//! A grammar is a probabilistic automaton: each rule emits one word and goes to a next nonterminal or ends the
//! sentence. Nonterminals carry tags (by default their own names) and terminals are words, so a derivation is a tagged
//! sentence. The syntax is told in [`read::grammar`](crate::read::grammar); the meaning is this.
//!
//! - Every list of choices is a distribution: a choice has the share of its weight in the sum of the list's weights.
//!   That holds for the alternatives of a rule, for the words in braces, for what follows them, and for `start`.
//! - A shared list `@name` within a list of words stands for one draw from it: its own weights count among themselves
//!   only.
//! - The probability of emitting w and going on to b from a is the sum, over the alternatives of a, of three shares:
//!   alternative, word, successor.
//!
//! Refused, with the place in the text: a nonterminal or list that is not defined or defined twice, a choice that
//! stands twice in one list, a list that is never used, a nonterminal that no sentence reaches or from which no
//! sentence ends, weights so far apart that a share is zero in floating point, more than [`LONGEST`] expected words
//! from any nonterminal, and more than [`MOST`] nonterminals. So generation cannot hang: since every nonterminal can
//! end, a derivation ends with probability 1, and because the mean from *every* nonterminal is at most L, a sentence
//! exceeds 2kL words with probability at most 2⁻ᵏ.
//!
//! Everything called exact here is computed, not sampled: expectations by solving the linear system of the automaton
//! without a subtraction, posteriors by forward-backward over numbers that carry their own exponent, so no sentence is
//! too long.
//!
//! ```
//! use rollin::Seed;
//! use rollin::grammar::Grammar;
//!
//! let grammar = Grammar::parse("<example>", "start A B; A -> { vel*3 oru } { A*4 end }; B -> oru { B*4 end };")?;
//! assert!((grammar.expected_length() - 5.0).abs() < 1e-12);
//! // By single words, every vel is an A (it always is) and every oru a B (it is, four times of five).
//! assert!((grammar.single_word().accuracy - 0.875).abs() < 1e-12);
//! // By whole sentences, one vel anywhere tells that all of it is A.
//! let sentences = grammar.generate(1000, Seed::new(1));
//! assert!(grammar.optimum(&sentences)? > 0.9);
//! let words = grammar.encode(&["oru", "oru", "vel"])?;
//! let tags = grammar.label(&words).unwrap();
//! assert!(tags.iter().all(|&tag| grammar.tag_name(tag) == "A"));
//! # Ok::<(), rollin::Error>(())
//! ```

mod bayes;
mod chain;
mod compile;
pub mod defaults;
mod generate;
mod graph;
#[cfg(test)]
mod tests;
mod wide;

use crate::read::input;
use std::collections::BTreeMap;
use std::path::Path;

use ndarray::{Array1, Array2};

pub use self::bayes::Posterior;
pub use self::compile::{LONGEST, MOST};
pub use self::generate::Sentence;
pub(crate) use self::graph::Automaton;
pub use self::graph::Node;

use self::generate::Wheels;
use crate::error::{Error, Result};
use crate::read::grammar::Tree;

/// A word that a grammar emits: an index into [`Grammar::words`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Word(pub u32);

/// A tag that a grammar's nonterminals carry: an index into [`Grammar::tags`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Tag(pub u32);

/// A checked grammar, frozen to flat tables.
///
/// An *arm* is one alternative of one nonterminal. Indices: a, b nonterminals and k arms in the order of the text, y
/// tags by first rule, w words by first appearance, first in the shared lists, then in the rules.
#[derive(Clone, Debug)]
pub struct Grammar {
    words: Vec<String>,
    index: BTreeMap<String, Word>,
    tags: Vec<String>,
    automaton: Automaton,
    /// `start[a]`: the share of sentences that start at a.
    start: Array1<f64>,
    /// `tag_of[a]`.
    tag_of: Vec<Tag>,
    /// `owner[k]`: the nonterminal whose alternative k is.
    owner: Vec<usize>,
    /// `next[k, b]`: how often b follows a word of k; the last column is the end of the sentence.
    next: Array2<f64>,
    /// Row w: the arms k that emit w, each with `share[k]` times the share of w among the words of k.
    emitters: Emitters,
    /// `visits[a]`: expected words emitted by a in one sentence.
    visits: Array1<f64>,
    wheels: Wheels,
}

/// For every word the arms that emit it, row after row: row w is `offsets[w]..offsets[w + 1]`.
#[derive(Clone, Debug)]
struct Emitters {
    offsets: Vec<usize>,
    arms: Vec<usize>,
    shares: Vec<f64>,
}

impl Emitters {
    fn of(&self, word: Word) -> impl Iterator<Item = (usize, f64)> + '_ {
        let row = self.offsets[word.0 as usize]..self.offsets[word.0 as usize + 1];
        self.arms[row.clone()].iter().copied().zip(self.shares[row].iter().copied())
    }
}

/// The best labelling that looks at single words only.
#[derive(Clone, Debug, PartialEq)]
pub struct SingleWord {
    /// The tag of each word, by the word's index.
    pub tags: Vec<Tag>,
    /// The share of words it labels correctly, exact under the grammar's own distribution.
    pub accuracy: f64,
}

/// Which tags may start, follow and end.
///
/// Every pair allowed here occurs in some sentence. Where several nonterminals carry one tag, a longer run may still be
/// impossible though each of its pairs is allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Successors {
    /// `start[y]`: y may be a sentence's first tag.
    pub start: Vec<bool>,
    /// `follow[y, z]`: z may follow y.
    pub follow: Array2<bool>,
    /// `end[y]`: y may be a sentence's last tag.
    pub end: Vec<bool>,
}

impl Grammar {
    /// The grammar written in `text`, which came from `path`.
    ///
    /// # Errors
    ///
    /// [`Error::Data`], with the place, for whatever the module's page says is refused.
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self> {
        Grammar::compile(&Tree::parse(path, text)?)
    }

    /// The grammar that was read as `tree`.
    ///
    /// # Errors
    ///
    /// As [`Grammar::parse`].
    pub fn compile(tree: &Tree) -> Result<Self> {
        compile::compile(tree)
    }

    /// The grammar written in the file `path`.
    ///
    /// # Errors
    ///
    /// If the file cannot be read or is not UTF-8, else as [`Grammar::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Grammar::parse(input::name(path), &input::text(path)?)
    }

    /// All words, by index.
    pub fn words(&self) -> &[String] {
        &self.words
    }

    /// All tags, by index.
    pub fn tags(&self) -> &[String] {
        &self.tags
    }

    /// The text of `word`, which is one of this grammar's.
    pub fn word_name(&self, word: Word) -> &str {
        &self.words[word.0 as usize]
    }

    /// The text of `tag`, which is one of this grammar's.
    pub fn tag_name(&self, tag: Tag) -> &str {
        &self.tags[tag.0 as usize]
    }

    /// The words with these texts.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a word that the grammar never emits.
    pub fn encode<S: AsRef<str>>(&self, words: &[S]) -> Result<Vec<Word>> {
        let find = |word: &S| {
            let word = word.as_ref();
            self.index.get(word).copied().ok_or_else(|| {
                Error::argument(
                    "word",
                    format!("`{word}`"),
                    format!("one of the {} words the grammar emits", self.words.len()),
                )
            })
        };
        words.iter().map(find).collect()
    }

    /// The automaton as a graph, which also renders itself for Graphviz.
    pub fn automaton(&self) -> &Automaton {
        &self.automaton
    }

    /// The expected number of words in a sentence, exact.
    pub fn expected_length(&self) -> f64 {
        self.visits.sum()
    }

    /// `counts[w, y]`: how often one sentence is expected to hold word w with tag y, exact.
    pub fn expected_counts(&self) -> Array2<f64> {
        let mut counts = Array2::zeros((self.words.len(), self.tags.len()));
        for w in 0..self.words.len() {
            for (k, share) in self.emitters.of(Word(w as u32)) {
                let a = self.owner[k];
                counts[[w, self.tag_of[a].0 as usize]] += self.visits[a] * share;
            }
        }
        counts
    }

    /// The best labelling that looks at single words only: each word gets its most frequent tag, ties to the lowest.
    pub fn single_word(&self) -> SingleWord {
        let counts = self.expected_counts();
        let best: Vec<(Tag, f64)> = counts.outer_iter().map(|row| bayes::largest(row)).collect();
        let accuracy = best.iter().map(|&(_, count)| count).sum::<f64>() / counts.sum();
        SingleWord { tags: best.into_iter().map(|(tag, _)| tag).collect(), accuracy }
    }

    /// Which tags may start, follow and end.
    pub fn successors(&self) -> Successors {
        let tags = self.tags.len();
        let mut successors = Successors {
            start: vec![false; tags],
            follow: Array2::from_elem((tags, tags), false),
            end: vec![false; tags],
        };
        for (a, &tag) in self.tag_of.iter().enumerate() {
            successors.start[tag.0 as usize] |= self.start[a] > 0.0;
        }
        for (k, row) in self.next.outer_iter().enumerate() {
            let y = self.tag_of[self.owner[k]].0 as usize;
            for (b, &chance) in row.iter().enumerate().filter(|&(_, &chance)| chance > 0.0) {
                match self.tag_of.get(b) {
                    Some(z) => successors.follow[[y, z.0 as usize]] |= chance > 0.0,
                    None => successors.end[y] = true,
                }
            }
        }
        successors
    }
}
