//! Everything that can be said exactly about an [`Instance`], as one object that serialises to JSON.
//!
//! Lists that start with the expert have it at index 0; where there is nothing to say at index 0 (a policy that never asks
//! the expert, before the first round) stands `null`. Array order: `[n][t][s]`, rounds before steps before states.

use super::counts::{Counts, Plan};
use super::evaluate::evaluate;
use super::forward::Forward;
use super::instance::Instance;
use super::korder::orders;
use super::mdp::Mdp;
use super::mixing::{Mixing, Proposal, Smile, SmileBounds};
use super::population::{Choice, Class};
use super::reuse::Reuse;
use super::table::Table;
use crate::error::Result;
use ndarray::{Array2, Array3};
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
    /// SMILe with the given classifiers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smile: Option<SmileGroup>,
    /// SEARN with the given classifiers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub searn: Option<SearnGroup>,
    /// The laws of SMILe's data sets when samples are reused.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reuse: Option<ReuseGroup>,
    /// Expected expert queries.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub counts: Option<Counts>,
    /// The best classifiers of the restricted class.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub population: Option<Population>,
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

/// SMILe; index n of a list from 0, j-1 of the others.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[allow(non_snake_case)]
pub struct SmileGroup {
    /// p_n, from 0.
    pub p: Vec<f64>,
    /// The weights of pi^N: the expert's first.
    pub weights: Vec<f64>,
    /// The weights of pitilde^N.
    pub tilde_weights: Vec<f64>,
    /// J(pi^n), from 0.
    pub J_pi: Vec<f64>,
    /// J(pitilde^n), from 0.
    pub J_tilde: Vec<Option<f64>>,
    /// pi^N, `[s][a]`.
    pub pi_N: Rows,
    /// pitilde^N.
    pub tilde_N: Rows,
    /// eps_j.
    pub eps: Vec<f64>,
    /// A_1(pi^{j-1}, hat*^j | pi*).
    pub A1_given_star: Vec<f64>,
    /// A_1(pi^{j-1}, hat^j) = p_{j-1} A_1(pi^{j-1}, hat*^j | pi*).
    pub A1_hat: Vec<f64>,
    /// A_k(pi^{j-1}, hat^j), `[j-1][k]`.
    pub Ak: Rows,
    /// Lemma 4.1's right side, `[n-1][k-1]`.
    pub lemma41_rhs: Rows,
    /// The right sides of the bounds, from 0.
    pub bounds: Vec<Option<SmileBounds>>,
    /// The least n with p_n <= 1/T^2.
    pub n_to_T2: f64,
}

/// SEARN; index n of a list from 0, j-1 of the others.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[allow(non_snake_case)]
pub struct SearnGroup {
    /// The weights of pi^n, from 0: the expert's first.
    pub weights: Rows,
    /// The weights of pitilde^N.
    pub tilde_weights: Vec<f64>,
    /// J(pi^n), from 0.
    pub J_pi: Vec<f64>,
    /// J(pitilde^n), from 0.
    pub J_tilde: Vec<Option<f64>>,
    /// A_k(pi^{j-1}, h_j), `[j-1][k]`.
    pub A: Rows,
    /// Lemma 4.1's right side at k = 1, after n = 1, ..., N rounds.
    pub rhs_lemma41_k1: Vec<f64>,
    /// The right side of conservative policy iteration's bound.
    pub rhs_cpi: Vec<f64>,
}

/// The laws of [`Reuse`].
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ReuseGroup {
    /// beta_n.
    pub beta: Vec<f64>,
    /// c_{n,k}, `[n-1][k]`.
    pub c: Rows,
    /// The expected share of new trajectories of Algorithm 4.2.
    pub new_frac42: Vec<f64>,
    /// That of Algorithm 4.3.
    pub new_frac43: Vec<f64>,
    /// d of pi^n, from 0, `[n][t][s]`.
    pub d_true: Vec<Rows>,
    /// The data set of Algorithm 4.2 if the last one was right.
    pub d_42_paper_onestep: Vec<Rows>,
    /// The data set of Algorithm 4.2, from 0.
    pub d_42_paper_chain: Vec<Rows>,
    /// A new trajectory of Algorithm 4.2.
    pub d_42_fresh_paper: Vec<Rows>,
    /// A new trajectory of Algorithm 4.2 repaired.
    pub d_42_fresh_exact: Vec<Rows>,
    /// The right side of Lemma 4.3.
    pub d_43_lemma_rhs: Vec<Rows>,
    /// The data set of Algorithm 4.3, from 0.
    pub d_43_paper_chain: Vec<Rows>,
    /// A new trajectory of Algorithm 4.3, `[n-1][k-1][t][s]`.
    pub d_43_fresh_paper: Vec<Vec<Rows>>,
    /// A new trajectory of Algorithm 4.3 repaired.
    pub d_43_fresh_exact: Vec<Vec<Rows>>,
    /// D_k^{pi*}(pitilde^n), `[n-1][k][t][s]`.
    pub d_k: Vec<Vec<Rows>>,
}

