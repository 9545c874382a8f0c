//! Multi-line sequences of Vowpal Wabbit, as `--search_task sequence` reads them: one item a line, `label |namespace feature ...`, a blank line
//! after each sequence.
//!
//! A feature `f` of a namespace `n` is the attribute `n^f`, as Vowpal Wabbit's own audit names it; written, all attributes stand in the namespace
//! without a name. Names have no blanks, colons or bars: these are written as per cent signs with their codes (`%20`, `%3A`, `%7C`), and read back.
//! A label may be a number or, for `--named_labels`, a name; none is `_`. Values and importances other than 1, base scores and tags are refused,
//! see [`super::attributes`].
//!
//! ```
//! use rollin::read::vw;
//!
//! let items = vw::parse(b"1 |w the:1 |p DT\n2 |w 5%3A30\n\n", "two".as_ref(), 1)?;
//! assert_eq!(items.labels.word(0, 1), "2");
//! assert_eq!(items.names.iter().collect::<Vec<_>>(), ["w^the", "p^DT", "w^5:30"]);
//! let mut again = Vec::new();
//! vw::write(&items, &mut again).expect("memory takes everything");
//! assert_eq!(again, b"1 | w^the p^DT\n2 | w^5%3A30\n\n");
//! # Ok::<(), rollin::Error>(())
//! ```

use super::attributes::{Items, ONE, UNKNOWN, check, escape, is_blank, is_label, is_one, some, unescape};
use super::conll::Source;
use crate::error::{Error, Result};
use crate::read::input;
use nom::bytes::complete::{take_while, take_while1};
use nom::character::complete::char;
use nom::combinator::opt;
use nom::sequence::{preceded, terminated};
use nom::{IResult, Parser};
use std::borrow::Cow;
use std::io::{self, Write};
use std::path::Path;

/// Reads the file at `path`.
///
/// # Errors
/// As [`parse`], and when the file cannot be read.
pub fn read_file(path: impl AsRef<Path>) -> Result<Items> {
    let path = path.as_ref();
    parse(&input::bytes(path)?, input::name(path), 1)
}

/// The items that are `text`, in time linear in its length. `first_line` is the number of the first line in `path`.
///
/// # Errors
/// As [`parse_block`], and when there is no item.
pub fn parse(text: &[u8], path: &Path, first_line: usize) -> Result<Items> {
    some(parse_block(text, path, first_line)?, &Source { text, path, first_line })
}

/// The same, but there may be none.
///
/// # Errors
/// With the exact place, when `text` is not UTF-8, or a line is not of the form above.
pub fn parse_block(text: &[u8], path: &Path, first_line: usize) -> Result<Items> {
    let source = Source { text, path, first_line };
    Items::read(&source, |content, offset, line, items| {
        let mut cursor = Cursor { source: &source, offset, content, rest: content };
        let label = cursor.head()?;
        while cursor.rest.starts_with('|') {
            cursor.namespace(items)?;
        }
        items.push(&label, line);
        Ok(())
    })
}

/// What is left of a line that starts at byte `offset`.
struct Cursor<'s, 'a> {
    source: &'s Source<'s>,
    offset: usize,
    content: &'a str,
    rest: &'a str,
}

/// What can be part of a name.
fn is_name(c: char) -> bool {
    !is_blank(c) && c != '|' && c != ':'
}

/// Blanks, at least none.
fn blanks(rest: &str) -> IResult<&str, &str, ()> {
    take_while(is_blank).parse(rest)
}

/// What stands before the first bar.
fn word(rest: &str) -> IResult<&str, &str, ()> {
    take_while1(|c| !is_blank(c) && c != '|').parse(rest)
}

/// A name, which may be empty, and its value, if it has one.
fn named(rest: &str) -> IResult<&str, (&str, Option<&str>), ()> {
    (take_while(is_name), opt(preceded(char(':'), take_while(|c| !is_blank(c) && c != '|')))).parse(rest)
}

