//! What a policy sees: 27,152 binary features, as footnote 4 of Ross & Bagnell (2010) lists them.
//!
//! | numbers | what they say |
//! |---|---|
//! | 6776 i + 14 (22 r + c) + k, i < 4 | i decisions ago there was something of class k in row r and column c of the image |
//! | 27104 + 8 j + b, j < 6 | j decisions ago, mark b was true |
//!
//! An image has 22 by 22 cells of a tile each. The runner's feet are in row 11 and column 11, both counted from 0, and cells outside the level are
//! empty. The classes k, from 0: ground (with hard and used blocks), ground that one can jump through from below, pipe, cannon, enemy without wings,
//! enemy with wings, spiky enemy, flower enemy, bullet, shell, fireball, block that can be broken (bricks, whatever is in them), item block, mushroom
//! or blossom. Hills below their tops and coins are not seen. The marks b, from 0: at the decision before, left, right, jump, speed was chosen;
//! the runner is on the ground, can jump, can throw fire, is large. What there was before the start of the level is empty.

use super::game::Game;
use super::runner::{Buttons, Mode};
use super::things::{Kind, Thing};
use super::tiles::{COLUMNS, ROWS, SIDE, Tile};

/// Rows and columns of an image.
pub const CELLS: usize = 22;

/// Classes of what can be in a cell.
pub const CLASSES: usize = 14;

/// Features of an image.
pub const IMAGE: usize = CELLS * CELLS * CLASSES;

/// How many images are seen: this decision's and those before.
pub const IMAGES: usize = 4;

/// For how many decisions marks are seen.
pub const STEPS: usize = 6;

/// How many marks a decision has.
pub const MARKS: usize = 8;

/// How many features there are.
pub const FEATURES: usize = IMAGES * IMAGE + STEPS * MARKS;

/// Cells to the left of the runner's, and above it.
const BEFORE: i32 = 11;

/// The class of what is not seen.
const NONE: u8 = CLASSES as u8;

impl Tile {
    /// What it is seen as.
    #[inline]
    fn class(self) -> u8 {
        match self {
            Tile::Ground | Tile::Hard | Tile::Used => 0,
            Tile::HillTop => 1,
            Tile::Pipe => 2,
            Tile::Barrel | Tile::Cannon => 3,
            Tile::Brick | Tile::CoinBrick | Tile::PowerBrick => 11,
            Tile::CoinBlock | Tile::PowerBlock => 12,
            Tile::Empty | Tile::Hill | Tile::Coin => NONE,
        }
    }
}

impl Thing {
    /// What it is seen as.
    #[inline]
    fn class(&self) -> u8 {
        match self.kind {
            Kind::Spiky => 6,
            kind if kind.walks() => 4 + u8::from(self.winged),
            Kind::Flower => 7,
            Kind::Bullet => 8,
            Kind::Shell => 9,
            Kind::Fireball => 10,
            _ => 13,
        }
    }
}

/// What was seen at the last decisions, the latest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Memory {
    /// The features of each image, ascending and below [`IMAGE`].
    images: [Vec<u16>; IMAGES],
    /// Bit b is mark b.
    marks: [u8; STEPS],
}

impl Memory {
    /// Remembers what is seen of `game` now, after `buttons` were chosen.
    pub fn see(&mut self, game: &Game, buttons: Buttons) {
        self.images.rotate_right(1);
        self.marks.rotate_right(1);
        image(game, &mut self.images[0]);
        let observed = [game.on_ground(), game.can_jump(), game.mode() == Mode::Fire, game.mode() != Mode::Small];
        let bits = observed.iter().enumerate().map(|(bit, there)| u8::from(*there) << (4 + bit));
        self.marks[0] = buttons.0 | bits.sum::<u8>();
    }

    /// Appends the numbers of all features that are there, ascending.
    pub fn list(&self, features: &mut Vec<u32>) {
        for (image, first) in self.images.iter().zip((0..).step_by(IMAGE)) {
            features.extend(image.iter().map(|feature| first + u32::from(*feature)));
        }
        for (marks, first) in self.marks.iter().zip(((IMAGES * IMAGE) as u32..).step_by(MARKS)) {
            features.extend((0..MARKS as u32).filter(|bit| marks >> bit & 1 == 1).map(|bit| first + bit));
        }
    }
}

/// The column or row in which `pixel` is, also outside the level.
fn cell(pixel: f32) -> i32 {
    (pixel / SIDE).floor() as i32
}

/// Writes the features of the image of `game`, ascending.
fn image(game: &Game, features: &mut Vec<u16>) {
    features.clear();
    let (left, top) = (cell(game.runner.body.x) - BEFORE, cell(game.runner.body.y) - BEFORE);
    let inside = |first: i32, size: usize| first.clamp(0, size as i32)..(first + CELLS as i32).clamp(0, size as i32);
    for column in inside(left, COLUMNS) {
        let tiles = &game.land.tiles[column as usize * ROWS..][..ROWS];
        for row in inside(top, ROWS) {
            let class = tiles[row as usize].class();
            if class != NONE {
                features.push(number(row - top, column - left, class));
            }
        }
    }
    for thing in game.things.iter().filter(|thing| thing.alive) {
        let (row, column) = (cell(thing.body.y) - top, cell(thing.body.x) - left);
        if (0..CELLS as i32).contains(&row) && (0..CELLS as i32).contains(&column) {
            features.push(number(row, column, thing.class()));
        }
    }
    features.sort_unstable();
    features.dedup();
}

#[inline]
fn number(row: i32, column: i32, class: u8) -> u16 {
    ((row * CELLS as i32 + column) * CLASSES as i32) as u16 + u16::from(class)
}
