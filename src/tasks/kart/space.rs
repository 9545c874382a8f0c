//! Driving as a space.

use super::camera::{self, Camera};
use super::car::{Car, RATE, TOP};
use super::driver::Driver;
use super::track::Track;
use crate::error::{Error, Result};
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Actions, Dense, Episode, Imitation, Space, Width};
use serde::{Deserialize, Serialize};

/// How many ways there are to hold the stick.
pub const STICKS: u32 = 15;
/// The stick's end to the left; its end to the right is one less than the opposite.
const FULL: f64 = 32768.0;
/// Decisions after which the driver sees what happened.
const DELAY: usize = 2;
/// Up to this, in radians, a bump in the road turns the nose at top speed.
const BUMP: f64 = 0.003;

/// The joystick's number, from -32768 to 32767, in the middle of the class that `action` is: negative to the left.
pub fn joystick(action: Action) -> i32 {
    (FULL * stick(action)).round() as i32
}

/// Where `action` holds the stick, from -1 to 1.
pub(super) fn stick(action: Action) -> f64 {
    f64::from(2 * action.0 as i32 + 1 - STICKS as i32) / f64::from(STICKS)
}

/// The class of the joystick's numbers that holds `stick`; beyond -1 and 1 the last.
pub(super) fn turn(stick: f64) -> Action {
    let class = (0.5 * (stick + 1.0) * f64::from(STICKS)).floor();
    Action(class.clamp(0.0, f64::from(STICKS - 1)) as u32)
}

/// Driving one lap of a track: 15 decisions a second about the stick, at full throttle. A fall costs 1, all else nothing.
///
/// An episode starts at the start, at rest, a little off the line, as its seed says; it ends after a lap or, where that comes first, after
/// [`Kart::limit`] decisions. All actions are always legal.
#[derive(Clone, Debug)]
pub struct Kart {
    track: Track,
    camera: Camera,
    limit: u32,
}

/// Where a lap stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ride {
    car: Car,
    /// The kart as it was before the last decisions, the earliest first.
    before: [Car; DELAY],
    hand: Action,
    t: u32,
    falls: u32,
    seed: Seed,
}

/// What a ride came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// How often the kart fell off and was put back.
    pub falls: u32,
    /// Metres of centre line that it passed, at most a lap's.
    pub distance: f64,
    /// Decisions taken.
    pub decisions: u32,
    /// Whether the lap was finished.
    pub finished: bool,
}

/// A moment of a ride as a replay draws it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Metres ahead and to the right of the start, as seen there.
    pub at: [f64; 2],
    /// Where the nose points, in radians, clockwise; 0 as at the start.
    pub heading: f64,
    /// In m/s.
    pub speed: f64,
    /// How far the wheels are turned, from -1 to 1.
    pub wheel: f64,
    /// Falls so far.
    pub falls: u32,
    /// Metres of the lap so far.
    pub distance: f64,
}

impl Kart {
    /// Laps of `track`, each at most twice as many decisions as it takes at top speed.
    pub fn new(track: Track) -> Self {
        let limit = (2.0 * track.length() / TOP * RATE).ceil() as u32;
        Kart { track, camera: Camera::default(), limit }
    }

    /// The same with at most `decisions` an episode.
    ///
    /// # Errors
    /// When there is to be none.
    pub fn limited(self, decisions: u32) -> Result<Self> {
        if decisions == 0 {
            return Err(Error::argument("decisions", decisions, "at least 1"));
        }
        Ok(Kart { limit: decisions, ..self })
    }

    /// The track.
    pub fn track(&self) -> &Track {
        &self.track
    }

    /// The most decisions of an episode.
    pub fn limit(&self) -> u32 {
        self.limit
    }

    /// The problem of imitating the [`Driver`], with so many laps a round.
    pub fn problem(self, laps: usize) -> Imitation<Self, Driver> {
        Imitation { space: self, expert: Driver::default(), episodes: laps }
    }

