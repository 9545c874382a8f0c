//! The platform game: how fast it is played, copied, seen and planned, and how many levels its planner finishes. Asserts the answers, then times.
//!
//! `cargo bench --bench platformer`; with `ROLLIN_FULL=1` also the planner's finishing rate over 400 levels a difficulty.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::RngExt;
use rayon::prelude::*;
use rollin::space::{Action, Episode, Features, Space};
use rollin::tasks::platformer::planner::{DEPTH, MOVES, STRETCH};
use rollin::tasks::platformer::{Buttons, Difficulty, End, Game, HOLD, Levels, Mode, Planner, Platformer, Settings};
use rollin::{Purpose, Seed};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

fn levels() -> Levels {
    Levels::standard().expect("they are read like any others")
}

/// The start of level number `number`.
fn start(levels: &Levels, d: Difficulty, number: u64) -> Game {
    let seed = Seed::new(2009).child(Purpose::Episode, u64::from(u8::from(d))).child(Purpose::Episode, number);
    Game::new(Arc::new(levels.draw(d, seed)), Mode::Fire, 3000)
}

/// Decisions at random, drawn beforehand: nine times of ten to the right, else to the left; jump and speed half of the time.
fn decisions(count: usize, seed: Seed) -> Vec<Buttons> {
    let mut rng = seed.rng();
    let mut pick = || {
        let side = if rng.random_bool(0.9) { Buttons::RIGHT } else { Buttons::LEFT };
        let jump = if rng.random_bool(0.5) { Buttons::JUMP } else { Buttons::NONE };
        side.and(jump).and(if rng.random_bool(0.5) { Buttons::SPEED } else { Buttons::NONE })
    };
    (0..count).map(|_| pick()).collect()
}

/// Plays on until the game is over, and shows it at each decision.
fn play_out(game: &mut Game, decisions: &[Buttons], mut watch: impl FnMut(&Game)) {
    for buttons in decisions.iter().cycle() {
        if game.end().is_some() {
            return;
        }
        watch(game);
        (0..HOLD).for_each(|_| game.advance(*buttons));
    }
}

/// A hundred levels of each difficulty, with the decisions to play them.
fn games() -> Vec<(Game, Vec<Buttons>)> {
    let levels = levels();
    let each = |i: u64| (start(&levels, Difficulty::ALL[(i % 11) as usize], i / 11), decisions(200, Seed::new(i)));
    (0..1100).map(each).collect()
}

/// Every eighth decision of all games.
fn moments(games: &[(Game, Vec<Buttons>)]) -> Vec<Game> {
    let mut moments = Vec::new();
    for (game, decisions) in games {
        let mut t = 0;
        play_out(&mut game.clone(), decisions, |game| {
            t += 1;
            if t % 8 == 0 {
                moments.push(game.clone());
            }
        });
    }
    moments
}

/// Frames of random play. About 1,300 px are made, as in the engine that the rules were measured in.
fn random_play(c: &mut Criterion) {
    let games = games();
    let play = |(game, decisions): &(Game, Vec<Buttons>)| {
        let mut game = game.clone();
        play_out(&mut game, decisions, |_| ());
        game
    };
    let ends: Vec<Game> = games.iter().map(play).collect();
    let made = ends.iter().map(|game| f64::from(game.position()[0])).sum::<f64>() / ends.len() as f64;
    assert!((1200.0..1450.0).contains(&made), "{made} px");
    let mut group = c.benchmark_group("platformer");
    group.throughput(Throughput::Elements(ends.iter().map(|game| u64::from(game.frames())).sum()));
    group.bench_function("frames of random play", |b| {
        b.iter(|| games.iter().map(|game| play(black_box(game)).frames()).sum::<u32>());
    });
    group.finish();
}

/// Copies, each run eight frames ahead.
fn copies(c: &mut Criterion) {
    let moments = moments(&games());
    let ahead = |scratch: &mut Game, game: &Game| {
        scratch.clone_from(game);
        (0..8).for_each(|_| scratch.advance(Buttons::RIGHT));
        scratch.position()[0]
    };
    let mut scratch = moments[0].clone();
    for game in &moments {
        let mut original = game.clone();
        (0..8).for_each(|_| original.advance(Buttons::RIGHT));
        ahead(&mut scratch, game);
        assert!(scratch == original, "a copy goes another way");
    }
    let mut group = c.benchmark_group("platformer");
    group.throughput(Throughput::Elements(moments.len() as u64));
    group.bench_function("copies run eight frames ahead", |b| {
        b.iter(|| moments.iter().map(|game| ahead(&mut scratch, black_box(game))).sum::<f32>());
    });
    group.finish();
}

