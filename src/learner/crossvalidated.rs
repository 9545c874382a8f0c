//! Early stopping by cross-validation.

use super::{Examples, Learner, Online, Setting, reduce};
use crate::policy::Classifier;
use crate::seed::{Purpose, Seed};
use crate::space::{Sight, Store, View};
use rand::seq::SliceRandom;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// A learner that goes over the examples as often as was best for examples held out ("ten-fold cross-validation to avoid overfitting", Ross & Bagnell
/// 2010, section 5, footnote 3), then learns from all of them with that many passes.
///
/// The examples are cut into [`folds`](Self::folds) blocks in their order, because neighbours are of one episode and nearly the same. For each
/// block one course learns from all others, all courses pass by pass at the same time, and after each pass the mean logistic loss of all blocks is
/// measured, each by the course that has not seen it. The passes end when the loss has not fallen for [`patience`](Self::patience) of
/// them, or after [`most`](Self::most); the first of equals is taken. The folds run on all threads of the current rayon pool. A learner that averages its
/// weights is measured by those it has at the time.
///
/// ```
/// use rollin::learner::{CrossValidated, Net};
/// use rollin::space::{Imitation, doc::{Follow, RealWorld}};
/// use rollin::trainer::{Run, Supervised};
///
/// let problem = Imitation { space: RealWorld, expert: Follow, episodes: 20 };
/// let learner = CrossValidated { learner: Net { units: 8, ..Net::default() }, ..CrossValidated::default() };
/// let trained = Supervised::default().train(&problem, &learner, &Run::new(1))?;
/// assert_eq!(trained.policy.0.units(), 8);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CrossValidated<L> {
    /// The learner; its own number of passes is not used.
    pub learner: L,
    /// Blocks; with fewer than 2, or fewer examples than blocks, nothing is held out and [`most`](Self::most) passes are made.
    pub folds: usize,
    /// Passes at most.
    pub most: usize,
    /// Passes without a better loss after which to stop.
    pub patience: usize,
}

impl<L: Default> Default for CrossValidated<L> {
    fn default() -> Self {
        CrossValidated { learner: L::default(), folds: 10, most: 40, patience: 2 }
    }
}

/// One block held out.
struct Fold<C> {
    course: C,
    /// The examples of all other blocks.
    rest: Vec<u32>,
    /// Those of this one.
    held: Vec<u32>,
}

impl<L> CrossValidated<L> {
    /// The number of passes that is best for what is held out.
    fn passes<V: View>(
        &self,
        setting: Setting<'_, V>,
        examples: &Examples<V>,
        warm: Option<&L::Classifier>,
        seed: Seed,
    ) -> usize
    where
        L: Online<V>,
    {
        let (count, folds) = (examples.len(), self.folds);
        if folds < 2 || count < folds {
            return self.most;
        }
        let fold = |k: usize| {
            let (from, to) = ((k * count / folds) as u32, ((k + 1) * count / folds) as u32);
            let mut course = self.learner.begin(setting, warm);
            self.learner.seed(&mut course, seed);
            Fold { course, rest: (0..from).chain(to..count as u32).collect(), held: (from..to).collect() }
        };
        let mut folds: Vec<Fold<L::Course>> = (0..folds).map(fold).collect();
        let (mut best, mut least) = (0, f64::INFINITY);
        for pass in 1..=self.most {
            let one = |(k, fold): (usize, &mut Fold<L::Course>)| {
                fold.rest
                    .shuffle(&mut seed.child(Purpose::Episode, k as u64).child(Purpose::Learner, pass as u64).rng());
                self.learner.study_some(&mut fold.course, setting, examples, &fold.rest);
                loss(&fold.course, setting, examples, &fold.held)
            };
            // Gathered in the order of the folds, so that the sum is the same at any number of threads.
            let losses: Vec<f64> = folds.par_iter_mut().enumerate().map(one).collect();
            let total: f64 = losses.iter().sum();
            if total < least {
                (best, least) = (pass, total);
            } else if pass >= best + self.patience {
                break;
            }
        }
        best
    }
}

/// The sum of the logistic losses of these examples, weighted by their importance.
fn loss<V: View, C: Classifier<V>>(
    classifier: &C,
    setting: Setting<'_, V>,
    examples: &Examples<V>,
    which: &[u32],
) -> f64 {
    let (mut view, mut memory) = (V::default(), C::Memory::default());
    let one = |i: &u32| {
        let i = *i as usize;
        let (label, importance) = reduce::as_label(examples.target(i), examples.legal(i));
        examples.views().recall(i, &mut view);
        let sight = Sight { shared: setting.shared, view: &view, legal: examples.legal(i) };
        let scores = classifier.scores(&sight, &mut memory);
        let own = f64::from(scores[label.index()]);
        let high = sight.legal.iter().map(|a| f64::from(scores[a.index()])).fold(own, f64::max);
        let total: f64 = sight.legal.iter().map(|a| (f64::from(scores[a.index()]) - high).exp()).sum();
        f64::from(importance) * (total.ln() + high - own)
    };
    which.iter().map(one).sum()
}

impl<V: View, L: Online<V>> Learner<V> for CrossValidated<L> {
    type Classifier = L::Classifier;

    fn fit(
        &self,
        setting: Setting<'_, V>,
        examples: &Examples<V>,
        warm: Option<&Self::Classifier>,
        seed: Seed,
    ) -> Self::Classifier {
        let passes = self.passes(setting, examples, warm, seed);
        let mut course = self.learner.begin(setting, warm);
        self.learner.seed(&mut course, seed);
        let mut order: Vec<u32> = (0..examples.len() as u32).collect();
        for pass in 0..passes {
            order.shuffle(&mut seed.child(Purpose::Learner, pass as u64).rng());
            self.learner.study_some(&mut course, setting, examples, &order);
        }
        self.learner.finish(course)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learner::{Net, Target};
    use crate::space::{Action, Actions, Dense, Width};

    /// `count` examples of eight random numbers; the label is whether the first is above a half, or noise.
    fn examples(count: u64, noise: bool) -> Examples<Dense> {
        let mut examples = Examples::default();
        for i in 0..count {
            let draw = |j: u64| Seed::new(i).child(Purpose::Step, j).unit() as f32;
            let view = Dense((0..8).map(draw).collect());
            let label = if noise { draw(9) > 0.5 } else { draw(0) > 0.5 };
            examples.push(&view, Actions::All(2), Target::Label(Action(u32::from(label))));
        }
        examples
    }

    #[test]
    fn passes_end_where_nothing_more_is_to_be_learned() {
        let setting = Setting::<Dense> { shared: &Width(8), actions: 2 };
        let learner =
            CrossValidated { learner: Net { units: 16, rate: 0.02, ..Net::default() }, ..CrossValidated::default() };
        let passes = |noise| learner.passes(setting, &examples(300, noise), None, Seed::new(1));
        let (rule, noise) = (passes(false), passes(true));
        assert!(rule > 2 * noise, "{rule} passes for a rule, {noise} for noise");
        let none = CrossValidated { folds: 0, most: 3, ..learner.clone() };
        assert_eq!(none.passes(setting, &examples(300, true), None, Seed::new(1)), 3);
    }

    #[test]
    fn threads_do_not_matter() {
        let setting = Setting::<Dense> { shared: &Width(8), actions: 2 };
        let learner = CrossValidated { learner: Net { units: 4, ..Net::default() }, ..CrossValidated::default() };
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| learner.fit(setting, &examples(100, false), None, Seed::new(3)))
        };
        assert!(on(1) == on(3));
    }
}
