//! A decision tree over binary features.

use super::Classifier;
use crate::space::{Features, Sight};

/// A binary decision tree: each inner node asks whether a feature is there, each leaf has a score for every action.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// The root first, parents before children.
    pub(crate) nodes: Vec<Node>,
    /// The leaves' scores, one leaf after the other.
    pub(crate) scores: Vec<f32>,
    pub(crate) actions: usize,
}

/// A node of a [`Tree`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Node {
    /// Goes on to one node where the feature is absent, to another where it is present.
    Split { feature: u32, absent: u32, present: u32 },
    /// The leaf with this number.
    Leaf(u32),
}

impl Tree {
    /// How many leaves there are.
    pub fn leaves(&self) -> usize {
        self.nodes.iter().filter(|node| matches!(node, Node::Leaf(_))).count()
    }

    /// The scores in the leaf that features lead to of which `has` knows whether they are there.
    pub(crate) fn leaf(&self, has: impl Fn(u32) -> bool) -> &[f32] {
        let mut at = 0;
        loop {
            match self.nodes[at] {
                Node::Split { feature, absent, present } => at = if has(feature) { present } else { absent } as usize,
                Node::Leaf(leaf) => return &self.scores[leaf as usize * self.actions..][..self.actions],
            }
        }
    }
}

impl Classifier<Features> for Tree {
    type Memory = Vec<f32>;

    fn scores<'m>(&self, sight: &Sight<'_, Features>, memory: &'m mut Vec<f32>) -> &'m [f32] {
        let listed = sight.listed();
        memory.clear();
        memory.extend_from_slice(self.leaf(|feature| listed.iter().any(|other| other == feature)));
        memory
    }
}
