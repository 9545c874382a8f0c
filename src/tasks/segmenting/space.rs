//! Sentences as a space: one span after the other, left to right.

use crate::seed::Seed;
use crate::space::{Action, Actions, CostToGo, Episode, Expert, FeatureTable, Features, Imitation, Space};
use crate::tasks::tagging::{Position, Tagging};
use std::ops::Range;
use std::sync::Arc;

/// What an action does: so many tokens get this label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Tokens, at least one.
    pub length: u32,
    /// The number of the label.
    pub label: u32,
    /// The action with the same label that is one token shorter; itself if there is none.
    shorter: u32,
}

/// All segments, the number of each its place: by length, then outside, then by label. So those that fit into what is left of a sentence come first.
#[derive(Clone, Debug)]
pub(super) struct Segments {
    all: Vec<Segment>,
    /// How many are of at most this length.
    up_to: Vec<u32>,
    /// The label of what is outside all spans.
    outside: u32,
}

impl Segments {
    /// Those of up to `longest[y]` tokens for each label y.
    pub(super) fn new(longest: &[u32], outside: u32) -> Self {
        let (mut all, mut up_to): (Vec<Segment>, _) = (Vec::new(), vec![0]);
        let mut last = vec![0; longest.len()];
        for length in 1..=longest.iter().copied().max().unwrap_or(0) {
            let mut labels: Vec<u32> = (0..longest.len() as u32).filter(|y| length <= longest[*y as usize]).collect();
            labels.sort_by_key(|y| (*y != outside, *y));
            for label in labels {
                let number = all.len() as u32;
                let shorter = std::mem::replace(&mut last[label as usize], number);
                all.push(Segment { length, label, shorter: if length == 1 { number } else { shorter } });
            }
            up_to.push(all.len() as u32);
        }
        Segments { all, up_to, outside }
    }

    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    pub(super) fn get(&self, action: Action) -> Segment {
        self.all[action.index()]
    }

    /// How many fit into `left` tokens.
    fn fitting(&self, left: u32) -> u32 {
        self.up_to[(left as usize).min(self.up_to.len() - 1)]
    }

    /// Writes for each segment that fits how many tokens it labels wrong where `gold` is what is left of a sentence, as [`code`]s.
    fn wrong(&self, gold: &[u32], costs: &mut Vec<f64>) {
        costs.clear();
        for (number, segment) in self.all[..self.fitting(gold.len() as u32) as usize].iter().enumerate() {
            let before = if segment.shorter as usize == number { 0.0 } else { costs[segment.shorter as usize] };
            let at = segment.length as usize - 1;
            costs.push(before + f64::from(gold[at] != code(segment.label, at > 0)));
        }
    }
}

/// A token's label and whether it is one within a span, after the first.
pub(super) fn code(label: u32, within: bool) -> u32 {
    2 * label + u32::from(within)
}

/// What is known of the right spans.
#[derive(Clone, Debug, Default)]
struct Known {
    /// The [`code`] of each token.
    gold: Vec<u32>,
    /// What the cheapest way from each token to its sentence's end costs.
    rest: Vec<u32>,
    /// The first step of that way.
    best: Vec<u32>,
}

/// The sentences of a corpus as episodes, a span a step. Copies share what is large.
#[derive(Clone, Debug)]
pub struct Segmenting {
    tagging: Tagging,
    segments: Arc<Segments>,
    known: Arc<Known>,
}

impl Segmenting {
    /// Sentences whose spans are not known.
    pub(super) fn new(tagging: Tagging, segments: Arc<Segments>) -> Self {
        Segmenting { tagging, segments, known: Arc::default() }
    }

