//! Structured prediction by learning to search: imitation learning treated as sequence labelling.
//!
//! A learner makes a sequence of decisions, an expert can be asked what it would do, and training happens on the states that the
//! learner itself reaches. This crate implements *Efficient Reductions for Imitation Learning* (Ross & Bagnell 2010): supervised
//! imitation, forward training and SMILe, with SEARN, CPI, DAgger, AggreVaTe and LOLS beside them, on the same task, with the same learner, under the
//! same bill.
//!
//! ```
#![doc = include_str!("../examples/tagger.rs")]
//! ```
//!
//! # Five ideas
//!
//! 1. **A reset is a `Clone`.** A [`space`]'s state need not be cloneable. Supervised training, forward training, SMILe and DAgger only step
//!    forward and ask the expert; SEARN, CPI and LOLS roll out alternatives, and their signatures demand `State: Clone`. That SMILe needs no resets is a
//!    fact the compiler checks.
//! 2. **One bill.** Trainers never hold the space or the expert: they get a [`worker`] and, at each state, a
//!    [`Visit`](worker::Visit), whose methods count in a [`Ledger`](worker::Ledger). Predicted ledgers
//!    ([`theory::ledgers`]) stand beside measured ones.
//! 3. **Randomness is keyed, never shared.** Every draw hangs below a [`Seed`] that names what it is for (round, episode, step), never who draws it.
//!    Same seed, same bits, at any number of threads.
//! 4. **Static and dynamic features.** What a policy sees splits into a part that depends on the input only, computed once per corpus and
//!    scored once per position, and a part that depends on the decisions so far ([`space::Features`]). Spaces may give a state a
//!    [signature](space::Space::signature): equal signatures have equal futures, so roll-outs remember them, exactly.
//! 5. **Published and exact, side by side.** Where a published procedure is only approximately right, both it and the exact one are
//!    here under their names, and the difference is measured.
//!
//! And one rule: **the expert answers for the state at hand**, with the best action that is legal there, also after mistakes that it would never
//! have made itself ([`space::Expert`]).
//!
//! # Map
//!
//! A module uses only what stands above it.
//!
//! | module | what is in it |
//! |---|---|
//! | [`error`], [`seed`], `output` | errors with places; keyed randomness; files that are whole or not there |
//! | [`space`] | spaces, views, experts, problems; actions and features |
//! | [`worker`] | workers, visits, the ledger, sweeps over threads |
//! | [`policy`] | classifiers, mixtures, ladders |
//! | [`learner`] | 0-1 and cost-sensitive learners and the reductions between them |
//! | [`roll`] | roll-in, deviation, roll-out |
//! | [`trainer`] | one short file an algorithm, in the order of its listing |
//! | [`theory`] | what can be said beforehand |
//! | [`corpus`], [`read`], [`grammar`], [`score`] | corpora, readers, writers and templates, grammars with exact answers, measures |
//! | [`tasks`] | sequence tagging, segmentation, dependency parsing, graph labelling, navigation, a platform game, a kart, tabular problems; what a task is to the program, and model files |
//! | [`experiment`] | the paper's two experiments, on games, and replays of them |
//! | [`report`], `cli` | tables, figures, pages; the program |
//! | [`guide`] | chapters, from a [quick start](guide::start) over [the choice of a trainer](guide::choosing) to [what the theorems say](guide::theorems) and [what a token costs](guide::speed) |

#[cfg(feature = "cli")]
pub mod cli;
pub mod corpus;
pub mod error;
pub mod experiment;
pub mod grammar;
pub mod guide;
mod index;
pub mod learner;
mod ordered;
pub(crate) mod output;
pub mod policy;
pub mod prelude;
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

/// The README's Rust examples, run as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
