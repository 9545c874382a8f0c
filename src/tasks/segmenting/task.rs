//! Segmentation as a [`Task`]: what the program's verbs need of it.

use super::space::{Divider, Segmenting, Segments, code};
use crate::corpus::{Column, Corpus};
use crate::error::{Error, Result};
use crate::read::conll::Block;
use crate::read::template::Template;
use crate::score::{Scheme, Score};
use crate::space::{Action, Imitation};
use crate::tasks::tagging::{self, Columns, Encoding, LabelColumn, Order};
use crate::tasks::{Arrays, Fact, Model, Task, write_labels};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

/// A trained segmenter: what turns words into features, and the policy.
pub type Segmenter = Model<Spans>;

/// The longest span there may be.
pub const MOST_LENGTH: u32 = 64;
/// How far from the first token shapes and tags are still seen all together: longer rows of them are too rare to learn from.
const PATH: u32 = 4;
/// More actions than this are too many to score.
const MOST_ACTIONS: usize = 1 << 16;
/// The label of what is outside all spans.
const OUTSIDE: &str = "O";

/// What a segmenter learns with.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The feature template; see [`default_template`].
    pub template: Template,
    /// The column with the labels.
    pub labels: LabelColumn,
    /// The longest span that an action takes, 1 to [`MOST_LENGTH`].
    pub longest: u32,
}

impl Settings {
    /// Those with the default template for all columns of `corpus` before the labels.
    ///
    /// # Errors
    /// When there is no such column, none before it, or no such length.
    pub fn default_for(corpus: &Corpus, labels: LabelColumn, longest: u32) -> Result<Self> {
        check_longest(longest)?;
        let columns = labels.in_corpus(corpus)?;
        if columns == 0 {
            return Err(Error::argument("label column", 0, "above 0: the template looks at the columns before it"));
        }
        Ok(Settings { template: default_template(columns, longest), labels, longest })
    }
}

fn check_longest(longest: u32) -> Result<()> {
    if (1..=MOST_LENGTH).contains(&longest) {
        return Ok(());
    }
    Err(Error::argument("longest span", longest, format!("1 to {MOST_LENGTH}")))
}

/// [`Template::default_for`] so many columns, and the tokens of spans of up to `longest` tokens and the one behind: words, pairs of shapes and of tags, and,
/// as far as four tokens on, all shapes and all tags from the first to that one.
pub fn default_template(columns: usize, longest: u32) -> Template {
    let mut text = Template::default_for(columns).text().to_owned() + "\n# Over the span, and one token beyond.\n";
    for j in 1..=longest.min(MOST_LENGTH) {
        let path = |name: &str, cell: &dyn Fn(u32) -> String| match j {
            1..=PATH => format!("U{name}{j}:{}\n", (0..=j).map(cell).collect::<Vec<_>>().join("/")),
            _ => String::new(),
        };
        if j > 2 {
            text += &format!("Usw{j}:%X[{j},0]\n");
        }
        text += &format!("Uss{j}:%s[{},0,4]/%s[{j},0,4]\n", j - 1);
        text += &path("sp", &|i| format!("%s[{i},0,2]"));
        for c in 1..columns.min(16) {
            text += &format!("U{c}st{j}:%x[{},{c}]/%x[{j},{c}]\n", j - 1);
            text += &path(&format!("{c}sp"), &|i| format!("%x[{i},{c}]"));
        }
    }
    match Template::parse(&text, Path::new("<default template>")) {
        Ok(template) => template,
        Err(fault) => unreachable!("every default is tested to parse: {fault}"),
    }
}

/// What turns the words of a corpus into features and spans: an [`Encoding`] whose labels are those of spans, `O` and `B-` with a type, and how long a span of each may be.
#[derive(Clone, Debug)]
pub struct Spans {
    base: Encoding,
    longest: Vec<u32>,
    segments: Arc<Segments>,
}

/// What a model file says of a segmenter.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    base: tagging::Header,
    longest: Vec<u32>,
}

