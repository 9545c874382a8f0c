//! Learners: from examples to classifiers.
//!
//! Two kinds: 0-1 learners ([`Perceptron`], [`Logistic`], [`Net`], and [`Ridge`] for actions that are values) learn labels, cost-sensitive
//! ones ([`Hinge`], [`Csoaa`], [`Wap`], [`FilterTree`], [`Svm`], [`CrammerSinger`], [`CostTree`]) costs. The two reductions of [`reduce`] let each learn from the
//! other's examples, so every trainer runs with every learner; those that learn example by example ([`Online`]) also while acting.
//! [`CrossValidated`] finds how often to go over the examples; [`calibrate`] makes probabilities of a classifier's scores.
//!
//! # Writing one
//! A learner that is a loss on linear scores is a [`Rule`]: one file with the loss's gradient, and the rest (passes, warm starts,
//! averaging, learning while acting) comes with it. Anything else implements [`Learner`] itself.
//! Where its classifier, or its course if it is online, is [`Kept`], training with it can go on after it was killed
//! ([`Checkpoint`](crate::trainer::Checkpoint)); where it is not, training with a checkpoint does not compile, and all else does.

mod calibrate;
mod costtree;
mod crammer;
mod crossvalidated;
mod csoaa;
mod dual;
mod examples;
mod hinge;
mod inlet;
mod kept;
mod linear;
mod logistic;
mod net;
mod perceptron;
pub mod reduce;
mod ridge;
mod svm;
mod tabular;
mod tree;
mod wap;

pub use crate::output::Arrays;
pub use calibrate::{Reliability, calibrate, calibration_error};
pub use costtree::CostTree;
pub(crate) use crammer::CrammerCourse;
pub use crammer::CrammerSinger;
pub use crossvalidated::CrossValidated;
pub use csoaa::Csoaa;
pub use dual::Steps;
pub use examples::{Examples, Target};
pub use hinge::Hinge;
pub use inlet::{Full, Inlet, Sensed, Sparse};
pub use kept::Kept;
pub(crate) use kept::MOST_COUNTED;
pub use linear::{Course, Descent, Lesson, Rule};
pub use logistic::Logistic;
pub(crate) use net::NetCourse;
pub use net::{Net, Step};
pub use perceptron::Perceptron;
pub use ridge::Ridge;
pub use svm::Svm;
pub(crate) use svm::SvmCourse;
pub use tabular::Tabular;
pub use tree::FilterTree;
pub use wap::Wap;

use crate::policy::Classifier;
use crate::seed::Seed;
use crate::space::{Action, Problem, Sight, Space, Store, View};

/// What a learner must know of a space.
pub struct Setting<'a, V: View> {
    /// What all views share.
    pub shared: &'a V::Shared,
    /// How many actions there are.
    pub actions: usize,
}

impl<V: View> Clone for Setting<'_, V> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<V: View> Copy for Setting<'_, V> {}

impl<'a, V: View> Setting<'a, V> {
    /// The setting of `problem`.
    pub fn of<P: Problem>(problem: &'a P) -> Self
    where
        P::Space: Space<View = V>,
    {
        Setting { shared: problem.space().shared(), actions: problem.space().actions() }
    }
}

/// Turns examples into a classifier.
pub trait Learner<V: View>: Sync {
    /// What it turns them into.
    type Classifier: Classifier<V>;

    /// Learns from `examples`, starting from `warm` where it is given. Same seed, same bits.
    fn fit(
        &self,
        setting: Setting<'_, V>,
        examples: &Examples<V>,
        warm: Option<&Self::Classifier>,
        seed: Seed,
    ) -> Self::Classifier;
}

/// A learner that learns example by example and can act in between.
pub trait Online<V: View>: Learner<V> {
    /// Learning in progress, which acts as far as it has learned.
    type Course: Classifier<V>;

    /// Begins, from `warm` where it is given.
    fn begin(&self, setting: Setting<'_, V>, warm: Option<&Self::Classifier>) -> Self::Course;

    /// Says what it would do at `sight` as far as it has learned, and then learns from `target`, if there is any.
    fn learn(&self, course: &mut Self::Course, sight: &Sight<'_, V>, target: Option<Target<'_>>) -> Action;

    /// Learns from all of `examples` once, in their order.
    fn study(&self, course: &mut Self::Course, setting: Setting<'_, V>, examples: &Examples<V>);

    /// Learns from the examples numbered in `order`, one after the other.
    fn study_some(&self, course: &mut Self::Course, setting: Setting<'_, V>, examples: &Examples<V>, order: &[u32]) {
        let mut view = V::default();
        for &i in order {
            let i = i as usize;
            examples.views().recall(i, &mut view);
            let sight = Sight { shared: setting.shared, view: &view, legal: examples.legal(i) };
            self.learn(course, &sight, Some(examples.target(i)));
        }
    }

    /// Gives a course that has just begun a `seed` of its own, where it draws anything.
    fn seed(&self, course: &mut Self::Course, seed: Seed) {
        let _ = (course, seed);
    }

    /// What has been learned.
    fn finish(&self, course: Self::Course) -> Self::Classifier;
}
