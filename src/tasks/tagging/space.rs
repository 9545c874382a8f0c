//! Sentences as a space: one label after the other, left to right.

use super::transitions::Transitions;
use crate::seed::Seed;
use crate::space::{Action, Actions, CostToGo, Episode, Expert, FeatureTable, Features, Space};
use std::sync::Arc;

/// How many labels back a history feature may look.
pub const MAX_ORDER: usize = crate::read::template::BACK as usize;

/// The feature numbers of one history line of a template: every context with every combination of the labels it looks at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HistoryLine {
    /// Which labels it looks at: 1 is the one before.
    pub back: Vec<u32>,
    /// The first of its feature numbers.
    pub base: u32,
    /// How many feature numbers it has.
    pub size: u32,
    /// Whether there are as many as contexts times combinations, or fewer, which combinations share by hash.
    pub exact: bool,
}

/// No such context was ever seen: the feature is left out.
pub const NO_CONTEXT: u32 = u32::MAX;

/// A line of more combinations than this shares its feature numbers by hash.
const MOST: u64 = 1 << 24;

impl HistoryLine {
    /// The line that looks at the labels `back`, with `contexts` contexts and `labels` labels, numbered from `base`.
    pub fn new(back: &[u32], contexts: usize, labels: usize, base: u32) -> Self {
        let all = (labels as u64 + 1).checked_pow(back.len() as u32).and_then(|n| n.checked_mul(contexts as u64));
        let exact = all.is_some_and(|n| n <= MOST);
        let size = all.filter(|_| exact).unwrap_or(MOST) as u32;
        HistoryLine { back: back.to_vec(), base, size, exact }
    }

    /// The feature number of `context` after `history`, the last label first.
    #[inline]
    fn number(&self, context: u32, history: &[u16; MAX_ORDER], labels: u64) -> u32 {
        let mut n = u64::from(context);
        if self.exact {
            for &back in &self.back {
                n = n * (labels + 1) + u64::from(history[back as usize - 1]);
            }
            return self.base + n as u32;
        }
        for &back in &self.back {
            n = (n ^ u64::from(history[back as usize - 1])).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            n ^= n >> 29;
        }
        self.base + (n % MOST) as u32
    }
}

/// The sentences of a corpus as episodes: one label after the other, left to right.
#[derive(Clone, Debug)]
pub struct Tagging {
    pub(super) table: FeatureTable,
    /// Sentence i is tokens `starts[i]..starts[i+1]`.
    pub(super) starts: Vec<u32>,
    /// The right label of every token; empty where none is known, and then no label costs anything.
    pub(super) gold: Vec<u32>,
    pub(super) transitions: Arc<Transitions>,
    pub(super) labels: usize,
    pub(super) history: Arc<[HistoryLine]>,
    /// How many labels back the future of a state depends on; `None` if they do not fit into a signature.
    pub(super) far: Option<usize>,
    /// `contexts[token * history.len() + line]`
    pub(super) contexts: Vec<u32>,
}

/// A place in a sentence and the labels just before it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Position {
    token: u32,
    end: u32,
    /// The last label first; [`Transitions::begin`] where there is none.
    history: [u16; MAX_ORDER],
}

impl Position {
    fn previous(&self) -> u32 {
        u32::from(self.history[0])
    }
}

impl Tagging {
    /// How many sentences.
    pub fn sentences(&self) -> usize {
        self.starts.len() - 1
    }

    /// The right labels, one a token; empty where they are not known.
    pub fn gold(&self) -> &[u32] {
        &self.gold
    }

    /// Which label may follow which.
    pub fn transitions(&self) -> &Transitions {
        &self.transitions
    }

    /// How many labels back features of these lines, or else the order of labels, look, if as many fit into 64 bits.
    pub(super) fn farthest(history: &[HistoryLine]) -> Option<usize> {
        let far = history.iter().flat_map(|line| &line.back).copied().max().unwrap_or(1).max(1) as usize;
        (far <= MAX_ORDER.min(4)).then_some(far)
    }

