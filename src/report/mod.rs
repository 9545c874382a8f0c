//! What people read: plain tables, numbers with separators, figures, and pages that hold all of it.
//!
//! A [`Plot`] or a [`Matrix`] draws itself as SVG, a [`Page`] puts figures, their numbers and where they come from into one HTML file that needs no
//! network. All positions, on linear and logarithmic axes alike, are computed here; the page's script only picks among them, so that
//! everything can be read without it.

mod markup;
mod matrix;
mod page;
mod plot;
mod scale;
mod table;

pub use markup::escaped;
pub use matrix::Matrix;
pub use page::{Fact, Figure, Page};
pub use plot::{Axis, Dot, Plot, Series, evenly};
pub use table::Table;
pub(crate) use table::grouped;
