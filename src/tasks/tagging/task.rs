//! Tagging as a [`Task`]: what the program's verbs need of it.

use super::TaggingProblem;
use super::encoding::{Dictionary, Encoding, LabelColumn, MOST_LABELS};
use super::readings;
use super::space::{Gold, MAX_ORDER, Tagging};
use super::transitions::{Order, Transitions};
use crate::corpus::Corpus;
use crate::error::{Error, Result};
use crate::read::conll::{self, Block};
use crate::read::template::Template;
use crate::score::{Scheme, Score};
use crate::seed::Seed;
use crate::space::{Action, Imitation};
use crate::tasks::{Arrays, Data, Done, Fact, Learned, Measure, Names, Reason, Task, Training, write_labels};
use crate::trainer::{Keeping, Run, Trained};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

/// What a tagger learns with.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// The feature template; by default one that looks at all columns before the labels'.
    pub template: Option<Template>,
    /// The column with the labels.
    pub labels: LabelColumn,
    /// Which label may follow which; by default labels that look like IOB2 or BILOU and follow its rule everywhere are held to it.
    pub order: Option<Order>,
    /// Features of the words alone that are seen fewer times in training are left out; those of labels before stay.
    pub cutoff: u8,
}

/// This template, and for the rest what is usual.
impl From<Template> for Settings {
    fn from(template: Template) -> Self {
        Settings { template: Some(template), ..Settings::default() }
    }
}

/// What a model file says of a tagger.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    template: String,
    labels: Vec<String>,
    label_column: usize,
    order: Order,
    features: usize,
    contexts: Vec<usize>,
}

impl Task for Encoding {
    const NAME: &'static str = "tagging";
    type Data = Corpus;
    type Settings = Settings;
    type Space = Tagging;
    type Expert = Gold;
    type Score = Score;
    type Header = Header;
    type Stream = Columns;

    fn parse(text: &[u8], path: &Path) -> Result<Corpus> {
        conll::parse(text, path, 1)
    }

    fn parse_block(&self, block: &Block, path: &Path, stream: &mut Self::Stream) -> Result<Option<Corpus>> {
        let corpus = block.corpus(path)?;
        if let Some(corpus) = &corpus {
            self.check_columns(corpus)?;
            stream.check(corpus)?;
        }
        Ok(corpus)
    }

    fn learn(corpus: &Corpus, settings: Settings) -> Result<(Self, Imitation<Tagging, Gold>)> {
        let (encoding, space) = Encoding::learn(corpus, settings)?;
        Ok((encoding, space.problem()))
    }

    fn extend(&self, corpus: &Corpus) -> Result<(Self, TaggingProblem, Vec<u32>)> {
        let (encoding, space, moved) = Encoding::extend(self, corpus)?;
        if space.looks_ahead() {
            let expected = "one that looks at no labels to come: two readings do not go on learning";
            return Err(Error::argument("template", "one of two readings", expected));
        }
        Ok((encoding, space.problem(), moved))
    }

    fn train(problem: &TaggingProblem, run: &Run<'_, Keeping>, train: &Training<'_, Self>) -> Result<Trained<Learned>> {
        match problem.space.looks_ahead() {
            true => readings::train(problem, run, train),
            false => train(problem, run),
        }
    }

    fn perform(policy: &Learned, space: Tagging, _: usize, number: usize, seed: Seed) -> Vec<Action> {
        readings::perform(policy, space, number, seed).0.actions
    }

    const NAMED: bool = true;