    /// How many labels are wrong at best from `token` to `end`, after `previous`: until the right label is legal again all are, and
    /// after that none need be.
    fn detour(&self, token: u32, end: u32, previous: u32) -> u32 {
        if token == end || self.transitions.after(previous).contains(Action(self.gold[token as usize])) {
            return 0;
        }
        let mut front = vec![previous];
        for at in token..end {
            let gold = Action(self.gold[at as usize]);
            if front.iter().any(|y| self.transitions.after(*y).contains(gold)) {
                return at - token;
            }
            front = front.iter().flat_map(|y| self.transitions.after(*y).iter().map(|a| a.0)).collect();
            front.sort_unstable();
            front.dedup();
        }
        end - token
    }
}

impl Space for Tagging {
    type State = Position;
    type View = Features;

    fn start(&self, episode: Episode) -> Position {
        let begin = self.transitions.begin() as u16;
        let (token, end) = (self.starts[episode.index], self.starts[episode.index + 1]);
        Position { token, end, history: [begin; MAX_ORDER] }
    }

    #[inline]
    fn legal<'a>(&'a self, state: &'a Position) -> Actions<'a> {
        if state.token == state.end { Actions::NONE } else { self.transitions.after(state.previous()) }
    }

    #[inline]
    fn look(&self, state: &Position, view: &mut Features) {
        let lines = self.history.len();
        let contexts = &self.contexts[state.token as usize * lines..][..lines];
        view.row = state.token;
        view.dynamic.clear();
        for (line, &context) in self.history.iter().zip(contexts) {
            if context != NO_CONTEXT {
                view.dynamic.push(line.number(context, &state.history, self.labels as u64));
            }
        }
    }

    #[inline]
    fn step(&self, state: &mut Position, action: Action, _: Seed) -> f64 {
        let wrong = self.gold.get(state.token as usize).is_some_and(|gold| *gold != action.0);
        state.token += 1;
        state.history.copy_within(..MAX_ORDER - 1, 1);
        state.history[0] = action.0 as u16;
        f64::from(wrong)
    }

    fn actions(&self) -> usize {
        self.labels
    }

    fn horizon(&self, index: usize) -> Option<usize> {
        Some((self.starts[index + 1] - self.starts[index]) as usize)
    }

    /// The labels that history features and the order of labels look at, where they fit.
    #[inline]
    fn signature(&self, state: &Position) -> Option<u64> {
        let labels = &state.history[..self.far?];
        Some(labels.iter().fold(0, |packed, label| packed << 16 | u64::from(*label)))
    }

    fn shared(&self) -> &FeatureTable {
        &self.table
    }
}

/// The expert who knows the right labels: takes the right one where it is legal, else the legal one from which the fewest labels go
/// wrong. Of equals the one of the right label's type is taken (B-NP for an illegal I-NP), then the lowest. Silent where no right
/// labels are known.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gold;

impl Expert<Tagging> for Gold {
    #[inline]
    fn action(&self, space: &Tagging, state: &Position) -> Option<Action> {
        let gold = *space.gold.get(state.token as usize)?;
        let legal = space.legal(state);
        if legal.contains(Action(gold)) {
            return Some(Action(gold));
        }
        let detour = |a: Action| space.detour(state.token + 1, state.end, a.0);
        let kin = |a: Action| space.transitions.kin(a.0, gold);
        // Mostly one of the right label's type leads straight back.
        let straight = legal.iter().find(|a| kin(*a) && detour(*a) == 0);
        straight.or_else(|| legal.iter().min_by_key(|a| (detour(*a), !kin(*a), a.0)))
    }
}

impl CostToGo<Tagging> for Gold {
    fn costs(&self, space: &Tagging, state: &Position, costs: &mut Vec<f64>) {
        costs.clear();
        let Some(gold) = space.gold.get(state.token as usize) else { return };
        costs.extend(space.legal(state).iter().map(|action| {
            f64::from(action.0 != *gold) + f64::from(space.detour(state.token + 1, state.end, action.0))
        }));
    }
}
