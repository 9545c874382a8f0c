//! The kart: at full throttle, steered through a lag, held by a limited grip.

use super::track::{HALF_WIDTH, Track};
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// Decisions a second.
pub const RATE: f64 = 15.0;
/// Steps in which the motion of one decision is computed.
const PARTS: usize = 4;
/// Seconds of each of them.
const STEP: f64 = 1.0 / (RATE * PARTS as f64);

/// The speed that the throttle tends to on a level straight, in m/s.
pub const TOP: f64 = 22.0;
/// Acceleration at rest, in m/s².
const THRUST: f64 = 10.0;
/// Seconds in which the wheels come near to what the hand asks for.
const LAG: f64 = 0.15;
/// Curvature that the nose follows with the wheels at full lock, in 1/m.
pub const LOCK: f64 = 1.0 / 9.0;
/// The most sideways acceleration that the tyres can bring, in m/s².
pub const GRIP: f64 = 28.0;
/// Turning of the course towards the nose, in 1/s for each radian between them, as far as the grip lets it.
const STIFF: f64 = 6.0;
/// Turning of the nose back to the course, in 1/s for each radian between them.
const ALIGN: f64 = 3.0;
/// Speed lost to the drift: share a second for each square radian between nose and course.
const SCRUB: f64 = 1.5;
/// Acceleration of gravity, in m/s².
const GRAVITY: f64 = 9.81;

/// How a kart stands on a road and moves. Angles are in radians, clockwise, from the direction of the road.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Car {
    /// Metres of centre line that it has passed since the start.
    pub distance: f64,
    /// Metres to the right of the centre line.
    pub side: f64,
    /// In m/s.
    pub speed: f64,
    /// Where it moves.
    pub course: f64,
    /// Where it looks; in a drift not where it moves.
    pub nose: f64,
    /// How far the wheels are turned, from -1 at full lock to the left to 1.
    pub wheel: f64,
}

impl Car {
    /// Drives on for one decision with `hand`, in [-1, 1], on the stick. Says whether the kart fell off, or turned around; then it stands where
    /// it went wrong, on the centre line and at rest.
    pub fn drive(&mut self, track: &Track, hand: f64) -> bool {
        for _ in 0..PARTS {
            self.part(track, hand);
            if self.side.abs() > HALF_WIDTH || self.course.abs() > FRAC_PI_2 {
                *self = Car { distance: self.distance, ..Car::default() };
                return true;
            }
        }
        false
    }

    fn part(&mut self, track: &Track, hand: f64) {
        let road = track.at(self.distance);
        self.wheel += (hand - self.wheel) * (STEP / LAG);
        let slip = self.nose - self.course;
        let most = GRIP / self.speed.max(1.0);
        let ahead = self.speed * self.course.cos() / (1.0 - self.side * road.bend);
        // The road turns away below the kart.
        let road_turns = road.bend * ahead;
        let climb = GRAVITY * road.slope * self.course.cos();
        self.nose += STEP * (self.speed * LOCK * self.wheel - ALIGN * slip - road_turns);
        let course = self.course;
        self.course += STEP * ((STIFF * slip).clamp(-most, most) - road_turns);
        self.distance += STEP * ahead;
        self.side += STEP * self.speed * course.sin();
        let gain = THRUST * (1.0 - self.speed / TOP) - climb - SCRUB * slip * slip * self.speed;
        self.speed = (self.speed + STEP * gain).max(0.0);
    }

    /// How far the wheels are to be turned so that the kart drives a curve of this curvature, in 1/m, where there is the grip for it.
    pub(super) fn wheel_for(curvature: f64) -> f64 {
        curvature / LOCK * (1.0 + ALIGN / STIFF)
    }

    /// The curvature, in 1/m, of the curve that the kart drives with its wheels turned so far, where there is the grip for it.
    pub(super) fn curvature_of(wheel: f64) -> f64 {
        wheel * LOCK / (1.0 + ALIGN / STIFF)
    }
}
