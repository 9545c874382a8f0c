//! How a kart drives, and how the expert drives it.

use crate::common::{LENGTH, answer, fixed, kart, lap, node, start, track};
use proptest::prelude::*;
use rayon::ThreadPoolBuilder;
use rollin::policy::Follow;
use rollin::roll::perform;
use rollin::space::{Action, Expert, Space};
use rollin::tasks::kart::{Car, Driver, GRIP, HALF_WIDTH, Kart, RATE, Ride, STICKS, TOP, Track, Tracks, joystick};
use rollin::{Purpose, Seed};

/// Any action, which one hanging below the step.
fn whatever(seed: u64, ride: &Ride) -> Action {
    Action((node(seed, ride).child(Purpose::Deviation, 0).unit() * f64::from(STICKS)) as u32)
}

#[test]
fn the_stick_is_cut_into_fifteen_classes() {
    let numbers: Vec<i32> = (0..STICKS).map(|class| joystick(Action(class))).collect();
    assert_eq!([numbers[0], numbers[7], numbers[14]], [-30583, 0, 30583]);
    // Classes of 65536 / 15 numbers, whose middles these are.
    assert!(numbers.windows(2).all(|pair| (4368..=4370).contains(&(pair[1] - pair[0]))));
}

/// Closed, 10,000 m of straight are a circle.
fn circle() -> Track {
    let straight = Tracks::parse("t", "start A; A -> straight-1000 end;").expect("a grammar");
    straight.draw(10_000.0, Seed::new(1)).expect("a circle")
}

/// On a level road the speed is 22 (1 - exp(-t / 2.2)) m/s after t seconds, worked by hand from 10 m/s² at rest and 22 m/s at most.
#[test]
fn the_throttle_brings_top_speed() {
    let circle = circle();
    let bend = std::f64::consts::TAU / 10_000.0;
    assert!(circle.nodes().iter().all(|node| (node.bend.abs() - bend).abs() < 1e-9 && node.slope == 0.0));
    let mut car = Car::default();
    for t in 1..=300 {
        assert!(!car.drive(&circle, 13.5 * circle.at(0.0).bend));
        let expected = TOP * (1.0 - (-f64::from(t) / (2.2 * RATE)).exp());
        assert!((car.speed / expected - 1.0).abs() < 0.02, "{} after {t} decisions and not {expected}", car.speed);
    }
    assert!((car.speed - TOP).abs() < 0.01);
}

/// In a drift the course turns as fast as the grip allows, and no faster: by its share of the speed.
#[test]
fn the_grip_limits_how_tight_one_turns() {
    let track = circle();
    for i in 0..50 {
        for nose in [-0.5, 0.5] {
            let distance = 200.0 * f64::from(i);
            let mut car = Car { distance, nose, speed: TOP, ..Car::default() };
            let before = track.at(distance).heading;
            assert!(!car.drive(&track, 2.0 * nose));
            let turned = car.course + track.at(car.distance).heading - before;
            // The start of the track is a whole turn away from its end.
            let turned = (turned + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
            // The drift takes some of the speed, and slower one turns tighter.
            let share = turned * nose.signum() * RATE * TOP / GRIP;
            assert!((1.0..1.04).contains(&share), "at {distance}, nose {nose}: {share}");
        }
    }
}

#[test]
fn the_driver_almost_never_falls() {
    let karts = [1, 2, 3].map(kart);
    for (i, kart) in karts.iter().enumerate() {
        let laps: Vec<_> = (0..20).map(|seed| lap(kart, seed, |ride| answer(kart, ride, seed))).collect();
        let falls: u32 = laps.iter().map(|lap| lap.falls).sum();
        assert!(falls <= 10, "track {i}: {falls} falls in 20 laps");
        for lap in laps {
            assert!(lap.finished && lap.distance == LENGTH, "{lap:?}");
            assert!((950..=1150).contains(&lap.decisions), "{lap:?}");
        }
    }
}

/// Other ways to drive do fall: at full lock, straight on, and with any stick at all.
#[test]
fn who_does_not_steer_by_the_road_falls() {
    let kart = kart(1);
    for action in [0, 7, 14] {
        let outcome = lap(&kart, 1, |_| Action(action));
        assert!(outcome.falls > 20, "{action}: {outcome:?}");
        assert!(outcome.finished || outcome.decisions == kart.limit());
    }
    assert!(lap(&kart, 2, |ride| whatever(2, ride)).falls > 20);
}

/// From wherever three decisions of other driving lead to without a fall, the driver mostly comes back to the road's middle.
#[test]
fn the_driver_recovers() {
    let kart = kart(1);
    let (mut tried, mut fell) = (0, 0);
    for seed in 0..120 {
        let mut ride = start(&kart, seed);
        let go = |ride: &mut Ride, action| kart.step(ride, action, node(seed, ride));
        (0..80 + 3 * seed).for_each(|_| {
            let action = answer(&kart, &ride, seed);
            go(&mut ride, action);
        });
        let stray = Action((Seed::new(seed).unit() * f64::from(STICKS)) as u32);
        let cost: f64 = (0..3).map(|_| go(&mut ride, stray)).sum();
        if cost > 0.0 {
            continue;
        }
        tried += 1;
        let cost: f64 = (0..45)
            .map(|_| {
                let action = answer(&kart, &ride, seed);
                go(&mut ride, action)
            })
            .sum();
        fell += u32::from(cost > 0.0);
    }
    assert!(tried > 60 && 2 * fell < tried, "{fell} of {tried}");
}

/// The hand's speed is limited, from wherever others have left it.
#[test]
fn the_hand_is_smooth() {
    let kart = kart(4);
    let driver = Driver::default();
    let mut ride = start(&kart, 1);
    // The furthest it moves, trembles and is rounded, in classes.
    let most = ((driver.quick + driver.tremor) * f64::from(STICKS) / 2.0 + 0.5).ceil() as u32;
    for _ in 0..1000 {
        let action = answer(&kart, &ride, 1);
        assert!(action.0.abs_diff(ride.hand().0) <= most, "{action:?} after {:?}", ride.hand());
        let action = if ride.t() % 50 < 40 { action } else { whatever(1, &ride) };
        let node = node(1, &ride);
        kart.step(&mut ride, action, node);
    }
}

#[test]
fn a_copy_run_ahead_equals_the_original() {
    let kart = kart(5);
    let mut ride = start(&kart, 7);
    for i in 0..600 {
        if i % 100 == 50 {
            let (mut one, mut other) = (ride, ride);
            for _ in 0..60 {
                for copy in [&mut one, &mut other] {
                    let (action, node) = (whatever(7, copy), node(7, copy));
                    kart.step(copy, action, node);
                }
            }
            assert_eq!(one, other);
            assert_eq!(kart.frame(&one), kart.frame(&other));
        }
        let (action, node) = (answer(&kart, &ride, 7), node(7, &ride));
        kart.step(&mut ride, action, node);
    }
    // And the copies have left no trace.
    let mut again = start(&kart, 7);
    (0..600).for_each(|_| {
        let (action, node) = (answer(&kart, &again, 7), node(7, &again));
        kart.step(&mut again, action, node);
    });
    assert_eq!(again, ride);
}

#[test]
fn seeds_matter_and_threads_do_not() {
    let problem = kart(1).problem(6);
    let run = |threads, seed| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let (done, ledger) = pool.install(|| perform(&problem, &Follow, Seed::new(seed)));
        (done.actions, done.costs, ledger)
    };
    let one = run(1, 1);
    assert!(one == run(3, 1));
    assert!(one.0 != run(1, 2).0);
    assert_eq!(one.2.steps, one.0.len() as u64);
}

