//! Calibration: how sure a classifier may be, from examples that it did not learn from.

use super::{Examples, Setting, reduce};
use crate::policy::{Calibrated, Classifier};
use crate::space::{Features, Sight, Store};
use serde::Serialize;

/// Temperatures that are looked at.
const RANGE: (f64, f64) = (1e-3, 1e3);
/// Halvings of the range's logarithm.
const HALVINGS: usize = 50;

/// Finds the temperature at which the labels of the `held_out` examples are likeliest, from 0.001 to 1,000. The logarithm of their likelihood is concave in one
/// over the temperature, so there is one such temperature. Costs count as [`reduce::as_label`] says; where nothing is at stake, that is to say with a single legal
/// action or without examples, the temperature stays at 1.
///
/// ```
/// use rollin::learner::{Logistic, Reliability, Setting, calibrate};
/// use rollin::policy::Follow;
/// use rollin::roll;
/// use rollin::space::{Imitation, doc};
/// use rollin::trainer::{Run, Supervised};
/// use rollin::Seed;
///
/// let problem = Imitation { space: doc::RealWorld, expert: doc::Follow, episodes: 20 };
/// let trained = Supervised::default().train(&problem, &Logistic::default(), &Run::new(1))?;
/// // What the expert says in twenty other runs.
/// let (held_out, _) = roll::labels(&problem, &Follow, &(20..40).collect::<Vec<_>>(), Seed::new(2));
/// let sure = calibrate(trained.policy.0, Setting::of(&problem), &held_out.examples);
/// assert!(sure.temperature > 0.0);
/// assert!(Reliability::of(&sure, Setting::of(&problem), &held_out.examples).loss >= 0.0);
/// # Ok::<(), rollin::Error>(())
/// ```
pub fn calibrate<C: Classifier<Features>>(
    classifier: C,
    setting: Setting<'_, Features>,
    held_out: &Examples<Features>,
) -> Calibrated<C> {
    // Every example's scores over the legal actions, counted from the label's.
    let (mut gaps, mut ends, mut weights) = (Vec::new(), Vec::new(), Vec::new());
    let mut memory = C::Memory::default();
    each(setting, held_out, |sight, label, weight| {
        let scores = classifier.scores(sight, &mut memory);
        gaps.extend(sight.legal.iter().map(|a| f64::from(scores[a.index()]) - f64::from(scores[label])));
        ends.push(gaps.len());
        weights.push(weight);
    });
    // The slope of the likelihood's logarithm in 1/temperature, with the sign turned: it only rises.
    let slope = |sharpness: f64| {
        let mut start = 0;
        let each = ends.iter().zip(&weights).map(|(end, weight)| {
            let gaps = &gaps[std::mem::replace(&mut start, *end)..*end];
            let high = gaps.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let (sum, total) = gaps.iter().fold((0.0, 0.0), |(sum, total), gap| {
                let share = (sharpness * (gap - high)).exp();
                (sum + share * gap, total + share)
            });
            weight * sum / total
        });
        each.sum::<f64>()
    };
    let (mut low, mut high) = (RANGE.0.ln(), RANGE.1.ln());
    if weights.is_empty() || gaps.iter().all(|gap| *gap == 0.0) {
        return Calibrated { classifier, temperature: 1.0 };
    }
    for _ in 0..HALVINGS {
        let middle = low.midpoint(high);
        if slope(middle.exp()) < 0.0 { low = middle } else { high = middle }
    }
    Calibrated { classifier, temperature: (-low.midpoint(high)).exp() as f32 }
}

/// Hands what was seen in each example, the label and its importance to `look`; examples of no importance are left out.
fn each(
    setting: Setting<'_, Features>,
    examples: &Examples<Features>,
    mut look: impl FnMut(&Sight<'_, Features>, usize, f64),
) {
    let mut view = Features::default();
    for i in 0..examples.len() {
        examples.views().recall(i, &mut view);
        let legal = examples.legal(i);
        let (label, importance) = reduce::as_label(examples.target(i), legal);
        if importance > 0.0 {
            look(&Sight { shared: setting.shared, view: &view, legal }, label.index(), f64::from(importance));
        }
    }
}

/// How far probabilities can be relied on, measured on examples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Reliability {
    /// The mean of -ln p over the labels, in nats.
    pub loss: f64,
    /// The expected calibration error: the mean distance between how sure the choice was and how often it was right, in ten bins of equal width.
    pub error: f64,
}

impl Reliability {
    /// Of the probabilities that `classifier` gives `examples`; not numbers where there are none.
    pub fn of<C: Classifier<Features>>(
        classifier: &Calibrated<C>,
        setting: Setting<'_, Features>,
        examples: &Examples<Features>,
    ) -> Self {
        let mut bins = Bins::default();
        let mut loss = 0.0;
        let (mut memory, mut probabilities) = (C::Memory::default(), Vec::new());
        each(setting, examples, |sight, label, weight| {
            classifier.probabilities(sight, &mut memory, &mut probabilities);
            let (mut sure, mut choice, mut given) = (0.0, 0, 0.0);
            for (action, p) in sight.legal.iter().zip(&probabilities) {
                if *p > sure {
                    (sure, choice) = (*p, action.index());
                }
                if action.index() == label {
                    given = f64::from(*p);
                }
            }
            loss -= weight * given.max(f64::MIN_POSITIVE).ln();
            bins.add(sure, choice == label, weight);
        });
        Reliability { loss: loss / bins.total, error: bins.error() }
    }
}

/// The expected calibration error of choices, each with how sure it was, from 0 to 1, and whether it was right: the mean distance between the two in ten bins of
/// equal width (Guo, Pleiss, Sun & Weinberger 2017, equation 3). Not a number where there are none.
///
/// ```
/// // Four choices made with 0.9, of which three were right, and one with 0.5 that was.
/// let choices = [(0.9, true), (0.9, true), (0.9, true), (0.9, false), (0.5, true)];
/// let error = rollin::learner::calibration_error(choices);
/// assert!((error - (0.8 * 0.15 + 0.2 * 0.5)).abs() < 1e-6);
/// ```
pub fn calibration_error(choices: impl IntoIterator<Item = (f32, bool)>) -> f64 {
    let mut bins = Bins::default();
    choices.into_iter().for_each(|(sure, right)| bins.add(sure, right, 1.0));
    bins.error()
}

/// Choices by how sure they were: for each bin the weight of being sure and that of being right.
#[derive(Default)]
struct Bins {
    bins: [[f64; 2]; 10],
    total: f64,
}

impl Bins {
    fn add(&mut self, sure: f32, right: bool, weight: f64) {
        let bin = &mut self.bins[((sure * 10.0) as usize).min(9)];
        bin[0] += weight * f64::from(sure);
        bin[1] += if right { weight } else { 0.0 };
        self.total += weight;
    }

    fn error(&self) -> f64 {
        self.bins.iter().map(|[sure, right]| (sure - right).abs()).sum::<f64>() / self.total
    }
}
