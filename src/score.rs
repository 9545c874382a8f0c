//! Measures of a tagging: token accuracy, and precision, recall and F1 of the chunks that its labels spell.
//!
//! The rules are those of `conlleval.pl`, the scorer of the CoNLL-2000 and CoNLL-2003 shared tasks (version 2004-01-26).
//! A label is split at its first `-` into prefix and type; without a `-` all of it is prefix and its type is empty.
//! Whether a chunk starts or ends between two labels depends on these two labels alone:
//!
//! - a chunk starts at `B` after `B`, `I` or `O`; at `I` or `E` after `O` or `E`;
//! - a chunk ends after `B` or `I` before `B` or `O`; after `E` before `E`, `I` or `O`;
//! - where the type changes, the chunk before ends and another starts; `O` and `.` are never part of one;
//! - `[` and `]` are chunks of one token.
//!
//! The script of 2004 knows no `S`, and joins `E-X B-X` into one chunk. Its later extension to IOBES, followed here, lets a
//! chunk start at `S`, end after `S`, and end between `E` and `B`. Labels without `S` and without `E-X B-X` score the same
//! under both. BILOU's `L` and `U` are read as `E` and `S`.
//!
//! A predicted chunk is correct if a gold chunk has the same first token, last token and type. Every sentence is scored as if it
//! were the whole file, so scores of parts add up to the score of the whole. A measure whose denominator is zero is 0.

use crate::{Error, Result};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

/// The part of a label before its first `-`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Prefix {
    B,
    I,
    E,
    S,
    O,
    Dot,
    Bracket,
    Other,
}

/// What scoring needs to know of a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Tag {
    prefix: Prefix,
    /// Index into the scheme's types.
    kind: u32,
    /// The first label with the same prefix and type: labels are right or wrong by this number.
    label: u32,
}

/// What stands before and after every sentence.
const OUTSIDE: Tag = Tag { prefix: Prefix::O, kind: 0, label: u32::MAX };

/// Label names, and the chunks they spell. A label's id is its place in the list.
///
/// Begin with the labels that a model predicts, then ask [`Scheme::id`] for each gold label: one that the model does not know
/// gets an id too, and so counts as an error wherever it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scheme {
    labels: Vec<String>,
    /// By [`spelling`].
    ids: BTreeMap<String, u32>,
    tags: Vec<Tag>,
    /// Names of the types by number; number 0 is the empty type.
    kinds: Vec<String>,
    spans: bool,
}

impl Scheme {
    /// The scheme in which `labels[i]` has id `i`.
    pub fn new(labels: &[impl AsRef<str>]) -> Self {
        let mut scheme = Scheme {
            labels: Vec::with_capacity(labels.len()),
            ids: BTreeMap::new(),
            tags: Vec::with_capacity(labels.len()),
            kinds: vec![String::new()],
            spans: spell_spans(labels),
        };
        for label in labels {
            scheme.push(label.as_ref());
        }
        scheme
    }

    /// The id of `label`, which is added if it is new. Of labels with the same prefix and type, the first one's.
    pub fn id(&mut self, label: &str) -> u32 {
        match self.ids.get(spelling(label)) {
            Some(&id) => id,
            None => self.push(label),
        }
    }

    /// The labels, by id.
    pub fn labels(&self) -> &[String] {
        &self.labels
    }

    /// Whether the labels given to [`Scheme::new`] look like spans: each is `O` or begins with `B-`, `I-`, `E-`, `S-`, `L-` or
    /// `U-`, and at least one does the latter. Otherwise, as with parts of speech, accuracy is the only measure that means something.
    pub fn is_spans(&self) -> bool {
        self.spans
    }

