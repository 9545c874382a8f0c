//! The expert: it tries out what its moves lead to, in copies of the game.

use super::game::{End, Game};
use super::runner::{Buttons, Mode};
use super::space::{Platformer, Playing};
use super::tiles::{ROWS, cell};
use crate::space::{Action, Expert};

/// What the planner tries, the first of equals being preferred: half of all sets of buttons, with which levels are finished as often as with more.
pub const MOVES: [Buttons; 8] = [
    Buttons::RIGHT.and(Buttons::SPEED),
    Buttons::RIGHT.and(Buttons::JUMP).and(Buttons::SPEED),
    Buttons::RIGHT,
    Buttons::RIGHT.and(Buttons::JUMP),
    Buttons::JUMP,
    Buttons::LEFT.and(Buttons::SPEED),
    Buttons::LEFT.and(Buttons::JUMP).and(Buttons::SPEED),
    Buttons::LEFT,
];

/// How many moves it looks ahead.
pub const DEPTH: u32 = 3;

/// For how many frames it holds each of them in mind. It is asked again every [`HOLD`](super::HOLD) frames.
pub const STRETCH: u32 = 8;

/// The planner of Ross & Bagnell (2010, footnote 4), which knows the state of the game whole: of all sequences of three moves, each held for eight
/// frames, it begins the one that leads to the state with the highest [`Planner::value`].
///
/// The search is exact. A branch is left where even running on unhindered could not lead to more than what was already found; so the answer is that
/// of trying all 512 sequences.
#[derive(Clone, Copy, Debug, Default)]
pub struct Planner;

/// What the planner found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// What to do.
    pub buttons: Buttons,
    /// The value of the state that it leads to.
    pub value: f32,
    /// How many frames were tried out.
    pub frames: u64,
}

impl Planner {
    /// How good `game` is, with `unused` moves left to make: pixels travelled and twice the speed; 300 less for each hurt; a death costs 100,000 and
    /// 1,000 for each move left, a win brings 10,000 and as much; who is low above a hole loses up to 400 more for each 48 pixels.
    pub fn value(game: &Game, unused: u32) -> f32 {
        let [x, y] = game.position();
        let mut value = x + 2.0 * game.speed()[0] - 300.0 * lost(game);
        match game.end() {
            Some(End::Won) => value += 10_000.0 + 1_000.0 * unused as f32,
            Some(_) => value -= 100_000.0 + 1_000.0 * unused as f32,
            None => {}
        }
        if y > 192.0 && !game.land.tile(cell(x), ROWS as i32 - 1).solid() {
            value -= 400.0 * (y - 192.0) / 48.0;
        }
        value
    }

    /// The best first move in `game`; nothing once it is over.
    pub fn plan(&self, game: &Game) -> Option<Plan> {
        if game.end().is_some() {
            return None;
        }
        let mut search = Search { games: vec![game.clone(); DEPTH as usize + 1], frames: 0 };
        let (value, buttons) = search.best(0, f32::NEG_INFINITY);
        Some(Plan { buttons, value, frames: search.frames })
    }
}

impl Expert<Platformer> for Planner {
    fn action(&self, _: &Platformer, state: &Playing) -> Option<Action> {
        self.plan(state.game()).map(|plan| Action(u32::from(plan.buttons.0)))
    }
}

/// How many hurts separate the runner from its best.
fn lost(game: &Game) -> f32 {
    match game.mode() {
        Mode::Fire => 0.0,
        Mode::Large => 1.0,
        Mode::Small => 2.0,
    }
}

/// No state that `game` can come to with `unused` moves has a higher value: it moves to the right as fast as it can, nothing is in the way, and
/// it finds all that it lacks.
///
/// The sums are those of the engine in the same order, and rounding never turns more into less, so the bound holds to the last bit and is met by
/// who runs unhindered.
fn bound(game: &Game, unused: u32) -> f32 {
    let (mut x, mut xa) = (game.runner.body.x, game.runner.xa);
    for frame in 0..unused * STRETCH {
        xa += 1.2;
        // Once, early on, a wall may have been pushed off from; later the speed is higher anyway.
        if frame == 0 {
            xa = xa.max(6.0);
        }
        let mut left = xa;
        while left > 8.0 {
            x += 8.0;
            left -= 8.0;
        }
        x += left;
        xa *= 0.89;
    }
    let prize = if x > game.level.exit() { 10_000.0 + 1_000.0 * unused as f32 } else { 0.0 };
    x + 2.0 * xa + prize
}

/// A search in depth, in which game i is the state after i moves.
struct Search {
    games: Vec<Game>,
    frames: u64,
}

impl Search {
    /// The highest value that can be reached from the state after `depth` moves, and the move to make there. Where it is not above `floor`, what is
    /// returned is not above it either.
    fn best(&mut self, depth: u32, floor: f32) -> (f32, Buttons) {
        let here = &self.games[depth as usize];
        if depth == DEPTH || here.end().is_some() {
            return (Planner::value(here, DEPTH - depth), Buttons::NONE);
        }
        let most = bound(here, DEPTH - depth);
        let mut best = (floor, Buttons::NONE);
        for buttons in MOVES {
            if best.0 >= most {
                break;
            }
            self.try_out(depth, buttons);
            let (value, _) = self.best(depth + 1, best.0);
            if value > best.0 {
                best = (value, buttons);
            }
        }
        best
    }

    /// Makes a move in a copy.
    fn try_out(&mut self, depth: u32, buttons: Buttons) {
        let (before, after) = self.games.split_at_mut(depth as usize + 1);
        let game = &mut after[0];
        game.clone_from(&before[depth as usize]);
        let start = game.frames();
        for _ in 0..STRETCH {
            game.advance(buttons);
        }
        self.frames += u64::from(game.frames() - start);
    }
}
