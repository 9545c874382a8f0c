//! Linear support vector machines, one for each pair of actions.

use super::dual::{Batch, Steps};
use super::{Examples, Kept, Learner, Lesson, Online, Setting, Target, Wap};
use crate::output::Arrays;
use crate::policy::{Classifier, Columns, Linear, LinearMemory, Weights};
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Features, Sight};
use rand::seq::SliceRandom;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Linear support vector machines for all pairs of actions, by dual coordinate descent with shrinking (Hsieh, Chang, Lin, Keerthi
/// & Sundararajan 2008, algorithm 3): for each pair the w that minimises ½ |w|² + Σ C_n max(0, 1 - y_n w·x_n). The action that beats most others
/// is taken.
///
/// A cost-sensitive learner: C_n is [`Svm::cost`] times the weight that weighted all pairs ([`Wap`]) gives the pair in the example, so a label
/// counts 1 against every other action and pairs of two others not at all, as usual with labels. There is no bias but what features there are.
///
/// Equal examples count as one with their number as weight, which is the same problem and a smaller one. The solution does not depend on where
/// descent starts: a classifier to start from is not used. Online, each example gets one step in the dual when it comes up, which is
/// the passive-aggressive algorithm (PA-I, Crammer et al. 2006).
///
/// ```
/// use rollin::learner::Svm;
/// use rollin::space::{Imitation, doc::{Follow, RealWorld}};
/// use rollin::trainer::{Run, Supervised};
///
/// let problem = Imitation { space: RealWorld, expert: Follow, episodes: 20 };
/// let trained = Supervised::default().train(&problem, &Svm { cost: 0.1, ..Svm::default() }, &Run::new(1))?;
/// assert_eq!(trained.ledger.examples, 200);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Svm {
    /// C: what a margin error costs. It counts for each example: what is learned from the rounds of an aggregate together is regularised less than
    /// what is learned from one.
    pub cost: f32,
    /// Passes over the examples of a pair at most.
    pub passes: usize,
    /// Descent stops where the projected gradient is nowhere further from 0 than this.
    pub tolerance: f32,
}

impl Default for Svm {
    fn default() -> Self {
        Svm { cost: 0.1, passes: 100, tolerance: 0.1 }
    }
}

/// An example of one pair.
#[derive(Clone, Copy)]
struct Item {
    /// Its number in the batch.
    n: u32,
    /// 1 where the first of the pair is cheaper, -1 where it is the second.
    sign: f64,
    /// What alpha is at most.
    most: f64,
    alpha: f64,
}

impl Svm {
    /// The nonzero weights of one pair.
    fn solve(&self, batch: &Batch<'_>, mut items: Vec<Item>, features: usize, seed: Seed) -> Vec<(u32, f32)> {
        let mut w = vec![0.0f64; features];
        let mut rng = seed.rng();
        let mut active = items.len();
        let (mut above, mut below) = (f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..self.passes {
            items[..active].shuffle(&mut rng);
            let (mut high, mut low) = (0.0f64, 0.0f64);
            let mut at = 0;
            while at < active {
                let slope = self.step(batch, &mut items[at], &mut w, (above, below));
                match slope {
                    Some(slope) => {
                        (high, low) = (high.max(slope), low.min(slope));
                        at += 1;
                    }
                    None => {
                        active -= 1;
                        items.swap(at, active);
                    }
                }
            }
            if high.max(-low) <= f64::from(self.tolerance) {
                if active == items.len() {
                    break;
                }
                // All that was left out is looked at once more.
                active = items.len();
                (above, below) = (f64::INFINITY, f64::NEG_INFINITY);
            } else {
                above = if high <= 0.0 { f64::INFINITY } else { high };
                below = if low >= 0.0 { f64::NEG_INFINITY } else { low };
            }
        }
        let nonzero = w.iter().enumerate().filter(|(_, w)| **w != 0.0);
        nonzero.map(|(feature, w)| (feature as u32, *w as f32)).collect()
    }

    /// Minimises along the variable of `item`. Returns the projected gradient there, or nothing where the variable is at a bound that it will
    /// hardly leave again: its gradient lies beyond those of the pass before.
    #[inline]
    fn step(&self, batch: &Batch<'_>, item: &mut Item, w: &mut [f64], (above, below): (f64, f64)) -> Option<f64> {
        let features = batch.features(item.n as usize);
        let sum: f64 = features.iter().map(|feature| w[feature as usize]).sum();
        let gradient = item.sign * sum - 1.0;
        let projected = if item.alpha == 0.0 {
            if gradient > above {
                return None;
            }
            gradient.min(0.0)
        } else if item.alpha == item.most {
            if gradient < below {
                return None;
            }
            gradient.max(0.0)
        } else {
            gradient
        };
        if projected.abs() > 1e-12 {
            let norm = features.len() as f64;
            let alpha = (item.alpha - gradient / norm).clamp(0.0, item.most);
            let change = item.sign * (alpha - item.alpha);
            item.alpha = alpha;
            features.iter().for_each(|feature| w[feature as usize] += change);
        }
        Some(projected)
    }
}

/// Writes the value that weighted all pairs gives each action into `values`; not a number where it is not legal.
fn value(lesson: Lesson<'_>, values: &mut [f32], scratch: &mut Vec<f32>) {
    values.fill(f32::NAN);
    scratch.clear();
    match lesson.target {
        Target::Label(label) => scratch.extend(lesson.legal.iter().map(|a| if a == label { 0.0 } else { 1.0 })),
        Target::Costs(costs) => {
            scratch.extend_from_slice(costs);
            Wap::integrate(scratch);
        }
    }
    for (action, value) in lesson.legal.iter().zip(scratch) {
        values[action.index()] = *value;
    }
}

impl Learner<Features> for Svm {
    type Classifier = Linear;

