//! `rollin train`

use super::algorithms::{Algorithm, TrainerOptions};
use super::long::LongOptions;
use super::options::{LearnerOptions, Reading, ReadingName, no_such_setting};
use super::progress::Bar;
use super::tasks::{TaskName, Verbs, with_task};
use super::{Given, Global, long, print, print_json};
use crate::error::{Error, Result};
use crate::output::{check_writable, checksum};
use crate::report::{Table, grouped};
use crate::seed::{Purpose, Seed};
use crate::tasks::{About, Data, Fact, Model, Recipe, Task};
use crate::trainer::{Progress, Run};
use clap::Args;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Train a tagger, a segmenter, a parser, a reader of handwriting, a labeller of graphs, a traveller or a walker and write its model file.
#[derive(Args)]
#[command(after_help = super::help::train(), after_long_help = super::help::recipes())]
pub struct Train {
    /// What is learned
    #[arg(long, value_enum, default_value_t, value_name = "NAME")]
    task: TaskName,
    /// What to learn from: one token a line, columns between spaces or tabs, a blank line after each sentence; for parsing CoNLL-U, for
    /// ocr a line a letter, with columns word_id, position, fold, letter and bits between tabs; for graph a line a node (name, label, features) or an
    /// edge (a -- b or a -> b); for navigation maps of letters a to z and # with trips such as 1,1 -> 5,3 below; for tabular an instance as
    /// for `rollin theory` (- for standard input)
    #[arg(long, value_name = "FILE")]
    data: PathBuf,
    /// The model file to write
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// The algorithm that decides at which states the expert is asked
    #[arg(long, value_enum, default_value = "dagger-online", value_name = "NAME")]
    algorithm: Algorithm,
    /// How the model chooses a label where the algorithm makes a mixture of classifiers (smile, searn, searn-online, cpi)
    #[arg(long, value_enum, default_value = "mean", value_name = "NAME")]
    reading: ReadingName,
    /// Set the last tenth of the sentences aside, to learn from them how sure the model may be: for `rollin tag --confidence`
    #[arg(long)]
    calibrate: bool,
    #[command(flatten)]
    columns: Reading,
    #[command(flatten)]
    trainer: TrainerOptions,
    #[command(flatten)]
    learner: LearnerOptions,
    #[command(flatten)]
    long: LongOptions,
}

impl Train {
    pub fn run(&self, global: &Global, given: &Given) -> Result<ExitCode> {
        with_task!(self.task, T => self.run_as::<T>(global, given))
    }

    fn run_as<T: Verbs>(&self, global: &Global, given: &Given) -> Result<ExitCode> {
        let deadline = self.long.deadline();
        self.long.check(&self.data, &self.model)?;
        self.columns.refuse_others(T::NAME)?;
        self.trainer.check(&[self.algorithm])?;
        let (trainer, learner) = (self.trainer.trainer(self.algorithm), self.learner.learner()?);
        let recipe = Recipe { trainer, learner, reading: self.reading.into(), seed: global.seed };
        use Algorithm::{DaggerOnline, EarlyUpdate, LolsOnline, SearnOnline};
        if matches!(self.algorithm, SearnOnline | DaggerOnline | LolsOnline | EarlyUpdate) {
            self.learner.refuse_passes(&format!("{} makes one pass a round; use --rounds", self.algorithm.name()))?;
        }
        if same_file(&self.model, &self.data) {
            return Err(Error::argument("--model", self.model.display(), "another file than --data"));
        }
        check_writable(&self.model)?;
        let corpus = self.columns.corpus::<T>(&self.data)?;
        let (encoding, mut problem) = T::learn(&corpus, T::settings(&self.columns, &corpus)?)?;
        let held_out = self.held_out::<T>(&corpus)?;
        problem.episodes = held_out.start;

        let mut about = About { expert: self.trainer.flaw(), ..recipe.about(&corpus) };
        let extent = [corpus.sentences(), corpus.tokens()].map(|count| grouped(count as f64));
        // Large, and of no more use.
        drop(corpus);
        let keep = self.long.keeping(given, &self.data, || checksum_of(&encoding))?;
        let log = self.long.log(&keep, &about)?;
        let kept = keep.is_some();
        let bar = Bar::new(&self.algorithm.name(), global.quiet);
        let watch = |progress: &_| {
            bar.show(progress);
            log.iter().for_each(|log| log.write(progress));
        };
        let stop = || long::interrupted() || deadline.is_some_and(|deadline| Instant::now() >= deadline);
        long::catch_interrupts()?;
        let run = Run { watch: &watch, stop: &stop, ..Run::new(global.seed).kept(keep) };
        let trained = T::train(&problem, &run, &|problem, run| {
            self.trainer.train(problem, (&recipe.trainer, &recipe.learner), run)
        })?;
        drop(bar);
        let policy = trained.policy.read_as(recipe.reading);
        let mut temperatures = Vec::new();
        if self.calibrate {
            problem.episodes = held_out.end;
            let seed = Seed::new(global.seed).child(Purpose::Evaluation, 1);
            temperatures = T::calibrate(&policy, &problem, &held_out.collect::<Vec<_>>(), seed);
        }
        // Large, and of no more use.
        drop(problem);

        about.ledger = trained.ledger;
        about.stopped = trained.stopped.then_some(trained.rounds.len());
        let model = Model { temperatures, ..Model::new(encoding, policy, about)? };
        model.save(&self.model)?;
        log.map_or(Ok(()), long::Log::finish)?;
        let facts = model.encoding.facts();
        let code = if trained.stopped { long::ending() } else { ExitCode::SUCCESS };

        if global.json {
            let mut report = serde_json::json!({
                "model": self.model,
                "about": model.about,
                "rounds": trained.rounds,
                "features": model.encoding.features(),
            });
            facts.into_iter().for_each(|fact| report[fact.name] = fact.value);
            return print_json(&report).map(|()| code);
        }
        let table = rounds(&trained.rounds, T::UNITS.episode);
        let how = if kept { ": go on with --resume" } else { "" };
        let end = model.about.stopped.map_or_else(String::new, |round| format!("stopped after round {round}{how}\n"));
        print(&format!(
            "{} {}, {} {}{}\n\n{table}\n{end}wrote {}\n",
            extent[0],
            T::UNITS.episodes,
            extent[1],
            T::UNITS.steps,
            short(&facts),
            self.model.display(),
        ))
        .map(|()| code)
    }
}

