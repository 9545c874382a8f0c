//! Levels against the counts of another generator, each within its statistical error, and grammars that are refused.

use super::common::*;
use rollin::tasks::platformer::{COLUMNS, End, Kind, Level, Levels, ROWS, Tile};
use rollin::{Purpose, Seed};

/// Mean and standard error.
fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// 500 levels.
fn drawn(d: u8) -> Vec<Level> {
    let levels = levels();
    (0..500).map(|i| levels.draw(at(d), Seed::new(1).child(Purpose::Episode, i))).collect()
}

/// How many columns each hole has.
fn holes(level: &Level) -> Vec<f64> {
    let air = |column: &usize| level.tile(*column, ROWS - 1) == Tile::Empty;
    let starts = (1..COLUMNS).filter(|column| air(column) && !air(&(column - 1)));
    starts.map(|column| (column..COLUMNS).take_while(air).count() as f64).collect()
}

fn barrels(level: &Level) -> f64 {
    let places = (0..COLUMNS).flat_map(|column| (0..ROWS).map(move |row| (column, row)));
    places.filter(|(column, row)| level.tile(*column, *row) == Tile::Barrel).count() as f64
}

/// Means over 500 levels of the other engine, as far as they are known: d, walkers, cannons, holes.
type Row = (u8, f64, Option<f64>, Option<f64>);

const COUNTS: [Row; 6] = [
    (0, 7.1, Some(0.0), Some(0.0)),
    (1, 13.0, Some(0.0), Some(1.5)),
    (2, 17.2, Some(0.0), Some(2.9)),
    (3, 20.5, Some(3.9), Some(3.5)),
    (5, 22.5, None, None),
    (10, 26.9, Some(14.7), Some(6.0)),
];

#[test]
fn counts_are_those_of_the_other_engine() {
    for (d, walkers, cannons, gaps) in COUNTS {
        let all = drawn(d);
        let compare = |what: &str, of: &dyn Fn(&Level) -> f64, expected: Option<f64>| {
            let Some(expected) = expected else { return };
            let (found, error) = mean(&all.iter().map(of).collect::<Vec<_>>());
            // Both are means of 500, and the other is known to a decimal: four standard errors of the difference.
            let allowed = 4.0 * std::f64::consts::SQRT_2 * error + 0.05;
            assert!((found - expected).abs() <= allowed, "{what} at {d}: {found} ± {error}, not {expected}");
        };
        let walk = |level: &Level| level.spawns().iter().filter(|spawn| spawn.kind.walks()).count();
        let wings = |level: &Level| level.spawns().iter().filter(|spawn| spawn.winged).count();
        let flowers = |level: &Level| level.spawns().iter().filter(|spawn| spawn.kind == Kind::Flower).count();
        let known = |at: [f64; 2]| [(0, at[0]), (10, at[1])].into_iter().find(|(at, _)| *at == d).map(|(_, mean)| mean);
        compare("walkers", &|level| walk(level) as f64, Some(walkers));
        compare("winged", &|level| wings(level) as f64, known([0.0, 7.6]));
        compare("flowers", &|level| flowers(level) as f64, known([0.2, 5.4]));
        compare("cannons", &barrels, cannons);
        compare("holes", &|level| holes(level).len() as f64, gaps);
        let wide: Vec<f64> = all.iter().flat_map(holes).collect();
        assert!(d == 0 || (mean(&wide).0 - 2.5).abs() < 0.1 && wide.iter().all(|wide| [2.0, 3.0].contains(wide)));
    }
}

#[test]
fn lengths_are_those_of_the_other_engine() {
    let mut total = 0.0;
    for d in 0..=10 {
        let exits: Vec<f64> = drawn(d).iter().map(|level| f64::from(level.exit())).collect();
        assert!(exits.iter().all(|exit| (4224.0..=4512.0).contains(exit)));
        let (mean, error) = mean(&exits);
        // The other engine's means over 500 levels, of which these have the standard error, are from 4294 to 4310.
        assert!((4294.0 - 3.0 * error..=4310.0 + 3.0 * error).contains(&mean), "{mean} ± {error} at {d}");
        total += mean / 11.0;
    }
    assert!((4294.0..=4310.0).contains(&total), "{total}");
}

