//! Reader of labelled graphs.
//!
//! A node is a line of its name, its label (`_` where that is not known) and any number of features, between spaces or tabs. An edge is a line of two
//! nodes that stand above it, with `--` between them; `->` in directed graphs, for an edge that goes from the first to the second. Blank lines
//! stand between graphs, in which names are anew.
//!
//! ```text
//! ann   left   reads walks
//! bob   right  drives
//! cleo  _      walks
//! ann -- bob
//! bob -- cleo
//!
//! ann   right
//! ```

use super::conll::Source;
use crate::corpus::{Interner, MARK};
use crate::error::{Error, Place, Result};
use nom::bytes::complete::take_till1;
use nom::character::complete::space0;
use nom::multi::many0;
use nom::sequence::preceded;
use nom::{IResult, Parser};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// The label of a node whose label is not known.
pub const UNKNOWN: u32 = u32::MAX;

/// A node of a graph that was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// The number of its label, or [`UNKNOWN`].
    pub label: u32,
    /// The numbers of its features, each once.
    pub features: Vec<u32>,
    /// The line it stands on, from 1.
    pub line: usize,
    /// The column of its label there, from 1.
    pub column: usize,
}

/// A graph that was read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Graph {
    /// The nodes, as they stand in the file.
    pub nodes: Vec<Node>,
    /// The edges, by the places of their nodes: no loop, and none twice.
    pub edges: Vec<[u32; 2]>,
}

/// The graphs of a file.
#[derive(Clone, Debug)]
pub struct Graphs {
    /// Where they come from.
    pub path: PathBuf,
    /// One after the other; none is without a node.
    pub graphs: Vec<Graph>,
    /// The names of labels.
    pub labels: Interner,
    /// The names of features.
    pub features: Interner,
    /// Whether edges have a direction; nothing where there is no edge.
    pub directed: Option<bool>,
}

impl Graphs {
    /// Where the label of `node` stands.
    pub fn place(&self, node: &Node) -> Place {
        Place { path: self.path.clone(), line: node.line, column: node.column }
    }
}

/// The graphs in `text`, of `path`, whose first line has the number `first_line` there; nothing when all lines are blank.
///
/// # Errors
/// With the exact place: text that is not UTF-8 or has a NUL in it, a line that is neither node nor edge, a node or a feature that stands twice, an edge
/// that stands twice, goes back to its own node or names a node that is not above it, edges with and without direction.
pub fn parse(text: &[u8], path: &Path, first_line: usize) -> Result<Option<Graphs>> {
    let source = Source { text, path, first_line };
    let whole = source.characters()?;
    let (labels, features) = (Interner::new(), Interner::new());
    let graphs = Graphs { path: path.to_owned(), graphs: Vec::new(), labels, features, directed: None };
    let mut reader = Reader { source: &source, whole, graphs, names: HashMap::new(), edges: HashSet::new() };
    let mut open = false;
    for (line, number) in whole.strip_prefix(MARK).unwrap_or(whole).split_inclusive('\n').zip(first_line..) {
        let line = line.trim_end_matches([' ', '\t', '\r', '\n']);
        if line.is_empty() {
            open = false;
            continue;
        }
        if !open {
            reader.graphs.graphs.push(Graph::default());
            reader.names.clear();
            reader.edges.clear();
            open = true;
        }
        reader.line(line, number)?;
    }
    Ok(Some(reader.graphs).filter(|found| !found.graphs.is_empty()))
}

struct Reader<'a> {
    source: &'a Source<'a>,
    whole: &'a str,
    graphs: Graphs,
    /// The nodes of the graph at hand, and its edges, those without direction by the lower node first.
    names: HashMap<&'a str, u32>,
    edges: HashSet<[u32; 2]>,
}

const NODE: &str = "a node's name, its label and its features, or an edge such as `a -- b` or `a -> b`";

fn blank(c: char) -> bool {
    c == ' ' || c == '\t'
}

/// The cells of a line.
fn cells(line: &str) -> IResult<&str, Vec<&str>> {
    many0(preceded(space0, take_till1(blank))).parse(line)
}

impl<'a> Reader<'a> {
    fn refuse(&self, at: &str, problem: impl Into<String>, expected: &str) -> Error {
        let offset = at.as_ptr() as usize - self.whole.as_ptr() as usize;
        Error::data(self.source.place(offset), problem, expected)
    }

    fn line(&mut self, line: &'a str, number: usize) -> Result<()> {
        let cells = cells(line).map_or(Vec::new(), |(_, cells)| cells);
        match cells[..] {
            [from, arrow @ ("--" | "->"), to] => self.edge([from, to], arrow),
            [_, "--" | "->"] => {
                Err(self.refuse(&line[line.len()..], "the line ends", "the node that the edge goes to"))
            }
            [_, "--" | "->", _, more, ..] => Err(self.refuse(more, format!("found `{more}`"), "the end of the edge")),
            [name, label, ref features @ ..] => self.node(name, label, features, (line, number)),
            _ => Err(self.refuse(&line[line.len()..], "the line ends", NODE)),
        }
    }

