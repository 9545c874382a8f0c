//! `rollin compare`

use super::algorithms::{Algorithm, RECIPES, TrainerOptions};
use super::options::{LearnerOptions, Reading, check_columns, read_corpus};
use super::progress::Bar;
use super::{Global, print, print_json};
use crate::corpus::Corpus;
use crate::error::{Error, Result};
use crate::grammar::{Grammar, defaults};
use crate::policy;
use crate::read::conll;
use crate::report::{Table, grouped};
use crate::score::Scheme;
use crate::seed::Seed;
use crate::tasks::tagging::{About, AnyLearner, Encoding, LabelColumn, Tagger, Tagging, TaggingProblem, Trainer};
use crate::theory::ledgers::{Expected, Extent};
use crate::trainer::Run;
use crate::worker::Ledger;
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Train with several algorithms on the same data and compare accuracy with what the expert was asked.
///
/// Without --data this runs on two corpora that are part of the program, drawn from a grammar, for which the best possible accuracy
/// is known exactly.
#[derive(Args)]
#[command(after_help = RECIPES)]
pub struct Compare {
    /// What to learn from, one token a line as for `rollin train` (- for standard input) [default: a corpus in the program]
    #[arg(long, value_name = "FILE")]
    data: Option<PathBuf>,
    /// What to measure on [default: the last fifth of the data's sentences, which is then not learned from]
    #[arg(long, value_name = "FILE", requires = "data")]
    test: Option<PathBuf>,
    /// The algorithms, separated by commas
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        value_name = "NAMES",
        default_value = "supervised,forward,smile,searn,dagger"
    )]
    algorithms: Vec<Algorithm>,
    #[command(flatten)]
    columns: Reading,
    #[command(flatten)]
    trainer: TrainerOptions,
    #[command(flatten)]
    learner: LearnerOptions,
}

/// One algorithm's results.
#[derive(Serialize)]
struct Row {
    algorithm: String,
    trainer: Trainer,
    readings: Vec<Measured>,
    ledger: Ledger,
    expected: Expected,
    rounds: usize,
    seconds: f64,
}

/// One reading's results.
#[derive(Serialize)]
struct Measured {
    reading: Option<policy::Reading>,
    /// Wrong labels per sentence.
    loss: f64,
    /// In percent.
    accuracy: f64,
    /// In percent; where the labels are spans.
    f1: Option<f64>,
}

/// What is learned from, and what is measured on.
struct Data {
    train: Corpus,
    test: Corpus,
    /// The accuracy in percent that no labelling of the test set is expected to exceed, where it is known.
    best: Option<f64>,
}

impl Compare {
    pub fn run(&self, global: &Global) -> Result<()> {
        let learner = self.learner.learner()?;
        self.trainer.check(&self.algorithms)?;
        let data = self.read()?;
        let template = self.columns.template(&data.train)?;
        let (encoding, space) = Encoding::learn(&data.train, self.columns.labels(), template, self.columns.order())?;
        LabelColumn::At(encoding.label_column).in_corpus(&data.test)?;
        check_columns(&encoding, &data.test)?;
        let problem = space.problem();
        let bench =
            Bench { extent: Extent::of(&problem), problem, test: encoding.apply(&data.test)?, encoding, data: &data };
        let rows = self
            .algorithms
            .iter()
            .map(|algorithm| bench.row(*algorithm, self.trainer.trainer(*algorithm), &learner, global))
            .collect::<Result<Vec<_>>>()?;
        if global.json {
            return print_json(&serde_json::json!({
                "train": {"path": data.train.path, "sentences": data.train.sentences(), "tokens": data.train.tokens()},
                "test": {"path": data.test.path, "sentences": data.test.sentences(), "tokens": data.test.tokens()},
                "learner": learner,
                "seed": global.seed,
                "best_accuracy": data.best,
                "rows": rows,
            }));
        }
        print(&bench.text(&rows, &learner))
    }

    fn read(&self) -> Result<Data> {
        let Some(path) = &self.data else {
            return embedded(&self.columns);
        };
        let mut train = self.columns.corpus(path)?;
        self.columns.labels().in_corpus(&train)?;
        let test = match &self.test {
            Some(path) => read_corpus(path)?,
            None => {
                let kept = train.sentences() - train.sentences() / 5;
                if kept == train.sentences() {
                    let few = format!("too few sentences to set some aside: {}", train.sentences());
                    return Err(Error::file(path, few, "give at least 5, or a --test file"));
                }
                train.split_off(kept)
            }
        };
        Ok(Data { train, test, best: None })
    }
}

/// The corpora that are part of the program.
fn embedded(columns: &Reading) -> Result<Data> {
    let corpus = |name: &str, text: &str| conll::parse(text.as_bytes(), Path::new(name), 1);
    let (mut train, test) = (corpus("<embedded train>", defaults::TRAIN)?, corpus("<embedded test>", defaults::TEST)?);
    if let Some(first) = columns.first {
        train.truncate(usize::try_from(first).unwrap_or(usize::MAX));
    }
    let grammar = Grammar::parse("<embedded grammar>", defaults::GRAMMAR)?;
    let (count, seed) = defaults::MADE[1];
    let best = 100.0 * grammar.optimum(&grammar.generate(count, Seed::new(seed)))?;
    Ok(Data { train, test, best: Some(best) })
}

