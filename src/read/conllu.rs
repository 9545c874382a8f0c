//! Treebanks in CoNLL-U, the format of Universal Dependencies: ten columns between tabs, one line a word, a blank line after each
//! sentence, comments before it.
//!
//! Multiword tokens (`3-4`), empty nodes (`8.1`), comments and columns that parsing does not touch are kept as the text they were:
//! [`Treebank::write`] gives the text back byte for byte, but for HEAD and DEPREL of the words.
//!
//! Reading is strict. A sentence is refused when its lines have not ten columns, its ids have gaps, a head is out of range, heads
//! run in a circle, or not exactly one word is the root. Where no trees are known, HEAD and DEPREL are `_` for all words of the
//! sentence.
//!
//! ```
//! let text = b"1-2\tdon't\t_\t_\t_\t_\t_\t_\t_\t_\n1\tdo\t_\tAUX\t_\t_\t0\troot\t_\t_\n2\tn't\t_\tPART\t_\t_\t1\tadvmod\t_\t_\n\n";
//! let bank = rollin::read::conllu::parse(text, "text".as_ref(), 1)?;
//! assert_eq!((bank.sentences(), bank.words(), bank.form(1), bank.head(1)), (1, 2, "n't", Some(1)));
//! # Ok::<(), rollin::Error>(())
//! ```

pub use columns::write_columns;

use crate::error::{Error, Place, Result};
use crate::read::input;
use memchr::memchr;
use nom::branch::alt;
use nom::bytes::complete::tag;
use nom::character::complete::u32 as number;
use nom::combinator::{all_consuming, map};
use nom::sequence::separated_pair;
use nom::{IResult, Parser};
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Columns of a line.
pub const COLUMNS: usize = 10;
/// Column numbers, from 0.
const ID: usize = 0;
const FORM: usize = 1;
const UPOS: usize = 3;
const XPOS: usize = 4;
const FEATS: usize = 5;
const HEAD: usize = 6;
const DEPREL: usize = 7;

/// The head of a word whose tree is not known.
const UNKNOWN: u32 = u32::MAX;

/// A word's line: where its columns are.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Word {
    /// The line, from 1.
    line: u32,
    /// Column c is bytes `cells[c]..cells[c+1]-1` of the text: one byte separates them.
    cells: [u32; COLUMNS + 1],
    /// 0 for the root, else the number of the head in its sentence, from 1; or [`UNKNOWN`].
    head: u32,
}

/// Sentences with their trees, where these are known, and the text they were read from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Treebank {
    /// Where it was read from.
    pub path: PathBuf,
    text: String,
    words: Vec<Word>,
    /// Sentence i is words `starts[i]..starts[i+1]`.
    starts: Vec<u32>,
}

/// A tree's arc into a word, as [`Treebank::write`] takes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arc<'a> {
    /// 0 for the root, else the number of the head in its sentence, from 1.
    pub head: u32,
    /// The relation.
    pub relation: &'a str,
}

/// Reads the treebank in the file at `path`.
///
/// # Errors
/// As [`parse`], and when the file cannot be read.
pub fn read_file(path: impl AsRef<Path>) -> Result<Treebank> {
    let path = path.as_ref();
    parse(&input::bytes(path)?, input::name(path), 1)
}

/// The treebank that is `text`, in time linear in its length. `first_line` is the number of the first line in `path`: 1 but for a
/// block from the middle of a file.
///
/// # Errors
/// As [`parse_block`], and when there is no sentence.
pub fn parse(text: &[u8], path: &Path, first_line: usize) -> Result<Treebank> {
    let bank = parse_block(text, path, first_line)?;
    if bank.sentences() == 0 {
        let place = Reader { text: "", path, first_line }.place(0);
        return Err(Error::data(place, "no sentence", "CoNLL-U: ten columns between tabs"));
    }
    Ok(bank)
}

/// The same, but a text of blank lines is a treebank without sentences.
///
/// # Errors
/// With the exact place, when `text` is not UTF-8, is no CoNLL-U, or a tree in it is none; see the [module](self).
pub fn parse_block(text: &[u8], path: &Path, first_line: usize) -> Result<Treebank> {
    let broken = |offset: usize, problem: String| {
        let place = Place::of(path, text, offset);
        Error::data(Place { line: place.line - 1 + first_line, ..place }, problem, "text in UTF-8")
    };
    let whole = std::str::from_utf8(text).map_err(|error| {
        let offset = error.valid_up_to();
        broken(offset, format!("byte 0x{:02x}, which is not UTF-8", text.get(offset).copied().unwrap_or(0)))
    })?;
    if let Some(offset) = memchr(0, text) {
        return Err(broken(offset, "a NUL byte".into()));
    }
    if text.len() > i32::MAX as usize {
        return Err(Error::file(path, format!("{} bytes at once", text.len()), "split it: 2 GiB is the most"));
    }
    let reader = Reader { text: whole, path, first_line };
    let (words, starts) = reader.read()?;
    Ok(Treebank { path: path.to_owned(), text: whole.to_owned(), words, starts })
}

