//! Small levels, and ways to play.

use rand::RngExt;
use rollin::tasks::platformer::{
    Buttons, COLUMNS, Difficulty, Figure, Game, Kind, Level, Levels, Mode, ROWS, Scene, Spawn, Tile,
};
use rollin::{Purpose, Seed};
use std::sync::Arc;

/// The row on which one stands in [`flat`].
pub const FLOOR: usize = 13;

/// The height of feet on the floor of [`flat`].
pub const GROUND: f32 = 16.0 * FLOOR as f32 - 1.0;

pub const NONE: Buttons = Buttons::NONE;
pub const LEFT: Buttons = Buttons::LEFT;
pub const RIGHT: Buttons = Buttons::RIGHT;
pub const JUMP: Buttons = Buttons::JUMP;
pub const SPEED: Buttons = Buttons::SPEED;

/// Nothing but ground.
pub fn flat() -> Level {
    let mut level = Level::empty(COLUMNS);
    for column in 0..COLUMNS {
        (FLOOR..ROWS).for_each(|row| level.set(column, row, Tile::Ground));
    }
    level
}

/// `level`, at its start.
pub fn game(level: Level, mode: Mode) -> Game {
    Game::new(Arc::new(level), mode, 3000)
}

/// `level` with the runner on the ground.
pub fn standing(level: Level, mode: Mode) -> Game {
    let mut game = game(level, mode);
    for _ in 0..30 {
        game.advance(NONE);
    }
    assert!(game.on_ground());
    game
}

/// `level` with the runner at rest in column [`AHEAD`], beneath what could be above it there.
pub fn ahead(level: Level, mode: Mode) -> Game {
    let mut game = standing(level, mode);
    until(&mut game, RIGHT, |game| game.position()[0] > 72.0);
    until(&mut game, NONE, |game| game.speed()[0] == 0.0);
    assert_eq!((game.position()[0] / 16.0) as usize, AHEAD, "{:?}", game.position());
    game
}

/// Where [`ahead`] leads to.
pub const AHEAD: usize = 6;

/// [`flat`] with one of these on the ground in each of these columns.
pub fn with(columns: &[u16], kind: Kind, winged: bool) -> Level {
    let mut level = flat();
    columns.iter().for_each(|column| level.add(Spawn { column: *column, row: FLOOR as u8 - 1, kind, winged }));
    level
}

/// [`flat`] with `tile` in some places.
pub fn built(places: &[(usize, usize)], tile: Tile) -> Level {
    let mut level = flat();
    places.iter().for_each(|(column, row)| level.set(*column, *row, tile));
    level
}

/// All of `kind` that are there.
pub fn all(game: &Game, kind: Kind) -> Vec<Figure> {
    Scene::of(game).things.into_iter().filter(|figure| figure.kind == kind).collect()
}

/// The one of `kind` that is there.
pub fn only(game: &Game, kind: Kind) -> Option<Figure> {
    let all = all(game, kind);
    assert!(all.len() < 2, "{all:?}");
    all.first().copied()
}

/// Goes on with `buttons` until `done`; fails after 600 frames.
pub fn until(game: &mut Game, buttons: Buttons, done: impl Fn(&Game) -> bool) {
    for _ in 0..600 {
        if done(game) {
            return;
        }
        game.advance(buttons);
    }
    panic!("it did not happen: {:?}", Scene::of(game));
}

pub fn levels() -> Levels {
    Levels::standard().expect("they are read like any others")
}

pub fn at(d: u8) -> Difficulty {
    Difficulty::new(d).expect("from 0 to 10")
}

/// The start of level number `number`.
pub fn start(levels: &Levels, d: u8, number: u64) -> Game {
    let seed = Seed::new(2009).child(Purpose::Episode, u64::from(d)).child(Purpose::Episode, number);
    Game::new(Arc::new(levels.draw(at(d), seed)), Mode::Fire, 3000)
}

/// Random games at every difficulty, `each` of them, played up to a random time.
pub fn moments(each: u64) -> Vec<Game> {
    let levels = levels();
    let moment = |i: u64| {
        let mut game = start(&levels, (i % 11) as u8, i);
        let seed = Seed::new(7).child(Purpose::Step, i);
        let time = 10 + (seed.unit() * 90.0) as usize;
        for buttons in std::iter::repeat_with(random(seed)).take(time) {
            let before = game.clone();
            (0..4).for_each(|_| game.advance(buttons));
            if game.end().is_some() {
                return before;
            }
        }
        game
    };
    (0..11 * each).map(moment).collect()
}

/// Decisions at random: nine times of ten to the right, else to the left; jump and speed half of the time.
pub fn random(seed: Seed) -> impl FnMut() -> Buttons {
    let mut rng = seed.rng();
    move || {
        let side = if rng.random_bool(0.9) { RIGHT } else { LEFT };
        let jump = if rng.random_bool(0.5) { JUMP } else { NONE };
        side.and(jump).and(if rng.random_bool(0.5) { SPEED } else { NONE })
    }
}
