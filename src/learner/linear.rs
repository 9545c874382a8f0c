//! What all linear learners share: passes over the examples, descent along a gradient in the columns, averaging.

use super::{Examples, Learner, Online, Setting, Target};
use crate::policy::{Classifier, Columns, Linear, LinearMemory, Weights, read_scores};
use crate::seed::Seed;
use crate::space::{Actions, Features};
use crate::worker::Sight;
use rand::seq::SliceRandom;

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
    /// Planes of a row: the weight, the sum of its changes times when they came, and the sum of squared gradients.
    fn planes(self) -> usize {
        match self {
            Descent::Plain => 2,
            Descent::Adaptive { .. } => 3,
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
    /// column. Returns whether there is anything to change.
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

/// A linear classifier in the making; acts with the weights as they are now.
#[derive(Clone, Debug)]
pub struct Course {
    actions: usize,
    columns: Columns,
    weights: Weights,
    /// Examples seen.
    seen: u64,
    scores: Vec<f32>,
    gradient: Vec<f32>,
}

impl Course {
    fn change(&mut self, descent: Descent, features: &[u32]) {
        let when = self.seen as f32;
        let stride = self.weights.stride();
        let gradient = &self.gradient[..stride];
        for &feature in features {
            let (w, rest) = self.weights.row_mut(feature).split_at_mut(stride);
            match descent {
                Descent::Plain => {
                    for ((w, u), g) in w.iter_mut().zip(rest).zip(gradient) {
                        *w -= g;
                        *u -= when * g;
                    }
                }
                Descent::Adaptive { rate, l2 } => {
                    let (u, squares) = rest.split_at_mut(stride);
                    for (((w, u), s), g) in w.iter_mut().zip(u).zip(squares).zip(gradient) {
                        let g = if *g == 0.0 { 0.0 } else { g + l2 * *w };
                        *s += g * g;
                        // Where the sum is still zero so is g: the small number only keeps 0/0 away.
                        let change = rate * g / (s.sqrt() + 1e-20);
                        *w -= change;
                        *u -= when * change;
                    }
                }
            }
        }
    }
}

impl Classifier<Features> for Course {
    type Memory = LinearMemory;

    #[inline]
    fn scores<'m>(&self, sight: &Sight<'_, Features>, memory: &'m mut LinearMemory) -> &'m [f32] {
        read_scores(self.actions, self.columns, &self.weights, sight, memory)
    }
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
        let mut course = self.begin(setting, warm);
        let mut order: Vec<u32> = (0..examples.len() as u32).collect();
        let mut rng = seed.rng();
        for _ in 0..self.passes() {
            order.shuffle(&mut rng);
            self.study(&mut course, setting, examples, order.iter().map(|i| *i as usize));
        }
        self.finish(course)
    }
}

impl<R: Rule> Online<Features> for R {
    type Course = Course;

    fn begin(&self, setting: Setting<'_, Features>, warm: Option<&Linear>) -> Course {
        let columns = self.columns();
        let count = columns.count(setting.actions);
        let mut weights = Weights::new(setting.shared.features(), count, self.descent().planes());
        if let Some(warm) = warm {
            for feature in 0..warm.weights.features() as u32 {
                if let Some(row) = warm.weights.row(feature) {
                    weights.row_mut(feature)[..row.len()].copy_from_slice(row);
                }
            }
        }
        let (scores, gradient) = (vec![0.0; weights.stride()], vec![0.0; weights.stride()]);
        Course { actions: setting.actions, columns, weights, seen: 0, scores, gradient }
    }

    fn study(
        &self,
        course: &mut Course,
        setting: Setting<'_, Features>,
        examples: &Examples<Features>,
        order: impl Iterator<Item = usize>,
    ) {
        let descent = self.descent();
        let count = course.weights.columns();
        for i in order {
            let (row, dynamic) = examples.views().get(i);
            let fixed = setting.shared.row(row);
            course.scores.fill(0.0);
            course.gradient.fill(0.0);
            course.weights.add_to(fixed, &mut course.scores);
            course.weights.add_to(dynamic, &mut course.scores);
            let lesson = Lesson { actions: course.actions, legal: examples.legal(i), target: examples.target(i) };
            if self.gradient(lesson, &course.scores[..count], &mut course.gradient[..count]) {
                course.change(descent, fixed);
                course.change(descent, dynamic);
            }
            course.seen += 1;
        }
    }

    fn finish(&self, course: Course) -> Linear {
        let stride = course.weights.stride();
        let seen = course.seen.max(1) as f32;
        let weights = course.weights.fold(|planes, average| {
            for ((average, w), u) in average.iter_mut().zip(&planes[..stride]).zip(&planes[stride..2 * stride]) {
                *average = w - u / seen;
            }
        });
        Linear { actions: course.actions, columns: course.columns, weights }
    }
}
