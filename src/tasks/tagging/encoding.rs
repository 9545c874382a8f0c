//! From the words of a corpus to the numbers of a [`Tagging`] space, and the dictionaries that make the same numbers of another corpus.

use super::space::{HistoryLine, NO_CONTEXT, Reading, Tagging};
use super::task::Settings;
use super::transitions::{Order, Transitions};
use crate::corpus::Corpus;
use crate::error::{Error, Result};
use crate::index::Index;
use crate::read::template::{ABSENT, Template};
use crate::space::FeatureTable;
use std::sync::Arc;

/// Labels are counted in 16 bits, one of which stands for the begin mark.
pub const MOST_LABELS: usize = u16::MAX as usize - 1;

/// Room for as many features is made before any is seen: 6 MB.
const MOST_FORESEEN: usize = 3 << 17;

/// Numbers of 64-bit hashes, in the order of their first occurrence.
#[derive(Clone, Debug, Default)]
pub struct Dictionary {
    keys: Vec<u64>,
    index: Index,
}

impl Dictionary {
    /// The dictionary of these keys, numbered as they stand; `None` when one stands twice.
    pub fn of(keys: impl ExactSizeIterator<Item = u64>) -> Option<Self> {
        let count = keys.len();
        let mut dictionary = Dictionary { keys: Vec::with_capacity(count), index: Index::default() };
        dictionary.index.rebuild(&[], count);
        for key in keys {
            dictionary.intern(key);
        }
        (dictionary.len() == count).then_some(dictionary)
    }

    /// An empty dictionary with room for what may be in `corpus`, if that is not too much.
    fn for_corpus(corpus: &Corpus) -> Self {
        let mut dictionary = Dictionary::default();
        dictionary.index.rebuild(&[], (3 * corpus.tokens() / 2).min(MOST_FORESEEN));
        dictionary
    }

    /// How many keys there are.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// The number of `key`, if it has one.
    #[inline]
    pub fn find(&self, key: u64) -> Option<u32> {
        self.index.find(key, |_| true)
    }

    /// The number of `key`, the next one if it is new.
    #[inline]
    pub fn intern(&mut self, key: u64) -> u32 {
        self.index.make_room(&self.keys);
        match self.index.probe(key, |_| true) {
            Ok(number) => number,
            Err(place) => {
                let number = self.keys.len() as u32;
                self.index.take(place, key, number);
                self.keys.push(key);
                number
            }
        }
    }

    /// The keys in the order of their numbers.
    pub fn keys(&self) -> &[u64] {
        &self.keys
    }
}

/// What turns the words of a corpus into features: a template, the labels, and the dictionaries of what was seen in training.
#[derive(Clone, Debug)]
pub struct Encoding {
    /// The feature template.
    pub template: Template,
    /// The labels' names, sorted; a label's number is its place.
    pub labels: Vec<String>,
    /// The column the labels stood in.
    pub label_column: usize,
    /// Which label may follow which.
    pub transitions: Arc<Transitions>,
    /// Static features by their hashes; numbered first.
    pub(super) features: Dictionary,
    /// For each history line, what its labels were seen with.
    pub(super) contexts: Vec<Dictionary>,
    /// The numbers of the dynamic features; they come after the static ones.
    pub(super) history: Arc<[HistoryLine]>,
}

/// What to learn from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LabelColumn {
    /// The last column.
    #[default]
    Last,
    /// This one, from 0.
    At(usize),
}

impl LabelColumn {
    /// The column in a corpus of `columns` columns.
    ///
    /// # Errors
    /// When there is no such column, or no other beside it.
    pub fn in_corpus(self, corpus: &Corpus) -> Result<usize> {
        let columns = corpus.columns.len();
        let at = match self {
            LabelColumn::Last => columns.saturating_sub(1),
            LabelColumn::At(at) => at,
        };
        if columns < 2 {
            let problem = format!("{columns} column");
            return Err(Error::data(corpus.place(0, 0), problem, "words and a column of labels beside them"));
        }
        if at >= columns {
            let problem = format!("{columns} columns, so their numbers end with {}", columns - 1);
            return Err(Error::data(corpus.place(0, columns - 1), problem, format!("a column {at} with the labels")));
        }
        Ok(at)
    }
}

