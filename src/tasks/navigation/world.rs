//! Graphs, and the ways that are to be found in them.

use super::network::{Network, Road, Site};
use super::plan::Plan;
use crate::error::{Error, Result};
use crate::space::{FeatureTable, Features};
use petgraph::graph::DiGraph;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How things are numbered in all graphs that one policy is to move in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Legend {
    /// How many actions there are.
    pub actions: usize,
    /// How many features edges have.
    pub roads: usize,
    /// How many features nodes have.
    pub sites: usize,
}

/// Directions that are told apart: which of the goal's coordinates are less, equal or more, and which of the two is further off.
const COMPASS: usize = 27;

impl Legend {
    /// How many features there are for a classifier over features. First come those of the node, then those of each edge out of it,
    /// by action; then the direction of the goal; then the features of each edge together with the direction.
    pub fn features(self) -> usize {
        let roads = self.actions.saturating_mul(self.roads);
        roads.saturating_mul(COMPASS + 1).saturating_add(self.sites).saturating_add(COMPASS)
    }

    fn road(self, action: u32, feature: u32) -> u32 {
        (self.sites + action as usize * self.roads) as u32 + feature
    }

    fn compass(self, direction: usize) -> u32 {
        (self.sites + self.actions * self.roads + direction) as u32
    }

    fn together(self, direction: usize, road: u32) -> u32 {
        self.compass(COMPASS) + (direction * self.actions * self.roads) as u32 + (road - self.sites as u32)
    }
}

/// A way to be found: an episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trip {
    /// In which graph, from 0.
    pub map: usize,
    /// From which node.
    pub start: usize,
    /// To which other node.
    pub goal: usize,
    /// In how many steps at most.
    pub horizon: usize,
}

/// Graphs in flat arrays, the trips to be made in them, and the exact cost-to-go to each of their goals.
#[derive(Clone, Debug)]
pub struct World {
    legend: Legend,
    networks: Vec<Network>,
    trips: Vec<Trip>,
    /// The goal of each trip, by its number in `goals`.
    ends: Vec<u32>,
    /// Different goals: map, node and the cheapest ways there.
    goals: Vec<(usize, u32, Plan)>,
    /// The row of node n of map m is `rows[m] + n`.
    rows: Vec<usize>,
    places: Vec<[f64; 2]>,
    table: FeatureTable,
}

impl World {
    /// The world of these `graphs` and `trips`.
    ///
    /// # Errors
    /// When a graph cannot be frozen ([`Network::freeze`]), a trip names what is not there, starts at its goal, has no steps, or can come to
    /// a node from which there is no way to its goal.
    pub fn new(legend: Legend, graphs: &[DiGraph<Site, Road>], trips: &[Trip]) -> Result<Self> {
        if legend.features() > u32::MAX as usize {
            return Err(Error::argument("legend", format!("{legend:?}"), "fewer than 2^32 features for a classifier"));
        }
        let freeze = |(map, graph)| Network::freeze(graph, legend, map);
        let networks = graphs.iter().enumerate().map(freeze).collect::<Result<Vec<_>>>()?;
        let mut numbers = BTreeMap::new();
        let mut ends = Vec::new();
        for (i, trip) in trips.iter().enumerate() {
            check_trip(i, trip, &networks)?;
            let next = numbers.len() as u32;
            ends.push(*numbers.entry((trip.map, trip.goal as u32)).or_insert(next));
        }
        let mut goals: Vec<(usize, u32, Plan)> = vec![(0, 0, Plan::default()); numbers.len()];
        numbers.into_iter().for_each(|((map, node), number)| goals[number as usize] = (map, node, Plan::default()));
        goals.par_iter_mut().for_each(|(map, node, plan)| {
            let network = &networks[*map];
            plan.towards(network, *node, |edge| network.cost(edge));
        });
        for (i, (trip, end)) in trips.iter().zip(&ends).enumerate() {
            check_way(i, trip, &networks[trip.map], &goals[*end as usize].2)?;
        }
        let rows =
            graphs.iter().scan(0, |sum, graph| Some(std::mem::replace(sum, *sum + graph.node_count()))).collect();
        let places = graphs.iter().flat_map(|graph| graph.node_weights().map(|site| site.at)).collect();
        let table = table(legend, graphs, &networks);
        Ok(World { legend, networks, trips: trips.to_vec(), ends, goals, rows, places, table })
    }

    /// How things are numbered.
    pub fn legend(&self) -> Legend {
        self.legend
    }

    /// The trips.
    pub fn trips(&self) -> &[Trip] {
        &self.trips
    }

    /// The number of the goal of trip `trip`.
    #[inline]
    pub fn goal(&self, trip: usize) -> u32 {
        self.ends[trip]
    }

