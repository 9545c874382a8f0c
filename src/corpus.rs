//! A corpus in memory: a table of interned columns, cut into sentences.
//!
//! Every cell is a number into its column's [`Interner`], which numbers the column's distinct words in order of first
//! occurrence. What depends on a word alone is therefore computed once per distinct word, never once per token.
//!
//! ```
//! use rollin::corpus::{Corpus, Separator};
//!
//! let corpus = rollin::read::conll::parse(b"the DT\ncat NN\n\nit PRP\n", "pets".as_ref(), 1)?;
//! assert_eq!((corpus.sentences(), corpus.tokens(), corpus.columns.len()), (2, 3, 2));
//! assert_eq!(corpus.sentence(1).map(|token| corpus.word(0, token)).collect::<Vec<_>>(), ["it"]);
//!
//! let mut text = Vec::new();
//! corpus.write(&mut text, Separator::Tab).expect("memory takes everything");
//! assert_eq!(text, b"the\tDT\ncat\tNN\n\nit\tPRP\n\n");
//! # Ok::<(), rollin::Error>(())
//! ```

use crate::error::Place;
use crate::index::Index;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The hash of one string: rapidhash v3, whose output is fixed for all time.
#[inline]
pub(crate) fn hash(text: &str) -> u64 {
    rapidhash::v3::rapidhash_v3(text.as_bytes())
}

/// Distinct strings, numbered from 0 in order of first occurrence.
///
/// The strings lie end to end in one arena.
#[derive(Clone, Default)]
pub struct Interner {
    arena: String,
    /// Where each string ends in the arena; it starts where the one before it ends.
    ends: Vec<usize>,
    /// The hash of each string.
    hashes: Vec<u64>,
    index: Index,
}

impl Interner {
    /// An interner without strings.
    pub fn new() -> Self {
        Self::default()
    }

    /// How many strings there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The string with number `id`.
    ///
    /// # Panics
    /// When there are no more than `id` strings.
    #[inline]
    pub fn get(&self, id: u32) -> &str {
        let id = id as usize;
        let start = if id == 0 { 0 } else { self.ends[id - 1] };
        &self.arena[start..self.ends[id]]
    }

    /// The number of `text`, if it has one.
    pub fn find(&self, text: &str) -> Option<u32> {
        self.index.find(hash(text), |id| self.get(id) == text)
    }

    /// The number of `text`, which is given the next one if it has none.
    #[inline]
    pub fn intern(&mut self, text: &str) -> u32 {
        let hash = hash(text);
        self.index.make_room(&self.hashes);
        match self.index.probe(hash, |id| self.get(id) == text) {
            Ok(id) => id,
            Err(place) => {
                let id = self.ends.len() as u32;
                self.index.take(place, hash, id);
                self.arena.push_str(text);
                self.ends.push(self.arena.len());
                self.hashes.push(hash);
                id
            }
        }
    }

    /// The strings in order of their numbers.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &str> {
        (0..self.ends.len()).map(|id| self.get(id as u32))
    }

    /// The hashes of the strings in order of their numbers.
    pub(crate) fn hashes(&self) -> &[u64] {
        &self.hashes
    }

    /// Forgets all strings but the first `len`.
    fn truncate(&mut self, len: usize) {
        if len < self.len() {
            self.ends.truncate(len);
            self.hashes.truncate(len);
            self.arena.truncate(self.ends.last().copied().unwrap_or(0));
            self.index.rebuild(&self.hashes, len);
        }
    }
}

/// Two interners are equal when they number the same strings in the same way.
impl PartialEq for Interner {
    fn eq(&self, other: &Self) -> bool {
        self.ends == other.ends && self.arena == other.arena
    }
}

impl Eq for Interner {}

impl std::fmt::Debug for Interner {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

impl<'a> FromIterator<&'a str> for Interner {
    fn from_iter<I: IntoIterator<Item = &'a str>>(strings: I) -> Self {
        let mut interner = Self::new();
        for text in strings {
            interner.intern(text);
        }
        interner
    }
}

/// One column of a corpus.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Column {
    /// The number of each token's word in `values`.
    pub cells: Vec<u32>,
    /// The distinct words of the column.
    pub values: Interner,
}

