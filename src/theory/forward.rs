//! Forward training (Section 3, Algorithm 3.1) with given classifiers, exactly.

use super::evaluate::{Evaluation, evaluate};
use super::mdp::Mdp;
use super::table::{Table, scheduled};
use crate::error::Result;
use ndarray::{Array1, Axis};

/// What forward training does with pi_1, ..., pi_T: policy pi^i acts by them at the first i steps and by the expert
/// afterwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Forward {
    /// `costs[i]`: J(pi^i), i = 0 (the expert), ..., T.
    pub costs: Vec<f64>,
    /// `disadvantages[i-1]`: A(pi^{i-1}, pi_i^i) = J^{pi^{i-1}}(pi_i, i) - J(pi^{i-1}); by Theorem 3.1 they add up to
    /// J(pi^T) - J(pi*).
    pub disadvantages: Vec<f64>,
    /// `errors[i-1]`: eps_i, the 0-1 loss of pi_i under d^i of pi^{i-1}.
    pub errors: Vec<f64>,
    /// `stakes[i-1]`: u_i with the supremum over actions: the most that one wrong action at step i adds to the expert's
    /// cost-to-go, over the states that have probability there; 0 counts too.
    pub stakes: Vec<f64>,
    /// `printed_stakes[i-1]`: u_i with the supremum over the single policy pi_i, as the paper reads for the class Pi =
    /// {pi_i}.
    pub printed_stakes: Vec<f64>,
    /// `visits[i-1]`: d^i of pi^{i-1} over states, which is also d^i of pi^T.
    pub visits: Vec<Array1<f64>>,
    /// J* + sum eps_i u_i.
    pub bound: f64,
    /// Whether pi_1, ..., pi_T are all deterministic: the printed u_i needs that.
    pub deterministic: bool,
}

impl Forward {
    /// Follows `tables[i-1]` = pi_i, one a step: O(T S^2 A).
    ///
    /// # Errors
    /// A table of the wrong shape, or fewer tables than steps.
    pub fn of(mdp: &Mdp, tables: &[Table]) -> Result<Self> {
        let tables = scheduled(mdp, tables)?;
        let star = mdp.star();
        let expert = evaluate(mdp, &star)?;
        let visits = super::evaluate::visits(mdp, &tables);
        let mut forward = Forward {
            costs: vec![expert.cost],
            disadvantages: Vec::new(),
            errors: Vec::new(),
            stakes: Vec::new(),
            printed_stakes: Vec::new(),
            visits: visits.outer_iter().map(|row| row.to_owned()).collect(),
            bound: expert.cost,
            deterministic: tables.iter().all(|table| table.is_deterministic()),
        };
        // What the first i steps cost, under the tables.
        let mut spent = 0.0;
        for (i, table) in tables.iter().enumerate() {
            let now = visits.row(i);
            let before = spent + now.dot(&expert.value.row(i));
            let taken = (table.rows() * &expert.action_value.index_axis(Axis(0), i)).sum_axis(Axis(1));
            let after = spent + now.dot(&taken);
            let error = now.dot(&mdp.errors(table));
            let stake = stake(&expert, i, &forward.visits[i]);
            let printed = now.iter().zip(&taken - &expert.value.row(i)).filter(|(p, _)| **p > 0.0);
            forward.printed_stakes.push(printed.map(|(_, gap)| gap).fold(0.0, f64::max));
            forward.costs.push(after);
            forward.disadvantages.push(after - before);
            forward.errors.push(error);
            forward.stakes.push(stake);
            forward.bound += error * stake;
            spent += now.dot(&mdp.charge(table));
        }
        Ok(forward)
    }

    /// J(pi*).
    pub fn expert_cost(&self) -> f64 {
        self.costs.first().copied().unwrap_or(f64::NAN)
    }

    /// J(pi^T).
    pub fn last(&self) -> f64 {
        self.costs.last().copied().unwrap_or(f64::NAN)
    }
}

/// u_t: the largest max_a Q*(s,a) - V*(s) at step t over states that have probability, at least 0.
fn stake(expert: &Evaluation, t: usize, visits: &Array1<f64>) -> f64 {
    let mut largest = 0.0f64;
    for (s, _) in visits.iter().enumerate().filter(|(_, p)| **p > 0.0) {
        let row = expert.action_value.index_axis(Axis(0), t);
        largest = row.row(s).iter().fold(largest, |worst, q| worst.max(q - expert.value[[t, s]]));
    }
    largest
}
