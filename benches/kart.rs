//! How fast a kart drives and sees: asserts what came out, then times it.
//!
//! `cargo bench --bench kart`

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rollin::space::{Dense, Episode, Expert, Space};
use rollin::tasks::kart::{Driver, Kart, Outcome, Ride, Tracks};
use rollin::{Purpose, Seed};
use std::hint::black_box;

const LENGTH: f64 = 1380.0;
/// Decisions of the lap, and the mean of all cells' three numbers on it, times 10,000.
const EXPECTED: (u32, [f64; 3]) = (1006, [2938.0, 886.0, -881.0]);

fn tracks() -> Tracks {
    Tracks::standard().expect("the embedded grammar")
}

fn kart() -> Kart {
    Kart::new(tracks().draw(LENGTH, Seed::new(1)).expect("a road that closes"))
}

/// The decision that `driver` takes in `ride`, and the step it makes.
fn decide(kart: &Kart, driver: &Driver, ride: &mut Ride, seed: Seed) {
    let node = seed.child(Purpose::Step, u64::from(ride.t()));
    if let Some(action) = driver.answer(kart, ride, node.child(Purpose::Expert, 0)) {
        kart.step(ride, action, node);
    }
}

/// A lap of the driver; `watch` is given every state.
fn lap(kart: &Kart, number: u64, mut watch: impl FnMut(&Ride)) -> Outcome {
    let (driver, seed) = (Driver::default(), Seed::new(number));
    let mut ride = kart.start(Episode { index: 0, seed });
    while !kart.legal(&ride).is_empty() {
        watch(&ride);
        decide(kart, &driver, &mut ride, seed);
    }
    kart.outcome(&ride)
}

fn decisions(c: &mut Criterion) {
    let kart = kart();
    let mut view = Dense::default();
    let mut sums = [0.0f64; 3];
    let outcome = lap(&kart, 1, |ride| {
        kart.look(ride, &mut view);
        view.0.chunks(3).for_each(|cell| (0..3).for_each(|k| sums[k] += f64::from(cell[k])));
    });
    let cells = f64::from(outcome.decisions) * 432.0;
    let means = sums.map(|sum| (1e4 * sum / cells).round());
    println!("{outcome:?}, mean L, a, b times 10,000: {means:?}");
    assert_eq!((outcome.falls, outcome.finished), (0, true));
    assert_eq!((outcome.decisions, means), EXPECTED);

    let mut group = c.benchmark_group("kart");
    group.throughput(Throughput::Elements(u64::from(outcome.decisions)));
    group.bench_function("rendered decisions", |b| {
        b.iter(|| black_box(lap(&kart, 1, |ride| kart.look(ride, black_box(&mut view)))));
    });
    group.bench_function("decisions", |b| b.iter(|| black_box(lap(&kart, 1, |_| ()))));
    group.finish();
}

fn copies(c: &mut Criterion) {
    let kart = kart();
    let (driver, seed) = (Driver::default(), Seed::new(1));
    let mut ride = kart.start(Episode { index: 0, seed });
    (0..300).for_each(|_| decide(&kart, &driver, &mut ride, seed));
    let ahead = || {
        let mut copy = black_box(ride);
        (0..15).for_each(|_| decide(&kart, &driver, &mut copy, seed));
        copy
    };
    assert_eq!((ahead(), ahead().t()), (ahead(), 315));
    c.bench_function("kart/a copy and a second of driving", |b| b.iter(|| black_box(ahead())));
}

fn drawing(c: &mut Criterion) {
    let tracks = tracks();
    let track = tracks.draw(LENGTH, Seed::new(1)).expect("a road that closes");
    assert_eq!(track, *kart().track());
    c.bench_function("kart/a track", |b| b.iter(|| black_box(tracks.draw(LENGTH, Seed::new(1)))));
}

criterion_group!(benches, decisions, copies, drawing);
criterion_main!(benches);
