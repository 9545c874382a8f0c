//! A game: the state of a level that is being played, and what a frame does to it.

use super::level::Level;
use super::runner::{Buttons, Mode, Runner};
use super::things::{Kind, NO_SPAWN, Thing};
use super::tiles::{COLUMNS, Land, ROWS, SIDE, Tile, cell};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The window's width and height in pixels.
pub const WINDOW: [f32; 2] = [320.0, 240.0];

/// How far beyond the window things still move, in pixels.
const MARGIN: f32 = 64.0;

/// Frames in a second.
pub const FRAME_RATE: usize = 24;

/// How a game can end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// The exit was reached.
    Won,
    /// Down a hole.
    Fell,
    /// Hurt while small.
    Killed,
    /// The time is over.
    Late,
}

/// A level that is being played. A copy goes on exactly as the original does.
///
/// Copies are cheap: the level is shared, and so is what has changed in it until it changes again.
#[derive(Debug, PartialEq)]
pub struct Game {
    pub(super) level: Arc<Level>,
    pub(super) land: Arc<Land>,
    /// The oldest first.
    pub(super) things: Vec<Thing>,
    pub(super) runner: Runner,
    /// The window's left edge, in pixels.
    pub(super) camera: f32,
    /// The columns around the window in the last frame, from and to.
    awake: (i32, i32),
    frame: u32,
    limit: u32,
    coins: u32,
    /// The next frame is skipped.
    stunned: bool,
    pub(super) end: Option<End>,
}

impl Clone for Game {
    fn clone(&self) -> Self {
        Game { level: self.level.clone(), land: self.land.clone(), things: self.things.clone(), ..*self }
    }

    /// Uses again what this one has set aside for things.
    fn clone_from(&mut self, from: &Self) {
        if !Arc::ptr_eq(&self.level, &from.level) {
            self.level = from.level.clone();
        }
        if !Arc::ptr_eq(&self.land, &from.land) {
            self.land = from.land.clone();
        }
        self.things.clone_from(&from.things);
        let Game { level: _, land: _, things: _, runner, camera, awake, frame, limit, coins, stunned, end } = *from;
        (self.runner, self.camera, self.awake, self.frame) = (runner, camera, awake, frame);
        (self.limit, self.coins, self.stunned, self.end) = (limit, coins, stunned, end);
    }
}

impl Game {
    /// The start of `level`, to be finished within `limit` frames.
    pub fn new(level: Arc<Level>, mode: Mode, limit: u32) -> Self {
        let land = Arc::new(Land::new(&level));
        Game {
            level,
            land,
            things: Vec::new(),
            runner: Runner::new(mode),
            camera: 0.0,
            awake: (0, -1),
            frame: 0,
            limit,
            coins: 0,
            stunned: false,
            end: None,
        }
    }

    /// Goes on by a frame with `buttons` held. Nothing happens once the game is over.
    pub fn advance(&mut self, buttons: Buttons) {
        if self.end.is_some() {
            return;
        }
        self.frame += 1;
        if self.frame >= self.limit {
            self.end = Some(End::Late);
            return;
        }
        if std::mem::take(&mut self.stunned) {
            return;
        }
        let last = COLUMNS as f32 * SIDE - WINDOW[0];
        self.camera = (self.runner.body.x - 0.5 * WINDOW[0]).clamp(0.0, last);
        let (left, right) = (self.camera - MARGIN, self.camera + WINDOW[0] + MARGIN);
        self.things.retain(|thing| {
            let Thing { body, alive, .. } = thing;
            *alive && (left..=right).contains(&body.x) && (-MARGIN..=WINDOW[1] + MARGIN).contains(&body.y)
        });
        self.wake();
        self.fire_cannon();
        for i in (0..self.things.len()).rev() {
            if let Some((x, y)) = self.things[i].go(&self.land, self.runner.body.x) {
                self.bump(cell(x), cell(y), true);
            }
        }
        self.run(buttons);
        if self.end.is_none() {
            self.touch();
            self.strike();
        }
    }

    /// The runner's part of a frame.
    fn run(&mut self, buttons: Buttons) {
        let newly = buttons.holds(Buttons::SPEED) && !self.runner.held.holds(Buttons::SPEED);
        if let Some((column, row)) = self.runner.go(&self.land, buttons) {
            self.bump(column, row, self.runner.mode != Mode::Small);
        }
        let Runner { body, facing, mode, .. } = self.runner;
        if newly && mode == Mode::Fire && self.flying() < 2 {
            let x = body.x + 6.0 * f32::from(facing);
            self.things.push(Thing::new(Kind::Fireball, x, body.y - 20.0, facing));
        }
        self.carry(buttons);
        for up in [0.0, 0.5 * body.height] {
            let (column, row) = (cell(body.x), cell(body.y - up));
            if self.land.tile(column, row) == Tile::Coin {
                self.coins += 1;
                self.set(column, row, Tile::Empty);
            }
        }
        if body.x > self.level.exit() {
            self.end = Some(End::Won);
        } else if body.y > (ROWS + 1) as f32 * SIDE {
            self.end = Some(End::Fell);
        }
    }

