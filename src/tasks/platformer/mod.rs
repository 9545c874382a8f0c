//! A platform game, and the planner that plays it: the second experiment of Ross & Bagnell (2010, section 5).
//!
//! The engine is this crate's own, written from the measured rules of the simulator that the paper used (Togelius & Karakovskiy 2009). It is exact:
//! the same level and the same buttons are the same game to the last bit, and a copy goes on as the original does. One runs and jumps to the
//! right through a level of 320 by 15 tiles that a [`grammar of zones`](Levels) draws, 24 frames a second, over holes and past enemies. A
//! decision is which of four [`Buttons`] to hold for four frames; what is seen of a state is told in [`features`], and the
//! expert is a [`Planner`] that tries out what its moves lead to.
//!
//! ```
//! use rollin::Seed;
//! use rollin::space::{Episode, Expert, Space};
//! use rollin::tasks::platformer::{Buttons, Levels, Planner, Platformer, Scene, Settings};
//!
//! let space = Platformer::new(Levels::standard()?, Settings::default())?;
//! // Episode 3 is played at difficulty 3.
//! let episode = Episode { index: 3, seed: Seed::new(1) };
//! let mut state = space.start(episode);
//! while !space.legal(&state).is_empty() {
//!     let Some(action) = Planner.action(&space, &state) else { break };
//!     space.step(&mut state, action, episode.seed);
//! }
//! assert!(state.outcome().won(), "{:?}", state.outcome());
//! // To watch it: every frame of a decision.
//! let mut film = Vec::new();
//! space.start(episode).act(Buttons::RIGHT, |game| film.push(Scene::of(game)));
//! assert_eq!(film.len(), 4);
//! # Ok::<(), rollin::Error>(())
//! ```

mod body;
pub mod features;
mod game;
mod level;
mod levels;
pub mod planner;
mod runner;
mod scene;
mod space;
mod things;
mod tiles;

pub use game::{End, FRAME_RATE, Game, WINDOW};
pub use level::{Level, Spawn};
pub use levels::{Difficulty, LEVELS, Levels};
pub use planner::{Plan, Planner};
pub use runner::{Buttons, Mode};
pub use scene::{Figure, Scene};
pub use space::{ACTIONS, HOLD, Outcome, Platformer, Playing, Settings};
pub use things::Kind;
pub use tiles::{COLUMNS, ROWS, SIDE, Tile};
