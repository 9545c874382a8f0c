//! The expert who knows the right trees, for whatever configuration is at hand.

use super::space::Parsing;
use super::state::{Configuration, MOVES, Move, NONE, ROOT, Side, System};
use super::tabular::Table;
use crate::seed::Seed;
use crate::space::{Action, CostToGo, Expert, Space};
use std::cell::RefCell;

/// The expert who knows the right trees. Silent where they are not known.
///
/// Arc-hybrid: the dynamic oracle of Goldberg & Nivre (2013), exact: no way on from the configuration at hand gets more words right
/// than the answer's. Arcs can be reached together whenever each can be reached (arc decomposability), so that a move costs what it makes unreachable.
/// Of equals the left arc is taken, then the right one.
///
/// Arc-standard: the tabular dynamic oracle of Goldberg, Sartorio & Satta (2014), exact as well. Of equals the move of the static oracle is taken (Nivre 2009),
/// so that from the start its way is the expert's, then the left arc, then the right one. Only where words that should have been joined have something on them
/// is a table filled; while more than 256 words have no head the static oracle answers there.
///
/// Arc-standard with swap: the same where the words that are left stand in the right order, and then no way on without swaps gets more words right; where two
/// words should have been joined and have something on them, swaps might. Where words are still to be swapped (a static-dynamic oracle, after de Lhoneux, Stymne
/// & Nivre 2017): the static oracle of Nivre (2009), as late with swaps as that of Nivre, Kuhlmann & Hall (2009), on the tree that is still possible: a word
/// whose right head is attached already belongs to the nearest ancestor that is not. It makes every tree from the start, and is exact as long as no words have
/// been swapped that stood in the right order, and nothing has been shifted onto two words that had to be swapped or joined; elsewhere it is the best effort of
/// one that looks no further than the top two words and the front of the buffer.
///
/// Labels: the right one where it is legal on this side, else the lowest legal one; a word on a wrong head is given its right label too,
/// though nothing depends on it any more.
#[derive(Clone, Copy, Debug, Default)]
pub struct GoldTree;

impl Expert<Parsing> for GoldTree {
    #[inline]
    fn action(&self, space: &Parsing, state: &Configuration) -> Option<Action> {
        if space.trees.is_empty() {
            return None;
        }
        if state.pending != NONE {
            let right = Action(MOVES + space.trees.labels[(state.first + state.pending) as usize]);
            let legal = space.legal(state);
            return Some(if legal.contains(right) { right } else { legal.nth(0) });
        }
        let gold = Gold { space, state };
        Some(Action(match space.system {
            System::ArcHybrid => gold.hybrid(),
            System::ArcStandard | System::ArcStandardSwap => gold.tabular(),
        } as u32))
    }

    fn foresee(&self, space: &Parsing, state: &Configuration, costs: &mut Vec<f64>) -> Option<u64> {
        costs.clear();
        if space.trees.is_empty() {
            return None;
        }
        let gold = Gold { space, state };
        // Of labels, and in arc-hybrid of moves, each costs something beside what is lost in any case.
        let beside = space.system == System::ArcHybrid || state.pending != NONE;
        let lost = beside.then(|| gold.rest(None)).flatten();
        let mut steps = 0;
        for action in space.legal(state).iter() {
            let cost = match (Move::ALL.get(action.index()), lost) {
                (Some(a), Some(lost)) => Some(f64::from(lost + gold.loses(*a))),
                (Some(a), None) => gold.after(*a).map(f64::from),
                (None, lost) => lost.map(|lost| f64::from(lost) + space.wrong_label(state, action)),
            };
            let tried = || self.to_the_end(space, state.clone(), action);
            let (cost, more) = cost.map_or_else(tried, |cost| (cost, state.steps()));
            costs.push(cost);
            steps += more;
        }
        Some(steps)
    }
}

/// Exact, but for swaps and where there still are some to be done: what this expert gets wrong then, found by letting it go on.
impl CostToGo<Parsing> for GoldTree {
    fn costs(&self, space: &Parsing, state: &Configuration, costs: &mut Vec<f64>) {
        self.foresee(space, state, costs);
    }
}

impl GoldTree {
    /// What it costs to take `action` and then do as this expert does, and how many steps that is: by trying, until it is known what is left.
    fn to_the_end(self, space: &Parsing, mut state: Configuration, action: Action) -> (f64, u64) {
        let nothing = Seed::new(0);
        let (mut cost, mut steps) = (space.step(&mut state, action, nothing), 1);
        while !space.legal(&state).is_empty() {
            let gold = Gold { space, state: &state };
            // A label costs nothing more where the expert says it.
            if let Some(rest) = gold.rest(None) {
                return (cost + f64::from(rest), steps + state.steps());
            }
            let Some(action) = self.action(space, &state) else { break };
            cost += space.step(&mut state, action, nothing);
            steps += 1;
        }
        (cost, steps)
    }
}

