//! The multiclass hinge loss, by its gradient.

use super::Target;
use super::linear::{Descent, Lesson, Rule};
use crate::policy::Columns;
use crate::space::Action;
use serde::{Deserialize, Serialize};

/// The multiclass hinge loss (Crammer & Singer 2001), whose margin is what an action costs more than the cheapest (Tsochantaridis et al. 2005): the loss is
/// max_a (s_a + c_a) - s_y, where y is the cheapest action; if there are several, that of the highest score. AdaGrad, averaged weights. A cost-sensitive
/// learner; where a label is right, all others cost 1.
///
/// An example changes the weights of two actions and those of no other, or of none: it is the fastest of the learners that come near the most accurate
/// ones. [`CrammerSinger`](super::CrammerSinger) solves the same with its squared norm exactly, example by example, and takes longer.
///
/// ```
/// use rollin::learner::Hinge;
/// use rollin::tasks::tagging;
/// use rollin::trainer::{Dagger, Run};
///
/// let problem = tagging::doc::problem()?;
/// let trained = Dagger { rounds: 2, ..Dagger::default() }.train_online(&problem, &Hinge::default(), &Run::new(1))?;
/// assert_eq!(trained.rounds.len(), 2);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Hinge {
    /// Passes over the examples.
    pub passes: usize,
    /// AdaGrad's rate.
    pub rate: f32,
    /// The weight of half the squared norm, per example.
    pub l2: f32,
}

impl Default for Hinge {
    fn default() -> Self {
        Hinge { passes: 5, rate: 0.1, l2: 0.0 }
    }
}

impl Rule for Hinge {
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
        let (right, rival, loss) = match example.target {
            Target::Label(right) => {
                let owed = |a: Action| scores[a.index()] + if a == right { 0.0 } else { 1.0 };
                // Mostly nobody comes that near, which is sooner seen than who comes nearest.
                if !example.legal.iter().any(|a| owed(a) > owed(right)) {
                    return false;
                }
                let rival = example.legal.best_by(owed);
                (right, rival, owed(rival) - owed(right))
            }
            Target::Costs(costs) => {
                let least = costs.iter().copied().fold(f32::INFINITY, f32::min);
                let [mut right, mut rival] = [(example.legal.nth(0), f32::NEG_INFINITY); 2];
                for (a, cost) in example.legal.iter().zip(costs) {
                    let score = scores[a.index()];
                    if *cost == least && score > right.1 {
                        right = (a, score);
                    }
                    if score + (cost - least) > rival.1 {
                        rival = (a, score + (cost - least));
                    }
                }
                (right.0, rival.0, rival.1 - right.1)
            }
        };
        if right == rival || loss.is_nan() || loss <= 0.0 {
            return false;
        }
        gradient[right.index()] = -1.0;
        gradient[rival.index()] = 1.0;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Actions;
    use proptest::prelude::*;

    proptest! {
        /// The gradient against differences of the loss, away from where two actions are owed the same.
        #[test]
        fn the_gradient_is_that_of_the_loss(
            scores in prop::array::uniform4(-3.0..3.0f32),
            costs in prop::array::uniform3(0.0..2.0f32),
            label in 0..3usize,
            costly: bool,
        ) {
            let some = [Action(0), Action(2), Action(3)];
            let target = if costly { Target::Costs(&costs) } else { Target::Label(some[label]) };
            let lesson = Lesson { actions: 4, legal: Actions::Only(&some), target };
            let least = (0..3).fold(0, |a, b| if costs[b] < costs[a] { b } else { a });
            let right = if costly { least } else { label };
            let owed = |scores: &[f32; 4]| -> Vec<f32> {
                let dearer = |a: usize| if costly { costs[a] - costs[right] } else { f32::from(u8::from(a != right)) };
                (0..3).map(|a| scores[some[a].index()] + dearer(a) - scores[some[right].index()]).collect()
            };
            let mut sorted = owed(&scores);
            sorted.sort_by(f32::total_cmp);
            prop_assume!(sorted[2] - sorted[1] > 0.01);
            let loss = |scores: &[f32; 4]| owed(scores).into_iter().fold(0.0, f32::max);
            let mut gradient = [0.0; 4];
            let changes = Hinge::default().gradient(lesson, &scores, &mut gradient);
            prop_assert_eq!(changes, loss(&scores) > 0.0);
            for column in 0..4 {
                let [up, down] = [1e-3, -1e-3].map(|by| {
                    let mut moved = scores;
                    moved[column] += by;
                    loss(&moved)
                });
                prop_assert!(((up - down) / 2e-3 - gradient[column]).abs() < 1e-2, "{column}: {gradient:?}");
            }
        }
    }

    /// Of two that cost as little, the one that would be taken is the right one: nothing is to be learned.
    #[test]
    fn equals_are_not_pushed_apart() {
        let lesson = Lesson { actions: 3, legal: Actions::All(3), target: Target::Costs(&[0.0, 0.0, 1.0]) };
        assert!(!Hinge::default().gradient(lesson, &[0.0, 2.0, 1.0], &mut [0.0; 3]));
        let mut gradient = [0.0; 3];
        assert!(Hinge::default().gradient(lesson, &[0.0, 2.0, 1.5], &mut gradient));
        assert_eq!(gradient, [0.0, -1.0, 1.0]);
    }
}
