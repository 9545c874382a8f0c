//! Sequences of items that are described by attributes, as CRFsuite and Vowpal Wabbit read them: what the formats [`super::crfsuite`] and
//! [`super::vw`] have in common.
//!
//! An item has a label, `_` where it is not known, and any number of attributes. The features of this crate are binary: an attribute is there or
//! not. A value may be given as long as it is 1; any other is refused.

use super::conll::Source;
use crate::corpus::{Corpus, Interner, MARK};
use crate::error::{Error, Result};
use crate::read::template::Speller;
use memchr::memchr;
use std::borrow::Cow;
use std::io;
use std::path::Path;

/// The label of an item whose label is not known.
pub const UNKNOWN: &str = "_";

/// Sequences of items.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Items {
    /// The sequences as sentences with one column, that of the labels.
    pub labels: Corpus,
    /// The distinct attributes.
    pub names: Interner,
    /// The numbers of the attributes of all items, one item after the other.
    ids: Vec<u32>,
    /// Item i has the numbers `ids[starts[i]..starts[i + 1]]`.
    starts: Vec<usize>,
}

impl Items {
    /// No items; what is pushed comes from `path`.
    pub fn new(path: &Path) -> Self {
        Items { labels: Corpus::new(path, 1), names: Interner::new(), ids: Vec::new(), starts: vec![0] }
    }

    /// The tokens of `corpus` as items: the labels in column `label_column`, the attributes what `speller` makes of its sentences.
    pub fn of(corpus: &Corpus, label_column: usize, speller: &Speller<'_>) -> Self {
        let mut items = Items::new(&corpus.path);
        for i in 0..corpus.sentences() {
            let sentence = corpus.sentence(i);
            for token in sentence.clone() {
                speller.observe(&sentence, token, |name| items.attribute(name));
                items.push(corpus.word(label_column, token), corpus.lines[token]);
            }
            items.end_sequence();
        }
        items
    }

