//! Training that goes on after it was killed, to the same bits.
//!
//! All randomness of a trainer is keyed, so what it does next follows from its settings, the problem and what it knew when its last round was
//! closed. That is its *state*, and it stands in the signature of every trainer: what keeps it is a [`Keeper`] of this state. Nothing (`()`) keeps anything;
//! a [`Checkpoint`] keeps what is [`Kept`].

use super::{Progress, Regret};
use crate::error::{Error, Result};
use crate::learner::{Kept, MOST_COUNTED, Setting};
use crate::output::{Arrays, BESIDE, Seal, first_line, write_whole};
use crate::space::View;
use crate::worker::Ledger;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Who keeps what a trainer knows after each round, for spaces whose view is `V`: its state `S`.
pub trait Keeper<V: View, S> {
    /// The state that was kept last, and the rounds before it; where none was kept, `start` and no rounds.
    ///
    /// # Errors
    /// When something was kept that cannot be gone on from.
    fn load(&self, setting: Setting<'_, V>, start: S) -> Result<(S, Vec<Progress>)>;

    /// Keeps `state`, which came of `rounds`, in place of what was kept before.
    ///
    /// # Errors
    /// When it cannot be kept; what was kept before is then still there.
    fn save(&self, state: &S, rounds: &[Progress]) -> Result<()>;
}

/// Nothing is kept.
impl<V: View, S> Keeper<V, S> for () {
    fn load(&self, _: Setting<'_, V>, start: S) -> Result<(S, Vec<Progress>)> {
        Ok((start, Vec::new()))
    }
    fn save(&self, _: &S, _: &[Progress]) -> Result<()> {
        Ok(())
    }
}

/// Something is kept, or nothing.
impl<V: View, S, K: Keeper<V, S>> Keeper<V, S> for Option<K> {
    fn load(&self, setting: Setting<'_, V>, start: S) -> Result<(S, Vec<Progress>)> {
        match self {
            Some(keeper) => keeper.load(setting, start),
            None => ().load(setting, start),
        }
    }
    fn save(&self, state: &S, rounds: &[Progress]) -> Result<()> {
        self.as_ref().map_or(Ok(()), |keeper| keeper.save(state, rounds))
    }
}

/// A checkpoint, if one is asked for.
pub type Keeping = Option<Checkpoint>;

/// Checkpoint files.
const CHECKPOINT: Seal = Seal {
    name: "checkpoint",
    version: 1,
    stranger: "name a folder that `rollin train --checkpoint` wrote",
    outdated: "begin again in another folder, or use the program that wrote it",
    broken: "delete it to begin again",
};

/// What the names of checkpoint files end with.
const ENDING: &str = "checkpoint";

/// A folder in which the state of a training lies: one file for each [stage](Checkpoint::stage), written beside, flushed to the disk and renamed, so
/// that whenever the program ends, however it does, the last whole state is there. Files are read as untrusted input.
///
/// ```
/// use rollin::learner::Perceptron;
/// use rollin::tasks::tagging;
/// use rollin::trainer::{Checkpoint, Run, Smile};
///
/// let (problem, folder) = (tagging::doc::problem()?, tempfile::tempdir().unwrap());
/// let smile = Smile { rounds: 3, ..Smile::default() };
/// let train = |keep| smile.train(&problem, &Perceptron::default(), &Run::new(1).kept(keep));
/// train(Checkpoint::begin(folder.path(), &[("seed", "1")])?)?;
/// assert!(Checkpoint::begin(folder.path(), &[("seed", "1")]).is_err()); // there is one already
/// let again = train(Checkpoint::resume(folder.path(), &[("seed", "1")])?)?; // all rounds are known: none is run
/// assert_eq!(again.rounds.len(), 3);
/// assert!(train(Checkpoint::resume(folder.path(), &[("seed", "2")])?).is_err()); // another training's
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Checkpoint {
    folder: PathBuf,
    stage: String,
    /// What the training depends on, by name.
    of: Arc<BTreeMap<String, String>>,
    /// Held as long as any clone lives.
    _lock: Arc<File>,
}

impl Checkpoint {
    /// Keeps a training that begins in `folder`, which is made if need be. The training depends on what `of` names: settings, corpora, versions.
    ///
    /// # Errors
    /// When a checkpoint lies there already, another run is using the folder, or the system refuses.
    pub fn begin(folder: impl AsRef<Path>, of: &[(&str, &str)]) -> Result<Self> {
        let checkpoint = Checkpoint::resume(folder, of)?;
        if !checkpoint.is_empty()? {
            let problem = "a checkpoint of a training lies there already";
            return Err(Error::file(checkpoint.folder, problem, "go on from it with --resume, or name another folder"));
        }
        Ok(checkpoint)
    }

