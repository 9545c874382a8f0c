//! How buttons become motion, against tables that were measured in another engine.

use super::common::*;
use rollin::tasks::platformer::{Buttons, COLUMNS, End, Game, Kind, Level, Mode, Tile};
use std::sync::Arc;

fn near(a: f32, b: f32, by: f32) -> bool {
    (a - b).abs() <= by
}

/// Pixels to the right in each of `frames` frames.
fn steps(game: &mut Game, buttons: Buttons, frames: usize) -> Vec<f32> {
    let step = |_| {
        let before = game.position()[0];
        game.advance(buttons);
        game.position()[0] - before
    };
    (0..frames).map(step).collect()
}

#[test]
fn speed_from_rest_and_back() {
    for (buttons, first, limit, rest) in
        [(RIGHT, [0.60, 1.13, 1.61], 5.4545, 20), (RIGHT.and(SPEED), [1.20, 2.27, 3.22], 10.909, 26)]
    {
        let mut game = standing(flat(), Mode::Fire);
        let found = steps(&mut game, buttons, 120);
        assert!(found.iter().zip(first).all(|(found, expected)| near(*found, expected, 0.006)), "{found:?}");
        assert!(near(found[119], limit, 0.001), "{}", found[119]);
        let slower = steps(&mut game, NONE, 40);
        assert_eq!(slower.iter().filter(|step| **step > 0.0).count(), rest, "{slower:?}");
    }
}

/// How high a jump goes, how many frames it is in the air and how far it gets, with the button held for `held` frames.
fn jump(game: &mut Game, held: usize, buttons: Buttons) -> (f32, usize, f32) {
    let [x, y] = game.position();
    let (mut top, mut air) = (y, 0);
    loop {
        game.advance(if air < held { buttons.and(JUMP) } else { buttons });
        air += 1;
        top = top.min(game.position()[1]);
        if game.on_ground() {
            return (y - top, air, game.position()[0] - x);
        }
    }
}

#[test]
fn jumps() {
    for (held, height, frames) in [(1, 26.1, 9), (4, 53.9, 13), (8, 66.5, 16), (12, 66.5, 16)] {
        let mut game = standing(flat(), Mode::Fire);
        let (top, air, _) = jump(&mut game, held, NONE);
        assert!(near(top, height, 0.1) && air.abs_diff(frames) <= 1, "held for {held}: {top} px, {air} frames");
    }
    for (buttons, far) in [(RIGHT, 87.0), (RIGHT.and(SPEED), 174.5)] {
        let mut game = standing(flat(), Mode::Fire);
        steps(&mut game, buttons, 100);
        let (_, _, distance) = jump(&mut game, 8, buttons);
        assert!(near(distance, far, 1.0), "{distance}");
    }
}

#[test]
fn a_jump_needs_the_button_up_before() {
    let mut game = standing(flat(), Mode::Fire);
    until(&mut game, JUMP, |game| !game.on_ground());
    until(&mut game, JUMP, |game| game.on_ground());
    (0..20).for_each(|_| game.advance(JUMP));
    assert!(game.on_ground() && !game.can_jump());
    game.advance(NONE);
    assert!(game.can_jump());
    game.advance(JUMP);
    assert!(!game.on_ground());
}

#[test]
fn hills_are_jumped_through_and_stood_on() {
    let places: Vec<_> = (4..14).map(|column| (column, FLOOR - 4)).collect();
    let mut game = ahead(built(&places, Tile::HillTop), Mode::Fire);
    until(&mut game, JUMP, |game| game.on_ground() && game.position()[1] < GROUND);
    assert_eq!(game.position()[1], 16.0 * (FLOOR - 4) as f32 - 1.0);
    // What blocks from all sides stops the jump below it: the head is at the tile's edge.
    let mut game = ahead(built(&places, Tile::Hard), Mode::Fire);
    let mut top = GROUND;
    for _ in 0..20 {
        game.advance(JUMP);
        top = top.min(game.position()[1]);
    }
    assert_eq!((top, game.tile(AHEAD, FLOOR - 4)), (16.0 * (FLOOR - 3) as f32 + 24.0, Tile::Hard));
}

#[test]
fn walls_stop_and_are_jumped_off() {
    let wall: Vec<_> = (0..FLOOR).map(|row| (8, row)).collect();
    let mut game = standing(built(&wall, Tile::Hard), Mode::Fire);
    let into = RIGHT.and(SPEED);
    steps(&mut game, into, 30);
    assert_eq!(game.position()[0], 8.0 * 16.0 - 4.0 - 1.0);
    (0..9).for_each(|_| game.advance(into.and(JUMP)));
    until(&mut game, into, |game| game.speed()[1] > 0.0 && game.can_jump());
    for _ in 0..3 {
        game.advance(into);
        // Half of it each frame, then damped, then the weight: it never gets beyond 3 / (1 - 0.425).
        assert!(!game.on_ground() && game.can_jump() && game.speed()[1] < 5.22, "{:?}", game.speed());
    }
    game.advance(into.and(JUMP));
    let [back, up] = game.speed();
    assert!(near(back, -6.0 * 0.89, 1e-5) && near(up, -12.0 * 0.85 + 3.0, 1e-5), "{back} {up}");
}

#[test]
fn levels_end_in_four_ways() {
    let short = |limit| {
        let mut level = Level::empty(20);
        (0..COLUMNS).for_each(|column| level.set(column, FLOOR, Tile::Ground));
        Game::new(Arc::new(level), Mode::Fire, limit)
    };
    let mut game = short(3000);
    until(&mut game, RIGHT, |game| game.end().is_some());
    assert!(game.end() == Some(End::Won) && game.position()[0] > 320.0);
    let over = game.clone();
    game.advance(LEFT);
    assert_eq!(game, over);
    let mut game = short(50);
    until(&mut game, RIGHT, |game| game.end().is_some());
    assert_eq!((game.end(), game.frames()), (Some(End::Late), 50));
    let mut game = Game::new(Arc::new(Level::empty(20)), Mode::Fire, 3000);
    until(&mut game, RIGHT, |game| game.end().is_some());
    assert!(game.end() == Some(End::Fell) && game.position()[1] > 256.0);
    let mut game = game_of_three();
    until(&mut game, NONE, |game| game.end().is_some());
    assert_eq!(game.end(), Some(End::Killed));
}

/// Three walkers that come one after the other.
fn game_of_three() -> Game {
    game(with(&[10, 15, 20], Kind::Walker, false), Mode::Fire)
}

#[test]
fn hurts() {
    let mut game = game_of_three();
    let mut modes = Vec::new();
    while game.end().is_none() {
        let before = game.clone();
        game.advance(NONE);
        if game.mode() != before.mode() {
            assert!(before.mode() > game.mode());
            modes.push((game.mode(), game.frames()));
            // The world skips a frame.
            let then = all(&game, Kind::Walker);
            game.advance(NONE);
            assert_eq!(all(&game, Kind::Walker), then);
        }
    }
    assert_eq!(modes.iter().map(|(mode, _)| *mode).collect::<Vec<_>>(), [Mode::Large, Mode::Small]);
    assert!(modes[1].1 - modes[0].1 > 32);
}
