//! What long runs need: checkpoints, an end before the end, a log.

use super::Given;
use super::report::sha256;
use super::terminal::tell;
use super::train::same_file;
use crate::error::{Error, Result};
use crate::read::input;
use crate::tasks::About;
use crate::trainer::{Checkpoint, Keeping, Progress};
use clap::Args;
use serde::Serialize;
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Options of long runs.
#[derive(Args)]
#[command(next_help_heading = "Long runs")]
pub struct LongOptions {
    /// Keep the whole state of training in this folder after every round, so that a run that was killed can be resumed
    #[arg(long, value_name = "FOLDER")]
    checkpoint: Option<PathBuf>,
    /// Go on from the checkpoint, to the same model to the bit; from the beginning where there is none
    #[arg(long, requires = "checkpoint")]
    resume: bool,
    /// Begin no round after so long, such as 90s, 30m or 2h; the model is written all the same
    #[arg(long, value_name = "TIME", value_parser = duration)]
    time_limit: Option<Duration>,
    /// Append one line of JSON to this file after every round
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
}

/// A time such as 90s, 30m or 2h.
fn duration(text: &str) -> Result<Duration> {
    let wrong = || Error::argument("time", text, "a number and s, m or h, such as 90s, 30m or 2h");
    let (number, unit) = text.split_at_checked(text.len().saturating_sub(1)).ok_or_else(wrong)?;
    let seconds = match unit {
        "s" => 1.0,
        "m" => 60.0,
        "h" => 3600.0,
        _ => return Err(wrong()),
    };
    let number: f64 = number.parse().map_err(|_| wrong())?;
    Duration::try_from_secs_f64(number * seconds).map_err(|_| wrong())
}

/// What resuming does not depend on: where results go, and how the run is watched.
const FREE: [&str; 9] = ["model", "threads", "quiet", "json", "checkpoint", "resume", "time_limit", "log", "help"];

impl LongOptions {
    /// The checkpoint, if one is asked for, of what was `given` on the command line and training depends on beside that: `features` gives the features'
    /// checksum.
    pub fn keeping(&self, given: &Given, data: &Path, features: impl FnOnce() -> u64) -> Result<Keeping> {
        let Some(folder) = &self.checkpoint else { return Ok(None) };
        let corpus = sha256(&input::bytes(data)?);
        let features = format!("{:016x}", features());
        let mut of = vec![
            ("the version", env!("CARGO_PKG_VERSION")),
            ("the corpus", &corpus),
            ("the checksum of the features", &features),
        ];
        of.extend(given.without(&FREE));
        if !self.resume {
            return Checkpoint::begin(folder, &of).map(Some);
        }
        let checkpoint = Checkpoint::resume(folder, &of)?;
        if checkpoint.is_empty()? {
            tell("note", &format!("{}: no checkpoint there: training begins at the beginning", folder.display()));
        }
        Ok(Some(checkpoint))
    }

    /// Refuses what cannot go together, before anything is read.
    pub fn check(&self, data: &Path, model: &Path) -> Result<()> {
        if let Some(log) = &self.log
            && (log == model || same_file(log, data) || same_file(log, model))
        {
            return Err(Error::argument("--log", log.display(), "another file than --data and --model"));
        }
        if self.checkpoint.is_some() && data == Path::new("-") {
            return Err(Error::argument("--data", "-", "a file for --checkpoint: a resumed run reads it again"));
        }
        Ok(())
    }

    /// The log, if one is asked for, of a training that `about` tells about; one that goes on if something is kept.
    pub fn log(&self, keep: &Keeping, about: &About) -> Result<Option<Log>> {
        let Some(path) = &self.log else { return Ok(None) };
        let goes_on = match keep {
            Some(checkpoint) => !checkpoint.is_empty()?,
            None => false,
        };
        let (mut log, mut text) = Log::open(path)?;
        let whole = memchr::memrchr(b'\n', &text).map_or(0, |end| end + 1);
        if whole < text.len() {
            if !self.resume {
                let problem = "its last line is not whole";
                return Err(Error::file(path, problem, "name another file, or go on with --resume"));
            }
            // What was being written when the last run was killed.
            text.truncate(whole);
            log.cut(whole)?;
        }
        let lines: Vec<&[u8]> = text.split_inclusive(|byte| *byte == b'\n').collect();
        match lines.iter().rev().position(|line| line.starts_with(HEAD)).filter(|_| goes_on) {
            Some(rounds) => log.begin(rounds),
            None => {
                let About { trainer, learner, seed, data, .. } = about;
                log.head(&serde_json::json!({ "trainer": trainer, "learner": learner, "seed": seed, "data": data }))?;
            }
        }
        Ok(Some(log))
    }