impl Train {
    /// The numbers of the sentences that are set aside: none, or the last tenth.
    fn held_out<T: Verbs>(&self, corpus: &T::Data) -> Result<Range<usize>> {
        let all = corpus.sentences();
        if !self.calibrate {
            return Ok(all..all);
        }
        if !T::CONFIDENT {
            return Err(no_such_setting("--calibrate", T::NAME));
        }
        if all < 10 {
            let few = format!("too few {} to set a tenth aside: {all}", T::UNITS.episodes);
            return Err(Error::file(corpus.path(), few, "give at least 10, or leave --calibrate out"));
        }
        Ok(all - all / 10..all)
    }
}

/// How training went, round by round; regrets where there are any.
pub fn rounds(rounds: &[Progress], episode: &str) -> Table {
    let regrets = rounds.iter().any(|round| round.regret.is_some());
    let cost = format!("cost per {episode}");
    let mut headings = vec!["round", &cost];
    headings.extend(regrets.then_some(["regret to the expert", "to deviations"]).into_iter().flatten());
    headings.extend(["labels", "expert acts", "roll-out acts", "seconds"]);
    let mut table = Table::new(headings);
    let cell = |cost: Option<f64>| cost.filter(|c| !c.is_nan()).map_or("-".to_owned(), |cost| format!("{cost:.3}"));
    for round in rounds {
        let mut cells = vec![round.round.to_string(), cell(Some(round.cost))];
        let regret = round.regret.unwrap_or_default();
        cells.extend(regrets.then_some([cell(regret.reference), cell(regret.deviations)]).into_iter().flatten());
        cells.extend([
            grouped(round.ledger.labels as f64),
            grouped(round.ledger.expert_acts as f64),
            grouped(round.ledger.rollout_acts as f64),
            format!("{:.2}", round.seconds),
        ]);
        table.row(cells);
    }
    table
}

/// The facts in a few words each: how many of what, then what is what.
fn short(facts: &[Fact]) -> String {
    let count = |fact: &Fact| fact.value.as_array().map(|all| format!(", {} {}", all.len(), fact.name));
    let single = |fact: &&Fact| !fact.value.is_array() && !fact.text.is_empty() && !fact.text.contains('\n');
    let others = facts.iter().filter(single).map(|fact| format!(", {} {}", fact.name, fact.text));
    facts.iter().filter_map(count).chain(others).collect()
}

/// Whether both are there and are one file.
pub fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// A number that tells what turns text into features apart from others.
fn checksum_of<T: Task>(encoding: &T) -> u64 {
    let mut bytes = to_json(&encoding.header()).into_bytes();
    bytes.extend(encoding.arrays().into_iter().flatten().flat_map(|key| key.to_le_bytes()));
    checksum(&bytes)
}

/// Settings as text.
pub fn to_json(settings: &impl serde::Serialize) -> String {
    serde_json::to_string(settings).unwrap_or_default()
}
