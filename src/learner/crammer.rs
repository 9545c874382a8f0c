//! The multiclass support vector machine of Crammer & Singer.

use super::dual::{Batch, Steps};
use super::{Examples, Kept, Learner, Lesson, Online, Setting, Target, reduce};
use crate::output::Arrays;
use crate::policy::{Classifier, Columns, Linear, LinearMemory};
use crate::seed::Seed;
use crate::space::{Action, Features, Sight};
use rand::seq::SliceRandom;
use serde::{Deserialize, Serialize};

/// The multiclass linear support vector machine (Crammer & Singer 2001), by the sequential dual method (Keerthi, Sundararajan, Chang, Hsieh &
/// Lin 2008): minimises ½ Σ_a |w_a|² + C Σ_n max_a (w_a·x_n + c_a - w_b·x_n), where b is the cheapest action, the lowest of equals, and c_a is what a costs more.
///
/// A cost-sensitive learner: with a label all other actions cost 1, which is the original; with costs the margin to each action is what it costs
/// (margin rescaling, Taskar, Guestrin & Koller 2003). All variables of one example are solved for at once, exactly.
///
/// Equal examples count as one. The solution does not depend on where descent starts: a classifier to start from is not used. Online, each
/// example gets one step in the dual when it comes up, which is the multiclass passive-aggressive algorithm.
///
/// ```
/// use rollin::learner::CrammerSinger;
/// use rollin::space::{Imitation, doc::{Follow, RealWorld}};
/// use rollin::trainer::{Run, Supervised};
///
/// let problem = Imitation { space: RealWorld, expert: Follow, episodes: 20 };
/// let trained = Supervised::default().train(&problem, &CrammerSinger::default(), &Run::new(1))?;
/// assert_eq!(trained.ledger.examples, 200);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CrammerSinger {
    /// C: what a margin error costs.
    pub cost: f32,
    /// Passes over the examples at most.
    pub passes: usize,
    /// Descent stops where no example violates the conditions of the optimum by more than this.
    pub tolerance: f32,
}

impl Default for CrammerSinger {
    fn default() -> Self {
        CrammerSinger { cost: 0.1, passes: 50, tolerance: 0.1 }
    }
}

/// The variables of one example: what is known and what is sought.
#[derive(Clone, Debug, Default)]
struct Subproblem {
    /// For each legal action: its gradient, first with, then without what its own variable adds.
    gradients: Vec<f32>,
    sorted: Vec<f32>,
    costs: Vec<f32>,
    /// The variables of an example that comes up but once.
    passing: Vec<f32>,
}

impl Subproblem {
    /// [`Subproblem::solve`] for an example whose variables are all 0 before and of no interest after. Returns whether anything changed.
    fn solve_once(&mut self, lesson: Lesson<'_>, size: (f32, f32), scores: &[f32], change: &mut [f32]) -> bool {
        let mut alphas = std::mem::take(&mut self.passing);
        alphas.clear();
        alphas.resize(lesson.actions, 0.0);
        let violation = self.solve(lesson, size, scores, &mut alphas, change);
        self.passing = alphas;
        violation > 0.0
    }

    /// Solves for the variables `alphas` of an example with `norm` features, of which that of the cheapest action is at most `most`, the others 0,
    /// all of them 0 in sum. Writes how much each changed into `change` and returns how much the conditions were violated.
    fn solve(
        &mut self,
        lesson: Lesson<'_>,
        (norm, most): (f32, f32),
        scores: &[f32],
        alphas: &mut [f32],
        change: &mut [f32],
    ) -> f32 {
        reduce::as_costs(lesson.target, lesson.legal, &mut self.costs);
        let (best, _) = reduce::as_label(lesson.target, lesson.legal);
        let bound = |action: Action| if action == best { most } else { 0.0 };
        self.gradients.clear();
        self.gradients.extend(lesson.legal.iter().zip(&self.costs).map(|(a, cost)| scores[a.index()] + cost));
        let high = self.gradients.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let free = lesson.legal.iter().zip(&self.gradients).filter(|(a, _)| alphas[a.index()] < bound(*a));
        let low = free.map(|(_, gradient)| *gradient).fold(f32::INFINITY, f32::min);
        let violation = high - low;
        if violation.is_nan() || violation <= 1e-6 || norm == 0.0 {
            return 0.0;
        }
        for (action, gradient) in lesson.legal.iter().zip(&mut self.gradients) {
            *gradient -= norm * alphas[action.index()];
        }
        let level = self.level(norm * most, lesson.legal.place(best).unwrap_or(0));
        for (action, gradient) in lesson.legal.iter().zip(&self.gradients) {
            let alpha = ((level - gradient) / norm).min(bound(action));
            change[action.index()] = alpha - alphas[action.index()];
            alphas[action.index()] = alpha;
        }
        violation
    }

