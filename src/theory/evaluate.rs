//! Exact evaluation by dynamic programming: Section 2's J, d^t, d and e, and costs-to-go.

use super::mdp::Mdp;
use super::table::{Schedule, Table, scheduled};
use crate::error::Result;
use ndarray::{Array1, Array2, Array3, Axis};

/// A policy's exact values.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// J(pi), the expected cost of T steps.
    pub cost: f64,
    /// `visits[t,s]`: d^t_pi(s), the probability of state s at step t.
    pub visits: Array2<f64>,
    /// `value[t,s]`: the expected cost of steps t to T-1 from state s at step t.
    pub value: Array2<f64>,
    /// `action_value[t,s,a]`: Q, the same when action a is taken first.
    pub action_value: Array3<f64>,
}

impl Evaluation {
    /// d_pi(s), the average of `visits` over the steps.
    pub fn mean(&self) -> Array1<f64> {
        average(&self.visits)
    }

    /// `[t,s,a]`: Q(s,a) less the value of the state; what one action at one step adds to the cost.
    pub fn advantages(&self) -> Array3<f64> {
        &self.action_value - &self.value.view().insert_axis(Axis(2))
    }
}

/// The average of the rows.
pub(super) fn average(visits: &Array2<f64>) -> Array1<f64> {
    visits.sum_axis(Axis(0)) / visits.nrows() as f64
}

/// Evaluates a stationary policy, a mixture (its table) or one table a step.
///
/// O(T S^2 A), nearly all of it one product of matrices an action, costs-to-go `[t,s']` with `next[s,a,s']`; states and
/// values alone take O(S^2 (T + A)) for a stationary policy. Memory: O(T S A).
///
/// # Errors
/// A table of the wrong shape, or fewer tables than steps.
pub fn evaluate(mdp: &Mdp, policy: &(impl Schedule + ?Sized)) -> Result<Evaluation> {
    let tables = scheduled(mdp, policy)?;
    let (horizon, states, actions) = (mdp.horizon(), mdp.states(), mdp.actions());
    let mut chains = Chains::new(mdp);
    let visits = chains.visits(&tables);
    let value = chains.values(&tables);
    // What is still to pay after each step; nothing after the last.
    let mut later = Array2::zeros((horizon, states));
    later.slice_axis_mut(Axis(0), (..horizon - 1).into()).assign(&value.slice_axis(Axis(0), (1..).into()));
    let mut action_value = Array3::zeros((horizon, states, actions));
    for (a, mut q) in action_value.axis_iter_mut(Axis(2)).enumerate() {
        q.assign(&(later.dot(&mdp.next().index_axis(Axis(1), a).t()) + mdp.cost().column(a)));
    }
    Ok(Evaluation { cost: mdp.start().dot(&value.row(0)), visits, value, action_value })
}

/// J of a stationary policy that fits the problem, and nothing else: O(S^2 (T + A)).
pub(super) fn cost(mdp: &Mdp, table: &Table) -> f64 {
    mdp.start().dot(&Chains::new(mdp).values(&vec![table; mdp.horizon()]).row(0))
}

/// `[t,s]`: the state distributions of the tables, which fit the problem; O(T S^2), and O(S^2 A) for every change of
/// the table.
pub(super) fn visits(mdp: &Mdp, tables: &[&Table]) -> Array2<f64> {
    Chains::new(mdp).visits(tables)
}

/// One step of a chain: the distribution `now[s]` times `chain[s,s']`, by rows, for columns are far apart in memory.
pub(super) fn push(now: &Array1<f64>, chain: &Array2<f64>) -> Array1<f64> {
    let mut later = Array1::zeros(chain.ncols());
    for (p, row) in now.iter().zip(chain.outer_iter()).filter(|(p, _)| **p != 0.0) {
        later.scaled_add(*p, &row);
    }
    later
}

/// The chain of the table asked for last: neighbours that are the same table share it.
struct Chains<'a> {
    mdp: &'a Mdp,
    last: Option<(&'a Table, Array2<f64>)>,
}

impl<'a> Chains<'a> {
    fn new(mdp: &'a Mdp) -> Self {
        Chains { mdp, last: None }
    }

    /// `[s,s']`.
    fn of(&mut self, table: &'a Table) -> &Array2<f64> {
        let same = self.last.take().filter(|(last, _)| std::ptr::eq(*last, table));
        &self.last.insert(same.unwrap_or_else(|| (table, self.mdp.chain(table)))).1
    }

    /// `[t,s]`, forwards.
    fn visits(&mut self, tables: &[&'a Table]) -> Array2<f64> {
        let mut visits = Array2::zeros((tables.len(), self.mdp.states()));
        let mut now = self.mdp.start().clone();
        for (t, table) in tables.iter().enumerate() {
            visits.row_mut(t).assign(&now);
            if t + 1 < tables.len() {
                now = push(&now, self.of(table));
            }
        }
        visits
    }

    /// `[t,s]`, backwards.
    fn values(&mut self, tables: &[&'a Table]) -> Array2<f64> {
        let mut values = Array2::zeros((tables.len(), self.mdp.states()));
        let mut later = Array1::zeros(self.mdp.states());
        for (t, table) in tables.iter().enumerate().rev() {
            later = self.mdp.charge(table) + self.of(table).dot(&later);
            values.row_mut(t).assign(&later);
        }
        values
    }
}
