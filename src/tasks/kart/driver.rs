//! The expert: a driver with eyes, a hand and their faults.

use super::car::{Car, RATE};
use super::space::{Kart, Ride, stick, turn};
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Expert};
use serde::{Deserialize, Serialize};

/// A human-like driver who knows the track.
///
/// It steers for a point on the road ahead, as one who pursues it would (pure pursuit), from where it saw the kart a moment ago; bends it cuts a
/// little. Its hand moves towards what it wants with a limited speed, leaves small errors alone until they have grown, and trembles; and the line
/// that it aims at wanders. What it did and saw before is part of the state, so it answers anywhere, also for a state that others have driven to,
/// and also in a recovery: there, it has their hand on the stick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Driver {
    /// Seconds of driving from the kart to the point that it steers for.
    pub reach: f64,
    /// The hand's fastest movement, in full deflections a decision.
    pub quick: f64,
    /// Errors of the stick up to this are left alone, in full deflections.
    pub lazy: f64,
    /// The trembling of the hand: at most this to either side, in full deflections.
    pub tremor: f64,
    /// How far the line wanders to either side, in metres.
    pub wander: f64,
}

impl Default for Driver {
    fn default() -> Self {
        Driver { reach: 0.7, quick: 0.3, lazy: 0.05, tremor: 0.02, wander: 0.15 }
    }
}

/// Metres from the centre line towards the inside of a bend, for each 1/m of curvature.
const CUT: f64 = 30.0;
/// Metres from the centre line that it aims at, at most.
const EDGE: f64 = 2.0;
/// Decisions in which the line wanders from one place to the next.
const MOOD: u32 = 24;
/// The least distance to the point that it steers for, in metres.
const NEAREST: f64 = 7.0;

impl Driver {
    /// Where it wants the stick, from -1 to 1, before its hand's faults.
    fn wish(&self, kart: &Kart, ride: &Ride) -> f64 {
        let track = kart.track();
        let (seen, since) = ride.seen();
        // It knows that it has driven on since, and how it held the stick, but not what came of that.
        let passed = seen.speed * since / RATE;
        let Car { distance, side, course, .. } = seen;
        let road = track.at(*distance);
        let turned = passed * (Car::curvature_of(stick(ride.hand())) - road.bend);
        let between = course + 0.5 * turned;
        let (distance, side) = (distance + passed * between.cos(), side + passed * between.sin());
        let reach = (self.reach * seen.speed).max(NEAREST);
        let (here, there) = (track.at(distance), track.at(distance + reach));
        let line = CUT * there.bend + self.wander * self.mood(ride);
        let ([x, y], [to_x, to_y]) = (here.beside(side), there.beside(line.clamp(-EDGE, EDGE)));
        let (sin, cos) = (here.heading + course + turned).sin_cos();
        let (ahead, right) = ((to_x - x) * cos + (to_y - y) * sin, (to_y - y) * cos - (to_x - x) * sin);
        // The circle through the kart, along its course, and the point.
        let curvature = 2.0 * right / (ahead * ahead + right * right).max(1.0);
        Car::wheel_for(curvature).clamp(-1.0, 1.0)
    }

    /// Where the line is between -1 and 1: from one random place to the next, smoothly.
    fn mood(&self, ride: &Ride) -> f64 {
        let (stretch, part) = (ride.t() / MOOD, f64::from(ride.t() % MOOD) / f64::from(MOOD));
        let place = |i: u32| 2.0 * ride.seed().child(Purpose::Expert, u64::from(i)).unit() - 1.0;
        let smooth = part * part * (3.0 - 2.0 * part);
        place(stretch) + smooth * (place(stretch + 1) - place(stretch))
    }

    fn hand(&self, kart: &Kart, ride: &Ride, tremble: f64) -> Action {
        let hand = stick(ride.hand());
        let error = self.wish(kart, ride) - hand;
        let moved = if error.abs() <= self.lazy { 0.0 } else { error.clamp(-self.quick, self.quick) };
        turn(hand + moved + self.tremor * tremble)
    }
}

impl Expert<Kart> for Driver {
    /// With a hand that does not tremble.
    fn action(&self, kart: &Kart, ride: &Ride) -> Option<Action> {
        Some(self.hand(kart, ride, 0.0))
    }

    fn answer(&self, kart: &Kart, ride: &Ride, seed: Seed) -> Option<Action> {
        Some(self.hand(kart, ride, 2.0 * seed.unit() - 1.0))
    }
}
