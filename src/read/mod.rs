//! Readers of text, all written with nom: every error says path, line, column and what was expected.

pub mod attributes;
pub mod conll;
pub mod conllu;
pub mod crfsuite;
pub mod grammar;
pub mod graph;
pub mod grid;
pub(crate) mod input;
pub mod letters;
pub mod template;
pub mod track;
pub mod vw;