impl Encoding {
    /// Learns the labels and features of `corpus`, and gives it in numbers.
    ///
    /// # Errors
    /// When a column is missing that the labels or the template need, there are too many labels, the labels break the order that is asked for, or there is
    /// no column before them and no template that says what to look at.
    pub fn learn(corpus: &Corpus, settings: Settings) -> Result<(Encoding, Tagging)> {
        let Settings { template, labels, order, cutoff } = settings;
        let label_column = labels.in_corpus(corpus)?;
        let template = match (template, label_column) {
            (Some(template), _) => template,
            (None, 0) => {
                let expected = "above 0, or come with a template: the default one looks at the columns before it";
                return Err(Error::argument("label column", 0, expected));
            }
            (None, columns) => Template::default_for(columns),
        };
        let column = &corpus.columns[label_column];
        let mut names: Vec<String> = column.values.iter().map(String::from).collect();
        names.sort_unstable();
        if let Some(token) = column.cells.iter().position(|cell| *cell as usize == MOST_LABELS) {
            let problem = format!("one more label, {:?}", column.word(token));
            let expected = format!("at most {MOST_LABELS} different ones");
            return Err(Error::data(corpus.place(token, label_column), problem, expected));
        }
        let numbers: Vec<u32> =
            column.values.iter().map(|name| names.partition_point(|other| other.as_str() < name) as u32).collect();
        let gold: Vec<u32> = column.cells.iter().map(|cell| numbers[*cell as usize]).collect();

        let wanted = order.unwrap_or_else(|| Transitions::suggest(&names));
        let mut transitions = Transitions::new(wanted, &names);
        if let Some(token) = illegal(&transitions, corpus, &gold).first() {
            if order.is_some() {
                let place = corpus.place(*token, label_column);
                let expected = format!("a label that may stand there by {}, as --repair makes it", wanted.name());
                return Err(Error::data(place, format!("label {}", column.word(*token)), expected));
            }
            transitions = Transitions::new(Order::Free, &names);
        }
        if !transitions.go_on() {
            if order.is_some() {
                let expected = "an order that these labels can go on with to the end of any sentence";
                return Err(Error::argument("order", wanted.name(), expected));
            }
            transitions = Transitions::new(Order::Free, &names);
        }

        let mut encoding = Encoding {
            contexts: vec![Dictionary::default(); template.history().len()],
            template,
            labels: names,
            label_column,
            transitions: Arc::new(transitions),
            features: Dictionary::for_corpus(corpus),
            history: [].into(),
        };
        let Encoding { features, contexts, template, .. } = &mut encoding;
        let mut rows = read(template, corpus, |hash| features.intern(hash), |line, hash| contexts[line].intern(hash))?;
        if cutoff > 1 {
            *features = rows.cut(features.keys(), cutoff);
        }
        encoding.number_history()?;
        let space = encoding.space(corpus, rows, gold);
        Ok((encoding, space))
    }

