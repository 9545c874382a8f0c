//! The platform game as a space.

use super::features::{FEATURES, Memory};
use super::game::{End, Game};
use super::levels::{Difficulty, Levels};
use super::planner::Planner;
use super::runner::{Buttons, Mode};
use crate::error::{Error, Result};
use crate::seed::Seed;
use crate::space::{Action, Actions, Episode, FeatureTable, Features, Imitation, NO_ROW, Space};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Frames for which an action holds its buttons.
pub const HOLD: u32 = 4;

/// The longest game that can be asked for, in frames: over an hour.
const MOST_FRAMES: u32 = 100_000;

/// How many actions there are: each set of buttons, as [`Buttons`] numbers them.
pub const ACTIONS: usize = 16;

/// How games are played.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Episode i is played at difficulty number i of these, from the front again after the last.
    pub difficulties: Vec<Difficulty>,
    /// Frames, of which there are 24 in a second, after which a game is over: from 1 to 100,000.
    pub limit: u32,
    /// What the runner can bear at the start.
    pub mode: Mode,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { difficulties: Difficulty::ALL.to_vec(), limit: 3000, mode: Mode::Fire }
    }
}

/// The platform game: levels are drawn anew for each episode, and an action holds four buttons for four frames.
///
/// Action a is the set of buttons whose mask a is: 1 left, 2 right, 4 jump, 8 speed. What is seen is told in [`features`](super::features). Costs
/// are 0 until the game is over; the last step costs the part of the way that was not made, 1 - distance / length, or 0 if the exit was reached. The
/// level of an episode hangs below its seed and the difficulty that its number has, so the same episode is always the same level.
#[derive(Clone, Debug)]
pub struct Platformer {
    levels: Levels,
    settings: Settings,
    table: FeatureTable,
}

/// A game and what was seen of it at the last decisions.
#[derive(Clone, Debug, PartialEq)]
pub struct Playing {
    game: Game,
    memory: Memory,
}

/// How a game went.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// How far the runner got, in pixels.
    pub distance: f32,
    /// How far the exit is, in pixels.
    pub length: f32,
    /// How it ended; nothing while it goes on.
    pub end: Option<End>,
    /// How many frames it took.
    pub frames: u32,
    /// How many coins were found.
    pub coins: u32,
}

impl Outcome {
    /// Whether the exit was reached.
    pub fn won(&self) -> bool {
        self.end == Some(End::Won)
    }

    /// Whether the runner died: fell or was killed.
    pub fn died(&self) -> bool {
        matches!(self.end, Some(End::Fell | End::Killed))
    }

    /// The part of the way that was not made, in [0, 1].
    pub fn missing(&self) -> f64 {
        if self.won() { 0.0 } else { (1.0 - f64::from(self.distance) / f64::from(self.length)).clamp(0.0, 1.0) }
    }
}

impl Playing {
    /// The start of `game`, of which nothing was seen before.
    pub fn new(game: Game) -> Self {
        let mut memory = Memory::default();
        memory.see(&game, Buttons::NONE);
        Playing { game, memory }
    }

    /// The game.
    pub fn game(&self) -> &Game {
        &self.game
    }

    /// How it went so far.
    pub fn outcome(&self) -> Outcome {
        let game = &self.game;
        Outcome {
            distance: game.position()[0],
            length: game.level().exit(),
            end: game.end(),
            frames: game.frames(),
            coins: game.coins(),
        }
    }

    /// Holds `buttons` for the frames of an action and shows each to `watch` when it is over.
    pub fn act(&mut self, buttons: Buttons, mut watch: impl FnMut(&Game)) {
        for _ in 0..HOLD {
            if self.game.end().is_some() {
                break;
            }
            self.game.advance(buttons);
            watch(&self.game);
        }
        self.memory.see(&self.game, buttons);
    }
}

impl Platformer {
    /// The game on `levels`.
    ///
    /// # Errors
    /// When there is no difficulty, or the time is out of its range.
    pub fn new(levels: Levels, settings: Settings) -> Result<Self> {
        if settings.difficulties.is_empty() {
            return Err(Error::argument("difficulties", "empty", "at least one difficulty"));
        }
        if !(1..=MOST_FRAMES).contains(&settings.limit) {
            return Err(Error::argument("limit", settings.limit, format!("from 1 to {MOST_FRAMES} frames")));
        }
        Ok(Platformer { levels, settings, table: FeatureTable::new(FEATURES) })
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The problem of imitating the planner in `episodes` episodes a round.
    pub fn problem(self, episodes: usize) -> Imitation<Self, Planner> {
        Imitation { space: self, expert: Planner, episodes }
    }

    /// The difficulty of the episode numbered `index`.
    pub fn difficulty(&self, index: usize) -> Difficulty {
        self.settings.difficulties[index % self.settings.difficulties.len()]
    }

    /// The most decisions that a game can take.
    pub fn longest(&self) -> usize {
        self.settings.limit.div_ceil(HOLD) as usize
    }
}

impl Space for Platformer {
    type State = Playing;
    type View = Features;

    fn start(&self, episode: Episode) -> Playing {
        let level = self.levels.draw(self.difficulty(episode.index), episode.seed);
        Playing::new(Game::new(Arc::new(level), self.settings.mode, self.settings.limit))
    }

    fn legal<'a>(&'a self, state: &'a Playing) -> Actions<'a> {
        if state.game.end().is_some() { Actions::NONE } else { Actions::All(ACTIONS as u32) }
    }

    fn look(&self, state: &Playing, view: &mut Features) {
        view.row = NO_ROW;
        view.dynamic.clear();
        state.memory.list(&mut view.dynamic);
    }

    fn step(&self, state: &mut Playing, action: Action, _: Seed) -> f64 {
        state.act(Buttons(action.0 as u8), |_| ());
        if state.game.end().is_some() { state.outcome().missing() } else { 0.0 }
    }

    fn actions(&self) -> usize {
        ACTIONS
    }

    fn shared(&self) -> &FeatureTable {
        &self.table
    }
}
