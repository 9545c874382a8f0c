//! A level, as it is before it is played.

use super::things::Kind;
use super::tiles::{COLUMNS, ROWS, SIDE, Tile, spot};
use std::fmt;

/// Who starts where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spawn {
    /// The column; for a flower the left one of its pipe.
    pub column: u16,
    /// The row; for a flower that of its pipe's top.
    pub row: u8,
    /// Who.
    pub kind: Kind,
    /// Whether it has wings.
    pub winged: bool,
}

impl Spawn {
    /// Where its feet start, in pixels.
    pub(super) fn place(self) -> (f32, f32) {
        let (x, y) = (f32::from(self.column) * SIDE, f32::from(self.row) * SIDE);
        if self.kind == Kind::Flower { (x + SIDE, y + 24.0) } else { (x + 0.5 * SIDE, y + SIDE - 1.0) }
    }
}

/// A level of 320 by 15 tiles.
#[derive(Clone, PartialEq, Eq)]
pub struct Level {
    pub(super) tiles: [Tile; COLUMNS * ROWS],
    pub(super) spawns: Vec<Spawn>,
    /// `starts[c]..starts[c + 1]`: the spawns of column c.
    starts: Vec<u16>,
    /// The column in which the exit is.
    exit: u16,
}

impl Level {
    /// A level of nothing but air, whose exit is at the left edge of `column`.
    pub fn empty(column: usize) -> Self {
        Level {
            tiles: [Tile::Empty; COLUMNS * ROWS],
            spawns: Vec::new(),
            starts: vec![0; COLUMNS + 1],
            exit: column.min(COLUMNS) as u16,
        }
    }

    /// The tile in `column` and `row`; outside the level that of its edge.
    pub fn tile(&self, column: usize, row: usize) -> Tile {
        self.tiles[spot(column.min(COLUMNS) as i32, row.min(ROWS) as i32)]
    }

    /// Puts `tile` in `column` and `row`; nothing happens outside the level.
    pub fn set(&mut self, column: usize, row: usize, tile: Tile) {
        if column < COLUMNS && row < ROWS {
            self.tiles[spot(column as i32, row as i32)] = tile;
        }
    }

    /// Lets `spawn` start here, after all that start in its column; nothing happens outside the level, or where a column has had 60 already.
    pub fn add(&mut self, spawn: Spawn) {
        let column = usize::from(spawn.column);
        if column >= COLUMNS || usize::from(spawn.row) >= ROWS || self.starts[column + 1] - self.starts[column] >= 60 {
            return;
        }
        self.spawns.insert(usize::from(self.starts[column + 1]), spawn);
        self.starts[column + 1..].iter_mut().for_each(|start| *start += 1);
    }

    /// Who starts here, from left to right.
    pub fn spawns(&self) -> &[Spawn] {
        &self.spawns
    }

    /// The numbers of those who start in `column`.
    pub(super) fn spawns_in(&self, column: i32) -> std::ops::Range<usize> {
        let Some(column) = usize::try_from(column).ok().filter(|column| *column < COLUMNS) else { return 0..0 };
        usize::from(self.starts[column])..usize::from(self.starts[column + 1])
    }

    /// The row of the topmost barrel in `column`.
    pub(super) fn barrel(&self, column: i32) -> Option<usize> {
        let column = usize::try_from(column).ok().filter(|column| *column < COLUMNS)?;
        self.tiles[column * ROWS..][..ROWS].iter().position(|tile| *tile == Tile::Barrel)
    }

    /// Moves the exit to the left edge of `column`.
    pub(super) fn leave(&mut self, column: usize) {
        self.exit = column.min(COLUMNS) as u16;
    }

    /// Where it is finished: pixels from the left that the runner's middle has to exceed.
    pub fn exit(&self) -> f32 {
        f32::from(self.exit) * SIDE
    }
}

/// As a picture: a line for each row, a character for each tile, and one for who starts there.
impl fmt::Display for Level {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for row in 0..ROWS {
            let line = (0..COLUMNS).map(|column| {
                let mut starts = self.spawns_in(column as i32).map(|i| self.spawns[i]);
                let who = starts.rfind(|spawn| usize::from(spawn.row) == row);
                who.map_or(self.tile(column, row).letter(), |spawn| spawn.kind.letter(spawn.winged))
            });
            writeln!(out, "{}", line.collect::<String>().trim_end())?;
        }
        Ok(())
    }
}

impl fmt::Debug for Level {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "Level with exit {}\n{self}", self.exit)
    }
}
