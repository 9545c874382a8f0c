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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learner::Target;
    use crate::space::{Action, Actions};

    /// The gradient in the bits against differences of the logistic loss over the legal actions.
    #[test]
    fn the_gradient_of_bits_is_that_of_the_loss() {
        let logistic = Logistic { outputs: Outputs::Bits, tolerance: 0.0, ..Logistic::default() };
        let some = [Action(1), Action(2), Action(6)];
        for legal in [Actions::All(7), Actions::Only(&some)] {
            let lesson = Lesson { actions: 7, legal, target: Target::Label(Action(6)) };
            let columns = [0.5f32, -1.0, 0.25];
            let loss = |columns: &[f32]| {
                let score =
                    |a: u32| (0..3).filter(|bit| a >> bit & 1 == 1).map(|bit| f64::from(columns[bit])).sum::<f64>();
                legal.iter().map(|a| score(a.0).exp()).sum::<f64>().ln() - score(6)
            };
            let mut gradient = [0.0; 3];
            assert!(logistic.gradient(lesson, &columns, &mut gradient));
            for bit in 0..3 {
                let [up, down] = [1e-2, -1e-2].map(|by| {
                    let mut moved = columns;
                    moved[bit] += by;
                    loss(&moved)
                });
                let expected = (up - down) / 2e-2;
                assert!((f64::from(gradient[bit]) - expected).abs() < 1e-4, "{bit}: {} for {expected}", gradient[bit]);
            }
        }
    }
}
