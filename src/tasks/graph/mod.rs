//! Labelling the nodes of graphs, one after the other, in an order that the user chooses.
//!
//! A node's view shows its own features and its neighbours', which never change, and the labels of those neighbours that are labelled
//! already. Graphs are handed in as petgraph's, or read from text ([`crate::read::graph`]) and labelled by a [`Labeller`]; in directed ones, neighbours by
//! edges that come and by edges that go are told apart.
//!
//! ```
//! use petgraph::graph::UnGraph;
//! use rollin::learner::Logistic;
//! use rollin::policy::Greedy;
//! use rollin::roll::perform;
//! use rollin::tasks::graph::{Labelling, Legend, Node, breadth_first};
//! use rollin::trainer::{Dagger, Run};
//!
//! // A chain whose first node says what it is; all others are like their neighbours.
//! let mut graph = UnGraph::<Node, ()>::new_undirected();
//! let nodes: Vec<_> = (0..5).map(|i| graph.add_node(Node { features: vec![u32::from(i > 0)], label: 1 })).collect();
//! (1..5).for_each(|i| { graph.add_edge(nodes[i - 1], nodes[i], ()); });
//! let order = breadth_first(&graph, nodes[0]);
//! let problem = Labelling::new(Legend { labels: 2, features: 2 }, &[(graph, order)])?.problem();
//! let trained = Dagger::default().train(&problem, &Logistic::default(), &Run::new(1))?;
//! assert_eq!(perform(&problem, &trained.policy, rollin::Seed::new(2)).0.costs, [0.0]);
//! # Ok::<(), rollin::Error>(())
//! ```

mod task;

pub use task::{Encoding, Labeller, Score, Visit};

use crate::error::{Error, Result};
use crate::seed::Seed;
use crate::space::{Action, Actions, CostToGo, Episode, Expert, FeatureTable, Features, Imitation, Space};
use crate::tasks::navigation::check_features;
use petgraph::graph::{Graph, NodeIndex};
use petgraph::visit::{Bfs, EdgeRef};
use petgraph::{Direction, EdgeType};
use serde::{Deserialize, Serialize};

/// A node of a graph that is handed in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Node {
    /// What is seen of it: binary features below [`Legend::features`], each at most once.
    pub features: Vec<u32>,
    /// Its right label, below [`Legend::labels`].
    pub label: u32,
}

/// A graph, and all of its nodes in the order in which they are labelled.
pub type Visits<E, Ty> = (Graph<Node, E, Ty>, Vec<NodeIndex>);

/// How labels and features are numbered in all graphs that one policy is to label.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Legend {
    /// How many labels there are.
    pub labels: usize,
    /// How many features nodes have.
    pub features: usize,
}

/// So many neighbours with the same label are counted one by one; more count as this many.
const MOST: u32 = 4;

/// By edges that go, by edges that come; all edges of an undirected graph go.
const WAYS: usize = 2;

impl Legend {
    /// How many features a view has: the node's own, those of its neighbours by each way, and by each way and for each label "at least k neighbours
    /// have it", k from 1 to 4.
    pub fn seen(self) -> usize {
        let neighbours = self.labels.saturating_mul(WAYS * MOST as usize);
        self.features.saturating_mul(1 + WAYS).saturating_add(neighbours)
    }

    fn neighbour(self, way: usize, label: u32, k: u32) -> u32 {
        ((1 + WAYS) * self.features + way * self.labels * MOST as usize) as u32 + label * MOST + k - 1
    }
}

/// Node labelling: an episode is a graph, an action the label of the node whose turn it is, and a wrong label costs 1.
#[derive(Clone, Debug)]
pub struct Labelling {
    legend: Legend,
    /// The nodes of graph g, in the order of their turns, are `starts[g]..starts[g+1]`.
    starts: Vec<usize>,
    gold: Vec<u32>,
    /// The neighbours of node n that are labelled before it, as turns within its graph: by way w,
    /// `before[spans[WAYS * n + w]..spans[WAYS * n + w + 1]]`.
    spans: Vec<usize>,
    before: Vec<u32>,
    table: FeatureTable,
}

