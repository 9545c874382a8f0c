//! Labelling graphs as a [`Task`]: what the program's verbs need of it.

use super::{Gold, Labelling, Legend, Node, Visits, breadth_first};
use crate::corpus::Interner;
use crate::error::{Error, Result};
use crate::read::conll::Block;
use crate::read::graph::{self, Graph, Graphs, UNKNOWN};
use crate::space::{Action, Imitation};
use crate::tasks::{self, Arrays, Data, Fact, Measure, Model, Task, Units, write_labels};
use petgraph::graph::NodeIndex;
use petgraph::{Directed, EdgeType, Undirected};
use serde::{Deserialize, Serialize};
use std::cmp::Reverse;
use std::io::{self, Write};
use std::path::Path;

/// A trained labeller of graphs: labels, features and the order of visits, and the policy.
pub type Labeller = Model<Encoding>;

/// In which order the nodes of a graph are labelled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Visit {
    /// As they stand in the file.
    File,
    /// The first in the file, then those that are reached from it, the nearest first, then the others: [`breadth_first`].
    #[default]
    Bfs,
    /// Those with the most edges first; of equals the first in the file.
    Degree,
}

impl Visit {
    fn name(self) -> &'static str {
        match self {
            Visit::File => "file",
            Visit::Bfs => "bfs",
            Visit::Degree => "degree",
        }
    }

    fn order<Ty: EdgeType>(self, graph: &petgraph::Graph<Node, (), Ty>) -> Vec<NodeIndex> {
        let mut order: Vec<NodeIndex> = graph.node_indices().collect();
        match self {
            Visit::File => order,
            Visit::Bfs => breadth_first(graph, NodeIndex::new(0)),
            Visit::Degree => {
                let degree = |node: NodeIndex| graph.neighbors_undirected(node).count();
                order.sort_by_key(|node| Reverse(degree(*node)));
                order
            }
        }
    }
}

/// What turns the text of graphs into features and labels, and the order in which their nodes are visited.
#[derive(Clone, Debug)]
pub struct Encoding {
    labels: Interner,
    features: Interner,
    visit: Visit,
    /// Whether edges have a direction; nothing where none was ever seen.
    directed: Option<bool>,
}

/// What a model file says of a labeller.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    labels: Vec<String>,
    nodes: Vec<String>,
    visit: Visit,
    directed: Option<bool>,
}

/// How many nodes have their right label.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Score {
    /// Graphs.
    pub graphs: u64,
    /// Nodes in them.
    pub nodes: u64,
    /// Nodes with the right label.
    pub right_nodes: u64,
    /// Graphs whose nodes all have the right label.
    pub right_graphs: u64,
}

impl Encoding {
    fn legend(&self) -> Legend {
        Legend { labels: self.labels.len(), features: self.features.len() }
    }

    /// The graphs as petgraph's, each with its order. What was never seen in training is not seen; labels that were not, or are not known, are the first.
    fn visits<Ty: EdgeType>(&self, data: &Graphs) -> Vec<Visits<(), Ty>> {
        let known = |of: &Interner, all: &Interner| all.iter().map(|name| of.find(name)).collect::<Vec<_>>();
        let (labels, features) = (known(&self.labels, &data.labels), known(&self.features, &data.features));
        let build = |read: &Graph| {
            let mut graph = petgraph::Graph::with_capacity(read.nodes.len(), read.edges.len());
            for node in &read.nodes {
                let label = labels.get(node.label as usize).copied().flatten().unwrap_or(0);
                let features = node.features.iter().filter_map(|feature| features[*feature as usize]).collect();
                graph.add_node(Node { features, label });
            }
            for [from, to] in &read.edges {
                graph.add_edge(NodeIndex::new(*from as usize), NodeIndex::new(*to as usize), ());
            }
            let order = self.visit.order(&graph);
            (graph, order)
        };
        data.graphs.iter().map(build).collect()
    }

    /// The place of each node's action among those of all graphs, as the nodes stand in the file.
    fn turns(&self, data: &Graphs) -> Vec<usize> {
        let orders: Vec<Vec<NodeIndex>> = match data.directed {
            Some(true) => self.visits::<Directed>(data).into_iter().map(|(_, order)| order).collect(),
            _ => self.visits::<Undirected>(data).into_iter().map(|(_, order)| order).collect(),
        };
        let mut turns = vec![0; data.tokens()];
        let mut first = 0;
        for order in orders {
            order.iter().enumerate().for_each(|(turn, node)| turns[first + node.index()] = first + turn);
            first += order.len();
        }
        turns
    }

