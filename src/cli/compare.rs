//! `rollin compare`

use super::algorithms::{Algorithm, RECIPES, TrainerOptions};
use super::options::{LearnerOptions, Reading, read_corpus};
use super::progress::Bar;
use super::tasks::{TaskName, Verbs, with_task};
use super::{Global, print, print_json};
use crate::corpus::Corpus;
use crate::error::{Error, Result};
use crate::grammar::{Grammar, defaults};
use crate::policy;
use crate::read::conll;
use crate::report::{Table, grouped};
use crate::seed::{Purpose, Seed};
use crate::space::Imitation;
use crate::tasks::{AnyLearner, Data, Learned, Measure, Score, Trainer};
use crate::theory::ledgers::{Expected, Extent};
use crate::trainer::Run;
use crate::worker::Ledger;
use clap::Args;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Train with several algorithms on the same data and compare accuracy with what the expert was asked.
///
/// Without --data this runs on two corpora that are part of the program, drawn from a grammar, for which the best possible accuracy
/// is known exactly.
#[derive(Args)]
#[command(after_help = RECIPES)]
pub struct Compare {
    /// What is learned
    #[arg(long, value_enum, default_value_t, value_name = "NAME")]
    task: TaskName,
    /// What to learn from, as for `rollin train` (- for standard input) [default: a corpus in the program, for tagging]
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
    /// Wrong words per sentence, cost per trip, and the like.
    loss: f64,
    /// In percent, by name.
    #[serde(flatten)]
    percent: BTreeMap<&'static str, Option<f64>>,
    #[serde(skip)]
    measures: Vec<Measure>,
}

/// What is learned from, and what is measured on.
pub struct Both<D> {
    train: D,
    test: D,
    /// The accuracy in percent that no labelling of the test set is expected to exceed, where it is known.
    best: Option<f64>,
}

impl Compare {
    pub fn run(&self, global: &Global) -> Result<()> {
        with_task!(self.task, T => self.run_as::<T>(global))
    }

    fn run_as<T: Verbs>(&self, global: &Global) -> Result<()> {
        self.columns.refuse_others(T::NAME)?;
        let learner = self.learner.learner()?;
        self.trainer.check(&self.algorithms)?;
        let (data, settings) = self.read::<T>()?;
        let (encoding, problem) = T::learn(&data.train, settings)?;
        encoding.check(&data.test)?;
        let extent = Extent::of(&problem);
        let bench = Bench { extent, problem, encoding, data: &data };
        let rows = self
            .algorithms
            .iter()
            .map(|algorithm| bench.row(*algorithm, self.trainer.trainer(*algorithm), &learner, global))
            .collect::<Result<Vec<_>>>()?;
        if global.json {
            return print_json(&serde_json::json!({
                "train": {"path": data.train.path(), "sentences": data.train.sentences(), "tokens": data.train.tokens()},
                "test": {"path": data.test.path(), "sentences": data.test.sentences(), "tokens": data.test.tokens()},
                "learner": learner,
                "seed": global.seed,
                "best_accuracy": data.best,
                "rows": rows,
            }));
        }
        print(&bench.text(&rows, &learner))
    }

    fn read<T: Verbs>(&self) -> Result<(Both<T::Data>, T::Settings)> {
        let Some(path) = &self.data else {
            let Some(embedded) = T::embedded() else {
                let expected = format!("given: there is no corpus for {} in the program", T::NAME);
                return Err(Error::argument("--data", "left out", expected));
            };
            let mut both = embedded?;
            if let Some(first) = self.columns.first {
                both.train.truncate(usize::try_from(first).unwrap_or(usize::MAX));
            }
            let settings = T::settings(&self.columns, &both.train)?;
            return Ok((both, settings));
        };
        let mut train = self.columns.corpus::<T>(path)?;
        let settings = T::settings(&self.columns, &train)?;
        let test = match &self.test {
            Some(path) => {
                let mut test = read_corpus::<T>(path)?;
                if self.columns.repair {
                    T::mend(&mut test, self.columns.mending())?;
                }
                test
            }
            None => {
                let kept = train.sentences() - train.sentences() / 5;
                if kept == train.sentences() {
                    let few = format!("too few {} to set some aside: {}", T::UNITS.episodes, train.sentences());
                    return Err(Error::file(path, few, "give at least 5, or a --test file"));
                }
                train.split_off(kept)
            }
        };
        Ok((Both { train, test, best: None }, settings))
    }
}

