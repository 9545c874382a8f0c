//! What a classifier's outputs say about actions.

use serde::{Deserialize, Serialize};

/// What the outputs of a classifier stand for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outputs {
    /// One per action: its score.
    #[default]
    Actions,
    /// One per bit of the action's number, such as the buttons of a game pad: an action's score is the sum of the outputs of the bits it sets.
    ///
    /// Where every number is a legal action, the logistic loss over the actions is the sum of the bits' own: exp(score_a) / sum over a' of exp(score_a') is
    /// the product over the bits of σ(output) or 1 - σ(output). So each output is a sigmoid of its own that says whether its button is
    /// pressed, and the best action presses those that are likelier pressed than not.
    Bits,
}

impl Outputs {
    /// How many outputs `actions` actions need.
    pub fn count(self, actions: usize) -> usize {
        match self {
            Outputs::Actions => actions,
            Outputs::Bits => (usize::BITS - actions.saturating_sub(1).leading_zeros()) as usize,
        }
    }

    /// Writes the score of each of `actions` actions.
    pub(crate) fn scores(self, actions: usize, outputs: &[f32], scores: &mut Vec<f32>) {
        scores.clear();
        match self {
            Outputs::Actions => scores.extend_from_slice(&outputs[..actions]),
            // A number's score is that of its highest bit and that of the number without it.
            Outputs::Bits => {
                scores.resize(actions, 0.0);
                for a in 1..actions {
                    let bit = a.ilog2() as usize;
                    scores[a] = scores[a - (1 << bit)] + outputs[bit];
                }
            }
        }
    }

    /// Adds to the outputs' slopes what the slope at the score of action `a` makes of them.
    #[inline]
    pub(crate) fn add_slope(self, a: usize, slope: f32, slopes: &mut [f32]) {
        match self {
            Outputs::Actions => slopes[a] += slope,
            Outputs::Bits => {
                slopes.iter_mut().enumerate().filter(|(bit, _)| a >> bit & 1 == 1).for_each(|(_, sum)| *sum += slope);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_counted_and_added_up() {
        assert_eq!([0, 1, 2, 3, 4, 5, 16, 17].map(|n| Outputs::Bits.count(n)), [0, 0, 1, 2, 2, 3, 4, 5]);
        let mut scores = Vec::new();
        Outputs::Bits.scores(6, &[1.0, 10.0, 100.0], &mut scores);
        assert_eq!(scores, [0.0, 1.0, 10.0, 11.0, 100.0, 101.0]);
        let mut slopes = [0.0; 3];
        Outputs::Bits.add_slope(5, 2.0, &mut slopes);
        assert_eq!(slopes, [2.0, 0.0, 2.0]);
    }
}
