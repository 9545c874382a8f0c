//! Weighted all pairs.

use super::Target;
use super::linear::{Descent, Lesson, Rule};
use crate::policy::Columns;
use crate::space::Action;
use serde::{Deserialize, Serialize};

/// Weighted all pairs (WAP; Beygelzimer et al. 2005): for every pair of legal actions a binary logistic regression says which one is
/// cheaper, with the pair's weight as importance; the action that beats most others is taken. A cost-sensitive learner.
///
/// The weight of a pair is |v_i - v_j|, where v_i is the integral from the least cost to c_i of 1 over the number of actions that cost
/// no more than t, dt: by this weighting the cost above each example's cheapest is at most twice the weighted binary loss, whatever the number of
/// actions. For labels the same holds of the regrets; for costs in general it does not, and pairs that are all decided as is best for them may
/// choose an action that is not (`tests/laws/regrets.rs` shows both).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Wap {
    /// Passes over the examples.
    pub passes: usize,
    /// AdaGrad's rate.
    pub rate: f32,
    /// The weight of half the squared norm, per example.
    pub l2: f32,
}

impl Default for Wap {
    fn default() -> Self {
        Wap { passes: 3, rate: 0.2, l2: 0.0 }
    }
}

/// A pair whose weighted chance of a mistake is below this changes nothing.
const SURE: f32 = 1e-4;

impl Wap {
    /// v of every cost, in place. Ties keep equal values.
    pub(super) fn integrate(costs: &mut [f32]) {
        let mut order: Vec<usize> = (0..costs.len()).collect();
        order.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
        let (mut value, mut last) = (0.0, f32::NAN);
        for (below, i) in order.into_iter().enumerate() {
            let cost = costs[i];
            if below > 0 {
                value += (cost - last) / below as f32;
            }
            last = cost;
            costs[i] = value;
        }
    }

    fn pair(
        actions: usize,
        (i, vi): (Action, f32),
        (j, vj): (Action, f32),
        scores: &[f32],
        gradient: &mut [f32],
    ) -> bool {
        let column = Columns::pair(actions, i.index(), j.index());
        let (weight, sign) = if vi < vj { (vj - vi, 1.0) } else { (vi - vj, -1.0) };
        let mistake = 1.0 / (1.0 + (sign * scores[column]).exp());
        if weight * mistake < SURE {
            return false;
        }
        gradient[column] = -sign * weight * mistake;
        true
    }
}

impl Rule for Wap {
    fn columns(&self) -> Columns {
        Columns::Pairs
    }

    fn descent(&self) -> Descent {
        Descent::Adaptive { rate: self.rate, l2: self.l2 }
    }

    fn passes(&self) -> usize {
        self.passes
    }

    fn gradient(&self, example: Lesson<'_>, scores: &[f32], gradient: &mut [f32]) -> bool {
        let (n, legal) = (example.actions, example.legal);
        let mut any = false;
        match example.target {
            // Only the label's pairs have weight: v is 0 at the label and 1 everywhere else.
            Target::Label(label) => {
                for other in legal.iter().filter(|a| *a != label) {
                    let (best, rest) = ((label, 0.0), (other, 1.0));
                    let (low, high) = if label < other { (best, rest) } else { (rest, best) };
                    any |= Wap::pair(n, low, high, scores, gradient);
                }
            }
            Target::Costs(costs) => {
                let mut values = costs.to_vec();
                Wap::integrate(&mut values);
                for (place, i) in legal.iter().enumerate() {
                    for (other, j) in legal.iter().enumerate().skip(place + 1) {
                        any |= Wap::pair(n, (i, values[place]), (j, values[other]), scores, gradient);
                    }
                }
            }
        }
        any
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_worked_by_hand() {
        // Costs 0, 1, 1, 3: one action costs no more than t on [0,1), three on [1,3): v = 0, 1, 1, 1 + 2/3.
        let mut costs = [1.0, 0.0, 3.0, 1.0];
        Wap::integrate(&mut costs);
        let expected = [1.0, 0.0, 1.0 + 2.0 / 3.0, 1.0];
        assert!(costs.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{costs:?}");
    }
}