    /// The chunks that one sentence's `labels` spell, in order: first token, one beyond the last, and number of the type ([`Scheme::kinds`]).
    ///
    /// # Panics
    /// When a label is not in the scheme.
    pub fn spans(&self, labels: &[u32]) -> Vec<(usize, usize, u32)> {
        let (mut spans, mut open, mut last) = (Vec::new(), None, OUTSIDE);
        for (at, label) in labels.iter().enumerate() {
            let tag = self.tags[*label as usize];
            if ends(last, tag)
                && let Some(start) = open.take()
            {
                spans.push((start, at, last.kind));
            }
            if starts(last, tag) {
                open = Some(at);
            }
            last = tag;
        }
        spans.extend(open.map(|start| (start, labels.len(), last.kind)));
        spans
    }

    /// The names of the types by number; number 0 is the empty one.
    pub fn kinds(&self) -> &[String] {
        &self.kinds
    }

    fn push(&mut self, label: &str) -> u32 {
        let id = self.labels.len() as u32;
        let (prefix, kind) = split(label);
        let kind = self.kinds.iter().position(|known| known == kind).unwrap_or_else(|| {
            self.kinds.push(kind.to_owned());
            self.kinds.len() - 1
        });
        let first = *self.ids.entry(spelling(label).to_owned()).or_insert(id);
        self.tags.push(Tag { prefix: Prefix::of(prefix), kind: kind as u32, label: first });
        self.labels.push(label.to_owned());
        id
    }
}

impl Prefix {
    fn of(text: &str) -> Self {
        match text {
            "B" => Prefix::B,
            "I" => Prefix::I,
            "E" | "L" => Prefix::E,
            "S" | "U" => Prefix::S,
            "O" => Prefix::O,
            "." => Prefix::Dot,
            "[" | "]" => Prefix::Bracket,
            _ => Prefix::Other,
        }
    }
}

/// Prefix and type of a label.
fn split(label: &str) -> (&str, &str) {
    label.split_once('-').unwrap_or((label, ""))
}

/// One spelling for all labels with the same prefix and type: `X-` has the empty type, as `X` has.
fn spelling(label: &str) -> &str {
    match split(label) {
        (prefix, "") => prefix,
        _ => label,
    }
}

fn spell_spans(labels: &[impl AsRef<str>]) -> bool {
    let inside = |label: &str| matches!(label.as_bytes(), [b'B' | b'I' | b'E' | b'S' | b'L' | b'U', b'-', ..]);
    labels.iter().all(|label| label.as_ref() == "O" || inside(label.as_ref()))
        && labels.iter().any(|label| inside(label.as_ref()))
}

/// Whether a chunk starts at `tag`, which follows `last`.
#[inline]
fn starts(last: Tag, tag: Tag) -> bool {
    use Prefix::*;
    match tag.prefix {
        O | Dot => false,
        Bracket => true,
        _ if last.kind != tag.kind => true,
        B | S => matches!(last.prefix, B | I | O | E | S),
        I | E => matches!(last.prefix, O | E | S),
        Other => false,
    }
}

/// Whether a chunk that reaches `last` ends there, before `tag`.
#[inline]
fn ends(last: Tag, tag: Tag) -> bool {
    use Prefix::*;
    match last.prefix {
        O | Dot => false,
        Bracket => true,
        _ if last.kind != tag.kind => true,
        B | I => matches!(tag.prefix, B | S | O),
        E | S => matches!(tag.prefix, B | I | E | S | O),
        Other => false,
    }
}

/// Numbers of chunks, of one type or of all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Chunks {
    /// Chunks in the gold labels.
    pub gold: u64,
    /// Chunks in the predicted labels.
    pub predicted: u64,
    /// Predicted chunks that are gold chunks.
    pub correct: u64,
}

impl Chunks {
    /// Correct chunks per predicted chunk; 0 if none was predicted.
    pub fn precision(&self) -> f64 {
        ratio(self.correct, self.predicted)
    }

    /// Correct chunks per gold chunk; 0 if there is none.
    pub fn recall(&self) -> f64 {
        ratio(self.correct, self.gold)
    }

    /// The harmonic mean of precision and recall; 0 if no chunk is correct.
    pub fn f1(&self) -> f64 {
        ratio(2 * self.correct, self.gold + self.predicted)
    }

