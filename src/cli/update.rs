//! `rollin update`

use super::options::read_corpus;
use super::progress::Bar;
use super::tasks::{read_model, with_task};
use super::train::rounds;
use super::{Global, print, print_json};
use crate::error::{Error, Result};
use crate::output::check_writable;
use crate::report::grouped;
use crate::seed::Seed;
use crate::tasks::{Data, Model, Task};
use crate::trainer::{Dagger, Run};
use clap::Args;
use std::path::{Path, PathBuf};

/// Go on training a model with more data, by DAgger online: a tagger or a parser, whose labels stay as they are and whose features become more.
///
/// It learns from the new data alone, starting from the model's weights. What only the old data say is forgotten by and by: give some of them, too, if that is to stay. The
/// model that comes of it is not calibrated.
#[derive(Args)]
#[command(after_help = super::help::update())]
pub struct Update {
    /// The model file to go on from
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// What to learn from, as for `rollin train` (- for standard input)
    #[arg(long, value_name = "FILE")]
    data: PathBuf,
    /// The model file to write; it may be the same
    #[arg(long, value_name = "FILE")]
    output: PathBuf,
    /// Rounds over the new data
    #[arg(long, value_name = "N", default_value_t = Dagger::default().rounds)]
    rounds: usize,
}

impl Update {
    pub fn run(&self, global: &Global) -> Result<()> {
        if self.model == Path::new("-") {
            return Err(Error::argument("--model", "-", "a file"));
        }
        check_writable(&self.output)?;
        let (bytes, task) = read_model(&self.model)?;
        with_task!(task, T => self.run_with(Model::<T>::from_bytes(&bytes, &self.model)?, global))
    }

    fn run_with<T: Task>(&self, model: Model<T>, global: &Global) -> Result<()> {
        let data = read_corpus::<T>(&self.data)?;
        let dagger = Dagger { rounds: self.rounds, ..Dagger::default() };
        let bar = Bar::new("update", global.quiet);
        let watch = |progress: &_| bar.show(progress);
        let run = Run { seed: Seed::new(global.seed), watch: &watch, ..Run::new(global.seed) };
        let before = model.encoding.features();
        let (model, progress) = model.update(&data, &dagger, &run)?;
        drop(bar);
        model.save(&self.output)?;
        if global.json {
            return print_json(&serde_json::json!({
                "model": self.output,
                "about": model.about,
                "rounds": progress,
                "features": model.encoding.features(),
                "features_before": before,
            }));
        }
        let count = |n: usize| grouped(n as f64);
        print(&format!(
            "{} {} more, {} features where there were {}\n\n{}\nwrote {}\n",
            count(data.sentences()),
            T::UNITS.episodes,
            count(model.encoding.features()),
            count(before),
            rounds(&progress, T::UNITS.episode),
            self.output.display(),
        ))
    }
}
