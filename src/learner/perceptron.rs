//! The averaged perceptron.

use super::linear::{Descent, Lesson, Rule};
use super::reduce;
use crate::policy::Columns;
use serde::{Deserialize, Serialize};

/// The multiclass averaged perceptron (Collins 2002; Freund & Schapire 1999): a 0-1 learner. A mistake moves the
/// weights by the example's importance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Perceptron {
    /// Passes over the examples.
    pub passes: usize,
}

impl Default for Perceptron {
    fn default() -> Self {
        Perceptron { passes: 5 }
    }
}

impl Rule for Perceptron {
    fn columns(&self) -> Columns {
        Columns::Actions
    }

    fn descent(&self) -> Descent {
        Descent::Plain
    }

    fn passes(&self) -> usize {
        self.passes
    }

    #[inline]
    fn gradient(&self, example: Lesson<'_>, scores: &[f32], gradient: &mut [f32]) -> bool {
        let (label, importance) = reduce::as_label(example.target, example.legal);
        let choice = example.legal.best(scores);
        if choice == label || importance == 0.0 {
            return false;
        }
        gradient[label.index()] = -importance;
        gradient[choice.index()] = importance;
        true
    }
}