    fn merge(&mut self, other: Chunks) {
        self.gold += other.gold;
        self.predicted += other.predicted;
        self.correct += other.correct;
    }
}

fn ratio(part: u64, whole: u64) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}

/// Counts over sentences that were tagged; what can be asked of them are the measures.
///
/// ```
/// use rollin::score::{Scheme, Score};
///
/// let mut scheme = Scheme::new(&["B-NP", "I-NP", "O"]);
/// let gold = ["B-NP", "I-NP", "O", "B-PP"].map(|label| scheme.id(label));
/// let mut score = Score::new(scheme);
/// score.add(&gold, &[0, 1, 2, 0])?;
/// assert_eq!((score.accuracy(), score.f1()), (0.75, 0.5));
/// # Ok::<(), rollin::Error>(())
/// ```
///
/// As text it is the table that `conlleval.pl` prints; as data it has the counts beside the measures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Score {
    scheme: Arc<Scheme>,
    tokens: u64,
    right: u64,
    /// By number of the type.
    chunks: Vec<Chunks>,
}

impl Score {
    /// Nothing counted yet.
    pub fn new(scheme: impl Into<Arc<Scheme>>) -> Self {
        let scheme = scheme.into();
        let chunks = vec![Chunks::default(); scheme.kinds.len()];
        Score { scheme, tokens: 0, right: 0, chunks }
    }

    /// Counts one sentence of `gold` labels and the labels `predicted` for it. An error counts nothing: sentences of
    /// different lengths, or an id that is not in the scheme.
    pub fn add(&mut self, gold: &[u32], predicted: &[u32]) -> Result<()> {
        self.check(gold, predicted)?;
        let tags = &self.scheme.tags;
        let mut last = (OUTSIDE, OUTSIDE);
        // Whether a gold and a predicted chunk, of the same type, began at the same token and have not ended since.
        let mut inside = false;
        for (&g, &p) in gold.iter().zip(predicted) {
            let (g, p) = (tags[g as usize], tags[p as usize]);
            self.right += u64::from(g.label == p.label);
            if inside {
                match (ends(last.0, g), ends(last.1, p)) {
                    (true, true) => {
                        self.chunks[last.0.kind as usize].correct += 1;
                        inside = false;
                    }
                    (false, false) => inside = g.kind == p.kind,
                    _ => inside = false,
                }
            }
            let began = (starts(last.0, g), starts(last.1, p));
            self.chunks[g.kind as usize].gold += u64::from(began.0);
            self.chunks[p.kind as usize].predicted += u64::from(began.1);
            inside |= began == (true, true) && g.kind == p.kind;
            last = (g, p);
        }
        self.chunks[last.0.kind as usize].correct += u64::from(inside);
        self.tokens += gold.len() as u64;
        Ok(())
    }

    fn check(&self, gold: &[u32], predicted: &[u32]) -> Result<()> {
        if gold.len() != predicted.len() {
            let value = format!("{} labels", predicted.len());
            return Err(Error::argument("predicted", value, format!("as long as gold, {} labels", gold.len())));
        }
        let labels = self.scheme.labels.len();
        for (name, ids) in [("gold", gold), ("predicted", predicted)] {
            if let Some(id) = ids.iter().find(|&&id| id as usize >= labels) {
                return Err(Error::argument(name, format!("label id {id}"), format!("below {labels}")));
            }
        }
        Ok(())
    }

    /// Counts what `other` has counted. An error if it counts by a scheme with other labels.
    pub fn merge(&mut self, other: &Score) -> Result<()> {
        if !Arc::ptr_eq(&self.scheme, &other.scheme) && self.scheme.labels != other.scheme.labels {
            let value = format!("a score over {} labels", other.scheme.labels.len());
            let expected = format!("over the same {} labels in the same order", self.scheme.labels.len());
            return Err(Error::argument("other", value, expected));
        }
        self.tokens += other.tokens;
        self.right += other.right;
        self.chunks.iter_mut().zip(&other.chunks).for_each(|(mine, &more)| mine.merge(more));
        Ok(())
    }

