//! Small random graphs, and worlds of maps.

use petgraph::graph::{DiGraph, NodeIndex};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rollin::Seed;
use rollin::policy::Policy;
use rollin::roll::perform;
use rollin::space::{Expert, Imitation};
use rollin::tasks::navigation::{Cheapest, Eyes, Legend, Maps, Navigation, Road, Site, Trip, World};

/// `cases` cases that are the same in every run.
pub fn fixed(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(2010), failure_persistence: None, ..ProptestConfig::default() }
}

pub const LEGEND: Legend = Legend { actions: 4, roads: 3, sites: 2 };

/// Graphs of 2 to 7 nodes on a ring, so that there is a way from everywhere to everywhere, with up to three more edges out of each, of
/// which many cost nothing.
pub fn graphs() -> impl Strategy<Value = DiGraph<Site, Road>> {
    let edge = (0..7usize, 0..4u32, 0..3u32);
    (2..=7usize).prop_flat_map(move |n| vec((vec(edge.clone(), 0..=3), 0..4u32), n)).prop_map(|drawn| {
        let n = drawn.len();
        let mut graph = DiGraph::new();
        for i in 0..n {
            graph.add_node(Site { at: [(i * i % 5) as f64, (i % 3) as f64], features: vec![i as u32 % 2] });
        }
        for (from, (edges, around)) in drawn.into_iter().enumerate() {
            // The way around has the last action, so that the order of the edges is not that of the actions.
            let ring = (from + 1, around, 2);
            for (action, (to, cost, feature)) in std::iter::once(ring).chain(edges).enumerate() {
                let road = Road { action: 3 - action as u32, cost: f64::from(cost), features: vec![feature] };
                graph.add_edge(NodeIndex::new(from), NodeIndex::new(to % n), road);
            }
        }
        graph
    })
}

/// One trip from each node but 0 to node 0.
pub fn world(graph: DiGraph<Site, Road>, horizon: usize) -> World {
    let trips: Vec<Trip> = (1..graph.node_count()).map(|start| Trip { map: 0, start, goal: 0, horizon }).collect();
    World::new(LEGEND, &[graph], &trips).expect("a connected graph")
}

/// Navigation on `count` maps.
pub fn drawn<V: Eyes>(maps: &Maps, count: usize, seed: u64) -> Imitation<Navigation<V>, Cheapest> {
    let seed = Seed::new(seed);
    Navigation::new(maps.world(&maps.grids(count, seed).expect("drawn"), seed).expect("a world")).problem()
}

/// The path cost ratio of `policy`.
pub fn ratio<V: Eyes, E, D>(problem: &Imitation<Navigation<V>, E>, policy: &D) -> f64
where
    E: Expert<Navigation<V>>,
    D: Policy<Imitation<Navigation<V>, E>>,
{
    let costs = perform(problem, policy, Seed::new(99)).0.costs;
    problem.space.world().ratio(&costs).expect("no way is free")
}
