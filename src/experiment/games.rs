//! The two games and their plans.

use super::{Amount, Filmed, Game, Goal, Length, Method, Outcome, Plan, Teaching};
use crate::error::{Error, Result};
use crate::learner::{CrossValidated, Net};
use crate::policy::Outputs;
use crate::seed::Seed;
use crate::space::{Action, Dense, Features};
use crate::tasks::kart::{Driver, Kart, Ride, Tracks, joystick};
use crate::tasks::platformer::{Buttons, HOLD, Levels, Planner, Platformer, Playing, Scene, Settings};
use crate::trainer::{Dagger, Forward, Reuse, Searn, Smile, Supervised};
use serde_json::{Value, json};

/// How large an experiment is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// So small that it is over in minutes, with the same methods and rounds.
    Quick,
    /// This part of the paper's examples, above 0 and at most 1.
    Part(f64),
}

impl Scale {
    fn part(self) -> Result<f64> {
        match self {
            Scale::Quick => Ok(0.01),
            Scale::Part(part) if part > 0.0 && part <= 1.0 => Ok(part),
            Scale::Part(part) => Err(Error::argument("scale", part, "above 0 and at most 1")),
        }
    }
}

/// T for reuse: 1 / alpha (section 5).
const PIECE: usize = 10;
/// N for alpha 0.1 and for 0.2: the expert's share is about a fifth then.
const ROUNDS: [usize; 2] = [15, 7];

/// A net stopped early. What is left out in haste are folds: few examples need many passes, and the loss stands still for a while before it falls,
/// so one who is not patient ends with a net that always does the same.
fn learner(net: Net, folds: usize) -> CrossValidated<Net> {
    CrossValidated { learner: net, folds, most: 60, patience: 5 }
}

/// The methods of both experiments, with `amount` a round; `short` is that of forward training and SEARN, which do not scale.
fn methods(learner: &CrossValidated<Net>, amount: Amount, short: [Amount; 2]) -> Vec<Method> {
    let [slow, fast] = ROUNDS;
    let [forward, searn] = short;
    let smile = |reuse, piece| Smile { alpha: 0.1, rounds: slow, reuse, piece, ..Smile::default() };
    let method = |name: &str, teaching| Method { name: name.into(), teaching, amount, learner: learner.clone() };
    let mut linear = learner.clone();
    linear.learner.units = 0;
    vec![
        method("supervised", Teaching::Supervised(Supervised { rounds: slow })),
        method("smile-0.1", Teaching::Smile(smile(Reuse::None, None))),
        method("smile-0.2", Teaching::Smile(Smile { alpha: 0.2, rounds: fast, ..smile(Reuse::None, None) })),
        method("smile-warm", Teaching::Smile(Smile { warm: true, ..smile(Reuse::None, None) })),
        method("smile-4.3", Teaching::Smile(smile(Reuse::Printed43, Some(PIECE)))),
        method("smile-ageing", Teaching::Smile(smile(Reuse::Ageing, Some(PIECE)))),
        method("dagger", Teaching::Dagger(Dagger { rounds: slow, ..Dagger::default() })),
        Method {
            learner: linear.clone(),
            ..method("supervised-linear", Teaching::Supervised(Supervised { rounds: slow }))
        },
        Method { learner: linear, ..method("smile-linear", Teaching::Smile(smile(Reuse::None, None))) },
        Method {
            amount: forward,
            ..method("forward", Teaching::Forward(Forward { longest: slow, ..Forward::default() }))
        },
        Method { amount: searn, ..method("searn", Teaching::Searn(Searn { rounds: 3, ..Searn::default() })) },
    ]
}

/// The platform game and its planner.
#[derive(Clone, Debug)]
pub struct Platforming {
    space: Platformer,
    levels: Levels,
    planner: Planner,
}

impl Platforming {
    /// The game on `levels` of all difficulties.
    ///
    /// # Errors
    /// None with the settings that it has.
    pub fn new(levels: Levels) -> Result<Self> {
        let space = Platformer::new(levels.clone(), Settings::default())?;
        Ok(Platforming { space, levels, planner: Planner })
    }