    /// The network that goal number `goal` lies in, and its node there.
    #[inline]
    pub fn target(&self, goal: u32) -> (&Network, u32) {
        let (map, node, _) = &self.goals[goal as usize];
        (&self.networks[*map], *node)
    }

    /// The cheapest ways to goal number `goal`, at what edges truly cost.
    #[inline]
    pub fn cheapest(&self, goal: u32) -> &Plan {
        &self.goals[goal as usize].2
    }

    /// What the cheapest way of trip `trip` costs.
    pub fn optimum(&self, trip: usize) -> f64 {
        self.cheapest(self.goal(trip)).value(self.trips[trip].start as u32)
    }

    /// The path cost ratio: what all trips cost together, `costs[i]` for trip i, over what the cheapest ways cost. None when those are free.
    pub fn ratio(&self, costs: &[f64]) -> Option<f64> {
        let least: f64 = (0..self.trips.len()).map(|trip| self.optimum(trip)).sum();
        (least > 0.0).then(|| costs.iter().sum::<f64>() / least)
    }

    /// The static features of all nodes.
    pub fn table(&self) -> &FeatureTable {
        &self.table
    }

    /// Writes what a classifier over features sees at `node` on the way to goal number `goal`.
    pub fn features(&self, goal: u32, node: u32, view: &mut Features) {
        let (map, end, _) = self.goals[goal as usize];
        let row = self.rows[map] + node as usize;
        let ([x, y], [to_x, to_y]) = (self.places[row], self.places[self.rows[map] + end as usize]);
        let (right, up) = (to_x - x, to_y - y);
        let direction = 9 * side(right, 0.0) + 3 * side(up, 0.0) + side(right.abs(), up.abs());
        view.row = row as u32;
        view.dynamic.clear();
        view.dynamic.push(self.legend.compass(direction));
        let network = &self.networks[map];
        for edge in network.out(node) {
            let action = network.action(edge).0;
            let seen = network.features(edge).iter().map(|feature| self.legend.road(action, *feature));
            view.dynamic.extend(seen.map(|road| self.legend.together(direction, road)));
        }
    }
}

/// 0, 1 or 2: `a` is less than, as large as or larger than `b`.
fn side(a: f64, b: f64) -> usize {
    if a < b { 0 } else { 1 + usize::from(a > b) }
}

/// The row of each node: its own features and those of the edges out of it, by action.
fn table(legend: Legend, graphs: &[DiGraph<Site, Road>], networks: &[Network]) -> FeatureTable {
    let (mut starts, mut ids) = (vec![0], Vec::new());
    for (graph, network) in graphs.iter().zip(networks) {
        for (node, site) in graph.node_weights().enumerate() {
            ids.extend(&site.features);
            for edge in network.out(node as u32) {
                let action = network.action(edge).0;
                ids.extend(network.features(edge).iter().map(|feature| legend.road(action, *feature)));
            }
            starts.push(ids.len());
        }
    }
    FeatureTable::from_rows(legend.features(), starts, ids)
}

/// Refuses a trip that names what is not there.
fn check_trip(i: usize, trip: &Trip, networks: &[Network]) -> Result<()> {
    let Some(network) = networks.get(trip.map) else {
        return Err(Error::argument("map", format!("{} of trip {i}", trip.map), format!("below {}", networks.len())));
    };
    for (name, node) in [("start", trip.start), ("goal", trip.goal)] {
        if node >= network.nodes() {
            return Err(Error::argument(
                name,
                format!("node {node} of trip {i}"),
                format!("below {}", network.nodes()),
            ));
        }
    }
    if trip.start == trip.goal {
        return Err(Error::argument("goal", format!("node {} of trip {i}, its start", trip.goal), "another node"));
    }
    if trip.horizon == 0 || trip.horizon > u32::MAX as usize {
        return Err(Error::argument("horizon", format!("{} of trip {i}", trip.horizon), "from 1 to 2^32-1"));
    }
    Ok(())
}

/// Refuses a trip that can come to where there is no way to its goal.
fn check_way(i: usize, trip: &Trip, network: &Network, plan: &Plan) -> Result<()> {
    let mut seen = vec![false; network.nodes()];
    let mut open = vec![trip.start as u32];
    seen[trip.start] = true;
    while let Some(node) = open.pop() {
        if plan.value(node).is_infinite() {
            let value = format!("node {} of trip {i}, to which there is no way from node {node}", trip.goal);
            return Err(Error::argument("goal", value, "a node that can be reached from wherever the trip may come"));
        }
        if node as usize == trip.goal {
            continue; // The trip has ended.
        }
        for head in network.out(node).map(|edge| network.head(edge)) {
            if !std::mem::replace(&mut seen[head as usize], true) {
                open.push(head);
            }
        }
    }
    Ok(())
}
