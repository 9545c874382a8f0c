//! What most programs need, in one line.
//!
//! Three lines train a tagger and keep it, one tags:
//!
//! ```standalone_crate
//! use rollin::prelude::*;
//!
//! # let folder = tempfile::tempdir().unwrap();
//! # std::env::set_current_dir(&folder).unwrap();
//! # std::fs::write("train.txt", "the DT B-NP\npound NN I-NP\nfell VB B-VP\n").unwrap();
//! let corpus = Corpus::read("train.txt")?;
//! let tagger = Tagger::train(&corpus)?;
//! tagger.save("chunker.model")?;
//!
//! let labels = tagger.label(&[["the", "DT"], ["pound", "NN"]])?;
//! # assert_eq!(labels, ["B-NP", "I-NP"]);
//! # Ok::<(), rollin::Error>(())
//! ```
//!
//! For a space of one's own it has the traits to implement, and the trainers and learners to choose from: see [`guide::spaces`](crate::guide::spaces).

pub use crate::corpus::Corpus;
pub use crate::error::{Error, Result};
pub use crate::learner::{Csoaa, Logistic, Perceptron};
pub use crate::read::template::Template;
pub use crate::seed::{Purpose, Seed};
pub use crate::space::{
    Action, Actions, CostToGo, Dense, Episode, Expert, FeatureTable, Features, Imitation, NO_ROW, Problem, Space,
};
pub use crate::tasks::tagging::{self, Tagger};
pub use crate::tasks::{AnyLearner, Model, Recipe, Trainer};
pub use crate::trainer::{
    Aggrevate, Cpi, Dagger, EarlyUpdate, Forward, Lols, Run, Searn, Smile, Stacking, Supervised, Trained,
};
pub use crate::worker::Ledger;
