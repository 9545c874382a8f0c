//! The tasks: spaces with their experts and losses.
//!
//! A [`Task`] names what the verbs of the program (and of any other) need: how text is read, how features and actions are learned from it
//! and found again, what is written, what is measured, and what a model file keeps. A [`Model`] is such a task with a trained policy.

mod classifiers;
mod confidence;
mod explain;
mod file;
pub mod graph;
pub mod kart;
mod learners;
mod model;
pub mod navigation;
pub mod ocr;
pub mod parsing;
pub mod platformer;
mod recipe;
pub mod segmenting;
pub mod tabular;
pub mod tagging;
mod training;
mod update;

pub(crate) use crate::output::Arrays;
pub use classifiers::AnyClassifier;
pub(crate) use confidence::Done;
#[cfg(feature = "cli")]
pub(crate) use explain::Share;
pub(crate) use explain::{Names, Reason};
pub(crate) use file::opened;
pub use file::sealed;
#[cfg(feature = "cli")]
pub(crate) use file::{MOST_UNITS, Parts, task_of};
pub use learners::AnyLearner;
pub use model::{About, Learned, Model};
pub use recipe::Recipe;
pub use training::{KeepsAll, Trainer};

use crate::error::{Error, Result};
use crate::read::conll::{Block, Line};
use crate::seed::Seed;
use crate::space::{Action, CostToGo, Features, Imitation, Silent, Space};
use crate::trainer::{Keeping, Run, Trained};
use serde::{Serialize, de::DeserializeOwned};
use std::io::{self, Write};
use std::path::Path;

/// What turns the text of a task into a space and the actions of a policy into text: learned from a corpus, kept in model files.
///
/// It is there to be used rather than to be implemented: what only the program and model files need of it is hidden, and may change with any version. A
/// space of one's own needs none of it ([`guide::spaces`](crate::guide::spaces)).
pub trait Task: Sized + Send + Sync {
    /// The task's name, in model files and on the command line.
    const NAME: &'static str;
    /// A corpus in memory.
    type Data: Data + Send;
    /// What the user chooses before learning.
    type Settings;
    /// Its sentences as episodes.
    type Space: Space<View = Features, State: Clone>;
    /// The one to be imitated.
    type Expert: CostToGo<Self::Space> + Clone;
    /// What is measured.
    type Score: Score;
    /// What a model file's header says of the task. It should refuse what it does not know.
    #[doc(hidden)]
    type Header: Serialize + DeserializeOwned;
    /// What is kept of the blocks of a stream to see that the next one goes with them.
    #[doc(hidden)]
    type Stream: Default + Send;

    /// What its corpora are made of.
    #[doc(hidden)]
    const UNITS: Units = Units { episode: "sentence", episodes: "sentences", steps: "tokens", loss: "wrong" };

    /// The corpus that is `text`, which comes from `path`.
    ///
    /// # Errors
    /// With the exact place, when it is none, or has no sentence.
    fn parse(text: &[u8], path: &Path) -> Result<Self::Data>;

    /// The corpus that is a block of `path`, or nothing when all its lines are blank.
    ///
    /// # Errors
    /// With the exact place, when it is none, or does not go with the blocks before it.
    #[doc(hidden)]
    fn parse_block(&self, block: &Block, path: &Path, stream: &mut Self::Stream) -> Result<Option<Self::Data>>;

    /// Learns features and actions from `data`, and gives it as a problem of imitation.
    ///
    /// # Errors
    /// When it is not what can be learned from with these settings.
    fn learn(data: &Self::Data, settings: Self::Settings) -> Result<(Self, ProblemOf<Self>)>;

    /// What [`Task::learn`] gives of other `data`, for those who know the actions and features of this encoding and go on learning: the encoding with
    /// more features, the problem, and for each feature the number that it has here, or `u32::MAX` if it is new. By default a task does not go on.
    ///
    /// # Errors
    /// As [`Task::learn`], and where there are actions that are not known here.
    #[doc(hidden)]
    fn extend(&self, data: &Self::Data) -> Result<(Self, ProblemOf<Self>, Vec<u32>)> {
        let _ = data;
        Err(Error::argument("task", Self::NAME, "tagging or parsing: the others' models do not go on learning"))
    }

    /// Trains policies for `problem` by `train`, which knows trainer and learner: one, unless the task needs more.
    ///
    /// # Errors
    /// Those of `train`.
    fn train(
        problem: &ProblemOf<Self>,
        run: &Run<'_, Keeping>,
        train: &Training<'_, Self>,
    ) -> Result<Trained<Learned>> {
        train(problem, run)
    }

