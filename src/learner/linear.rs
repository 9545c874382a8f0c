//! What all linear learners share: passes over the examples, descent along a gradient in the columns, averaging.

use super::{Examples, Learner, Online, Setting, Target};
use crate::policy::{Classifier, Columns, Linear, LinearMemory, Weights, best, reserve_some};
use crate::seed::Seed;
use crate::space::{Action, Actions, Features, Front, Listed, Sight};
use rand::seq::SliceRandom;
use std::ops::Range;

mod kept;

/// How weights follow a gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Descent {
    /// w -= g.
    Plain,
    /// Each weight at its own rate: G += g^2, w -= rate * g / sqrt(G) (Duchi, Hazan & Singer 2011), where g includes `l2` * w for
    /// the features at hand.
    Adaptive {
        /// The rate.
        rate: f32,
        /// The weight of half the squared norm.
        l2: f32,
    },
}

impl Descent {
    /// What is kept of each weight beside it: the sum of its changes times when they came, and the sum of squared gradients.
    fn beside(self) -> usize {
        match self {
            Descent::Plain => 1,
            Descent::Adaptive { .. } => 2,
        }
    }
}

/// A loss on linear scores. The weights' average over all examples seen is what is learned.
pub trait Rule: Sync {
    /// What the columns stand for.
    fn columns(&self) -> Columns;

    /// How the weights follow the gradient.
    fn descent(&self) -> Descent;

    /// Passes over the examples in [`Learner::fit`].
    fn passes(&self) -> usize;

    /// Writes the loss's gradient at the scores of `example` into `gradient`, which is zero when it is called; both have one number a
    /// column. The scores of actions that are not legal mean nothing. Returns whether there is anything to change.
    fn gradient(&self, example: Lesson<'_>, scores: &[f32], gradient: &mut [f32]) -> bool;
}

/// One example, as a [`Rule`] sees it.
#[derive(Clone, Copy)]
pub struct Lesson<'a> {
    /// How many actions there are.
    pub actions: usize,
    /// The actions that were legal.
    pub legal: Actions<'a>,
    /// What is to be learned.
    pub target: Target<'a>,
}

/// A linear classifier in the making.
#[derive(Clone, Debug)]
pub struct Course {
    actions: usize,
    columns: Columns,
    weights: Weights,
    /// What is kept of each weight beside it: away from the weights, because every score needs those and only changes need these. Row
    /// after row as in the weights, block after block, what is kept of a block's weights side by side.
    beside: Vec<Block>,
    /// Examples seen.
    seen: u64,
    scores: Vec<f32>,
    gradient: Vec<f32>,
    /// The blocks of the gradient that are not all zero, and which they are.
    blocks: Vec<(usize, Block)>,
    votes: Vec<f32>,
}

/// Columns that are changed together: what one instruction takes on every machine.
const BLOCK: usize = 4;
type Block = [f32; BLOCK];

impl Course {
    /// A course that begins with these weights.
    fn of(actions: usize, columns: Columns, weights: Weights) -> Self {
        let (scores, gradient) = (vec![0.0; weights.stride()], vec![0.0; weights.stride()]);
        let (beside, blocks, votes) = (Vec::new(), Vec::new(), Vec::new());
        Course { actions, columns, weights, beside, seen: 0, scores, gradient, blocks, votes }
    }

    /// Scores the example with these features.
    #[inline]
    fn score(&mut self, features: Listed<'_>, legal: Actions<'_>) {
        let span = self.weights.span(self.columns, legal);
        self.weights.sum_parts(features.parts(), span, &mut self.scores);
    }

    /// Learns from the example that was scored last, which has these features. Returns whether their weights were changed.
    #[inline]
    fn learn<R: Rule>(&mut self, rule: &R, features: Listed<'_>, legal: Actions<'_>, target: Target<'_>) -> bool {
        let count = self.weights.columns();
        let lesson = Lesson { actions: self.actions, legal, target };
        self.gradient.fill(0.0);
        let changes = rule.gradient(lesson, &self.scores[..count], &mut self.gradient[..count]);
        if changes {
            let blocks = self.gradient.as_chunks().0.iter().copied().enumerate();
            self.blocks.clear();
            self.blocks.extend(blocks.filter(|(_, g)| *g != [0.0; BLOCK]));
            features.parts().into_iter().for_each(|part| self.change(rule.descent(), part));
        }
        self.seen += 1;
        changes
    }

