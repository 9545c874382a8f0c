//! Everything that can be said exactly about an [`Instance`], as one object that serialises to JSON.
//!
//! Lists that start with the expert have it at index 0; where there is nothing to say at index 0 (a policy that never
//! asks the expert, before the first round) stands `null`. Array order: `[n][t][s]`, rounds before steps before states.

mod groups;

pub use groups::{
    Eval, ForwardGroup, Korder, Population, PopulationCosts, ReuseGroup, Rows, SearnGroup, SmileGroup, Stationary,
};

use crate::theory::bounds::{self, Bound};
use crate::theory::counts::{Counts, Plan};
use crate::theory::forward::Forward;
use crate::theory::instance::Instance;
use crate::theory::korder::orders;
use crate::theory::mixing::{Mixer, Mixing, Proposal, Smile};
use crate::theory::population::{Choice, Class};
use crate::theory::reuse::Reuse;
use crate::theory::{Evaluation, Mdp, Table, evaluate};

use crate::error::Result;
use ndarray::{Array2, Array3};
use serde::Serialize;

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
    /// Every bound that applies to what the instance has.
    pub theorems: Vec<Bound>,
    /// Why a group is not there.
    pub left_out: Vec<String>,
}

/// The most numbers that a law of reuse by round, number of classifier steps, step and state, N T (T+1) S, may have in
/// an audit; beyond it laws are averaged over the steps.
pub const MOST_NUMBERS: usize = 400_000;

/// Computes every group that the instance has the inputs of: O(N T S (A S + T S + T^2)), and N^2 for the variances of
/// the counts. Most of it is the laws of reuse. Memory: O(N T S A), and O(N T^2 S) while laws are given by step.
///
/// # Errors
/// A table of the wrong shape; an instance that was read has none.
pub fn audit(instance: &Instance) -> Result<Audit> {
    let mut audit = Audit { eval: Some(eval(instance)?), ..Audit::default() };
    if let Some(policy) = &instance.policy {
        audit.theorems.push(bounds::theorem_2_1(&instance.mdp, policy)?);
        audit.theorems.push(bounds::theorem_2_1_sharp(&instance.mdp, policy)?);
    }
    match &instance.ladder {
        Some(ladder) => {
            let forward = Forward::of(&instance.mdp, ladder)?;
            audit.theorems.extend(bounds::of_forward(&forward));
            audit.forward = Some(self::forward(forward));
        }
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
    audit.reuse = Some(reuse(if numbers <= MOST_NUMBERS {
        Reuse::of(mdp, &smile.mixing, hats)?
    } else {
        audit.left_out.push(format!(
            "reuse, laws by step: {numbers} numbers a law (N T (T+1) S), more than {MOST_NUMBERS}; laws are averaged \
             over the steps, as one row each, and d_k, d_43_fresh_paper, d_43_fresh_exact are empty but for the last \
             round"
        ));
        Reuse::means(mdp, &smile.mixing, hats)?
    }));
    audit.smile = Some(self::smile(&smile));
    let searn = Mixing::of(mdp, Proposal::Searn, hats, rate)?;
    audit.theorems.extend(bounds::of_smile(&smile));
    audit.theorems.extend(bounds::of_searn(&searn));
    audit.searn = Some(self::searn(&searn));
    Ok(())
}

fn eval(instance: &Instance) -> Result<Eval> {
    let mdp = &instance.mdp;
    let star = evaluate(mdp, &mdp.star())?;
    let stationary = instance.policy.as_ref().map(|policy| stationary(mdp, policy, &star)).transpose()?;
    let per_step = instance.ladder.as_ref().map(|ladder| evaluate(mdp, ladder.as_slice())).transpose()?;
    Ok(Eval { J_star: star.cost, d_star: star.mean().to_vec(), stationary, J_ns: per_step.map(|own| own.cost) })
}

fn stationary(mdp: &Mdp, policy: &Table, star: &Evaluation) -> Result<Stationary> {
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

fn forward(forward: Forward) -> ForwardGroup {
    ForwardGroup {
        J: forward.costs,
        adv: forward.disadvantages,
        eps: forward.errors,
        u: forward.stakes,
        bound: forward.bound,
        d_i: forward.visits.iter().map(|row| row.to_vec()).collect(),
    }
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
        let mut mixer = Mixer::new(mdp, proposal, rate)?;
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
