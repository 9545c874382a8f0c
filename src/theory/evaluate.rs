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

/// Evaluates a stationary policy, a mixture (its table) or one table a step, in O(T (S^2 A)).
///
/// # Errors
/// A table of the wrong shape, or fewer tables than steps.
pub fn evaluate(mdp: &Mdp, policy: &(impl Schedule + ?Sized)) -> Result<Evaluation> {
    let tables = scheduled(mdp, policy)?;
    let visits = visits(mdp, &tables);
    let (horizon, states, actions) = (mdp.horizon(), mdp.states(), mdp.actions());
    let mut value = Array2::zeros((horizon, states));
    let mut action_value = Array3::zeros((horizon, states, actions));
    let mut later = Array1::<f64>::zeros(states);
    for (t, table) in tables.iter().enumerate().rev() {
        let mut q = mdp.cost().clone();
        for (s, mut row) in q.outer_iter_mut().enumerate() {
            row += &mdp.next().index_axis(Axis(0), s).dot(&later);
        }
        later = (table.rows() * &q).sum_axis(Axis(1));
        value.row_mut(t).assign(&later);
        action_value.index_axis_mut(Axis(0), t).assign(&q);
    }
    Ok(Evaluation { cost: mdp.start().dot(&later), visits, value, action_value })
}

/// `[t,s]`: the state distributions of the tables, which fit the problem. Equal neighbours share their chain.
pub(super) fn visits(mdp: &Mdp, tables: &[&Table]) -> Array2<f64> {
    let mut visits = Array2::zeros((tables.len(), mdp.states()));
    let mut now = mdp.start().clone();
    let mut chain: Option<(&Table, Array2<f64>)> = None;
    for (t, table) in tables.iter().copied().enumerate() {
        visits.row_mut(t).assign(&now);
        let reusable = chain.take().filter(|(last, _)| std::ptr::eq(*last, table));
        let (table, matrix) = reusable.unwrap_or_else(|| (table, mdp.chain(table)));
        now = now.dot(&matrix);
        chain = Some((table, matrix));
    }
    visits
}
