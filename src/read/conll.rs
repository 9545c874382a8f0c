//! Corpora in columns, as in the shared tasks of CoNLL: one token a line, its columns separated by runs of spaces or
//! tabs, blank lines between sentences.
//!
//! Only the ASCII space and tab separate columns: a no-break space is part of a word. Spaces, tabs and carriage returns
//! at the end of a line are no part of it, and a line of nothing else is blank. A byte order mark before the first line
//! is skipped.

use crate::corpus::{Column, Corpus, MARK};
use crate::error::{Error, Place, Result};
use crate::read::input;
use memchr::{memchr, memchr_iter};
use nom::{IResult, Parser, sequence::preceded};
use std::io::BufRead;
use std::path::Path;

impl Corpus {
    /// Reads the corpus in a file: [`read_file`].
    ///
    /// # Errors
    /// As [`parse`], and when the file cannot be read.
    pub fn read(path: impl AsRef<Path>) -> Result<Corpus> {
        read_file(path)
    }

    /// The corpus that is `text`: [`parse`].
    ///
    /// # Errors
    /// As [`parse`], with the place in `<text>`.
    pub fn parse(text: impl AsRef<[u8]>) -> Result<Corpus> {
        parse(text.as_ref(), "<text>".as_ref(), 1)
    }
}

/// Reads the corpus in the file at `path`.
///
/// # Errors
/// As [`parse`], and when the file cannot be read.
pub fn read_file(path: impl AsRef<Path>) -> Result<Corpus> {
    let path = path.as_ref();
    parse(&input::bytes(path)?, input::name(path), 1)
}

/// The corpus that is `text`, in time linear in its length. `first_line` is the number of the first line in `path`: 1
/// but for a block from the middle of a file.
///
/// # Errors
/// With the exact place, when `text` is not UTF-8, has a NUL in it, has lines of different numbers of columns or no
/// sentence at all, or has more tokens than a `u32` can count.
pub fn parse(text: &[u8], path: &Path, first_line: usize) -> Result<Corpus> {
    let source = Source { text, path, first_line };
    match source.corpus()? {
        Some(corpus) => Ok(corpus),
        None => Err(Error::data(source.place(text.len()), "no sentence", "lines of one token each")),
    }
}

/// A text and where it comes from.
pub(super) struct Source<'a> {
    pub(super) text: &'a [u8],
    pub(super) path: &'a Path,
    pub(super) first_line: usize,
}

impl Source<'_> {
    /// The place at byte `offset`.
    pub(super) fn place(&self, offset: usize) -> Place {
        let place = Place::of(self.path, self.text, offset);
        Place { line: place.line - 1 + self.first_line, ..place }
    }

    /// The text as characters, if it can be a corpus.
    pub(super) fn characters(&self) -> Result<&str> {
        if let Some(offset) = memchr(0, self.text) {
            return Err(Error::data(self.place(offset), "a NUL byte", "text in UTF-8, not a binary file"));
        }
        std::str::from_utf8(self.text).map_err(|error| {
            let offset = error.valid_up_to();
            let byte = self.text.get(offset).copied().unwrap_or(0);
            Error::data(self.place(offset), format!("byte 0x{byte:02x}, which is not UTF-8"), "text in UTF-8")
        })
    }

    /// The corpus, or nothing when all lines are blank.
    fn corpus(&self) -> Result<Option<Corpus>> {
        let whole = self.characters()?;
        let skipped = if self.first_line == 1 && whole.starts_with(MARK) { MARK.len_utf8() } else { 0 };
        let mut corpus = Corpus::new(self.path, 0);
        let (mut rest, mut line) = (&whole[skipped..], self.first_line);
        while !rest.is_empty() {
            let (content, next) = split_line(rest);
            if content.is_empty() {
                corpus.end_sentence();
            } else {
                if corpus.columns.is_empty() {
                    self.open(&mut corpus, content);
                }
                if corpus.lines.len() >= u32::MAX as usize - 1 {
                    let limit = format!("at most {} of them", u32::MAX - 1);
                    return Err(Error::data(self.place(whole.len() - rest.len()), "too many tokens", limit));
                }
                self.token(&mut corpus, content, whole.len() - rest.len())?;
                corpus.lines.push(line);
            }
            rest = next;
            line += 1;
        }
        corpus.end_sentence();
        Ok((corpus.sentences() > 0).then_some(corpus))
    }

    /// Gives `corpus` as many columns as its first line has, with room for all the tokens there can be.
    fn open(&self, corpus: &mut Corpus, mut content: &str) {
        let mut columns = 0;
        while let Ok((rest, _)) = cell(content) {
            columns += 1;
            content = rest;
        }
        // A cell takes two bytes at least, its separator included.
        let tokens = (memchr_iter(b'\n', self.text).count() + 1).min(self.text.len() / (2 * columns).max(1) + 1);
        corpus.lines.reserve(tokens);
        corpus.columns.resize_with(columns, || Column { cells: Vec::with_capacity(tokens), ..Column::default() });
    }

    /// Appends the words of one line, which starts at byte `offset`, to the columns.
    #[inline]
    fn token(&self, corpus: &mut Corpus, content: &str, offset: usize) -> Result<()> {
        let mut rest = content;
        for column in &mut corpus.columns {
            let Ok((next, word)) = cell(rest) else { return Err(self.uneven(corpus, content, offset)) };
            column.push(word);
            rest = next;
        }
        if rest.is_empty() { Ok(()) } else { Err(self.uneven(corpus, content, offset)) }
    }

    /// The error of a line with more or fewer columns than the first.
    #[cold]
    fn uneven(&self, corpus: &Corpus, content: &str, offset: usize) -> Error {
        let (mut rest, mut found, mut at) = (content, 0, content.len());
        while let Ok((next, word)) = cell(rest) {
            if found == corpus.columns.len() {
                at = content.len() - next.len() - word.len();
            }
            found += 1;
            rest = next;
        }
        let columns = |n| if n == 1 { "1 column".to_owned() } else { format!("{n} columns") };
        let expected = match corpus.lines.first() {
            Some(line) => format!("{} as on line {line}", columns(corpus.columns.len())),
            None => columns(corpus.columns.len()),
        };
        Error::data(self.place(offset + at), columns(found), expected)
    }
}

