//! How far a sentence has been parsed.

use crate::space::Action;
use serde::{Deserialize, Serialize};

/// No such word.
pub(super) const NONE: u32 = u32::MAX;
/// The head of the root.
pub(super) const ROOT: u32 = u32::MAX - 1;

/// Which words a move attaches to which.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum System {
    /// Arc-hybrid (Kuhlmann, Gómez-Rodríguez & Satta 2011): left arcs from the front of the buffer, right arcs within the stack. Makes every
    /// projective tree and no other.
    #[default]
    ArcHybrid,
    /// Arc-standard (Nivre 2004): arcs between the two words on top of the stack. Makes every projective tree and no other.
    ArcStandard,
    /// Arc-standard with swap (Nivre 2009): arcs between the two words on top of the stack, the lower of which may go back into the
    /// buffer. Makes every tree.
    ArcStandardSwap,
}

/// The moves, numbered as the actions that they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Move {
    /// The front of the buffer goes onto the stack.
    Shift = 0,
    /// The arc whose head is on the right.
    Left = 1,
    /// The arc whose head is on the left.
    Right = 2,
    /// The word below the top of the stack goes back into the buffer.
    Swap = 3,
}

/// How many moves there are; labels are numbered behind them.
pub(super) const MOVES: u32 = 4;

impl Move {
    /// All moves, by number.
    pub const ALL: [Move; MOVES as usize] = [Move::Shift, Move::Left, Move::Right, Move::Swap];
}

/// On which side of its dependent a head stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// The head is on the right: a left arc.
    Left,
    /// The head is on the left: a right arc.
    Right,
    /// There is none: the root.
    Root,
}

impl Side {
    /// The side of an arc.
    pub fn of(head: u32, dependent: u32) -> Side {
        match head {
            ROOT => Side::Root,
            head if dependent < head => Side::Left,
            _ => Side::Right,
        }
    }
}

/// A word and what has been attached to it. Words are numbered in their sentence, from 0.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Node {
    /// Its head; [`NONE`] while it has none.
    pub head: u32,
    /// Its label; [`NONE`] while it has none.
    pub label: u32,
    /// Its outermost dependents on the left, the outer one first.
    pub left: [u32; 2],
    /// Its outermost dependents on the right, the outer one first.
    pub right: [u32; 2],
    /// How many dependents it has on the left and on the right.
    pub valency: [u32; 2],
    /// Their labels, modulo 64, as bits.
    pub labels: [u64; 2],
    /// How many words without a head belong below it in the right tree, those between it and them having been attached; kept where
    /// the right tree is known.
    pub open: u32,
}

/// A sentence in the middle of being parsed: stack, buffer, and the arcs made so far.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Configuration {
    /// The corpus's number of the sentence's first word.
    pub(super) first: u32,
    pub(super) nodes: Vec<Node>,
    pub(super) stack: Vec<u32>,
    /// Words put back into the buffer, the front last; those from `front` on come behind them.
    pub(super) returned: Vec<u32>,
    pub(super) front: u32,
    /// The dependent of an arc that waits for its label.
    pub(super) pending: u32,
    /// Whether the static oracle of arc-standard may be wrong here; kept where the right tree is known.
    pub(super) astray: bool,
}

impl Configuration {
    /// All of `count` words in the buffer.
    pub(super) fn new(first: u32, count: usize) -> Self {
        let node = Node {
            head: NONE,
            label: NONE,
            left: [NONE; 2],
            right: [NONE; 2],
            valency: [0; 2],
            labels: [0; 2],
            open: 0,
        };
        let stack = Vec::with_capacity(count.min(64));
        let nodes = vec![node; count];
        Configuration { first, nodes, stack, returned: Vec::new(), front: 0, pending: NONE, astray: false }
    }

    /// The word `k` below the top of the stack.
    #[inline]
    pub(super) fn stacked(&self, k: usize) -> u32 {
        let depth = self.stack.len();
        if k < depth { self.stack[depth - 1 - k] } else { NONE }
    }

    /// The word `k` behind the front of the buffer.
    #[inline]
    pub(super) fn buffered(&self, k: usize) -> u32 {
        let back = self.returned.len();
        if k < back {
            return self.returned[back - 1 - k];
        }
        let word = self.front + (k - back) as u32;
        if (word as usize) < self.nodes.len() { word } else { NONE }
    }

    /// Whether the buffer is empty.
    #[inline]
    pub(super) fn drained(&self) -> bool {
        self.front as usize == self.nodes.len() && self.returned.is_empty()
    }

