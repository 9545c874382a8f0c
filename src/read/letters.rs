//! Handwritten letters as text: one letter a line, in columns between tabs, the letters of a word one after the other.
//!
//! The first line is `word_id position fold letter bits`; then a line has the word's number, the letter's position in the word from 1, the
//! number of the fold that the whole word is in (0 to 9), the letter (a to z, or `_` where it is not known) and its image: 16 rows of 8 pixels, row by row, 128
//! characters 0 or 1.

mod words;

pub use words::{COLUMNS, LETTERS, Letters, PIXELS, ROWS, UNKNOWN};

use crate::error::{Error, Place, Result};
use crate::read::input;
use memchr::memchr;
use nom::character::complete::{char, one_of, satisfy, u64 as number};
use nom::combinator::{eof, verify};
use nom::{IResult, Parser};
use std::path::Path;

/// What the first line says.
const HEAD: &[u8] = b"word_id\tposition\tfold\tletter\tbits";

/// Reads the letters in the file at `path`.
///
/// # Errors
/// As [`parse`], and when the file cannot be read.
pub fn read_file(path: impl AsRef<Path>) -> Result<Letters> {
    let path = path.as_ref();
    parse(&input::bytes(path)?, input::name(path))
}

/// The letters that are `text`, which was read from `path`.
///
/// # Errors
/// With the exact place, when a line is not of the form above, a word's positions do not run from 1, its letters are in different folds, or there is
/// no word.
pub fn parse(text: &[u8], path: &Path) -> Result<Letters> {
    let source = Source { text, path };
    let mut letters = Letters::default();
    let mut word = None;
    let mut offset = 0;
    while offset < text.len() {
        let end = memchr(b'\n', &text[offset..]).map_or(text.len(), |length| offset + length);
        let line = text[offset..end].strip_suffix(b"\r").unwrap_or(&text[offset..end]);
        if offset == 0 {
            if line != HEAD {
                let expected = "the columns word_id, position, fold, letter and bits, between tabs";
                return Err(Error::data(source.place(0), "another first line", expected));
            }
        } else {
            source.letter(line, offset, &mut word, &mut letters)?;
        }
        offset = end + 1;
    }
    if letters.words() == 0 {
        return Err(Error::data(source.place(text.len()), "no word", "lines of one letter each"));
    }
    Ok(letters)
}

/// A text and where it comes from.
struct Source<'a> {
    text: &'a [u8],
    path: &'a Path,
}

/// A word that is being read: its number, its fold and how many letters it has so far.
type Word = (u64, u64, u64);

impl<'a> Source<'a> {
    fn place(&self, offset: usize) -> Place {
        Place::of(self.path, self.text, offset)
    }

    /// Reads the line that starts at byte `offset`.
    fn letter(&self, line: &'a [u8], offset: usize, word: &mut Option<Word>, letters: &mut Letters) -> Result<()> {
        let mut cursor = Cursor { source: self, line, offset, rest: line };
        let id = cursor.field("a word's number", number)?;
        let next = word.filter(|word| word.0 == id).map_or(1, |word| word.2 + 1);
        let position = format!("position {next}: a word's letters stand one after the other, from 1");
        cursor.field(&position, verify(number, |n: &u64| *n == next))?;
        let known = word.filter(|word| word.0 == id).map(|word| word.1);
        let fold = match known {
            Some(fold) => format!("fold {fold}, that of the whole word"),
            None => "the number of a fold, 0 to 9".to_owned(),
        };
        let fold = cursor.field(&fold, verify(number, |n: &u64| known.map_or(*n < 10, |fold| *n == fold)))?;
        let letter = cursor.field("a letter from a to z, or _", satisfy(|c| c.is_ascii_lowercase() || c == '_'))?;
        let image = cursor.image()?;
        if known.is_none() {
            letters.begin(fold as u8);
        }
        letters.push(if letter == '_' { UNKNOWN } else { letter as u32 - 'a' as u32 }, image);
        *word = Some((id, fold, next));
        Ok(())
    }
}

/// What is left of a line.
struct Cursor<'s, 'a> {
    source: &'s Source<'a>,
    line: &'a [u8],
    offset: usize,
    rest: &'a [u8],
}

impl<'a> Cursor<'_, 'a> {
    fn error(&self, expected: &str) -> Error {
        let end = memchr(b'\t', self.rest).unwrap_or(self.rest.len());
        let problem = match String::from_utf8_lossy(&self.rest[..end.min(20)]) {
            text if text.is_empty() => "nothing".to_owned(),
            text => format!("`{text}`"),
        };
        let at = self.offset + self.line.len() - self.rest.len();
        Error::data(self.source.place(at), problem, expected)
    }

    /// Reads a field and the tab behind it.
    fn field<T>(
        &mut self,
        expected: &str,
        mut parser: impl Parser<&'a [u8], Output = T, Error = nom::error::Error<&'a [u8]>>,
    ) -> Result<T> {
        let (rest, value) = parser.parse(self.rest).map_err(|_| self.error(expected))?;
        let tab: IResult<&[u8], char> = char('\t')(rest);
        self.rest = tab.map_err(|_| self.error(expected))?.0;
        Ok(value)
    }

    /// Reads the image that ends the line: pixel p is bit p.
    fn image(&mut self) -> Result<u128> {
        let mut image = 0;
        for pixel in 0..PIXELS {
            let parsed: IResult<&[u8], char> = one_of("01")(self.rest);
            let (rest, bit) = parsed.map_err(|_| self.error(&format!("pixel {} of {PIXELS}: 0 or 1", pixel + 1)))?;
            image |= u128::from(bit == '1') << pixel;
            self.rest = rest;
        }
        let end: IResult<&[u8], &[u8]> = eof(self.rest);
        end.map(|_| image).map_err(|_| self.error("the end of the line"))
    }
}