    /// What `policy` does in all `episodes` of `space`, one after the other. They are part of a longer series, in which the first of them
    /// has the number `number`: what is drawn is what would be drawn if the whole series were run at once.
    fn perform(policy: &Learned, space: Self::Space, episodes: usize, number: usize, seed: Seed) -> Vec<Action> {
        let problem = Imitation { space, expert: Silent, episodes };
        policy.perform_from(&problem, number, seed).0.actions
    }

    /// Whether an action says something of a token, so that it can be told how sure it is.
    #[doc(hidden)]
    const CONFIDENT: bool = false;

    /// The temperatures of the classifiers of `policy`, found on these episodes of `problem`, from which it did not learn.
    fn calibrate(policy: &Learned, problem: &ProblemOf<Self>, episodes: &[usize], seed: Seed) -> Vec<f32> {
        policy.calibrate(problem, episodes, seed)
    }

    /// How sure `policy` was of what it did in all `episodes` of `space` by [`Task::perform`].
    #[doc(hidden)]
    fn sure(policy: &Learned, space: Self::Space, episodes: usize, done: Done<'_>) -> Vec<f32> {
        policy.sure_from(&Imitation { space, expert: Silent, episodes }, done)
    }

    /// Whether its features have names, so that it can be told why a policy did what it did.
    #[doc(hidden)]
    const NAMED: bool = false;

    /// What tells the names of the features that occur in `data`: models keep hashes only, and a text from which the names can be had again is mostly at
    /// hand. None are known unless [`Task::NAMED`].
    ///
    /// # Errors
    /// As [`Task::apply`].
    #[doc(hidden)]
    fn names(&self, data: &Self::Data) -> Result<Names<'_>> {
        let _ = data;
        Ok(Box::new(|_| None))
    }

    /// What an action says: a label, where actions are labels, else its number.
    #[doc(hidden)]
    fn label(&self, action: Action) -> String {
        action.0.to_string()
    }

    /// The features that show nothing but the one action before: that action, none at the start, and the feature's number.
    #[doc(hidden)]
    fn transitions(&self) -> Vec<(Option<Action>, u32)> {
        Vec::new()
    }

    /// Why `policy` did what it did in all `episodes` of `space` by [`Task::perform`]; `None` where that is no sum of weights ([`Learned::sums`]).
    #[doc(hidden)]
    fn reasons(policy: &Learned, space: Self::Space, episodes: usize, done: Done<'_>) -> Option<Vec<Reason>> {
        policy.reasons_from(&Imitation { space, expert: Silent, episodes }, done)
    }

    /// The words of sentence `i` of `data`, each with its line, in the order in which [`Task::answers`] tells of them; none where a text has no such thing.
    #[doc(hidden)]
    fn words<'a>(&self, data: &'a Self::Data, i: usize) -> Vec<(usize, &'a str)> {
        let _ = (data, i);
        Vec::new()
    }

    /// For each token of `data` the line it stands on and which of `actions` says what it is; nothing unless [`Task::CONFIDENT`].
    #[doc(hidden)]
    fn lines(&self, data: &Self::Data, actions: &[Action]) -> Vec<(usize, usize)> {
        let _ = (data, actions);
        Vec::new()
    }

    /// Which of `actions` are right, each as a whole; nothing unless [`Task::CONFIDENT`].
    ///
    /// # Errors
    /// As [`Task::check`].
    #[doc(hidden)]
    fn right(&self, data: &Self::Data, actions: &[Action]) -> Result<Vec<bool>> {
        let _ = (data, actions);
        Ok(Vec::new())
    }

    /// Another corpus as a space, of which no right answers are known.
    ///
    /// # Errors
    /// When something is missing in it that the features need.
    fn apply(&self, data: &Self::Data) -> Result<Self::Space>;

    /// Writes `block` again with what `actions`, those of all its episodes, say of `data`, its corpus if it is not blank.
    ///
    /// # Errors
    /// Those of `out`.
    #[doc(hidden)]
    fn write(&self, block: &Block, of: Option<(&Self::Data, &[Action])>, out: &mut impl Write) -> io::Result<()>;

    /// Refuses a corpus that cannot be measured on, for want of right answers or anything else.
    ///
    /// # Errors
    /// With the exact place.
    #[doc(hidden)]
    fn check(&self, data: &Self::Data) -> Result<()>;

    /// How `actions`, those of all episodes, compare with the right answers in `data`.
    ///
    /// # Errors
    /// As [`Task::check`].
    fn score(&self, data: &Self::Data, actions: &[Action]) -> Result<Self::Score>;

    /// What `policy` is worth, who took these `actions` in all episodes of `data`. By default that is their [`Task::score`]; where exact values can be
    /// computed from the policy itself, they are told, too.
    ///
    /// # Errors
    /// As [`Task::check`].
    fn judge(&self, policy: &Learned, data: &Self::Data, actions: &[Action]) -> Result<Self::Score> {
        let _ = policy;
        self.score(data, actions)
    }

    /// Tells for each word of `data` the right answer and the one that `actions`, those of all episodes, give: labels, relations, letters. Nothing where
    /// there is no single right answer.
    ///
    /// # Errors
    /// As [`Task::check`].
    #[doc(hidden)]
    fn answers(&self, data: &Self::Data, actions: &[Action], tell: &mut dyn FnMut(&str, &str)) -> Result<()> {
        let _ = (data, actions, tell);
        Ok(())
    }

    /// How many features there are.
    fn features(&self) -> usize;

    /// How many actions there are.
    fn actions(&self) -> usize;

    /// Forgets features that are not `used`, as far as it can, and numbers the others anew: feature i is the one that was the i-th of what
    /// is returned.
    ///
    /// # Errors
    /// When there are too many features to be numbered.
    #[doc(hidden)]
    fn keep(&mut self, used: &dyn Fn(u32) -> bool) -> Result<Vec<u32>>;

    /// What a model file's header says.
    #[doc(hidden)]
    fn header(&self) -> Self::Header;

    /// The arrays of a model file, in the order in which [`Task::restore`] takes them.
    #[doc(hidden)]
    fn arrays(&self) -> Vec<&[u64]>;

    /// The same again from a model file at `path`: untrusted input.
    ///
    /// # Errors
    /// What is wrong with header or arrays.
    #[doc(hidden)]
    fn restore(header: Self::Header, arrays: &mut Arrays<'_>, path: &Path) -> Result<Self, String>;

    /// What a person wants to know of it: one line each, a name and a fact, as text and as JSON.
    #[doc(hidden)]
    fn facts(&self) -> Vec<Fact>;
}