    /// Changes the weights of these features, `more` added to their numbers.
    fn change(&mut self, descent: Descent, (features, more): (&[u32], u32)) {
        let when = self.seen as f32;
        let blocks = self.weights.stride() / BLOCK;
        let width = blocks * descent.beside();
        for feature in features.iter().map(|feature| feature + more) {
            let place = self.weights.make_place(feature);
            if self.beside.len() < (place + 1) * width {
                self.beside.resize((place + 1) * width, [0.0; BLOCK]);
            }
            let w = self.weights.row_mut(feature).as_chunks_mut().0;
            let beside = &mut self.beside[place * width..(place + 1) * width];
            match descent {
                Descent::Plain => {
                    for (block, g) in &self.blocks {
                        (w[*block], beside[*block]) = plain(when, *g, w[*block], beside[*block]);
                    }
                }
                Descent::Adaptive { rate, l2 } => {
                    let beside = beside.as_chunks_mut::<2>().0;
                    for (block, g) in &self.blocks {
                        let [u, squares] = beside[*block];
                        let now = (w[*block], u, squares);
                        let (weight, u, squares) = adaptive(rate, l2, when, *g, now);
                        (w[*block], beside[*block]) = (weight, [u, squares]);
                    }
                }
            }
        }
    }
}

/// The weights and the sums of changes after a plain step. Blocks come and go by value: only then can each line be one instruction.
#[inline]
fn plain(when: f32, g: Block, mut w: Block, mut u: Block) -> (Block, Block) {
    for c in 0..BLOCK {
        w[c] -= g[c];
        u[c] -= when * g[c];
    }
    (w, u)
}

/// The weights, the sums of changes and the sums of squares after an adaptive step.
#[inline]
fn adaptive(rate: f32, l2: f32, when: f32, g: Block, now: (Block, Block, Block)) -> (Block, Block, Block) {
    let (mut w, mut u, mut s) = now;
    for c in 0..BLOCK {
        let g = if g[c] == 0.0 { 0.0 } else { g[c] + l2 * w[c] };
        s[c] += g * g;
        // Where the sum is still zero so is g: the small number only keeps 0/0 away.
        let change = rate * g / (s[c].sqrt() + 1e-20);
        w[c] -= change;
        u[c] -= when * change;
    }
    (w, u, s)
}

/// A course of `rule` from the weights of `warm`, which are not measured: for passes over examples, in which nothing is decided.
fn start<R: Rule>(rule: &R, setting: Setting<'_, Features>, warm: Option<&Linear>) -> Course {
    let columns = rule.columns();
    let mut weights = Weights::new(setting.shared.features(), columns.count(setting.actions));
    weights.reserve_all();
    // One with columns for something else, or more features, is none to start from.
    let fits = |warm: &&Linear| {
        let features = warm.weights.features() <= setting.shared.features();
        features && warm.columns == columns && warm.actions == setting.actions
    };
    if let Some(warm) = warm.filter(fits) {
        weights.start_from(&warm.weights);
    }
    let beside = weights.features() * weights.stride() / BLOCK * rule.descent().beside();
    let mut course = Course::of(setting.actions, columns, weights);
    reserve_some(&mut course.beside, beside);
    course
}

/// The weights as they are now, not their average.
impl Classifier<Features> for Course {
    type Memory = LinearMemory;

    fn scores<'m>(&self, sight: &Sight<'_, Features>, memory: &'m mut LinearMemory) -> &'m [f32] {
        memory.scores(self.columns, self.actions, &self.weights, sight)
    }

    #[inline]
    fn choose(&self, sight: &Sight<'_, Features>, memory: &mut LinearMemory) -> Action {
        memory.choose(self.columns, self.actions, &self.weights, sight)
    }

