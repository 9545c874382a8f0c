//! Labels of spans that do not follow their own rule, mended.

use super::encoding;
use super::transitions::{Order, Transitions};
use crate::corpus::{Column, Corpus};
use crate::error::{Error, Place, Result};
use crate::score::Scheme;
use std::fmt;

/// A label that was changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mended {
    /// Where it stands.
    pub place: Place,
    /// What it was.
    pub was: String,
    /// What it is.
    pub is: String,
}

impl fmt::Display for Mended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} is now {}", self.place, self.was, self.is)
    }
}

/// The tokens whose labels in `column` may not stand where they do by `order`, which is by default the one that the labels suggest; and that order.
///
/// # Panics
/// When there is no such column.
pub fn illegal(corpus: &Corpus, column: usize, order: Option<Order>) -> (Vec<usize>, Order) {
    let Column { cells, values } = &corpus.columns[column];
    let names: Vec<String> = values.iter().map(String::from).collect();
    let order = order.unwrap_or_else(|| Transitions::suggest(&names));
    (encoding::illegal(&Transitions::new(order, &names), corpus, cells), order)
}

/// Makes the labels in `column` follow `order`, by default the one that they suggest. A sentence with a label that may not stand where it does is spelled anew:
/// with the spans that [`Scheme::spans`] finds in it, which are those of `conlleval.pl`. So scores of spans are the same before and after. What was changed is
/// returned, in the order of the tokens.
///
/// ```
/// use rollin::read::conll;
/// use rollin::tasks::tagging::repair;
///
/// let mut corpus = conll::parse(b"of O\nNew I-LOC\nYork I-LOC\n", "city".as_ref(), 1)?;
/// let mended = repair(&mut corpus, 1, None)?;
/// assert_eq!(mended[0].to_string(), "city:2:5: I-LOC is now B-LOC");
/// assert_eq!((mended.len(), corpus.word(1, 1), corpus.word(1, 2)), (1, "B-LOC", "I-LOC"));
/// # Ok::<(), rollin::Error>(())
/// ```
///
/// # Errors
/// When there is something to mend, but the labels are not all `O` or a prefix and a type.
pub fn repair(corpus: &mut Corpus, column: usize, order: Option<Order>) -> Result<Vec<Mended>> {
    let (illegal, order) = illegal(corpus, column, order);
    let Some(first) = illegal.first() else { return Ok(Vec::new()) };
    let names: Vec<&str> = corpus.columns[column].values.iter().collect();
    let scheme = Scheme::new(&names);
    if !scheme.is_spans() {
        let problem = format!("label {}, and not all labels are those of spans", corpus.word(column, *first));
        return Err(Error::data(
            corpus.place(*first, column),
            problem,
            "labels that are O or B-, I-, L-, U- and a type",
        ));
    }
    let letters = Letters::of(&names);
    let (mut mended, mut anew) = (Vec::new(), Column::default());
    let mut illegal = illegal.into_iter().peekable();
    for sentence in (0..corpus.sentences()).map(|i| corpus.sentence(i)) {
        let mut broken = false;
        while illegal.next_if(|token| *token < sentence.end).is_some() {
            broken = true;
        }
        let start = anew.cells.len();
        sentence.clone().for_each(|token| anew.push(corpus.word(column, token)));
        if !broken {
            continue;
        }
        let spelled = letters.spell(order, &scheme, &corpus.columns[column].cells[sentence.clone()]);
        anew.cells.truncate(start);
        for (token, label) in sentence.zip(spelled) {
            let was = corpus.word(column, token);
            if was != label {
                let place = corpus.place(token, column);
                mended.push(Mended { place, was: was.to_owned(), is: label.clone() });
            }
            anew.push(&label);
        }
    }
    // Anew from its words: a label that is nowhere left is none.
    let mut words = Column::default();
    anew.cells.iter().for_each(|cell| words.push(anew.values.get(*cell)));
    corpus.columns[column] = words;
    Ok(mended)
}

/// The letters for the last token of a span and for a span of one token.
struct Letters {
    last: char,
    unit: char,
}

impl Letters {
    /// Those that these labels have: BILOU's, or those of IOBES.
    fn of(names: &[&str]) -> Self {
        match names.iter().any(|name| name.starts_with("E-") || name.starts_with("S-")) {
            true => Letters { last: 'E', unit: 'S' },
            false => Letters { last: 'L', unit: 'U' },
        }
    }

    /// The spans of these labels, one sentence's, as labels that follow `order`.
    fn spell(&self, order: Order, scheme: &Scheme, labels: &[u32]) -> Vec<String> {
        let mut spelled = vec!["O".to_owned(); labels.len()];
        for (start, end, kind) in scheme.spans(labels) {
            for (at, label) in spelled.iter_mut().enumerate().take(end).skip(start) {
                let prefix = match (order, at == start, at + 1 == end) {
                    (Order::Bilou, true, true) => self.unit,
                    (Order::Bilou, false, true) => self.last,
                    (_, true, _) => 'B',
                    (_, false, _) => 'I',
                };
                *label = format!("{prefix}-{}", scheme.kinds()[kind as usize]);
            }
        }
        spelled
    }
}