/// Whether `byte` separates columns.
#[inline]
fn is_blank(byte: u8) -> bool {
    byte == b' ' || byte == b'\t'
}

/// The first line of `text`, without its end and blanks before that, and what follows the line.
#[inline]
fn split_line(text: &str) -> (&str, &str) {
    let (line, next) = match memchr(b'\n', text.as_bytes()) {
        Some(end) => (&text[..end], &text[end + 1..]),
        None => (text, ""),
    };
    (&line[..trimmed(line.as_bytes())], next)
}

/// The length of `line` without its end.
#[inline]
fn trimmed(line: &[u8]) -> usize {
    line.iter().rposition(|&byte| !is_blank(byte) && byte != b'\r' && byte != b'\n').map_or(0, |last| last + 1)
}

/// The blanks at the start of a line's rest.
#[inline]
fn blanks(rest: &str) -> IResult<&str, &str, ()> {
    let end = rest.bytes().position(|byte| !is_blank(byte)).unwrap_or(rest.len());
    Ok((&rest[end..], &rest[..end]))
}

/// A word: everything up to the next blank.
#[inline]
fn word(rest: &str) -> IResult<&str, &str, ()> {
    match rest.bytes().position(is_blank).unwrap_or(rest.len()) {
        0 => Err(nom::Err::Error(())),
        end => Ok((&rest[end..], &rest[..end])),
    }
}

/// The next cell of a line.
#[inline]
fn cell(rest: &str) -> IResult<&str, &str, ()> {
    preceded(blanks, word).parse(rest)
}

/// Some whole sentences of a stream, as they were read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// Every byte of it.
    pub bytes: Vec<u8>,
    /// The number of its first line in the stream, from 1.
    pub first_line: usize,
}

/// One line of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line<'a> {
    /// The line up to its last character that is no blank: empty if the line is blank, a token otherwise.
    pub text: &'a [u8],
    /// What is left of it, its end included.
    pub end: &'a [u8],
}

impl Block {
    /// The corpus that this block of `path` is, or nothing when all its lines are blank.
    ///
    /// # Errors
    /// As [`parse`], but for blank lines.
    pub fn corpus(&self, path: &Path) -> Result<Option<Corpus>> {
        Source { text: &self.bytes, path, first_line: self.first_line }.corpus()
    }

    /// The lines: one after the other, text and end, they are the block again.
    pub fn lines(&self) -> impl Iterator<Item = Line<'_>> {
        self.bytes.split_inclusive(|&byte| byte == b'\n').map(|line| {
            let (text, end) = line.split_at(trimmed(line));
            Line { text, end }
        })
    }
}

/// A stream cut into blocks of whole sentences, so that a corpus of any size can be tagged in little memory: that of
/// one block, which is as long as it must be to end where a sentence does.
pub struct Blocks<R> {
    input: R,
    size: usize,
    line: usize,
    failed: bool,
}

impl<R: BufRead> Blocks<R> {
    /// The blocks of `input`, each of at least `size` lines but for the last; none after an error.
    pub fn new(input: R, size: usize) -> Self {
        Blocks { input, size, line: 1, failed: false }
    }
}