    /// The same encoding with the features of another `corpus` beside its own, that corpus in numbers, and for each feature the number that it had
    /// before, or `u32::MAX` if it is new. Labels stay as they are.
    ///
    /// # Errors
    /// With the exact place, when a label is none of this encoding's or may not stand where it does, and when a column is missing that the template needs.
    pub fn extend(&self, corpus: &Corpus) -> Result<(Encoding, Tagging, Vec<u32>)> {
        let label_column = LabelColumn::At(self.label_column).in_corpus(corpus)?;
        let column = &corpus.columns[label_column];
        let refused = |token: usize, expected: String| {
            Error::data(corpus.place(token, label_column), format!("label {}", column.word(token)), expected)
        };
        let known = |name: &str| self.labels.binary_search_by(|label| label.as_str().cmp(name)).ok();
        let numbers: Vec<Option<u32>> = column.values.iter().map(|name| known(name).map(|n| n as u32)).collect();
        let mut gold = Vec::with_capacity(corpus.tokens());
        for (token, cell) in column.cells.iter().enumerate() {
            let expected = || format!("one of the model's labels: {}", self.labels.join(" "));
            gold.push(numbers[*cell as usize].ok_or_else(|| refused(token, expected()))?);
        }
        if let Some(token) = illegal(&self.transitions, corpus, &gold).first() {
            let order = self.transitions.order().name();
            return Err(refused(*token, format!("a label that may stand there by {order}, as --repair makes it")));
        }
        let mut encoding = self.clone();
        let Encoding { features, contexts, template, .. } = &mut encoding;
        let rows = read(template, corpus, |hash| features.intern(hash), |line, hash| contexts[line].intern(hash))?;
        encoding.number_history()?;
        let number = |n: usize, before: usize| if n < before { n as u32 } else { u32::MAX };
        let mut moved: Vec<u32> = (0..encoding.features.len()).map(|n| number(n, self.features.len())).collect();
        for (now, before) in encoding.history.iter().zip(self.history.iter()) {
            moved.extend((0..now.size).map(|n| before.moved(now, n).unwrap_or(u32::MAX)));
        }
        let space = encoding.space(corpus, rows, gold);
        Ok((encoding, space, moved))
    }

    /// Another corpus in the same numbers, as something to be tagged: features never seen in training are left out, and no right
    /// labels are known.
    ///
    /// # Errors
    /// When a column is missing that the template needs.
    pub fn apply(&self, corpus: &Corpus) -> Result<Tagging> {
        let feature = |hash| self.features.find(hash).unwrap_or(ABSENT);
        let context = |line: usize, hash| self.contexts[line].find(hash).unwrap_or(NO_CONTEXT);
        let rows = read(&self.template, corpus, feature, context)?;
        Ok(self.space(corpus, rows, Vec::new()))
    }

    /// How many features there are, static and dynamic.
    pub fn features(&self) -> usize {
        self.history.last().map_or(self.features.len(), |line| line.base as usize + line.size as usize)
    }

    /// Numbers the dynamic features after the static ones.
    pub(super) fn number_history(&mut self) -> Result<()> {
        let mut base = self.features.len();
        let mut history: Vec<HistoryLine> = Vec::new();
        let mut lines: Vec<_> = self.template.history().iter().map(|line| &line.labels[..]).enumerate().collect();
        // Those that look no further back than one label come first, and lines that look at the same labels stand side by side.
        lines.sort_by_key(|(_, labels)| (labels.iter().any(|k| *k < -1), *labels));
        for (line, labels) in lines {
            history.push(HistoryLine::new(line, labels, self.contexts[line].len(), self.labels.len(), base as u32));
            base += history[history.len() - 1].size as usize;
            if base > u32::MAX as usize {
                return Err(Error::argument("features", base, format!("at most {}", u32::MAX)));
            }
        }
        self.history = history.into();
        Ok(())
    }