    /// How many fireballs there are.
    fn flying(&self) -> usize {
        self.things.iter().filter(|thing| thing.kind == Kind::Fireball && thing.alive).count()
    }

    /// A shell that is carried goes with the runner, until the button is up.
    fn carry(&mut self, buttons: Buttons) {
        let Runner { body, facing, .. } = self.runner;
        for shell in self.things.iter_mut().filter(|thing| thing.carried) {
            shell.carried = buttons.holds(Buttons::SPEED);
            let ahead = if shell.carried { 8.0 } else { 16.0 };
            shell.facing = if shell.carried { 0 } else { facing };
            (shell.body.x, shell.body.y, shell.ya) = (body.x + ahead * f32::from(facing), body.y, 0.0);
        }
    }

    /// Wakes those who start in columns that have just come near the window, unless they are gone or still there.
    fn wake(&mut self) {
        let first = cell(self.camera) - 1;
        let now = (first, cell(self.camera + WINDOW[0]) + 1);
        if now == self.awake {
            return;
        }
        let (from, to) = std::mem::replace(&mut self.awake, now);
        let level = self.level.clone();
        for column in (now.0..=now.1).filter(|column| !(from..=to).contains(column)) {
            for number in level.spawns_in(column) {
                let spawn = level.spawns[number];
                let here = self.things.iter().any(|thing| thing.spawn == number as u16);
                if here || self.land.gone[number] {
                    continue;
                }
                let (x, y) = spawn.place();
                let facing = if x > self.runner.body.x { -1 } else { 1 };
                let thing = Thing::new(spawn.kind, x, y, facing);
                self.things.push(Thing { winged: spawn.winged, spawn: number as u16, ..thing });
            }
        }
    }

    /// Column c's cannon fires every 100 frames, at frame 2c: of all the window's columns at most one has its turn.
    fn fire_cannon(&mut self) {
        if self.frame % 2 == 1 {
            return;
        }
        let first = cell(self.camera).max(0);
        let turn = (self.frame / 2 % 50) as i32;
        let column = first + (turn - first).rem_euclid(50);
        if column > cell(self.camera + WINDOW[0]) {
            return;
        }
        if let Some(row) = self.level.barrel(column) {
            let x = column as f32 * SIDE + 0.5 * SIDE;
            let apart = self.runner.body.x - x;
            if apart.abs() > SIDE {
                let facing = if apart > 0.0 { 1 } else { -1 };
                let y = row as f32 * SIDE + SIDE - 1.0;
                self.things.push(Thing::new(Kind::Bullet, x + 8.0 * f32::from(facing), y, facing));
            }
        }
    }

    /// What the runner touches, the newest first.
    fn touch(&mut self) {
        for i in (0..self.things.len()).rev() {
            let Runner { body, mode, ya, .. } = self.runner;
            let thing = &mut self.things[i];
            if !thing.alive || thing.carried || !thing.touches(body.x, body.y, body.height) {
                continue;
            }
            let stomps = ya > 0.0 && body.y <= thing.body.y && !(self.runner.on_ground && self.runner.was_on_ground);
            match thing.kind {
                Kind::Fireball => {}
                Kind::Mushroom | Kind::Blossom => {
                    thing.alive = false;
                    let to = if thing.kind == Kind::Blossom { Mode::Fire } else { Mode::Large };
                    if mode < to { self.runner.become_mode(to) } else { self.coins += 1 }
                }
                Kind::Flower | Kind::Spiky => self.hurt(),
                Kind::Shell if !stomps && thing.facing == 0 => {
                    thing.carried = self.runner.held.holds(Buttons::SPEED);
                    thing.facing = if thing.carried { 0 } else { self.runner.facing };
                }
                _ if !stomps => self.hurt(),
                Kind::Shell => {
                    thing.facing = if thing.facing == 0 { self.runner.facing } else { 0 };
                    self.runner.bounce();
                }
                _ => {
                    self.runner.bounce();
                    self.stomp(i);
                }
            }
            if self.end.is_some() {
                return;
            }
        }
    }

    fn stomp(&mut self, i: usize) {
        let thing = &mut self.things[i];
        if thing.winged {
            (thing.winged, thing.ya) = (false, 0.0);
            return;
        }
        let Thing { kind, body, .. } = *thing;
        self.kill(i);
        if matches!(kind, Kind::RedTurtle | Kind::GreenTurtle) {
            self.things.push(Thing { ya: -5.0, ..Thing::new(Kind::Shell, body.x, body.y, 0) });
        }
    }

