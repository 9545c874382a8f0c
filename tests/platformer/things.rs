//! What else moves, one kind after the other.

use super::common::*;
use rollin::tasks::platformer::{Game, Kind, Mode, Scene, Spawn, Tile};

#[test]
fn walkers_walk_and_turn() {
    for kind in [Kind::Walker, Kind::RedTurtle, Kind::GreenTurtle, Kind::Spiky] {
        let mut level = with(&[15], kind, false);
        level.set(12, FLOOR - 1, Tile::Hard);
        let mut game = game(level, Mode::Fire);
        (0..5).for_each(|_| game.advance(NONE));
        let before = only(&game, kind).expect("awake from the start");
        (0..10).for_each(|_| game.advance(NONE));
        let after = only(&game, kind).expect("still there");
        assert_eq!((after.at[0] - before.at[0], after.at[1]), (-17.5, GROUND));
        until(&mut game, NONE, |game| only(game, kind).is_some_and(|figure| figure.facing == 1));
        assert!(only(&game, kind).is_some_and(|figure| figure.at[0] >= 13.0 * 16.0 + 4.0));
    }
}

#[test]
fn only_red_turtles_turn_at_cliffs() {
    for (kind, turns) in [(Kind::RedTurtle, true), (Kind::GreenTurtle, false), (Kind::Walker, false)] {
        let mut level = with(&[], kind, false);
        (8..16).for_each(|column| level.set(column, 6, Tile::HillTop));
        level.add(Spawn { column: 12, row: 5, kind, winged: false });
        let mut game = game(level, Mode::Fire);
        for _ in 0..120 {
            game.advance(NONE);
        }
        let found = only(&game, kind).expect("still there");
        assert_eq!(found.at[1] == 6.0 * 16.0 - 1.0, turns, "{found:?}");
    }
}

/// Lets the runner fall on what starts in column 3 and walks towards it; the game at the frame in which they meet.
fn fallen_on(kind: Kind, winged: bool, mode: Mode) -> Game {
    let mut game = game(with(&[3], kind, winged), mode);
    until(&mut game, NONE, |game| game.mode() != mode || game.speed()[1] < -10.0);
    game
}

#[test]
fn stomps() {
    let game = fallen_on(Kind::Walker, false, Mode::Fire);
    // Thrown up as by a jump of eight frames.
    assert_eq!((game.speed()[1], game.mode(), only(&game, Kind::Walker)), (-1.9 * 8.0, Mode::Fire, None));
    let game = fallen_on(Kind::GreenTurtle, true, Mode::Fire);
    assert_eq!(only(&game, Kind::GreenTurtle).map(|figure| figure.winged), Some(false));
    let game = fallen_on(Kind::Spiky, false, Mode::Fire);
    assert!(game.mode() == Mode::Large && only(&game, Kind::Spiky).is_some());
}

#[test]
fn shells_rest_slide_and_are_carried() {
    let mut game = fallen_on(Kind::RedTurtle, false, Mode::Fire);
    assert_eq!(only(&game, Kind::Shell).map(|shell| shell.facing), Some(0));
    // Down on it again: it slides, 11 pixels a frame.
    until(&mut game, NONE, |game| only(game, Kind::Shell).is_some_and(|shell| shell.facing != 0));
    let before = only(&game, Kind::Shell).expect("a shell").at[0];
    game.advance(NONE);
    assert_eq!((only(&game, Kind::Shell).expect("a shell").at[0] - before).abs(), 11.0);
    // Beside it with the button held: it comes along until the button is up.
    let mut game = fallen_on(Kind::RedTurtle, false, Mode::Large);
    until(&mut game, LEFT, |game| game.on_ground());
    let far = |game: &Game| (only(game, Kind::Shell).expect("a shell").at[0] - game.position()[0]).abs();
    if far(&game) < 16.0 {
        until(&mut game, LEFT, |game| far(game) > 20.0);
    }
    until(&mut game, RIGHT.and(SPEED), |game| far(game) == 8.0);
    (0..10).for_each(|_| game.advance(RIGHT.and(SPEED)));
    assert_eq!(far(&game), 8.0);
    game.advance(RIGHT);
    assert_eq!(only(&game, Kind::Shell).map(|shell| shell.facing), Some(1));
}

