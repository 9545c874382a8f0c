//! What stands still: tiles of 16 by 16 pixels.

use super::level::Level;
use serde::{Deserialize, Serialize};

/// Columns of a level.
pub const COLUMNS: usize = 320;

/// Rows of a level, 0 at the top.
pub const ROWS: usize = 15;

/// Pixels to a tile's side.
pub const SIDE: f32 = 16.0;

/// One tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[repr(u8)]
pub enum Tile {
    /// Air.
    #[default]
    Empty,
    /// Solid ground, at the surface and below it.
    Ground,
    /// A hard block, as in stairs.
    Hard,
    /// A block whose content is gone: hard.
    Used,
    /// The top of a hill: blocks what falls, and nothing else.
    HillTop,
    /// A hill below its top: background.
    Hill,
    /// A part of a pipe.
    Pipe,
    /// The barrel of a cannon, from which bullets come.
    Barrel,
    /// A cannon below its barrel.
    Cannon,
    /// A brick with nothing in it.
    Brick,
    /// A brick with a coin in it; looks like any other.
    CoinBrick,
    /// A brick with a mushroom or a flower in it; looks like any other.
    PowerBrick,
    /// A question block with a coin in it.
    CoinBlock,
    /// A question block with a mushroom or a flower in it; looks like any other.
    PowerBlock,
    /// A coin in the air: counted, and of no other use.
    Coin,
}

impl Tile {
    /// Whether it blocks from all sides.
    #[inline]
    pub fn solid(self) -> bool {
        !matches!(self, Tile::Empty | Tile::HillTop | Tile::Hill | Tile::Coin)
    }

    /// Whether it blocks what falls.
    #[inline]
    pub fn carries(self) -> bool {
        !matches!(self, Tile::Empty | Tile::Hill | Tile::Coin)
    }

    /// In pictures of letters.
    pub fn letter(self) -> char {
        match self {
            Tile::Empty => ' ',
            Tile::Ground => '#',
            Tile::Hard | Tile::Used => 'X',
            Tile::HillTop => '=',
            Tile::Hill => ':',
            Tile::Pipe => '|',
            Tile::Barrel => '@',
            Tile::Cannon => 'I',
            Tile::Brick | Tile::CoinBrick | Tile::PowerBrick => '%',
            Tile::CoinBlock | Tile::PowerBlock => '?',
            Tile::Coin => 'o',
        }
    }
}

/// The place of column `column`, row `row` among a level's tiles. Beside, above and below the level its outermost tiles go on for ever, so that who
/// falls into a hole does not get out below the ground.
#[inline]
pub(super) fn spot(column: i32, row: i32) -> usize {
    column.clamp(0, COLUMNS as i32 - 1) as usize * ROWS + row.clamp(0, ROWS as i32 - 1) as usize
}

/// The column or row in which `pixel` is. The last pixel before the level counts as its first: it has the same tiles.
#[inline]
pub(super) fn cell(pixel: f32) -> i32 {
    (pixel as i32) >> 4
}

/// What of a level changes as it is played: its tiles, column by column, and which of those who start in it are gone for good. States share it
/// until one of them changes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Land {
    pub tiles: [Tile; COLUMNS * ROWS],
    pub gone: Vec<bool>,
}

impl Land {
    pub fn new(level: &Level) -> Self {
        Land { tiles: level.tiles, gone: vec![false; level.spawns.len()] }
    }

    #[inline]
    pub fn tile(&self, column: i32, row: i32) -> Tile {
        self.tiles[spot(column, row)]
    }
}