    /// The same sentences, these tokens each, with the [`code`] of every token.
    pub(super) fn knowing(self, sentences: impl Iterator<Item = Range<usize>>, gold: Vec<u32>) -> Self {
        let (mut rest, mut best, mut costs) = (vec![0; gold.len()], vec![0; gold.len()], Vec::new());
        for sentence in sentences {
            for token in sentence.clone().rev() {
                self.segments.wrong(&gold[token..sentence.end], &mut costs);
                let mut cheapest: Option<(u32, Segment, u32)> = None;
                for (number, (segment, wrong)) in self.segments.all.iter().zip(&costs).enumerate() {
                    let after = token + segment.length as usize;
                    let cost = *wrong as u32 + if after < sentence.end { rest[after] } else { 0 };
                    // Of equals outside, else the longest: whatever is cut in pieces is no span any more.
                    let better = cheapest.is_none_or(|(least, other, _)| {
                        let longer = other.label != self.segments.outside && segment.length > other.length;
                        cost < least || cost == least && longer
                    });
                    if better {
                        cheapest = Some((cost, *segment, number as u32));
                    }
                }
                (rest[token], best[token]) = cheapest.map_or((0, 0), |(cost, _, number)| (cost, number));
            }
        }
        Segmenting { known: Arc::new(Known { gold, rest, best }), ..self }
    }

    /// The problem of imitating [`Divider`] on all sentences.
    pub fn problem(self) -> Imitation<Segmenting, Divider> {
        let episodes = self.tagging.sentences();
        Imitation { space: self, expert: Divider, episodes }
    }

    /// What `action` does.
    pub fn segment(&self, action: Action) -> Segment {
        self.segments.get(action)
    }

    /// The codes of what is left of the sentence; none where they are not known.
    fn gold(&self, state: &Position) -> &[u32] {
        let start = state.token() as usize;
        self.known.gold.get(start..start + state.left() as usize).unwrap_or(&[])
    }
}

impl Space for Segmenting {
    /// Whose labels are those of the spans before.
    type State = Position;
    type View = Features;

    fn start(&self, episode: Episode) -> Position {
        self.tagging.start(episode)
    }

    fn legal<'a>(&'a self, state: &'a Position) -> Actions<'a> {
        Actions::All(self.segments.fitting(state.left()))
    }

    fn look(&self, state: &Position, view: &mut Features) {
        self.tagging.look(state, view);
    }

    fn glance(&self, state: &Position, view: &mut Features) -> bool {
        self.tagging.glance(state, view)
    }

    fn step(&self, state: &mut Position, action: Action, _: Seed) -> f64 {
        let Segment { length, label, .. } = self.segments.get(action);
        let gold = self.gold(state).iter().take(length as usize).enumerate();
        let wrong = gold.filter(|(at, gold)| **gold != code(label, *at > 0)).count();
        state.advance(length, label);
        wrong as f64
    }

    fn actions(&self) -> usize {
        self.segments.len()
    }

    /// As [`Tagging`]'s, with the place: states of one step may stand at different ones. None where that does not fit.
    fn signature(&self, state: &Position) -> Option<u64> {
        let seen = self.tagging.signature(state)?;
        (seen >> 32 == 0).then_some(seen << 32 | u64::from(state.left()))
    }

    fn shared(&self) -> &FeatureTable {
        self.tagging.shared()
    }
}

/// The expert who knows the right spans: from wherever the state at hand stands, takes the first step of a way on which the fewest tokens go wrong. Of
/// equal steps the one outside all spans is taken, else the longest, then the lowest. Silent where no right spans are known.
#[derive(Clone, Copy, Debug, Default)]
pub struct Divider;

impl Expert<Segmenting> for Divider {
    fn action(&self, space: &Segmenting, state: &Position) -> Option<Action> {
        space.known.best.get(state.token() as usize).map(|best| Action(*best))
    }
}

impl CostToGo<Segmenting> for Divider {
    fn costs(&self, space: &Segmenting, state: &Position, costs: &mut Vec<f64>) {
        let gold = space.gold(state);
        costs.clear();
        if gold.is_empty() {
            return;
        }
        space.segments.wrong(gold, costs);
        for (cost, segment) in costs.iter_mut().zip(&space.segments.all) {
            if (segment.length as usize) < gold.len() {
                *cost += f64::from(space.known.rest[(state.token() + segment.length) as usize]);
            }
        }
    }
}