/// What the first column of a line can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Id {
    Word(u32),
    /// A multiword token, first and last word.
    Range(u32, u32),
    /// An empty node: the word before it, and its number there.
    Empty(u32, u32),
}

/// Any of the three.
fn id(cell: &str) -> Option<Id> {
    let parsed: IResult<&str, Id> = all_consuming(alt((
        map(separated_pair(number, tag("-"), number), |(a, b)| Id::Range(a, b)),
        map(separated_pair(number, tag("."), number), |(a, b)| Id::Empty(a, b)),
        map(number, Id::Word),
    )))
    .parse(cell);
    parsed.ok().map(|(_, id)| id)
}

/// A head: a number and nothing else.
fn head(cell: &str) -> Option<u32> {
    let parsed: IResult<&str, u32> = all_consuming(number).parse(cell);
    parsed.ok().map(|(_, head)| head)
}

/// A text and where it comes from.
struct Reader<'a> {
    text: &'a str,
    path: &'a Path,
    first_line: usize,
}

/// How far a sentence has been read.
#[derive(Default)]
struct Sentence {
    /// Whether there was a comment or a line of columns.
    begun: bool,
    /// Words so far.
    words: u32,
    /// The last empty node after the last word.
    empty: u32,
    /// The end of the last multiword token, and the byte where it was claimed.
    range: (u32, usize),
}

