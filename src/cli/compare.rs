//! `rollin compare`

use super::algorithms::{Algorithm, TrainerOptions};
use super::options::{LearnerOptions, Reading, read_corpus};
use super::progress::Bar;
use super::report::{ReportOptions, Sources, mixture, spoken};
use super::tasks::{TaskName, Verbs, with_task};
use super::{Global, print, print_json};
use crate::corpus::Corpus;
use crate::error::{Error, Result};
use crate::grammar::{Grammar, defaults};
use crate::policy;
use crate::read::conll;
use crate::report::{Axis, Dot, Figure, Page, Plot, Series, Table, grouped};
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
#[command(after_help = super::help::compare())]
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
    #[command(flatten)]
    report: ReportOptions,
}

/// One algorithm's results.
#[derive(Serialize)]
struct Row {
    algorithm: String,
    trainer: Trainer,
    readings: Vec<Measured>,
    ledger: Ledger,
    expected: Expected,
    /// The mixture's weights after each round, the expert's first, where the rate was known beforehand.
    #[serde(skip_serializing_if = "Option::is_none")]
    weights: Option<Vec<Vec<f64>>>,
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
        let files = self.files();
        self.report.check(&files.iter().map(|(_, path)| *path).collect::<Vec<_>>())?;
        let (data, settings) = self.read::<T>()?;
        let (encoding, problem) = T::learn(&data.train, settings)?;
        encoding.check(&data.test)?;
        let extent = Extent::of(&problem);
        let bench = Bench { extent, problem, encoding, how: &self.trainer, data: &data };
        let rows = self
            .algorithms
            .iter()
            .map(|algorithm| bench.row(*algorithm, self.trainer.trainer(*algorithm), &learner, global))
            .collect::<Result<Vec<_>>>()?;
        if global.json {
            print_json(&serde_json::json!({
                "train": {"path": data.train.path(), "sentences": data.train.sentences(), "tokens": data.train.tokens()},
                "test": {"path": data.test.path(), "sentences": data.test.sentences(), "tokens": data.test.tokens()},
                "learner": learner,
                "expert": self.trainer.flaw(),
                "seed": global.seed,
                "best_accuracy": data.best,
                "rows": rows,
            }))?;
        } else {
            print(&bench.text(&rows, &learner))?;
        }
        let texts = [("data", defaults::TRAIN), ("test", defaults::TEST)];
        let texts = if self.data.is_none() { &texts[..] } else { &[] };
        self.report.write(|| bench.page(&rows, &learner), global, &Sources { files: &files, texts })
    }

    /// The files that are read, by what they are for.
    fn files(&self) -> Vec<(&'static str, &Path)> {
        let files = [("data", &self.data), ("test", &self.test), ("template", &self.columns.template)];
        files.into_iter().filter_map(|(what, path)| Some((what, path.as_deref()?))).collect()
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
    how: &'d TrainerOptions,
    data: &'d Both<T::Data>,
}

impl<T: Verbs> Bench<'_, T> {
    fn row(&self, algorithm: Algorithm, trainer: Trainer, learner: &AnyLearner, global: &Global) -> Result<Row> {
        let bar = Bar::new(&algorithm.name(), global.quiet);
        let watch = |progress: &_| bar.show(progress);
        let run = Run { watch: &watch, ..Run::new(global.seed).kept(None) };
        let trained = T::train(&self.problem, &run, &|problem, run| self.how.train(problem, (&trainer, learner), run))?;
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
            weights: trainer.weights(),
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
        format!(
            "{}\n\n{}{}\n{}",
            self.lead(learner),
            results::<T>(rows),
            self.best().map_or(String::new(), |best| best + "\n"),
            bill(rows)
        )
    }

    fn lead(&self, learner: &AnyLearner) -> String {
        format!(
            "{} {} to learn from, {} to measure on; learner {}",
            grouped(self.data.train.sentences() as f64),
            T::UNITS.episodes,
            grouped(self.data.test.sentences() as f64),
            spoken(learner),
        )
    }

    fn best(&self) -> Option<String> {
        Some(format!("No labelling of these sentences is expected to exceed {:.2} %.", self.data.best?))
    }

    /// What there is to be seen.
    fn page(&self, rows: &[Row], learner: &AnyLearner) -> Page {
        let words = self.data.test.tokens() as f64 / self.data.test.sentences() as f64;
        let least = self.data.best.map(|best| (1.0 - best / 100.0) * words);
        let mut figures = vec![loss::<T>(rows, least), ledgers(rows)];
        let weights = rows.iter().filter_map(|row| Some((&row.algorithm, row.weights.as_ref()?)));
        figures.extend(weights.map(|(name, weights)| mixture(&format!("weights-{name}"), name, weights)));
        Page {
            title: format!("Algorithms compared on {}", T::NAME),
            lead: format!("{}. {}", self.lead(learner), self.best().unwrap_or_default()),
            figures,
            tables: vec![("Results".to_owned(), results::<T>(rows)), ("The bill".to_owned(), bill(rows))],
            ..Page::default()
        }
    }
}

