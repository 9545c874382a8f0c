//! Structured prediction by learning to search: imitation learning treated as sequence labelling.

#[cfg(feature = "cli")]
pub mod cli;
pub mod corpus;
pub mod error;
pub mod grammar;
pub mod learner;
pub mod output;
pub mod policy;
pub mod read;
pub mod report;
pub mod roll;
pub mod score;
pub mod seed;
pub mod space;
pub mod tasks;
pub mod theory;
pub mod trainer;
pub mod worker;

pub use error::{Error, Place, Result};
pub use seed::{Purpose, Seed};