    /// The paper's experiment: alpha 0.1 and N = 15, 6,000 examples a difficulty and round, T = 10 for reuse, and what stands beside it.
    ///
    /// # Errors
    /// When the scale is none.
    pub fn plan(scale: Scale, seed: u64) -> Result<Plan> {
        let pieces = ((6000.0 * scale.part()?) as usize / PIECE).max(2);
        // Runs of some hundred decisions: of a few games each.
        let episodes = (pieces * PIECE).div_ceil(600);
        let decisions = pieces.div_ceil(episodes) * PIECE;
        let quick = scale == Scale::Quick;
        let net = Net { units: 32, outputs: Outputs::Bits, rate: 0.003, batch: 32, ..Net::default() };
        let learner = learner(net, if quick { 3 } else { 10 });
        let forward = Amount { episodes: episodes * decisions, length: Length::Short(ROUNDS[0]) };
        let searn = Amount { episodes: 1, length: Length::Short(if quick { 5 } else { 20 }) };
        let amount = Amount { episodes, length: Length::Marathon(decisions) };
        let methods = methods(&learner, amount, [forward, searn]);
        Ok(Plan { game: Self::NAME.into(), seed, trainings: 1, games: if quick { 20 } else { 200 }, methods })
    }
}

impl Game for Platforming {
    type View = Features;
    type Space = Platformer;
    type Expert = Planner;

    const NAME: &'static str = "platformer";
    const GOAL: Goal = Goal::Distance;

    fn space(&self) -> &Platformer {
        &self.space
    }

    fn short(&self, decisions: usize) -> Result<Platformer> {
        let limit = u32::try_from(decisions).unwrap_or(u32::MAX).saturating_mul(HOLD);
        Platformer::new(self.levels.clone(), Settings { limit, ..self.space.settings().clone() })
    }

    fn expert(&self) -> &Planner {
        &self.planner
    }

    fn grades(&self) -> Vec<String> {
        self.space.settings().difficulties.iter().map(|d| u8::from(*d).to_string()).collect()
    }

    fn outcome(&self, state: &Playing) -> Outcome {
        let outcome = state.outcome();
        let [falls, won] = [outcome.died(), outcome.won()].map(|so| f64::from(u8::from(so)));
        Outcome { distance: f64::from(outcome.distance), falls, won }
    }
}

impl Filmed for Platforming {
    fn scene(&self, start: &Playing) -> Value {
        use crate::tasks::platformer::{COLUMNS, ROWS};
        let level = start.game().level();
        let row = |row| (0..COLUMNS).map(|column| level.tile(column, row).letter()).collect();
        let tiles: Vec<String> = (0..ROWS).map(row).collect();
        json!({ "tiles": tiles, "exit": level.exit() })
    }

    fn film(&self, state: &Playing, action: Action) -> Vec<Value> {
        let mut film = Vec::new();
        let picture = |game: &_| serde_json::to_value(Scene::of(game)).unwrap_or_default();
        let start = picture(state.game());
        state.clone().act(Buttons(action.0 as u8), |game| film.push(picture(game)));
        // The last frame is the next decision's first.
        film.pop();
        film.insert(0, start);
        film
    }

    fn action(&self, action: Action) -> String {
        let held =
            [(Buttons::LEFT, "left"), (Buttons::RIGHT, "right"), (Buttons::JUMP, "jump"), (Buttons::SPEED, "speed")];
        let buttons = Buttons(action.0 as u8);
        let names: Vec<&str> = held.iter().filter(|(one, _)| buttons.holds(*one)).map(|(_, name)| *name).collect();
        if names.is_empty() { "nothing".into() } else { names.join(" ") }
    }

    fn rate(&self) -> f64 {
        crate::tasks::platformer::FRAME_RATE as f64
    }

    fn tell(&self, state: &Playing) -> String {
        let outcome = state.outcome();
        let end = outcome.end.map_or("goes on".into(), |end| format!("{end:?}").to_lowercase());
        format!("{:.0} of {:.0} px, {end}", outcome.distance, outcome.length)
    }
}

