//! What is refused, and in what words.

use petgraph::graph::{DiGraph, NodeIndex};
use rollin::Seed;
use rollin::read::grid;
use rollin::tasks::navigation::{Legend, Maps, Road, Site, Trip, World};

const LEGEND: Legend = Legend { actions: 2, roads: 2, sites: 1 };
const TRIP: Trip = Trip { map: 0, start: 0, goal: 1, horizon: 4 };

fn graph(edges: &[(u32, u32, Road)]) -> DiGraph<Site, Road> {
    let mut graph = DiGraph::new();
    for _ in 0..3 {
        graph.add_node(Site::default());
    }
    for (from, to, road) in edges {
        graph.add_edge(NodeIndex::new(*from as usize), NodeIndex::new(*to as usize), road.clone());
    }
    graph
}

fn road(action: u32, cost: f64) -> Road {
    Road { action, cost, features: vec![] }
}

fn refused(graph: DiGraph<Site, Road>, trip: Trip, expected: &str) {
    let error = World::new(LEGEND, &[graph], &[trip]).expect_err(expected).to_string();
    assert!(error.starts_with(expected), "{error}\n  not {expected}");
}

#[test]
fn costs_that_are_none() {
    for (cost, name) in [(-1.0, "-1"), (f64::NAN, "NaN"), (f64::INFINITY, "inf"), (1e13, "10000000000000")] {
        let expected = format!("cost is {name} from node 0 to node 1 of map 0, but must be from 0 to 1e12");
        refused(graph(&[(0, 1, road(0, cost))]), TRIP, &expected);
    }
}

#[test]
fn graphs_that_are_none() {
    let with = |features: Vec<u32>| graph(&[(0, 1, Road { features, ..road(0, 1.0) })]);
    refused(with(vec![0, 2]), TRIP, "road features is 2 from node 0 to node 1 of map 0, but must be below 2");
    refused(with(vec![1, 0, 1]), TRIP, "road features is 1 twice from node 0 to node 1");
    refused(graph(&[(0, 1, road(2, 1.0))]), TRIP, "action is 2 from node 0 to node 1 of map 0, but must be below 2");
    let twice = graph(&[(0, 1, road(1, 1.0)), (0, 2, road(1, 1.0))]);
    refused(twice, TRIP, "action is 1 from node 0 to node 2 of map 0, but must be another for each edge");
    let mut odd = graph(&[(0, 1, road(0, 1.0))]);
    odd[NodeIndex::new(2)].features = vec![1];
    refused(odd.clone(), TRIP, "site features is 1 of node 2 of map 0, but must be below 1");
    odd[NodeIndex::new(2)] = Site { at: [0.0, f64::NAN], features: vec![0] };
    refused(odd, TRIP, "at is [0.0, NaN] of node 2 of map 0");
    let vast = Legend { actions: usize::MAX, roads: 2, sites: 1 };
    assert!(World::new(vast, &[], &[]).is_err());
}

#[test]
fn trips_that_are_none() {
    let good = || graph(&[(0, 1, road(0, 1.0)), (1, 0, road(0, 1.0))]);
    refused(good(), Trip { map: 1, ..TRIP }, "map is 1 of trip 0, but must be below 1");
    refused(good(), Trip { start: 3, ..TRIP }, "start is node 3 of trip 0, but must be below 3");
    refused(good(), Trip { goal: 9, ..TRIP }, "goal is node 9 of trip 0, but must be below 3");
    refused(good(), Trip { goal: 0, ..TRIP }, "goal is node 0 of trip 0, its start, but must be another node");
    refused(good(), Trip { horizon: 0, ..TRIP }, "horizon is 0 of trip 0");
    refused(good(), Trip { goal: 2, ..TRIP }, "goal is node 2 of trip 0, to which there is no way from node 0");
    // One can come to node 2, from where there is no way on.
    let trap = graph(&[(0, 1, road(0, 1.0)), (0, 2, road(1, 1.0))]);
    refused(trap, TRIP, "goal is node 1 of trip 0, to which there is no way from node 2");
    // Behind the goal one never comes.
    assert!(World::new(LEGEND, &[graph(&[(0, 1, road(0, 1.0)), (1, 2, road(1, 1.0))])], &[TRIP]).is_ok());
}

#[test]
fn maps_that_cannot_be_drawn() {
    let seed = Seed::new(1);
    let good = Maps::default();
    for (maps, name) in [
        (Maps { width: 0, ..good.clone() }, "cells is 0"),
        (Maps { width: usize::MAX, ..good.clone() }, "cells is "),
        (Maps { patches: 0, ..good.clone() }, "patches is 0"),
        (Maps { walls: 1.0, ..good.clone() }, "walls is 1"),
        (Maps { walls: f64::NAN, ..good.clone() }, "walls is NaN"),
        (Maps { walls: 0.9999, width: 3, height: 3, patches: 2, ..good.clone() }, "walls is 0.9999"),
        (Maps { costs: vec![], ..good.clone() }, "costs is 0 numbers"),
    ] {
        let error = maps.grids(1, seed).expect_err(name).to_string();
        assert!(error.starts_with(name), "{error}");
    }
    let grids = grid::parse("ab\n1,1 -> 2,1\n", "m", 2).expect("a map");
    let world = |maps: Maps| maps.world(&grids, seed).map(|_| ()).map_err(|error| error.to_string());
    assert!(world(Maps { costs: vec![1.0], ..good.clone() }).expect_err("no cost").starts_with("terrain is 1"));
    assert!(world(Maps { costs: vec![1.0, -1.0], ..good.clone() }).expect_err("negative").starts_with("cost is -1"));
    assert!(world(Maps { rough: 1.0, ..good }).expect_err("rough").starts_with("rough is 1"));
}

/// Maps are the same for the same seed, others for another, and come back from their text.
#[test]
fn maps_hang_below_their_seed() {
    let maps = Maps::default();
    let draw = |count, seed| maps.grids(count, Seed::new(seed)).expect("drawn");
    assert_eq!(draw(3, 1)[..2], draw(2, 1));
    assert_ne!(draw(1, 1), draw(1, 2));
    let drawn = draw(5, 3);
    let text = drawn.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    assert_eq!(grid::parse(&text, "maps", 5).expect("they are maps"), drawn);
    for grid in &drawn {
        let [start, goal] = grid.trips[0];
        assert!((start % 16).abs_diff(goal % 16) + (start / 16).abs_diff(goal / 16) >= 16);
    }
}
