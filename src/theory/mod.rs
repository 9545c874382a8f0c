//! What theory says: exact values of small problems, every bound of Ross & Bagnell (2010), and bills in advance.
//!
//! Exact values are those of a tabular problem, an [`Mdp`], under policies that are tables of probabilities
//! ([`Table`]). Steps are indexed from 0: row t of an array `d[t,s]` is the paper's step t+1. Rounds n keep the paper's
//! numbers: index 0 is the expert where a sequence starts with the expert, and the first round where it starts with the
//! first round; every field says which.
//!
//! - [`evaluate()`]: J, d, Q by dynamic programming; [`korder`]: the k-th order quantities of Section 4, for all k in
//!   polynomial time
//! - [`forward`], [`mixing`]: forward training, SMILe and SEARN with given classifiers; [`population`]: with the best
//!   ones of a class
//! - [`bounds`]: one function a theorem, each a [`Bound`](bounds::Bound) with left side, right side and slack
//! - [`reuse`]: the exact laws of the data sets of Algorithms 4.2 and 4.3, as printed and repaired
//! - [`counts`], [`ledgers`]: expected expert queries, of the paper's conventions and of this crate's trainers
//! - [`instances`]: hard instances with closed forms; [`instance`]: instances from JSON; [`audit`]: all of it at once

mod evaluate;
mod mdp;
mod table;

pub mod audit;
pub mod bounds;
pub mod closed;
pub mod counts;
pub mod forward;
pub mod instance;
pub mod instances;
pub mod korder;
pub mod ledgers;
pub mod mixing;
pub mod population;
pub mod reuse;

pub use evaluate::{Evaluation, evaluate};
pub use mdp::{LONGEST, Mdp, Parts};
pub use table::{Schedule, Table};