#[test]
fn sliding_shells_kill_and_break_and_hurt() {
    let mut level = with(&[3], Kind::GreenTurtle, false);
    level.add(Spawn { column: 14, row: FLOOR as u8 - 1, kind: Kind::Spiky, winged: false });
    level.set(18, FLOOR - 1, Tile::Brick);
    let mut game = game(level, Mode::Fire);
    until(&mut game, NONE, |game| only(game, Kind::Shell).is_some_and(|shell| shell.facing == 1));
    until(&mut game, NONE, |game| game.tile(18, FLOOR - 1) == Tile::Empty);
    assert_eq!((all(&game, Kind::Spiky), game.mode()), (vec![], Mode::Fire));
    until(&mut game, NONE, |game| game.mode() == Mode::Large);
}

#[test]
fn flowers() {
    let pipe = |column: usize| {
        let places: Vec<_> = (0..6).map(|i| (column + i % 2, 10 + i / 2)).collect();
        let mut level = built(&places, Tile::Pipe);
        level.add(Spawn { column: column as u16, row: 10, kind: Kind::Flower, winged: false });
        level
    };
    let mut game = game(pipe(8), Mode::Fire);
    let base = 160.0 + 24.0;
    let mut heights = Vec::new();
    for _ in 0..300 {
        game.advance(NONE);
        heights.push(base - only(&game, Kind::Flower).expect("always there").at[1]);
    }
    let highest = heights.iter().copied().fold(0.0, f32::max);
    assert!((59.0..61.0).contains(&highest), "{highest}");
    let waits = heights.iter().take_while(|height| **height == 0.0).count();
    let out = heights[waits..].iter().take_while(|height| **height > 0.0).count();
    assert!(waits == 40 && out.abs_diff(90) <= 2, "{waits} {out}");
    // With the runner beside the pipe it stays in.
    let mut game = standing(pipe(4), Mode::Fire);
    (0..300).for_each(|_| game.advance(RIGHT));
    assert_eq!(only(&game, Kind::Flower).map(|flower| flower.at[1]), Some(base));
}

#[test]
fn cannons() {
    let mut level = flat();
    level.set(15, FLOOR - 2, Tile::Barrel);
    level.set(15, FLOOR - 1, Tile::Cannon);
    let mut game = game(level, Mode::Fire);
    let mut shots = Vec::new();
    let mut known = 0;
    for _ in 0..250 {
        game.advance(NONE);
        let bullets = all(&game, Kind::Bullet);
        if bullets.len() > known {
            let newest = bullets[bullets.len() - 1];
            assert_eq!((newest.at, newest.facing), ([15.0 * 16.0 + 8.0 - 8.0 - 4.0, 12.0 * 16.0 - 1.0], -1));
            shots.push(game.frames());
        }
        known = bullets.len();
    }
    assert_eq!(shots, [30, 130, 230]);
    // It comes at the height of a large runner's head, through everything.
    assert_eq!(game.mode(), Mode::Small);
}

