//! What is done in an experiment.

use crate::error::{Error, Result};
use crate::learner::{CrossValidated, Net};
use crate::trainer::{Dagger, Forward, Searn, Smile, Supervised};
use serde::{Deserialize, Serialize};

/// An experiment: methods, each trained `seeds` times, and how what they learn is measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// The game's name.
    pub game: String,
    /// The number that all randomness starts from.
    pub seed: u64,
    /// How often each method is trained, each time on games of their own. With one training, intervals are over the games that what was learned is measured
    /// on; with more, over the trainings.
    pub trainings: u64,
    /// Games of each grade on which a policy is measured: new ones for each training, the same for all methods and rounds.
    pub games: usize,
    /// The methods.
    pub methods: Vec<Method>,
}

/// A way to learn a game.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Method {
    /// Its name: one of its own in the plan, of letters, digits, dots and hyphens.
    pub name: String,
    /// Its trainer.
    pub teaching: Teaching,
    /// How much is played in a round.
    pub amount: Amount,
    /// Its learner.
    pub learner: CrossValidated<Net>,
}

/// How much is played in a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Amount {
    /// Episodes of each grade.
    pub episodes: usize,
    /// What an episode is.
    pub length: Length,
}

/// What an episode is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Length {
    /// One game.
    Game,
    /// Games one after the other, for so many decisions ([`Marathon`](crate::space::Marathon)).
    Marathon(usize),
    /// A game that is over after so many decisions.
    Short(usize),
}

/// A trainer with its settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Teaching {
    /// [`Supervised`].
    Supervised(Supervised),
    /// [`Forward`].
    Forward(Forward),
    /// [`Smile`].
    Smile(Smile),
    /// [`Searn`].
    Searn(Searn),
    /// [`Dagger`].
    Dagger(Dagger),
}

impl Teaching {
    /// How many classifiers are learned.
    pub fn rounds(&self) -> usize {
        match self {
            Teaching::Supervised(trainer) => trainer.rounds,
            Teaching::Forward(trainer) => trainer.longest,
            Teaching::Smile(trainer) => trainer.rounds,
            Teaching::Searn(trainer) => trainer.rounds,
            Teaching::Dagger(trainer) => trainer.rounds,
        }
    }

    /// The first round after which there is a policy to be measured: forward training has one only at its end.
    pub(super) fn first(&self) -> usize {
        if let Teaching::Forward(trainer) = self { trainer.longest } else { 1 }
    }

    /// Whether learning gets longer from round to round, the examples of all before being learned from again.
    pub(super) fn aggregates(&self) -> bool {
        matches!(self, Teaching::Supervised(_) | Teaching::Dagger(_))
    }
}

impl Plan {
    /// Refuses a plan that nobody can follow.
    ///
    /// # Errors
    /// When nothing is to be learned or measured, or names of methods are no names or stand twice.
    pub fn validate(&self) -> Result<()> {
        if self.trainings == 0 {
            return Err(Error::argument("trainings", 0, "at least 1"));
        }
        if self.games < 2 {
            return Err(Error::argument("games", self.games, "at least 2 of each grade"));
        }
        for (i, method) in self.methods.iter().enumerate() {
            let name = &method.name;
            let proper = |c: char| c.is_ascii_alphanumeric() || c == '.' || c == '-';
            if name.is_empty() || name.starts_with('.') || !name.chars().all(proper) {
                return Err(Error::argument("methods", name, "names of letters, digits, dots and hyphens"));
            }
            if self.methods[..i].iter().any(|other| other.name == *name) {
                return Err(Error::argument("methods", name, "names of which each stands once"));
            }
            if method.amount.episodes == 0 {
                return Err(Error::argument("episodes", 0, "at least 1"));
            }
        }
        if self.methods.is_empty() {
            return Err(Error::argument("methods", "none", "at least one"));
        }
        Ok(())
    }
}
