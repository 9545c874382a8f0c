//! Navigation on explicit weighted directed graphs, and inverse optimal control as a learner.
//!
//! Graphs are handed in as petgraph's [`DiGraph`](petgraph::graph::DiGraph) of [`Site`]s and [`Road`]s and frozen to flat arrays. The expert
//! knows what edges cost and takes the cheapest way ([`Cheapest`]); learners see the edges' features only. A [`MaximumMargin`] learner finds costs at
//! which a planner does as the expert does, and its [`Planner`] goes by them on maps that it has never seen; the same space
//! [seen as](Navigation::seen_as) [`Features`](crate::space::Features) is open to every other learner.
//!
//! # As a task of the program
//! Maps are read as [`crate::read::grid`] does and seen as features by a [`Guide`]; what terrain costs, which only the expert knows, is a setting. Maximum margin
//! planning is not among the program's learners: its classifier sees the whole [`World`] and plans in it, while everything that models keep, from
//! learners over mixtures and beams to model files, is made for classifiers that see [`Features`](crate::space::Features). In the library every trainer runs with it.
//!
//! ```
//! use petgraph::graph::{DiGraph, NodeIndex};
//! use rollin::space::{Expert, Space, Action, Episode};
//! use rollin::tasks::navigation::{Cheapest, Legend, Navigation, Place, Road, Site, Trip, World};
//!
//! // A ford (feature 0) straight to the goal for 9, or a bridge (feature 1) by another node for 2 + 3.
//! let mut graph = DiGraph::new();
//! let [home, bank, goal] = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]].map(|at| graph.add_node(Site { at, features: vec![] }));
//! graph.add_edge(home, goal, Road { action: 0, cost: 9.0, features: vec![0] });
//! graph.add_edge(home, bank, Road { action: 1, cost: 2.0, features: vec![] });
//! graph.add_edge(bank, goal, Road { action: 0, cost: 3.0, features: vec![1] });
//! let trip = Trip { map: 0, start: home.index(), goal: goal.index(), horizon: 5 };
//! let world = World::new(Legend { actions: 2, roads: 2, sites: 0 }, &[graph], &[trip])?;
//! assert_eq!(world.optimum(0), 5.0);
//! let space = Navigation::<Place>::new(world);
//! let state = space.start(Episode { index: 0, seed: rollin::Seed::new(1) });
//! assert_eq!(Cheapest.action(&space, &state), Some(Action(1)));
//! # Ok::<(), rollin::Error>(())
//! ```

mod maps;
mod margin;
mod network;
mod plan;
mod space;
mod task;
mod world;

pub use maps::Maps;
pub use margin::{MaximumMargin, Planner};
pub(crate) use network::check_features;
pub use network::{Network, Road, Site};
pub use plan::Plan;
pub use space::{At, Cheapest, Eyes, Navigation, Place};
pub use task::{Atlas, Guide, Journeys, Traveller};
pub use world::{Legend, Trip, World};
