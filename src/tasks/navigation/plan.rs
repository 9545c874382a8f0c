//! The cheapest way to one goal from everywhere.

use super::Network;
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// No edge.
const NONE: u32 = u32::MAX;

/// The cheapest ways to one goal from all nodes: Dijkstra's algorithm (1959) from the goal backwards, because an expert or a planner may be
/// asked at any node that a learner strays to. Of equally cheap ways that with the fewest edges, then that with the lowest action first:
/// following the plan arrives, also where edges cost nothing. Room is kept from plan to plan.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    values: Vec<f64>,
    hops: Vec<u32>,
    next: Vec<u32>,
    queue: BinaryHeap<Reverse<Reached>>,
}

/// A node and what is known of its way to the goal.
#[derive(Clone, Copy, Debug)]
struct Reached {
    value: f64,
    hops: u32,
    node: u32,
}

impl Reached {
    fn way(&self, other: &Self) -> Ordering {
        self.value.total_cmp(&other.value).then(self.hops.cmp(&other.hops))
    }
}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        self.way(other).then(self.node.cmp(&other.node))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Reached {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Reached {}

impl Plan {
    /// Plans the ways to `goal`, one of its nodes, in `network` where edge e costs `cost(e)`; what is less than nothing, or no number, counts as nothing.
    pub fn towards(&mut self, network: &Network, goal: u32, cost: impl Fn(usize) -> f64) {
        let nodes = network.nodes();
        self.values.clear();
        self.values.resize(nodes, f64::INFINITY);
        self.hops.clear();
        self.hops.resize(nodes, u32::MAX);
        self.next.clear();
        self.next.resize(nodes, NONE);
        self.queue.clear();
        self.reach(Reached { value: 0.0, hops: 0, node: goal }, NONE);
        while let Some(Reverse(here)) = self.queue.pop() {
            if here.way(&self.known(here.node)).is_gt() {
                continue;
            }
            for &edge in network.into(here.node) {
                let node = network.tail(edge as usize);
                let found = Reached { value: cost(edge as usize).max(0.0) + here.value, hops: here.hops + 1, node };
                match found.way(&self.known(node)) {
                    Ordering::Less => self.reach(found, edge),
                    // All equals come before the node's own turn, because they have one edge less to go.
                    Ordering::Equal => self.next[node as usize] = self.next[node as usize].min(edge),
                    Ordering::Greater => {}
                }
            }
        }
    }

    fn known(&self, node: u32) -> Reached {
        Reached { value: self.values[node as usize], hops: self.hops[node as usize], node }
    }

    fn reach(&mut self, found: Reached, by: u32) {
        let node = found.node as usize;
        (self.values[node], self.hops[node], self.next[node]) = (found.value, found.hops, by);
        self.queue.push(Reverse(found));
    }

    /// What the way from `node` costs; infinite where there is none.
    #[inline]
    pub fn value(&self, node: u32) -> f64 {
        self.values[node as usize]
    }

    /// The first edge of the way from `node`; none at the goal and where there is no way.
    #[inline]
    pub fn next(&self, node: u32) -> Option<usize> {
        Some(self.next[node as usize]).filter(|edge| *edge != NONE).map(|edge| edge as usize)
    }

    /// The edges of the way from `node`, in order.
    pub fn way<'a>(&'a self, network: &'a Network, node: u32) -> impl Iterator<Item = usize> + 'a {
        std::iter::successors(self.next(node), |edge| self.next(network.head(*edge)))
    }
}