    /// Whether each node got its right label, as they stand in the file.
    fn hits(&self, data: &Graphs, actions: &[Action]) -> Vec<bool> {
        let gold = data.graphs.iter().flat_map(|graph| &graph.nodes);
        let said = self.turns(data).into_iter().map(|turn| self.labels.get(actions[turn].0));
        gold.zip(said).map(|(node, said)| node.label != UNKNOWN && data.labels.get(node.label) == said).collect()
    }
}

/// Refuses a node whose label is not known.
fn all_known(data: &Graphs, what: &str) -> Result<()> {
    match data.graphs.iter().flat_map(|graph| &graph.nodes).find(|node| node.label == UNKNOWN) {
        Some(node) => Err(Error::data(data.place(node), "no label", format!("graphs {what}: a label for every node"))),
        None => Ok(()),
    }
}

/// Nodes have the place of tokens.
impl Data for Graphs {
    fn path(&self) -> &Path {
        &self.path
    }
    fn sentences(&self) -> usize {
        self.graphs.len()
    }
    fn tokens(&self) -> usize {
        self.graphs.iter().map(|graph| graph.nodes.len()).sum()
    }
    fn truncate(&mut self, graphs: usize) {
        self.graphs.truncate(graphs);
    }
    fn split_off(&mut self, graphs: usize) -> Self {
        let rest = self.graphs.split_off(graphs);
        Graphs { graphs: rest, ..self.clone() }
    }
}

impl Task for Encoding {
    const NAME: &'static str = "graph";
    type Data = Graphs;
    type Settings = Visit;
    type Space = Labelling;
    type Expert = Gold;
    type Score = Score;
    type Header = Header;
    type Stream = ();

    const UNITS: Units = Units { episode: "graph", episodes: "graphs", steps: "nodes", loss: "wrong" };

    fn parse(text: &[u8], path: &Path) -> Result<Graphs> {
        match graph::parse(text, path, 1)? {
            Some(graphs) => Ok(graphs),
            None => Err(Error::file(path, "no graph", "give lines of nodes and edges")),
        }
    }

    fn parse_block(&self, block: &Block, path: &Path, (): &mut ()) -> Result<Option<Graphs>> {
        graph::parse(&block.bytes, path, block.first_line)
    }

    /// Only what occurs in `data` is learned, though names of what was cut off may still be known.
    fn learn(data: &Graphs, visit: Visit) -> Result<(Self, Imitation<Labelling, Gold>)> {
        all_known(data, "to learn from")?;
        let (mut labels, mut features) = (Interner::new(), Interner::new());
        for node in data.graphs.iter().flat_map(|graph| &graph.nodes) {
            labels.intern(data.labels.get(node.label));
            node.features.iter().for_each(|feature| {
                features.intern(data.features.get(*feature));
            });
        }
        let encoding = Encoding { labels, features, visit, directed: data.directed };
        let problem = encoding.apply(data)?.problem();
        Ok((encoding, problem))
    }

    fn apply(&self, data: &Graphs) -> Result<Labelling> {
        match (self.directed, data.directed) {
            (Some(false), Some(true)) => {
                Err(Error::file(&data.path, "edges with direction", "the model was trained on edges without"))
            }
            (Some(true), Some(false)) => {
                Err(Error::file(&data.path, "edges without direction", "the model was trained on edges with one"))
            }
            (_, Some(true)) => Labelling::new(self.legend(), &self.visits::<Directed>(data)),
            _ => Labelling::new(self.legend(), &self.visits::<Undirected>(data)),
        }
    }

    const CONFIDENT: bool = true;

    fn lines(&self, data: &Graphs, _: &[Action]) -> Vec<(usize, usize)> {
        data.graphs.iter().flat_map(|graph| &graph.nodes).map(|node| node.line).zip(self.turns(data)).collect()
    }

    fn right(&self, data: &Graphs, actions: &[Action]) -> Result<Vec<bool>> {
        let mut right = vec![false; actions.len()];
        self.turns(data).into_iter().zip(self.hits(data, actions)).for_each(|(turn, hit)| right[turn] = hit);
        Ok(right)
    }

