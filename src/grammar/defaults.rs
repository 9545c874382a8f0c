//! The grammar and the corpora that come with the crate.