    fn names(&self, corpus: &Corpus) -> Result<Names<'_>> {
        self.feature_names(corpus)
    }

    fn label(&self, action: Action) -> String {
        self.labels.get(action.index()).cloned().unwrap_or_default()
    }

    fn transitions(&self) -> Vec<(Option<Action>, u32)> {
        self.label_features()
    }

    fn reasons(policy: &Learned, space: Tagging, _: usize, done: Done<'_>) -> Option<Vec<Reason>> {
        readings::reasons(policy, space, done)
    }

    /// The first column, or the second where labels stand in the first.
    fn words<'a>(&self, corpus: &'a Corpus, i: usize) -> Vec<(usize, &'a str)> {
        let Some(column) = corpus.columns.get(usize::from(self.label_column == 0)) else { return Vec::new() };
        corpus.sentence(i).map(|token| (corpus.lines[token], column.word(token))).collect()
    }

    const CONFIDENT: bool = true;

    fn calibrate(policy: &Learned, problem: &TaggingProblem, episodes: &[usize], seed: Seed) -> Vec<f32> {
        readings::calibrate(policy, problem, episodes, seed)
    }

    fn sure(policy: &Learned, space: Tagging, _: usize, done: Done<'_>) -> Vec<f32> {
        readings::sure(policy, space, done)
    }

    fn lines(&self, corpus: &Corpus, _: &[Action]) -> Vec<(usize, usize)> {
        corpus.lines.iter().copied().zip(0..).collect()
    }

    fn right(&self, corpus: &Corpus, actions: &[Action]) -> Result<Vec<bool>> {
        let column = &corpus.columns[LabelColumn::At(self.label_column).in_corpus(corpus)?];
        Ok(actions.iter().enumerate().map(|(t, action)| column.word(t) == self.labels[action.index()]).collect())
    }

    fn apply(&self, corpus: &Corpus) -> Result<Tagging> {
        Encoding::apply(self, corpus)
    }

    fn write(&self, block: &Block, of: Option<(&Corpus, &[Action])>, out: &mut impl Write) -> io::Result<()> {
        let (lines, actions) = of.map_or((&[][..], &[][..]), |(corpus, actions)| (&corpus.lines[..], actions));
        let labels = actions.iter().map(|action| self.labels[action.index()].as_str());
        write_labels(block, lines.iter().copied().zip(labels), out)
    }

    fn check(&self, corpus: &Corpus) -> Result<()> {
        LabelColumn::At(self.label_column).in_corpus(corpus)?;
        self.check_columns(corpus)
    }

    /// Where a right label was never seen in training, the model is wrong.
    fn score(&self, corpus: &Corpus, actions: &[Action]) -> Result<Score> {
        let column = &corpus.columns[LabelColumn::At(self.label_column).in_corpus(corpus)?];
        let labels: Vec<u32> = actions.iter().map(|action| action.0).collect();
        let mut scheme = Scheme::new(&self.labels);
        let ids: Vec<u32> = column.values.iter().map(|name| scheme.id(name)).collect();
        let gold: Vec<u32> = column.cells.iter().map(|cell| ids[*cell as usize]).collect();
        let mut score = Score::new(scheme);
        for i in 0..corpus.sentences() {
            let sentence = corpus.sentence(i);
            score.add(&gold[sentence.clone()], &labels[sentence])?;
        }
        Ok(score)
    }

    fn answers(&self, corpus: &Corpus, actions: &[Action], tell: &mut dyn FnMut(&str, &str)) -> Result<()> {
        let column = LabelColumn::At(self.label_column).in_corpus(corpus)?;
        for (i, action) in actions.iter().enumerate().take(corpus.tokens()) {
            tell(corpus.word(column, i), &self.labels[action.0 as usize]);
        }
        Ok(())
    }

    fn features(&self) -> usize {
        Encoding::features(self)
    }

    fn actions(&self) -> usize {
        self.labels.len()
    }

    /// Static features are forgotten; dynamic ones keep their order behind them.
    fn keep(&mut self, used: &dyn Fn(u32) -> bool) -> Result<Vec<u32>> {
        let before = self.features.len();
        let kept: Vec<u32> = (0..before as u32).filter(|feature| used(*feature)).collect();
        let keys = self.features.keys();
        self.features =
            Dictionary::of(kept.iter().map(|old| keys[*old as usize])).unwrap_or_else(|| self.features.clone());
        self.number_history()?;
        let dynamic = before as u32..(Encoding::features(self) + before - self.features.len()) as u32;
        Ok(kept.into_iter().chain(dynamic).collect())
    }

    fn header(&self) -> Header {
        Header {
            template: self.template.text().into(),
            labels: self.labels.clone(),
            label_column: self.label_column,
            order: self.transitions.order(),
            features: self.features.len(),
            contexts: self.contexts.iter().map(Dictionary::len).collect(),
        }
    }

    /// The hashes of the static features in the order of their numbers, then for each history line those of its contexts.
    fn arrays(&self) -> Vec<&[u64]> {
        std::iter::once(&self.features).chain(&self.contexts).map(Dictionary::keys).collect()
    }

    fn restore(header: Header, arrays: &mut Arrays<'_>, path: &Path) -> Result<Self, String> {
        // Whatever its template is blamed for later is not to look like a line of the model file.
        let source = format!("<template in {}>", path.display());
        let template = Template::parse(&header.template, source.as_ref()).map_err(|error| error.to_string())?;
        let labels = header.labels;
        if labels.is_empty() || labels.len() > MOST_LABELS || !labels.is_sorted_by(|a, b| a < b) {
            return Err("its labels are not a sorted list of names".into());
        }
        let far =
            template.history().iter().flat_map(|line| &line.labels).any(|k| k.unsigned_abs() as usize > MAX_ORDER);
        if far || template.history().len() != header.contexts.len() {
            return Err("its history lines are not those of its template".into());
        }
        let mut dictionary = |count: usize| {
            let keys = arrays.keys(count).ok_or("it ends within a dictionary")?;
            Dictionary::of(keys).ok_or("a feature stands in it twice")
        };
        let features = dictionary(header.features)?;
        let contexts = header.contexts.iter().map(|count| dictionary(*count)).collect::<Result<Vec<_>, _>>()?;
        let transitions = Arc::new(Transitions::new(header.order, &labels));
        if !transitions.go_on() {
            return Err("its order of labels leaves none to go on with".into());
        }
        let mut encoding = Encoding {
            template,
            label_column: header.label_column,
            transitions,
            features,
            contexts,
            history: [].into(),
            labels,
        };
        encoding.number_history().map_err(|error| error.to_string())?;
        Ok(encoding)
    }

    fn facts(&self) -> Vec<Fact> {
        let order = self.transitions.order().name();
        vec![
            Fact { name: "order", text: order.into(), value: order.into() },
            Fact { name: "labels", text: self.labels.join(" "), value: self.labels.clone().into() },
            Fact {
                name: "template",
                text: format!("\n{}", self.template.text().trim_end()),
                value: self.template.text().into(),
            },
        ]
    }
}