    /// The labels become a further last column in the lines of nodes.
    fn write(&self, block: &Block, of: Option<(&Graphs, &[Action])>, out: &mut impl Write) -> io::Result<()> {
        let lines = of.map_or(Vec::new(), |(data, actions)| {
            let label = |(line, turn): (usize, usize)| (line, self.labels.get(actions[turn].0));
            self.lines(data, actions).into_iter().map(label).collect()
        });
        write_labels(block, lines.into_iter(), out)
    }

    fn check(&self, data: &Graphs) -> Result<()> {
        all_known(data, "to measure on")
    }

    fn score(&self, data: &Graphs, actions: &[Action]) -> Result<Score> {
        self.check(data)?;
        let hits = self.hits(data, actions);
        let (mut score, mut rest) = (Score::default(), &hits[..]);
        for graph in &data.graphs {
            let (here, after) = rest.split_at(graph.nodes.len());
            let right = here.iter().filter(|hit| **hit).count();
            score.graphs += 1;
            score.nodes += here.len() as u64;
            score.right_nodes += right as u64;
            score.right_graphs += u64::from(right == here.len());
            rest = after;
        }
        Ok(score)
    }

    fn answers(&self, data: &Graphs, actions: &[Action], tell: &mut dyn FnMut(&str, &str)) -> Result<()> {
        self.check(data)?;
        let gold = data.graphs.iter().flat_map(|graph| &graph.nodes);
        for (node, turn) in gold.zip(self.turns(data)) {
            tell(data.labels.get(node.label), self.labels.get(actions[turn].0));
        }
        Ok(())
    }

    fn features(&self) -> usize {
        self.legend().seen()
    }

    fn actions(&self) -> usize {
        self.labels.len()
    }

    /// All: a node's feature is also its neighbours'.
    fn keep(&mut self, _: &dyn Fn(u32) -> bool) -> Result<Vec<u32>> {
        Ok((0..self.features() as u32).collect())
    }

    fn header(&self) -> Header {
        let names = |of: &Interner| of.iter().map(str::to_owned).collect();
        Header { labels: names(&self.labels), nodes: names(&self.features), visit: self.visit, directed: self.directed }
    }

    fn arrays(&self) -> Vec<&[u64]> {
        Vec::new()
    }

    fn restore(header: Header, _: &mut Arrays<'_>, _: &Path) -> Result<Self, String> {
        let interned = |names: &[String]| {
            let mut all = Interner::new();
            names.iter().for_each(|name| {
                all.intern(name);
            });
            all
        };
        let (labels, features) = (interned(&header.labels), interned(&header.nodes));
        if labels.is_empty() || labels.len() != header.labels.len() || features.len() != header.nodes.len() {
            return Err("a label or a feature stands twice, or there is none".into());
        }
        let encoding = Encoding { labels, features, visit: header.visit, directed: header.directed };
        let few = encoding.features() <= u32::MAX as usize;
        if few { Ok(encoding) } else { Err("it has too many features".into()) }
    }

    fn facts(&self) -> Vec<Fact> {
        let labels: Vec<&str> = self.labels.iter().collect();
        let edges = match self.directed {
            None => "none",
            Some(true) => "directed",
            Some(false) => "undirected",
        };
        let fact = |name, text: &str| Fact { name, text: text.to_owned(), value: text.into() };
        vec![
            Fact { name: "labels", text: labels.join(" "), value: labels.into() },
            fact("visit", self.visit.name()),
            fact("edges", edges),
        ]
    }
}

/// What share of all a part is, in percent; nothing of nothing.
fn percent(part: u64, all: u64) -> f64 {
    if all == 0 { 0.0 } else { 100.0 * part as f64 / all as f64 }
}

impl tasks::Score for Score {
    fn text(&self) -> String {
        let (nodes, graphs) = (percent(self.right_nodes, self.nodes), percent(self.right_graphs, self.graphs));
        format!(
            "labelled {} nodes in {} graphs\nnodes: {nodes:.2}%\nwhole graphs: {graphs:.2}%\n",
            self.nodes, self.graphs
        )
    }

    fn loss(&self) -> f64 {
        (self.nodes - self.right_nodes) as f64
    }

    fn measures(&self) -> Vec<Measure> {
        vec![
            Measure { key: "graphs", name: "graphs %", percent: Some(percent(self.right_graphs, self.graphs)) },
            Measure { key: "nodes", name: "nodes %", percent: Some(percent(self.right_nodes, self.nodes)) },
        ]
    }
}
