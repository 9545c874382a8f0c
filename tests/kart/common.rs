//! Tracks, and rides on them.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rollin::space::{Action, Episode, Expert, Space};
use rollin::tasks::kart::{Driver, Kart, Outcome, Ride, Track, Tracks};
use rollin::{Purpose, Seed};

/// `cases` cases that are the same in every run.
pub fn fixed(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(2010), failure_persistence: None, ..ProptestConfig::default() }
}

/// The lap that the experiments drive: about 1,000 decisions.
pub const LENGTH: f64 = 1380.0;

pub fn track(length: f64, seed: u64) -> Track {
    Tracks::standard().expect("the embedded grammar").draw(length, Seed::new(seed)).expect("a road that closes")
}

pub fn kart(seed: u64) -> Kart {
    Kart::new(track(LENGTH, seed))
}

pub fn start(kart: &Kart, seed: u64) -> Ride {
    kart.start(Episode { index: 0, seed: Seed::new(seed) })
}

/// What is random about the step at which `ride` stands.
pub fn node(seed: u64, ride: &Ride) -> Seed {
    Seed::new(seed).child(Purpose::Step, u64::from(ride.t()))
}

/// What the driver does, with its hand trembling.
pub fn answer(kart: &Kart, ride: &Ride, seed: u64) -> Action {
    let node = node(seed, ride).child(Purpose::Expert, 0);
    Driver::default().answer(kart, ride, node).expect("the driver always answers")
}

/// A whole episode; `drive` says what to do.
pub fn lap(kart: &Kart, seed: u64, mut drive: impl FnMut(&Ride) -> Action) -> Outcome {
    let mut ride = start(kart, seed);
    let mut cost = 0.0;
    while !kart.legal(&ride).is_empty() {
        let action = drive(&ride);
        let node = node(seed, &ride);
        cost += kart.step(&mut ride, action, node);
    }
    let outcome = kart.outcome(&ride);
    assert_eq!(cost, f64::from(outcome.falls), "a fall costs 1, all else nothing");
    outcome
}