    fn node(&mut self, name: &'a str, label: &'a str, features: &[&'a str], at: (&'a str, usize)) -> Result<()> {
        let number = self.names.len() as u32;
        if self.names.insert(name, number).is_some() {
            return Err(self.refuse(
                name,
                format!("node {name} for the second time"),
                "a name of its own in the graph",
            ));
        }
        let mut ids = Vec::with_capacity(features.len());
        for feature in features {
            let id = self.graphs.features.intern(feature);
            if ids.contains(&id) {
                return Err(self.refuse(
                    feature,
                    format!("feature {feature} for the second time"),
                    "each once in a line",
                ));
            }
            ids.push(id);
        }
        let (line, number) = at;
        let before = label.as_ptr() as usize - line.as_ptr() as usize;
        let column = 1 + line[..before].chars().count();
        let label = if label == "_" { UNKNOWN } else { self.graphs.labels.intern(label) };
        if let Some(graph) = self.graphs.graphs.last_mut() {
            graph.nodes.push(Node { label, features: ids, line: number, column });
        }
        Ok(())
    }

    fn edge(&mut self, ends: [&'a str; 2], arrow: &'a str) -> Result<()> {
        let mut numbers = [0; 2];
        for (number, name) in numbers.iter_mut().zip(ends) {
            let known = self.names.get(name).copied();
            *number =
                known.ok_or_else(|| self.refuse(name, format!("no node {name} above"), "a node of the same graph"))?;
        }
        let directed = arrow == "->";
        if *self.graphs.directed.get_or_insert(directed) != directed {
            return Err(self.refuse(
                arrow,
                format!("found `{arrow}`"),
                "edges that are all with direction, or all without",
            ));
        }
        let [from, to] = numbers;
        if from == to {
            return Err(self.refuse(ends[1], "an edge back to its own node", "another node"));
        }
        if !self.edges.insert(if directed { numbers } else { [from.min(to), from.max(to)] }) {
            return Err(self.refuse(ends[0], "the same edge for the second time", "each once"));
        }
        if let Some(graph) = self.graphs.graphs.last_mut() {
            graph.edges.push(numbers);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> Result<Option<Graphs>> {
        parse(text.as_bytes(), Path::new("g"), 1)
    }

    #[test]
    fn a_whole_text() {
        let found = read("a X p q\r\n b\tY\tq \na -- b\n\n\nb _\n").expect("well formed").expect("graphs");
        let node = |label, features: &[u32], line, column| Node { label, features: features.to_vec(), line, column };
        let first = Graph { nodes: vec![node(0, &[0, 1], 1, 3), node(1, &[1], 2, 4)], edges: vec![[0, 1]] };
        assert_eq!(found.graphs, [first, Graph { nodes: vec![node(UNKNOWN, &[], 6, 3)], edges: vec![] }]);
        assert_eq!(found.labels.iter().collect::<Vec<_>>(), ["X", "Y"]);
        assert_eq!((found.features.len(), found.directed), (2, Some(false)));
        assert!(read("\n \n").expect("blank").is_none());
    }

    #[test]
    fn every_error_tells_place_finding_and_expectation() {
        for (text, expected) in [
            ("a\n", "g:1:2: the line ends; expected a node's name"),
            ("é\n", "g:1:2: the line ends"),
            ("a X\n\na X\na Y\n", "g:4:1: node a for the second time; expected a name of its own"),
            ("a X p q p\n", "g:1:9: feature p for the second time; expected each once"),
            ("a X\na --\n", "g:2:5: the line ends; expected the node that the edge goes to"),
            ("a X\nb X\na -> b 3\n", "g:3:8: found `3`; expected the end of the edge"),
            ("a X\nb X\n\na -- b\n", "g:4:1: no node a above; expected a node of the same graph"),
            ("a X\na -> b\nb X\n", "g:2:6: no node b above"),
            ("a X\na -- a\n", "g:2:6: an edge back to its own node; expected another node"),
            ("a X\nb X\na -- b\nb -- a\n", "g:4:1: the same edge for the second time; expected each once"),
            ("a X\nb X\na -> b\nb -> a\na -> b\n", "g:5:1: the same edge for the second time"),
            ("a X\nb X\na -> b\n\na X\nb X\na -- b\n", "g:7:3: found `--`; expected edges that are all with direction"),
            ("a X\0\n", "g:1:4: a NUL byte"),
        ] {
            let error = read(text).expect_err(text).to_string();
            assert!(error.starts_with(expected), "{text:?}: {error}\n  not {expected}");
        }
        let error = parse(b"a X\nb\n", Path::new("g"), 100).expect_err("half a node").to_string();
        assert!(error.starts_with("g:101:2: "), "{error}");
    }

    proptest! {
        #[test]
        fn no_text_is_a_panic(text in "[ab_> \n\t-]{0,40}|\\PC{0,30}") {
            for graph in read(&text).into_iter().flatten().flat_map(|found| found.graphs) {
                let nodes = graph.nodes.len() as u32;
                prop_assert!(nodes > 0 && graph.edges.iter().all(|[a, b]| *a < nodes && *b < nodes && a != b));
            }
        }
    }
}
