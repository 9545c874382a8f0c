//! Sentences as a space: one label after the other, left to right.

use super::transitions::{Order, Transitions};
use crate::seed::Seed;
use crate::space::{Action, Actions, CostToGo, Episode, Expert, FeatureTable, Features, Space};
use std::borrow::Cow;
use std::sync::Arc;

/// How many labels back a history feature may look.
pub const MAX_ORDER: usize = crate::read::template::BACK as usize;
const _: () = assert!(MAX_ORDER == 8, "a history of 128 bits has room for no more");

/// The feature numbers of one history line of a template: every context with every combination of the labels it looks at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HistoryLine {
    /// Its place among the history lines of the template, and so among the contexts of a token.
    pub line: usize,
    /// How many tokens further on the labels stand that it looks at: -1 is the one before, from 0 on it is that of a first reading.
    pub labels: Vec<i32>,
    /// Whether one of them is that of a first reading.
    pub ahead: bool,
    /// Whether the line before looks at the same labels.
    pub(super) again: bool,
    /// The first of its feature numbers.
    pub base: u32,
    /// How many feature numbers it has.
    pub size: u32,
    /// How many combinations of labels there are, if they are as many as fit.
    codes: u64,
    /// Whether there are as many numbers as contexts times combinations, or fewer, which combinations share by hash.
    exact: bool,
}

/// No such context was ever seen: the feature is left out.
pub const NO_CONTEXT: u32 = u32::MAX;

/// A line of more combinations than this shares its feature numbers by hash.
const MOST: u64 = 1 << 24;

impl HistoryLine {
    /// Line `line`, which looks at the labels `at`, with `contexts` contexts and `labels` labels, numbered from `base`.
    pub fn new(line: usize, at: &[i32], contexts: usize, labels: usize, base: u32) -> Self {
        let codes = (labels as u64 + 1).checked_pow(at.len() as u32);
        let all = codes.and_then(|n| n.checked_mul(contexts as u64)).filter(|n| *n <= MOST);
        HistoryLine {
            line,
            labels: at.to_vec(),
            ahead: at.iter().any(|k| *k >= 0),
            again: false,
            base,
            size: all.unwrap_or(MOST) as u32,
            codes: codes.unwrap_or(MOST),
            exact: all.is_some(),
        }
    }

    /// Whether the label before is the only one that it looks at, and added to the [first](HistoryLine::first) number of a context gives its feature.
    pub(super) fn is_keyed(&self) -> bool {
        self.exact && self.labels == [-1]
    }

    /// What [`HistoryLine::number`] needs of `context`: the first of its feature numbers, where they are its own.
    pub(super) fn first(&self, context: u32) -> u32 {
        match self.exact && context != NO_CONTEXT {
            true => self.base + context * self.codes as u32,
            false => context,
        }
    }

    /// The labels that it looks at in one number: `label(k)` is the one `k` tokens further on.
    #[inline]
    fn code(&self, labels: u64, label: impl Fn(i32) -> u16) -> u64 {
        self.labels.iter().fold(0, |code: u64, k| code.wrapping_mul(labels + 1).wrapping_add(u64::from(label(*k))))
    }

    /// The feature number with the labels of `code` of the context whose [first](HistoryLine::first) this is.
    #[inline]
    fn number(&self, first: u32, code: u64) -> u32 {
        if self.exact {
            return first + code as u32;
        }
        let n = u64::from(first).wrapping_mul(self.codes).wrapping_add(code);
        let n = (n ^ n >> 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.base + (n >> 29) as u32 % MOST as u32
    }
}

impl HistoryLine {
    /// The context and the labels, in the order of `self.labels`, that the feature `number` stands for, one of `labels` each or none; `None` if it is no feature of this
    /// line, or one that several share.
    pub(super) fn apart(&self, number: u32, labels: usize) -> Option<(u32, Vec<Option<usize>>)> {
        let n = number.checked_sub(self.base).filter(|n| self.exact && *n < self.size)?;
        let (context, mut code) = (u64::from(n) / self.codes, u64::from(n) % self.codes);
        let mut found = Vec::with_capacity(self.labels.len());
        for _ in &self.labels {
            let label = (code % (labels as u64 + 1)) as usize;
            found.push(Some(label).filter(|label| *label < labels));
            code /= labels as u64 + 1;
        }
        found.reverse();
        Some((context as u32, found))
    }

    /// The number here of the n-th feature of `later`, the same line with more contexts; none if it is new, or numbered in another way since there are so many.
    pub(super) fn moved(&self, later: &HistoryLine, n: u32) -> Option<u32> {
        Some(self.base + n).filter(|_| n < self.size && self.exact == later.exact)
    }

