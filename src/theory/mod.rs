//! What theory says beforehand.

pub mod ledgers;