/// The problem of imitating a task's expert.
pub type ProblemOf<T> = Imitation<<T as Task>::Space, <T as Task>::Expert>;

/// What trains one policy.
pub type Training<'a, T> = dyn Fn(&ProblemOf<T>, &Run<'_, Keeping>) -> Result<Trained<Learned>> + 'a;

/// The words for what a task's corpora are made of, in reports.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Units {
    /// An episode.
    pub episode: &'static str,
    /// Several of them.
    pub episodes: &'static str,
    /// What [`Data::tokens`] counts.
    pub steps: &'static str,
    /// What [`Score::loss`] sums up.
    pub loss: &'static str,
}

/// Something to know of a task.
#[doc(hidden)]
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// What it is about.
    pub name: &'static str,
    /// As text: in a line behind its name, below it if it has lines of its own, or not at all if it is empty.
    pub text: String,
    /// As data.
    pub value: serde_json::Value,
}

/// A corpus as all tasks know it: sentences of words, or whatever the task has in their place ([`Units`]).
pub trait Data {
    /// Where it comes from.
    fn path(&self) -> &Path;
    /// How many sentences.
    fn sentences(&self) -> usize;
    /// How many words.
    fn tokens(&self) -> usize;
    /// Keeps the first `sentences` sentences.
    fn truncate(&mut self, sentences: usize);
    /// Keeps the first `sentences` sentences and gives the rest.
    fn split_off(&mut self, sentences: usize) -> Self;
}

/// What was measured: as data, all of it; as text, with a line's end.
pub trait Score: Serialize {
    /// For a person.
    fn text(&self) -> String;
    /// What is lost in all sentences: how many words are wrong, what all paths cost.
    fn loss(&self) -> f64;
    /// What the field measures, in percent, the most important one last.
    fn measures(&self) -> Vec<Measure>;
}

/// One measure of a [`Score`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// Its name in data.
    pub key: &'static str,
    /// Its name in tables.
    pub name: &'static str,
    /// In percent; none where it means nothing.
    pub percent: Option<f64>,
}

/// Writes the lines of `block` again, each whose number is next among `labels` with its label.
pub(crate) fn write_labels(
    block: &Block,
    labels: impl Iterator<Item = (usize, impl AsRef<str>)>,
    out: &mut impl Write,
) -> io::Result<()> {
    let mut labels = labels.peekable();
    for (line, number) in block.lines().zip(block.first_line..) {
        let label = labels.next_if(|(at, _)| *at == number);
        write_line(out, line, label.as_ref().map(|(_, label)| label.as_ref()))?;
    }
    Ok(())
}

/// Writes one line and, where there is one, a `label` behind a separator like that of the line.
fn write_line(out: &mut impl Write, Line { text, end }: Line<'_>, label: Option<&str>) -> io::Result<()> {
    out.write_all(text)?;
    if let Some(label) = label {
        out.write_all(if memchr::memchr(b'\t', text).is_some() { b"\t" } else { b" " })?;
        out.write_all(label.as_bytes())?;
    }
    out.write_all(end)?;
    if !end.ends_with(b"\n") {
        out.write_all(b"\n")?;
    }
    Ok(())
}