    /// How many items there are.
    pub fn len(&self) -> usize {
        self.labels.tokens()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The attributes of item `i` as numbers into [`Items::names`], in their order.
    ///
    /// # Panics
    /// When there are no more than `i` items.
    pub fn attributes(&self, i: usize) -> &[u32] {
        &self.ids[self.starts[i]..self.starts[i + 1]]
    }

    /// Gives the next item one more attribute.
    pub fn attribute(&mut self, name: &str) {
        let id = self.names.intern(name);
        self.ids.push(id);
    }

    /// Ends the next item, which has this label and stands on `line`.
    pub fn push(&mut self, label: &str, line: usize) {
        self.labels.push(&[label], line);
        self.starts.push(self.ids.len());
    }

    /// Ends the sequence in progress; does nothing if it has no item.
    pub fn end_sequence(&mut self) {
        self.labels.end_sentence();
    }

    /// A corpus of as many columns as an item has attributes at most, and one more for the label. Where an item has fewer, `_` stands in the
    /// columns before the label; blanks are written as [`escape`] does.
    ///
    /// # Errors
    /// When an attribute is `_`, which would be lost.
    pub fn columns(&self) -> Result<Corpus> {
        let width = (0..self.len()).map(|i| self.attributes(i).len()).max().unwrap_or(0);
        let names: Vec<Cow<'_, str>> = self.names.iter().map(|name| escape(name, is_blank)).collect();
        if let Some(lost) = self.names.find(UNKNOWN) {
            let at = (0..self.len()).find(|i| self.attributes(*i).contains(&lost)).unwrap_or(0);
            let expected = "another name: `_` stands in a column for no attribute";
            return Err(Error::data(self.labels.place(at, 0), "the attribute `_`", expected));
        }
        let mut corpus = Corpus::new(&self.labels.path, width + 1);
        let mut words = Vec::with_capacity(width + 1);
        for i in 0..self.labels.sentences() {
            for item in self.labels.sentence(i) {
                words.clear();
                words.extend(self.attributes(item).iter().map(|id| &*names[*id as usize]));
                words.resize(width, UNKNOWN);
                words.push(self.labels.word(0, item));
                corpus.push(&words, self.labels.lines[item]);
            }
            corpus.end_sentence();
        }
        Ok(corpus)
    }

    /// Reads `source` line by line: `item` reads the one that is given, which starts at that byte, and pushes what it says.
    pub(super) fn read(
        source: &Source<'_>,
        mut item: impl FnMut(&str, usize, usize, &mut Items) -> Result<()>,
    ) -> Result<Items> {
        let whole = source.characters()?;
        let mut items = Items::new(source.path);
        let marked = source.first_line == 1 && whole.starts_with(MARK);
        let (mut offset, mut line) = (if marked { MARK.len_utf8() } else { 0 }, source.first_line);
        while offset < whole.len() {
            let end = memchr(b'\n', &whole.as_bytes()[offset..]).map_or(whole.len(), |length| offset + length);
            let content = &whole[offset..end];
            let content = content.strip_suffix('\r').unwrap_or(content);
            if content.trim_end_matches([' ', '\t', '\r']).is_empty() {
                items.end_sequence();
            } else {
                if items.len() >= u32::MAX as usize - 1 {
                    let limit = format!("at most {} of them", u32::MAX - 1);
                    return Err(Error::data(source.place(offset), "too many items", limit));
                }
                item(content, offset, line, &mut items)?;
            }
            offset = end + 1;
            line += 1;
        }
        items.end_sequence();
        Ok(items)
    }
}

/// Refuses items of a whole file when there are none.
pub(super) fn some(items: Items, source: &Source<'_>) -> Result<Items> {
    if items.is_empty() {
        return Err(Error::data(source.place(source.text.len()), "no item", "lines of one item each"));
    }
    Ok(items)
}

/// Whether `value` says that an attribute is there: 1 in any spelling, or nothing.
pub(super) fn is_one(value: &str) -> bool {
    value.is_empty() || value.parse::<f64>() == Ok(1.0)
}

/// What to say of a value that is not 1.
pub(super) const ONE: &str = "1 or no value at all: features are there or not";

/// What separates columns or ends lines.
pub fn is_blank(character: char) -> bool {
    matches!(character, ' ' | '\t' | '\r' | '\n')
}

/// `name` with every character that is `special` as a per cent sign and its code in two hexadecimal digits, and so every per cent sign that would
/// otherwise be read as the beginning of a code. Special characters are ASCII, and neither letters nor digits.
pub fn escape(name: &str, special: impl Fn(char) -> bool) -> Cow<'_, str> {
    let is_special = |(at, c): &(usize, char)| special(*c) || *c == '%' && coded(&name[at + 1..]).is_some();
    if !name.char_indices().any(|place| is_special(&place)) {
        return Cow::Borrowed(name);
    }
    let mut escaped = String::with_capacity(name.len() + 2);
    for place in name.char_indices() {
        match is_special(&place) {
            true => escaped += &format!("%{:02X}", u32::from(place.1)),
            false => escaped.push(place.1),
        }
    }
    Cow::Owned(escaped)
}

/// The character whose code follows a per cent sign.
fn coded(rest: &str) -> Option<char> {
    let code = rest.get(..2).filter(|code| code.bytes().all(|c| c.is_ascii_hexdigit()))?;
    u8::from_str_radix(code, 16).ok().filter(|c| c.is_ascii() && !c.is_ascii_alphanumeric()).map(char::from)
}

/// What [`escape`] made `name` of. A per cent sign without the code of a special character behind it stands for itself.
pub fn unescape(name: &str) -> Cow<'_, str> {
    if !name.contains('%') {
        return Cow::Borrowed(name);
    }
    let (mut text, mut rest) = (String::with_capacity(name.len()), name);
    while let Some(at) = rest.find('%') {
        text.push_str(&rest[..at]);
        let code = coded(&rest[at + 1..]);
        text.push(code.unwrap_or('%'));
        rest = &rest[at + if code.is_some() { 3 } else { 1 }..];
    }
    text.push_str(rest);
    Cow::Owned(text)
}

/// Refuses to write one of `words`, a `kind` of thing, that is not `fine`.
pub(super) fn check<'a>(
    kind: &str,
    mut words: impl Iterator<Item = &'a str>,
    fine: impl Fn(&str) -> bool,
) -> io::Result<()> {
    match words.find(|word| !fine(word)) {
        Some(word) => {
            let message = format!("there is the {kind} {word:?}, which cannot be read back");
            Err(io::Error::new(io::ErrorKind::InvalidInput, message))
        }
        None => Ok(()),
    }
}

/// Whether a label can be read back: all formats want it without blanks, and a byte order mark is taken off.
pub(super) fn is_label(label: &str) -> bool {
    !label.is_empty() && !label.contains(is_blank) && !label.starts_with(MARK)
}
