//! The k-th order quantities of Section 4: what happens when pi' acts at k of the T steps and pi at the others.
//!
//! Jbar_k^pi(pi') averages the cost over all C(T,k) choices of the k steps, A_k(pi, pi') = Jbar_k - J(pi) is the k-th
//! order policy disadvantage, D_k^pi(pi') the state frequencies. Enumeration is not needed: step t belongs to a uniform
//! j-subset of the first t steps with probability j/t, so with `F_t[j]` the state distribution after t steps of which a
//! uniform j-subset was pi's substitute,
//!
//! `F_t[j] = (j/t) F_{t-1}[j-1] P_{pi'} + (1-j/t) F_{t-1}[j] P_pi`,
//!
//! one product of a (t+1) x S matrix with each chain per step. How many of the k steps fall among the first t is
//! hypergeometric. Everything for all k at once costs O(T^2 (S^2 + T S)), and O(S^2 A) for the two chains.
//!
//! Costs alone come at half the price: with `W_m[i]` the cost-to-go of the last m steps when a uniform i-subset of them
//! is pi's substitute, Jbar_k joins `F_{T/2}[j]` with `W_{T/2}[k-j]`, and each recursion goes half the way.

use super::mdp::Mdp;
use super::table::Table;
use crate::error::Result;
use ndarray::{Array1, Array2, Array3, ArrayView2, Axis, Slice};

/// The k-th order quantities of one pair of policies, k = 0, ..., T.
#[derive(Clone, Debug, PartialEq)]
pub struct Orders {
    /// `costs[k]`: Jbar_k; at 0 the cost of pi, at T that of pi'.
    pub costs: Vec<f64>,
    /// `disadvantages[k]`: A_k = Jbar_k - Jbar_0.
    pub disadvantages: Vec<f64>,
    /// `frequencies[k,s]`: D_k, averaged over the steps.
    pub frequencies: Array2<f64>,
}

/// Jbar_k and A_k alone, k = 0, ..., T.
#[derive(Clone, Debug, PartialEq)]
pub struct Costs {
    /// `costs[k]`: Jbar_k.
    pub costs: Vec<f64>,
    /// `disadvantages[k]`: A_k = Jbar_k - Jbar_0.
    pub disadvantages: Vec<f64>,
}

/// The costs of all orders of `substitute` with respect to `base`, without the state frequencies: O(T^2 S^2 + T^3),
/// half of what [`orders`] takes. Memory: O(T (S + T)).
///
/// # Errors
/// A table of the wrong shape.
pub fn costs(mdp: &Mdp, base: &Table, substitute: &Table) -> Result<Costs> {
    mdp.admit(base)?;
    mdp.admit(substitute)?;
    let chains = [base, substitute].map(|table| mdp.chain(table));
    let charges = [base, substitute].map(|table| mdp.charge(table));
    let half = mdp.horizon() / 2;
    let (mut split, mut prefixes) = (Split::new(mdp.horizon()), Prefixes::new(mdp, &chains[0], &chains[1]));
    let mut costs = Array1::<f64>::zeros(mdp.horizon() + 1);
    for t in 1..=half {
        let spent = spent(&prefixes.rows(), &charges, t);
        split.advance();
        costs += &split.weights().dot(&spent);
        prefixes.advance();
    }
    // [j,i]: what remains when j of the first half of the steps and i of the second are the substitute's.
    let ahead = prefixes.rows().dot(&remaining(mdp, &chains, &charges, mdp.horizon() - half).t());
    for ((k, j), weight) in split.weights().indexed_iter().filter(|((k, j), weight)| j <= k && **weight > 0.0) {
        costs[k] += weight * ahead[[j, k - j]];
    }
    let disadvantages = costs.iter().map(|cost| cost - costs[0]).collect();
    Ok(Costs { costs: costs.to_vec(), disadvantages })
}

/// `[i,s]`, i = 0, ..., `steps`: the cost of the last `steps` steps from state s when a uniform i-subset of them is the
/// substitute's, `W_m[i] = (i/m)(C_{pi'} + P_{pi'} W_{m-1}[i-1]) + (1-i/m)(C_pi + P_pi W_{m-1}[i])`.
fn remaining(mdp: &Mdp, chains: &[Array2<f64>; 2], charges: &[Array1<f64>; 2], steps: usize) -> Array2<f64> {
    let mut rows = Array2::zeros((steps + 1, mdp.states()));
    for m in 1..=steps {
        let later = first(&rows, Axis(0), m);
        let [stay, swap] = [0, 1].map(|i| later.dot(&chains[i].t()) + &charges[i]);
        blend(&mut rows, m, &stay, &swap);
    }
    rows
}

/// `[j]`: what step t costs, counted from 1, when a uniform j-subset of the first t steps is the substitute's.
fn spent(before: &ArrayView2<'_, f64>, charges: &[Array1<f64>; 2], t: usize) -> Array1<f64> {
    let [stay, swap] = [0, 1].map(|i| before.dot(&charges[i]));
    (0..=t).map(|j| share(j, t, |j| swap[j], |j| stay[j])).collect()
}

/// All k-th order quantities of `substitute` with respect to `base`: O(T^2 S (S + T)). Memory: O(T (S + T)).
///
/// # Errors
/// A table of the wrong shape.
pub fn orders(mdp: &Mdp, base: &Table, substitute: &Table) -> Result<Orders> {
    mdp.admit(base)?;
    mdp.admit(substitute)?;
    let horizon = mdp.horizon();
    let charges = [base, substitute].map(|table| mdp.charge(table));
    let mut split = Split::new(horizon);
    let mut costs = Array1::<f64>::zeros(horizon + 1);
    let mut frequencies = Array2::zeros((horizon + 1, mdp.states()));
    let chains = [base, substitute].map(|table| mdp.chain(table));
    let mut prefixes = Prefixes::new(mdp, &chains[0], &chains[1]);
    for t in 1..=horizon {
        // F_{t-1}[j]: the states at the t-th step.
        let now = prefixes.rows();
        frequencies += &split.weights().dot(&now);
        let spent = spent(&now, &charges, t);
        split.advance();
        costs += &split.weights().dot(&spent);
        if t < horizon {
            prefixes.advance();
        }
    }
    frequencies /= horizon as f64;
    let disadvantages = costs.iter().map(|cost| cost - costs[0]).collect();
    Ok(Orders { costs: costs.to_vec(), disadvantages, frequencies })
}