#[test]
fn blocks() {
    let over = [(AHEAD, FLOOR - 4)];
    let hit = |tile, mode| {
        let mut game = ahead(built(&over, tile), mode);
        (0..8).for_each(|_| game.advance(JUMP));
        game
    };
    for (mode, left) in [(Mode::Small, Tile::Brick), (Mode::Large, Tile::Empty)] {
        assert_eq!(hit(Tile::Brick, mode).tile(AHEAD, FLOOR - 4), left);
    }
    for tile in [Tile::CoinBlock, Tile::CoinBrick] {
        let game = hit(tile, Mode::Small);
        assert_eq!((game.coins(), game.tile(AHEAD, FLOOR - 4)), (1, Tile::Used));
        assert_eq!(Scene::of(&game).changed, [(AHEAD as u16, FLOOR as u8 - 4, Tile::Used)]);
    }
    for tile in [Tile::PowerBlock, Tile::PowerBrick] {
        let mut game = hit(tile, Mode::Large);
        assert!(only(&game, Kind::Blossom).is_some());
        (0..20).for_each(|_| game.advance(NONE));
        assert_eq!(only(&game, Kind::Blossom).map(|item| item.at), Some([16.0 * AHEAD as f32 + 8.0, 9.0 * 16.0 - 1.0]));
        let mut game = hit(tile, Mode::Small);
        assert!(only(&game, Kind::Mushroom).is_some());
        // It walks to the right and off the block, and makes large who follows it.
        until(&mut game, NONE, |game| only(game, Kind::Mushroom).is_some_and(|item| item.at[1] == GROUND));
        until(&mut game, RIGHT, |game| game.mode() == Mode::Large);
        assert!(game.on_ground());
    }
}

#[test]
fn who_stands_on_a_block_that_is_hit_dies() {
    let mut level = built(&[(AHEAD, FLOOR - 4)], Tile::CoinBlock);
    [AHEAD - 1, AHEAD + 1].iter().for_each(|column| level.set(*column, FLOOR - 5, Tile::Hard));
    level.add(Spawn { column: AHEAD as u16, row: FLOOR as u8 - 5, kind: Kind::Spiky, winged: false });
    let mut game = ahead(level, Mode::Fire);
    assert!(only(&game, Kind::Spiky).is_some());
    (0..12).for_each(|_| game.advance(JUMP));
    assert_eq!(only(&game, Kind::Spiky), None);
}

#[test]
fn fireballs() {
    let mut game = standing(flat(), Mode::Fire);
    let fire = |game: &mut Game| {
        game.advance(SPEED);
        let count = all(game, Kind::Fireball).len();
        game.advance(SPEED);
        assert_eq!(all(game, Kind::Fireball).len(), count, "only a new press throws");
        game.advance(NONE);
        count
    };
    assert_eq!([fire(&mut game), fire(&mut game), fire(&mut game)], [1, 2, 2]);
    let first = all(&game, Kind::Fireball)[0].at[0];
    game.advance(NONE);
    assert_eq!(all(&game, Kind::Fireball)[0].at[0] - first, 8.0);
    let mut game = standing(flat(), Mode::Large);
    assert_eq!(fire(&mut game), 0);
    for (kind, dies) in [(Kind::Walker, true), (Kind::GreenTurtle, true), (Kind::Spiky, false)] {
        // Fireballs hop, so the first may miss.
        let mut game = standing(with(&[14], kind, false), Mode::Fire);
        (0..60).for_each(|t| game.advance(if t % 4 == 0 { SPEED } else { NONE }));
        assert_eq!(only(&game, kind).is_none(), dies);
        assert!(game.mode() == Mode::Fire && only(&game, Kind::Shell).is_none());
    }
}

#[test]
fn those_who_were_left_behind_come_back() {
    // In a box, high up.
    let mut level = built(&[(19, 3), (21, 3), (20, 4)], Tile::Hard);
    level.add(Spawn { column: 20, row: 3, kind: Kind::Walker, winged: false });
    let mut game = standing(level, Mode::Fire);
    assert!(only(&game, Kind::Walker).is_some());
    until(&mut game, RIGHT.and(SPEED), |game| only(game, Kind::Walker).is_none());
    // Gone 64 pixels beyond the window, whose middle the runner is in.
    assert!((game.position()[0] - (20.5 * 16.0 + 160.0 + 64.0)).abs() < 16.0, "{:?}", game.position());
    until(&mut game, LEFT.and(SPEED), |game| only(game, Kind::Walker).is_some());
}
