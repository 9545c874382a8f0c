//! Laws that every trainer, learner and policy obeys, on small random corpora and on cases worked by hand.
//!
//! All random tests have fixed seeds: each either always passes or never does. Where a test compares frequencies, the
//! bound it uses would fail for fewer than one seed in ten million unless it says otherwise.

mod arguments;
mod bills;
mod checkpoints;
mod common;
mod cutoffs;
mod experts;
mod files;
mod flaws;
mod learners;
mod mixtures;
mod nets;
mod ocr;
mod optima;
mod orders;
mod policies;
mod readings;
mod regrets;
mod rollouts;
mod search;
mod segmenting;
mod threads;
mod updates;