    /// Goes on with the training in `folder`, or begins one where there is none.
    ///
    /// # Errors
    /// When another run is using the folder, or the system refuses.
    pub fn resume(folder: impl AsRef<Path>, of: &[(&str, &str)]) -> Result<Self> {
        let folder = folder.as_ref();
        std::fs::create_dir_all(folder).map_err(|source| Error::io("make", folder, source))?;
        let lock = folder.join("lock");
        let file = File::create(&lock).map_err(|source| Error::io("write", &lock, source))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                return Err(Error::file(folder, "another run is using this folder", "wait for it, or name another"));
            }
            Err(TryLockError::Error(source)) => return Err(Error::io("lock", &lock, source)),
            Ok(()) => {}
        }
        let of = of.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
        let (folder, stage) = (folder.to_owned(), "training".to_owned());
        let checkpoint = Checkpoint { folder, stage, of: Arc::new(of), _lock: Arc::new(file) };
        // What was being written when the last run was killed.
        for name in checkpoint.names()?.iter().filter(|name| name.starts_with(BESIDE)) {
            let path = checkpoint.folder.join(name);
            std::fs::remove_file(&path).map_err(|source| Error::io("delete", &path, source))?;
        }
        Ok(checkpoint)
    }

    /// The same folder for a part of the training that is one of its own, such as the first of two readings.
    pub fn stage(&self, name: &str) -> Self {
        Checkpoint { stage: name.to_owned(), ..self.clone() }
    }

    /// Whether nothing is kept yet.
    ///
    /// # Errors
    /// When the folder cannot be read.
    pub fn is_empty(&self) -> Result<bool> {
        Ok(!self.names()?.iter().any(|name| Path::new(name).extension().is_some_and(|ending| ending == ENDING)))
    }

    /// The names in the folder.
    fn names(&self) -> Result<Vec<String>> {
        let entries = std::fs::read_dir(&self.folder).and_then(Iterator::collect::<std::io::Result<Vec<_>>>);
        let entries = entries.map_err(|source| Error::io("read", &self.folder, source))?;
        Ok(entries.iter().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect())
    }

    fn path(&self) -> PathBuf {
        self.folder.join(&self.stage).with_added_extension(ENDING)
    }

    /// Refuses a checkpoint of another training, which depended on `other`.
    fn compare(&self, other: &BTreeMap<String, String>, path: &Path) -> Result<()> {
        let names: BTreeSet<&String> = other.keys().chain(self.of.keys()).collect();
        let differs = |name: &&String| match (other.get(*name), self.of.get(*name)) {
            (before, now) if before == now => None,
            (Some(before), Some(now)) => Some(format!("{name} was {before} and is {now}")),
            (Some(before), None) => Some(format!("{name} was {before} and is not given")),
            (None, now) => Some(format!("{name} was not given and is {}", now.map_or("", |now| now))),
        };
        let differences: Vec<String> = names.iter().filter_map(differs).collect();
        if differences.is_empty() {
            return Ok(());
        }
        let problem = format!("the checkpoint of another training: {}", differences.join(", "));
        Err(Error::file(path, problem, "go on as it was begun, or name another folder"))
    }
}

impl<V: View, S: Kept<V>> Keeper<V, S> for Checkpoint {
    fn load(&self, setting: Setting<'_, V>, start: S) -> Result<(S, Vec<Progress>)> {
        let path = self.path();
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok((start, Vec::new())),
            Err(source) => return Err(Error::io("read", &path, source)),
        };
        let body = CHECKPOINT.open(&bytes, &path)?;
        let (json, arrays) = first_line(body).ok_or_else(|| CHECKPOINT.damaged(&path, "no header"))?;
        let of = serde_json::from_slice(json).map_err(|error| CHECKPOINT.damaged(&path, &error.to_string()))?;
        self.compare(&of, &path)?;
        let mut arrays = Arrays::of(arrays);
        <(Vec<Progress>, S)>::take(&mut arrays, setting)
            .filter(|(rounds, state)| arrays.is_empty() && state.follows(&start) && in_order(rounds))
            .map(|(rounds, state)| (state, rounds))
            .ok_or_else(|| CHECKPOINT.damaged(&path, "its state is none of this training"))
    }

    fn save(&self, state: &S, rounds: &[Progress]) -> Result<()> {
        let path = self.path();
        let mut body = serde_json::to_vec(&*self.of).unwrap_or_default();
        body.push(b'\n');
        Kept::<V>::put(&rounds.to_vec(), &mut body);
        state.put(&mut body);
        write_whole(&path, &CHECKPOINT.close(body)).map_err(|error| {
            let n = rounds.len();
            let why = if let Error::Io { source, .. } = &error { source.to_string() } else { error.to_string() };
            let remedy = match n {
                0 | 1 => "make room, and begin again".to_owned(),
                _ => format!("that after round {} is whole: make room, then go on with --resume", n - 1),
            };
            Error::file(&path, format!("the checkpoint after round {n} cannot be written: {why}"), remedy)
        })
    }
}

/// Whether these are the first rounds of a training.
fn in_order(rounds: &[Progress]) -> bool {
    !rounds.is_empty() && rounds.iter().zip(1..).all(|(progress, round)| progress.round == round)
}

impl<V: View> Kept<V> for Ledger {
    fn put(&self, to: &mut Vec<u8>) {
        let Ledger { labels, expert_acts, rollout_acts, queries, rollouts, resets, steps, examples } = *self;
        for count in [labels, expert_acts, rollout_acts, queries, rollouts, resets, steps, examples] {
            Kept::<V>::put(&count, to);
        }
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        let mut next = || u64::take(from, setting).filter(|count| *count <= MOST_COUNTED);
        Some(Ledger {
            labels: next()?,
            expert_acts: next()?,
            rollout_acts: next()?,
            queries: next()?,
            rollouts: next()?,
            resets: next()?,
            steps: next()?,
            examples: next()?,
        })
    }
}

impl<V: View> Kept<V> for Regret {
    fn put(&self, to: &mut Vec<u8>) {
        Kept::<V>::put(&(self.reference, self.deviations), to);
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        let (reference, deviations) = Kept::take(from, setting)?;
        Some(Regret { reference, deviations })
    }
}

impl<V: View> Kept<V> for Progress {
    fn put(&self, to: &mut Vec<u8>) {
        let Progress { round, rounds, cost, regret, ledger, seconds } = *self;
        Kept::<V>::put(&((round, rounds), ((cost, regret), (ledger, seconds))), to);
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        let ((round, rounds), ((cost, regret), (ledger, seconds))) = Kept::take(from, setting)?;
        Some(Progress { round, rounds, cost, regret, ledger, seconds })
    }
}
