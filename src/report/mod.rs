//! What people read: plain tables, numbers with separators.

mod table;

pub use table::{Table, grouped};
