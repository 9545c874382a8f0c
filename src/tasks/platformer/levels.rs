//! Levels drawn from a grammar of zones.

use super::level::{Level, Spawn};
use super::things::Kind;
use super::tiles::{COLUMNS, ROWS, Tile};
use crate::error::{Error, Result};
use crate::grammar::Grammar;
use crate::read::grammar::{Item, Name, Tree};
use crate::read::input;
use crate::seed::{Purpose, Seed};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::Path;

/// The grammar of the levels that come with the crate: `grammars/platformer.levels`.
pub const LEVELS: &str = include_str!("../../../grammars/platformer.levels");

/// How hard a level is, from 0 to 10.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "u8", into = "u8")]
pub struct Difficulty(u8);

impl Difficulty {
    /// All, the easiest first.
    pub const ALL: [Difficulty; 11] = {
        let mut all = [Difficulty(0); 11];
        let mut d = 1;
        while d < all.len() {
            all[d] = Difficulty(d as u8);
            d += 1;
        }
        all
    };

    /// Difficulty `d`.
    ///
    /// # Errors
    /// When it is not from 0 to 10.
    pub fn new(d: u8) -> Result<Self> {
        Self::ALL.get(usize::from(d)).copied().ok_or_else(|| Error::argument("difficulty", d, "from 0 to 10"))
    }
}

impl TryFrom<u8> for Difficulty {
    type Error = Error;
    fn try_from(d: u8) -> Result<Self> {
        Difficulty::new(d)
    }
}

impl From<Difficulty> for u8 {
    fn from(Difficulty(d): Difficulty) -> u8 {
        d
    }
}

/// Zones are drawn until this column is reached.
const ENOUGH: usize = COLUMNS - 64;

/// The terminals of a grammar of levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Zone {
    Straight,
    Hills,
    Pipes,
    Gap,
    Cannons,
}

/// Zones by name.
const ZONES: [(&str, Zone); 5] = [
    ("straight", Zone::Straight),
    ("hills", Zone::Hills),
    ("pipes", Zone::Pipes),
    ("gap", Zone::Gap),
    ("cannons", Zone::Cannons),
];

impl Zone {
    fn named(name: &str) -> Option<Zone> {
        ZONES.iter().find(|(other, _)| *other == name).map(|(_, zone)| *zone)
    }
}

/// Levels of every difficulty, as a grammar describes them.
///
/// ```
/// use rollin::Seed;
/// use rollin::tasks::platformer::{Difficulty, Levels};
///
/// let levels = Levels::standard()?;
/// let level = levels.draw(Difficulty::new(5)?, Seed::new(1));
/// assert!((4224.0..=4512.0).contains(&level.exit()));
/// // Nothing but holes, at every difficulty.
/// let holes = Levels::parse("<example>", "start All; All -> gap end;")?.draw(Difficulty::default(), Seed::new(1));
/// assert!(holes.spawns().is_empty());
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Levels {
    /// `grammars[d]`, with the zone of each of its words.
    grammars: Vec<(Grammar, Vec<Zone>)>,
}

impl Levels {
    /// The levels that come with the crate.
    ///
    /// # Errors
    /// None; they are read like any others.
    pub fn standard() -> Result<Self> {
        Levels::parse("grammars/platformer.levels", LEVELS)
    }