    #[inline]
    fn choose_at_once(&self, sight: &Sight<'_, Features>, memory: &mut LinearMemory) -> Option<Action> {
        memory.choose_at_once(self.columns, self.actions, &self.weights, sight)
    }

    #[inline]
    fn choose_all_at_once(
        &self,
        front: &Front<'_, Features>,
        memory: &mut LinearMemory,
        actions: &mut [Option<Action>],
    ) {
        memory.choose_all_at_once(self.columns, self.actions, &self.weights, front, actions);
    }
}

/// Examples that are gathered before they are learned from.
const AHEAD: usize = 32;

/// Writes the features of the examples `some` one after the other into `features`, and returns where those of each stand, what was legal and what is to be learned. In random order each
/// example would wait for memory, one place after the other, before the next begins to; so they wait side by side.
fn gather<'a>(
    setting: Setting<'a, Features>,
    examples: &'a Examples<Features>,
    some: &[u32],
    features: &mut Vec<u32>,
) -> Vec<(Range<usize>, Actions<'a>, Target<'a>)> {
    features.clear();
    let mut lesson = |i: &u32| {
        let (i, start) = (*i as usize, features.len());
        for (part, more) in examples.views().listed(i, setting.shared).parts() {
            features.extend(part.iter().map(|feature| feature + more));
        }
        (start..features.len(), examples.legal(i), examples.target(i))
    };
    some.iter().map(&mut lesson).collect()
}

impl<R: Rule> Learner<Features> for R {
    type Classifier = Linear;

    fn fit(
        &self,
        setting: Setting<'_, Features>,
        examples: &Examples<Features>,
        warm: Option<&Linear>,
        seed: Seed,
    ) -> Linear {
        let mut course = start(self, setting, warm);
        let mut order: Vec<u32> = (0..examples.len() as u32).collect();
        let (mut rng, mut features) = (seed.rng(), Vec::new());
        for _ in 0..self.passes() {
            order.shuffle(&mut rng);
            for some in order.chunks(AHEAD) {
                for (place, legal, target) in gather(setting, examples, some, &mut features) {
                    let features = Listed { fixed: &features[place], keyed: &[], key: 0, dynamic: &[] };
                    course.score(features, legal);
                    course.learn(self, features, legal, target);
                }
            }
        }
        let mut learned = self.finish(course);
        learned.weights.measure(setting.shared);
        learned
    }
}

impl<R: Rule> Online<Features> for R {
    type Course = Course;

    fn begin(&self, setting: Setting<'_, Features>, warm: Option<&Linear>) -> Course {
        let mut course = start(self, setting, warm);
        course.weights.measure(setting.shared);
        course
    }

    #[inline]
    fn learn(&self, course: &mut Course, sight: &Sight<'_, Features>, target: Option<Target<'_>>) -> Action {
        let features = sight.listed();
        course.score(features, sight.legal);
        let choice = best(course.columns, course.actions, &course.scores, sight.legal, &mut course.votes);
        if let Some(target) = target {
            course.learn(self, features, sight.legal, target);
        }
        choice
    }

    fn study(&self, course: &mut Course, setting: Setting<'_, Features>, examples: &Examples<Features>) {
        for i in 0..examples.len() {
            let features = examples.views().listed(i, setting.shared);
            course.score(features, examples.legal(i));
            if course.learn(self, features, examples.legal(i), examples.target(i)) {
                // Who learns from whole episodes rolls out in between, and asks how far dynamic features reach.
                features.dynamic.iter().for_each(|feature| course.weights.measure_row(*feature));
            }
        }
    }

    fn finish(&self, course: Course) -> Linear {
        let seen = course.seen.max(1) as f32;
        let (blocks, each) = (course.weights.stride() / BLOCK, self.descent().beside());
        let weights = course.weights.map_rows(|place, row| {
            let Some(beside) = course.beside.get(place * blocks * each..) else { return };
            for (w, kept) in row.as_chunks_mut::<BLOCK>().0.iter_mut().zip(beside.chunks_exact(each)) {
                w.iter_mut().zip(&kept[0]).for_each(|(w, u)| *w -= *u / seen);
            }
        });
        Linear { actions: course.actions, columns: course.columns, weights }
    }
}