impl Spans {
    /// The segmenter of these labels.
    fn new(base: Encoding, longest: Vec<u32>) -> Result<Self, String> {
        let outside = base.labels.iter().position(|label| label == OUTSIDE).ok_or("it has no label O")?;
        let fine = longest.len() == base.labels.len() && longest.iter().all(|l| (1..=MOST_LENGTH).contains(l));
        let actions: usize = longest.iter().map(|length| *length as usize).sum();
        if !fine || actions > MOST_ACTIONS || longest[outside] != 1 || base.transitions.order() != Order::Free {
            return Err("its spans are not as long as spans may be".into());
        }
        if base.template.looks_ahead() {
            return Err("its template looks at labels ahead, and spans are read once".into());
        }
        let segments = Arc::new(Segments::new(&longest, outside as u32));
        Ok(Spans { base, longest, segments })
    }

    /// The column of the right labels.
    pub fn label_column(&self) -> usize {
        self.base.label_column
    }

    /// Looks for the right labels in another column.
    pub fn set_label_column(&mut self, column: usize) {
        self.base.label_column = column;
    }

    /// The spans of a sentence of `tokens` tokens by the first of `actions`, which are then no longer among them: first token, one beyond the last, label.
    fn taken(&self, actions: &mut &[Action], tokens: usize) -> Vec<(usize, usize, u32)> {
        let (mut spans, mut start) = (Vec::new(), 0);
        while let Some((action, rest)) = actions.split_first()
            && start < tokens
        {
            let segment = self.segments.get(*action);
            let end = start + segment.length as usize;
            spans.push((start, end, segment.label));
            (start, *actions) = (end, rest);
        }
        spans
    }

    /// The IOB2 label of every token by `actions`, those of all sentences.
    fn labels<'s>(&'s self, corpus: &Corpus, mut actions: &[Action]) -> Vec<(&'static str, &'s str)> {
        let mut labels = Vec::with_capacity(corpus.tokens());
        for i in 0..corpus.sentences() {
            for (start, end, label) in self.taken(&mut actions, corpus.sentence(i).len()) {
                let kind = self.base.labels[label as usize].strip_prefix("B-");
                labels.extend((start..end).map(|at| match kind {
                    None => (OUTSIDE, ""),
                    Some(kind) => (if at == start { "B-" } else { "I-" }, kind),
                }));
            }
        }
        labels
    }
}

/// The spans that the labels in `column` spell, for each sentence: first token of the corpus, one beyond the last, type.
fn spans_of<'s>(corpus: &Corpus, column: usize, scheme: &'s Scheme) -> Vec<(usize, usize, &'s str)> {
    let cells = &corpus.columns[column].cells;
    let sentence = |i: usize| {
        let tokens = corpus.sentence(i);
        let found = scheme.spans(&cells[tokens.clone()]).into_iter();
        found.map(move |(a, b, kind)| (tokens.start + a, tokens.start + b, scheme.kinds()[kind as usize].as_str()))
    };
    (0..corpus.sentences()).flat_map(sentence).collect()
}

/// The scheme of the labels in `column`, by the numbers of its words.
fn scheme_of(corpus: &Corpus, column: usize) -> Result<Scheme> {
    let values = &corpus.columns[column].values;
    let names: Vec<&str> = values.iter().collect();
    let scheme = Scheme::new(&names);
    if scheme.is_spans() {
        return Ok(scheme);
    }
    let odd = values.iter().position(|name| name != OUTSIDE && !Scheme::new(&[name]).is_spans());
    let token = corpus.columns[column].cells.iter().position(|cell| odd == Some(*cell as usize)).unwrap_or(0);
    let problem = match odd {
        Some(_) => format!("label {}", corpus.word(column, token)),
        None => "no span in the whole corpus".to_owned(),
    };
    let expected = "labels of spans: O, or B-, I-, L-, U-, E- or S- and a type";
    Err(Error::data(corpus.place(token, column), problem, expected))
}

impl Task for Spans {
    const NAME: &'static str = "segmenting";
    type Data = Corpus;
    type Settings = Settings;
    type Space = Segmenting;
    type Expert = Divider;
    type Score = Score;
    type Header = Header;
    type Stream = Columns;

    fn parse(text: &[u8], path: &Path) -> Result<Corpus> {
        Encoding::parse(text, path)
    }