    /// The levels described in the file `path`.
    ///
    /// # Errors
    /// If the file cannot be read or is not UTF-8, else as [`Levels::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Levels::parse(input::name(path), &input::text(path)?)
    }

    /// The levels described by `text`, which came from `path`.
    ///
    /// # Errors
    /// [`Error::Data`] with the place, where it is not a [`grammar`](crate::read::grammar) at every difficulty, or where a word is no zone.
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self> {
        let at = |difficulty| {
            let tree = Tree::parse_at(&path, text, f64::from(u8::from(difficulty)))?;
            check(&tree)?;
            let grammar = Grammar::compile(&tree)?;
            let zones = grammar.words().iter().filter_map(|word| Zone::named(word)).collect();
            Ok((grammar, zones))
        };
        Ok(Levels { grammars: Difficulty::ALL.map(at).into_iter().collect::<Result<_>>()? })
    }

    /// The level that belongs to `seed`, at `difficulty`.
    pub fn draw(&self, Difficulty(difficulty): Difficulty, seed: Seed) -> Level {
        let (grammar, zones) = &self.grammars[usize::from(difficulty)];
        let mut builder = Builder {
            level: Level::empty(0),
            rng: seed.child(Purpose::Episode, 0).rng(),
            difficulty: u32::from(difficulty),
            column: 0,
        };
        let safe = 10 + builder.below(5);
        builder.flat(safe);
        for passage in 0.. {
            for word in grammar.sentence(seed.child(Purpose::Sentence, passage)).words {
                if builder.column < ENOUGH {
                    builder.zone(zones[word.0 as usize]);
                }
            }
            if builder.column >= ENOUGH {
                break;
            }
        }
        builder.level.leave(builder.column + 8);
        builder.flat(COLUMNS);
        builder.level
    }
}

/// Refuses words that are no zones.
fn check(tree: &Tree) -> Result<()> {
    let of_lists = tree.lists.iter().flat_map(|list| &list.items);
    let of_rules = tree.rules.iter().flat_map(|rule| &rule.arms).flat_map(|arm| &arm.item.words);
    let unknown = |item: &Item| match item {
        Item::Word(word) if Zone::named(&word.text).is_none() => Some(word.clone()),
        _ => None,
    };
    match of_lists.chain(of_rules).find_map(|choice| unknown(&choice.item)) {
        None => Ok(()),
        Some(Name { text, offset }) => {
            let names = ZONES.map(|(name, _)| name).join(", ");
            Err(Error::data(tree.place(offset), format!("`{text}` is no zone"), format!("one of {names}")))
        }
    }
}

/// A level up to some column.
struct Builder {
    level: Level,
    rng: ChaCha8Rng,
    difficulty: u32,
    column: usize,
}

impl Builder {
    /// 0 to n - 1, each with the same chance.
    fn below(&mut self, n: usize) -> usize {
        self.rng.random_range(0..n)
    }

    /// True with probability `part` of `whole`; always, where it is more.
    fn chance(&mut self, part: u32, whole: u32) -> bool {
        self.rng.random_range(0..whole) < part
    }

    /// The row at which a zone's ground begins: it is one to four tiles thick.
    fn floor(&mut self) -> usize {
        ROWS - 1 - self.below(4)
    }

    /// Fills `rows` of `columns` with `tile`.
    fn fill(&mut self, columns: Range<usize>, rows: Range<usize>, tile: Tile) {
        for column in columns {
            rows.clone().for_each(|row| self.level.set(column, row, tile));
        }
    }

    /// A hill behind all that is there.
    fn hill(&mut self, columns: Range<usize>, top: usize, floor: usize) {
        for column in columns {
            for row in top..floor {
                if self.level.tile(column, row) == Tile::Empty {
                    self.level.set(column, row, if row == top { Tile::HillTop } else { Tile::Hill });
                }
            }
        }
    }

    /// Ground of `length` columns, or as far as the level goes. Returns its first column and its top row.
    fn flat(&mut self, length: usize) -> (usize, usize) {
        let (from, floor) = (self.column, self.floor());
        self.column = (from + length).min(COLUMNS);
        self.fill(from..self.column, floor..ROWS, Tile::Ground);
        (from, floor)
    }

    fn zone(&mut self, zone: Zone) {
        match zone {
            Zone::Straight => self.straight(),
            Zone::Hills => self.hills(),
            Zone::Pipes => self.pipes(),
            Zone::Gap => self.gap(),
            Zone::Cannons => self.cannons(),
        }
    }

    fn straight(&mut self) {
        let length = 2 + self.below(10);
        let (from, floor) = self.flat(length);
        if length > 5 {
            self.decorate(from, self.column, floor);
        }
    }

