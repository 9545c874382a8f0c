//! The game as a space: trainers run on it, whatever the number of threads, and outcomes are told.

use super::common::*;
use rollin::Seed;
use rollin::learner::Perceptron;
use rollin::roll::perform;
use rollin::space::{Action, Episode, Expert, Space};
use rollin::tasks::platformer::{Difficulty, Levels, Planner, Platformer, Settings};
use rollin::trainer::{Run, Supervised};

fn space(difficulties: &[u8]) -> Platformer {
    let difficulties = difficulties.iter().map(|d| at(*d)).collect();
    Platformer::new(levels(), Settings { difficulties, ..Settings::default() }).expect("valid settings")
}

#[test]
fn outcomes_and_costs() {
    let space = space(&[4, 6]);
    assert_eq!([0, 1, 2].map(|index| space.difficulty(index)), [at(4), at(6), at(4)]);
    let episode = Episode { index: 1, seed: Seed::new(5) };
    let mut state = space.start(episode);
    let (mut cost, mut decisions) = (0.0, 0);
    while let Some(action) = Planner.action(&space, &state) {
        assert!(cost == 0.0 && state.outcome().end.is_none());
        cost += space.step(&mut state, action, episode.seed);
        decisions += 1;
    }
    let outcome = state.outcome();
    assert!(outcome.won() && !outcome.died() && outcome.distance > outcome.length && cost == 0.0, "{outcome:?}");
    assert!(decisions <= space.longest() && space.longest() == 750);
    // Who does nothing has made the way that it starts with.
    let mut state = space.start(episode);
    while !space.legal(&state).is_empty() {
        cost += space.step(&mut state, Action(0), episode.seed);
    }
    let outcome = state.outcome();
    assert!(!outcome.won() && (cost - (1.0 - 32.0 / f64::from(outcome.length))).abs() < 0.05, "{cost} {outcome:?}");
}

#[test]
fn a_level_that_no_one_can_finish_is_over_when_its_time_is() {
    // No one runs 4,000 pixels in 40 frames.
    let levels = Levels::parse("<test>", "start All; All -> straight end;").expect("a grammar");
    let settings = Settings { limit: 40, ..Settings::default() };
    let space = Platformer::new(levels, settings).expect("valid settings");
    let mut state = space.start(Episode { index: 0, seed: Seed::new(1) });
    let mut decisions = 0;
    while let Some(action) = Planner.action(&space, &state) {
        space.step(&mut state, action, Seed::new(1));
        decisions += 1;
    }
    assert!(decisions == 10 && !state.outcome().won() && !state.outcome().died());
}

#[test]
fn settings_are_checked() {
    let wrong = |settings| Platformer::new(levels(), settings).expect_err("refused").to_string();
    let none = Settings { difficulties: vec![], ..Settings::default() };
    assert_eq!(wrong(none), "difficulties is empty, but must be at least one difficulty");
    assert_eq!(wrong(Settings { limit: 0, ..Settings::default() }), "limit is 0, but must be from 1 to 100000 frames");
    assert!(wrong(Settings { limit: u32::MAX, ..Settings::default() }).starts_with("limit is 4294967295"));
    assert!(Difficulty::new(11).is_err() && serde_json::from_str::<Settings>(r#"{"difficulties":[11]}"#).is_err());
    assert_eq!(serde_json::from_str::<Settings>("{}").expect("defaults"), Settings::default());
}

/// Supervised imitation of four games, the same at any number of threads, gets further than who does nothing, who misses 0.993 of the way.
#[test]
fn trainers_run_on_it() {
    let problem = space(&[0]).problem(4);
    let train = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| Supervised::default().train(&problem, &Perceptron::default(), &Run::new(1)).expect("it trains"))
    };
    let (one, two) = (train(1), train(2));
    assert_eq!(one.ledger, two.ledger);
    let costs = |policy| perform(&problem, policy, Seed::new(2)).0.costs;
    let found = costs(&one.policy);
    assert_eq!(found, costs(&two.policy));
    assert!(found.iter().sum::<f64>() / 4.0 < 0.97, "{found:?}");
}
