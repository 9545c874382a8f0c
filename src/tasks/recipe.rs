//! From a corpus to a model in one call.

use super::{About, AnyLearner, Data, Model, Task, Trainer};
use crate::error::Result;
use crate::policy::Reading;
use crate::trainer::Run;
use serde::{Deserialize, Serialize};

/// What to train with: plain settings, which can be read from JSON. The defaults are those of `rollin train`.
///
/// ```
/// use rollin::prelude::*;
///
/// let corpus = Corpus::parse("the DT\ncat NN\n\nthe DT\ndog NN\nbarks VBZ\n")?;
/// let recipe = Recipe { trainer: Trainer::Smile(Smile::default()), ..Recipe::default() };
/// let tagger: Tagger = recipe.train(&corpus, tagging::Settings::default())?;
/// assert_eq!(tagger.label(&[["the"], ["dog"]])?, ["DT", "NN"]);
///
/// let same: Recipe = serde_json::from_str(r#"{"trainer": {"smile": {"rounds": 7}}}"#).unwrap();
/// assert_eq!(same, recipe);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Recipe {
    /// The trainer, which decides at which states the expert is asked.
    pub trainer: Trainer,
    /// What learns from the answers.
    pub learner: AnyLearner,
    /// How a mixture is read where the trainer makes one.
    pub reading: Reading,
    /// The number that all randomness starts from.
    pub seed: u64,
}

impl Default for Recipe {
    fn default() -> Self {
        Recipe { trainer: Trainer::default(), learner: AnyLearner::default(), reading: Reading::Mean, seed: 1 }
    }
}

impl Recipe {
    /// The model of a task that is learned from `data`.
    ///
    /// # Errors
    /// When `data` cannot be learned from with these `settings`, or a setting of trainer or learner is out of its range.
    pub fn train<T: Task>(&self, data: &T::Data, settings: T::Settings) -> Result<Model<T>> {
        let (encoding, problem) = T::learn(data, settings)?;
        let run = Run::new(self.seed).kept(None);
        let trained = T::train(&problem, &run, &|problem, run| self.trainer.train(problem, &self.learner, run))?;
        let about = About { ledger: trained.ledger, ..self.about(data) };
        Model::new(encoding, trained.policy.read_as(self.reading), about)
    }

    /// What a model that is trained by this on `data` says of itself; the bill is still to come.
    pub fn about(&self, data: &impl Data) -> About {
        About {
            trainer: json(&self.trainer),
            learner: if matches!(self.trainer, Trainer::EarlyUpdate(_)) { "none".into() } else { json(&self.learner) },
            seed: self.seed,
            data: data.path().display().to_string(),
            sentences: data.sentences(),
            tokens: data.tokens(),
            ..About::default()
        }
    }
}

/// Settings as text.
fn json(settings: &impl Serialize) -> String {
    serde_json::to_string(settings).unwrap_or_default()
}
