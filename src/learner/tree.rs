//! The filter tree.

use super::linear::{Descent, Lesson, Rule};
use super::reduce;
use crate::policy::{Columns, tournament};
use serde::{Deserialize, Serialize};

/// The filter tree (Beygelzimer, Langford & Ravikumar 2009): actions play a single-elimination tournament in a balanced tree. At every match
/// a binary logistic regression says which of the two winners from below is cheaper, with the difference of their costs as
/// importance; an example reaches a match only with the actions that its current classifiers let through. A cost-sensitive
/// learner with one column less than there are actions; AdaGrad, averaged weights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FilterTree {
    /// Passes over the examples.
    pub passes: usize,
    /// AdaGrad's rate.
    pub rate: f32,
    /// The weight of half the squared norm, per example.
    pub l2: f32,
}

impl Default for FilterTree {
    fn default() -> Self {
        FilterTree { passes: 5, rate: 0.2, l2: 0.0 }
    }
}

/// A match whose weighted chance of a mistake is below this changes nothing.
const SURE: f32 = 1e-4;

impl Rule for FilterTree {
    fn columns(&self) -> Columns {
        Columns::Tree
    }

    fn descent(&self) -> Descent {
        Descent::Adaptive { rate: self.rate, l2: self.l2 }
    }

    fn passes(&self) -> usize {
        self.passes
    }

    fn gradient(&self, example: Lesson<'_>, scores: &[f32], gradient: &mut [f32]) -> bool {
        let mut costs = Vec::new();
        reduce::as_costs(example.target, example.legal, &mut costs);
        let mut any = false;
        tournament(example.actions, scores, example.legal, &mut |column, left, right| {
            let cost = |action| example.legal.place(action).map_or(0.0, |place| costs[place]);
            let more = cost(right) - cost(left);
            let mistake = 1.0 / (1.0 + (more.signum() * scores[column]).exp());
            if more.abs() * mistake >= SURE {
                gradient[column] = -more * mistake;
                any = true;
            }
        });
        any
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learner::Target;
    use crate::space::{Action, Actions};

    #[test]
    fn matches_worked_by_hand() {
        // Five actions: (0, 1) meet in column 0, (3, 4) in 3, 2 and the winner of those in 2, the last match is 1.
        let lesson = |legal, target| Lesson { actions: 5, legal, target };
        let mut gradient = [0.0; 4];
        let costs = Target::Costs(&[3.0, 1.0, 0.0, 2.0, 2.0]);
        assert!(FilterTree::default().gradient(lesson(Actions::All(5), costs), &[0.0; 4], &mut gradient));
        // Ties go left: 0 beats 1 and 3 beats 4, which cost the same; 2 beats 3; then 0 meets 2. Half of each difference.
        assert_eq!(gradient, [1.0, 1.5, -1.0, 0.0]);
        // With column 0 for 1, it is 1 that meets 2.
        let mut gradient = [0.0; 4];
        FilterTree::default().gradient(lesson(Actions::All(5), costs), &[-100.0, 0.0, 0.0, 0.0], &mut gradient);
        assert_eq!(gradient, [0.0, 0.5, -1.0, 0.0]);
        // Only legal actions play: 1 and 4 meet at the top.
        let legal = [Action(1), Action(4)];
        let mut gradient = [0.0; 4];
        let label = Target::Label(Action(4));
        FilterTree::default().gradient(lesson(Actions::Only(&legal), label), &[0.0; 4], &mut gradient);
        assert_eq!(gradient, [0.0, 0.5, 0.0, 0.0]);
        let champion = |scores: [f32; 4]| tournament(5, &scores, Actions::All(5), &mut |_, _, _| {});
        assert_eq!(champion([0.0, 0.0, 0.0, 0.0]), Some(Action(0)));
        assert_eq!(champion([0.0, -1.0, -1.0, -1.0]), Some(Action(4)));
        assert_eq!(champion([-1.0, 0.0, 0.0, 0.0]), Some(Action(1)));
    }
}
