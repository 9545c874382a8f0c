//! Ridge regression, for continuous actions.

use super::dual::Batch;
use super::{Examples, Learner, Setting, reduce};
use crate::policy::{Columns, Linear, Valued, Weights, value_of};
use crate::seed::Seed;
use crate::space::Features;
use serde::{Deserialize, Serialize};

/// Ridge regression on the value of the expert's action, for spaces whose actions are the classes of an interval in ascending order
/// ([`Valued`]): the w that minimises Σ_n (w·x_n - y_n)² + l2 |w|², by conjugate gradients on the normal equations (Hestenes & Stiefel 1952),
/// whose answer does not depend on where they start: a classifier to start from is not used. An example of costs counts with the importance of [`reduce::as_label`].
///
/// ```
/// use rollin::learner::Ridge;
/// use rollin::space::{Imitation, doc::{Follow, RealWorld}};
/// use rollin::trainer::{Dagger, Run};
///
/// let problem = Imitation { space: RealWorld, expert: Follow, episodes: 20 };
/// let trained = Dagger::default().train(&problem, &Ridge::default(), &Run::new(1))?;
/// assert_eq!(trained.ledger.labels, 5 * 200);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Ridge {
    /// The values of the lowest and the highest action.
    pub interval: (f32, f32),
    /// The weight of the squared norm; above 0.
    pub l2: f32,
    /// Steps of the conjugate gradients at most.
    pub steps: usize,
}

impl Default for Ridge {
    fn default() -> Self {
        Ridge { interval: (-1.0, 1.0), l2: 1.0, steps: 100 }
    }
}

/// Of the residual's squared norm, where the descent stops.
const SMALL: f64 = 1e-16;

/// Examples as the rows of a matrix X with weights r.
struct Rows<'a> {
    batch: Batch<'a>,
    weights: Vec<f64>,
    l2: f64,
}

impl Rows<'_> {
    /// Writes (XᵀRX + l2) `w` into `product`.
    fn multiply(&self, w: &[f64], product: &mut [f64]) {
        product.iter_mut().zip(w).for_each(|(p, w)| *p = self.l2 * w);
        for (n, weight) in self.weights.iter().enumerate() {
            let sum: f64 = self.batch.features(n).iter().map(|feature| w[feature as usize]).sum();
            self.spread(n, weight * sum, product);
        }
    }

    /// Adds `amount` to the features of row `n`.
    fn spread(&self, n: usize, amount: f64, sums: &mut [f64]) {
        self.batch.features(n).iter().for_each(|feature| sums[feature as usize] += amount);
    }

    /// The w at which (XᵀRX + l2) w = `right`.
    fn solve(&self, right: Vec<f64>, steps: usize) -> Vec<f64> {
        let square = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
        let (mut w, mut product) = (vec![0.0; right.len()], vec![0.0; right.len()]);
        let (mut direction, mut residual) = (right.clone(), right);
        let first = square(&residual);
        let mut now = first;
        for _ in 0..steps {
            if now <= SMALL * first {
                break;
            }
            self.multiply(&direction, &mut product);
            let length = now / direction.iter().zip(&product).map(|(d, p)| d * p).sum::<f64>();
            w.iter_mut().zip(&direction).for_each(|(w, d)| *w += length * d);
            residual.iter_mut().zip(&product).for_each(|(r, p)| *r -= length * p);
            let next = square(&residual);
            direction.iter_mut().zip(&residual).for_each(|(d, r)| *d = r + next / now * *d);
            now = next;
        }
        w
    }
}

impl Learner<Features> for Ridge {
    type Classifier = Valued;

    fn fit(
        &self,
        setting: Setting<'_, Features>,
        examples: &Examples<Features>,
        _: Option<&Valued>,
        _: Seed,
    ) -> Valued {
        let (features, actions) = (setting.shared.features(), setting.actions);
        let mut rows = Rows { batch: Batch::of(setting, examples), weights: Vec::new(), l2: f64::from(self.l2) };
        let mut right = vec![0.0; features];
        for n in 0..rows.batch.len() {
            let (i, count) = rows.batch.example(n);
            let (best, importance) = reduce::as_label(examples.target(i), examples.legal(i));
            let weight = f64::from(count * importance);
            rows.weights.push(weight);
            rows.spread(n, weight * f64::from(value_of(self.interval, best.index(), actions)), &mut right);
        }
        let mut weights = Weights::new(features, 1);
        for (feature, w) in rows.solve(right, self.steps).into_iter().enumerate().filter(|(_, w)| *w != 0.0) {
            weights.row_mut(feature as u32)[0] = w as f32;
        }
        Valued { value: Linear { actions: 1, columns: Columns::Actions, weights }, interval: self.interval, actions }
    }
}