#[test]
fn levels_are_sound() {
    for d in 0..=10 {
        for level in drawn(d).iter().take(100) {
            // Ten safe columns at least, and nobody starts in a tile that blocks.
            assert!(level.spawns().iter().all(|spawn| spawn.column >= 10));
            for spawn in level.spawns().iter().filter(|spawn| spawn.kind != Kind::Flower) {
                let (column, row) = (usize::from(spawn.column), usize::from(spawn.row));
                assert!(!level.tile(column, row).solid() && level.tile(column, row + 1).carries(), "{level}");
            }
            assert!(level.spawns().is_sorted_by_key(|spawn| spawn.column));
        }
    }
    assert_eq!(drawn(7)[3], drawn(7)[3]);
    assert_ne!(drawn(7)[3], drawn(7)[4]);
}

/// Right nine times of ten: 1,300 px were measured in the other engine, over all difficulties.
#[test]
fn random_play_gets_about_1300_pixels() {
    let levels = levels();
    let play = |i: u64| {
        let mut game = start(&levels, (i % 11) as u8, i);
        let mut pick = random(Seed::new(i));
        while game.end().is_none() {
            let buttons = pick();
            (0..4).for_each(|_| game.advance(buttons));
        }
        assert!(game.frames() <= 3000 && (game.end() != Some(End::Late) || game.frames() == 3000));
        f64::from(game.position()[0])
    };
    let (mean, error) = mean(&(0..1100).map(play).collect::<Vec<_>>());
    assert!((1200.0..=1450.0).contains(&mean), "{mean} ± {error}");
}

#[test]
fn grammars_that_are_none_are_refused_with_the_place() {
    for (text, expected) in [
        ("", "l:1:1: no `start`"),
        (
            "start A; A -> straigth end;",
            "l:1:15: `straigth` is no zone; expected one of straight, hills, pipes, gap, cannons",
        ),
        ("start A;\nwords w = gap hole;\nA -> @w end;", "l:2:15: `hole` is no zone"),
        ("start A; A -> { gap*(2x) } end;", "l:1:22: found `2x)`; expected a number, `d` or a multiple"),
        ("start A; A -> { gap*(2+) } end;", "l:1:24: found `)`; expected a number, `d` or a multiple"),
        ("start A; A -> { gap*(2 } end;", "l:1:24: found `}`; expected `+` or `-` and another term, or `)`"),
        ("start A; A -> { gap*(1e308+1e308) } end;", "l:1:22: found `1e308+1e308)`; expected a finite sum"),
        ("start A; A -> { gap*(d) } end;", "l:1:17: found `gap*(d)`; expected at every difficulty a weight above 0"),
        ("start A; A -> gap end *(d-3);", "l:1:15: found `gap`; expected at every difficulty a weight above 0"),
        ("start A*(2d);  A -> gap end;", "l:1:7: found `A*(2d);`; expected at every difficulty"),
        ("start A B*(d); A -> gap end; B -> pipes end;", "l:1:30: "),
    ] {
        let error = Levels::parse("l", text).expect_err(text).to_string();
        assert!(error.starts_with(expected), "{text:?}: {error}\n  not {expected}");
    }
    assert!(Levels::read("no/such/file").is_err());
}

#[test]
fn weights_depend_on_the_difficulty() {
    let levels = Levels::parse("l", "start A; A -> { straight*(10-d) gap*(d) } end;").expect("a grammar");
    let count = |d: u8| {
        let all = (0..50).map(|i| levels.draw(at(d), Seed::new(i)));
        all.map(|level| holes(&level).len()).sum::<usize>()
    };
    assert!(count(0) == 0 && 0 < count(5) && count(5) < count(10));
}
