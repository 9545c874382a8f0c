//! Learners by name.

use super::AnyClassifier;
use super::classifiers::put_kind;
use crate::learner::{
    Course, CrammerCourse, CrammerSinger, Csoaa, Examples, FilterTree, Hinge, Kept, Learner, Logistic, Net, NetCourse,
    Online, Perceptron, Setting, Svm, SvmCourse, Target, Wap,
};
use crate::output::Arrays;
use crate::policy::{Classifier, Linear, Neural, NeuralMemory};
use crate::seed::Seed;
use crate::space::{Action, Features, Front, Sight};
use serde::{Deserialize, Serialize};

/// A learner with its settings. It is a learner itself, so that whatever is generic over learners is compiled once for all of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AnyLearner {
    /// [`Perceptron`].
    Perceptron(Perceptron),
    /// [`Logistic`].
    Logistic(Logistic),
    /// [`Hinge`].
    Hinge(Hinge),
    /// [`Csoaa`].
    Csoaa(Csoaa),
    /// [`Wap`].
    Wap(Wap),
    /// [`FilterTree`].
    FilterTree(FilterTree),
    /// [`Svm`].
    Svm(Svm),
    /// [`CrammerSinger`].
    CrammerSinger(CrammerSinger),
    /// [`Net`].
    Net(Net),
}

/// [`Logistic`].
impl Default for AnyLearner {
    fn default() -> Self {
        AnyLearner::Logistic(Logistic::default())
    }
}

/// An [`AnyLearner`] in the middle of learning. It goes on with a learner of the kind that began it: one of another kind panics, as that is
/// a mistake in a program and never one in its input.
pub enum AnyCourse {
    /// That of a learner by gradients.
    Linear(Course),
    /// That of an [`Svm`].
    Svm(SvmCourse),
    /// That of a [`CrammerSinger`].
    Crammer(CrammerCourse),
    /// That of a [`Net`].
    Net(NetCourse),
}

/// Does the same with the learner in `$any`, whichever it is.
macro_rules! with_learner {
    ($any:expr, $learner:ident => $body:expr) => {
        match $any {
            AnyLearner::Perceptron($learner) => $body,
            AnyLearner::Logistic($learner) => $body,
            AnyLearner::Hinge($learner) => $body,
            AnyLearner::Csoaa($learner) => $body,
            AnyLearner::Wap($learner) => $body,
            AnyLearner::FilterTree($learner) => $body,
            AnyLearner::Svm($learner) => $body,
            AnyLearner::CrammerSinger($learner) => $body,
            AnyLearner::Net($learner) => $body,
        }
    };
}

/// A course, as the learner that began it knows it.
trait Begun: Sized {
    fn wrap(self) -> AnyCourse;
    fn of(course: &mut AnyCourse) -> &mut Self;
    fn unwrap(course: AnyCourse) -> Self;
}

macro_rules! begun {
    ($course:ty, $variant:ident) => {
        impl Begun for $course {
            fn wrap(self) -> AnyCourse {
                AnyCourse::$variant(self)
            }
            fn of(course: &mut AnyCourse) -> &mut Self {
                match course {
                    AnyCourse::$variant(course) => course,
                    _ => unreachable!("a course goes on with the learner that began it"),
                }
            }
            fn unwrap(course: AnyCourse) -> Self {
                match course {
                    AnyCourse::$variant(course) => course,
                    _ => unreachable!("a course is finished by the learner that began it"),
                }
            }
        }
    };
}
begun!(Course, Linear);
begun!(SvmCourse, Svm);
begun!(CrammerCourse, Crammer);
begun!(NetCourse, Net);

/// A classifier, as the learners that make its kind know it; one of another kind is nothing to start from.
trait Made: Into<AnyClassifier> {
    fn of(classifier: &AnyClassifier) -> Option<&Self>;
}

macro_rules! made {
    ($classifier:ty, $variant:ident) => {
        impl Made for $classifier {
            fn of(classifier: &AnyClassifier) -> Option<&Self> {
                match classifier {
                    AnyClassifier::$variant(classifier) => Some(classifier),
                    _ => None,
                }
            }
        }
    };
}
made!(Linear, Linear);
made!(Neural, Net);

impl Classifier<Features> for AnyCourse {
    type Memory = NeuralMemory;