/// What a decision of a classifier pays for beside its scores: four frames, and what is seen after them.
fn steps(c: &mut Criterion) {
    let space = Platformer::new(levels(), Settings::default()).expect("valid settings");
    let starts: Vec<_> = (0..44).map(|index| space.start(Episode { index, seed: Seed::new(index as u64) })).collect();
    let decisions = decisions(200, Seed::new(1));
    let mut view = Features::default();
    let mut run = || {
        let (mut steps, mut seen) = (0u64, 0);
        for start in &starts {
            let mut state = start.clone();
            for buttons in &decisions {
                if space.legal(&state).is_empty() {
                    break;
                }
                space.look(&state, &mut view);
                seen += view.dynamic.len();
                space.step(&mut state, Action(u32::from(buttons.0)), Seed::new(0));
                steps += 1;
            }
        }
        (steps, seen)
    };
    let (count, seen) = run();
    assert!((150..350).contains(&(seen as u64 / count)), "{} features", seen as u64 / count);
    let mut group = c.benchmark_group("platformer");
    group.throughput(Throughput::Elements(count));
    group.bench_function("decisions seen and made", |b| b.iter(&mut run));
    group.finish();
}

/// The best value from `game` and the first move to it, by trying everything.
fn brute(game: &Game, depth: u32) -> (f32, Buttons) {
    if depth == DEPTH || game.end().is_some() {
        return (Planner::value(game, DEPTH - depth), Buttons::NONE);
    }
    let mut best = (f32::NEG_INFINITY, Buttons::NONE);
    for buttons in MOVES {
        let mut next = game.clone();
        (0..STRETCH).for_each(|_| next.advance(buttons));
        let (value, _) = brute(&next, depth + 1);
        if value > best.0 {
            best = (value, buttons);
        }
    }
    best
}

/// Decisions of the planner where it plays itself; trying everything beside them.
fn planning(c: &mut Criterion) {
    let levels = levels();
    let mut moments = Vec::new();
    for i in 0..22 {
        let mut game = start(&levels, Difficulty::ALL[i as usize % 11], i);
        for t in 0.. {
            let Some(plan) = Planner.plan(&game) else { break };
            if t % 8 == 0 {
                moments.push(game.clone());
            }
            (0..HOLD).for_each(|_| game.advance(plan.buttons));
        }
    }
    for game in &moments {
        let plan = Planner.plan(game).expect("it goes on");
        assert_eq!((plan.value, plan.buttons), brute(game, 0));
    }
    let mut group = c.benchmark_group("platformer");
    group.sample_size(10).throughput(Throughput::Elements(moments.len() as u64));
    group.bench_function("plans", |b| {
        b.iter(|| moments.iter().filter_map(|game| Planner.plan(black_box(game))).map(|plan| plan.frames).sum::<u64>());
    });
    group.bench_function("plans by trying everything", |b| {
        b.iter(|| moments.iter().map(|game| brute(black_box(game), 0).0).sum::<f32>());
    });
    group.finish();
    if std::env::var_os("ROLLIN_FULL").is_some() {
        finishing(&levels);
    }
}

/// The paper says that its planner finishes 95 to 99 % of the levels at every difficulty.
fn finishing(levels: &Levels) {
    println!(
        "| difficulty | finished of 400 | late, fell, killed | decisions a level | frames a decision |\n|--:|--:|--:|--:|--:|"
    );
    let clock = Instant::now();
    let (mut plans, mut all) = (0u64, 0);
    for d in Difficulty::ALL {
        let run = |number: u64| {
            let mut game = start(levels, d, number);
            let (mut decisions, mut frames) = (0u64, 0);
            while let Some(plan) = Planner.plan(&game) {
                (decisions, frames) = (decisions + 1, frames + plan.frames);
                (0..HOLD).for_each(|_| game.advance(plan.buttons));
            }
            (game.end(), decisions, frames)
        };
        let found: Vec<_> = (0..400).into_par_iter().map(run).collect();
        let count = |end| found.iter().filter(|game| game.0 == Some(end)).count();
        let (decisions, frames) = found.iter().fold((0, 0), |sum, game| (sum.0 + game.1, sum.1 + game.2));
        println!(
            "| {} | {} | {}, {}, {} | {} | {} |",
            u8::from(d),
            count(End::Won),
            count(End::Late),
            count(End::Fell),
            count(End::Killed),
            decisions / 400,
            frames / decisions,
        );
        // 93 %: of 400 levels at 95 % fewer are finished with a chance of 3 %, at 97 % with one of 1 in 10,000.
        assert!(count(End::Won) >= 372, "{} of 400", count(End::Won));
        (plans, all) = (plans + decisions, all + count(End::Won));
    }
    println!("{all} of 4400 levels, {plans} decisions in {:.0} s", clock.elapsed().as_secs_f64());
}

criterion_group!(benches, random_play, copies, steps, planning);
criterion_main!(benches);
