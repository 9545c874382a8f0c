//! Scores as probabilities.

use super::Classifier;
use crate::space::{Sight, View};

/// A classifier whose scores, divided by a temperature, are the logarithms of probabilities but for a constant: p_a is proportional to
/// exp(score_a / temperature) over the legal actions (Guo, Pleiss, Sun & Weinberger 2017; for two actions Platt 1999, without offset). It chooses
/// as the classifier does. [`crate::learner::calibrate`] finds the temperature.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated<C> {
    /// What it makes probabilities of.
    pub classifier: C,
    /// Above 0; the higher, the less sure.
    pub temperature: f32,
}

impl<C> Calibrated<C> {
    /// Writes the probability of each legal action at `sight`, in ascending order of the actions, into `probabilities`.
    pub fn probabilities<V: View>(&self, sight: &Sight<'_, V>, memory: &mut C::Memory, probabilities: &mut Vec<f32>)
    where
        C: Classifier<V>,
    {
        let scores = self.classifier.scores(sight, memory);
        if sight.legal.is_empty() {
            return probabilities.clear();
        }
        let high = scores[sight.legal.best(scores).index()];
        probabilities.clear();
        probabilities.extend(sight.legal.iter().map(|a| ((scores[a.index()] - high) / self.temperature).exp()));
        let total: f32 = probabilities.iter().sum();
        probabilities.iter_mut().for_each(|p| *p /= total);
    }
}

impl<V: View, C: Classifier<V>> Classifier<V> for Calibrated<C> {
    type Memory = C::Memory;

    fn scores<'m>(&self, sight: &Sight<'_, V>, memory: &'m mut C::Memory) -> &'m [f32] {
        self.classifier.scores(sight, memory)
    }
}
