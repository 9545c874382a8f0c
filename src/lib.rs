//! Structured prediction by learning to search: imitation learning treated as sequence labelling.

pub mod corpus;
pub mod error;
pub mod grammar;
pub mod read;
pub mod score;
pub mod seed;

pub use error::{Error, Place, Result};
pub use seed::{Purpose, Seed};