/// Training with infinitely many samples: tables, then margins.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[allow(non_snake_case)]
pub struct Population {
    /// One table and its margin.
    pub supervised: (Rows, f64),
    /// One table a step.
    pub forward: (Vec<Rows>, Vec<f64>),
    /// One table a round.
    pub smile: (Vec<Rows>, Vec<f64>),
    /// One table a round.
    pub searn: (Vec<Rows>, Vec<f64>),
    /// What the results cost.
    pub J: PopulationCosts,
}

/// Exact costs of the policies that population training ends with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PopulationCosts {
    /// Of the one classifier.
    pub supervised: f64,
    /// Of the classifiers, one a step.
    pub forward: f64,
    /// Of SMILe's pitilde^N.
    pub smile_tilde: f64,
    /// Of SEARN's pitilde^N.
    pub searn_tilde: f64,
}

/// The most numbers that the laws of reuse may have in an audit; beyond it they are left out.
pub const MOST_NUMBERS: usize = 4_000_000;

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
    match (&instance.hats, instance.rate) {
        (Some(hats), Some(rate)) => mixtures(&mut audit, &instance.mdp, hats, rate)?,
        _ => audit.left_out.push("smile, searn, reuse: the instance has no hats or no alpha".into()),
    }
    match (instance.samples, instance.rollouts, instance.rounds, instance.rate) {
        (Some(samples), Some(rollouts), Some(rounds), Some(rate)) => {
            let (horizon, actions) = (instance.mdp.horizon(), instance.mdp.actions());
            audit.counts =
                Some(Counts::of(&Plan { horizon, actions, rounds, alpha: rate, beta: rate, samples, rollouts }));
        }
        _ => audit.left_out.push("counts: the instance has no m, k_roll, N (or hats) or alpha".into()),
    }
    match (&instance.view, instance.rounds, instance.rate) {
        (Some(view), Some(rounds), Some(rate)) => {
            audit.population = Some(population(&instance.mdp, view, rounds, rate)?);
        }
        _ => audit.left_out.push("population: the instance has no phi, N (or hats) or alpha".into()),
    }
    Ok(audit)
}