/// The corpora that are part of the program.
pub fn embedded() -> Result<Both<Corpus>> {
    let corpus = |name: &str, text: &str| conll::parse(text.as_bytes(), Path::new(name), 1);
    let (train, test) = (corpus("<embedded train>", defaults::TRAIN)?, corpus("<embedded test>", defaults::TEST)?);
    let grammar = Grammar::parse("<embedded grammar>", defaults::GRAMMAR)?;
    let (count, seed) = defaults::MADE[1];
    let best = 100.0 * grammar.optimum(&grammar.generate(count, Seed::new(seed)))?;
    Ok(Both { train, test, best: Some(best) })
}

/// What all rows share.
struct Bench<'d, T: Verbs> {
    problem: Imitation<T::Space, T::Expert>,
    extent: Extent,
    encoding: T,
    data: &'d Both<T::Data>,
}

impl<T: Verbs> Bench<'_, T> {
    fn row(&self, algorithm: Algorithm, trainer: Trainer, learner: &AnyLearner, global: &Global) -> Result<Row> {
        let bar = Bar::new(&algorithm.name(), global.quiet);
        let watch = |progress: &_| bar.show(progress);
        let run = Run { seed: Seed::new(global.seed), watch: &watch };
        let trained = T::train(&self.problem, &run, &|problem, run| trainer.train(problem, learner, run))?;
        let readings = match trainer.mixes() {
            true => vec![Some(policy::Reading::Sampled), Some(policy::Reading::Vote), Some(policy::Reading::Mean)],
            false => vec![None],
        };
        let readings = readings
            .into_iter()
            .map(|reading| {
                let policy = trained.policy.clone().read_as(reading.unwrap_or_default());
                self.measure(reading, policy, Seed::new(global.seed))
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

    fn measure(&self, reading: Option<policy::Reading>, policy: Learned, seed: Seed) -> Result<Measured> {
        let (test, encoding) = (&self.data.test, &self.encoding);
        let actions =
            T::perform(&policy, encoding.apply(test)?, test.sentences(), 0, seed.child(Purpose::Evaluation, 0));
        let score = encoding.judge(&policy, test, &actions)?;
        let measures = score.measures();
        Ok(Measured {
            reading,
            loss: score.loss() / test.sentences() as f64,
            percent: measures.iter().map(|measure| (measure.key, measure.percent)).collect(),
            measures,
        })
    }

    fn text(&self, rows: &[Row], learner: &AnyLearner) -> String {
        let (train, test) = (&self.data.train, &self.data.test);
        let loss = format!("{}/{}", T::UNITS.loss, T::UNITS.episode);
        let mut headings = vec!["", "reading", &loss];
        // What means nothing for one row means nothing for all: the labels are the same.
        let told = |measured: &Measured| measured.measures.iter().filter(|m| m.percent.is_some()).copied().collect();
        let measures: Vec<Measure> = rows.iter().flat_map(|row| &row.readings).map(told).next().unwrap_or_default();
        headings.extend(measures.iter().map(|measure| measure.name));
        headings.extend(["expert queries", "resets", "rounds", "seconds"]);
        let mut results = Table::new(headings);
        for row in rows {
            for measured in &row.readings {
                let mut cells = vec![
                    row.algorithm.clone(),
                    measured.reading.map_or("-".into(), |r| super::train::to_json(&r).trim_matches('"').to_owned()),
                    format!("{:.3}", measured.loss),
                ];
                cells.extend(measured.measures.iter().filter_map(|m| m.percent).map(|p| format!("{p:.2}")));
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
            "{} {} to learn from, {} to measure on; learner {}\n\n{results}{best}\n{}",
            grouped(train.sentences() as f64),
            T::UNITS.episodes,
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