    /// Whether word `w` is on the stack or in the buffer.
    #[inline]
    pub(super) fn alive(&self, w: u32) -> bool {
        self.nodes[w as usize].head == NONE
    }

    /// The legal moves, as bits: enough of them for every sentence to end with one root.
    #[inline]
    pub(super) fn moves(&self, system: System) -> usize {
        let bit = |legal: bool, a: Move| usize::from(legal) << a as u32;
        let (buffer, two) = (!self.drained(), self.stack.len() >= 2);
        let others = match system {
            System::ArcHybrid => bit(buffer && !self.stack.is_empty(), Move::Left),
            // Two words are swapped once at most, which ends every sentence.
            System::ArcStandard => bit(two, Move::Left),
            System::ArcStandardSwap => bit(two, Move::Left) | bit(two && self.stacked(1) < self.stacked(0), Move::Swap),
        };
        bit(buffer, Move::Shift) | bit(two, Move::Right) | others
    }

    /// Makes a legal move. An arc's dependent is then pending.
    #[inline]
    pub(super) fn make(&mut self, system: System, a: Move) {
        let (top, below) = (self.stacked(0), self.stacked(1));
        match (a, system) {
            (Move::Shift, _) => {
                let word = self.buffered(0);
                if self.returned.pop().is_none() {
                    self.front += 1;
                }
                self.stack.push(word);
            }
            (Move::Swap, _) => {
                self.lower();
                self.returned.push(below);
            }
            (Move::Right, _) => {
                self.stack.pop();
                self.attach(below, top);
            }
            (Move::Left, System::ArcHybrid) => {
                self.stack.pop();
                self.attach(self.buffered(0), top);
            }
            (Move::Left, _) => {
                self.lower();
                self.attach(top, below);
            }
        }
    }

    /// Takes the word below the top off the stack.
    fn lower(&mut self) {
        let depth = self.stack.len();
        self.stack.swap_remove(depth - 2);
    }

    /// The last word, to which nothing else is left to be attached, is the root. Returns whether it has just become that.
    pub(super) fn settle(&mut self) -> bool {
        let last = self.pending == NONE && self.drained() && self.stack.len() == 1;
        if last {
            let word = self.stacked(0);
            self.stack.pop();
            self.nodes[word as usize].head = ROOT;
            self.pending = word;
        }
        last
    }

    fn attach(&mut self, head: u32, dependent: u32) {
        self.nodes[dependent as usize].head = head;
        self.pending = dependent;
        let side = usize::from(dependent > head);
        let node = &mut self.nodes[head as usize];
        node.valency[side] += 1;
        let outermost = if side == 0 { &mut node.left } else { &mut node.right };
        // NONE is above every number: on the left it is never outside a word, on the right it has to be asked for.
        let outside = |other: u32| if side == 0 { dependent < other } else { other == NONE || dependent > other };
        if outside(outermost[0]) {
            *outermost = [dependent, outermost[0]];
        } else if outside(outermost[1]) {
            outermost[1] = dependent;
        }
    }

    /// Gives the pending dependent its label.
    #[inline]
    pub(super) fn label(&mut self, label: u32) {
        let dependent = std::mem::replace(&mut self.pending, NONE);
        let node = &mut self.nodes[dependent as usize];
        node.label = label;
        let head = node.head;
        if head != ROOT {
            self.nodes[head as usize].labels[usize::from(dependent > head)] |= 1 << (label % 64);
        }
    }

    /// Takes a legal action, and all that follows by itself.
    #[inline]
    pub(super) fn take(&mut self, system: System, action: Action) {
        match Move::ALL.get(action.index()) {
            Some(&a) => self.make(system, a),
            None => self.label(action.0 - MOVES),
        }
        self.settle();
    }

    /// How many actions there are to come, without swaps: a shift, an arc and a label for each word, but no arc for the root.
    pub(super) fn steps(&self) -> u64 {
        let buffered = self.nodes.len() - self.front as usize + self.returned.len();
        let words = 3 * buffered + 2 * self.stack.len();
        (words.saturating_sub(1) + usize::from(self.pending != NONE)) as u64
    }

    /// Whether all words have been attached and labelled.
    pub fn finished(&self) -> bool {
        self.pending == NONE && self.stack.is_empty() && self.drained()
    }

    /// The arcs made so far, word by word: the head's number from 1, 0 for the root, and the label's number from 0. A word without either
    /// has `u32::MAX` there.
    pub fn arcs(&self) -> impl ExactSizeIterator<Item = (u32, u32)> + '_ {
        self.nodes.iter().map(|node| match node.head {
            ROOT => (0, node.label),
            NONE => (NONE, node.label),
            head => (head + 1, node.label),
        })
    }
}