impl Encoding {
    /// Refuses a corpus that has fewer columns than the template looks at.
    pub(super) fn check_columns(&self, corpus: &Corpus) -> Result<()> {
        let (needed, found) = (self.template.columns(), corpus.columns.len());
        if found >= needed {
            return Ok(());
        }
        let expected =
            format!("at least {}, because the model looks at column {} (from 0)", columns(needed), needed - 1);
        Err(Error::data(corpus.place(0, 0), columns(found), expected))
    }
}

/// So many columns, in words.
pub(super) fn columns(n: usize) -> String {
    if n == 1 { "1 column".to_owned() } else { format!("{n} columns") }
}

/// The columns of a stream of blocks: how many, and the line on which so many were first found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Columns(Option<(usize, usize)>);

impl Columns {
    /// Refuses a block whose lines have another number of columns than those of the blocks before.
    ///
    /// # Errors
    /// With the place where the first column too many begins, or one too few would.
    pub fn check(&mut self, block: &Corpus) -> Result<()> {
        let found = block.columns.len();
        let (expected, line) = *self.0.get_or_insert((found, block.lines.first().copied().unwrap_or(0)));
        if found == expected {
            return Ok(());
        }
        let mut place = block.place(0, found.min(expected));
        if found < expected {
            // A word is missing where the line ends, not a separator further on.
            place.column -= 1;
        }
        Err(Error::data(place, columns(found), format!("{} as on line {line}", columns(expected))))
    }
}

impl Data for Corpus {
    fn path(&self) -> &Path {
        &self.path
    }
    fn sentences(&self) -> usize {
        Corpus::sentences(self)
    }
    fn tokens(&self) -> usize {
        Corpus::tokens(self)
    }
    fn truncate(&mut self, sentences: usize) {
        Corpus::truncate(self, sentences);
    }
    fn split_off(&mut self, sentences: usize) -> Self {
        Corpus::split_off(self, sentences)
    }
}

impl crate::tasks::Score for Score {
    /// What `conlleval.pl` prints where the labels are spans, else accuracy.
    fn text(&self) -> String {
        if self.scheme().is_spans() {
            return self.to_string();
        }
        format!("processed {} tokens\naccuracy: {:6.2}%\n", self.tokens(), 100.0 * self.accuracy())
    }

    fn loss(&self) -> f64 {
        (self.tokens() - self.right()) as f64
    }

    fn measures(&self) -> Vec<Measure> {
        let f1 = self.scheme().is_spans().then(|| 100.0 * self.f1());
        vec![
            Measure { key: "accuracy", name: "accuracy %", percent: Some(100.0 * self.accuracy()) },
            Measure { key: "f1", name: "F1 %", percent: f1 },
        ]
    }
}
