//! Cost-sensitive one-against-all.

use super::Target;
use super::linear::{Descent, Lesson, Rule};
use crate::policy::Columns;
use serde::{Deserialize, Serialize};

/// Cost-sensitive one-against-all (CSOAA): one linear regression per action predicts its cost above the cheapest, and the action
/// with the lowest prediction is taken. A cost-sensitive learner; squared loss, AdaGrad, averaged weights.
///
/// Scores are predicted costs with the sign turned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Csoaa {
    /// Passes over the examples.
    pub passes: usize,
    /// AdaGrad's rate.
    pub rate: f32,
    /// The weight of half the squared norm, per example.
    pub l2: f32,
}

impl Default for Csoaa {
    fn default() -> Self {
        Csoaa { passes: 5, rate: 0.1, l2: 0.0 }
    }
}

impl Rule for Csoaa {
    fn columns(&self) -> Columns {
        Columns::Actions
    }

    fn descent(&self) -> Descent {
        Descent::Adaptive { rate: self.rate, l2: self.l2 }
    }

    fn passes(&self) -> usize {
        self.passes
    }

    #[inline]
    fn gradient(&self, example: Lesson<'_>, scores: &[f32], gradient: &mut [f32]) -> bool {
        // d/ds of (s + c)^2 / 2, with costs counted from the cheapest.
        match example.target {
            Target::Label(label) => {
                for action in example.legal.iter() {
                    gradient[action.index()] = scores[action.index()] + if action == label { 0.0 } else { 1.0 };
                }
            }
            Target::Costs(costs) => {
                let least = costs.iter().copied().fold(f32::INFINITY, f32::min);
                for (action, cost) in example.legal.iter().zip(costs) {
                    gradient[action.index()] = scores[action.index()] + (cost - least);
                }
            }
        }
        true
    }
}
