//! A platform game.

mod body;
pub mod features;
mod game;
mod level;
mod levels;
mod runner;
mod space;
mod things;
mod tiles;

pub use game::{End, FRAME_RATE, Game, WINDOW};
pub use level::{Level, Spawn};
pub use levels::{Difficulty, LEVELS, Levels};
pub use runner::{Buttons, Mode};
pub use space::{ACTIONS, HOLD, Outcome, Platformer, Playing, Settings};
pub use things::Kind;
pub use tiles::{COLUMNS, ROWS, SIDE, Tile};