    /// When no further round is to begin.
    pub fn deadline(&self) -> Option<Instant> {
        self.time_limit.and_then(|limit| Instant::now().checked_add(limit))
    }
}

/// Whether an interrupt came.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// What a program ends with that was interrupted, as a shell has it.
const INTERRUPT: u8 = 130;

/// Lets the first interrupt (Ctrl-C, SIGTERM, SIGHUP) end training after its round, and the second one the program at once.
pub fn catch_interrupts() -> Result<()> {
    let caught = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::SeqCst) {
            std::process::exit(INTERRUPT.into());
        }
        tell("note", &"interrupted: the model is written after this round; once more to stop at once");
    });
    caught.map_err(|error| Error::io("catch", "<interrupts>", std::io::Error::other(error)))
}

/// Whether an interrupt came.
pub fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}

/// How the program ends.
pub fn ending() -> ExitCode {
    if interrupted() { ExitCode::from(INTERRUPT) } else { ExitCode::SUCCESS }
}

/// A log of rounds: a line of JSON that tells what is trained, then a line for each round.
pub struct Log {
    path: PathBuf,
    state: Mutex<Lines>,
}

struct Lines {
    file: File,
    /// Rounds of this training that have their line.
    logged: usize,
    /// The first that could not be written.
    failed: Option<std::io::Error>,
}

impl Log {
    /// The log at `path`, which is made if need be, and what stands in it.
    fn open(path: &Path) -> Result<(Self, Vec<u8>)> {
        let refused = |source| Error::io("write", path, source);
        let mut file = OpenOptions::new().create(true).read(true).append(true).open(path).map_err(refused)?;
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(refused)?;
        let state = Mutex::new(Lines { file, logged: 0, failed: None });
        Ok((Log { path: path.to_owned(), state }, text))
    }

    fn lines(&mut self) -> &mut Lines {
        self.state.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps the first `length` bytes.
    fn cut(&mut self, length: usize) -> Result<()> {
        let cut = self.lines().file.set_len(length as u64);
        cut.map_err(|source| Error::io("write", &self.path, source))
    }

    /// So many rounds of this training are there.
    fn begin(&mut self, rounds: usize) {
        self.lines().logged = rounds;
    }

    /// Appends the first line of a training.
    fn head(&mut self, training: &serde_json::Value) -> Result<()> {
        let written = self.lines().file.write_all(&line(&serde_json::json!({ "training": training })));
        written.map_err(|source| Error::io("write", &self.path, source))
    }

    /// Appends a round, unless it is there.
    pub fn write(&self, progress: &Progress) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if progress.round <= state.logged || state.failed.is_some() {
            return;
        }
        let written = state.file.write_all(&line(progress)).and_then(|()| state.file.flush());
        (state.logged, state.failed) = (progress.round, written.err());
    }

    /// Tells what could not be written.
    pub fn finish(self) -> Result<()> {
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        state.failed.map_or(Ok(()), |source| Err(Error::io("write", &self.path, source)))
    }
}

/// What the first line of a training begins with.
const HEAD: &[u8] = b"{\"training\":";

/// A line of JSON.
fn line(value: &impl Serialize) -> Vec<u8> {
    let mut line = serde_json::to_vec(value).unwrap_or_default();
    line.push(b'\n');
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read() {
        let seconds = |text: &str| duration(text).ok().map(|time| time.as_secs_f64());
        assert_eq!([seconds("90s"), seconds("1.5m"), seconds("2h")], [Some(90.0), Some(90.0), Some(7200.0)]);
        for wrong in ["", "s", "90", "-1s", "1d", "infs", "nans", "1e300h", "1 h", "h2", "5é"] {
            assert_eq!(seconds(wrong), None, "{wrong}");
        }
    }
}