    #[inline]
    fn scores<'m>(&self, sight: &Sight<'_, Features>, memory: &'m mut NeuralMemory) -> &'m [f32] {
        match self {
            AnyCourse::Linear(course) => course.scores(sight, &mut memory.input),
            AnyCourse::Svm(course) => course.scores(sight, &mut memory.input),
            AnyCourse::Crammer(course) => course.scores(sight, &mut memory.input),
            AnyCourse::Net(course) => course.scores(sight, memory),
        }
    }

    #[inline]
    fn choose(&self, sight: &Sight<'_, Features>, memory: &mut NeuralMemory) -> Action {
        match self {
            AnyCourse::Linear(course) => course.choose(sight, &mut memory.input),
            AnyCourse::Svm(course) => course.choose(sight, &mut memory.input),
            AnyCourse::Crammer(course) => course.choose(sight, &mut memory.input),
            AnyCourse::Net(course) => course.choose(sight, memory),
        }
    }

    #[inline]
    fn choose_at_once(&self, sight: &Sight<'_, Features>, memory: &mut NeuralMemory) -> Option<Action> {
        match self {
            AnyCourse::Linear(course) => course.choose_at_once(sight, &mut memory.input),
            AnyCourse::Svm(_) | AnyCourse::Crammer(_) | AnyCourse::Net(_) => None,
        }
    }

    #[inline]
    fn choose_all_at_once(
        &self,
        front: &Front<'_, Features>,
        memory: &mut NeuralMemory,
        actions: &mut [Option<Action>],
    ) {
        if let AnyCourse::Linear(course) = self {
            course.choose_all_at_once(front, &mut memory.input, actions);
        }
    }
}

impl Kept<Features> for AnyCourse {
    fn put(&self, to: &mut Vec<u8>) {
        match self {
            AnyCourse::Linear(course) => put_kind(0, course, to),
            AnyCourse::Svm(course) => put_kind(1, course, to),
            AnyCourse::Crammer(course) => put_kind(2, course, to),
            AnyCourse::Net(course) => put_kind(3, course, to),
        }
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, Features>) -> Option<Self> {
        Some(match u8::take(from, setting)? {
            0 => AnyCourse::Linear(Kept::take(from, setting)?),
            1 => AnyCourse::Svm(Kept::take(from, setting)?),
            2 => AnyCourse::Crammer(Kept::take(from, setting)?),
            3 => AnyCourse::Net(Kept::take(from, setting)?),
            _ => return None,
        })
    }

    fn follows(&self, start: &Self) -> bool {
        match (self, start) {
            (AnyCourse::Linear(course), AnyCourse::Linear(start)) => course.follows(start),
            (AnyCourse::Svm(course), AnyCourse::Svm(start)) => course.follows(start),
            (AnyCourse::Crammer(course), AnyCourse::Crammer(start)) => course.follows(start),
            (AnyCourse::Net(course), AnyCourse::Net(start)) => course.follows(start),
            _ => false,
        }
    }
}

impl Learner<Features> for AnyLearner {
    type Classifier = AnyClassifier;

    fn fit(
        &self,
        setting: Setting<'_, Features>,
        examples: &Examples<Features>,
        warm: Option<&AnyClassifier>,
        seed: Seed,
    ) -> AnyClassifier {
        with_learner!(self, learner => learner.fit(setting, examples, warm.and_then(Made::of), seed).into())
    }
}

impl Online<Features> for AnyLearner {
    type Course = AnyCourse;

    fn begin(&self, setting: Setting<'_, Features>, warm: Option<&AnyClassifier>) -> AnyCourse {
        with_learner!(self, learner => learner.begin(setting, warm.and_then(Made::of)).wrap())
    }

    #[inline]
    fn learn(&self, course: &mut AnyCourse, sight: &Sight<'_, Features>, target: Option<Target<'_>>) -> Action {
        with_learner!(self, learner => learner.learn(Begun::of(course), sight, target))
    }

    fn study(&self, course: &mut AnyCourse, setting: Setting<'_, Features>, examples: &Examples<Features>) {
        with_learner!(self, learner => learner.study(Begun::of(course), setting, examples));
    }

    fn seed(&self, course: &mut AnyCourse, seed: Seed) {
        with_learner!(self, learner => Online::<Features>::seed(learner, Begun::of(course), seed));
    }

    fn finish(&self, course: AnyCourse) -> AnyClassifier {
        with_learner!(self, learner => learner.finish(Begun::unwrap(course)).into())
    }
}