/// What all rows share.
struct Bench<'d> {
    problem: TaggingProblem,
    extent: Extent,
    test: Tagging,
    encoding: Encoding,
    data: &'d Data,
}

impl Bench<'_> {
    fn row(&self, algorithm: Algorithm, trainer: Trainer, learner: &AnyLearner, global: &Global) -> Result<Row> {
        let bar = Bar::new(&algorithm.name(), global.quiet);
        let watch = |progress: &_| bar.show(progress);
        let trained = trainer.train(&self.problem, learner, &Run { seed: Seed::new(global.seed), watch: &watch })?;
        let readings = match trainer.mixes() {
            true => vec![Some(policy::Reading::Sampled), Some(policy::Reading::Vote), Some(policy::Reading::Mean)],
            false => vec![None],
        };
        let readings = readings
            .into_iter()
            .map(|reading| {
                let policy = trained.policy.clone().read_as(reading.unwrap_or_default());
                let tagger = Tagger { encoding: self.encoding.clone(), policy, about: About::default() };
                self.measure(reading, &tagger.tag_encoded(self.test.clone(), 0, Seed::new(global.seed)))
            })
            .collect::<Result<Vec<_>>>()?;
        Ok(Row {
            algorithm: algorithm.name(),
            expected: trainer.expected(&self.extent),
            trainer,
            readings,
            ledger: trained.ledger,
            rounds: trained.rounds.len(),
            seconds: trained.rounds.last().map_or(0.0, |round| round.seconds),
        })
    }

    fn measure(&self, reading: Option<policy::Reading>, labels: &[u32]) -> Result<Measured> {
        let score = super::evaluate::score(&self.data.test, &self.encoding, labels)?;
        Ok(Measured {
            reading,
            loss: (score.tokens() - score.right()) as f64 / self.data.test.sentences() as f64,
            accuracy: 100.0 * score.accuracy(),
            f1: Scheme::new(&self.encoding.labels).is_spans().then(|| 100.0 * score.f1()),
        })
    }

    fn text(&self, rows: &[Row], learner: &AnyLearner) -> String {
        let (train, test) = (&self.data.train, &self.data.test);
        let spans = rows.iter().flat_map(|row| &row.readings).any(|m| m.f1.is_some());
        let mut headings = vec!["", "reading", "wrong/sentence", "accuracy %"];
        headings.extend(spans.then_some("F1 %"));
        headings.extend(["expert queries", "resets", "rounds", "seconds"]);
        let mut results = Table::new(headings);
        for row in rows {
            for measured in &row.readings {
                let mut cells = vec![
                    row.algorithm.clone(),
                    measured.reading.map_or("-".into(), |r| super::train::to_json(&r).trim_matches('"').to_owned()),
                    format!("{:.3}", measured.loss),
                    format!("{:.2}", measured.accuracy),
                ];
                cells.extend(spans.then(|| measured.f1.map_or("-".into(), |f1| format!("{f1:.2}"))));
                cells.extend([
                    grouped(row.ledger.queries as f64),
                    grouped(row.ledger.resets as f64),
                    row.rounds.to_string(),
                    format!("{:.2}", row.seconds),
                ]);
                results.row(cells);
            }
        }
        let best = self.data.best.map_or(String::new(), |best| {
            format!("No labelling of these sentences is expected to exceed {best:.2} %.\n")
        });
        format!(
            "{} sentences to learn from, {} to measure on; learner {}\n\n{results}{best}\n{}",
            grouped(train.sentences() as f64),
            grouped(test.sentences() as f64),
            super::train::to_json(learner),
            bill(rows),
        )
    }
}

/// The bill: what was measured, and below it what was predicted.
fn bill(rows: &[Row]) -> String {
    type Field = (&'static str, fn(&Expected) -> f64);
    let fields: [Field; 8] = [
        ("labels", |e| e.labels),
        ("expert acts", |e| e.expert_acts),
        ("roll-out acts", |e| e.rollout_acts),
        ("expert queries", |e| e.queries),
        ("roll-outs", |e| e.rollouts),
        ("resets", |e| e.resets),
        ("steps", |e| e.steps),
        ("examples", |e| e.examples),
    ];
    let mut table = Table::new(std::iter::once("the bill").chain(rows.iter().map(|row| row.algorithm.as_str())));
    for (name, field) in fields {
        let cells = |of: &dyn Fn(&Row) -> Expected| rows.iter().map(|row| grouped(field(&of(row)))).collect::<Vec<_>>();
        table.row(std::iter::once(name.to_owned()).chain(cells(&|row| row.ledger.into())));
        table.row(std::iter::once("  predicted".to_owned()).chain(cells(&|row| row.expected)));
    }
    table.to_string()
}
