//! The grammar that comes with the crate and the corpora it made, as text.
//!
//! `corpora/README.md` tells how they were made and what is known exactly about them.

/// The grammar of both corpora: `grammars/dialects.grammar`.
pub const GRAMMAR: &str = include_str!("../../grammars/dialects.grammar");

/// 2,000 sentences for training, made with seed 1: `corpora/train.txt`.
pub const TRAIN: &str = include_str!("../../corpora/train.txt");

/// 500 sentences for testing, made with seed 2: `corpora/test.txt`.
pub const TEST: &str = include_str!("../../corpora/test.txt");

/// How many sentences each corpus has, and the number of its seed: training, then test.
pub const MADE: [(usize, u64); 2] = [(2000, 1), (500, 2)];
