//! A trained tagger.

use super::encoding::{Dictionary, Encoding};
use super::space::Tagging;
use crate::corpus::Corpus;
use crate::error::Result;
use crate::policy::{Classifier, Columns, Greedy, Ladder, Linear, Mixture, MixtureMemory, Policy, Reading};
use crate::roll::{self, Performance};
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Features, Imitation, Problem, Silent, Space, StateOf};
use crate::trainer::{Beam, Stages, TwoStage};
use crate::worker::{Ledger, Visit};
use serde::{Deserialize, Serialize};

/// The policies that training can end with.
///
/// As a [`Policy`], step by step, a beam is one path wide and of two stages the first acts: [`Learned::perform_from`] does it all.
#[derive(Clone, Debug)]
pub enum Learned {
    /// A mixture, or a single classifier.
    Mixture(Mixture<Linear>),
    /// One classifier per step.
    Ladder(Ladder<Linear>),
    /// A classifier that is searched with.
    Beam(Beam<Linear>),
    /// Two classifiers, of which the second sees what the first did.
    Stacked(Stages<Linear>),
}

impl From<Greedy<Linear>> for Learned {
    fn from(Greedy(classifier): Greedy<Linear>) -> Self {
        Learned::Mixture(Mixture::of_one(classifier))
    }
}

impl From<Mixture<Linear>> for Learned {
    fn from(mixture: Mixture<Linear>) -> Self {
        Learned::Mixture(mixture)
    }
}

impl From<Ladder<Linear>> for Learned {
    fn from(ladder: Ladder<Linear>) -> Self {
        Learned::Ladder(ladder)
    }
}

impl Learned {
    /// Its classifiers.
    pub fn classifiers(&self) -> Vec<&Linear> {
        match self {
            Learned::Mixture(mixture) => mixture.members().iter().map(|(_, classifier)| classifier).collect(),
            Learned::Ladder(ladder) => ladder.steps().iter().collect(),
            Learned::Beam(beam) => vec![&beam.classifier],
            Learned::Stacked(stages) => vec![&stages.first.0, &stages.second.0],
        }
    }

    /// The same with every classifier replaced by what `change` makes of it.
    pub fn map(self, mut change: impl FnMut(Linear) -> Linear) -> Self {
        match self {
            Learned::Mixture(mixture) => Learned::Mixture(mixture.map(change)),
            Learned::Ladder(ladder) => Learned::Ladder(ladder.map(change)),
            Learned::Beam(Beam { classifier, width }) => Learned::Beam(Beam { classifier: change(classifier), width }),
            Learned::Stacked(TwoStage { first, second, window }) => {
                Learned::Stacked(TwoStage { first: Greedy(change(first.0)), second: Greedy(change(second.0)), window })
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
                    && one.columns == Columns::Actions
                {
                    // Its own mean.
                    return Learned::Mixture(mixture.read_as(Reading::default()));
                }
                if reading == Reading::Mean
                    && let Some(mean) = Linear::mean(mixture.members())
                {
                    return Learned::Mixture(Mixture::of_one(mean));
                }
                Learned::Mixture(mixture.read_as(reading))
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
    type Memory =
        (MixtureMemory<<Linear as Classifier<Features>>::Memory>, Vec<<Linear as Classifier<Features>>::Memory>);

    #[inline]
    fn act(&self, visit: &mut Visit<'_, P>, memory: &mut Self::Memory) -> Action {
        match self {
            Learned::Mixture(mixture) => mixture.act(visit, &mut memory.0),
            Learned::Ladder(ladder) => ladder.act(visit, &mut memory.1),
            Learned::Beam(Beam { classifier: one, .. }) | Learned::Stacked(TwoStage { first: Greedy(one), .. }) => {
                memory.1.resize_with(1, Default::default);
                one.choose(&visit.sight(), &mut memory.1[0])
            }
        }
    }
}

/// How a tagger came to be.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct About {
    /// The trainer's name and settings.
    pub trainer: String,
    /// The learner's name and settings.
    pub learner: String,
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
}

/// A trained tagger: what turns words into features, and the policy.
#[derive(Clone, Debug)]
pub struct Tagger {
    /// What turns words into features.
    pub encoding: Encoding,
    /// The policy.
    pub policy: Learned,
    /// How it came to be.
    pub about: About,
}

impl Tagger {
    /// The tagger of `encoding` and `policy`. Static features without weights are forgotten.
    pub fn new(mut encoding: Encoding, policy: impl Into<Learned>, about: About) -> Result<Self> {
        let policy = policy.into();
        let before = encoding.features.len();
        let classifiers = policy.classifiers();
        let used = |feature: &u32| classifiers.iter().any(|c| c.weights.row(*feature).is_some());
        let kept: Vec<u32> = (0..before as u32).filter(used).collect();
        let keys = encoding.features.keys();
        encoding.features =
            Dictionary::of(kept.iter().map(|old| keys[*old as usize])).unwrap_or_else(|| encoding.features.clone());
        encoding.number_history()?;
        let features = encoding.features();
        // Dynamic features keep their order behind the static ones, and those of a second stage behind them.
        let dynamic = (features - encoding.features.len()) + before;
        let moved: Vec<u32> = kept.into_iter().chain(before as u32..dynamic as u32).collect();
        let policy = policy.map(|classifier| {
            let more = dynamic as u32..classifier.weights.features() as u32;
            let moved: Vec<u32> = moved.iter().copied().chain(more).collect();
            Linear { weights: classifier.weights.renumber(&moved), ..classifier }
        });
        Ok(Tagger { encoding, policy, about })
    }

    /// The labels of all tokens of `corpus`, as numbers into [`Encoding::labels`]. Only a mixture that is sampled draws from `seed`.
    ///
    /// # Errors
    /// When `corpus` lacks a column that the template needs.
    pub fn tag(&self, corpus: &Corpus, seed: Seed) -> Result<Vec<u32>> {
        self.tag_from(corpus, 0, seed)
    }

    /// The same for a part of a longer text: its first sentence has the number `first`, from 0. What is drawn is what would be drawn if
    /// the whole text were tagged at once.
    ///
    /// # Errors
    /// When `corpus` lacks a column that the template needs.
    pub fn tag_from(&self, corpus: &Corpus, first: usize, seed: Seed) -> Result<Vec<u32>> {
        Ok(self.tag_encoded(self.encoding.apply(corpus)?, first, seed))
    }

    /// The labels of all tokens of sentences that are encoded already, the first of which has the number `first`.
    pub fn tag_encoded(&self, space: Tagging, first: usize, seed: Seed) -> Vec<u32> {
        let episodes = space.sentences();
        let problem = Imitation { space, expert: Silent, episodes };
        let (done, _) = self.policy.perform_from(&problem, first, seed.child(Purpose::Evaluation, 0));
        done.actions.into_iter().map(|action| action.0).collect()
    }

    /// The columns of the classifiers: what they score.
    pub fn columns(&self) -> Columns {
        self.policy.classifiers().first().map_or(Columns::Actions, |c| c.columns)
    }
}
