//! Explicit graphs: handed in as petgraph's, run on as flat arrays.

use super::Legend;
use crate::error::{Error, Result};
use crate::space::Action;
use petgraph::graph::{DiGraph, EdgeReference};
use petgraph::visit::EdgeRef;

/// What the expert may pay for one edge, at most: sums over paths then stay exact enough to compare.
const MOST: f64 = 1e12;

/// A node of a graph that is handed in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Site {
    /// Where it lies: x and y, in any unit. A classifier over features sees in which direction the goal is.
    pub at: [f64; 2],
    /// What a classifier over features sees from here: binary features below [`Legend::sites`], each at most once.
    pub features: Vec<u32>,
}

/// An edge of a graph that is handed in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Road {
    /// The number of the action that takes it: below [`Legend::actions`], and another for each edge out of a node.
    pub action: u32,
    /// What it costs: from 0 to 1e12. The expert knows, learners do not.
    pub cost: f64,
    /// What everybody sees of it: binary features below [`Legend::roads`], each at most once.
    pub features: Vec<u32>,
}

/// A weighted directed graph in flat arrays. Edges are numbered by their tail, and within a node by their action.
#[derive(Clone, Debug)]
pub struct Network {
    /// The edges out of node n are `starts[n]..starts[n+1]`.
    starts: Vec<usize>,
    actions: Vec<Action>,
    tails: Vec<u32>,
    heads: Vec<u32>,
    costs: Vec<f64>,
    /// The features of edge e are `features[spans[e]..spans[e+1]]`.
    spans: Vec<usize>,
    features: Vec<u32>,
    /// The edges into node n are `into[doors[n]..doors[n+1]]`.
    doors: Vec<usize>,
    into: Vec<u32>,
}

impl Network {
    /// Freezes `graph`, which is called map `map` in errors.
    ///
    /// # Errors
    /// When a cost is negative, infinite or not a number, two edges out of a node have the same action, or a number is not below what
    /// `legend` says.
    pub fn freeze(graph: &DiGraph<Site, Road>, legend: Legend, map: usize) -> Result<Self> {
        for node in graph.node_indices() {
            let blame = || format!("of node {} of map {map}", node.index());
            check_features("site features", &graph[node].features, legend.sites, blame)?;
            if graph[node].at.iter().any(|x| !x.is_finite()) {
                return Err(Error::argument("at", format!("{:?} {}", graph[node].at, blame()), "two finite numbers"));
            }
        }
        let mut edges: Vec<_> = graph.edge_references().collect();
        edges.sort_by_key(|edge| (edge.source(), edge.weight().action));
        check_edges(&edges, legend, map)?;
        let tails: Vec<u32> = edges.iter().map(|edge| edge.source().index() as u32).collect();
        let heads: Vec<u32> = edges.iter().map(|edge| edge.target().index() as u32).collect();
        let mut into: Vec<u32> = (0..edges.len() as u32).collect();
        into.sort_by_key(|edge| (heads[*edge as usize], *edge));
        let nodes = graph.node_count();
        Ok(Network {
            starts: offsets(nodes, tails.iter().map(|tail| *tail as usize)),
            doors: offsets(nodes, into.iter().map(|edge| heads[*edge as usize] as usize)),
            spans: std::iter::once(0)
                .chain(edges.iter().scan(0, |end, edge| {
                    *end += edge.weight().features.len();
                    Some(*end)
                }))
                .collect(),
            features: edges.iter().flat_map(|edge| edge.weight().features.iter().copied()).collect(),
            actions: edges.iter().map(|edge| Action(edge.weight().action)).collect(),
            costs: edges.iter().map(|edge| edge.weight().cost).collect(),
            tails,
            heads,
            into,
        })
    }

    /// How many nodes there are.
    pub fn nodes(&self) -> usize {
        self.starts.len() - 1
    }

    /// How many edges there are.
    pub fn edges(&self) -> usize {
        self.heads.len()
    }

    /// The numbers of the edges out of `node`, by ascending action.
    #[inline]
    pub fn out(&self, node: u32) -> std::ops::Range<usize> {
        self.starts[node as usize]..self.starts[node as usize + 1]
    }

    /// The edges into `node`.
    #[inline]
    pub fn into(&self, node: u32) -> &[u32] {
        &self.into[self.doors[node as usize]..self.doors[node as usize + 1]]
    }

    /// The actions of the edges out of `node`, in their order.
    #[inline]
    pub fn actions(&self, node: u32) -> &[Action] {
        &self.actions[self.out(node)]
    }

    /// The edge that `action` takes out of `node`, if there is one.
    #[inline]
    pub fn edge(&self, node: u32, action: Action) -> Option<usize> {
        self.actions(node).binary_search(&action).ok().map(|place| self.starts[node as usize] + place)
    }

    /// The action that takes `edge`.
    #[inline]
    pub fn action(&self, edge: usize) -> Action {
        self.actions[edge]
    }

    /// The node that `edge` leaves.
    #[inline]
    pub fn tail(&self, edge: usize) -> u32 {
        self.tails[edge]
    }

    /// The node that `edge` leads to.
    #[inline]
    pub fn head(&self, edge: usize) -> u32 {
        self.heads[edge]
    }

    /// What `edge` costs.
    #[inline]
    pub fn cost(&self, edge: usize) -> f64 {
        self.costs[edge]
    }

    /// What is seen of `edge`.
    #[inline]
    pub fn features(&self, edge: usize) -> &[u32] {
        &self.features[self.spans[edge]..self.spans[edge + 1]]
    }
}

/// Refuses edges that cannot be frozen, of which those out of one node stand together, by action.
fn check_edges(edges: &[EdgeReference<'_, Road>], legend: Legend, map: usize) -> Result<()> {
    for (i, edge) in edges.iter().enumerate() {
        let Road { action, cost, features } = edge.weight();
        let blame = || format!("from node {} to node {} of map {map}", edge.source().index(), edge.target().index());
        if !(0.0..=MOST).contains(cost) {
            return Err(Error::argument("cost", format!("{cost} {}", blame()), "from 0 to 1e12"));
        }
        if *action as usize >= legend.actions {
            let allowed = format!("below {}", legend.actions);
            return Err(Error::argument("action", format!("{action} {}", blame()), allowed));
        }
        if i > 0 && edges[i - 1].source() == edge.source() && edges[i - 1].weight().action == *action {
            return Err(Error::argument(
                "action",
                format!("{action} {}", blame()),
                "another for each edge out of a node",
            ));
        }
        check_features("road features", features, legend.roads, blame)?;
    }
    Ok(())
}

/// Where each of `nodes` groups starts and ends, of ascending `keys`.
fn offsets(nodes: usize, keys: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut offsets = vec![0; nodes + 1];
    keys.for_each(|key| offsets[key + 1] += 1);
    for n in 0..nodes {
        offsets[n + 1] += offsets[n];
    }
    offsets
}

/// Refuses features that are not below `count`, or are listed twice.
pub(crate) fn check_features(
    name: &'static str,
    features: &[u32],
    count: usize,
    blame: impl Fn() -> String,
) -> Result<()> {
    if let Some(feature) = features.iter().find(|feature| **feature as usize >= count) {
        return Err(Error::argument(name, format!("{feature} {}", blame()), format!("below {count}")));
    }
    let mut sorted = features.to_vec();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(Error::argument(name, format!("{} twice {}", pair[0], blame()), "each at most once")),
        None => Ok(()),
    }
}
