//! What moves, but for the runner: its kinds, how they move and what they touch.

use super::body::{Body, Side, Stop};
use super::tiles::Land;
use serde::{Deserialize, Serialize};

/// A kind of thing that moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Walks; low.
    Walker,
    /// Walks, high, turns at cliffs; in a shell.
    RedTurtle,
    /// Walks, high, over cliffs; in a shell.
    GreenTurtle,
    /// Walks; low, hurts who jumps on it, and fire does it nothing.
    Spiky,
    /// Comes out of a pipe.
    Flower,
    /// Comes out of a cannon and flies through everything.
    Bullet,
    /// What is left of a turtle; rests or slides.
    Shell,
    /// What the runner throws.
    Fireball,
    /// Makes a small runner large.
    Mushroom,
    /// Lets a runner throw fireballs.
    Blossom,
}

impl Kind {
    /// Whether it walks, or flies on wings.
    #[inline]
    pub fn walks(self) -> bool {
        matches!(self, Kind::Walker | Kind::RedTurtle | Kind::GreenTurtle | Kind::Spiky)
    }

    /// In pictures of letters: upper case with wings.
    pub fn letter(self, winged: bool) -> char {
        let letter = match self {
            Kind::Walker => 'w',
            Kind::RedTurtle => 'r',
            Kind::GreenTurtle => 'g',
            Kind::Spiky => 's',
            Kind::Flower => 'f',
            Kind::Bullet => '*',
            Kind::Shell => 'c',
            Kind::Fireball => '.',
            Kind::Mushroom => 'm',
            Kind::Blossom => 'b',
        };
        if winged { letter.to_ascii_uppercase() } else { letter }
    }

    /// Half its width and its height, in pixels.
    #[inline]
    fn size(self) -> (f32, f32) {
        match self {
            Kind::RedTurtle | Kind::GreenTurtle => (4.0, 24.0),
            Kind::Flower => (2.0, 12.0),
            Kind::Fireball => (4.0, 8.0),
            _ => (4.0, 12.0),
        }
    }

    /// How near the runner's middle has to come to its own to touch it, in pixels.
    #[inline]
    fn reach(self) -> f32 {
        match self {
            Kind::Flower => 8.0,
            kind if kind.walks() => 12.0,
            _ => 16.0,
        }
    }
}

/// The number of a spawn that is none.
pub(super) const NO_SPAWN: u16 = u16::MAX;

/// A thing that moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Thing {
    pub kind: Kind,
    pub body: Body,
    /// Pixels a frame, downwards.
    pub ya: f32,
    /// -1 left, 1 right; a shell that rests 0.
    pub facing: i8,
    pub winged: bool,
    pub on_ground: bool,
    /// A shell in the runner's hands.
    pub carried: bool,
    /// What is not alive is taken away at the next frame.
    pub alive: bool,
    /// Frames: how long an item has risen, or a flower has waited.
    pub clock: u16,
    /// The number of the level's spawn that it came from.
    pub spawn: u16,
    /// Where its feet were at first: deep in the pipe, for a flower.
    pub home: f32,
}

/// Frames that an item needs to come out of its block, a pixel each.
const RISE: u16 = 9;

impl Thing {
    pub fn new(kind: Kind, x: f32, y: f32, facing: i8) -> Self {
        let (half, height) = kind.size();
        Thing {
            kind,
            body: Body { x, y, half, height },
            ya: if kind == Kind::Fireball { 4.0 } else { 0.0 },
            facing,
            winged: false,
            on_ground: false,
            carried: false,
            alive: true,
            clock: 0,
            spawn: NO_SPAWN,
            home: y,
        }
    }

    /// A shell that slides.
    #[inline]
    pub fn sliding(&self) -> bool {
        self.kind == Kind::Shell && self.facing != 0 && !self.carried
    }

    /// Whether a runner of `height` with middle and feet at `x` and `y` touches it.
    #[inline]
    pub fn touches(&self, x: f32, y: f32, height: f32) -> bool {
        let (dx, dy) = (x - self.body.x, y - self.body.y);
        dx.abs() < self.kind.reach() && -self.body.height < dy && dy < height
    }

    /// Whether `other`, a shell or a fireball, strikes it.
    #[inline]
    pub fn struck_by(&self, other: &Body) -> bool {
        let (dx, dy) = (other.x - self.body.x, other.y - self.body.y);
        dx.abs() < 16.0 && -self.body.height < dy && dy < other.height
    }

    /// Moves for a frame, with the runner at `runner`. Returns the column and row at the height of its feet that a shell has run into.
    #[inline]
    pub fn go(&mut self, land: &Land, runner: f32) -> Option<(f32, f32)> {
        match self.kind {
            Kind::Bullet => self.body.x += 4.0 * f32::from(self.facing),
            Kind::Flower => self.bloom(runner),
            Kind::Mushroom | Kind::Blossom if self.clock < RISE => {
                self.clock += 1;
                self.body.y -= 1.0;
            }
            Kind::Blossom => {}
            Kind::Fireball => self.fly(land),
            Kind::Shell => return self.slide(land),
            _ => self.walk(land),
        }
        None
    }

    /// Walkers and mushrooms: they turn at what is in the way.
    fn walk(&mut self, land: &Land) {
        let careful = self.kind == Kind::RedTurtle && self.on_ground && !self.winged;
        if self.body.walk(land, 1.75 * f32::from(self.facing), careful) != Side::Free {
            self.facing = -self.facing;
        }
        self.drop(land, if self.winged { (0.95, 0.6) } else { (0.85, 2.0) });
        if self.winged && self.on_ground {
            self.ya = -10.0;
        }
    }

    /// Moves up or down; then the speed is damped and, in the air, the weight added.
    fn drop(&mut self, land: &Land, (damp, weight): (f32, f32)) {
        match self.body.fall(land, self.ya) {
            Stop::Floor => self.on_ground = true,
            met => {
                self.on_ground = false;
                if met != Stop::Free {
                    self.ya = 0.0;
                }
            }
        }
        self.ya *= damp;
        if !self.on_ground {
            self.ya += weight;
        }
    }

    /// A flower waits in its pipe, comes out when the runner is not too near, and sinks again.
    fn bloom(&mut self, runner: f32) {
        if self.body.y >= self.home {
            self.body.y = self.home;
            self.clock = self.clock.saturating_add(1);
            if self.clock <= 40 || (runner - self.body.x).abs() <= 24.0 {
                return;
            }
            self.ya = -8.0;
            self.clock = 0;
        }
        self.body.y += self.ya;
        self.ya = self.ya * 0.9 + 0.1;
    }

    /// A fireball hops along and ends at a wall.
    fn fly(&mut self, land: &Land) {
        self.alive = self.body.walk(land, 8.0 * f32::from(self.facing), false) == Side::Free;
        self.drop(land, (0.95, 1.5));
        if self.on_ground {
            self.ya = -10.0;
        }
    }

    /// A shell falls, and slides if it has been kicked.
    fn slide(&mut self, land: &Land) -> Option<(f32, f32)> {
        if self.carried {
            return None;
        }
        let met = self.body.walk(land, 11.0 * f32::from(self.facing), false);
        let ahead = self.body.x + (self.body.half + 2.0) * f32::from(self.facing);
        let hit = (met != Side::Free).then_some((ahead, self.body.y));
        if hit.is_some() {
            self.facing = -self.facing;
        }
        self.drop(land, (0.85, 2.0));
        hit
    }
}