thread_local! {
    /// One table a thread: experts are asked often, and its memory is worth keeping.
    static TABLE: RefCell<Table> = RefCell::default();
}

/// A configuration beside its right tree.
struct Gold<'a> {
    space: &'a Parsing,
    state: &'a Configuration,
}

impl Gold<'_> {
    /// The right head of word `w`.
    #[inline]
    fn head(&self, w: u32) -> u32 {
        self.space.trees.heads[(self.state.first + w) as usize]
    }

    #[inline]
    fn dependents(&self, w: u32) -> impl Iterator<Item = u32> + '_ {
        self.space.trees.dependents((self.state.first + w) as usize)
    }

    /// Of the arc-hybrid moves that lose least, the first of left, right and shift.
    fn hybrid(&self) -> Move {
        let legal = self.state.moves(System::ArcHybrid);
        let moves = [Move::Left, Move::Right, Move::Shift].into_iter().filter(|a| legal >> *a as u32 & 1 == 1);
        moves.min_by_key(|a| self.loses(*a)).unwrap_or(Move::Shift)
    }

    /// How many words' right heads an arc-hybrid move makes unreachable (Goldberg & Nivre 2013, section 4.2; the root is what is left last).
    fn loses(&self, a: Move) -> u32 {
        let (state, front) = (self.state, self.state.front);
        let (top, below) = (state.stacked(0), state.stacked(1));
        let later = |w: &u32| *w >= front;
        let stacked = |w: u32| w < front && state.alive(w);
        match a {
            Move::Shift => {
                // From now on the word's head is the one below it, or comes later; its dependents come later.
                let head = self.head(front);
                let own = if head == ROOT { top != NONE } else { head != top && stacked(head) };
                u32::from(own) + self.dependents(front).filter(|w| stacked(*w)).count() as u32
            }
            _ => {
                let head = self.head(top);
                let own = match a {
                    Move::Left if head == ROOT => state.stack.len() == 1,
                    Move::Left => head != front && (head == below || later(&head)),
                    _ => head != ROOT && later(&head),
                };
                u32::from(own) + self.dependents(top).filter(later).count() as u32
            }
        }
    }

    /// How many of the words without a head can no longer get their right one, in arc-hybrid.
    fn unreachable(&self) -> u32 {
        let (state, front) = (self.state, self.state.front);
        let lost_on_stack = |(i, &w): (usize, &u32)| match self.head(w) {
            ROOT => i > 0,
            head => head < front && (i == 0 || state.stack[i - 1] != head),
        };
        let lost_in_buffer = |w: &u32| {
            let head = self.head(*w);
            head != ROOT && head < front && !state.alive(head)
        };
        let stack = state.stack.iter().enumerate().filter(|at| lost_on_stack(*at)).count();
        (stack + (front..state.nodes.len() as u32).filter(lost_in_buffer).count()) as u32
    }

    /// The nearest right ancestor of `w` that can still be its head, or [`ROOT`].
    fn ancestor(&self, w: u32) -> u32 {
        self.space.ancestor(self.state, w)
    }

    /// Of the arc-standard moves that get least wrong the static oracle's if it is one of them, else the first of left, right and shift. Where nothing
    /// has gone astray the static oracle's is.
    fn tabular(&self) -> Move {
        let usual = self.standard();
        if !self.state.astray || self.state.stack.len() < 2 {
            return usual;
        }
        let Some(cost) = self.after(usual).filter(|cost| *cost > self.lost(None)) else { return usual };
        let Some(least) = self.rest(None).filter(|least| *least < cost) else { return usual };
        let legal = self.state.moves(System::ArcStandard);
        let mut moves = [Move::Left, Move::Right, Move::Shift].into_iter().filter(|a| legal >> *a as u32 & 1 == 1);
        moves.find(|a| self.after(*a) == Some(least)).unwrap_or(usual)
    }

    /// The fewest words that get wrong heads when the move `a` is made now, without swaps. `None` for a swap, where there are still swaps to be done, and where
    /// too many words are left.
    fn after(&self, a: Move) -> Option<u32> {
        let (top, below) = (self.state.stacked(0), self.state.stacked(1));
        let wrong = match a {
            Move::Shift => false,
            Move::Left => self.head(below) != top,
            Move::Right => self.head(top) != below,
            Move::Swap => return None,
        };
        Some(u32::from(wrong) + self.rest(Some(a))?)
    }

    /// [`Gold::after`], but for the arc of the move itself.
    fn rest(&self, a: Option<Move>) -> Option<u32> {
        if self.space.system == System::ArcHybrid {
            return Some(self.unreachable());
        }
        if self.space.system == System::ArcStandardSwap && !self.sorted() {
            return None;
        }
        if self.state.astray || a.is_some_and(|a| self.strays(a)) {
            let heads = self.space.heads(self.state);
            return TABLE.with_borrow_mut(|table| {
                table.read(heads, self.state, a);
                table.least(heads)
            });
        }
        Some(self.lost(a))
    }

    /// How many words without a head have lost their right one, after the move `a`.
    fn lost(&self, a: Option<Move>) -> u32 {
        let heads = self.space.heads(self.state);
        TABLE.with_borrow_mut(|table| {
            table.read(heads, self.state, a);
            table.lost(heads)
        })
    }

    /// Whether the words without a head are in the order in which no arcs cross.
    fn sorted(&self) -> bool {
        let state = self.state;
        let order = |w: u32| self.space.trees.order[(state.first + w) as usize];
        let stack = state.stack.iter().copied();
        stack
            .chain(state.returned.iter().rev().copied())
            .chain(state.front..state.nodes.len() as u32)
            .is_sorted_by_key(order)
    }

    /// The move of the static oracle, on the tree that is still possible. Where that is projective no words stand in the wrong order, and
    /// nothing is ever swapped.
    fn standard(&self) -> Move {
        let state = self.state;
        let (top, below) = (state.stacked(0), state.stacked(1));
        if below == NONE {
            return Move::Shift;
        }
        let heads = (self.ancestor(below), self.ancestor(top));
        let open = |w: u32| state.nodes[w as usize].open;
        // Where the right root is gone, of two words without an ancestor one has to take the other.
        let headless = heads == (ROOT, ROOT);
        if open(below) == 0 && heads.0 == top {
            return Move::Left;
        }
        if open(top) == 0 && (heads.1 == below || headless) {
            return Move::Right;
        }
        let order = |w: u32| self.space.trees.order[(state.first + w) as usize];
        // What belongs to the part that the top is in is joined to it first: then that goes past the word below as one.
        let part = |w: u32| self.space.trees.parts[(self.state.first + w) as usize];
        let front = state.buffered(0);
        if below < top && order(below) > order(top) && (front == NONE || part(front) != part(top)) {
            return Move::Swap;
        }
        if !state.drained() {
            return Move::Shift;
        }
        // A word swapped wrongly is in the way: the arc goes in at which the fewer words lose their heads.
        let loses = |w: u32, head: u32, other: u32| open(w) + u32::from(head != other && head == self.head(w));
        if loses(below, heads.0, top) < loses(top, heads.1, below) { Move::Left } else { Move::Right }
    }
}

