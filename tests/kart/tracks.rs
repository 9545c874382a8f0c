//! Tracks close, are as long as is said, and are refused where they are none.

use crate::common::{LENGTH, fixed, track};
use proptest::prelude::*;
use rollin::Seed;
use rollin::tasks::kart::{GRAMMAR, HALF_WIDTH, Track, Tracks};
use std::f64::consts::TAU;

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// From node to node, also from the last to the first, it is as far as is said, in the direction of the road and up its slope.
fn check(track: &Track, length: f64) {
    let nodes = track.nodes();
    let n = nodes.len();
    assert!((track.length() - length).abs() < 1e-9 && (track.spacing() - 2.0).abs() < 0.1);
    let mut turned = 0.0;
    for (i, node) in nodes.iter().enumerate() {
        let next = nodes[(i + 1) % n];
        // A chord is shorter than its arc by (arc / radius)² / 24 of it.
        let chord = distance(node.at, next.at);
        assert!(chord <= track.spacing() + 1e-6 && chord > 0.999 * track.spacing(), "node {i}: {chord}");
        let turn = 0.5 * (node.bend + next.bend) * track.spacing();
        let heading = (next.at[1] - node.at[1]).atan2(next.at[0] - node.at[0]);
        let off = (heading - node.heading - 0.5 * turn).rem_euclid(TAU);
        assert!(off.min(TAU - off) < 1e-6, "node {i}: {off}");
        let up = 0.5 * (node.slope + next.slope) * track.spacing();
        assert!((next.height - node.height - up).abs() < 1e-9, "node {i}");
        assert!(node.bend.abs() < 1.0 / 13.0 + 1e-12);
        turned += turn;
    }
    assert!((turned.abs() - TAU).abs() < 1e-9, "{turned}");
}

#[test]
fn tracks_close_and_are_as_long_as_is_said() {
    for seed in 0..20 {
        check(&track(LENGTH, seed), LENGTH);
    }
    check(&track(200.0, 1), 200.0);
    check(&track(2718.28, 1), 2718.28);
}

/// Two pieces of road are nowhere nearer than the road is wide, unless little road lies between them.
#[test]
fn tracks_do_not_touch_themselves() {
    for seed in 0..20 {
        let track = track(LENGTH, seed);
        let (nodes, n) = (track.nodes(), track.nodes().len());
        for i in 0..n {
            for j in 0..i {
                let between = track.spacing() * (i - j).min(n + j - i) as f64;
                let apart = distance(nodes[i].at, nodes[j].at);
                assert!(between < 30.0 || apart > 2.0 * HALF_WIDTH, "seed {seed}: {between} m on, {apart} m away");
            }
        }
    }
}

#[test]
fn tracks_hang_below_their_seed() {
    assert_eq!(track(LENGTH, 1), track(LENGTH, 1));
    assert_ne!(track(LENGTH, 1), track(LENGTH, 2));
}

#[test]
fn the_centre_line_goes_on_lap_after_lap() {
    let track = track(LENGTH, 3);
    for s in [0.0, 1.0, 17.3, 650.0, LENGTH - 0.001] {
        let here = track.at(s);
        for laps in [-2.0, 1.0, 5.0] {
            let there = track.at(s + laps * LENGTH);
            assert!(distance(here.at, there.at) < 1e-6 && (here.bend - there.bend).abs() < 1e-6);
        }
        assert!(distance(here.beside(-2.0), here.beside(1.0)) - 3.0 < 1e-9);
    }
    let (last, first) = (track.at(LENGTH - 1e-6), track.at(0.0));
    assert!(distance(last.at, first.at) < 1e-5 && (last.height - first.height).abs() < 1e-5);
    assert_eq!(track.outline().len(), track.nodes().len());
    assert_eq!(track.mirrored().mirrored(), track);
}

#[test]
fn what_is_no_track_is_refused_with_its_place() {
    for (text, expected) in [
        ("start A;\nA -> straight-60 B;", "t:2:18: nonterminal `B` is not defined"),
        ("start A;\nA -> { straight-60 left-90 } end;", "t:2:27: `left-90` ends; expected a piece of a road such as"),
        ("start A;\nwords w = straight-60 bump;\nA -> @w end;", "t:2:23: found `bump` in `bump`; expected a piece"),
        ("start A;\nA -> right-90-14 end;", "t:2:15: 14 in `right-90-14`; expected from 15 to 1000 metres of radius"),
        ("start A;\nA -> straight-60 end", "t:2:21: the text ends; expected"),
        ("", "t:1:1: no `start`"),
    ] {
        let error = Tracks::parse("t", text).expect_err(text).to_string();
        assert!(error.starts_with(expected), "{error}\n  not {expected}");
    }
    assert!(Tracks::read("no/such/file").expect_err("no file").to_string().starts_with("cannot read no/such/file"));
}

#[test]
fn roads_that_cannot_be_are_refused() {
    let tracks = Tracks::parse("t", GRAMMAR).expect("the embedded grammar");
    for length in [0.0, -5.0, 199.0, 1e5, f64::NAN, f64::INFINITY] {
        let error = tracks.draw(length, Seed::new(1)).expect_err("no lap").to_string();
        assert!(error.starts_with(&format!("length is {length}, but must be from 200 to 10000")), "{error}");
    }
    // Round and round: a road of many turns cannot be bent to one without touching itself.
    let round = Tracks::parse("t", "start A; A -> right-180-15 { A*9 end };").expect("a grammar");
    let drawn = round.draw(3000.0, Seed::new(1));
    drawn.iter().for_each(|track| check(track, 3000.0));
}

proptest! {
    #![proptest_config(fixed(60))]

    /// Whatever closes is a track, and nothing hangs.
    #[test]
    fn grammars_make_tracks_or_errors(
        words in prop::collection::vec("(straight-[1-9]0?|(left|right)-[1-9]0-[2-9]0)(-up-[0-3])?", 1..5),
        length in 200.0..900.0,
        seed in 0..1000u64,
    ) {
        let list: Vec<String> = words.iter().enumerate().map(|(i, word)| format!("{word}*{}", i + 1)).collect();
        let text = format!("start A; A -> {{ {} }} {{ A*3 end }};", list.join(" "));
        if let Ok(tracks) = Tracks::parse("t", &text) && let Ok(track) = tracks.draw(length, Seed::new(seed)) {
            check(&track, length);
        }
    }

    #[test]
    fn no_text_is_a_panic(text in "(start A;|A ->|straight-9|left-9-99|-up-1| end|;| |\\PC){0,12}") {
        let _ = Tracks::parse("t", &text);
    }
}
