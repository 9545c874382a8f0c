//! Everything that can be said exactly about an [`Instance`], as one object that serialises to JSON.
//!
//! Lists that start with the expert have it at index 0; where there is nothing to say at index 0 (a policy that never asks
//! the expert, before the first round) stands `null`. Array order: `[n][t][s]`, rounds before steps before states.

use super::evaluate::evaluate;
use super::forward::Forward;
use super::instance::Instance;
use super::korder::orders;
use super::mdp::Mdp;
use super::table::Table;
use crate::error::Result;
use ndarray::Array2;
use serde::Serialize;

/// Rows of numbers.
pub type Rows = Vec<Vec<f64>>;

/// What an instance allows to be computed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Audit {
    /// The expert, one stationary policy and one policy a step.
    pub eval: Option<Eval>,
    /// Forward training with the given policies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forward: Option<ForwardGroup>,
    /// k-th order quantities of the first classifier with respect to the stationary policy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub korder: Option<Korder>,
    /// Why a group is not there.
    pub left_out: Vec<String>,
}

/// Exact evaluation.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[allow(non_snake_case)]
pub struct Eval {
    /// J of the expert.
    pub J_star: f64,
    /// d of the expert, by state.
    pub d_star: Vec<f64>,
    /// What the stationary policy does.
    #[serde(flatten)]
    pub stationary: Option<Stationary>,
    /// J of one policy a step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub J_ns: Option<f64>,
}

/// Exact evaluation of a stationary policy.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[allow(non_snake_case)]
pub struct Stationary {
    /// J(pi).
    pub J: f64,
    /// d^t_pi(s), `[t][s]`.
    pub d_t: Rows,
    /// d_pi(s).
    pub d: Vec<f64>,
    /// 0-1 loss under the expert's states.
    pub eps: f64,
    /// 0-1 loss under its own states.
    pub e_own: f64,
    /// T^2 eps - (J - J*): what Theorem 2.1 gives away.
    pub thm21_gap: f64,
    /// sum_t e_t (T-t+1): the sharper form of the bound on J - J*.
    pub thm21_refined_bound: f64,
}

/// Forward training.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[allow(non_snake_case)]
pub struct ForwardGroup {
    /// J(pi^i), i = 0, ..., T.
    pub J: Vec<f64>,
    /// A(pi^{i-1}, pi_i^i), i = 1, ..., T.
    pub adv: Vec<f64>,
    /// eps_i.
    pub eps: Vec<f64>,
    /// u_i, the supremum taken over actions.
    pub u: Vec<f64>,
    /// J* + sum eps_i u_i.
    pub bound: f64,
    /// d^i of pi^{i-1}, `[i][s]`.
    pub d_i: Rows,
}

/// k-th order quantities, k = 0, ..., T.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[allow(non_snake_case)]
pub struct Korder {
    /// The policy that acts at the T-k steps.
    pub base: String,
    /// The policy that acts at the k steps.
    pub alt: String,
    /// Jbar_k.
    pub Jbar: Vec<f64>,
    /// A_k.
    pub A: Vec<f64>,
    /// D_k, `[k][s]`.
    pub D: Rows,
}

/// Computes every group that the instance has the inputs of.
///
/// # Errors
/// A table of the wrong shape; an instance that was read has none.
pub fn audit(instance: &Instance) -> Result<Audit> {
    let mut audit = Audit { eval: Some(eval(instance)?), ..Audit::default() };
    match &instance.ladder {
        Some(ladder) => audit.forward = Some(forward(&instance.mdp, ladder)?),
        None => audit.left_out.push("forward: the instance has no pis".into()),
    }
    match (&instance.policy, instance.hats.as_ref().and_then(|hats| hats.first())) {
        (Some(policy), Some(hat)) => audit.korder = Some(korder(&instance.mdp, policy, hat)?),
        _ => audit.left_out.push("korder: the instance has no pi or no hats".into()),
    }
    Ok(audit)
}

fn eval(instance: &Instance) -> Result<Eval> {
    let mdp = &instance.mdp;
    let star = evaluate(mdp, &mdp.star())?;
    let stationary = instance.policy.as_ref().map(|policy| stationary(mdp, policy, &star)).transpose()?;
    let per_step = instance.ladder.as_ref().map(|ladder| evaluate(mdp, ladder.as_slice())).transpose()?;
    Ok(Eval { J_star: star.cost, d_star: star.mean().to_vec(), stationary, J_ns: per_step.map(|own| own.cost) })
}

fn stationary(mdp: &Mdp, policy: &Table, star: &super::Evaluation) -> Result<Stationary> {
    let own = evaluate(mdp, policy)?;
    let errors = mdp.errors(policy);
    let (horizon, mean) = (mdp.horizon(), own.mean());
    let eps = star.mean().dot(&errors);
    let by_step = star.visits.dot(&errors);
    let refined: f64 = by_step.iter().enumerate().map(|(t, e)| e * (horizon - t) as f64).sum();
    Ok(Stationary {
        J: own.cost,
        d_t: rows(&own.visits),
        eps,
        e_own: mean.dot(&errors),
        d: mean.to_vec(),
        thm21_gap: (horizon * horizon) as f64 * eps - (own.cost - star.cost),
        thm21_refined_bound: refined,
    })
}

fn forward(mdp: &Mdp, ladder: &[Table]) -> Result<ForwardGroup> {
    let forward = Forward::of(mdp, ladder)?;
    Ok(ForwardGroup {
        J: forward.costs,
        adv: forward.disadvantages,
        eps: forward.errors,
        u: forward.stakes,
        bound: forward.bound,
        d_i: forward.visits.iter().map(|row| row.to_vec()).collect(),
    })
}

fn korder(mdp: &Mdp, policy: &Table, hat: &Table) -> Result<Korder> {
    let orders = orders(mdp, policy, hat)?;
    Ok(Korder {
        base: "pi".into(),
        alt: "hats[0]".into(),
        Jbar: orders.costs,
        A: orders.disadvantages,
        D: rows(&orders.frequencies),
    })
}

/// The rows of a matrix.
pub(super) fn rows(matrix: &Array2<f64>) -> Rows {
    matrix.outer_iter().map(|row| row.to_vec()).collect()
}
