//! Dependency parsing: moves on a stack and a buffer, each arc followed by its label.
//!
//! [`Encoding::learn`] turns a treebank into a [`Parsing`] space, whose expert is [`GoldTree`]; a trainer makes a policy of it; a
//! [`Parser`] is encoding and policy together. Three [systems](System): two for projective trees, whose expert is exact in every
//! configuration, and one for all trees.
//!
//! ```
//! use rollin::learner::Logistic;
//! use rollin::read::conllu;
//! use rollin::tasks::{About, Task, parsing::{Encoding, Parser, Settings}};
//! use rollin::trainer::{Dagger, Run};
//!
//! let text = b"1\tthe\t_\tDET\t_\t_\t2\tdet\t_\t_\n2\tcat\t_\tNOUN\t_\t_\t3\tnsubj\t_\t_\n3\tsleeps\t_\tVERB\t_\t_\t0\troot\t_\t_\n\n";
//! let bank = conllu::parse(text, "cat".as_ref(), 1)?;
//! let (encoding, space) = Encoding::learn(&bank, &Settings { cutoff: 1, ..Settings::default() })?;
//! let trained = Dagger::default().train_online(&space.problem(), &Logistic::default(), &Run::new(1))?;
//! let parser = Parser::new(encoding, trained.policy, About::default())?;
//!
//! let space = parser.encoding.apply(&bank)?;
//! let actions = parser.perform(space, bank.sentences(), 0, rollin::Seed::new(1));
//! let heads: Vec<u32> = parser.encoding.arcs(&bank, &actions).iter().map(|(head, _)| *head).collect();
//! assert_eq!(heads, [2, 3, 0]);
//! assert_eq!(parser.encoding.score(&bank, &actions)?.all.las(), 1.0);
//! # Ok::<(), rollin::Error>(())
//! ```

mod encoding;
mod features;
mod oracle;
mod score;
mod space;
mod state;
mod tabular;
mod task;
mod tree;

pub use encoding::{Encoding, MOST_LABELS, Settings};
pub use oracle::GoldTree;
pub use score::{Attachment, Counts};
pub use space::Parsing;
pub use state::{Configuration, Move, System};
pub use task::Parser;

use crate::space::Imitation;

/// Parsing as a problem of imitation.
pub type ParsingProblem = Imitation<Parsing, GoldTree>;

impl Parsing {
    /// The problem of imitating [`GoldTree`] on all sentences.
    pub fn problem(self) -> ParsingProblem {
        let episodes = self.sentences();
        Imitation { space: self, expert: GoldTree, episodes }
    }
}

#[cfg(test)]
mod tests;
