//! The expert is right wherever it is asked; every trainer runs; threads change nothing.

use crate::common::{drawn, fixed, graphs, ratio, world};
use petgraph::algo::{astar, dijkstra};
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::{EdgeRef, Reversed};
use proptest::prelude::*;
use rayon::ThreadPoolBuilder;
use rollin::learner::{Logistic, Perceptron};
use rollin::policy::{Classifier, Follow, Ladder, Linear};
use rollin::roll::{Shortcut, perform};
use rollin::space::{Action, CostToGo, Episode, Expert, Features, Sight, Space};
use rollin::tasks::navigation::{At, Cheapest, Maps, MaximumMargin, Navigation, Place, Road, Site};
use rollin::tasks::{AnyLearner, Trainer};
use rollin::trainer::{
    Aggrevate, Cpi, Dagger, EarlyUpdate, Forward, Lols, Rate, Reuse, Run, Searn, Smile, Stacking, Supervised,
};
use rollin::{Error, Purpose, Seed};

/// The cheapest way from `node` to node 0 by trying all ways that come to no node twice.
fn brute(graph: &DiGraph<Site, Road>, node: NodeIndex, seen: u32) -> f64 {
    if node.index() == 0 {
        return 0.0;
    }
    let seen = seen | 1 << node.index();
    let onward = graph.edges(node).filter(|edge| seen & 1 << edge.target().index() == 0);
    onward.map(|edge| edge.weight().cost + brute(graph, edge.target(), seen)).fold(f64::INFINITY, f64::min)
}

proptest! {
    #![proptest_config(fixed(300))]

    /// Three ways agree: the frozen graph's plan, every way tried, and petgraph's Dijkstra and A*.
    #[test]
    fn the_cost_to_go_is_exact(graph in graphs()) {
        let world = world(graph.clone(), 9);
        let back = dijkstra(Reversed(&graph), NodeIndex::new(0), None, |edge| edge.weight().cost);
        for node in graph.node_indices() {
            let value = world.cheapest(0).value(node.index() as u32);
            prop_assert_eq!(value, brute(&graph, node, 0));
            prop_assert_eq!(value, back[&node]);
            let star = astar(&graph, node, |n| n.index() == 0, |edge| edge.weight().cost, |_| 0.0);
            prop_assert_eq!(Some(value), star.map(|(cost, _)| cost));
        }
    }

    /// The expert's act is the first of the cheapest, its costs are what they should be by their definition, and following it arrives, in
    /// fewer steps than there are nodes and for just what was said; also where edges cost nothing.
    #[test]
    fn the_expert_does_what_is_cheapest(graph in graphs(), horizon in 1..9usize) {
        let space = Navigation::<Place>::new(world(graph.clone(), horizon));
        let mut costs = Vec::new();
        for trip in 0..space.world().trips().len() {
            for node in 1..graph.node_count() as u32 {
                let state = At { trip: trip as u32, node, t: 0 };
                Cheapest.costs(&space, &state, &mut costs);
                let action = Cheapest.action(&space, &state).expect("it always answers");
                let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
                let legal = space.legal(&state);
                prop_assert_eq!(costs[legal.place(action).expect("legal")], least);
                for (action, cost) in legal.iter().zip(&costs) {
                    let mut after = state;
                    let mut paid = space.step(&mut after, action, Seed::new(0));
                    while let Some(next) = Cheapest.action(&space, &after).filter(|_| !space.legal(&after).is_empty()) {
                        paid += space.step(&mut after, next, Seed::new(0));
                    }
                    prop_assert_eq!(paid, *cost);
                    prop_assert!(after.node == 0 || after.t as usize == horizon);
                }
            }
        }
        let long = Navigation::<Place>::new(world(graph.clone(), graph.node_count() - 1)).problem();
        let ways = perform(&long, &Follow, Seed::new(1)).0;
        for (trip, cost) in ways.costs.iter().enumerate() {
            prop_assert_eq!(*cost, long.space.world().optimum(trip));
            let way = long.space.world().cheapest(0).way(long.space.world().target(0).0, 1 + trip as u32);
            prop_assert!(way.count() < graph.node_count());
        }
    }

    /// Whatever is done, a trip ends, and costs no less than the cheapest way.
    #[test]
    fn no_trip_is_cheaper_than_the_cheapest(graph in graphs(), horizon in 1..9usize, choices in any::<u64>()) {
        let space = Navigation::<Place>::new(world(graph, horizon));
        for trip in 0..space.world().trips().len() {
            let seed = Seed::new(choices);
            let mut state = space.start(Episode { index: trip, seed });
            let (mut cost, mut steps) = (0.0, 0);
            while !space.legal(&state).is_empty() {
                let legal = space.legal(&state);
                let draw = seed.child(Purpose::Step, steps).unit();
                let action = legal.nth((draw * legal.len() as f64) as usize);
                cost += space.step(&mut state, action, seed);
                steps += 1;
            }
            prop_assert!(steps as usize <= horizon && cost >= space.world().optimum(trip));
        }
    }

    /// Every feature of a view is in its table, and none is there twice.
    #[test]
    fn views_are_sets_of_known_features(graph in graphs()) {
        let space = Navigation::<Features>::new(world(graph.clone(), 3));
        for node in 1..graph.node_count() as u32 {
            let mut view = Features::default();
            space.look(&At { trip: 0, node, t: 0 }, &mut view);
            let mut ids = [space.shared().row(view.row), &view.dynamic].concat();
            prop_assert!(ids.iter().all(|id| (*id as usize) < space.shared().features()));
            let count = ids.len();
            ids.sort_unstable();
            ids.dedup();
            prop_assert_eq!(ids.len(), count);
        }
    }
}

