//! Attribute files of CRFsuite: one item a line, its label and attributes between tabs, a blank line after each sequence.
//!
//! A colon stands before an attribute's value; `\:` is a colon and `\\` a backslash in a name, a backslash before anything else itself, as CRFsuite
//! reads them. Values other than 1 are refused, see [`super::attributes`]; so are weights of sequences (`@weight:2`). A label has no
//! blanks and is `_` where it is not known.
//!
//! ```
//! use rollin::read::crfsuite;
//!
//! let text = b"B-NP\tw=the\tpos:1\nI-NP\tw=5\\:30\n\n";
//! let items = crfsuite::parse(text, "two".as_ref(), 1)?;
//! assert_eq!(items.labels.word(0, 1), "I-NP");
//! assert_eq!(items.names.iter().collect::<Vec<_>>(), ["w=the", "pos", "w=5:30"]);
//! let mut again = Vec::new();
//! crfsuite::write(&items, &mut again).expect("memory takes everything");
//! assert_eq!(again, b"B-NP\tw=the\tpos\nI-NP\tw=5\\:30\n\n");
//! # Ok::<(), rollin::Error>(())
//! ```

use super::attributes::{Items, ONE, check, is_label, is_one, some};
use super::conll::Source;
use crate::error::{Error, Result};
use crate::read::input;
use nom::branch::alt;
use nom::bytes::complete::{take_while, take_while1};
use nom::character::complete::{char, one_of};
use nom::combinator::{opt, recognize};
use nom::multi::many0_count;
use nom::sequence::preceded;
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
        let mut label = None;
        let mut rest = content;
        while let Ok((next, (name, value))) = token(rest) {
            let place = |at: &str| source.place(offset + content.len() - at.len());
            match (&label, value) {
                (None, None) if is_label(&unescape(name)) => label = Some(unescape(name)),
                (None, None) => return Err(Error::data(place(rest), format!("{name:?}"), "a label without blanks")),
                (None, Some(_)) => {
                    return Err(Error::data(place(&rest[name.len()..]), "a colon", "a tab after the label, or \\:"));
                }
                (Some(_), Some(value)) if !is_one(value) => {
                    let end = rest.len() - name.len() - 1;
                    return Err(Error::data(place(&rest[rest.len() - end..]), format!("the value {value:?}"), ONE));
                }
                (Some(_), _) if name.is_empty() && value.is_some() => {
                    return Err(Error::data(place(rest), "a value", "the name of an attribute before it"));
                }
                // CRFsuite skips what is nothing between tabs.
                (Some(_), _) if name.is_empty() => {}
                (Some(_), _) => items.attribute(&unescape(name)),
            }
            rest = match next.strip_prefix('\t') {
                Some(rest) => rest,
                None if next.is_empty() => break,
                None => return Err(Error::data(place(next), "a second colon", "a tab, or \\: for a colon in a name")),
            };
        }
        items.push(&label.unwrap_or_default(), line);
        Ok(())
    })
}

/// A name and its value, if it has one.
fn token(rest: &str) -> IResult<&str, (&str, Option<&str>), ()> {
    let plain = take_while1(|c| !matches!(c, '\\' | ':' | '\t'));
    let escaped = recognize(preceded(char('\\'), opt(one_of("\\:"))));
    let value = preceded(char(':'), take_while(|c| !matches!(c, ':' | '\t')));
    (recognize(many0_count(alt((plain, escaped)))), opt(value)).parse(rest)
}

/// What a name means.
fn unescape(name: &str) -> Cow<'_, str> {
    if !name.contains('\\') {
        return Cow::Borrowed(name);
    }
    let (mut text, mut characters) = (String::with_capacity(name.len()), name.chars().peekable());
    while let Some(c) = characters.next() {
        let meant = (c == '\\').then(|| characters.next_if(|c| matches!(c, '\\' | ':'))).flatten();
        text.push(meant.unwrap_or(c));
    }
    Cow::Owned(text)
}

/// The name that means `text`.
fn escape(text: &str) -> Cow<'_, str> {
    match text.contains(['\\', ':']) {
        true => Cow::Owned(text.replace('\\', "\\\\").replace(':', "\\:")),
        false => Cow::Borrowed(text),
    }
}

/// Writes one line for each item and a blank line after each sequence. Reading this gives the items back, but for their path and lines.
///
/// # Errors
/// When `out` fails, and with [`io::ErrorKind::InvalidInput`] when a label or an attribute could not be read back: when it is empty, has a tab, a line's end
/// or a NUL in it, or, in a label, a space.
pub fn write(items: &Items, out: &mut impl Write) -> io::Result<()> {
    check("label", items.labels.columns[0].values.iter(), |label| is_label(label) && !label.contains('\0'))?;
    check("attribute", items.names.iter(), |name| {
        !name.is_empty() && !name.contains(['\t', '\n', '\0']) && !name.ends_with('\r')
    })?;
    let names: Vec<Cow<'_, str>> = items.names.iter().map(escape).collect();
    for i in 0..items.labels.sentences() {
        for item in items.labels.sentence(i) {
            out.write_all(escape(items.labels.word(0, item)).as_bytes())?;
            for id in items.attributes(item) {
                out.write_all(b"\t")?;
                out.write_all(names[*id as usize].as_bytes())?;
            }
            out.write_all(b"\n")?;
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}
