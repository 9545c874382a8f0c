//! Maximum margin planning: a step worked by hand, and maps on which it finds the expert's costs.

use crate::common::{drawn, fixed, graphs, ratio, world};
use petgraph::graph::DiGraph;
use proptest::prelude::*;
use rollin::Seed;
use rollin::learner::{Examples, Learner, Setting, Target};
use rollin::policy::Greedy;
use rollin::space::{Action, Actions};
use rollin::tasks::navigation::{Legend, Maps, MaximumMargin, Place, Planner, Road, Site, Trip, World};
use rollin::trainer::{Dagger, Forward, Run, Smile, Supervised};

/// Three edges in parallel to the goal, with one feature each but for the last, which has the first two.
fn parallel() -> World {
    let mut graph = DiGraph::new();
    let (home, goal) = (graph.add_node(Site::default()), graph.add_node(Site::default()));
    for (action, features) in [vec![0], vec![1], vec![0, 1]].into_iter().enumerate() {
        graph.add_edge(home, goal, Road { action: action as u32, cost: 1.0, features });
    }
    let trip = Trip { map: 0, start: 0, goal: 1, horizon: 1 };
    World::new(Legend { actions: 3, roads: 2, sites: 0 }, &[graph], &[trip]).expect("a world")
}

fn fit(world: &World, learner: &MaximumMargin, label: Action, warm: &[f64]) -> Planner {
    let mut examples = Examples::default();
    examples.push(&Place { goal: 0, node: 0 }, Actions::Only(world.target(0).0.actions(0)), Target::Label(label));
    let warm = Planner { weights: warm.to_vec() };
    learner.fit(Setting { shared: world, actions: 3 }, &examples, Some(&warm), Seed::new(1))
}

/// From given weights, with the one example that the expert takes a certain edge.
#[test]
fn steps_worked_by_hand() {
    let world = parallel();
    let one = MaximumMargin { passes: 1, rate: 0.25, l2: 0.0, margin: 1.0 };
    // The expert takes edge 1 with cost 1 + 1. Edge 0 at 1 + 1 - 1 is the temptation, edge 2 at 1 + 2 - 1 is not.
    // Gradient (-1, 1), AdaGrad's first step is the rate: (1.25, 0.75); all changes came at time 0, so that is also the average.
    assert_eq!(fit(&world, &one, Action(1), &[1.0, 1.0]).weights, [1.25, 0.75]);
    // Who is right by the margin changes nothing: 1 + 0.5 against 1 + 1.5 - 1, of equals the lowest, which is not the label ...
    assert_eq!(fit(&world, &one, Action(1), &[1.5, 0.5]).weights, [1.75, 0.25]);
    // ... and by more than the margin the label's own edge is the minimum.
    assert_eq!(fit(&world, &one, Action(1), &[1.75, 0.5]).weights, [1.75, 0.5]);
    // A weight stops at 0.
    assert_eq!(fit(&world, &one, Action(1), &[0.5, 0.125]).weights, [0.75, 0.0]);
    // Without a margin it is enough to be no dearer and lower in number.
    let bare = MaximumMargin { margin: 0.0, ..one.clone() };
    assert_eq!(fit(&world, &bare, Action(0), &[1.0, 1.0]).weights, [1.0, 1.0]);
    // Two passes from (1, 1): gradients (-1, 1) and (-1, 1) again, at 1 + 0.75 against 1 + 1.25 - 1; sums of squares 1 and 2, changes 0.25 and
    // 0.25/sqrt(2) at times 0 and 1. The average takes half of the second back.
    let two = fit(&world, &MaximumMargin { passes: 2, ..one }, Action(1), &[1.0, 1.0]).weights;
    let half = 0.125 / 2f64.sqrt();
    assert!((two[0] - 1.25 - half).abs() < 1e-12 && (two[1] - 0.75 + half).abs() < 1e-12, "{two:?}");
}

proptest! {
    #![proptest_config(fixed(200))]

    /// Any labels whatever, of a confused expert, several for one state, in circles: weights are numbers and not negative.
    #[test]
    fn no_labels_are_too_odd(graph in graphs(), drawn in prop::collection::vec((1..7u32, 0..4usize, 0..5u32), 0..12)) {
        let world = world(graph, 5);
        let mut examples = Examples::default();
        let (network, _) = world.target(0);
        for (node, place, cost) in drawn.into_iter().filter(|(node, ..)| (*node as usize) < network.nodes()) {
            let legal = Actions::Only(network.actions(node));
            let label = legal.nth(place % legal.len());
            let mut costs = vec![1.0; legal.len()];
            costs[place % legal.len()] = cost as f32;
            let target = if cost < 3 { Target::Label(label) } else { Target::Costs(&costs) };
            examples.push(&Place { goal: 0, node }, legal, target);
        }
        let planner = MaximumMargin { passes: 4, ..MaximumMargin::default() }
            .fit(Setting { shared: &world, actions: 4 }, &examples, None, Seed::new(1));
        prop_assert!(planner.weights.iter().all(|w| w.is_finite() && *w >= 0.0));
    }
}

/// Where the expert's costs are linear in what is seen, the learner's planner takes ways as cheap as the expert's on maps that it has never seen.
#[test]
fn the_expert_is_recovered() {
    let maps = Maps { width: 10, height: 10, patches: 25, costs: vec![1.0, 3.0, 9.0], ..Maps::default() };
    let (train, test) = (drawn::<Place>(&maps, 60, 1), drawn::<Place>(&maps, 60, 2));
    let (learner, run) = (MaximumMargin::default(), Run::new(1));
    let supervised = Supervised::default().train(&train, &learner, &run).expect("trains").policy;
    let smile = Smile { alpha: 0.5, rounds: 3, ..Smile::default() }.train(&train, &learner, &run).expect("trains");
    let dagger = Dagger { rounds: 3, ..Dagger::default() }.train(&train, &learner, &run).expect("trains");
    let forward = Forward { warm: true, ..Forward::default() }.train(&train, &learner, &run).expect("trains");
    let ratios = [
        ratio(&test, &supervised),
        ratio(&test, &smile.policy),
        ratio(&test, &dagger.policy),
        ratio(&test, &forward.policy),
        ratio(&test, &Greedy(Planner { weights: vec![0.0; 3] })),
    ];
    assert!(ratios[..3].iter().all(|ratio| *ratio < 1.002), "{ratios:?}");
    assert!(ratios[3] < 1.05 && ratios[4] > 1.2, "{ratios:?}");
}