impl Column {
    /// The word of `token`.
    ///
    /// # Panics
    /// When there are no more than `token` tokens.
    #[inline]
    pub fn word(&self, token: usize) -> &str {
        self.values.get(self.cells[token])
    }

    /// Appends the word of one more token.
    #[inline]
    pub fn push(&mut self, word: &str) {
        let id = self.values.intern(word);
        self.cells.push(id);
    }
}

/// What stands between two columns when a corpus is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Separator {
    /// One tab.
    #[default]
    Tab,
    /// One space.
    Space,
}

/// Sentences of tokens, each token with one word in every column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Corpus {
    /// Where it was read from.
    pub path: PathBuf,
    /// Its columns, all with as many cells as there are tokens.
    pub columns: Vec<Column>,
    /// Sentence `i` is the tokens `starts[i]..starts[i + 1]`: one entry more than there are sentences, the first 0.
    pub starts: Vec<u32>,
    /// The line of the source on which each token stands, from 1.
    pub lines: Vec<usize>,
}

impl Corpus {
    /// A corpus without sentences, with `columns` columns.
    pub fn new(path: impl AsRef<Path>, columns: usize) -> Self {
        Corpus {
            path: path.as_ref().to_owned(),
            columns: vec![Column::default(); columns],
            starts: vec![0],
            lines: Vec::new(),
        }
    }

