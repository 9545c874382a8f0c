//! What is seen, against a slow account of it by the numbering that is documented.

use super::common::*;
use rollin::space::{Action, Episode, Features, Space};
use rollin::tasks::platformer::features::{CELLS, CLASSES, FEATURES, IMAGE, IMAGES, MARKS, STEPS};
use rollin::tasks::platformer::{COLUMNS, Game, Kind, Mode, Platformer, Playing, ROWS, Scene, Settings, Tile};
use rollin::{Purpose, Seed};
use std::collections::BTreeSet;

fn space() -> Platformer {
    Platformer::new(levels(), Settings::default()).expect("valid settings")
}

fn seen(space: &Platformer, state: &Playing) -> Vec<u32> {
    let mut view = Features::default();
    space.look(state, &mut view);
    view.dynamic
}

/// Rows, columns and classes of what is in the image.
fn image(game: &Game) -> BTreeSet<(i64, i64, usize)> {
    let [x, y] = game.position().map(|pixel| (f64::from(pixel) / 16.0).floor() as i64);
    let mut cells = BTreeSet::new();
    for column in 0..COLUMNS {
        for row in 0..ROWS {
            let class = match game.tile(column, row) {
                Tile::Empty | Tile::Hill | Tile::Coin => continue,
                Tile::Ground | Tile::Hard | Tile::Used => 0,
                Tile::HillTop => 1,
                Tile::Pipe => 2,
                Tile::Barrel | Tile::Cannon => 3,
                Tile::Brick | Tile::CoinBrick | Tile::PowerBrick => 11,
                Tile::CoinBlock | Tile::PowerBlock => 12,
            };
            cells.insert((row as i64 - y + 11, column as i64 - x + 11, class));
        }
    }
    for figure in Scene::of(game).things {
        let class = match figure.kind {
            Kind::Spiky => 6,
            Kind::Walker | Kind::RedTurtle | Kind::GreenTurtle if figure.winged => 5,
            Kind::Walker | Kind::RedTurtle | Kind::GreenTurtle => 4,
            Kind::Flower => 7,
            Kind::Bullet => 8,
            Kind::Shell => 9,
            Kind::Fireball => 10,
            Kind::Mushroom | Kind::Blossom => 13,
        };
        let [column, row] = figure.at.map(|pixel| (f64::from(pixel) / 16.0).floor() as i64);
        cells.insert((row - y + 11, column - x + 11, class));
    }
    cells.retain(|(row, column, _)| (0..22).contains(row) && (0..22).contains(column));
    cells
}

fn marks(game: &Game) -> [bool; 4] {
    [game.on_ground(), game.can_jump(), game.mode() == Mode::Fire, game.mode() >= Mode::Large]
}

#[test]
fn there_are_27152() {
    assert_eq!((CELLS, CLASSES, IMAGES, STEPS, MARKS), (22, 14, 4, 6, 8));
    assert_eq!((IMAGE, FEATURES), (6776, 27_152));
    assert_eq!((space().shared().features(), space().actions()), (27_152, 16));
}

#[test]
fn numbers_are_as_documented() {
    let space = space();
    let (mut states, mut active, mut most) = (0, 0, 0);
    for index in 0..22 {
        let mut state = space.start(Episode { index, seed: Seed::new(index as u64) });
        let mut pick = random(Seed::new(3).child(Purpose::Step, index as u64));
        // The latest first: what was chosen, what was seen, what was marked.
        let mut past = vec![(0u8, image(state.game()), marks(state.game()))];
        loop {
            let mut expected = BTreeSet::new();
            for (i, (_, cells, _)) in past.iter().enumerate().take(4) {
                expected.extend(cells.iter().map(|(r, c, k)| 6776 * i + 14 * (22 * *r as usize + *c as usize) + k));
            }
            for (j, (buttons, _, marks)) in past.iter().enumerate().take(6) {
                let chosen = (0..4).filter(|bit| buttons >> bit & 1 == 1);
                let marked = (0..4).filter(|bit| marks[*bit]).map(|bit| 4 + bit);
                expected.extend(chosen.chain(marked).map(|bit| 27_104 + 8 * j + bit));
            }
            let found = seen(&space, &state);
            assert!(found.iter().map(|feature| *feature as usize).eq(expected), "episode {index}");
            let now = found.iter().filter(|feature| **feature < 6776).count();
            (states, active, most) = (states + 1, active + now, most.max(now));
            if space.legal(&state).is_empty() {
                break;
            }
            let buttons = pick();
            space.step(&mut state, Action(u32::from(buttons.0)), Seed::new(0));
            past.insert(0, (buttons.0, image(state.game()), marks(state.game())));
            past.truncate(6);
        }
    }
    // About 61, at most 114, were measured in other games than these.
    let mean = active as f64 / f64::from(states);
    assert!((50.0..75.0).contains(&mean) && most < 140, "{mean} {most}");
}