impl<R: BufRead> Iterator for Blocks<R> {
    type Item = std::io::Result<Block>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let mut block = Block { bytes: Vec::new(), first_line: self.line };
        loop {
            let start = block.bytes.len();
            match self.input.read_until(b'\n', &mut block.bytes) {
                Ok(0) => return (start > 0).then_some(Ok(block)),
                Ok(_) => self.line += 1,
                Err(error) => {
                    self.failed = true;
                    return Some(Err(error));
                }
            }
            let blank = trimmed(&block.bytes[start..]) == 0;
            if blank && self.line - block.first_line >= self.size {
                return Some(Ok(block));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::Separator;
    use proptest::prelude::*;

    fn read(text: &[u8]) -> Result<Corpus> {
        parse(text, Path::new("text"), 1)
    }

    /// The words of each sentence, token by token.
    fn sentences(corpus: &Corpus) -> Vec<Vec<Vec<String>>> {
        let token = |t| (0..corpus.columns.len()).map(|c| corpus.word(c, t).to_owned()).collect();
        (0..corpus.sentences()).map(|i| corpus.sentence(i).map(token).collect()).collect()
    }

    #[test]
    fn everything_that_separates() {
        let text = "\u{feff}\n \t\n a  b\r\nc\u{a0}c \t d \n\r\n\n\t\ne\rf\tg";
        let corpus = read(text.as_bytes()).expect("a corpus");
        assert_eq!(sentences(&corpus), [vec![["a", "b"], ["c\u{a0}c", "d"]], vec![["e\rf", "g"]]]);
        assert_eq!(corpus.lines, [3, 4, 8]);
        assert_eq!(corpus.starts, [0, 2, 3]);
    }

    #[test]
    fn errors_say_where_and_what() {
        let cases: [(&[u8], &str); 9] = [
            (b"", "text:1:1: no sentence; expected lines of one token each"),
            (b"\n \n", "text:3:1: no sentence; expected lines of one token each"),
            (b"a b c\n\nd e\n", "text:3:4: 2 columns; expected 3 columns as on line 1"),
            (b"\na\nd e  f\n", "text:3:3: 3 columns; expected 1 column as on line 2"),
            ("é b\nè  b ç ç".as_bytes(), "text:2:6: 4 columns; expected 2 columns as on line 1"),
            (b"a\nb\0", "text:2:2: a NUL byte; expected text in UTF-8, not a binary file"),
            (b"a\nb \xe9t\xe9\n", "text:2:3: byte 0xe9, which is not UTF-8; expected text in UTF-8"),
            (b"caf\xc3", "text:1:4: byte 0xc3, which is not UTF-8; expected text in UTF-8"),
            (b"a\r\na b\r\n", "text:2:3: 2 columns; expected 1 column as on line 1"),
        ];
        for (text, expected) in cases {
            let error = read(text).expect_err(expected);
            assert!(matches!(error, Error::Data { .. }));
            assert_eq!(error.to_string(), expected);
        }
        let error = parse(b"a\nb b", Path::new("text"), 11).expect_err("uneven");
        assert_eq!(error.to_string(), "text:12:3: 2 columns; expected 1 column as on line 11");
        let error = read_file("/no/such/file").expect_err("missing");
        assert!(error.to_string().starts_with("cannot read /no/such/file: "), "{error}");
    }

    #[test]
    fn a_byte_order_mark_counts_as_a_character_of_its_line() {
        let error = read("\u{feff}a\n\nb c\n".as_bytes()).expect_err("uneven");
        assert_eq!(error.to_string(), "text:3:3: 2 columns; expected 1 column as on line 1");
    }

    #[test]
    fn huge_words_and_sentences() {
        let word = "é".repeat(500_000);
        let corpus = read(format!("{word} A\n").repeat(2).as_bytes()).expect("a corpus");
        assert_eq!(corpus.word(0, 1), word);
        let corpus = read("w T\n".repeat(100_000).as_bytes()).expect("a corpus");
        assert_eq!((corpus.sentences(), corpus.tokens()), (1, 100_000));
    }

    #[test]
    fn many_columns_reserve_no_more_than_the_text_can_hold() {
        let text = "a ".repeat(50_000) + &"\n".repeat(1_000_000);
        assert_eq!(read(text.as_bytes()).expect("a corpus").columns.len(), 50_000);
    }

    #[test]
    fn lines_keep_their_ends() {
        let block = Block { bytes: b"a b \r\n\t\nc".to_vec(), first_line: 1 };
        let lines: Vec<_> = block.lines().map(|line| (line.text, line.end)).collect();
        assert_eq!(lines, [(&b"a b"[..], &b" \r\n"[..]), (b"", b"\t\n"), (b"c", b"")]);
    }

    #[test]
    fn a_block_ends_with_its_sentence() {
        let blocks: Vec<_> = Blocks::new(&b"a\nb\n\n\nc\n \nd\ne"[..], 2).map(|block| block.expect("memory")).collect();
        let bytes: Vec<_> = blocks.iter().map(|block| (&block.bytes[..], block.first_line)).collect();
        assert_eq!(bytes, [(&b"a\nb\n\n"[..], 1), (b"\nc\n \n", 4), (b"d\ne", 7)]);
        assert_eq!(Block { bytes: b" \n".to_vec(), first_line: 3 }.corpus(Path::new("text")).expect("blank"), None);
    }

    #[test]
    fn nothing_follows_a_failure() {
        struct Broken;
        impl std::io::Read for Broken {
            fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
                Err(std::io::Error::other("broken"))
            }
        }
        let mut blocks = Blocks::new(std::io::BufReader::new(Broken), 1);
        assert!(blocks.next().is_some_and(|block| block.is_err()));
        assert!(blocks.next().is_none());
    }

    /// Text that is often a corpus: words, blanks of all kinds, and now and then something odd.
    fn nearly_a_corpus() -> impl Strategy<Value = String> {
        let piece = prop_oneof![
            4 => "[ab]{1,2}",
            1 => "\u{feff}|\u{a0}|é|\r|\u{2028}|%",
            3 => Just(" ".to_owned()),
            1 => "\t|  |\r\n",
            3 => "\n|\n\n|\n \n",
        ];
        prop::collection::vec(piece, 0..40).prop_map(|pieces| pieces.concat())
    }

    /// Sentences of as many columns as asked for, of words that can be read.
    fn words() -> impl Strategy<Value = Vec<Vec<Vec<String>>>> {
        let word = "[^ \t\n\0]{0,3}[^ \t\r\n\0]";
        (1..4usize).prop_flat_map(move |columns| {
            let token = prop::collection::vec(word, columns);
            prop::collection::vec(prop::collection::vec(token, 1..5), 1..5)
        })
    }

    proptest! {
        #[test]
        fn no_bytes_panic(text in prop::collection::vec(any::<u8>(), 0..60)) {
            let _ = read(&text);
        }

        #[test]
        fn reading_what_was_written_gives_it_back(words in words(), space in any::<bool>()) {
            let mut corpus = Corpus::new("text", words[0][0].len());
            let mut line = 0;
            for sentence in &words {
                for token in sentence {
                    line += 1;
                    corpus.push(&token.iter().map(String::as_str).collect::<Vec<_>>(), line);
                }
                line += 1;
                corpus.end_sentence();
            }
            let mut text = Vec::new();
            let separator = if space { Separator::Space } else { Separator::Tab };
            corpus.write(&mut text, separator).expect("memory");
            prop_assert_eq!(read(&text).expect("a corpus"), corpus);
        }

        #[test]
        fn what_was_read_can_be_written(text in nearly_a_corpus()) {
            if let Ok(corpus) = read(text.as_bytes()) {
                let mut written = Vec::new();
                corpus.write(&mut written, Separator::Tab).expect("memory");
                prop_assert_eq!(sentences(&read(&written).expect("a corpus")), sentences(&corpus));
            }
        }

        #[test]
        fn blocks_are_the_stream(text in nearly_a_corpus(), size in 0..6usize, buffer in 1..9usize) {
            let input = std::io::BufReader::with_capacity(buffer, text.as_bytes());
            let blocks: Vec<_> = Blocks::new(input, size).map(|block| block.expect("memory")).collect();
            let (last, others) = blocks.split_last().map_or((None, &[][..]), |(last, others)| (Some(last), others));
            for block in others {
                prop_assert!(block.lines().count() >= size);
            }
            prop_assert_eq!(last.is_none(), text.is_empty());
            prop_assert_eq!(blocks.iter().flat_map(|block| block.bytes.clone()).collect::<Vec<_>>(), text.as_bytes());
            for block in &blocks {
                let lines: Vec<u8> = block.lines().flat_map(|line| [line.text, line.end].concat()).collect();
                prop_assert_eq!(&lines, &block.bytes);
            }
            if let Ok(whole) = read(text.as_bytes()) {
                let (mut found, mut lines) = (Vec::new(), Vec::new());
                for block in &blocks {
                    if let Some(corpus) = block.corpus(Path::new("text")).expect("part of a corpus") {
                        found.extend(sentences(&corpus));
                        lines.extend(corpus.lines);
                    }
                }
                prop_assert_eq!(found, sentences(&whole));
                prop_assert_eq!(lines, whole.lines);
            }
        }
    }
}