/// What the static oracle of arc-standard, with swaps or without, cannot see: it is exact while nothing of this is on the stack below its top.
/// Words are taken as done whose dependents have all been attached, rightly or wrongly.
impl Gold<'_> {
    fn done(&self, w: u32) -> bool {
        !self.dependents(w).any(|dependent| self.state.alive(dependent))
    }

    /// A word that may go anywhere, but has to go before the words beside it can be joined.
    fn idle(&self, w: u32) -> bool {
        let head = self.head(w);
        head != ROOT && !self.state.alive(head) && self.done(w)
    }

    /// Two neighbours of which one should have been joined to the other.
    fn due(&self, below: u32, top: u32) -> bool {
        self.head(below) == top && self.done(below) || self.head(top) == below && self.done(top)
    }

    /// Whether the move `a` puts something there, or is a swap too many or too few.
    fn strays(&self, a: Move) -> bool {
        let (top, below) = (self.state.stacked(0), self.state.stacked(1));
        let buries = || top != NONE && (self.idle(top) || below != NONE && self.due(below, top));
        match a {
            Move::Left | Move::Right => false,
            Move::Shift if self.space.system == System::ArcStandard => buries(),
            _ => self.standard() != a || buries(),
        }
    }

    /// Whether there is something, or words are still to be swapped.
    fn astray(&self) -> bool {
        let buried = &self.state.stack[..self.state.stack.len().saturating_sub(1)];
        let unsorted = self.space.system == System::ArcStandardSwap && !self.sorted();
        unsorted || buried.iter().any(|w| self.idle(*w)) || buried.windows(2).any(|pair| self.due(pair[0], pair[1]))
    }
}

/// Keeps [`Configuration::astray`] before the move `a`.
pub(super) fn before(space: &Parsing, state: &mut Configuration, a: Move) {
    state.astray = state.astray || Gold { space, state }.strays(a);
}

/// Keeps it after the arc of the pending word. One that is right and after which nothing hangs in the air changes nothing.
pub(super) fn after(space: &Parsing, state: &mut Configuration) {
    let w = state.pending as usize;
    let wrong = space.heads(state)[w] != state.nodes[w].head || state.nodes[w].open > 0;
    if wrong || state.astray {
        state.astray = Gold { space, state }.astray();
    }
}

/// The side on which the right head of a word stands.
pub(super) fn side(heads: &[u32], w: usize) -> Side {
    Side::of(heads[w], w as u32)
}