/// A graph in part labelled.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Labelled {
    /// Which graph.
    pub graph: u32,
    /// The labels set so far, in the order of the turns.
    pub labels: Vec<u32>,
}

/// Who knows the right labels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gold;

/// The nodes as they are reached from `start`, the nearest first, and then those that are not, by number.
pub fn breadth_first<E, Ty: EdgeType>(graph: &Graph<Node, E, Ty>, start: NodeIndex) -> Vec<NodeIndex> {
    let mut seen = vec![false; graph.node_count()];
    let mut order = Vec::with_capacity(graph.node_count());
    if start.index() < graph.node_count() {
        let mut walk = Bfs::new(graph, start);
        while let Some(node) = walk.next(graph) {
            seen[node.index()] = true;
            order.push(node);
        }
    }
    order.extend(graph.node_indices().filter(|node| !seen[node.index()]));
    order
}

impl Labelling {
    /// Labelling these `graphs`, each in its order: all of its nodes, each once.
    ///
    /// # Errors
    /// When an order is none, or a label or feature is not below what `legend` says.
    pub fn new<E, Ty: EdgeType>(legend: Legend, graphs: &[Visits<E, Ty>]) -> Result<Self> {
        if legend.seen() > u32::MAX as usize {
            return Err(Error::argument("legend", format!("{legend:?}"), "fewer than 2^32 features for a view"));
        }
        let (mut starts, mut gold, mut spans, mut before) = (vec![0], Vec::new(), vec![0], Vec::new());
        let (mut rows, mut ids) = (vec![0], Vec::new());
        for (g, (graph, order)) in graphs.iter().enumerate() {
            check_nodes(legend, g, graph)?;
            let turns = turns(g, graph.node_count(), order)?;
            for (turn, &node) in order.iter().enumerate() {
                let site = &graph[node];
                gold.push(site.label);
                ids.extend(&site.features);
                for way in 0..WAYS {
                    let near = neighbours(graph, node, way);
                    before.extend(near.iter().map(|n| turns[n.index()]).filter(|other| (*other as usize) < turn));
                    spans.push(before.len());
                    let first = ids.len();
                    let shift = ((1 + way) * legend.features) as u32;
                    ids.extend(near.iter().flat_map(|n| &graph[*n].features).map(|feature| shift + feature));
                    ids[first..].sort_unstable();
                    dedup_from(&mut ids, first);
                }
                rows.push(ids.len());
            }
            starts.push(gold.len());
        }
        let table = FeatureTable::from_rows(legend.seen(), rows, ids);
        Ok(Labelling { legend, starts, gold, spans, before, table })
    }

    /// The problem of labelling all graphs as who knows the right labels.
    pub fn problem(self) -> Imitation<Self, Gold> {
        let episodes = self.starts.len() - 1;
        Imitation { space: self, expert: Gold, episodes }
    }

    /// How many nodes all graphs have together.
    pub fn nodes(&self) -> usize {
        self.gold.len()
    }

    /// The right label of the node whose turn it is.
    fn right(&self, state: &Labelled) -> u32 {
        self.gold[self.starts[state.graph as usize] + state.labels.len()]
    }
}

/// Removes what is listed twice in `ids` from `first` on, where equals stand together.
fn dedup_from(ids: &mut Vec<u32>, first: usize) {
    let mut kept = first;
    for i in first..ids.len() {
        if i == first || ids[i] != ids[kept - 1] {
            ids[kept] = ids[i];
            kept += 1;
        }
    }
    ids.truncate(kept);
}

/// The neighbours of `node` by way `way`, by number, each once and never itself.
fn neighbours<E, Ty: EdgeType>(graph: &Graph<Node, E, Ty>, node: NodeIndex, way: usize) -> Vec<NodeIndex> {
    let mut near: Vec<NodeIndex> = match (way, graph.is_directed()) {
        (0, _) => graph.edges_directed(node, Direction::Outgoing).map(|edge| edge.target()).collect(),
        (_, true) => graph.edges_directed(node, Direction::Incoming).map(|edge| edge.source()).collect(),
        (_, false) => Vec::new(),
    };
    near.retain(|other| *other != node);
    near.sort_unstable();
    near.dedup();
    near
}