    /// Takes thing `i` away; where it started it does not come back.
    fn kill(&mut self, i: usize) {
        let thing = &mut self.things[i];
        thing.alive = false;
        if thing.spawn != NO_SPAWN {
            Arc::make_mut(&mut self.land).gone[thing.spawn as usize] = true;
        }
    }

    fn hurt(&mut self) {
        if self.runner.safe > 0 {
            return;
        }
        (self.runner.safe, self.stunned) = (32, true);
        match self.runner.mode {
            Mode::Small => self.end = Some(End::Killed),
            Mode::Large => self.runner.become_mode(Mode::Small),
            Mode::Fire => self.runner.become_mode(Mode::Large),
        }
    }

    /// What sliding shells strike, then what fireballs do.
    fn strike(&mut self) {
        for i in (0..self.things.len()).rev() {
            if self.things[i].sliding() {
                self.strike_with(i, |_, _| (true, false));
            }
        }
        for i in (0..self.things.len()).rev() {
            if self.things[i].kind == Kind::Fireball {
                self.strike_with(i, |kind, rests| match kind {
                    Kind::Spiky | Kind::Bullet => (false, true),
                    Kind::Shell => (rests, true),
                    _ => (true, true),
                });
            }
        }
    }

    /// Strikes all that thing `i` touches and that can be struck. What kind it is and whether it rests decides whether it dies, and whether thing
    /// `i` ends there.
    fn strike_with(&mut self, i: usize, fate: impl Fn(Kind, bool) -> (bool, bool)) {
        let body = self.things[i].body;
        for j in (0..self.things.len()).rev() {
            let thing = &self.things[j];
            let immune = matches!(thing.kind, Kind::Fireball | Kind::Mushroom | Kind::Blossom) || thing.carried;
            if i == j || !self.things[i].alive || !thing.alive || immune || !thing.struck_by(&body) {
                continue;
            }
            let (dies, ends) = fate(thing.kind, thing.facing == 0);
            if dies {
                self.kill(j);
            }
            self.things[i].alive = !ends;
        }
    }

    fn set(&mut self, column: i32, row: i32, tile: Tile) {
        Arc::make_mut(&mut self.land).tiles[super::tiles::spot(column, row)] = tile;
    }

    /// A blow to a block: what is in it comes out, a brick breaks if the blow is `hard`, and who stands on it dies.
    fn bump(&mut self, column: i32, row: i32, hard: bool) {
        let tile = self.land.tile(column, row);
        match tile {
            Tile::CoinBlock | Tile::CoinBrick => self.coins += 1,
            Tile::PowerBlock | Tile::PowerBrick => {
                let kind = if self.runner.mode == Mode::Small { Kind::Mushroom } else { Kind::Blossom };
                let (x, y) = (column as f32 * SIDE + 0.5 * SIDE, row as f32 * SIDE + 0.5 * SIDE);
                self.things.push(Thing::new(kind, x, y, 1));
            }
            Tile::Brick => {}
            _ => return,
        }
        match tile {
            Tile::Brick if hard => self.set(column, row, Tile::Empty),
            Tile::Brick => {}
            _ => self.set(column, row, Tile::Used),
        }
        for i in 0..self.things.len() {
            let Thing { kind, body, alive, .. } = self.things[i];
            let above = cell(body.y) == row - 1 && [-body.half, body.half].map(|s| cell(body.x + s)).contains(&column);
            if alive && kind.walks() && above {
                self.kill(i);
            }
        }
    }
}

/// What can be asked of a game.
impl Game {
    /// How it ended, if it has.
    pub fn end(&self) -> Option<End> {
        self.end
    }

    /// Where the runner's feet are: pixels to the right and down. The first is the distance travelled.
    pub fn position(&self) -> [f32; 2] {
        [self.runner.body.x, self.runner.body.y]
    }

    /// How fast the runner is: pixels a frame to the right and down.
    pub fn speed(&self) -> [f32; 2] {
        [self.runner.xa, self.runner.ya]
    }

    /// What the runner can bear.
    pub fn mode(&self) -> Mode {
        self.runner.mode
    }

    /// Whether the runner stands on something.
    pub fn on_ground(&self) -> bool {
        self.runner.on_ground
    }

    /// Whether the runner could jump in the next frame: on the ground or at a wall, with the jump button up in the last frame.
    pub fn can_jump(&self) -> bool {
        self.runner.may_jump
    }

    /// How many frames have passed.
    pub fn frames(&self) -> u32 {
        self.frame
    }

    /// How many coins were found.
    pub fn coins(&self) -> u32 {
        self.coins
    }

    /// The level.
    pub fn level(&self) -> &Level {
        &self.level
    }

    /// The tile in `column` and `row` as it is now; outside the level that of its edge.
    pub fn tile(&self, column: usize, row: usize) -> Tile {
        self.land.tile(column.min(COLUMNS) as i32, row.min(ROWS) as i32)
    }
}
