//! The tabular learner.

use super::{Examples, Learner, Setting, reduce};
use crate::policy::{Columns, Linear, Weights};
use crate::seed::Seed;
use crate::space::{Actions, Features};

/// Takes, for each feature, the action that cost least in sum over the examples with that feature; the lowest of equals, and the lowest
/// action where there is no example. Where every view has exactly one feature this is the best classifier of the class that
/// tells views apart by it: empirical risk minimisation, exact, for labels and for costs. A classifier to start from is not
/// needed and not used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tabular;

impl Learner<Features> for Tabular {
    type Classifier = Linear;

    fn fit(
        &self,
        setting: Setting<'_, Features>,
        examples: &Examples<Features>,
        _: Option<&Linear>,
        _: Seed,
    ) -> Linear {
        let (features, actions) = (setting.shared.features(), setting.actions);
        let mut sums = vec![0.0f64; features * actions];
        let mut seen = vec![false; features];
        let mut costs = Vec::new();
        for i in 0..examples.len() {
            let legal = examples.legal(i);
            reduce::as_costs(examples.target(i), legal, &mut costs);
            for feature in examples.views().listed(i, setting.shared).iter() {
                let start = feature as usize * actions;
                seen[feature as usize] = true;
                for (action, cost) in legal.iter().zip(&costs) {
                    sums[start + action.index()] += f64::from(*cost);
                }
            }
        }
        let mut weights = Weights::new(features, actions);
        for (feature, sums) in sums.chunks(actions).enumerate().filter(|(feature, _)| seen[*feature]) {
            let best = Actions::All(actions as u32).iter().min_by(|a, b| sums[a.index()].total_cmp(&sums[b.index()]));
            if let Some(best) = best {
                weights.row_mut(feature as u32)[best.index()] = 1.0;
            }
        }
        Linear { actions, columns: Columns::Actions, weights }
    }
}
