//! Features spelled out as the text they are the hashes of, as CRF++ and Wapiti print them.

use super::pattern::{self, Line, Part, Row};
use crate::corpus::{Corpus, MARK};
use std::ops::Range;

/// Stands for a label in a feature that looks at one. No corpus has it.
pub const HOLE: char = '\0';

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
    /// Those that look at labels.
    history: Vec<(char, Vec<Part>)>,
    pad: Option<(String, String)>,
}

impl<'a> Speller<'a> {
    /// The template that is `text`, which was parsed before, for a corpus that has all its columns.
    pub(super) fn new(text: &str, corpus: &'a Corpus) -> Self {
        let (mut patterns, mut history, mut pad) = (Vec::new(), Vec::new(), None);
        for line in text.strip_prefix(MARK).unwrap_or(text).split('\n') {
            match pattern::line(line.trim_ascii_end()) {
                Ok(Line::Pad { before, after }) => pad = Some((before, after)),
                Ok(Line::Pattern { kind, parts }) => {
                    for parts in pattern::features(kind, parts) {
                        let kinds = if pattern::looks_back(&parts) { &mut history } else { &mut patterns };
                        kinds.push((kind, parts));
                    }
                }
                _ => {}
            }
        }
        Speller { corpus, patterns, history, pad }
    }

    /// Hands the observation features of `token`, a token of `sentence`, to `tell`, in the template's order: each is its line's first character
    /// and the rest of the line with all commands replaced by what was found.
    pub fn observe(&self, sentence: &Range<usize>, token: usize, tell: impl FnMut(&str)) {
        self.spell(&self.patterns, sentence, token, tell);
    }

    /// The same for the history features, in the order of [`Template::history`](super::Template::history): where one looks at a label stand its place and
    /// [`HOLE`], as in `B:y[-1]=` and the hole.
    pub fn contexts(&self, sentence: &Range<usize>, token: usize, tell: impl FnMut(&str)) {
        self.spell(&self.history, sentence, token, tell);
    }

    fn spell(&self, patterns: &[(char, Vec<Part>)], sentence: &Range<usize>, token: usize, mut tell: impl FnMut(&str)) {
        let mut feature = String::new();
        for (kind, parts) in patterns {
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
                    Part::Label(k) => {
                        // One that is added has nothing that parts it from what stands before.
                        let gap = match feature.chars().last() {
                            _ if feature.len() == 1 => ":",
                            Some(last) if last.is_alphanumeric() => "|",
                            _ => "",
                        };
                        feature.push_str(&format!("{gap}y[{k}]={HOLE}"));
                    }
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
