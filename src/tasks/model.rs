//! What training leaves behind: a policy, what turns text into its features, and how both came to be.

use super::{AnyClassifier, Data, Done, Task};
use crate::error::Result;
use crate::policy::{Classifier, Columns, Greedy, Ladder, Mixture, MixtureMemory, NeuralMemory, Policy, Reading};
use crate::roll::{self, Performance};
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Features, Problem, Space, StateOf};
use crate::trainer::{Beam, Stages, TwoStage};
use crate::worker::{Ledger, Visit};
use serde::{Deserialize, Serialize};

/// The policies that training can end with.
///
/// As a [`Policy`], step by step, a beam is one path wide, of two stages the first acts and of two readings the second, untold:
/// [`Learned::perform_from`] and [`Task::perform`] do it all.
#[derive(Clone, Debug)]
pub enum Learned {
    /// A mixture, or a single classifier.
    Mixture(Mixture<AnyClassifier>),
    /// One classifier per step.
    Ladder(Ladder<AnyClassifier>),
    /// A classifier that is searched with.
    Beam(Beam<AnyClassifier>),
    /// Two classifiers, of which the second sees what the first did.
    Stacked(Stages<AnyClassifier>),
    /// Two policies, of which the first reads from the end and the second, which is told, from the start.
    Readings {
        /// The first.
        first: Box<Learned>,
        /// The second.
        second: Box<Learned>,
    },
}

impl<C: Into<AnyClassifier>> From<Greedy<C>> for Learned {
    fn from(Greedy(classifier): Greedy<C>) -> Self {
        Learned::Mixture(Mixture::of_one(classifier.into()))
    }
}

impl<C: Into<AnyClassifier>> From<Mixture<C>> for Learned {
    fn from(mixture: Mixture<C>) -> Self {
        Learned::Mixture(mixture.map(Into::into))
    }
}

impl<C: Into<AnyClassifier>> From<Ladder<C>> for Learned {
    fn from(ladder: Ladder<C>) -> Self {
        Learned::Ladder(ladder.map(Into::into))
    }
}

impl<C: Into<AnyClassifier>> From<Beam<C>> for Learned {
    fn from(Beam { classifier, width }: Beam<C>) -> Self {
        Learned::Beam(Beam { classifier: classifier.into(), width })
    }
}

impl<C: Into<AnyClassifier>> From<Stages<C>> for Learned {
    fn from(TwoStage { first, second, window }: Stages<C>) -> Self {
        Learned::Stacked(TwoStage { first: Greedy(first.0.into()), second: Greedy(second.0.into()), window })
    }
}

impl Learned {
    /// Its classifiers.
    pub fn classifiers(&self) -> Vec<&AnyClassifier> {
        match self {
            Learned::Mixture(mixture) => mixture.members().iter().map(|(_, classifier)| classifier).collect(),
            Learned::Ladder(ladder) => ladder.steps().iter().collect(),
            Learned::Beam(beam) => vec![&beam.classifier],
            Learned::Stacked(stages) => vec![&stages.first.0, &stages.second.0],
            Learned::Readings { first, second } => [first.classifiers(), second.classifiers()].concat(),
        }
    }

    /// The same with every classifier replaced by what `change` makes of it.
    pub fn map(self, change: &mut dyn FnMut(AnyClassifier) -> AnyClassifier) -> Self {
        match self {
            Learned::Mixture(mixture) => Learned::Mixture(mixture.map(change)),
            Learned::Ladder(ladder) => Learned::Ladder(ladder.map(change)),
            Learned::Beam(Beam { classifier, width }) => Learned::Beam(Beam { classifier: change(classifier), width }),
            Learned::Stacked(TwoStage { first, second, window }) => {
                Learned::Stacked(TwoStage { first: Greedy(change(first.0)), second: Greedy(change(second.0)), window })
            }
            Learned::Readings { first, second } => {
                Learned::Readings { first: Box::new(first.map(change)), second: Box::new(second.map(change)) }
            }
        }
    }

    /// The same read as `reading`, where it is a mixture. A mixture that is read by its mean score becomes the one classifier that
    /// has the mean weights, where there is one.
    pub fn read_as(self, reading: Reading) -> Self {
        match self {
            Learned::Mixture(mixture) => {
                if let [(_, one)] = mixture.members()
                    && reading == Reading::Mean
                    && one.columns() == Columns::Actions
                {
                    // Its own mean.
                    return Learned::Mixture(mixture.read_as(Reading::default()));
                }
                if reading == Reading::Mean
                    && let Some(mean) = AnyClassifier::mean(mixture.members())
                {
                    return Learned::Mixture(Mixture::of_one(mean));
                }
                Learned::Mixture(mixture.read_as(reading))
            }
            Learned::Readings { first, second } => {
                Learned::Readings { first: Box::new(first.read_as(reading)), second: Box::new(second.read_as(reading)) }
            }
            other => other,
        }
    }

