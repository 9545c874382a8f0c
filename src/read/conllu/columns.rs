//! Treebanks as plain corpora of ten columns, and back.

use super::{COLUMNS, Treebank, parse_block};
use crate::corpus::Corpus;
use crate::error::{Error, Place, Result};
use crate::read::attributes::{escape, is_blank, unescape};
use std::io::{self, Write};

impl Treebank {
    /// The words with all their ten columns as a corpus, blanks written as [`escape`] does (`%20`). Comments, multiword tokens and empty nodes have no
    /// place there and are left out.
    pub fn columns(&self) -> Corpus {
        let mut corpus = Corpus::new(&self.path, COLUMNS);
        for i in 0..self.sentences() {
            for w in self.sentence(i) {
                let cells: Vec<_> = (0..COLUMNS).map(|c| escape(self.cell(w, c), is_blank)).collect();
                corpus.push(&cells.iter().map(|cell| &**cell).collect::<Vec<_>>(), self.line(w));
            }
            corpus.end_sentence();
        }
        corpus
    }
}

/// Writes a corpus of ten columns, as [`Treebank::columns`] makes it, as CoNLL-U.
///
/// # Errors
/// With the line, when it has not ten columns or they are no trees; the inner result is that of `out`.
pub fn write_columns(corpus: &Corpus, out: &mut impl Write) -> Result<io::Result<()>> {
    let found = corpus.columns.len();
    if found != COLUMNS {
        let expected = "10: ID, FORM, LEMMA, UPOS, XPOS, FEATS, HEAD, DEPREL, DEPS and MISC";
        return Err(Error::data(corpus.place(0, 0), format!("{found} columns"), expected));
    }
    let (mut text, mut lines) = (String::new(), Vec::new());
    for i in 0..corpus.sentences() {
        for token in corpus.sentence(i) {
            let cells: Vec<_> = (0..COLUMNS).map(|c| unescape(corpus.word(c, token))).collect();
            text += &cells.join("\t");
            text.push('\n');
            lines.push(corpus.lines[token]);
        }
        text.push('\n');
        lines.push(lines.last().map_or(0, |line| line + 1));
    }
    match parse_block(text.as_bytes(), &corpus.path, 1) {
        // What is wrong is said of the text that is not written; it stands in this line of the corpus.
        Err(Error::Data { place, problem, expected }) => {
            let line = lines.get(place.line - 1).copied().unwrap_or(place.line);
            Err(Error::Data { place: Place { line, ..place }, problem, expected })
        }
        Err(other) => Err(other),
        Ok(_) => Ok(out.write_all(text.as_bytes())),
    }
}