    /// How many sentences there are.
    pub fn sentences(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// How many tokens there are, in all sentences together.
    pub fn tokens(&self) -> usize {
        self.lines.len()
    }

    /// The tokens of sentence `i`.
    ///
    /// # Panics
    /// When there are no more than `i` sentences.
    #[inline]
    pub fn sentence(&self, i: usize) -> Range<usize> {
        self.starts[i] as usize..self.starts[i + 1] as usize
    }

    /// The word of `token` in `column`.
    ///
    /// # Panics
    /// When there is no such column or token.
    #[inline]
    pub fn word(&self, column: usize, token: usize) -> &str {
        self.columns[column].word(token)
    }

    /// Where the word of `token` in `column` stands in the source. The line is exact; the character is counted as if
    /// single characters separated the columns, as they do in nearly every file.
    pub fn place(&self, token: usize, column: usize) -> Place {
        let before = self.columns.iter().take(column).filter(|c| token < c.cells.len());
        Place {
            path: self.path.clone(),
            line: self.lines.get(token).copied().unwrap_or(0),
            column: 1 + before.map(|c| c.word(token).chars().count() + 1).sum::<usize>(),
        }
    }

    /// Appends a token that stands on `line` to the sentence in progress: one word for each column.
    ///
    /// # Panics
    /// When there are more or fewer words than columns.
    pub fn push(&mut self, words: &[&str], line: usize) {
        assert_eq!(words.len(), self.columns.len(), "a word for each column");
        for (column, word) in self.columns.iter_mut().zip(words) {
            column.push(word);
        }
        self.lines.push(line);
    }

    /// Ends the sentence in progress; does nothing if it has no token.
    pub fn end_sentence(&mut self) {
        let end = self.lines.len() as u32;
        if self.starts.last().is_some_and(|&start| start < end) {
            self.starts.push(end);
        }
    }

    /// Keeps the first `sentences` sentences, as if the source had ended after them.
    pub fn truncate(&mut self, sentences: usize) {
        if sentences >= self.sentences() {
            return;
        }
        self.starts.truncate(sentences + 1);
        let tokens = self.starts.last().copied().unwrap_or(0) as usize;
        self.lines.truncate(tokens);
        for column in &mut self.columns {
            column.cells.truncate(tokens);
            // Numbers go by first occurrence: those that are left are the smallest.
            column.values.truncate(column.cells.iter().max().map_or(0, |&last| last as usize + 1));
        }
    }

    /// Keeps the first `sentences` sentences and gives the rest, as if they had stood in a source of their own.
    pub fn split_off(&mut self, sentences: usize) -> Corpus {
        let mut rest = Corpus::new(&self.path, self.columns.len());
        for i in sentences..self.sentences() {
            for token in self.sentence(i) {
                for (column, from) in rest.columns.iter_mut().zip(&self.columns) {
                    column.push(from.word(token));
                }
                rest.lines.push(self.lines[token]);
            }
            rest.end_sentence();
        }
        self.truncate(sentences);
        rest
    }

    /// Writes one line for each token and a blank line after each sentence. Reading this gives the corpus back, but
    /// for its path and line numbers.
    ///
    /// # Errors
    /// When `out` fails, and with [`io::ErrorKind::InvalidInput`] when a word could not be read back: when it is
    /// empty or has a space, a tab, a line's end or a NUL in it.
    pub fn write(&self, out: &mut impl Write, separator: Separator) -> io::Result<()> {
        let last = self.columns.len().saturating_sub(1);
        for (c, column) in self.columns.iter().enumerate() {
            if let Some(word) =
                column.values.iter().find(|word| !is_writable(word) || c == last && word.ends_with('\r'))
            {
                let message = format!("column {c} has the word {word:?}, which cannot be read back");
                return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
            }
        }
        // A reader takes one byte order mark off the first word.
        if self.columns.first().is_some_and(|column| column.values.iter().next().is_some_and(|w| w.starts_with(MARK))) {
            write!(out, "{MARK}")?;
        }
        let separator: &[u8] = match separator {
            Separator::Tab => b"\t",
            Separator::Space => b" ",
        };
        for i in 0..self.sentences() {
            for token in self.sentence(i) {
                for (c, column) in self.columns.iter().enumerate() {
                    if c > 0 {
                        out.write_all(separator)?;
                    }
                    out.write_all(column.word(token).as_bytes())?;
                }
                out.write_all(b"\n")?;
            }
            out.write_all(b"\n")?;
        }
        Ok(())
    }
}

/// The byte order mark.
pub(crate) const MARK: char = '\u{feff}';

/// Whether a reader would take `word` for one word.
fn is_writable(word: &str) -> bool {
    !word.is_empty() && !word.contains([' ', '\t', '\n', '\0'])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashMap;

    proptest! {
        #[test]
        fn interner_agrees_with_a_map(
            words in prop::collection::vec("[ab]{0,4}|\\PC{0,3}", 0..200),
            keep in 0..50usize,
        ) {
            let mut interner = Interner::new();
            let mut map = HashMap::new();
            let mut order = Vec::new();
            for word in &words {
                let next = map.len() as u32;
                let id = *map.entry(word.clone()).or_insert(next);
                if id == next {
                    order.push(word.clone());
                }
                prop_assert_eq!(interner.intern(word), id);
            }
            prop_assert_eq!(interner.iter().collect::<Vec<_>>(), order.clone());
            interner.truncate(keep);
            prop_assert_eq!(interner.len(), keep.min(order.len()));
            for (id, word) in order.iter().enumerate() {
                prop_assert_eq!(interner.find(word), (id < keep).then_some(id as u32));
            }
            prop_assert_eq!(interner.find("never there"), None);
        }
    }

    #[test]
    fn an_empty_interner_finds_nothing() {
        assert_eq!(Interner::new().find(""), None);
    }

    #[test]
    fn truncating_is_as_if_the_source_had_ended() {
        let mut corpus = Corpus::new("three", 1);
        for (line, word) in [(1, "a"), (3, "b"), (5, "a")] {
            corpus.push(&[word], line);
            corpus.end_sentence();
        }
        corpus.end_sentence();
        let mut one = Corpus::new("three", 1);
        one.push(&["a"], 1);
        one.end_sentence();
        corpus.truncate(7);
        assert_eq!(corpus.sentences(), 3);
        corpus.truncate(1);
        assert_eq!(corpus, one);
        assert_eq!(corpus.columns[0].values.find("b"), None);
        corpus.truncate(0);
        assert_eq!((corpus.sentences(), corpus.tokens()), (0, 0));
    }

    #[test]
    fn words_that_could_not_be_read_back_are_refused() {
        for word in ["", "a b", "a\tb", "a\n", "\0", "a\r"] {
            let mut corpus = Corpus::new("odd", 1);
            corpus.push(&[word], 1);
            corpus.end_sentence();
            let error = corpus.write(&mut Vec::new(), Separator::Tab).expect_err(word);
            assert_eq!(error.kind(), io::ErrorKind::InvalidInput);
        }
    }

    #[test]
    fn places_count_characters() {
        let mut corpus = Corpus::new("café", 2);
        corpus.push(&["été", "NOM"], 4);
        assert_eq!(corpus.place(0, 1).to_string(), "café:4:5");
    }
}
