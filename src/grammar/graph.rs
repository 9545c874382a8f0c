//! The automaton as a graph: what can be reached, what can end, and a picture.

use std::fmt;

use petgraph::Direction;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::{Dfs, EdgeRef, Reversed};

/// A node of the automaton.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Node {
    /// Where every sentence starts.
    Start,
    /// A nonterminal, by name.
    Nonterminal(String),
    /// Where every sentence ends.
    End,
}

/// The automaton as a graph, whose edges carry the probability of the step.
///
/// Nonterminal a has node index a; the start and the end come after them. `Display` writes it in the DOT language of
/// Graphviz.
#[derive(Clone, Debug)]
pub struct Automaton {
    graph: DiGraph<Node, f64>,
    start: NodeIndex,
    end: NodeIndex,
}

impl Automaton {
    /// The automaton of these nonterminals, without steps.
    pub(super) fn new<'a>(nonterminals: impl Iterator<Item = &'a str>) -> Self {
        let mut graph = DiGraph::new();
        for name in nonterminals {
            graph.add_node(Node::Nonterminal(name.to_owned()));
        }
        let (start, end) = (graph.add_node(Node::Start), graph.add_node(Node::End));
        Automaton { graph, start, end }
    }

    /// A sentence may start at a.
    pub(super) fn add_start(&mut self, a: usize, chance: f64) {
        self.graph.add_edge(self.start, NodeIndex::new(a), chance);
    }

    /// b may follow a; the number of nonterminals stands for the end.
    pub(super) fn add_step(&mut self, a: usize, b: usize, chance: f64) {
        let target = if b < self.start.index() { NodeIndex::new(b) } else { self.end };
        self.graph.add_edge(NodeIndex::new(a), target, chance);
    }

    /// The graph itself.
    pub fn graph(&self) -> &DiGraph<Node, f64> {
        &self.graph
    }

    /// The first nonterminal that no sentence reaches.
    pub(super) fn unreachable(&self) -> Option<usize> {
        let mut seen = vec![false; self.graph.node_count()];
        let mut walk = Dfs::new(&self.graph, self.start);
        while let Some(node) = walk.next(&self.graph) {
            seen[node.index()] = true;
        }
        seen[..self.start.index()].iter().position(|&seen| !seen)
    }

    /// The first nonterminal from which no sentence ends.
    pub(super) fn endless(&self) -> Option<usize> {
        let mut seen = vec![false; self.graph.node_count()];
        let backwards = Reversed(&self.graph);
        let mut walk = Dfs::new(backwards, self.end);
        while let Some(node) = walk.next(backwards) {
            seen[node.index()] = true;
        }
        seen[..self.start.index()].iter().position(|&seen| !seen)
    }
}

impl fmt::Display for Automaton {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "digraph grammar {{\n    rankdir = LR;")?;
        for node in self.graph.node_indices() {
            let (label, shape) = match &self.graph[node] {
                Node::Start => ("start", "plaintext"),
                Node::Nonterminal(name) => (name.as_str(), "ellipse"),
                Node::End => ("end", "doublecircle"),
            };
            writeln!(f, "    {} [label = \"{label}\", shape = {shape}];", node.index())?;
        }
        for node in self.graph.node_indices() {
            let mut edges: Vec<_> = self.graph.edges_directed(node, Direction::Outgoing).collect();
            edges.sort_by_key(|edge| edge.target());
            for edge in edges {
                let (a, b) = (node.index(), edge.target().index());
                writeln!(f, "    {a} -> {b} [label = \"{:.3}\"];", edge.weight())?;
            }
        }
        writeln!(f, "}}")
    }
}
