//! What there is to draw of a game.

use super::game::{End, Game};
use super::runner::Mode;
use super::things::Kind;
use super::tiles::{COLUMNS, ROWS, Tile};
use serde::{Deserialize, Serialize};

/// All that can be drawn of a moment of a game, but for the tiles that are as they were in the [`Level`](super::Level). Pixels are counted from the
/// left and the top of the level.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// How many frames have passed.
    pub frame: u32,
    /// The left edge of the window of 320 by 240 pixels, whose top is the level's.
    pub camera: f32,
    /// Where the middle of the runner's feet is.
    pub at: [f32; 2],
    /// -1 where the runner faces left, 1 right.
    pub facing: i8,
    /// What the runner can bear, which is also how high it is.
    pub mode: Mode,
    /// Whether nothing hurts the runner for now.
    pub safe: bool,
    /// How the game ended, if it has.
    pub end: Option<End>,
    /// What else moves; flowers are drawn behind pipes, and items that come out behind blocks.
    pub things: Vec<Figure>,
    /// Tiles that are no longer those of the level: column, row, what is there now.
    pub changed: Vec<(u16, u8, Tile)>,
}

/// A thing that moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// What it is.
    pub kind: Kind,
    /// Where the middle of its feet is, in pixels.
    pub at: [f32; 2],
    /// Its height in pixels.
    pub height: f32,
    /// -1 where it faces left, 1 right; 0 for a shell that rests.
    pub facing: i8,
    /// Whether it has wings.
    pub winged: bool,
}

impl Scene {
    /// The moment at which `game` is.
    pub fn of(game: &Game) -> Self {
        let things = game.things.iter().filter(|thing| thing.alive);
        let figure = |thing: &super::things::Thing| Figure {
            kind: thing.kind,
            at: [thing.body.x, thing.body.y],
            height: thing.body.height,
            facing: thing.facing,
            winged: thing.winged,
        };
        let spots = (0..COLUMNS * ROWS).filter(|spot| game.land.tiles[*spot] != game.level.tiles[*spot]);
        Scene {
            frame: game.frames(),
            camera: game.camera,
            at: game.position(),
            facing: game.runner.facing,
            mode: game.mode(),
            safe: game.runner.safe > 0,
            end: game.end(),
            things: things.map(figure).collect(),
            changed: spots.map(|spot| ((spot / ROWS) as u16, (spot % ROWS) as u8, game.land.tiles[spot])).collect(),
        }
    }
}
