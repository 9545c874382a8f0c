//! The classifiers that the learners of the program make.

use crate::learner::{Kept, Setting};
use crate::output::Arrays;
use crate::policy::{Classifier, Columns, Linear, Neural, NeuralMemory, Weights};
use crate::space::{Action, Features, Front, Sight};

/// A classifier of one of the kinds that [`AnyLearner`](super::AnyLearner) makes and model files keep.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyClassifier {
    /// A linear one.
    Linear(Linear),
    /// A net of one hidden layer.
    Net(Neural),
}

impl From<Linear> for AnyClassifier {
    fn from(linear: Linear) -> Self {
        AnyClassifier::Linear(linear)
    }
}

impl From<Neural> for AnyClassifier {
    fn from(net: Neural) -> Self {
        AnyClassifier::Net(net)
    }
}

impl AnyClassifier {
    /// The weights of the features: those of a net are its input layer's, a column a unit.
    pub fn weights(&self) -> &Weights {
        match self {
            AnyClassifier::Linear(linear) => &linear.weights,
            AnyClassifier::Net(net) => &net.input.weights,
        }
    }

    /// The same with other weights of the features.
    pub fn map_weights(self, change: impl FnOnce(Weights) -> Weights) -> Self {
        let changed = |linear: Linear| Linear { weights: change(linear.weights), ..linear };
        match self {
            AnyClassifier::Linear(linear) => AnyClassifier::Linear(changed(linear)),
            AnyClassifier::Net(net) => AnyClassifier::Net(Neural { input: changed(net.input), ..net }),
        }
    }

    /// What the columns of a linear one are; a net scores actions.
    pub fn columns(&self) -> Columns {
        match self {
            AnyClassifier::Linear(linear) => linear.columns,
            AnyClassifier::Net(_) => Columns::Actions,
        }
    }

    /// The one linear classifier that scores as the mean of these, where there is one: see [`Linear::mean`].
    pub fn mean(members: &[(f64, AnyClassifier)]) -> Option<AnyClassifier> {
        let linear = members.iter().map(|(weight, member)| match member {
            AnyClassifier::Linear(linear) => Some((*weight, linear)),
            AnyClassifier::Net(_) => None,
        });
        let members: Vec<(f64, &Linear)> = linear.collect::<Option<_>>()?;
        Linear::mean(&members).map(AnyClassifier::Linear)
    }
}

impl Classifier<Features> for AnyClassifier {
    /// A linear classifier keeps its own as that of an input layer.
    type Memory = NeuralMemory;

    #[inline]
    fn scores<'m>(&self, sight: &Sight<'_, Features>, memory: &'m mut NeuralMemory) -> &'m [f32] {
        match self {
            AnyClassifier::Linear(linear) => linear.scores(sight, &mut memory.input),
            AnyClassifier::Net(net) => net.scores(sight, memory),
        }
    }

    #[inline]
    fn choose(&self, sight: &Sight<'_, Features>, memory: &mut NeuralMemory) -> Action {
        match self {
            AnyClassifier::Linear(linear) => linear.choose(sight, &mut memory.input),
            AnyClassifier::Net(net) => net.choose(sight, memory),
        }
    }

    #[inline]
    fn choose_at_once(&self, sight: &Sight<'_, Features>, memory: &mut NeuralMemory) -> Option<Action> {
        match self {
            AnyClassifier::Linear(linear) => linear.choose_at_once(sight, &mut memory.input),
            AnyClassifier::Net(_) => None,
        }
    }

    #[inline]
    fn choose_all_at_once(
        &self,
        front: &Front<'_, Features>,
        memory: &mut NeuralMemory,
        actions: &mut [Option<Action>],
    ) {
        if let AnyClassifier::Linear(linear) = self {
            linear.choose_all_at_once(front, &mut memory.input, actions);
        }
    }
}

/// Appends which kind of several `value` is, then what it is.
pub(super) fn put_kind(kind: u8, value: &impl Kept<Features>, to: &mut Vec<u8>) {
    to.push(kind);
    value.put(to);
}

impl Kept<Features> for AnyClassifier {
    fn put(&self, to: &mut Vec<u8>) {
        match self {
            AnyClassifier::Linear(linear) => put_kind(0, linear, to),
            AnyClassifier::Net(net) => put_kind(1, net, to),
        }
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, Features>) -> Option<Self> {
        Some(match u8::take(from, setting)? {
            0 => AnyClassifier::Linear(Kept::take(from, setting)?),
            1 => AnyClassifier::Net(Kept::take(from, setting)?),
            _ => return None,
        })
    }
}