    /// The feature number of `context` with these labels.
    pub(super) fn feature(&self, context: u32, labels: u64, label: impl Fn(i32) -> u16) -> u32 {
        self.number(self.first(context), self.code(labels, label))
    }
}

/// The sentences of a corpus as episodes: one label after the other, left to right, or right to left in a first reading
/// ([`Tagging::backwards`]). Copies share what is large.
#[derive(Clone, Debug)]
pub struct Tagging {
    pub(super) table: Arc<FeatureTable>,
    /// Where each sentence starts and ends.
    pub(super) sentences: Vec<[u32; 2]>,
    /// The right label of every token; empty where none is known, and then no label costs anything.
    pub(super) gold: Arc<[u32]>,
    pub(super) transitions: Arc<Transitions>,
    pub(super) labels: usize,
    /// The lines that are not [keyed](HistoryLine::is_keyed): those are in the table.
    pub(super) history: Arc<[HistoryLine]>,
    /// How many labels back the future of a state depends on; `None` if they do not fit into a signature.
    pub(super) far: Option<usize>,
    /// `firsts[token * history.len() + i]`: the [first](HistoryLine::first) of the context of line i of the history, or [`NO_CONTEXT`].
    pub(super) firsts: Arc<[u32]>,
    pub(super) reading: Reading,
}

/// Which way a sentence is read.
#[derive(Clone, Debug)]
pub(super) enum Reading {
    /// From the start to the end.
    Only,
    /// From the end to the start, for a second one to know what comes.
    First,
    /// From the start to the end, after a first one that gave the tokens these labels.
    Second(Arc<[u16]>),
}

/// A place in a sentence and the labels given just before it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Position {
    token: u32,
    /// Tokens without a label.
    left: u32,
    /// Sixteen bits a label, the last one lowest; [`Transitions::begin`] where there is none.
    history: u128,
}

impl Position {
    /// The token at hand.
    pub fn token(&self) -> u32 {
        self.token
    }

    /// How many tokens have no label yet, the one at hand among them.
    pub fn left(&self) -> u32 {
        self.left
    }

    /// Goes `tokens` tokens further on, of which `label` is what was said last.
    pub(in crate::tasks) fn advance(&mut self, tokens: u32, label: u32) {
        self.token += tokens;
        self.left -= tokens;
        self.say(label);
    }

    #[inline]
    fn say(&mut self, label: u32) {
        self.history = self.history << 16 | u128::from(label as u16);
    }

    /// The label `back` tokens back, from 1.
    #[inline]
    fn before(&self, back: usize) -> u16 {
        (self.history >> (16 * (back - 1))) as u16
    }

    #[inline]
    fn previous(&self) -> u32 {
        u32::from(self.before(1))
    }
}

impl Tagging {
    /// How many sentences.
    pub fn sentences(&self) -> usize {
        self.sentences.len()
    }

    /// Whether its features ask for two readings.
    pub fn looks_ahead(&self) -> bool {
        self.history.iter().any(|line| line.ahead)
    }

    /// The same sentences for a first reading, from the end to the start: any label may follow any, and nothing is looked at ahead.
    pub fn backwards(&self) -> Tagging {
        Tagging { reading: Reading::First, transitions: Arc::new(self.transitions.freed()), ..self.clone() }
    }

    /// The same sentences for a second reading, after a first that took these actions, sentence after sentence in its own direction.
    ///
    /// # Panics
    /// When there are fewer actions than tokens.
    pub fn told(&self, said: &[Action]) -> Tagging {
        let mut labels = vec![self.transitions.begin() as u16; self.table.rows()];
        let mut said = said.iter();
        for [start, end] in &self.sentences {
            for token in (*start..*end).rev() {
                labels[token as usize] = said.next().map_or(labels[token as usize], |action| action.0 as u16);
            }
        }
        Tagging { reading: Reading::Second(labels.into()), ..self.clone() }
    }

    /// Those sentences whose numbers `keep` wants.
    pub fn part(&self, keep: impl Fn(usize) -> bool) -> Tagging {
        let kept = self.sentences.iter().enumerate().filter(|(i, _)| keep(*i));
        Tagging { sentences: kept.map(|(_, sentence)| *sentence).collect(), ..self.clone() }
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
        let far = history.iter().flat_map(|line| &line.labels).map(|k| -k).max().unwrap_or(1).max(1) as usize;
        (far <= MAX_ORDER.min(4)).then_some(far)
    }

    /// Whether the right label is legal after `state` whatever is taken there, or there is none.
    fn needs_no_detour(&self, state: &Position) -> bool {
        let left = state.left - 1;
        self.transitions.order() == Order::Free
            || left == 0
            || self.transitions.allows_anywhere(self.gold[state.token as usize + 1], left)
    }

    /// How many labels are wrong at best after `state` if `previous` is taken there: until the right label is legal again all are, and after
    /// that none need be.
    fn detour(&self, state: &Position, previous: u32) -> u32 {
        let (next, end) = (state.token + 1, state.token + state.left);
        let right = |previous: u32, at: u32| self.transitions.allows(previous, self.gold[at as usize], end - at);
        let after = |previous: u32, at: u32| self.transitions.after(previous, end - at).iter().map(|a| a.0);
        if self.transitions.order() == Order::Free || next == end || right(previous, next) {
            return 0;
        }
        if next + 1 == end || self.transitions.is_near(self.gold[next as usize + 1], end - next - 1) {
            return 1;
        }
        let only = [previous];
        let mut front = Cow::from(&only[..]);
        for at in next + 1..end {
            let reached = || front.iter().flat_map(|y| after(*y, at - 1));
            // Mostly one wrong label leads back, and no list of them is made.
            if reached().any(|y| right(y, at)) {
                return at - next;
            }
            let mut ahead: Vec<u32> = reached().collect();
            ahead.sort_unstable();
            ahead.dedup();
            front = ahead.into();
        }
        end - next
    }
}

