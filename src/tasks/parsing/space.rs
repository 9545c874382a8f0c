//! Sentences as a space: move after move, each arc followed by its label.

use super::encoding::Slots;
use super::features::{self, Attributes};
use super::oracle;
use super::state::{Configuration, MOVES, Move, NONE, ROOT, Side, System};
use super::tree::Trees;
use crate::seed::Seed;
use crate::space::{Action, Actions, Episode, FeatureTable, Features, Space};
use std::sync::Arc;

/// The legal actions of all configurations: those of each set of moves, then the labels of each side.
#[derive(Clone, Debug)]
pub(super) struct Legal {
    moves: [Box<[Action]>; 1 << MOVES],
    labels: [Box<[Action]>; 3],
}

impl Legal {
    /// Where label y may stand on the sides `sides[y]`, as bits by [`Side`]. A side without labels has all of them.
    pub fn new(sides: &[u8]) -> Self {
        let moves = std::array::from_fn(|set| (0..MOVES).filter(|a| set >> a & 1 == 1).map(Action).collect());
        let labels = [Side::Left, Side::Right, Side::Root].map(|side| {
            let has = |y: &u32| sides[*y as usize] >> side as u32 & 1 == 1;
            let all = 0..sides.len() as u32;
            let own: Vec<Action> = all.clone().filter(has).map(|y| Action(MOVES + y)).collect();
            if own.is_empty() { all.map(|y| Action(MOVES + y)).collect() } else { own.into() }
        });
        Legal { moves, labels }
    }
}

/// The sentences of a treebank as episodes. Actions 0 to 3 are the [moves](Move), the labels come behind them: after each arc its label
/// is an action of its own.
///
/// A word costs 1 when its head or its label is wrong, when that is settled. Every episode ends with one tree that has one root:
/// the last word, which has none left to be attached to.
#[derive(Clone, Debug)]
pub struct Parsing {
    pub(super) system: System,
    /// Sentence i is words `starts[i]..starts[i+1]`.
    pub(super) starts: Vec<u32>,
    pub(super) words: Vec<Attributes>,
    pub(super) table: FeatureTable,
    pub(super) slots: Arc<Slots>,
    pub(super) legal: Arc<Legal>,
    pub(super) labels: usize,
    /// The right trees; empty where none are known, and then nothing costs anything.
    pub(super) trees: Trees,
}

impl Parsing {
    /// How many sentences.
    pub fn sentences(&self) -> usize {
        self.starts.len() - 1
    }

    /// How many words.
    pub fn words(&self) -> usize {
        self.words.len()
    }

    /// The transition system.
    pub fn system(&self) -> System {
        self.system
    }

    /// The right heads in the sentence of `state`.
    pub(super) fn heads(&self, state: &Configuration) -> &[u32] {
        &self.trees.heads[state.first as usize..][..state.nodes.len()]
    }

    /// The nearest right ancestor of `w` that is not attached yet, or [`ROOT`].
    pub(super) fn ancestor(&self, state: &Configuration, w: u32) -> u32 {
        let mut head = self.trees.heads[(state.first + w) as usize];
        while head != ROOT && !state.alive(head) {
            head = self.trees.heads[(state.first + head) as usize];
        }
        head
    }

    /// 1 when the pending word is on its right head and `action` is not its right label.
    pub(super) fn wrong_label(&self, state: &Configuration, action: Action) -> f64 {
        let w = (state.first + state.pending) as usize;
        let right = self.trees.heads[w] == state.nodes[state.pending as usize].head;
        f64::from(right && self.trees.labels[w] != action.0 - MOVES)
    }

    /// What the arc that has just been made costs, and who else is concerned by it.
    fn settle(&self, state: &mut Configuration) -> f64 {
        let w = state.pending;
        if w == NONE || self.trees.is_empty() {
            return 0.0;
        }
        if self.system != System::ArcHybrid {
            let (open, ancestor) = (state.nodes[w as usize].open, self.ancestor(state, w));
            if ancestor != ROOT {
                let node = &mut state.nodes[ancestor as usize];
                node.open = (node.open + open).saturating_sub(1);
            }
            oracle::after(self, state);
        }
        f64::from(self.trees.heads[(state.first + w) as usize] != state.nodes[w as usize].head)
    }
}

impl Space for Parsing {
    type State = Configuration;
    type View = Features;

    fn start(&self, episode: Episode) -> Configuration {
        let (first, end) = (self.starts[episode.index], self.starts[episode.index + 1]);
        let mut state = Configuration::new(first, (end - first) as usize);
        if !self.trees.is_empty() && self.system != System::ArcHybrid {
            for (node, w) in state.nodes.iter_mut().zip(first as usize..) {
                node.open = self.trees.dependents(w).count() as u32;
            }
        }
        state
    }

    #[inline]
    fn legal<'a>(&'a self, state: &'a Configuration) -> Actions<'a> {
        if state.pending != NONE {
            let side = Side::of(state.nodes[state.pending as usize].head, state.pending);
            return Actions::Only(&self.legal.labels[side as usize]);
        }
        Actions::Only(&self.legal.moves[state.moves(self.system)])
    }

    #[inline]
    fn look(&self, state: &Configuration, view: &mut Features) {
        view.dynamic.clear();
        let words = &self.words[state.first as usize..][..state.nodes.len()];
        let mut found = features::Found::default();
        view.row = features::of(state, words, &mut found);
        self.slots.number(found.slots(), &mut view.dynamic);
    }

    #[inline]
    fn step(&self, state: &mut Configuration, action: Action, _: Seed) -> f64 {
        let cost = match Move::ALL.get(action.index()) {
            Some(&a) => {
                if !self.trees.is_empty() && self.system != System::ArcHybrid {
                    oracle::before(self, state, a);
                }
                state.make(self.system, a);
                self.settle(state)
            }
            None => {
                let wrong = if self.trees.is_empty() { 0.0 } else { self.wrong_label(state, action) };
                state.label(action.0 - MOVES);
                wrong
            }
        };
        if state.settle() { cost + self.settle(state) } else { cost }
    }

    fn actions(&self) -> usize {
        MOVES as usize + self.labels
    }

    /// Every word is shifted, attached (the root goes by itself) and labelled; with swaps it is not known.
    fn horizon(&self, index: usize) -> Option<usize> {
        let words = (self.starts[index + 1] - self.starts[index]) as usize;
        (self.system != System::ArcStandardSwap).then_some(3 * words - 1)
    }

    fn shared(&self) -> &FeatureTable {
        &self.table
    }
}