    fn parse_block(&self, block: &Block, path: &Path, stream: &mut Columns) -> Result<Option<Corpus>> {
        self.base.parse_block(block, path, stream)
    }

    /// A label's spans may be as long as the longest in `corpus`, and no longer than the settings say.
    fn learn(corpus: &Corpus, settings: Settings) -> Result<(Self, Imitation<Segmenting, Divider>)> {
        check_longest(settings.longest)?;
        if settings.template.looks_ahead() {
            let expected = "one without %y[0] and the like: spans are read once";
            return Err(Error::argument("template", "looking ahead", expected));
        }
        let column = settings.labels.in_corpus(corpus)?;
        let scheme = scheme_of(corpus, column)?;
        let spans = spans_of(corpus, column, &scheme);
        let mut names = vec![OUTSIDE.to_owned(); corpus.tokens()];
        for (start, end, kind) in &spans {
            names[*start..*end].fill(format!("B-{kind}"));
        }
        let mut labels = Column::default();
        names.iter().for_each(|name| labels.push(name));
        labels.values.intern(OUTSIDE);
        let mut spelled = corpus.clone();
        spelled.columns[column] = labels;
        let order = Some(Order::Free);
        let base =
            tagging::Settings { labels: LabelColumn::At(column), order, ..tagging::Settings::from(settings.template) };
        let (base, tagging) = Encoding::learn(&spelled, base)?;
        let mut longest = vec![1; base.labels.len()];
        let mut gold: Vec<u32> = tagging.gold().iter().map(|label| code(*label, false)).collect();
        for (start, end, _) in spans {
            let most = &mut longest[tagging.gold()[start] as usize];
            *most = ((end - start) as u32).min(settings.longest).max(*most);
            gold[start + 1..end].iter_mut().for_each(|code| *code += 1);
        }
        let actions: u32 = longest.iter().sum();
        if actions as usize > MOST_ACTIONS {
            return Err(Error::argument(
                "actions",
                actions,
                format!("at most {MOST_ACTIONS}: fewer types, shorter spans"),
            ));
        }
        let spans = Spans::new(base, longest).map_err(|what| Error::argument("spans", what, "other ones"))?;
        let space = Segmenting::new(tagging, spans.segments.clone());
        let space = space.knowing((0..corpus.sentences()).map(|i| corpus.sentence(i)), gold);
        Ok((spans, space.problem()))
    }

    const CONFIDENT: bool = true;

    /// The tokens of one span have one action.
    fn lines(&self, corpus: &Corpus, actions: &[Action]) -> Vec<(usize, usize)> {
        let lengths = actions.iter().enumerate().map(|(number, action)| (number, self.segments.get(*action).length));
        let numbers = lengths.flat_map(|(number, length)| std::iter::repeat_n(number, length as usize));
        corpus.lines.iter().copied().zip(numbers).collect()
    }

    /// A span is right if it begins and ends as one in the corpus with its type; a token outside if it is outside there.
    fn right(&self, corpus: &Corpus, mut actions: &[Action]) -> Result<Vec<bool>> {
        let column = LabelColumn::At(self.base.label_column).in_corpus(corpus)?;
        let scheme = Scheme::new(&corpus.columns[column].values.iter().collect::<Vec<_>>());
        let gold = spans_of(corpus, column, &scheme);
        let mut right = Vec::with_capacity(actions.len());
        for sentence in (0..corpus.sentences()).map(|i| corpus.sentence(i)) {
            for (start, end, label) in self.taken(&mut actions, sentence.len()) {
                let (start, end) = (sentence.start + start, sentence.start + end);
                // The span that is the first to end behind the start: those before end at it or before.
                let found = gold.get(gold.partition_point(|span| span.1 <= start));
                right.push(match (self.base.labels[label as usize].strip_prefix("B-"), found) {
                    (Some(kind), Some(span)) => *span == (start, end, kind),
                    (Some(_), None) => false,
                    (None, found) => found.is_none_or(|span| span.0 >= end),
                });
            }
        }
        Ok(right)
    }

    fn apply(&self, corpus: &Corpus) -> Result<Segmenting> {
        Ok(Segmenting::new(self.base.apply(corpus)?, self.segments.clone()))
    }

