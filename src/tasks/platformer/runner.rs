//! The one who is played: how buttons become motion.

use super::body::{Body, Side, Stop};
use super::tiles::Land;
use serde::{Deserialize, Serialize};

/// Which of the four buttons are held: a bit mask, and the number of an action.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Buttons(pub u8);

impl Buttons {
    /// None.
    pub const NONE: Buttons = Buttons(0);
    /// To the left.
    pub const LEFT: Buttons = Buttons(1);
    /// To the right.
    pub const RIGHT: Buttons = Buttons(2);
    /// Jump; higher the longer it is held.
    pub const JUMP: Buttons = Buttons(4);
    /// Run instead of walk; throw a fireball when newly pressed; carry a shell while held.
    pub const SPEED: Buttons = Buttons(8);

    /// These and those.
    pub const fn and(self, other: Buttons) -> Buttons {
        Buttons(self.0 | other.0)
    }

    /// Whether all of `other` are held.
    #[inline]
    pub const fn holds(self, other: Buttons) -> bool {
        self.0 & other.0 == other.0
    }
}

/// What a runner can bear: each hurt takes one away.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Low; dies when hurt.
    Small,
    /// High; breaks bricks.
    Large,
    /// As large, and throws fireballs.
    #[default]
    Fire,
}

impl Mode {
    /// The runner's height in pixels.
    pub fn height(self) -> f32 {
        if self == Mode::Small { 12.0 } else { 24.0 }
    }
}

/// The runner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Runner {
    pub body: Body,
    /// Pixels a frame, to the right.
    pub xa: f32,
    /// Pixels a frame, downwards.
    pub ya: f32,
    /// -1 left, 1 right.
    pub facing: i8,
    pub mode: Mode,
    pub on_ground: bool,
    /// On the ground at the end of the frame before the last.
    pub was_on_ground: bool,
    /// On the ground or at a wall, with the jump button up in the last frame.
    pub may_jump: bool,
    /// Gliding down a wall.
    pub at_wall: bool,
    /// Frames that a jump goes on while the button is held; those of a jump from a wall are negative and go on by themselves.
    pub jump: i8,
    /// What was held in the last frame.
    pub held: Buttons,
    /// Frames for which nothing hurts.
    pub safe: u8,
}

/// How fast one gets up by each frame that a jump goes on, pixels a frame.
const LIFT: f32 = -1.9;

impl Runner {
    pub fn new(mode: Mode) -> Self {
        Runner {
            body: Body { x: 32.0, y: 0.0, half: 4.0, height: mode.height() },
            xa: 0.0,
            ya: 0.0,
            facing: 1,
            mode,
            on_ground: false,
            was_on_ground: false,
            may_jump: false,
            at_wall: false,
            jump: 0,
            held: Buttons::NONE,
            safe: 0,
        }
    }

    /// Moves for a frame: speeds up, moves to the side, moves up or down, is damped, falls. Returns the tile that the head has hit.
    pub fn go(&mut self, land: &Land, buttons: Buttons) -> Option<(i32, i32)> {
        self.safe = self.safe.saturating_sub(1);
        self.was_on_ground = self.on_ground;
        self.speed_up(buttons);
        self.leap(buttons);
        if self.xa.abs() < 0.5 {
            self.xa = 0.0;
        }
        let met = self.body.walk(land, self.xa, false);
        if met != Side::Free {
            self.xa = 0.0;
        }
        let hit = match self.body.fall(land, self.ya) {
            Stop::Free => {
                self.on_ground = false;
                None
            }
            Stop::Floor => {
                self.on_ground = true;
                None
            }
            Stop::Ceiling(column, row) => {
                (self.on_ground, self.ya, self.jump) = (false, 0.0, 0);
                Some((column, row))
            }
        };
        // The level begins with a wall that is not in its tiles.
        if self.body.x < 0.0 {
            (self.body.x, self.xa) = (0.0, 0.0);
        }
        self.at_wall = met == Side::Walled && !self.on_ground && self.ya > 0.0;
        self.may_jump = (self.on_ground || self.at_wall) && !buttons.holds(Buttons::JUMP);
        self.xa *= 0.89;
        self.ya *= 0.85;
        if !self.on_ground {
            self.ya = (self.ya + 3.0).min(20.0);
        }
        self.held = buttons;
        hit
    }

    fn speed_up(&mut self, buttons: Buttons) {
        let by = if buttons.holds(Buttons::SPEED) { 1.2 } else { 0.6 };
        let way = i8::from(buttons.holds(Buttons::RIGHT)) - i8::from(buttons.holds(Buttons::LEFT));
        self.xa += by * f32::from(way);
        // Who jumps off a wall goes away from it, whatever is held.
        if way != 0 && self.jump >= 0 {
            self.facing = way;
        }
    }

    /// Starts a jump, goes on with it or ends it.
    fn leap(&mut self, buttons: Buttons) {
        let pressed = buttons.holds(Buttons::JUMP);
        if self.jump < 0 && !self.on_ground && !self.at_wall {
            self.push_off();
        } else if !pressed {
            self.jump = 0;
        } else if self.jump > 0 {
            self.ya = LIFT * f32::from(self.jump);
            self.jump -= 1;
        } else if self.on_ground && self.may_jump {
            self.jump = 7;
            self.ya = LIFT * 7.0;
            (self.on_ground, self.at_wall) = (false, false);
        } else if self.at_wall && self.may_jump {
            (self.jump, self.facing, self.at_wall) = (-6, -self.facing, false);
            self.push_off();
        } else {
            self.jump = 0;
        }
        if self.at_wall {
            self.ya *= 0.5;
        }
    }

    /// A frame of a jump away from a wall.
    fn push_off(&mut self) {
        self.xa = 6.0 * f32::from(self.facing);
        self.ya = 2.0 * f32::from(self.jump);
        self.jump += 1;
    }

    /// Thrown up by what was jumped on, as by a jump of eight frames.
    pub fn bounce(&mut self) {
        self.jump = 8;
        self.ya = LIFT * 8.0;
        self.on_ground = false;
        self.safe = self.safe.max(1);
    }

    pub fn become_mode(&mut self, mode: Mode) {
        self.mode = mode;
        self.body.height = mode.height();
    }
}