#[test]
fn episodes_have_a_limit() {
    let whole = kart(1);
    // 1380 m at 22 m/s take 62.7 s; twice that at 15 decisions a second.
    assert_eq!((whole.limit(), whole.horizon(0)), (1882, None));
    let short = kart(1).limited(40).expect("a limit");
    assert_eq!(short.horizon(0), Some(40));
    let outcome = lap(&short, 1, |ride| answer(&short, ride, 1));
    assert_eq!((outcome.decisions, outcome.finished), (40, false));
    assert!(kart(1).limited(0).is_err());
}

/// Left and right are alike: in a mirror a kart drives as in the open.
#[test]
fn a_mirrored_kart_drives_the_mirrored_way() {
    let track = track(LENGTH, 6);
    let mirror = track.mirrored();
    let (mut car, mut other) = (Car::default(), Car::default());
    for i in 0..2000u64 {
        let hand = (2.0 * Seed::new(1).child(Purpose::Step, i / 5).unit() - 1.0) * 0.7;
        assert_eq!(car.drive(&track, hand), other.drive(&mirror, -hand));
        let expected = Car { side: -car.side, course: -car.course, nose: -car.nose, wheel: -car.wheel, ..car };
        assert_eq!(other, expected);
    }
}

proptest! {
    #![proptest_config(fixed(40))]

    /// Whoever drives is on the road after each decision, with finite numbers, and an episode ends.
    #[test]
    fn every_ride_stays_on_the_road(track in 0..50u64, seed in 0..1000u64, share in 0.0..1.0f64) {
        let kart: Kart = kart(track);
        let mut ride = start(&kart, seed);
        let mut last = 0.0;
        while !kart.legal(&ride).is_empty() {
            let astray = node(seed, &ride).child(Purpose::Deviation, 1).unit() < share;
            let action = if astray { whatever(seed, &ride) } else { answer(&kart, &ride, seed) };
            prop_assert!(Driver::default().action(&kart, &ride).is_some_and(|action| action.0 < STICKS));
            let node = node(seed, &ride);
            let cost = kart.step(&mut ride, action, node);
            let car = ride.car();
            prop_assert!(car.side.abs() <= HALF_WIDTH && car.course.abs() < 1.6 && car.wheel.abs() <= 1.0);
            prop_assert!(car.distance >= last && (0.0..25.0).contains(&car.speed), "{:?}", car);
            prop_assert!(cost == 0.0 || (car.speed, car.side, car.nose) == (0.0, 0.0, 0.0));
            last = car.distance;
        }
        prop_assert!(ride.t() <= kart.limit());
    }
}