    fn write(&self, block: &Block, of: Option<(&Corpus, &[Action])>, out: &mut impl Write) -> io::Result<()> {
        let labels = of.map_or(Vec::new(), |(corpus, actions)| self.labels(corpus, actions));
        let lines = of.map_or(&[][..], |(corpus, _)| &corpus.lines);
        write_labels(
            block,
            lines.iter().copied().zip(labels.iter().map(|(prefix, kind)| [*prefix, *kind].concat())),
            out,
        )
    }

    fn check(&self, corpus: &Corpus) -> Result<()> {
        self.base.check(corpus)
    }

    /// Tokens and spans, both as IOB2 spells them. Where a right label was never seen in training, the model is wrong.
    fn score(&self, corpus: &Corpus, actions: &[Action]) -> Result<Score> {
        let column = LabelColumn::At(self.base.label_column).in_corpus(corpus)?;
        let scheme = Scheme::new(&corpus.columns[column].values.iter().collect::<Vec<_>>());
        let kinds = self.base.labels.iter().filter_map(|label| label.strip_prefix("B-"));
        let known: Vec<String> = kinds.flat_map(|kind| [format!("B-{kind}"), format!("I-{kind}")]).collect();
        let mut iob2 = Scheme::new(&known);
        let outside = iob2.id(OUTSIDE);
        let mut gold = vec![outside; corpus.tokens()];
        for (start, end, kind) in spans_of(corpus, column, &scheme) {
            gold[start..end].fill(iob2.id(&format!("I-{kind}")));
            gold[start] = iob2.id(&format!("B-{kind}"));
        }
        let said: Vec<u32> =
            self.labels(corpus, actions).iter().map(|(prefix, kind)| iob2.id(&[*prefix, *kind].concat())).collect();
        let mut score = Score::new(iob2);
        for sentence in (0..corpus.sentences()).map(|i| corpus.sentence(i)) {
            score.add(&gold[sentence.clone()], &said[sentence])?;
        }
        Ok(score)
    }

    /// Of the spans, told word by word as B-X, I-X and O.
    fn answers(&self, corpus: &Corpus, actions: &[Action], tell: &mut dyn FnMut(&str, &str)) -> Result<()> {
        let column = LabelColumn::At(self.base.label_column).in_corpus(corpus)?;
        let scheme = Scheme::new(&corpus.columns[column].values.iter().collect::<Vec<_>>());
        let mut right = vec![OUTSIDE.to_owned(); corpus.tokens()];
        for (start, end, kind) in spans_of(corpus, column, &scheme) {
            right[start..end].fill(format!("I-{kind}"));
            right[start] = format!("B-{kind}");
        }
        for (right, (prefix, kind)) in right.iter().zip(self.labels(corpus, actions)) {
            tell(right, &[prefix, kind].concat());
        }
        Ok(())
    }

    fn features(&self) -> usize {
        self.base.features()
    }

    fn actions(&self) -> usize {
        self.segments.len()
    }

    fn keep(&mut self, used: &dyn Fn(u32) -> bool) -> Result<Vec<u32>> {
        self.base.keep(used)
    }

    fn header(&self) -> Header {
        Header { base: self.base.header(), longest: self.longest.clone() }
    }

    fn arrays(&self) -> Vec<&[u64]> {
        self.base.arrays()
    }

    fn restore(header: Header, arrays: &mut Arrays<'_>, path: &Path) -> Result<Self, String> {
        Spans::new(Encoding::restore(header.base, arrays, path)?, header.longest)
    }

    fn facts(&self) -> Vec<Fact> {
        let named = self.base.labels.iter().zip(&self.longest).filter(|(label, _)| *label != OUTSIDE);
        let lengths: Vec<(&str, u32)> = named.map(|(label, length)| (&label[2..], *length)).collect();
        let text: Vec<String> = lengths.iter().map(|(kind, length)| format!("{kind} 1-{length}")).collect();
        let value = lengths.iter().map(|(kind, length)| serde_json::json!({"type": kind, "longest": length})).collect();
        let template = self.base.facts().into_iter().filter(|fact| fact.name == "template");
        std::iter::once(Fact { name: "spans", text: text.join(", "), value }).chain(template).collect()
    }
}