/// SMILe, SEARN and the laws of reuse.
fn mixtures(audit: &mut Audit, mdp: &Mdp, hats: &[Table], rate: f64) -> Result<()> {
    let smile = Smile::of(mdp, hats, rate)?;
    let numbers = [hats.len(), mdp.horizon() + 1, mdp.horizon(), mdp.states()];
    let numbers = numbers.iter().fold(1usize, |product, n| product.saturating_mul(*n));
    if numbers <= MOST_NUMBERS {
        audit.reuse = Some(reuse(Reuse::of(mdp, &smile.mixing, hats)?));
    } else {
        audit.left_out.push(format!("reuse: {numbers} numbers a law (N T (T+1) S), more than {MOST_NUMBERS}"));
    }
    audit.smile = Some(self::smile(&smile));
    audit.searn = Some(searn(&Mixing::of(mdp, Proposal::Searn, hats, rate)?));
    Ok(())
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

fn smile(smile: &Smile) -> SmileGroup {
    let mixing = &smile.mixing;
    let rounds = mixing.rounds();
    SmileGroup {
        p: mixing.kept.clone(),
        weights: mixing.weights(rounds),
        tilde_weights: mixing.unsupervised_weights(rounds),
        J_pi: mixing.evaluations.iter().map(|evaluation| evaluation.cost).collect(),
        J_tilde: from_zero(mixing.unsupervised_costs.iter().copied()),
        pi_N: mixing.policies.last().map(|table| rows(table.rows())).unwrap_or_default(),
        tilde_N: mixing.unsupervised.last().map(|table| rows(table.rows())).unwrap_or_default(),
        eps: smile.errors.clone(),
        A1_given_star: smile.given_expert.clone(),
        A1_hat: mixing.orders.iter().map(|orders| orders.disadvantages[1]).collect(),
        Ak: mixing.orders.iter().map(|orders| orders.disadvantages.clone()).collect(),
        lemma41_rhs: (1..=rounds).map(|n| mixing.lemma_4_1(n)).collect(),
        bounds: from_zero((1..=rounds).map(|n| smile.bounds(n))),
        n_to_T2: mixing.rounds_wanted(),
    }
}

fn searn(mixing: &Mixing) -> SearnGroup {
    let rounds = mixing.rounds();
    SearnGroup {
        weights: (0..=rounds).map(|n| mixing.weights(n)).collect(),
        tilde_weights: mixing.unsupervised_weights(rounds),
        J_pi: mixing.evaluations.iter().map(|evaluation| evaluation.cost).collect(),
        J_tilde: from_zero(mixing.unsupervised_costs.iter().copied()),
        A: mixing.orders.iter().map(|orders| orders.disadvantages.clone()).collect(),
        rhs_lemma41_k1: (1..=rounds).map(|n| mixing.lemma_4_1(n)[0]).collect(),
        rhs_cpi: (1..=rounds).map(|n| mixing.conservative(n)).collect(),
    }
}

fn reuse(reuse: Reuse) -> ReuseGroup {
    let matrices = |list: &[Array2<f64>]| list.iter().map(rows).collect();
    let cubes = |list: &[Array3<f64>]| {
        let cube = |cube: &Array3<f64>| cube.outer_iter().map(|matrix| rows(&matrix.to_owned())).collect();
        list.iter().map(cube).collect()
    };
    ReuseGroup {
        d_true: matrices(&reuse.truth),
        d_42_paper_onestep: matrices(&reuse.onestep42),
        d_42_paper_chain: matrices(&reuse.chain42),
        d_42_fresh_paper: matrices(&reuse.printed42),
        d_42_fresh_exact: matrices(&reuse.exact42),
        d_43_lemma_rhs: matrices(&reuse.lemma43),
        d_43_paper_chain: matrices(&reuse.chain43),
        d_43_fresh_paper: cubes(&reuse.printed43),
        d_43_fresh_exact: cubes(&reuse.exact43),
        d_k: cubes(&reuse.by_count),
        beta: reuse.older,
        c: reuse.split,
        new_frac42: reuse.fresh42,
        new_frac43: reuse.fresh43,
    }
}

fn population(mdp: &Mdp, view: &[usize], rounds: usize, rate: f64) -> Result<Population> {
    let class = Class::new(mdp, view)?;
    let (supervised, margin) = class.supervised()?;
    let (forward, smile, searn) = (class.forward(), class.smile(rate, rounds)?, class.searn(rate, rounds)?);
    let mixed = |proposal, choices: &[Choice]| -> Result<f64> {
        let mut mixer = super::mixing::Mixer::new(mdp, proposal, rate)?;
        choices.iter().for_each(|(table, _)| drop(mixer.advance(table)));
        Ok(evaluate(mdp, mixer.unsupervised().unwrap_or(mixer.policy()))?.cost)
    };
    let ladder: Vec<&Table> = forward.iter().map(|(table, _)| table).collect();
    let listed = |choices: &[Choice]| choices.iter().map(|(table, margin)| (rows(table.rows()), *margin)).unzip();
    Ok(Population {
        J: PopulationCosts {
            supervised: evaluate(mdp, &supervised)?.cost,
            forward: evaluate(mdp, ladder.as_slice())?.cost,
            smile_tilde: mixed(Proposal::Smile, &smile)?,
            searn_tilde: mixed(Proposal::Searn, &searn)?,
        },
        supervised: (rows(supervised.rows()), margin),
        forward: listed(&forward),
        smile: listed(&smile),
        searn: listed(&searn),
    })
}

/// A list that has nothing to say of the expert.
fn from_zero<N>(later: impl Iterator<Item = N>) -> Vec<Option<N>> {
    std::iter::once(None).chain(later.map(Some)).collect()
}

/// The rows of a matrix.
pub(super) fn rows(matrix: &Array2<f64>) -> Rows {
    matrix.outer_iter().map(|row| row.to_vec()).collect()
}
