//! Sequence tagging: one label for every token of a sentence, left to right.
//!
//! [`Encoding::learn`] turns a corpus into a [`Tagging`] space, whose expert is [`Gold`]; a trainer makes a policy of it; a [`Tagger`] is
//! encoding and policy together, to be used, saved and loaded.

pub mod doc;
mod encoding;
mod names;
pub mod readings;
mod repair;
mod space;
mod tagger;
mod task;
mod transitions;

pub use encoding::{Dictionary, Encoding, LabelColumn, MOST_LABELS};
pub use repair::{Mended, illegal, repair};
pub use space::{Gold, HistoryLine, MAX_ORDER, Position, Tagging};
pub use tagger::Tagger;
pub(crate) use task::Header;
pub use task::{Columns, Settings};
pub use transitions::{Order, Transitions};

use crate::space::Imitation;

/// Tagging as a problem of imitation.
pub type TaggingProblem = Imitation<Tagging, Gold>;

impl Tagging {
    /// The problem of imitating [`Gold`] on all sentences.
    pub fn problem(self) -> TaggingProblem {
        let episodes = self.sentences();
        Imitation { space: self, expert: Gold, episodes }
    }
}