impl<'a> Cursor<'_, 'a> {
    /// Reads by `parser`, which may find nothing.
    fn take<T: Default>(&mut self, mut parser: impl Parser<&'a str, Output = T, Error = ()>) -> T {
        match parser.parse(self.rest) {
            Ok((rest, found)) => {
                self.rest = rest;
                found
            }
            Err(_) => T::default(),
        }
    }

    /// An error at what is left when it was `at`.
    fn error<T>(&self, at: &str, problem: impl Into<String>, expected: &str) -> Result<T> {
        let place = self.source.place(self.offset + self.content.len() - at.len());
        Err(Error::data(place, problem, expected))
    }

    /// The label, and everything up to the first bar.
    fn head(&mut self) -> Result<Cow<'a, str>> {
        self.take(blanks);
        let label = self.take(terminated(word, blanks));
        let importance = self.rest;
        match self.take(terminated(word, blanks)) {
            one if is_one(one) => {}
            other => return self.error(importance, format!("`{other}`"), "| or an importance of 1 after the label"),
        }
        if !self.rest.starts_with('|') {
            let found = if self.rest.is_empty() { "the line's end".to_owned() } else { format!("`{}`", self.rest) };
            return self.error(self.rest, found, "| and the features");
        }
        if label.starts_with('\'') {
            return self.error(self.content, "a tag", "a label, which no tag follows");
        }
        match unescape(label) {
            label if label.is_empty() => Ok(UNKNOWN.into()),
            label if !is_label(&label) => self.error(self.content, format!("{label:?}"), "a label without blanks"),
            label => Ok(label),
        }
    }

    /// A bar, the name of a namespace and its features.
    fn namespace(&mut self, items: &mut Items) -> Result<()> {
        let mut name = String::new();
        self.rest = &self.rest[1..];
        let space = self.weighed("a namespace")?;
        if !space.is_empty() {
            name = unescape(space).into_owned() + "^";
        }
        let prefix = name.len();
        loop {
            self.take(blanks);
            if self.rest.is_empty() || self.rest.starts_with('|') {
                return Ok(());
            }
            let feature = self.weighed("a feature")?;
            if feature.is_empty() {
                return self.error(self.rest, "a value", "the name of a feature before it");
            }
            name.truncate(prefix);
            name += &unescape(feature);
            items.attribute(&name);
        }
    }

    /// A name whose value, if there is one, is 1.
    fn weighed(&mut self, what: &str) -> Result<&'a str> {
        let before = self.rest;
        let (name, value) = self.take(named);
        match value {
            Some(value) if name.is_empty() => {
                self.error(before, format!("the value `{value}`"), &format!("the name of {what} before it"))
            }
            Some(value) if !is_one(value) => self.error(&before[name.len() + 1..], format!("the value `{value}`"), ONE),
            _ => Ok(name),
        }
    }
}

/// Whether a character is written as its code.
fn is_special(c: char) -> bool {
    !is_name(c) || c == '\0'
}

/// Writes one line for each item and a blank line after each sequence. Reading this gives the items back, but for their path and lines.
///
/// # Errors
/// When `out` fails, and with [`io::ErrorKind::InvalidInput`] when a label is empty or has blanks, or an attribute is empty.
pub fn write(items: &Items, out: &mut impl Write) -> io::Result<()> {
    check("label", items.labels.columns[0].values.iter(), is_label)?;
    check("attribute", items.names.iter(), |name| !name.is_empty())?;
    let names: Vec<Cow<'_, str>> = items.names.iter().map(|name| escape(name, is_special)).collect();
    for i in 0..items.labels.sentences() {
        for item in items.labels.sentence(i) {
            let label = items.labels.word(0, item);
            if label != UNKNOWN {
                // A tag would begin with a prime.
                let special = |c| is_special(c) || c == '\'';
                write!(out, "{} ", escape(label, special))?;
            }
            out.write_all(b"|")?;
            for id in items.attributes(item) {
                out.write_all(b" ")?;
                out.write_all(names[*id as usize].as_bytes())?;
            }
            out.write_all(b"\n")?;
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}
