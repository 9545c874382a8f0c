//! What is seen from a kart.

use crate::common::{LENGTH, answer, kart, node, start, track};
use rollin::space::{Dense, Episode, Space};
use rollin::tasks::kart::camera::{COLUMNS, NUMBERS, ROWS};
use rollin::tasks::kart::{Camera, Car, HALF_WIDTH};
use rollin::{Purpose, Seed};

#[test]
fn pictures_are_of_24_by_18_cells_within_range() {
    assert_eq!((COLUMNS, ROWS, NUMBERS), (24, 18, 1296));
    let kart = kart(1);
    assert_eq!(kart.shared().0, NUMBERS);
    let mut ride = start(&kart, 1);
    let mut view = Dense(vec![9.0; 5]);
    let mut changed = 0;
    for _ in 0..600 {
        let last = view.clone();
        kart.look(&ride, &mut view);
        assert_eq!(view.0.len(), NUMBERS);
        for cell in view.0.chunks(3) {
            assert!((0.0..=1.0).contains(&cell[0]) && cell[1].abs() <= 1.0 && cell[2].abs() <= 1.0, "{cell:?}");
        }
        changed += u32::from(view != last);
        let (action, node) = (answer(&kart, &ride, 1), node(1, &ride));
        kart.step(&mut ride, action, node);
    }
    assert!(changed > 590, "{changed}");
}

/// What was in a view before does not show.
#[test]
fn a_used_view_shows_what_a_new_one_does() {
    let kart = kart(1);
    let (mut used, mut ride) = (Dense::default(), start(&kart, 3));
    for _ in 0..50 {
        kart.look(&ride, &mut used);
        let (action, node) = (answer(&kart, &ride, 3), node(3, &ride));
        kart.step(&mut ride, action, node);
    }
    kart.look(&ride, &mut used);
    let mut new = Dense::default();
    kart.look(&ride, &mut new);
    assert_eq!(used, new);
}

/// A car anywhere on the road.
fn anywhere(i: u64) -> Car {
    let draw = |k| 2.0 * Seed::new(i).child(Purpose::Step, k).unit() - 1.0;
    let nose = 0.6 * draw(2);
    Car { distance: LENGTH * draw(0).abs(), side: HALF_WIDTH * draw(1), nose, course: nose, speed: 9.0, wheel: draw(3) }
}

/// The picture of the mirrored kart on the mirrored track is the mirrored picture.
#[test]
fn a_mirror_shows_the_mirrored_picture() {
    let track = track(LENGTH, 2);
    let (camera, mirror) = (Camera::default(), track.mirrored());
    let (mut here, mut there) = ([0.0; NUMBERS], [0.0; NUMBERS]);
    for i in 0..300 {
        let car = anywhere(i);
        let other = Car { side: -car.side, nose: -car.nose, course: -car.course, wheel: -car.wheel, ..car };
        camera.shoot(&track, &car, &mut here);
        camera.shoot(&mirror, &other, &mut there);
        let mut off = 0;
        for (row, mirrored) in here.chunks(3 * COLUMNS).zip(there.chunks(3 * COLUMNS)) {
            let cells = row.chunks(3).zip(mirrored.chunks(3).rev());
            off += cells.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| (a - b).abs() > 1e-4)).count();
        }
        // A point right on an edge may fall to either side.
        assert!(off <= 4, "car {i}: {off} cells");
    }
}

/// What is to the right is seen to the right: the further right the kart stands, the further left is the road; and the nose points where the
/// wheels do.
#[test]
fn the_picture_tells_where_the_road_is() {
    let kart = kart(1);
    let road = kart.start(Episode { index: 0, seed: Seed::new(1) });
    // Where it is straight ahead, so that the two halves of the picture are alike from the middle.
    let straight = kart.track().nodes().windows(30).position(|nodes| nodes.iter().all(|node| node.bend.abs() < 0.01));
    let distance = kart.track().spacing() * straight.expect("a straight") as f64;
    let mut cells = [0.0; NUMBERS];
    let mut light = |car: Car, rows: std::ops::Range<usize>| {
        Camera::default().shoot(kart.track(), &car, &mut cells);
        let mut halves = [0.0; 2];
        for row in rows {
            for column in 0..COLUMNS {
                halves[2 * column / COLUMNS] += cells[3 * (COLUMNS * row + column)];
            }
        }
        halves[0] - halves[1]
    };
    let mut last = f32::NEG_INFINITY;
    for side in [-2.5, -1.2, 0.0, 1.2, 2.5] {
        let balance = light(Car { distance, side, ..*road.car() }, 9..15);
        assert!(balance > last, "at {side}: {balance} after {last}");
        last = balance;
    }
    let car = Car { distance, ..Car::default() };
    let [mut left, mut right] = [[0.0; NUMBERS]; 2];
    Camera::default().shoot(kart.track(), &Car { wheel: -1.0, ..car }, &mut left);
    Camera::default().shoot(kart.track(), &Car { wheel: 1.0, ..car }, &mut right);
    // The nose is blue: its b is below zero, and the road's is not.
    let blue = |cells: &[f32; NUMBERS], column: usize| cells[3 * (COLUMNS * (ROWS - 2) + column) + 2] < -0.1;
    assert!(blue(&left, 9) && !blue(&left, 15) && blue(&right, 14) && !blue(&right, 8));
}