/// Driving the kart on one track, as its driver does.
#[derive(Clone, Debug)]
pub struct Racing {
    kart: Kart,
    driver: Driver,
}

/// The length of the track, in metres: about 1,000 decisions a lap.
const TRACK: f64 = 1300.0;

impl Racing {
    /// The kart on the track that `tracks` gives for `seed`.
    ///
    /// # Errors
    /// When no track closes.
    pub fn new(tracks: &Tracks, seed: Seed) -> Result<Self> {
        Ok(Racing { kart: Kart::new(tracks.draw(TRACK, seed)?), driver: Driver::default() })
    }

    /// The paper's experiment: three laps a round, alpha 0.1 and N = 15, alpha 0.2 and N = 7, each ten times, and what stands beside it. There is only one
    /// track, so a part of it are fewer trainings.
    ///
    /// # Errors
    /// When the scale is none.
    pub fn plan(scale: Scale, seed: u64) -> Result<Plan> {
        let trainings = ((10.0 * scale.part()?).round() as u64).max(1);
        let quick = scale == Scale::Quick;
        let net = Net { units: 32, rate: 0.001, batch: 16, ..Net::default() };
        let mut learner = learner(net, if quick { 0 } else { 10 });
        if quick {
            // Nothing is held out: a number of passes that is about right for all.
            learner.most = 25;
        }
        let forward = Amount { episodes: if quick { 300 } else { 1000 }, length: Length::Short(ROUNDS[0]) };
        let searn = Amount { episodes: 1, length: Length::Short(if quick { 20 } else { 60 }) };
        let amount = Amount { episodes: if quick { 1 } else { 3 }, length: Length::Game };
        // With one training the laps alone say how sure the result is.
        let games = match trainings {
            _ if quick => 10,
            1 => 40,
            _ => 20,
        };
        let methods = methods(&learner, amount, [forward, searn]);
        // No reuse, as in the paper: all pieces that are run anew would be of the beginning of the one track.
        let methods = methods
            .into_iter()
            .filter(|method| !["smile-4.3", "smile-ageing"].contains(&method.name.as_str()))
            .collect();
        Ok(Plan { game: Self::NAME.into(), seed, trainings, games, methods })
    }
}

impl Game for Racing {
    type View = Dense;
    type Space = Kart;
    type Expert = Driver;

    const NAME: &'static str = "kart";
    const GOAL: Goal = Goal::Falls;

    fn space(&self) -> &Kart {
        &self.kart
    }

    fn short(&self, decisions: usize) -> Result<Kart> {
        self.kart.clone().limited(u32::try_from(decisions).unwrap_or(u32::MAX))
    }

    fn expert(&self) -> &Driver {
        &self.driver
    }

    fn grades(&self) -> Vec<String> {
        vec!["lap".into()]
    }

    /// Falls are those of the part of the lap that was made, over that part; of a lap that hardly began over a hundredth.
    fn outcome(&self, ride: &Ride) -> Outcome {
        let outcome = self.kart.outcome(ride);
        let made = (outcome.distance / self.kart.track().length()).max(0.01);
        let won = f64::from(u8::from(outcome.finished));
        Outcome { distance: outcome.distance, falls: f64::from(outcome.falls) / made, won }
    }
}

impl Filmed for Racing {
    fn scene(&self, _: &Ride) -> Value {
        json!({ "outline": self.kart.track().outline(), "length": self.kart.track().length() })
    }

    fn film(&self, ride: &Ride, _: Action) -> Vec<Value> {
        vec![serde_json::to_value(self.kart.frame(ride)).unwrap_or_default()]
    }

    fn action(&self, action: Action) -> String {
        joystick(action).to_string()
    }

    fn rate(&self) -> f64 {
        crate::tasks::kart::RATE
    }

    fn tell(&self, ride: &Ride) -> String {
        let outcome = self.kart.outcome(ride);
        let end = if outcome.finished { "finished" } else { "not finished" };
        format!("{} falls, {:.0} m, {end}", outcome.falls, outcome.distance)
    }
}
