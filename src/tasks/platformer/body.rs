//! Moving through tiles, in the same way for all that do not fly through them.

use super::tiles::{Land, SIDE, cell};

/// Nobody moves further than this at once without looking for what is in the way, in pixels.
const STRIDE: f32 = 8.0;

/// Where a body is and how big it is, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Body {
    /// The middle.
    pub x: f32,
    /// The feet; the row below has the number after.
    pub y: f32,
    /// Half the width.
    pub half: f32,
    /// From the feet up.
    pub height: f32,
}

/// What stopped a body on its way to the side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// Nothing.
    Free,
    /// A tile at its head, its middle or its feet.
    Blocked,
    /// A wall at its head, its middle and its feet.
    Walled,
    /// The edge of a cliff, where it does not go on.
    Cliff,
}

/// What stopped a body on its way up or down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// Nothing.
    Free,
    /// What it stands on.
    Floor,
    /// The tile in this column and row above it.
    Ceiling(i32, i32),
}

impl Body {
    /// Moves by `dx` to the side, until something is in the way; with `careful`, also until its front would stand above nothing.
    pub fn walk(&mut self, land: &Land, dx: f32, careful: bool) -> Side {
        let mut left = dx;
        while left.abs() > STRIDE {
            let met = self.pace(land, STRIDE.copysign(dx), careful);
            if met != Side::Free {
                return met;
            }
            left -= STRIDE.copysign(dx);
        }
        if left == 0.0 { Side::Free } else { self.pace(land, left, careful) }
    }

    /// One stride of [`Body::walk`].
    #[inline]
    fn pace(&mut self, land: &Land, dx: f32, careful: bool) -> Side {
        let to = self.x + dx;
        let front = cell(to + self.half.copysign(dx));
        let (column, feet) = (cell(self.x), cell(self.y));
        // The tile that holds the feet never blocks.
        let wall = |row: i32| land.tile(front, row).solid() && (front, row) != (column, feet);
        let walls = [self.height, 0.5 * self.height, 0.0].map(|up| wall(cell(self.y - up)));
        if walls == [false; 3] {
            if careful && !land.tile(front, feet + 1).carries() {
                return Side::Cliff;
            }
            self.x = to;
            return Side::Free;
        }
        // Up to the tile, but never further than without it.
        if dx > 0.0 {
            let edge = (cell(self.x + self.half) + 1) as f32 * SIDE;
            self.x = (edge - self.half - 1.0).min(to);
        } else {
            let edge = cell(self.x - self.half) as f32 * SIDE;
            self.x = (edge + self.half).max(to);
        }
        if walls == [true; 3] { Side::Walled } else { Side::Blocked }
    }

    /// Moves by `dy` down (up, if it is negative), until something is in the way.
    pub fn fall(&mut self, land: &Land, dy: f32) -> Stop {
        let mut left = dy;
        while left.abs() > STRIDE {
            let met = self.drop(land, STRIDE.copysign(dy));
            if met != Stop::Free {
                return met;
            }
            left -= STRIDE.copysign(dy);
        }
        if left == 0.0 { Stop::Free } else { self.drop(land, left) }
    }

    /// One stride of [`Body::fall`].
    #[inline]
    fn drop(&mut self, land: &Land, dy: f32) -> Stop {
        let to = self.y + dy;
        let (column, feet) = (cell(self.x), cell(self.y));
        let sides = [cell(self.x - self.half), cell(self.x + self.half)];
        if dy < 0.0 {
            let row = cell(to - self.height);
            let blocks = |c: &i32| land.tile(*c, row).solid() && (*c, row) != (column, feet);
            if let Some(hit) = [column, sides[0], sides[1]].into_iter().find(blocks) {
                self.y = cell(self.y - self.height) as f32 * SIDE + self.height;
                return Stop::Ceiling(hit, row);
            }
        } else {
            let (row, under) = (cell(to), cell(to + 1.0));
            let blocks = |c: i32| {
                (land.tile(c, row).solid() && (c, row) != (column, feet))
                    || (land.tile(c, under).carries() && (c, under) != (column, feet))
            };
            if blocks(sides[0]) || blocks(sides[1]) {
                self.y = (cell(self.y - 1.0) + 1) as f32 * SIDE - 1.0;
                return Stop::Floor;
            }
        }
        self.y = to;
        Stop::Free
    }
}
