//! Navigation: its expert against brute force and petgraph, maximum margin planning on maps where it should find everything, all
//! trainers, and what is refused.
//!
//! All random tests have fixed seeds: each either always passes or never does.

mod common;
mod experiment;
mod laws;
mod margin;
mod refusals;
