//! Expected expert queries by method and convention, for m state samples a round (M = m/T trajectories).
//!
//! A query is a state whose expert action is asked for, executed or not. The paper's own conventions differ from those
//! of this crate's trainers, which [`ledgers`](super::ledgers) predicts. SEARN counted *eagerly* bills every step at
//! which a mixture with an expert in it acts, *lazily* only those at which it draws the expert.
//!
//! The `smile42` rows are Algorithm 4.2, the `smile43` rows Algorithm 4.3 and its exact repair, the `flip` rows the
//! repair by ageing labels (the same mean, a smaller variance: the reruns of one trajectory slot exclude each other).

use super::closed::{fresh42, fresh43, gone, kept, shares};
use serde::Serialize;

/// The most rounds of which [`Counts::flip_var`] is computed: it takes a sum over pairs of rounds.
pub const MOST_PAIRED: usize = 10_000;

/// What is counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// T.
    pub horizon: usize,
    /// A.
    pub actions: usize,
    /// N.
    pub rounds: usize,
    /// SMILe's alpha, from 1e-15 to 1.
    pub alpha: f64,
    /// SEARN's beta, from 1e-15 to 1.
    pub beta: f64,
    /// m, state samples a round.
    pub samples: u64,
    /// k, roll-outs an action.
    pub rollouts: u64,
}

/// Expected queries; `_var` are variances, `_bound` the paper's upper bounds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Counts {
    /// m.
    pub m: u64,
    /// k.
    pub k_roll: u64,
    /// m.
    pub supervised_labels: f64,
    /// m T: m labels at each of T steps.
    pub forward_labels: f64,
    /// m T(T+1)/2: Algorithm 3.1 as printed, whose expert acts from step i to T in round i.
    pub forward_literal: f64,
    /// m T(T+1)/2: environment steps when round i stops at step i.
    pub forward_env_steps: f64,
    /// N m.
    pub smile_labels: f64,
    /// m (1-p_N)/alpha, those labels that the expert also executes.
    pub smile_expert_executed: f64,
    /// m (1 + (N-1)(1-(1-alpha)^T)).
    pub smile42_labels: f64,
    /// T^2 M (N-1) r(1-r) with r = 1-(1-alpha)^T.
    pub smile42_var: f64,
    /// m (1 + (N-1) alpha T).
    pub smile42_bound: f64,
    /// m (1 + sum_{n<N} r_n), r_n = 1-(1-alpha p_{n-1})^T.
    pub smile43_labels: f64,
    /// T^2 M sum_{n<N} r_n (1-r_n).
    pub smile43_var: f64,
    /// (T+1) m.
    pub smile43_bound: f64,
    /// As `smile43_labels`.
    pub flip_labels: f64,
    /// T^2 M Var(reruns of a slot); nothing beyond [`MOST_PAIRED`] rounds, whose pairs are too many to add up.
    pub flip_var: Option<f64>,
    /// N m (1 + A k (T-1)/2).
    pub searn_eager: f64,
    /// m (1-p_N)/beta (1 + A k (T-1)/2).
    pub searn_lazy: f64,
    /// sum over rounds of the steps times p_{n-1}(1-p_{n-1}).
    pub searn_lazy_var: f64,
    /// `searn_eager` when a roll-in gives one state, at a uniform step: (T-1)/2 for 1.
    pub searn_eager_one_state: f64,
    /// `searn_lazy` likewise.
    pub searn_lazy_one_state: f64,
    /// 2 m A k T^4 ln T: the paper's order, at beta = T^-3 and N = 2 T^3 ln T, one for its constants.
    pub searn_headline: f64,
}

impl Counts {
    /// The counts of `plan`: O(N), and O(N^2) for the variance of the repair by ageing, which is left out for large N.
    pub fn of(plan: &Plan) -> Self {
        let (m, horizon, rounds) = (plan.samples as f64, plan.horizon as f64, plan.rounds as f64);
        let (a, b) = (plan.alpha, plan.beta);
        let tries = plan.actions as f64 * plan.rollouts as f64;
        let later = plan.rounds.saturating_sub(1);
        let once = fresh42(plan.horizon, a);
        let fresh: Vec<f64> = (1..=later).map(|n| fresh43(plan.horizon, a, n)).collect();
        let renewed = m * (1.0 + fresh.iter().sum::<f64>());
        // T^2 M = T m samples squared, for each trajectory has T samples.
        let square = horizon * m;
        let spread: f64 = fresh.iter().map(|r| r * (1.0 - r)).sum();
        let steps = 1.0 + tries * (horizon - 1.0) / 2.0;
        let steps_one = (1.0 + tries) * (horizon - 1.0) / 2.0;
        let drawn = shares(b, plan.rounds);
        let doubt: f64 = (0..plan.rounds).map(|n| kept(b, n) * gone(b, n)).sum();
        Counts {
            m: plan.samples,
            k_roll: plan.rollouts,
            supervised_labels: m,
            forward_labels: m * horizon,
            forward_literal: m * horizon * (horizon + 1.0) / 2.0,
            forward_env_steps: m * horizon * (horizon + 1.0) / 2.0,
            smile_labels: rounds * m,
            smile_expert_executed: m * shares(a, plan.rounds),
            smile42_labels: m * (1.0 + later as f64 * once),
            smile42_var: square * later as f64 * once * (1.0 - once),
            smile42_bound: m * (1.0 + later as f64 * a * horizon),
            smile43_labels: renewed,
            smile43_var: square * spread,
            smile43_bound: (horizon + 1.0) * m,
            flip_labels: renewed,
            flip_var: (plan.rounds <= MOST_PAIRED).then(|| square * (spread + 2.0 * overlap(plan, &fresh))),
            searn_eager: rounds * m * steps,
            searn_lazy: drawn * m * steps,
            searn_lazy_var: m * steps * doubt,
            searn_eager_one_state: rounds * m * steps_one,
            searn_lazy_one_state: drawn * m * steps_one,
            searn_headline: 2.0 * m * tries * horizon.powi(4) * horizon.ln(),
        }
    }
}

/// The sum over i < j of Cov(rerun at i, rerun at j): P(neither) = (1 - a p_{i-1} - a p_{j-1})^T.
fn overlap(plan: &Plan, fresh: &[f64]) -> f64 {
    let weight = |n: usize| plan.alpha * kept(plan.alpha, n);
    let mut sum = 0.0;
    for j in 0..fresh.len() {
        for i in 0..j {
            sum += kept((weight(i) + weight(j)).min(1.0), plan.horizon) - (1.0 - fresh[i]) * (1.0 - fresh[j]);
        }
    }
    sum
}