/// Refuses labels and features that there are not.
fn check_nodes<E, Ty: EdgeType>(legend: Legend, g: usize, graph: &Graph<Node, E, Ty>) -> Result<()> {
    for node in graph.node_indices() {
        let Node { features, label } = &graph[node];
        let blame = || format!("of node {} of graph {g}", node.index());
        if *label as usize >= legend.labels {
            return Err(Error::argument("label", format!("{label} {}", blame()), format!("below {}", legend.labels)));
        }
        check_features("features", features, legend.features, blame)?;
    }
    Ok(())
}

/// The turn of each node.
fn turns(g: usize, nodes: usize, order: &[NodeIndex]) -> Result<Vec<u32>> {
    let mut turns = vec![u32::MAX; nodes];
    for (turn, node) in order.iter().enumerate() {
        match turns.get_mut(node.index()) {
            Some(free) if *free == u32::MAX => *free = turn as u32,
            Some(_) => {
                return Err(Error::argument("order", format!("node {} twice in graph {g}", node.index()), "each once"));
            }
            None => {
                let value = format!("node {} in graph {g}", node.index());
                return Err(Error::argument("order", value, format!("nodes below {nodes}")));
            }
        }
    }
    match turns.iter().position(|turn| *turn == u32::MAX) {
        Some(node) => Err(Error::argument("order", format!("without node {node} of graph {g}"), "all nodes")),
        None => Ok(turns),
    }
}

impl Space for Labelling {
    type State = Labelled;
    type View = Features;

    fn start(&self, episode: Episode) -> Labelled {
        let nodes = self.starts[episode.index + 1] - self.starts[episode.index];
        Labelled { graph: episode.index as u32, labels: Vec::with_capacity(nodes) }
    }

    fn legal<'a>(&'a self, state: &'a Labelled) -> Actions<'a> {
        let graph = state.graph as usize;
        let over = state.labels.len() >= self.starts[graph + 1] - self.starts[graph];
        if over { Actions::NONE } else { Actions::All(self.legend.labels as u32) }
    }

    fn look(&self, state: &Labelled, view: &mut Features) {
        let node = self.starts[state.graph as usize] + state.labels.len();
        view.row = node as u32;
        view.dynamic.clear();
        for way in 0..WAYS {
            let near = &self.before[self.spans[WAYS * node + way]..self.spans[WAYS * node + way + 1]];
            for (i, turn) in near.iter().enumerate() {
                let label = state.labels[*turn as usize];
                // Which of those with this label: few neighbours are counted faster than a table is cleared.
                let k = 1 + near[..i].iter().filter(|other| state.labels[**other as usize] == label).count() as u32;
                if k <= MOST {
                    view.dynamic.push(self.legend.neighbour(way, label, k));
                }
            }
        }
    }

    fn step(&self, state: &mut Labelled, action: Action, _: Seed) -> f64 {
        let cost = f64::from(u8::from(action.0 != self.right(state)));
        state.labels.push(action.0);
        cost
    }

    fn actions(&self) -> usize {
        self.legend.labels
    }

    fn horizon(&self, index: usize) -> Option<usize> {
        Some(self.starts[index + 1] - self.starts[index])
    }

    fn shared(&self) -> &FeatureTable {
        &self.table
    }
}

impl Expert<Labelling> for Gold {
    fn action(&self, space: &Labelling, state: &Labelled) -> Option<Action> {
        Some(Action(space.right(state)))
    }
}

impl CostToGo<Labelling> for Gold {
    fn costs(&self, space: &Labelling, state: &Labelled, costs: &mut Vec<f64>) {
        let right = space.right(state);
        costs.clear();
        costs.extend((0..space.legend.labels as u32).map(|label| f64::from(u8::from(label != right))));
    }
}
