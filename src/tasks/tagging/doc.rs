//! A small corpus for the examples in this documentation.

use super::{Encoding, Settings, TaggingProblem};
use crate::corpus::Corpus;
use crate::error::Result;
use crate::read::conll;

/// Four sentences of two columns: words and their labels.
pub const CORPUS: &str = "the D\nold A\nman N\nsleeps V\n\nthe D\nold N\nman V\nthe D\nboats N\n\n\
                          a D\nman N\nboats V\n\nold A\nboats N\nsink V\n";

/// The corpus.
///
/// # Errors
/// None.
pub fn corpus() -> Result<Corpus> {
    conll::parse(CORPUS.as_bytes(), "corpus".as_ref(), 1)
}

/// Tagging it, with the default template.
///
/// # Errors
/// None.
pub fn problem() -> Result<TaggingProblem> {
    let (_, space) = Encoding::learn(&corpus()?, Settings::default())?;
    Ok(space.problem())
}