impl Tagging {
    /// Writes into `view` what there is to see; `label` knows the labels around, those ahead only where they are wanted.
    #[inline]
    fn look_around(&self, state: &Position, ahead: bool, label: impl Fn(i32) -> u16, view: &mut Features) {
        let firsts = &self.firsts[state.token as usize * self.history.len()..][..self.history.len()];
        (view.row, view.key) = (state.token, state.previous());
        view.dynamic.clear();
        let mut code = 0;
        for (line, first) in self.history.iter().zip(firsts).filter(|(line, _)| ahead || !line.ahead) {
            if !line.again {
                code = line.code(self.labels as u64, &label);
            }
            if *first != NO_CONTEXT {
                view.dynamic.push(line.number(*first, code));
            }
        }
    }
}

impl Space for Tagging {
    type State = Position;
    type View = Features;

    fn start(&self, episode: Episode) -> Position {
        let begin = u128::from(self.transitions.begin() as u16);
        let [start, end] = self.sentences[episode.index];
        let token = if matches!(self.reading, Reading::First) { end - 1 } else { start };
        Position { token, left: end - start, history: (0..MAX_ORDER).fold(0, |history, _| history << 16 | begin) }
    }

    #[inline]
    fn legal<'a>(&'a self, state: &'a Position) -> Actions<'a> {
        if state.left == 0 { Actions::NONE } else { self.transitions.after(state.previous(), state.left) }
    }

    #[inline]
    fn look(&self, state: &Position, view: &mut Features) {
        let begin = self.transitions.begin() as u16;
        let before = |k: i32| state.before((-k) as usize);
        match &self.reading {
            Reading::Second(said) => {
                let said = &said[state.token as usize..(state.token + state.left) as usize];
                let around = |k: i32| if k < 0 { before(k) } else { said.get(k as usize).copied().unwrap_or(begin) };
                self.look_around(state, true, around, view);
            }
            _ => self.look_around(state, false, before, view),
        }
    }

    #[inline]
    fn glance(&self, state: &Position, view: &mut Features) -> bool {
        (view.row, view.key) = (state.token, state.previous());
        true
    }

    #[inline]
    fn step(&self, state: &mut Position, action: Action, _: Seed) -> f64 {
        let wrong = self.gold.get(state.token as usize).is_some_and(|gold| *gold != action.0);
        state.token =
            if matches!(self.reading, Reading::First) { state.token.wrapping_sub(1) } else { state.token + 1 };
        state.left -= 1;
        state.say(action.0);
        f64::from(wrong)
    }

    fn actions(&self) -> usize {
        self.labels
    }

    fn horizon(&self, index: usize) -> Option<usize> {
        let [start, end] = self.sentences[index];
        Some((end - start) as usize)
    }

    /// The labels that history features and the order of labels look at, where they fit.
    #[inline]
    fn signature(&self, state: &Position) -> Option<u64> {
        Some(state.history as u64 & u64::MAX >> (64 - 16 * self.far?))
    }

    fn is_trellis(&self) -> bool {
        self.far == Some(1)
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
        if space.transitions.allows(state.previous(), gold, state.left) {
            return Some(Action(gold));
        }
        let detour = |a: Action| space.detour(state, a.0);
        let legal = |a: Action| space.transitions.allows(state.previous(), a.0, state.left);
        let foreign = |a: Action| !space.transitions.kin(a.0, gold);
        // Mostly one of the right label's type leads straight back.
        let straight = space.transitions.alike(gold).iter().copied().find(|a| legal(*a) && detour(*a) == 0);
        straight.or_else(|| space.legal(state).iter().min_by_key(|a| (detour(*a), foreign(*a), a.0)))
    }

    fn foresee(&self, space: &Tagging, state: &Position, costs: &mut Vec<f64>) -> Option<u64> {
        self.costs(space, state, costs);
        (!space.gold.is_empty()).then_some(costs.len() as u64 * u64::from(state.left))
    }
}

impl CostToGo<Tagging> for Gold {
    fn costs(&self, space: &Tagging, state: &Position, costs: &mut Vec<f64>) {
        costs.clear();
        let Some(gold) = space.gold.get(state.token as usize) else { return };
        let wrong = |action: Action| f64::from(action.0 != *gold);
        let legal = space.legal(state).iter();
        if space.needs_no_detour(state) {
            costs.extend(legal.map(wrong));
        } else {
            costs.extend(legal.map(|action| wrong(action) + f64::from(space.detour(state, action.0))));
        }
    }
}