fn small() -> Maps {
    Maps { width: 6, height: 5, patches: 10, costs: vec![1.0, 3.0, 9.0], ..Maps::default() }
}

#[test]
fn every_trainer_plans() {
    let problem = drawn::<Place>(&small(), 30, 1);
    let (learner, run) = (MaximumMargin::default(), Run::new(1));
    let smile = Smile { alpha: 0.5, rounds: 3, warm: true, ..Smile::default() };
    let searn = Searn { beta: 0.5, rounds: 2, samples: 1, warm: false };
    let (dagger, aggrevate) =
        (Dagger { rounds: 2, ..Dagger::default() }, Aggrevate { rounds: 2, ..Aggrevate::default() });
    let train = || -> rollin::Result<Vec<f64>> {
        let forward = Forward::default().train(&problem, &learner, &run)?;
        Ok(vec![
            ratio(&problem, &Supervised::default().train(&problem, &learner, &run)?.policy),
            ratio(&problem, &forward.policy),
            ratio(&problem, &smile.train(&problem, &learner, &run)?.policy),
            ratio(&problem, &searn.train_by(&problem, &learner, &Shortcut, &run)?.policy),
            ratio(&problem, &searn.train(&problem, &learner, &run)?.policy),
            ratio(&problem, &dagger.train(&problem, &learner, &run)?.policy),
            ratio(&problem, &aggrevate.train_by(&problem, &learner, &Shortcut, &run)?.policy),
            ratio(&problem, &Lols { rounds: 2, ..Lols::default() }.train(&problem, &learner, &run)?.policy),
        ])
    };
    for (i, ratio) in train().expect("settings in range").into_iter().enumerate() {
        assert!((1.0..1.1).contains(&ratio), "number {i}: {ratio}");
    }
}

/// Who plans trajectories ahead cannot, because a trip ends where it arrives, and says so. Who draws a step counts them first.
#[test]
fn who_must_know_horizons_is_refused() {
    let problem = drawn::<Place>(&small(), 3, 1);
    let (learner, run) = (MaximumMargin::default(), Run::new(1));
    let smile = Smile { reuse: Reuse::Printed42, ..Smile::default() };
    let refusal = smile.train(&problem, &learner, &run).err();
    let text = refusal.as_ref().map(Error::to_string).expect("refused");
    assert!(text.contains("does not know its horizons"), "{text}");
    let cpi = Cpi { rate: Rate::Fixed(0.5), rounds: 2, ..Cpi::default() };
    assert_eq!(cpi.train(&problem, &learner, &run).expect("it counts steps").ledger.examples, 2 * 3);
    let aggrevate = Aggrevate { rounds: 2, ..Aggrevate::default() };
    assert_eq!(aggrevate.train(&problem, &learner, &run).expect("it counts steps").ledger.examples, 2 * 3);
}

