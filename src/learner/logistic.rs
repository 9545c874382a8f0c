//! Multinomial logistic regression.

use super::linear::{Descent, Lesson, Rule};
use super::reduce;
use crate::policy::{Columns, Outputs};
use serde::{Deserialize, Serialize};

/// Multinomial logistic regression over the legal actions, by AdaGrad with an L2 penalty and averaged weights: a 0-1 learner.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Logistic {
    /// What the columns are: one per action, or one per bit of its number, where every bit is a logistic regression of its own if all numbers
    /// are legal.
    pub outputs: Outputs,
    /// Passes over the examples.
    pub passes: usize,
    /// AdaGrad's rate.
    pub rate: f32,
    /// The weight of half the squared norm, per example.
    pub l2: f32,
    /// The probability of a mistake below which an example changes nothing, in [0, 1). What is almost certain already has next to no
    /// gradient, but most examples are of that kind: leaving them out makes a pass several times as fast.
    pub tolerance: f32,
}

impl Default for Logistic {
    fn default() -> Self {
        Logistic { outputs: Outputs::Actions, passes: 5, rate: 0.1, l2: 0.0, tolerance: 0.01 }
    }
}

impl Rule for Logistic {
    fn columns(&self) -> Columns {
        match self.outputs {
            Outputs::Actions => Columns::Actions,
            Outputs::Bits => Columns::Bits,
        }
    }

    fn descent(&self) -> Descent {
        Descent::Adaptive { rate: self.rate, l2: self.l2 }
    }

    fn passes(&self) -> usize {
        self.passes
    }

    #[inline]
    fn gradient(&self, example: Lesson<'_>, scores: &[f32], gradient: &mut [f32]) -> bool {
        let (label, importance) = reduce::as_label(example.target, example.legal);
        if importance == 0.0 {
            return false;
        }
        if self.outputs == Outputs::Bits {
            return self.by_bits(example, (label.index(), importance), scores, gradient);
        }
        let high = scores[example.legal.best(scores).index()];
        let mut total = 0.0;
        for action in example.legal.iter() {
            let share = (scores[action.index()] - high).exp();
            gradient[action.index()] = share;
            total += share;
        }
        if 1.0 - gradient[label.index()] / total < self.tolerance {
            return false;
        }
        for action in example.legal.iter() {
            gradient[action.index()] *= importance / total;
        }
        gradient[label.index()] -= importance;
        true
    }
}

impl Logistic {
    /// [`Rule::gradient`] where the columns are bits.
    fn by_bits(
        &self,
        example: Lesson<'_>,
        (label, importance): (usize, f32),
        scores: &[f32],
        gradient: &mut [f32],
    ) -> bool {
        let score =
            |a: usize| scores.iter().enumerate().filter(|(bit, _)| a >> bit & 1 == 1).map(|(_, s)| s).sum::<f32>();
        let all = || example.legal.iter().map(|action| action.index());
        let high = all().map(score).fold(f32::NEG_INFINITY, f32::max);
        let total: f32 = all().map(|a| (score(a) - high).exp()).sum();
        if 1.0 - (score(label) - high).exp() / total < self.tolerance {
            return false;
        }
        all().for_each(|a| self.outputs.add_slope(a, importance * (score(a) - high).exp() / total, gradient));
        self.outputs.add_slope(label, -importance, gradient);
        true
    }
}
