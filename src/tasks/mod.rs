//! The tasks: spaces with their experts and losses.

pub mod ocr;
pub mod tabular;
pub mod tagging;
