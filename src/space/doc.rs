//! A small space for the examples in this documentation: a walker that has to follow a beacon, in a world that nobody can put back.

use super::{Action, Actions, Episode, Expert, FeatureTable, Features, NO_ROW, Space};
use crate::seed::{Purpose, Seed};
use std::sync::LazyLock;

/// A world whose states cannot be cloned, as the real one's cannot.
///
/// For ten steps a beacon stands at one of three places and the walker goes to one of three. It sees where the beacon
/// is and where it stands itself; a step to a place without the beacon costs 1.
#[derive(Clone, Copy, Debug)]
pub struct RealWorld;

/// A moment of the [`RealWorld`]: deliberately not `Clone`.
#[derive(Debug)]
pub struct Moment {
    t: usize,
    beacon: u32,
    walker: u32,
}

/// The expert who goes where the beacon is.
#[derive(Clone, Copy, Debug)]
pub struct Follow;

static NINE: LazyLock<FeatureTable> = LazyLock::new(|| FeatureTable::new(9));

impl Space for RealWorld {
    type State = Moment;
    type View = Features;

    fn start(&self, episode: Episode) -> Moment {
        Moment { t: 0, beacon: (episode.seed.unit() * 3.0) as u32, walker: 0 }
    }

    fn legal<'a>(&'a self, state: &'a Moment) -> Actions<'a> {
        if state.t < 10 { Actions::All(3) } else { Actions::NONE }
    }

    fn look(&self, state: &Moment, view: &mut Features) {
        view.row = NO_ROW;
        view.dynamic.clear();
        view.dynamic.push(3 * state.beacon + state.walker);
    }

    fn step(&self, state: &mut Moment, action: Action, seed: Seed) -> f64 {
        let cost = f64::from(action.0 != state.beacon);
        state.t += 1;
        state.walker = action.0;
        state.beacon = (seed.child(Purpose::Step, 0).unit() * 3.0) as u32;
        cost
    }

    fn actions(&self) -> usize {
        3
    }

    fn horizon(&self, _: usize) -> Option<usize> {
        Some(10)
    }

    fn shared(&self) -> &FeatureTable {
        &NINE
    }
}

impl Expert<RealWorld> for Follow {
    fn action(&self, _: &RealWorld, state: &Moment) -> Option<Action> {
        Some(Action(state.beacon))
    }
}