    /// What `ride` has come to so far.
    pub fn outcome(&self, ride: &Ride) -> Outcome {
        let finished = ride.car.distance >= self.track.length();
        let distance = ride.car.distance.min(self.track.length());
        Outcome { falls: ride.falls, distance, decisions: ride.t, finished }
    }

    /// The moment at which `ride` stands.
    pub fn frame(&self, ride: &Ride) -> Frame {
        let Car { distance, side, speed, nose, wheel, .. } = ride.car;
        let road = self.track.at(distance);
        let heading = road.heading + nose;
        Frame { at: road.beside(side), heading, speed, wheel, falls: ride.falls, distance }
    }

    /// What is seen in `ride`: 24 by 18 cells of three numbers, row after row from the top left. See [`camera`].
    pub fn image(&self, ride: &Ride, cells: &mut [f32; camera::NUMBERS]) {
        self.camera.shoot(&self.track, &ride.car, cells);
    }
}

impl Ride {
    /// The kart.
    pub fn car(&self) -> &Car {
        &self.car
    }

    /// The last decision: where the hand is.
    pub fn hand(&self) -> Action {
        self.hand
    }

    /// How often the kart has fallen.
    pub fn falls(&self) -> u32 {
        self.falls
    }

    /// Decisions so far.
    pub fn t(&self) -> u32 {
        self.t
    }

    /// The node that what is random about the driver hangs below.
    pub(super) fn seed(&self) -> Seed {
        self.seed
    }

    /// The kart as the driver has seen it, and how many decisions ago that was.
    pub(super) fn seen(&self) -> (&Car, f64) {
        (&self.before[0], DELAY as f64)
    }
}

impl Space for Kart {
    type State = Ride;
    type View = Dense;

    fn start(&self, episode: Episode) -> Ride {
        let draw = |i| 2.0 * episode.seed.child(Purpose::Step, u64::MAX - i).unit() - 1.0;
        let car = Car { side: draw(0), course: 0.05 * draw(1), nose: 0.05 * draw(1), ..Car::default() };
        Ride { car, before: [car; DELAY], hand: turn(0.0), t: 0, falls: 0, seed: episode.seed }
    }

    fn legal<'a>(&'a self, ride: &'a Ride) -> Actions<'a> {
        let over = ride.t >= self.limit || ride.car.distance >= self.track.length();
        if over { Actions::NONE } else { Actions::All(STICKS) }
    }

    fn look(&self, ride: &Ride, view: &mut Dense) {
        view.0.resize(camera::NUMBERS, 0.0);
        if let Ok(cells) = view.0.as_mut_slice().try_into() {
            self.image(ride, cells);
        }
    }

    fn step(&self, ride: &mut Ride, action: Action, seed: Seed) -> f64 {
        ride.before.rotate_left(1);
        ride.before[DELAY - 1] = ride.car;
        ride.hand = action;
        ride.t += 1;
        ride.car.nose += BUMP * (2.0 * seed.child(Purpose::Step, 0).unit() - 1.0) * ride.car.speed / TOP;
        if !ride.car.drive(&self.track, stick(action)) {
            return 0.0;
        }
        // Whoever is put back on the road looks anew, with the hand off the stick.
        ride.falls += 1;
        (ride.before, ride.hand) = ([ride.car; DELAY], turn(0.0));
        1.0
    }

    fn actions(&self) -> usize {
        STICKS as usize
    }

    /// Known where no lap can end before the limit.
    fn horizon(&self, _: usize) -> Option<usize> {
        // On the inside of bends and downhill one may be somewhat faster than top speed on the centre line.
        let fastest = self.track.length() / (2.0 * TOP) * RATE;
        (f64::from(self.limit) < fastest).then_some(self.limit as usize)
    }

    fn shared(&self) -> &Width {
        &camera::WIDTH
    }
}