    fn fit(
        &self,
        setting: Setting<'_, Features>,
        examples: &Examples<Features>,
        _: Option<&Linear>,
        seed: Seed,
    ) -> Linear {
        let (k, features) = (setting.actions, setting.shared.features());
        let batch = Batch::of(setting, examples);
        let mut values = vec![0.0; batch.len() * k];
        let mut scratch = Vec::new();
        for (n, values) in values.chunks_mut(k.max(1)).enumerate() {
            let (i, _) = batch.example(n);
            value(Lesson { actions: k, legal: examples.legal(i), target: examples.target(i) }, values, &mut scratch);
        }
        let pairs: Vec<(usize, usize)> = (0..k).flat_map(|i| (i + 1..k).map(move |j| (i, j))).collect();
        let solved: Vec<Vec<(u32, f32)>> = pairs
            .par_iter()
            .map(|&(i, j)| {
                let items = (values.chunks(k).enumerate()).filter_map(|(n, v)| {
                    let more = f64::from(v[j] - v[i]);
                    let most = f64::from(self.cost * batch.example(n).1) * more.abs();
                    (most > 0.0).then_some(Item { n: n as u32, sign: more.signum(), most, alpha: 0.0 })
                });
                let column = Columns::pair(k, i, j) as u64;
                self.solve(&batch, items.collect(), features, seed.child(Purpose::Learner, column))
            })
            .collect();
        let mut weights = Weights::new(features, Columns::Pairs.count(k));
        for (column, solved) in solved.into_iter().enumerate() {
            for (feature, w) in solved {
                weights.row_mut(feature)[column] = w;
            }
        }
        Linear { actions: k, columns: Columns::Pairs, weights }
    }
}

/// An [`Svm`] in the middle of learning.
#[derive(Clone, Debug)]
pub struct SvmCourse {
    steps: Steps,
    pairs: Pairs,
}

/// The pairs of one example.
#[derive(Clone, Debug)]
struct Pairs {
    values: Vec<f32>,
    scratch: Vec<f32>,
}

impl Pairs {
    fn of(actions: usize) -> Self {
        Pairs { values: vec![0.0; actions], scratch: Vec::new() }
    }

    /// Writes the step in the dual of each pair at which these scores fall short of the margin into `change`. Returns whether there is any.
    fn step(&mut self, cost: f32, lesson: Lesson<'_>, norm: f32, scores: &[f32], change: &mut [f32]) -> bool {
        let Pairs { values, scratch } = self;
        value(lesson, values, scratch);
        let mut any = false;
        for i in 0..lesson.actions {
            for j in i + 1..lesson.actions {
                let (column, more) = (Columns::pair(lesson.actions, i, j), values[j] - values[i]);
                let short = 1.0 - more.signum() * scores[column];
                if more.abs() > 0.0 && short > 0.0 {
                    change[column] = more.signum() * (short / norm).min(cost * more.abs());
                    any = true;
                }
            }
        }
        any
    }
}

impl Kept<Features> for SvmCourse {
    fn put(&self, to: &mut Vec<u8>) {
        self.steps.put(to);
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, Features>) -> Option<Self> {
        Some(SvmCourse { steps: Steps::take(from, setting)?, pairs: Pairs::of(setting.actions) })
    }

    fn follows(&self, start: &Self) -> bool {
        self.steps.follows(&start.steps)
    }
}

/// The weights as they are now.
impl Classifier<Features> for SvmCourse {
    type Memory = LinearMemory;

    fn scores<'m>(&self, sight: &Sight<'_, Features>, memory: &'m mut LinearMemory) -> &'m [f32] {
        self.steps.scores(sight, memory)
    }
}

impl Online<Features> for Svm {
    type Course = SvmCourse;

    fn begin(&self, setting: Setting<'_, Features>, warm: Option<&Linear>) -> SvmCourse {
        SvmCourse { steps: Steps::begin(Columns::Pairs, setting, warm), pairs: Pairs::of(setting.actions) }
    }

    fn learn(&self, course: &mut SvmCourse, sight: &Sight<'_, Features>, target: Option<Target<'_>>) -> Action {
        let SvmCourse { steps, pairs } = course;
        steps.meet(sight, target, |lesson, norm, scores, change| pairs.step(self.cost, lesson, norm, scores, change))
    }

    fn study(&self, course: &mut SvmCourse, setting: Setting<'_, Features>, examples: &Examples<Features>) {
        let SvmCourse { steps, pairs } = course;
        steps.study(setting, examples, |lesson, norm, scores, change| {
            pairs.step(self.cost, lesson, norm, scores, change)
        });
    }

    fn finish(&self, course: SvmCourse) -> Linear {
        course.steps.finish()
    }
}
