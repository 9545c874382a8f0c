//! The platform game: its engine against measured tables, its levels against counts, what is seen, and how its expert does.
//!
//! All random tests have fixed seeds: each either always passes or never does.

mod common;
mod copies;
mod features;
mod levels;
mod motion;
mod planner;
mod things;
mod training;
