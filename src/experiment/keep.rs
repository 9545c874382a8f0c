//! What lets an experiment go on after it was killed: a learner that keeps what it learned, and an expert whose answers are kept.
//!
//! A trainer that is run again does the same again, because all its randomness is keyed. So nothing of its state needs to be kept, only what took
//! long: every classifier, and every answer of the expert, by the key of the step at which it was given. The second time the games are played again,
//! but nothing is learned or asked twice.

use super::Stored;
use crate::error::{Error, Result};
use crate::experiment::Driver;
use crate::learner::{CrossValidated, Examples, Learner, Net, Sensed, Setting};
use crate::output::write_whole;
use crate::policy::Mixture;
use crate::policy::Neural;
use crate::seed::Seed;
use crate::space::{Action, Expert, Space};
use crate::tasks::{opened, sealed};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What is inside, whatever happened to those who held it before.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What files of answers and classifiers call themselves.
const ANSWERS: &str = "experiment-answers";
const CLASSIFIER: &str = "experiment-classifier";

/// What a file of answers says of itself.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    task: String,
    count: usize,
}

/// Answers of an expert, by the number of the seed they were asked with. Two steps of an experiment of a million answers have the same with a
/// probability of 3e-8.
#[derive(Default)]
pub struct Answers {
    /// Those from files.
    before: HashMap<u64, u32>,
    /// Those given since they were last written.
    new: Mutex<Vec<(u64, u32)>>,
    /// Where they are kept, if they are.
    folder: Option<PathBuf>,
}

impl Answers {
    /// Those in `folder`, where further ones will be kept.
    pub fn open(folder: Option<&Path>, rounds: usize) -> Result<Self> {
        let mut answers = Answers { folder: folder.map(Path::to_owned), ..Answers::default() };
        let paths: Vec<PathBuf> = (0..rounds).filter_map(|round| answers.path(round)).collect();
        for path in paths.into_iter().filter(|path| path.exists()) {
            let bytes = std::fs::read(&path).map_err(|source| Error::io("read", &path, source))?;
            let (header, mut arrays): (Header, _) = opened(&bytes, &path, ANSWERS)?;
            let pairs = arrays.take::<12>(header.count).ok_or_else(|| {
                Error::file(&path, "fewer answers than it says", "delete it: they will be asked for again")
            })?;
            answers.before.extend(pairs.iter().map(|[a, b, c, d, e, f, g, h, rest @ ..]| {
                (u64::from_le_bytes([*a, *b, *c, *d, *e, *f, *g, *h]), u32::from_le_bytes(*rest))
            }));
        }
        Ok(answers)
    }

    fn path(&self, round: usize) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(format!("answers-{round}")))
    }

    /// Writes what is new, which was asked for in `round`.
    fn write(&self, round: usize) -> Result<()> {
        let mut new = std::mem::take(&mut *lock(&self.new));
        let Some(path) = self.path(round).filter(|_| !new.is_empty()) else { return Ok(()) };
        new.sort_unstable();
        let header = Header { task: ANSWERS.into(), count: new.len() };
        let mut body = serde_json::to_vec(&header).unwrap_or_default();
        body.push(b'\n');
        new.iter().for_each(|(key, answer)| body.extend([&key.to_le_bytes()[..], &answer.to_le_bytes()].concat()));
        write_whole(&path, &sealed(body))
    }
}

/// An expert whose answers are kept. Its answers at roll-outs are not: there a seed is shared by many states.
pub struct Remembering<'a, E> {
    expert: &'a E,
    answers: Option<&'a Answers>,
}

impl<'a, E> Remembering<'a, E> {
    /// `expert`, whose answers are in `answers`, if they are to be kept.
    pub fn new(expert: &'a E, answers: Option<&'a Answers>) -> Self {
        Remembering { expert, answers }
    }
}

/// What an answer is in files: silence, or an action.
const SILENCE: u32 = u32::MAX;