    fn space(&self, corpus: &Corpus, rows: Rows, gold: Vec<u32>) -> Tagging {
        let (keyed, mut history): (Vec<HistoryLine>, Vec<HistoryLine>) =
            self.history.iter().cloned().partition(HistoryLine::is_keyed);
        for i in 1..history.len() {
            history[i].again = history[i - 1].labels == history[i].labels;
        }
        let mut keyed_starts = Vec::with_capacity(corpus.tokens() + 1);
        keyed_starts.push(0);
        let mut keyed_firsts = Vec::with_capacity(corpus.tokens() * keyed.len());
        let mut firsts = Vec::with_capacity(corpus.tokens() * history.len());
        for token in 0..corpus.tokens() {
            let contexts = &rows.contexts[token * self.history.len()..][..self.history.len()];
            let first = |line: &HistoryLine| line.first(contexts[line.line]);
            keyed_firsts.extend(keyed.iter().map(first).filter(|first| *first != NO_CONTEXT));
            keyed_starts.push(keyed_firsts.len());
            firsts.extend(history.iter().map(first));
        }
        let dynamic = history.first().map_or(self.features(), |line| line.base as usize) as u32;
        let table = FeatureTable::from_rows(self.features(), rows.starts, rows.ids);
        Tagging {
            table: Arc::new(table.keyed_by(keyed_starts, keyed_firsts, dynamic, history.len())),
            sentences: corpus.starts.windows(2).map(|pair| [pair[0], pair[1]]).collect(),
            gold: gold.into(),
            transitions: self.transitions.clone(),
            labels: self.labels.len(),
            far: Tagging::farthest(&self.history),
            history: history.into(),
            firsts: firsts.into(),
            reading: Reading::Only,
        }
    }
}

/// The static features and the contexts of every token.
struct Rows {
    starts: Vec<usize>,
    ids: Vec<u32>,
    contexts: Vec<u32>,
}

impl Rows {
    /// Leaves out the features, which are those of `keys`, that stand here fewer than `cutoff` times; returns the others, which keep their order.
    fn cut(&mut self, keys: &[u64], cutoff: u8) -> Dictionary {
        let mut numbers = vec![0; keys.len()];
        self.ids.iter().for_each(|id| numbers[*id as usize] += 1);
        let mut kept = Dictionary::default();
        for (number, key) in numbers.iter_mut().zip(keys) {
            *number = if *number < u32::from(cutoff) { ABSENT } else { kept.intern(*key) };
        }
        let (mut from, mut to) = (0, 0);
        for end in &mut self.starts[1..] {
            for i in from..*end {
                let number = numbers[self.ids[i] as usize];
                self.ids[to] = number;
                to += usize::from(number != ABSENT);
            }
            (from, *end) = (*end, to);
        }
        self.ids.truncate(to);
        kept
    }
}

/// The rows of `corpus`: each hash that the template makes is looked up by `feature`, which may find nothing, or, for a history
/// line, `context`.
fn read(
    template: &Template,
    corpus: &Corpus,
    mut feature: impl FnMut(u64) -> u32,
    mut context: impl FnMut(usize, u64) -> u32,
) -> Result<Rows> {
    let bound = template.bind(corpus)?;
    let mut numbered = bound.numbered();
    let mut rows = Rows {
        starts: Vec::with_capacity(corpus.tokens() + 1),
        ids: Vec::with_capacity(corpus.tokens() * template.observations()),
        contexts: Vec::with_capacity(corpus.tokens() * template.history().len()),
    };
    rows.starts.push(0);
    for i in 0..corpus.sentences() {
        let sentence = corpus.sentence(i);
        let width = template.observations();
        let known = numbered.observe(&sentence, |_, hash| feature(hash));
        for token in 0..sentence.len() {
            let row = &known[token * width..(token + 1) * width];
            match row.contains(&ABSENT) {
                true => rows.ids.extend(row.iter().filter(|number| **number != ABSENT)),
                false => rows.ids.extend_from_slice(row),
            }
            rows.starts.push(rows.ids.len());
        }
        rows.contexts.extend_from_slice(numbered.contexts(&sentence, &mut context));
    }
    Ok(rows)
}

/// The tokens whose labels may not stand where they do; a label after such a one is held against it all the same.
pub(super) fn illegal(transitions: &Transitions, corpus: &Corpus, gold: &[u32]) -> Vec<usize> {
    let mut found = Vec::new();
    for sentence in (0..corpus.sentences()).map(|i| corpus.sentence(i)) {
        let mut previous = transitions.begin();
        for token in sentence.clone() {
            let left = (sentence.end - token) as u32;
            if !transitions.allows(previous, gold[token], left) {
                found.push(token);
            }
            previous = gold[token];
        }
    }
    found
}