impl Reader<'_> {
    fn place(&self, offset: usize) -> Place {
        let place = Place::of(self.path, self.text.as_bytes(), offset);
        Place { line: place.line - 1 + self.first_line, ..place }
    }

    #[cold]
    fn error(&self, offset: usize, problem: impl Into<String>, expected: impl Into<String>) -> Error {
        Error::data(self.place(offset), problem, expected)
    }

    fn read(&self) -> Result<(Vec<Word>, Vec<u32>)> {
        let (mut words, mut starts) = (Vec::new(), vec![0]);
        let mut sentence = Sentence::default();
        let mut at = if self.first_line == 1 && self.text.starts_with('\u{feff}') { 3 } else { 0 };
        let mut line = self.first_line;
        while at < self.text.len() {
            let rest = &self.text.as_bytes()[at..];
            let length = memchr(b'\n', rest).unwrap_or(rest.len());
            let end = at + length - usize::from(rest[..length].ends_with(b"\r"));
            match &self.text[at..end] {
                "" => self.finish(&mut sentence, &mut words, &mut starts, at)?,
                comment if comment.starts_with('#') => {
                    if sentence.words > 0 || sentence.empty > 0 || sentence.range.0 > 0 {
                        return Err(self.error(at, "a comment within a sentence", "comments before its first word"));
                    }
                    sentence.begun = true;
                }
                _ => self.line(&mut sentence, &mut words, at..end, line)?,
            }
            at += length + 1;
            line += 1;
        }
        self.finish(&mut sentence, &mut words, &mut starts, self.text.len())?;
        Ok((words, starts))
    }

    /// Reads a line of columns.
    fn line(&self, sentence: &mut Sentence, words: &mut Vec<Word>, bytes: Range<usize>, line: usize) -> Result<()> {
        let cells = self.cells(bytes)?;
        let cell = |c: usize| &self.text[cells[c] as usize..cells[c + 1] as usize - 1];
        let at = cells[ID] as usize;
        sentence.begun = true;
        let next = sentence.words + 1;
        match id(cell(ID)) {
            Some(Id::Word(n)) if n == next => {
                let head = self.head(&cells, next)?;
                words.push(Word { line: line as u32, cells, head });
                (sentence.words, sentence.empty) = (next, 0);
                Ok(())
            }
            Some(Id::Range(first, last)) if first == next && last > first && first > sentence.range.0 => {
                sentence.range = (last, at);
                Ok(())
            }
            Some(Id::Empty(after, n)) if after == sentence.words && n == sentence.empty + 1 => {
                sentence.empty = n;
                Ok(())
            }
            _ => {
                let expected =
                    format!("{next}, or {next}-... for a multiword token, or {}.{}", next - 1, sentence.empty + 1);
                Err(self.error(at, format!("id {}", cell(ID)), expected))
            }
        }
    }

    /// Where the columns of a line start, and one byte beyond its end.
    fn cells(&self, bytes: Range<usize>) -> Result<[u32; COLUMNS + 1]> {
        let mut cells = [0; COLUMNS + 1];
        let (mut count, mut at) = (0, bytes.start);
        loop {
            let rest = &self.text.as_bytes()[at..bytes.end];
            let length = memchr(b'\t', rest).unwrap_or(rest.len());
            if count < COLUMNS {
                cells[count] = at as u32;
                if length == 0 {
                    return Err(self.error(at, "an empty column", "_ where nothing is said"));
                }
            }
            count += 1;
            if length == rest.len() {
                break;
            }
            at += length + 1;
        }
        if count != COLUMNS {
            let columns = if count == 1 { "1 column".to_owned() } else { format!("{count} columns") };
            // Where the first column too many begins, or the line ends.
            let surplus = self.text[bytes.clone()].match_indices('\t').nth(COLUMNS - 1);
            let offset = surplus.map_or(bytes.end, |(tab, _)| bytes.start + tab + 1);
            return Err(self.error(offset, columns, "10 columns, each followed by one tab but the last"));
        }
        cells[COLUMNS] = bytes.end as u32 + 1;
        Ok(cells)
    }

    /// The head in a word's line, as far as it can be checked without the others.
    fn head(&self, cells: &[u32; COLUMNS + 1], word: u32) -> Result<u32> {
        let cell = |c: usize| &self.text[cells[c] as usize..cells[c + 1] as usize - 1];
        let (offset, text) = (cells[HEAD] as usize, cell(HEAD));
        if text == "_" {
            return match cell(DEPREL) {
                "_" => Ok(UNKNOWN),
                _ => Err(self.error(offset, "a relation without a head", "the number of the head")),
            };
        }
        match head(text) {
            Some(head) if head == word => Err(self.error(offset, format!("head {text}"), "another word than this one")),
            Some(_) if cell(DEPREL) == "_" => {
                Err(self.error(cells[DEPREL] as usize, "a head without a relation", "the relation to the head"))
            }
            Some(head) if head != UNKNOWN => Ok(head),
            _ => Err(self.error(offset, format!("head {text}"), "0 or the number of a word")),
        }
    }

    /// Ends the sentence before `at`, if one has begun.
    fn finish(&self, sentence: &mut Sentence, words: &mut [Word], starts: &mut Vec<u32>, at: usize) -> Result<()> {
        let Sentence { begun, words: count, range, .. } = std::mem::take(sentence);
        if !begun {
            return Ok(());
        }
        if count == 0 {
            return Err(self.error(at, "a sentence without words", "lines of ten columns"));
        }
        if range.0 > count {
            return Err(self.error(
                range.1,
                format!("a multiword token up to word {}", range.0),
                format!("at most {count}"),
            ));
        }
        let first = words.len() - count as usize;
        self.tree(&words[first..])?;
        starts.push(words.len() as u32);
        Ok(())
    }

    /// Refuses a sentence whose heads are no tree with one root.
    fn tree(&self, words: &[Word]) -> Result<()> {
        let count = words.len();
        let at = |i: usize| words[i].cells[HEAD] as usize;
        let known = words[0].head != UNKNOWN;
        let mut root = None;
        for (i, word) in words.iter().enumerate() {
            if (word.head != UNKNOWN) != known {
                let (problem, expected) = if known {
                    ("no head", "one, as the words before have")
                } else {
                    ("a head", "_, as the words before have")
                };
                return Err(self.error(at(i), problem, expected));
            }
            if known && word.head as usize > count {
                return Err(self.error(
                    at(i),
                    format!("head {}", word.head),
                    format!("at most {count}, the number of words"),
                ));
            }
            if word.head == 0
                && let Some(before) = root.replace(i)
            {
                let problem = format!("a second root: words {} and {}", before + 1, i + 1);
                return Err(self.error(at(i), problem, "one head 0 in a sentence"));
            }
        }
        if !known {
            return Ok(());
        }
        // Who was reached first from which word: a word met again on the same way closes a circle.
        let mut reached = vec![0; count];
        for i in 0..count {
            let mut word = i;
            while reached[word] == 0 {
                reached[word] = i + 1;
                match words[word].head {
                    0 => break,
                    head => word = head as usize - 1,
                }
            }
            if words[word].head != 0 && reached[word] == i + 1 {
                return Err(self.error(
                    at(word),
                    format!("word {} is its own ancestor", word + 1),
                    "heads without circles",
                ));
            }
        }
        Ok(())
    }
}