/// What was measured.
fn results<T: Verbs>(rows: &[Row]) -> Table {
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
            let mut cells = vec![row.algorithm.clone(), measured.name(), format!("{:.3}", measured.loss)];
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
    results
}

impl Measured {
    /// The reading's name.
    fn name(&self) -> String {
        self.reading.map_or("-".into(), |r| super::train::to_json(&r).trim_matches('"').to_owned())
    }
}

/// Loss against what the expert was asked, and the loss that none is expected to go below.
fn loss<T: Verbs>(rows: &[Row], least: Option<f64>) -> Figure {
    let dots = |row: &Row| {
        let dot = |measured: &Measured| {
            let name = measured.reading.map_or(String::new(), |_| measured.name());
            Dot { x: row.ledger.queries as f64, y: measured.loss, name, ..Dot::default() }
        };
        Series::Dots(row.algorithm.clone(), row.readings.iter().map(dot).collect())
    };
    let mut series: Vec<Series> = rows.iter().map(dots).collect();
    let best = least.map(|least| Series::level("best possible", least, &series));
    series.extend(best);
    let lost = format!("{} per {}", T::UNITS.loss, T::UNITS.episode);
    let plot = Plot { x: Axis::log("expert queries"), y: Axis::linear(&lost), series };
    let note = "Further down is better, further left is cheaper. Mixtures have a mark for each way to read them.";
    Figure::plot("loss", "Loss against expert queries", note, &plot)
}

/// Every entry of every bill: what was predicted, and what was measured.
fn ledgers(rows: &[Row]) -> Figure {
    let dots = |row: &Row| {
        let measured = Expected::from(row.ledger);
        let dot = |(name, of): &Entry| Dot {
            x: of(&row.expected),
            y: of(&measured),
            name: (*name).to_owned(),
            ..Dot::default()
        };
        Series::Dots(row.algorithm.clone(), ENTRIES.iter().map(dot).collect())
    };
    let mut series: Vec<Series> = rows.iter().map(dots).collect();
    series.push(Series::diagonal("as predicted", &series));
    let plot = Plot { x: Axis::log("predicted"), y: Axis::log("measured"), series };
    let note = "A mark for each entry of the bill: labels, queries, resets, steps and so on. On the line are those that came out as predicted.";
    Figure::plot("ledger", "The bill: predicted against measured", note, &plot)
}

/// An entry of the bill: its name and where it stands.
type Entry = (&'static str, fn(&Expected) -> f64);
const ENTRIES: [Entry; 8] = [
    ("labels", |e| e.labels),
    ("expert acts", |e| e.expert_acts),
    ("roll-out acts", |e| e.rollout_acts),
    ("expert queries", |e| e.queries),
    ("roll-outs", |e| e.rollouts),
    ("resets", |e| e.resets),
    ("steps", |e| e.steps),
    ("examples", |e| e.examples),
];

/// The bill: what was measured, and below it what was predicted.
fn bill(rows: &[Row]) -> Table {
    let mut table = Table::new(std::iter::once("the bill").chain(rows.iter().map(|row| row.algorithm.as_str())));
    for (name, field) in ENTRIES {
        let cells = |of: &dyn Fn(&Row) -> Expected| rows.iter().map(|row| grouped(field(&of(row)))).collect::<Vec<_>>();
        table.row(std::iter::once(name.to_owned()).chain(cells(&|row| row.ledger.into())));
        table.row(std::iter::once("  predicted".to_owned()).chain(cells(&|row| row.expected)));
    }
    table
}
