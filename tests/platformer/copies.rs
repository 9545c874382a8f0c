//! Copies go on as the original does, and leave it alone.

use super::common::*;
use rollin::Seed;
use rollin::tasks::platformer::Game;

fn run(game: &mut Game, seed: Seed, decisions: usize) {
    for buttons in std::iter::repeat_with(random(seed)).take(decisions) {
        (0..4).for_each(|_| game.advance(buttons));
    }
}

#[test]
fn a_copy_run_ahead_equals_the_original() {
    let moments = moments(10);
    // Whatever stood in the scratch before does not matter.
    let mut scratch = moments[3].clone();
    for (i, game) in moments.iter().enumerate() {
        let (seed, mut original) = (Seed::new(i as u64), game.clone());
        scratch.clone_from(game);
        run(&mut scratch, seed, 40);
        assert_eq!(original, *game, "the original changed");
        run(&mut original, seed, 40);
        assert_eq!(original, scratch);
        assert!(original != *game);
    }
}

#[test]
fn the_same_level_and_buttons_are_the_same_game() {
    let play = || -> Vec<Game> { moments(2) };
    assert_eq!(play(), play());
}