impl<S: Space, E: Expert<S>> Expert<S> for Remembering<'_, E> {
    fn action(&self, space: &S, state: &S::State) -> Option<Action> {
        self.expert.action(space, state)
    }

    fn answer(&self, space: &S, state: &S::State, seed: Seed) -> Option<Action> {
        let Some(answers) = self.answers.filter(|answers| answers.folder.is_some()) else {
            return self.expert.answer(space, state, seed);
        };
        if let Some(known) = answers.before.get(&seed.number()) {
            return Some(Action(*known)).filter(|action| action.0 != SILENCE);
        }
        let answer = self.expert.answer(space, state, seed);
        lock(&answers.new).push((seed.number(), answer.map_or(SILENCE, |action| action.0)));
        answer
    }
}

/// A learner that keeps all it learned, in memory and in files.
pub struct Keeping<'a, V: Sensed> {
    learner: &'a CrossValidated<Net>,
    answers: &'a Answers,
    learned: Mutex<Vec<Neural<V::Layer>>>,
    trouble: Mutex<Option<Error>>,
    /// Who is told that one more has been learned, and which.
    watch: &'a (dyn Fn(usize) + Sync),
}

impl<'a, V: Sensed<Layer: Stored<V>>> Keeping<'a, V> {
    /// `learner`, whose files are where those of `answers` are.
    pub fn new(learner: &'a CrossValidated<Net>, answers: &'a Answers, watch: &'a (dyn Fn(usize) + Sync)) -> Self {
        Keeping { learner, answers, learned: Mutex::default(), trouble: Mutex::default(), watch }
    }

    /// All it learned, the first first.
    ///
    /// # Errors
    /// The first that came up in reading or writing a file.
    pub fn finish(self) -> Result<Vec<Neural<V::Layer>>> {
        match self.trouble.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(error) => Err(error),
            None => Ok(self.learned.into_inner().unwrap_or_else(PoisonError::into_inner)),
        }
    }

    /// What was learned in `round`, if it is in its file.
    fn read(&self, path: &Path, setting: Setting<'_, V>) -> Result<Option<Neural<V::Layer>>> {
        if !path.exists() {
            return Ok(None);
        }
        let bytes = std::fs::read(path).map_err(|source| Error::io("read", path, source))?;
        let kind = (CLASSIFIER, setting.shared, setting.actions);
        match Driver::from_bytes::<V>(&bytes, path, kind)?.0 {
            Driver::Ladder(ladder) => Ok(ladder.steps().first().cloned()),
            Driver::Mixture(mixture) => Ok(mixture.members().first().map(|(_, net)| net.clone())),
        }
    }

    fn learn(
        &self,
        round: usize,
        setting: Setting<'_, V>,
        examples: &Examples<V>,
        warm: Option<&Neural<V::Layer>>,
        seed: Seed,
    ) -> Result<Neural<V::Layer>> {
        let path = self.answers.folder.as_ref().map(|folder| folder.join(format!("classifier-{round}")));
        if let Some(path) = &path
            && let Some(net) = self.read(path, setting)?
        {
            return Ok(net);
        }
        self.answers.write(round)?;
        let net = self.learner.fit(setting, examples, warm, seed);
        if let Some(path) = &path {
            let one = Driver::Mixture(Mixture::of_one(net.clone()));
            write_whole(path, &one.to_bytes::<V>(CLASSIFIER, ""))?;
        }
        Ok(net)
    }
}

impl<V: Sensed<Layer: Stored<V>>> Learner<V> for Keeping<'_, V> {
    type Classifier = Neural<V::Layer>;

    fn fit(
        &self,
        setting: Setting<'_, V>,
        examples: &Examples<V>,
        warm: Option<&Self::Classifier>,
        seed: Seed,
    ) -> Self::Classifier {
        let round = lock(&self.learned).len();
        let net = self.learn(round, setting, examples, warm, seed).unwrap_or_else(|error| {
            // A learner cannot fail: the error is told at the end, and until then something is learned from nothing.
            lock(&self.trouble).get_or_insert(error);
            CrossValidated { most: 0, ..self.learner.clone() }.fit(setting, &Examples::default(), None, seed)
        });
        lock(&self.learned).push(net.clone());
        (self.watch)(round);
        net
    }
}