    /// What it does in the problem's episodes, a part of a longer series that starts with its episode number `first`.
    pub fn perform_from<P: Problem>(&self, problem: &P, first: usize, seed: Seed) -> (Performance, Ledger)
    where
        P::Space: Space<View = Features>,
        StateOf<P>: Clone,
    {
        match self {
            Learned::Beam(beam) => beam.perform_from(problem, first, seed),
            Learned::Stacked(stages) => stages.perform_from(problem, first, seed),
            steps => roll::perform_from(problem, steps, first, seed),
        }
    }
}

impl<P: Problem> Policy<P> for Learned
where
    P::Space: Space<View = Features>,
{
    type Memory = (MixtureMemory<NeuralMemory>, Vec<NeuralMemory>);

    #[inline]
    fn act(&self, visit: &mut Visit<'_, P>, memory: &mut Self::Memory) -> Action {
        match self {
            Learned::Mixture(mixture) => mixture.act(visit, &mut memory.0),
            Learned::Ladder(ladder) => ladder.act(visit, &mut memory.1),
            Learned::Beam(Beam { classifier: one, .. }) | Learned::Stacked(TwoStage { first: Greedy(one), .. }) => {
                memory.1.resize_with(1, Default::default);
                one.choose(&visit.sight(), &mut memory.1[0])
            }
            Learned::Readings { second, .. } => second.act(visit, memory),
        }
    }
}

/// How a model came to be.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct About {
    /// The trainer's name and settings.
    pub trainer: String,
    /// The learner's name and settings.
    pub learner: String,
    /// How the expert fell short, as on the command line; empty where it did not.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub expert: String,
    /// The number the seed was made from.
    pub seed: u64,
    /// What it was trained on: the path as it was given.
    pub data: String,
    /// Sentences in it.
    pub sentences: usize,
    /// Tokens in it.
    pub tokens: usize,
    /// The bill.
    pub ledger: Ledger,
    /// The round after which training was stopped, where that was before its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped: Option<usize>,
}

/// A trained model of a task: what turns text into features, and the policy.
#[derive(Clone, Debug)]
pub struct Model<T> {
    /// What turns text into features.
    pub encoding: T,
    /// The policy.
    pub policy: Learned,
    /// How it came to be.
    pub about: About,
    /// The temperatures of the policy's classifiers, by which their scores become probabilities; none if it was not calibrated.
    pub temperatures: Vec<f32>,
}

impl<T: Task> Model<T> {
    /// The model of `encoding` and `policy`. Features without weights are forgotten as far as the task can.
    ///
    /// # Errors
    /// When there are too many features to be numbered.
    pub fn new(mut encoding: T, policy: impl Into<Learned>, about: About) -> Result<Self> {
        let policy = policy.into();
        let classifiers = policy.classifiers();
        let before = encoding.features();
        let mut moved = encoding.keep(&|feature| classifiers.iter().any(|c| c.weights().row(feature).is_some()))?;
        // The features of a second stage stand behind the task's.
        let most = classifiers.iter().map(|c| c.weights().features()).max().unwrap_or(0);
        moved.extend(before as u32..most as u32);
        let (first, after) = (encoding.features(), moved);
        let policy = policy.map(&mut |classifier| {
            let more = classifier.weights().features() - before;
            classifier.map_weights(|weights| weights.renumber(&after[..first + more]))
        });
        Ok(Model { encoding, policy, about, temperatures: Vec::new() })
    }

    /// What the policy does in all `episodes` of `space`: see [`Task::perform`]. Only a mixture that is sampled draws from `seed`.
    pub fn perform(&self, space: T::Space, episodes: usize, first: usize, seed: Seed) -> Vec<Action> {
        T::perform(&self.policy, space, episodes, first, seed.child(Purpose::Evaluation, 0))
    }

    /// The same read as `reading`; it is not calibrated any more where that makes one classifier of several.
    pub fn read_as(mut self, reading: Reading) -> Self {
        self.policy = self.policy.read_as(reading);
        if self.temperatures.len() != self.policy.classifiers().len() {
            self.temperatures.clear();
        }
        self
    }

    /// How sure it was of `actions`, which is what [`Model::perform`] says it does in all `data`, a part of a longer text that starts with its sentence
    /// number `first`: the probability of each. `None` where it was not calibrated, or the task's actions say nothing of tokens.
    ///
    /// # Errors
    /// As [`Task::apply`].
    pub fn sure(&self, data: &T::Data, actions: &[Action], first: usize, seed: Seed) -> Result<Option<Vec<f32>>> {
        if !T::CONFIDENT || self.temperatures.is_empty() {
            return Ok(None);
        }
        let (seed, temperatures) = (seed.child(Purpose::Evaluation, 0), &self.temperatures[..]);
        let done = Done { actions, number: first, seed, temperatures };
        Ok(Some(T::sure(&self.policy, self.encoding.apply(data)?, data.sentences(), done)))
    }

    /// The columns of the classifiers: what they score.
    pub fn columns(&self) -> Columns {
        self.policy.classifiers().first().map_or(Columns::Actions, |c| c.columns())
    }
}
