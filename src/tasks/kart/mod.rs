//! Driving a kart by what is seen, after the first experiment of Ross & Bagnell (2010, section 5, Super Tux Kart).
//!
//! A [`Track`] floats in space: whoever leaves it falls, and is put back on its centre line at rest. The throttle is fixed; 15 times a second
//! a policy holds the stick in one of 15 ways, and all it sees is an image of 24 by 18 cells ([`camera`]). The expert ([`Driver`]) knows the track
//! and drives as people do: late, with a hand of limited speed, on a wandering line.
//!
//! ```
//! use rollin::Seed;
//! use rollin::space::{Episode, Expert, Space};
//! use rollin::tasks::kart::{Driver, Kart, Tracks};
//!
//! let kart = Kart::new(Tracks::standard()?.draw(1380.0, Seed::new(1))?);
//! let seed = Seed::new(2);
//! let mut ride = kart.start(Episode { index: 0, seed });
//! while let (false, Some(action)) = (kart.legal(&ride).is_empty(), Driver::default().action(&kart, &ride)) {
//!     let step = seed.child(rollin::Purpose::Step, u64::from(ride.t()));
//!     kart.step(&mut ride, action, step);
//! }
//! let outcome = kart.outcome(&ride);
//! assert!(outcome.finished && outcome.falls <= 1);
//! assert!((900..1200).contains(&outcome.decisions)); // a lap, 15 decisions a second
//! # Ok::<(), rollin::Error>(())
//! ```

pub mod camera;
mod car;
mod driver;
mod paint;
mod space;
mod track;

pub use camera::Camera;
pub use car::{Car, GRIP, LOCK, RATE, TOP};
pub use driver::Driver;
pub use space::{Frame, Kart, Outcome, Ride, STICKS, joystick};
pub use track::{GRAMMAR, HALF_WIDTH, Node, Track, Tracks};