    /// Platforms above one another, each two to four rows higher, until one would stand on the sides of another or the sky is reached.
    fn hills(&mut self) {
        let length = 10 + self.below(10);
        let (from, floor) = self.flat(length);
        self.enemies(from + 1..self.column.saturating_sub(1), floor);
        let mut sides = [false; 24];
        let mut top = floor;
        loop {
            let (rise, wide) = (2 + self.below(3), 3 + self.below(5));
            if top <= rise {
                return;
            }
            top -= rise;
            let left = 1 + self.below(length - wide - 2);
            let right = left + wide;
            if [left - 1, left, right, right + 1].iter().any(|side| sides[*side]) {
                return;
            }
            (sides[left], sides[right]) = (true, true);
            let columns = from + left..from + right;
            self.hill(columns.clone(), top, floor);
            self.enemies(columns.clone(), top);
            if self.chance(1, 4) {
                self.decorate(columns.start - 1, columns.end + 1, top);
                return;
            }
        }
    }

    fn pipes(&mut self) {
        let length = 5 + self.below(10);
        let (from, floor) = self.flat(length);
        let mut pipe = from + 1 + self.below(4);
        while pipe + 2 < from + length {
            let top = floor - 2 - self.below(2);
            self.fill(pipe..pipe + 2, top..floor, Tile::Pipe);
            if self.chance(self.difficulty + 1, 11) {
                self.spawn(pipe, top, Kind::Flower, false);
            }
            pipe += 3 + self.below(4);
        }
    }

    /// A hole, with stairs up to it from both sides or without.
    fn gap(&mut self) {
        let (side, hole) = (2 + self.below(4), 2 + self.below(2));
        let stairs = self.chance(1, 3);
        let (from, floor) = self.flat(2 * side + hole);
        self.fill(from + side..from + side + hole, floor..ROWS, Tile::Empty);
        for step in (2..side).filter(|_| stairs) {
            let rows = floor + 1 - step..floor;
            self.fill(from + step..from + step + 1, rows.clone(), Tile::Hard);
            let other = from + 2 * side + hole - 1 - step;
            self.fill(other..other + 1, rows, Tile::Hard);
        }
    }

    fn cannons(&mut self) {
        let length = 2 + self.below(10);
        let (from, floor) = self.flat(length);
        let mut cannon = from + 1 + self.below(4);
        while cannon + 1 < from + length {
            let top = floor - 1 - self.below(4);
            self.fill(cannon..cannon + 1, top..floor, Tile::Cannon);
            self.level.set(cannon, top, Tile::Barrel);
            cannon += 2 + self.below(4);
        }
    }

    /// Enemies on the ground at row `floor`, coins above them and blocks above those, from column `from` to before column `to`.
    fn decorate(&mut self, from: usize, to: usize, floor: usize) {
        self.enemies(from + 1..to.saturating_sub(1), floor);
        let coins = from + 1 + self.below(4)..(to - 1).saturating_sub(self.below(4));
        if floor > 2 && coins.len() > 1 {
            self.fill(coins, floor - 2..floor - 1, Tile::Coin);
        }
        let blocks = from + 1 + self.below(4)..(to - 1).saturating_sub(self.below(4));
        if floor > 4 && blocks.len() > 2 {
            for column in blocks {
                let inner = column != from + 1 && column + 2 != to;
                let tile = match (inner && self.chance(1, 3), self.chance(1, 4)) {
                    (true, true) => Tile::PowerBlock,
                    (true, false) => Tile::CoinBlock,
                    (false, false) => Tile::Brick,
                    (false, true) if self.chance(1, 4) => Tile::PowerBrick,
                    (false, true) => Tile::CoinBrick,
                };
                self.level.set(column, floor - 4, tile);
            }
        }
    }

    /// Each of `columns` may have an enemy that stands on row `floor`.
    fn enemies(&mut self, columns: Range<usize>, floor: usize) {
        for column in columns {
            if !self.chance(self.difficulty + 1, 35) {
                continue;
            }
            let kinds = [Kind::Walker, Kind::GreenTurtle, Kind::RedTurtle, Kind::Spiky];
            let known = [1, 3, 3].get(self.difficulty as usize).copied().unwrap_or(4);
            let kind = kinds[self.below(known)];
            let winged = self.chance(self.difficulty, 35);
            self.spawn(column, floor - 1, kind, winged);
        }
    }

    fn spawn(&mut self, column: usize, row: usize, kind: Kind, winged: bool) {
        self.level.add(Spawn { column: column as u16, row: row as u8, kind, winged });
    }
}