    /// The scheme that says what the labels mean.
    pub fn scheme(&self) -> &Scheme {
        &self.scheme
    }

    /// Tokens counted.
    pub fn tokens(&self) -> u64 {
        self.tokens
    }

    /// Tokens whose predicted label is the gold one: the same prefix and the same type.
    pub fn right(&self) -> u64 {
        self.right
    }

    /// Right tokens per token; 0 if there is none.
    pub fn accuracy(&self) -> f64 {
        ratio(self.right, self.tokens)
    }

    /// Chunks of all types together.
    pub fn chunks(&self) -> Chunks {
        self.chunks.iter().fold(Chunks::default(), |mut sum, &chunks| {
            sum.merge(chunks);
            sum
        })
    }

    /// [`Chunks::precision`] over all types.
    pub fn precision(&self) -> f64 {
        self.chunks().precision()
    }

    /// [`Chunks::recall`] over all types.
    pub fn recall(&self) -> f64 {
        self.chunks().recall()
    }

    /// [`Chunks::f1`] over all types.
    pub fn f1(&self) -> f64 {
        self.chunks().f1()
    }

    /// The types of which a chunk was gold or predicted, sorted by name.
    pub fn types(&self) -> Vec<(&str, Chunks)> {
        let seen = |chunks: &Chunks| chunks.gold + chunks.predicted > 0;
        let mut types: Vec<_> = (self.scheme.kinds.iter().map(String::as_str))
            .zip(self.chunks.iter().copied())
            .filter(|(_, chunks)| seen(chunks))
            .collect();
        types.sort_unstable_by_key(|&(name, _)| name);
        types
    }
}

/// The table of `conlleval.pl`, which ends with a newline.
impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = self.chunks();
        write!(f, "processed {} tokens with {} phrases; ", self.tokens, all.gold)?;
        writeln!(f, "found: {} phrases; correct: {}.", all.predicted, all.correct)?;
        if self.tokens > 0 {
            let accuracy = ratio(100 * self.right, self.tokens);
            writeln!(f, "accuracy: {accuracy:6.2}%; {}", Percent(all))?;
        }
        for (name, chunks) in self.types() {
            writeln!(f, "{name:>17}: {}  {}", Percent(chunks), chunks.predicted)?;
        }
        Ok(())
    }
}

/// The measures of chunks as `conlleval.pl` prints them.
struct Percent(Chunks);

impl fmt::Display for Percent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Chunks { gold, predicted, correct } = self.0;
        let (precision, recall) = (ratio(100 * correct, predicted), ratio(100 * correct, gold));
        let f1 = ratio(200 * correct, gold + predicted);
        write!(f, "precision: {precision:6.2}%; recall: {recall:6.2}%; FB1: {f1:6.2}")
    }
}

impl Serialize for Score {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Row<'a> {
            #[serde(rename = "type", skip_serializing_if = "Option::is_none")]
            name: Option<&'a str>,
            #[serde(flatten)]
            chunks: Chunks,
            precision: f64,
            recall: f64,
            f1: f64,
        }
        #[derive(Serialize)]
        struct Report<'a> {
            tokens: u64,
            right: u64,
            accuracy: f64,
            chunks: Row<'a>,
            types: Vec<Row<'a>>,
        }
        let row = |name, chunks: Chunks| {
            let (precision, recall, f1) = (chunks.precision(), chunks.recall(), chunks.f1());
            Row { name, chunks, precision, recall, f1 }
        };
        Report {
            tokens: self.tokens,
            right: self.right,
            accuracy: self.accuracy(),
            chunks: row(None, self.chunks()),
            types: self.types().into_iter().map(|(name, chunks)| row(Some(name), chunks)).collect(),
        }
        .serialize(serializer)
    }
}
