//! Features spelled out as the text they are the hashes of, as CRF++ and Wapiti print them.

use super::pattern::{self, Line, Part, Row};
use crate::corpus::{Corpus, MARK};
use std::ops::Range;

/// A template applied to a corpus, to spell out its features.
///
/// ```
/// use rollin::read::{conll, template::Template};
///
/// let corpus = conll::parse(b"The DT\ncat NN\n", "pets".as_ref(), 1)?;
/// let template = Template::parse("U1:%X[-1,0]\nU2:%m[0,0,\"..$\"]/%x[0,1]\nB\n", "two.template".as_ref())?;
/// let mut features = Vec::new();
/// template.speller(&corpus)?.observe(&corpus.sentence(0), 1, |feature| features.push(feature.to_owned()));
/// assert_eq!(features, ["U1:the", "U2:at/NN"]);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Speller<'a> {
    corpus: &'a Corpus,
    patterns: Vec<(char, Vec<Part>)>,
    pad: Option<(String, String)>,
}

impl<'a> Speller<'a> {
    /// The template that is `text`, which was parsed before, for a corpus that has all its columns.
    pub(super) fn new(text: &str, corpus: &'a Corpus) -> Self {
        let (mut patterns, mut pad) = (Vec::new(), None);
        for line in text.strip_prefix(MARK).unwrap_or(text).split('\n') {
            match pattern::line(line.trim_ascii_end()) {
                Ok(Line::Pad { before, after }) => pad = Some((before, after)),
                // A `B` is one about labels, and so is whatever has a label in it.
                Ok(Line::Pattern { kind, parts })
                    if kind != 'B' && !parts.iter().any(|part| matches!(part, Part::Label(_))) =>
                {
                    patterns.push((kind, parts));
                }
                _ => {}
            }
        }
        Speller { corpus, patterns, pad }
    }

    /// Hands the observation features of `token`, a token of `sentence`, to `tell`, in the template's order: each is its line's first character
    /// and the rest of the line with all commands replaced by what was found.
    pub fn observe(&self, sentence: &Range<usize>, token: usize, mut tell: impl FnMut(&str)) {
        let mut feature = String::new();
        for (kind, parts) in &self.patterns {
            feature.clear();
            feature.push(*kind);
            for part in parts {
                match part {
                    Part::Text(text) => feature.push_str(text),
                    Part::Cell { transform, row, column, .. } => {
                        feature.push_str(&match self.at(sentence, token, *row) {
                            Ok(at) => transform.text(self.corpus.word(*column as usize, at)),
                            Err(pad) => transform.text(&pad),
                        });
                    }
                    Part::Label(_) => {}
                }
            }
            tell(&feature);
        }
    }

    /// The token that `row` means, or what stands for it outside the sentence.
    fn at(&self, sentence: &Range<usize>, token: usize, row: Row) -> Result<usize, String> {
        let (anchor, row) = match row {
            Row::Relative(n) => (token, n),
            Row::First(n) => (sentence.start, n),
            Row::End(n) => (sentence.end, n),
        };
        let at = anchor as i64 + i64::from(row);
        let (start, end) = (sentence.start as i64, sentence.end as i64);
        match (&self.pad, at < start) {
            _ if (start..end).contains(&at) => Ok(at as usize),
            (Some((before, _)), true) => Err(before.clone()),
            (Some((_, after)), false) => Err(after.clone()),
            (None, true) => Err(format!("_B-{}", start - at)),
            (None, false) => Err(format!("_B+{}", at - end + 1)),
        }
    }
}