/// `[k,t,s]`: the law of the state at every step, when `substitute` acts at k uniformly chosen steps and `base` at the
/// others: O(T^2 S (S + T)). Memory: O(T^2 S).
///
/// # Errors
/// A table of the wrong shape.
pub fn laws(mdp: &Mdp, base: &Table, substitute: &Table) -> Result<Array3<f64>> {
    mdp.admit(base)?;
    mdp.admit(substitute)?;
    let horizon = mdp.horizon();
    let mut laws = Array3::zeros((horizon + 1, horizon, mdp.states()));
    let mut split = Split::new(horizon);
    let chains = [base, substitute].map(|table| mdp.chain(table));
    let mut prefixes = Prefixes::new(mdp, &chains[0], &chains[1]);
    for t in 0..horizon {
        laws.index_axis_mut(Axis(1), t).assign(&split.weights().dot(&prefixes.rows()));
        split.advance();
        if t + 1 < horizon {
            prefixes.advance();
        }
    }
    Ok(laws)
}

/// (j/t) swap(j-1) + (1-j/t) stay(j), without asking for what has no weight.
fn share(j: usize, t: usize, swap: impl Fn(usize) -> f64, stay: impl Fn(usize) -> f64) -> f64 {
    let swapped = if j > 0 { j as f64 / t as f64 * swap(j - 1) } else { 0.0 };
    let stayed = if j < t { (t - j) as f64 / t as f64 * stay(j) } else { 0.0 };
    swapped + stayed
}

/// F_t: `rows[j,s]`, j = 0, ..., t.
pub(super) struct Prefixes<'a> {
    t: usize,
    base: &'a Array2<f64>,
    substitute: &'a Array2<f64>,
    rows: Array2<f64>,
}

impl<'a> Prefixes<'a> {
    /// F_0, the initial distribution. The chains are of the problem.
    pub(super) fn new(mdp: &Mdp, base: &'a Array2<f64>, substitute: &'a Array2<f64>) -> Self {
        let mut rows = Array2::zeros((mdp.horizon() + 1, mdp.states()));
        rows.row_mut(0).assign(mdp.start());
        Prefixes { t: 0, base, substitute, rows }
    }

    /// `[j,s]`, j = 0, ..., t.
    pub(super) fn rows(&self) -> ArrayView2<'_, f64> {
        first(&self.rows, Axis(0), self.t + 1)
    }

    /// From F_t to F_{t+1}.
    pub(super) fn advance(&mut self) {
        let now = first(&self.rows, Axis(0), self.t + 1);
        let (stay, swap) = (now.dot(self.base), now.dot(self.substitute));
        self.t += 1;
        if self.t < self.rows.nrows() {
            blend(&mut self.rows, self.t, &stay, &swap);
        }
    }
}

/// The first `count` rows or columns, all of them if there are fewer.
fn first(matrix: &Array2<f64>, axis: Axis, count: usize) -> ArrayView2<'_, f64> {
    matrix.slice_axis(axis, Slice::from(..count.min(matrix.len_of(axis))))
}

/// rows[j] = (j/t) swap[j-1] + (1-j/t) stay[j] for j = 0, ..., t; `stay` and `swap` have t rows.
pub(super) fn blend(rows: &mut Array2<f64>, t: usize, stay: &Array2<f64>, swap: &Array2<f64>) {
    for j in 0..=t {
        let mut row = rows.row_mut(j);
        row.fill(0.0);
        if j > 0 {
            row.scaled_add(j as f64 / t as f64, &swap.row(j - 1));
        }
        if j < t {
            row.scaled_add((t - j) as f64 / t as f64, &stay.row(j));
        }
    }
}

/// How many of k uniformly chosen steps out of T fall among the first t: hypergeometric, for all k at once.
pub(super) struct Split {
    t: usize,
    weights: Array2<f64>,
}

impl Split {
    /// Before the first step.
    pub(super) fn new(horizon: usize) -> Self {
        let mut weights = Array2::zeros((horizon + 1, horizon + 1));
        weights.column_mut(0).fill(1.0);
        Split { t: 0, weights }
    }

    /// `[k,j]`: the probability that j of the k steps are among the first t; k = 0, ..., T and j = 0, ..., t.
    pub(super) fn weights(&self) -> ArrayView2<'_, f64> {
        first(&self.weights, Axis(1), self.t + 1)
    }

    /// From t to t+1 <= T: with j of k behind, the next of the T-t steps left is one of the k-j with probability
    /// (k-j)/(T-t).
    pub(super) fn advance(&mut self) {
        let horizon = self.weights.nrows() - 1;
        let left = horizon.saturating_sub(self.t).max(1) as f64;
        for (k, mut row) in self.weights.outer_iter_mut().enumerate() {
            for j in (0..=k.min(self.t + 1)).rev() {
                let stay = row[j] * (1.0 - (k - j) as f64 / left).max(0.0);
                let swap = if j > 0 { row[j - 1] * ((k - j + 1) as f64 / left) } else { 0.0 };
                row[j] = stay + swap;
            }
        }
        self.t = (self.t + 1).min(horizon);
    }
}