    /// The level beta at which min(bound, (beta - gradient) / norm) are 0 in sum, where the bound of the action at `place` is `room` / norm and all
    /// others' 0: the largest of the sorted numbers are taken in as long as they stand above it.
    fn level(&mut self, room: f32, place: usize) -> f32 {
        self.sorted.clone_from(&self.gradients);
        self.sorted[place] += room;
        self.sorted.sort_unstable_by(|a, b| b.total_cmp(a));
        let mut sum = -room;
        for (taken, value) in self.sorted.iter().enumerate() {
            if taken > 0 && sum >= taken as f32 * value {
                return sum / taken as f32;
            }
            sum += value;
        }
        sum / self.sorted.len() as f32
    }
}

impl Learner<Features> for CrammerSinger {
    type Classifier = Linear;

    fn fit(
        &self,
        setting: Setting<'_, Features>,
        examples: &Examples<Features>,
        _: Option<&Linear>,
        seed: Seed,
    ) -> Linear {
        let k = setting.actions;
        let batch = Batch::of(setting, examples);
        let mut steps = Steps::begin(Columns::Actions, setting, None);
        let (mut alphas, mut problem) = (vec![0.0f32; batch.len() * k], Subproblem::default());
        let mut order: Vec<u32> = (0..batch.len() as u32).collect();
        let mut rng = seed.rng();
        for _ in 0..self.passes {
            order.shuffle(&mut rng);
            let mut worst = 0.0f32;
            for &n in &order {
                let (i, count) = batch.example(n as usize);
                let features = batch.features(n as usize);
                let lesson = Lesson { actions: k, legal: examples.legal(i), target: examples.target(i) };
                let alphas = &mut alphas[n as usize * k..][..k];
                steps.score(features);
                steps.change(features, lesson, |lesson, norm, scores, change| {
                    let violation = problem.solve(lesson, (norm, self.cost * count), scores, alphas, change);
                    worst = worst.max(violation);
                    violation > 0.0
                });
            }
            if worst <= self.tolerance {
                break;
            }
        }
        steps.finish()
    }
}

/// A [`CrammerSinger`] in the middle of learning.
#[derive(Clone, Debug)]
pub struct CrammerCourse {
    steps: Steps,
    problem: Subproblem,
}

impl Kept<Features> for CrammerCourse {
    fn put(&self, to: &mut Vec<u8>) {
        self.steps.put(to);
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, Features>) -> Option<Self> {
        Some(CrammerCourse { steps: Steps::take(from, setting)?, problem: Subproblem::default() })
    }

    fn follows(&self, start: &Self) -> bool {
        self.steps.follows(&start.steps)
    }
}

/// The weights as they are now.
impl Classifier<Features> for CrammerCourse {
    type Memory = LinearMemory;

    fn scores<'m>(&self, sight: &Sight<'_, Features>, memory: &'m mut LinearMemory) -> &'m [f32] {
        self.steps.scores(sight, memory)
    }
}

impl Online<Features> for CrammerSinger {
    type Course = CrammerCourse;

    fn begin(&self, setting: Setting<'_, Features>, warm: Option<&Linear>) -> CrammerCourse {
        CrammerCourse { steps: Steps::begin(Columns::Actions, setting, warm), problem: Subproblem::default() }
    }

    fn learn(&self, course: &mut CrammerCourse, sight: &Sight<'_, Features>, target: Option<Target<'_>>) -> Action {
        let CrammerCourse { steps, problem } = course;
        steps.meet(sight, target, |lesson, norm, scores, change| {
            problem.solve_once(lesson, (norm, self.cost), scores, change)
        })
    }

    fn study(&self, course: &mut CrammerCourse, setting: Setting<'_, Features>, examples: &Examples<Features>) {
        let CrammerCourse { steps, problem } = course;
        steps.study(setting, examples, |lesson, norm, scores, change| {
            problem.solve_once(lesson, (norm, self.cost), scores, change)
        });
    }

    fn finish(&self, course: CrammerCourse) -> Linear {
        course.steps.finish()
    }
}
