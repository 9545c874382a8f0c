//! A game: stay on a plank that sways and is higher in the middle.

use rollin::experiment::{Amount, Game, Goal, Length, Method, Outcome, Plan, Teaching};
use rollin::learner::{CrossValidated, Net};
use rollin::policy::Outputs;
use rollin::space::{Action, Actions, Episode, Expert, FeatureTable, Features, NO_ROW, Space};
use rollin::trainer::{Dagger, Forward, Reuse, Searn, Smile, Supervised};
use rollin::{Purpose, Result, Seed};

/// A plank of 21 places; falling off ends the game, and so do so many steps.
#[derive(Clone)]
pub struct Plank {
    limit: usize,
    table: FeatureTable,
}

#[derive(Clone)]
pub struct Stand {
    place: i32,
    steps: usize,
    sway: f64,
}

/// Goes back towards the middle: button 1 to the left, 2 to the right.
pub struct Careful;

impl Plank {
    fn new(limit: usize) -> Self {
        Plank { limit, table: FeatureTable::new(21) }
    }
}

impl Space for Plank {
    type State = Stand;
    type View = Features;

    fn start(&self, episode: Episode) -> Stand {
        // The second grade sways more.
        Stand { place: 0, steps: 0, sway: if episode.index.is_multiple_of(2) { 0.4 } else { 0.5 } }
    }

    fn legal<'a>(&'a self, state: &'a Stand) -> Actions<'a> {
        if state.place.abs() > 10 || state.steps >= self.limit { Actions::NONE } else { Actions::All(4) }
    }

    fn look(&self, state: &Stand, view: &mut Features) {
        view.row = NO_ROW;
        view.dynamic.clear();
        view.dynamic.push((state.place + 10) as u32);
    }

    fn step(&self, state: &mut Stand, action: Action, seed: Seed) -> f64 {
        let draw = |i| i32::from(seed.child(Purpose::Step, i).unit() < state.sway);
        state.place += (action.0 as i32 >> 1 & 1) - (action.0 as i32 & 1) + draw(0) - draw(1);
        let slides = seed.child(Purpose::Step, 2).unit() < 0.5;
        state.place += if slides { state.place.signum() } else { 0 };
        state.steps += 1;
        f64::from(u8::from(state.place.abs() > 10))
    }

    fn actions(&self) -> usize {
        4
    }

    fn shared(&self) -> &FeatureTable {
        &self.table
    }
}

impl Expert<Plank> for Careful {
    fn action(&self, _: &Plank, state: &Stand) -> Option<Action> {
        Some(Action(match state.place {
            ..0 => 2,
            0 => 0,
            1.. => 1,
        }))
    }
}

pub struct Balance {
    plank: Plank,
}

impl Default for Balance {
    fn default() -> Self {
        Balance { plank: Plank::new(60) }
    }
}

impl Game for Balance {
    type View = Features;
    type Space = Plank;
    type Expert = Careful;

    const NAME: &'static str = "balance";
    const GOAL: Goal = Goal::Distance;

    fn space(&self) -> &Plank {
        &self.plank
    }

    fn short(&self, decisions: usize) -> Result<Plank> {
        Ok(Plank::new(decisions))
    }

    fn expert(&self) -> &Careful {
        &Careful
    }

    fn grades(&self) -> Vec<String> {
        vec!["calm".into(), "rough".into()]
    }

    fn outcome(&self, state: &Stand) -> Outcome {
        let won = f64::from(u8::from(state.steps == 60 && state.place.abs() <= 10));
        Outcome { distance: state.steps as f64, falls: 1.0 - won, won }
    }
}

/// A plan of these methods.
pub fn plan(names: &[&str]) -> Plan {
    let net = Net { units: 4, outputs: Outputs::Bits, rate: 0.05, ..Net::default() };
    let learner = CrossValidated { learner: net, folds: 3, most: 4, patience: 2 };
    let smile = |reuse, piece| Teaching::Smile(Smile { alpha: 0.3, rounds: 4, reuse, piece, ..Smile::default() });
    let method = |name: &&str| {
        let (teaching, episodes, length) = match *name {
            "supervised" => (Teaching::Supervised(Supervised { rounds: 4 }), 2, Length::Marathon(30)),
            "smile" => (smile(Reuse::None, None), 2, Length::Marathon(30)),
            "ageing" => (smile(Reuse::Ageing, Some(10)), 2, Length::Marathon(30)),
            "printed" => (smile(Reuse::Printed43, Some(10)), 2, Length::Marathon(30)),
            "dagger" => (Teaching::Dagger(Dagger { rounds: 4, ..Dagger::default() }), 2, Length::Marathon(30)),
            "forward" => (Teaching::Forward(Forward { longest: 4, ..Forward::default() }), 90, Length::Short(4)),
            _ => (Teaching::Searn(Searn { rounds: 4, ..Searn::default() }), 2, Length::Short(6)),
        };
        Method { name: name.to_string(), teaching, amount: Amount { episodes, length }, learner: learner.clone() }
    };
    Plan { game: "balance".into(), seed: 1, trainings: 1, games: 12, methods: names.iter().map(method).collect() }
}