impl Treebank {
    /// How many sentences.
    pub fn sentences(&self) -> usize {
        self.starts.len() - 1
    }

    /// How many words.
    pub fn words(&self) -> usize {
        self.words.len()
    }

    /// The words of sentence `i`, as numbers into the treebank.
    pub fn sentence(&self, i: usize) -> Range<usize> {
        self.starts[i] as usize..self.starts[i + 1] as usize
    }

    /// Sentence i is words `starts[i]..starts[i+1]`.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// The text in column `c`, from 0, of word `w`.
    fn cell(&self, w: usize, c: usize) -> &str {
        let cells = &self.words[w].cells;
        &self.text[cells[c] as usize..cells[c + 1] as usize - 1]
    }

    /// The form of word `w`.
    pub fn form(&self, w: usize) -> &str {
        self.cell(w, FORM)
    }

    /// Its universal part of speech.
    pub fn upos(&self, w: usize) -> &str {
        self.cell(w, UPOS)
    }

    /// Its part of speech in the treebank's own tags.
    pub fn xpos(&self, w: usize) -> &str {
        self.cell(w, XPOS)
    }

    /// Its morphological features, as they stand.
    pub fn feats(&self, w: usize) -> &str {
        self.cell(w, FEATS)
    }

    /// Its relation to its head; `_` where that is not known.
    pub fn relation(&self, w: usize) -> &str {
        self.cell(w, DEPREL)
    }

    /// Its head: 0 for the root, else the head's number in the sentence, from 1; `None` where it is not known.
    pub fn head(&self, w: usize) -> Option<u32> {
        Some(self.words[w].head).filter(|head| *head != UNKNOWN)
    }

    /// The first word without a head.
    pub fn first_unknown(&self) -> Option<usize> {
        self.words.iter().position(|word| word.head == UNKNOWN)
    }

    /// The line of word `w`, from 1.
    pub fn line(&self, w: usize) -> usize {
        self.words[w].line as usize
    }

    /// The place of a word's head.
    pub fn head_place(&self, w: usize) -> Place {
        self.place(w, HEAD)
    }

    /// The place of a word's relation.
    pub fn relation_place(&self, w: usize) -> Place {
        self.place(w, DEPREL)
    }

    fn place(&self, w: usize, c: usize) -> Place {
        let cells = &self.words[w].cells;
        let before = &self.text[cells[0] as usize..cells[c] as usize];
        Place { path: self.path.clone(), line: self.line(w), column: before.chars().count() + 1 }
    }

    /// Only the first `count` sentences.
    pub fn truncate(&mut self, count: usize) {
        if count < self.sentences() {
            drop(self.split_off(count));
        }
    }

    /// Splits the sentences from number `first` on off. Both keep their places.
    pub fn split_off(&mut self, first: usize) -> Treebank {
        let words = self.starts[first];
        let cut = match self.words.get(words as usize) {
            Some(word) => word.cells[0] as usize,
            None => self.text.len(),
        };
        // Comments and multiword tokens stand before the word, after a blank line.
        let blank =
            ["\n\n", "\n\r\n"].iter().filter_map(|end| self.text[..cut].rfind(end).map(|at| at + end.len())).max();
        let cut = if words == 0 { 0 } else { blank.unwrap_or(cut) };
        let text = self.text.split_off(cut);
        let mut later = self.words.split_off(words as usize);
        later.iter_mut().flat_map(|word| &mut word.cells).for_each(|cell| *cell -= cut as u32);
        let starts = self.starts[first..].iter().map(|start| start - words).collect();
        self.starts.truncate(first + 1);
        Treebank { path: self.path.clone(), text, words: later, starts }
    }

    /// Writes the text as it was read, with HEAD and DEPREL of word w from `arc(w)`. A last line without an end gets one.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write<'a>(&self, out: &mut impl Write, mut arc: impl FnMut(usize) -> Arc<'a>) -> io::Result<()> {
        let mut from = 0;
        for (w, word) in self.words.iter().enumerate() {
            let Arc { head, relation } = arc(w);
            out.write_all(&self.text.as_bytes()[from..word.cells[HEAD] as usize])?;
            write!(out, "{head}\t{relation}")?;
            from = word.cells[DEPREL + 1] as usize - 1;
        }
        out.write_all(&self.text.as_bytes()[from..])?;
        if self.text.is_empty() || self.text.ends_with('\n') { Ok(()) } else { out.write_all(b"\n") }
    }
}

mod columns;
#[cfg(test)]
mod tests;