#[test]
fn every_trainer_goes_by_features() {
    let (train, test) = (drawn::<Features>(&small(), 200, 1), drawn::<Features>(&small(), 100, 2));
    let learner = AnyLearner::Logistic(Logistic::default());
    // The lowest action everywhere.
    let nothing = ratio(&test, &Ladder::<Linear>::of(Vec::new()));
    let (dagger, lols) = (Dagger { rounds: 3, ..Dagger::default() }, Lols { rounds: 4, ..Lols::default() });
    let searn = Searn { beta: 0.5, rounds: 2, samples: 1, warm: false };
    for trainer in [
        Trainer::Supervised(Supervised::default()),
        Trainer::Forward(Forward { warm: true, ..Forward::default() }),
        Trainer::Smile(Smile { alpha: 0.5, rounds: 3, ..Smile::default() }),
        Trainer::Searn(searn.clone()),
        Trainer::SearnShortcut(searn),
        Trainer::Dagger(dagger.clone()),
        Trainer::DaggerOnline(dagger),
        Trainer::Aggrevate(Aggrevate { rounds: 3, ..Aggrevate::default() }),
        Trainer::Lols(lols.clone()),
        Trainer::LolsOnline(lols),
        Trainer::Stacked(Stacking { folds: 2, window: 1 }),
        Trainer::EarlyUpdate(EarlyUpdate { width: 2, rounds: 3 }),
    ] {
        let trained = trainer.train(&train, &learner, &Run::new(1)).expect("settings in range");
        let costs = trained.policy.perform_from(&test, 0, Seed::new(3)).0.costs;
        let ratio = test.space.world().ratio(&costs).expect("no way is free");
        assert!(1.0 <= ratio && ratio < 0.6 * nothing, "{trainer:?}: {ratio}, and {nothing} for nothing learned");
    }
}

fn at<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(work)
}

#[test]
fn threads_change_nothing_and_seeds_do() {
    let maps = Maps { rough: 0.5, ..small() };
    let run = |threads, seed| {
        at(threads, || {
            let problem = drawn::<Place>(&maps, 40, 1);
            let smile = Smile { alpha: 0.5, rounds: 3, ..Smile::default() };
            let trained = smile.train(&problem, &MaximumMargin::default(), &Run::new(seed)).expect("in range");
            let weights: Vec<Vec<u64>> = trained
                .policy
                .members()
                .iter()
                .map(|(_, planner)| planner.weights.iter().map(|w| w.to_bits()).collect())
                .collect();
            (weights, perform(&problem, &trained.policy, Seed::new(5)).0.actions, trained.ledger)
        })
    };
    let one = run(1, 1);
    assert!(one == run(2, 1) && one == run(5, 1));
    assert!(one.0 != run(1, 2).0);
}

/// A memory that has served for other states gives the scores of a new one, and the best action has score 0.
#[test]
fn scores_do_not_depend_on_what_was_asked_before() {
    let problem = drawn::<Place>(&small(), 8, 1);
    let space = &problem.space;
    let planner =
        Supervised::default().train(&problem, &MaximumMargin::default(), &Run::new(1)).expect("trains").policy.0;
    let mut kept = Default::default();
    for i in 0..400u64 {
        let trip = (Seed::new(i).unit() * 8.0) as u32;
        let mut state = space.start(Episode { index: trip as usize, seed: Seed::new(i) });
        if i % 2 == 0 {
            let first = space.legal(&state).nth(0);
            space.step(&mut state, first, Seed::new(i));
        }
        if space.legal(&state).is_empty() {
            continue;
        }
        let mut view = Place::default();
        space.look(&state, &mut view);
        let sight = Sight { shared: space.shared(), view: &view, legal: space.legal(&state) };
        let fresh = planner.scores(&sight, &mut Default::default()).to_vec();
        assert_eq!(planner.scores(&sight, &mut kept), fresh);
        let Action(best) = planner.choose(&sight, &mut kept);
        assert_eq!(fresh[best as usize], 0.0);
    }
}

/// Supervised imitation asks once for each step of the cheapest ways.
#[test]
fn the_bill_is_that_of_the_cheapest_ways() {
    let problem = drawn::<Features>(&small(), 20, 3);
    let trained = Supervised::default().train(&problem, &Perceptron::default(), &Run::new(1)).expect("trains");
    let ways: usize = (0..20)
        .map(|trip| {
            let world = problem.space.world();
            let (network, _) = world.target(world.goal(trip));
            world.cheapest(world.goal(trip)).way(network, world.trips()[trip].start as u32).count()
        })
        .sum();
    let ledger = trained.ledger;
    assert_eq!([ledger.labels, ledger.expert_acts, ledger.steps, ledger.examples], [ways as u64; 4]);
}
