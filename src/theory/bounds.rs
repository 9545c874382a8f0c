//! Every bound of Ross & Bagnell (2010) on exact values: one function a theorem, each giving left side, right side and
//! slack.
//!
//! Where the printed statement needs a hypothesis the bound carries it, true or not; where it is not needed its name
//! says so. Where a printed statement is weaker than what its proof gives, or leaves constants open, the stronger form
//! stands beside it.
//!
//! # Proofs
//!
//! *Theorem 2.1.* Run learner and expert with the same randomness until they first choose differently. At step t they do so for
//! the first time with probability at most e_t, the learner's error under the expert's own states, and what follows
//! costs at most T-t+1 more. Summing gives the sharp form; T-t+1 <= T gives the printed one.
//!
//! *Theorem 3.1.* pi^n differs from pi^{n-1} at step n only, so the disadvantages telescope. With u_i the most that one wrong
//! action at step i can cost while the expert acts after it, a disadvantage is at most eps_i u_i. The supremum must be over
//! actions: over stochastic policies alone it would count the error mass twice.
//!
//! *Lemma 4.1.* How often the new policy acts in T steps is binomial, and given the number, when is uniform: one round's change of J is the
//! binomial mean of the A_i. Its orders above k have probability at most C(T,k+1) a^{k+1}, by a union bound over sets of
//! k+1 steps, and cost at most T each. Nothing here needs a <= 1/T.
//!
//! *Lemma 4.2.* Couple pi^n with pitilde^n until the expert is first drawn, at step t with probability p(1-p)^{t-1}; what follows costs at most
//! T-t+1 more. The sum is T - sum_t (1-p)^t, at most pT(T+1)/2, at most pT^2.
//!
//! *Theorem 4.1 and the form without tail.* hat^n and pi^{n-1} choose differently in state s with probability at most p_{n-1} e(s), and a
//! step is among k uniform ones with probability k/T. Coupling as for Theorem 2.1 gives A_k <= (k/T) p_{n-1} W_n, with
//! W_n = sum_t e_t (T-t+1) <= T^2 eps_n. Lemma 4.1 at k = 2, with this for A_2 and A_1 as it is, and Lemma 4.2 give the explicit form
//! of Theorem 4.1. Using it for every k >= 2 leaves no tail, since sum_{k>=2} C(T,k) a^k (1-a)^{T-k} k/T = a (1 - (1-a)^{T-1}).
//!
//! *By the performance difference lemma* (Kakade & Langford 2002). J(pi^n) - J(pi^{n-1}) is a p_{n-1} times the sum over t of the mean under
//! d^t of pi^n of the advantage of hat*^n over the expert, at most T-t+1 in size. The two policies' d^t differ by at most
//! a p_{n-1} sum_{i<t} e_i in total variation; replacing one by the other and summing over t and n gives the bound. At
//! alpha = 1/T^2 its second term is at most (T-1) eps~, and p_N <= 1/T^2 pays for dropping the expert.
//!
//! *SEARN and CPI.* Lemma 4.1 at k = 1 with Lemma 4.2; and the same performance difference, with b for a p_{n-1} e_i, summed over the
//! steps: b^2 T(T^2-1)/3.

use super::closed::{alpha_printed, kept, rounds_printed, tail};
use super::evaluate::evaluate;
use super::forward::Forward;
use super::mdp::Mdp;
use super::mixing::{Mixing, Smile};
use super::table::Table;
use crate::error::Result;
use serde::Serialize;

/// lhs <= rhs, under hypotheses.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bound {
    /// Which statement.
    pub name: String,
    /// What is bounded.
    pub lhs: f64,
    /// By what.
    pub rhs: f64,
    /// rhs - lhs.
    pub slack: f64,
    /// What the statement assumes, and whether it is so here.
    pub hypotheses: Vec<(String, bool)>,
}

impl Bound {
    fn new(name: impl Into<String>, lhs: f64, rhs: f64) -> Self {
        Bound { name: name.into(), lhs, rhs, slack: rhs - lhs, hypotheses: Vec::new() }
    }

    fn given(mut self, hypothesis: &str, so: bool) -> Self {
        self.hypotheses.push((hypothesis.into(), so));
        self
    }

    /// Whether every hypothesis is so.
    pub fn applies(&self) -> bool {
        self.hypotheses.iter().all(|(_, so)| *so)
    }

    /// Whether lhs <= rhs up to rounding: 1e-12 of the larger side, at least of 1.
    pub fn holds(&self) -> bool {
        self.slack >= -1e-12 * self.lhs.abs().max(self.rhs.abs()).max(1.0)
    }
}

/// Theorem 2.1: J(pi) <= J(pi*) + T^2 eps, eps the 0-1 loss under the expert's states.
///
/// # Errors
/// A table of the wrong shape.
pub fn theorem_2_1(mdp: &Mdp, policy: &Table) -> Result<Bound> {
    let (own, star) = (evaluate(mdp, policy)?, evaluate(mdp, &mdp.star())?);
    let eps = star.mean().dot(&mdp.errors(policy));
    let horizon = mdp.horizon() as f64;
    Ok(Bound::new("Theorem 2.1", own.cost, star.cost + horizon * horizon * eps))
}

/// Theorem 2.1, sharper: J(pi) <= J(pi*) + sum_t e_t (T-t+1), e_t the 0-1 loss under d^t of the expert.
///
/// # Errors
/// A table of the wrong shape.
pub fn theorem_2_1_sharp(mdp: &Mdp, policy: &Table) -> Result<Bound> {
    let (own, star) = (evaluate(mdp, policy)?, evaluate(mdp, &mdp.star())?);
    let by_step = star.visits.dot(&mdp.errors(policy));
    let refined: f64 = by_step.iter().enumerate().map(|(t, e)| e * (mdp.horizon() - t) as f64).sum();
    Ok(Bound::new("Theorem 2.1, sharper: sum e_t (T-t+1)", own.cost, star.cost + refined))
}

/// Theorem 3.1, an identity: J(pi^T) = J(pi*) + sum_i A(pi^{i-1}, pi_i^i).
pub fn theorem_3_1(forward: &Forward) -> Bound {
    let sum: f64 = forward.disadvantages.iter().sum();
    Bound::new("Theorem 3.1 (an identity)", forward.last(), forward.expert_cost() + sum)
}

/// Section 3: J(pi^T) <= J(pi*) + sum eps_i u_i, u_i the supremum over actions.
pub fn forward_stakes(forward: &Forward) -> Bound {
    Bound::new("Section 3: sum eps_i u_i, u_i over actions", forward.last(), forward.bound)
}

/// Section 3 as printed, u_i the supremum over the policies of a class, here of the class of the one policy pi_i.
/// It is false for stochastic policies, whose error counts twice.
pub fn forward_printed(forward: &Forward) -> Bound {
    let sum: f64 = forward.errors.iter().zip(&forward.printed_stakes).map(|(eps, u)| eps * u).sum();
    let name = "Section 3 as printed: u_i over the class {pi_i}";
    Bound::new(name, forward.last(), forward.expert_cost() + sum)
        .given("every pi_i is deterministic", forward.deterministic)
}

/// Section 3, worst case: J(pi^T) <= J(pi*) + sum eps_i (T-i+1).
pub fn forward_worst(forward: &Forward) -> Bound {
    let horizon = forward.errors.len();
    let sum: f64 = forward.errors.iter().enumerate().map(|(i, eps)| eps * (horizon - i) as f64).sum();
    Bound::new("Section 3, worst case: sum eps_i (T-i+1)", forward.last(), forward.expert_cost() + sum)
}

/// Lemma 4.1 at order k, 1 <= k <= T, after n rounds. The printed hypothesis alpha <= 1/T is not needed; at k = T it is
/// an equality.
pub fn lemma_4_1(mixing: &Mixing, n: usize, k: usize) -> Bound {
    let n = n.min(mixing.rounds());
    let k = k.clamp(1, mixing.horizon());
    let bound = Bound::new(format!("Lemma 4.1, k = {k}"), mixing.cost(n), mixing.lemma_4_1(n)[k - 1]);
    bound.given("alpha <= 1/T (printed, not needed)", mixing.rate * mixing.horizon() as f64 <= 1.0)
}

/// Lemma 4.2 as printed: J(pitilde^n) <= J(pi^n) + p_n T^2, n >= 1.
pub fn lemma_4_2(mixing: &Mixing, n: usize) -> Bound {
    let [printed, ..] = mixing.lemma_4_2(n);
    Bound::new("Lemma 4.2", mixing.unsupervised_cost(n), mixing.cost(n) + printed)
}

/// Lemma 4.2 with the steps that are left when the expert first acts: J(pitilde^n) <= J(pi^n) + p_n T(T+1)/2, n >= 1.
pub fn lemma_4_2_half(mixing: &Mixing, n: usize) -> Bound {
    let [_, half, _] = mixing.lemma_4_2(n);
    Bound::new("Lemma 4.2, by the steps left: p T(T+1)/2", mixing.unsupervised_cost(n), mixing.cost(n) + half)
}

/// Lemma 4.2, sharp: J(pitilde^n) <= J(pi^n) + T - sum_{t<=T} (1-p_n)^t, n >= 1; attained by
/// [`rescue`](super::instances::rescue).
pub fn lemma_4_2_sharp(mixing: &Mixing, n: usize) -> Bound {
    let [_, _, sharp] = mixing.lemma_4_2(n);
    Bound::new("Lemma 4.2, sharp: T - sum (1-p)^t", mixing.unsupervised_cost(n), mixing.cost(n) + sharp)
}

/// Theorem 4.1 with explicit constants, for every alpha and n >= 1:
/// J(pitilde^n) <= J* + (1-p_n)(T(1-a)^{T-1} A~ + a T^2(T-1)(1-a)^{T-2} eps~) + n a^3 T C(T,3) + p_n T^2.
pub fn theorem_4_1(smile: &Smile, n: usize) -> Bound {
    let bounds = smile.bounds(n);
    Bound::new("Theorem 4.1, explicit constants", smile.mixing.unsupervised_cost(n), bounds.B_paper)
}

/// Theorem 4.1 at its printed alpha and N, with the constants that O() hides:
/// J(pitilde^N) <= J* + T max(A~,0) + sqrt(3/ln T) T eps~ + N a^3 T C(T,3) + p_N T^2; the last two are about sqrt(3)
/// and T^{2-2 sqrt(3)}.
pub fn theorem_4_1_printed(smile: &Smile, n: usize) -> Bound {
    let (bounds, mixing) = (smile.bounds(n), &smile.mixing);
    let horizon = mixing.horizon() as f64;
    let constant = n as f64 * tail(mixing.horizon(), mixing.rate, 3) * horizon + kept(mixing.rate, n) * horizon.powi(2);
    let spread = if horizon > 1.0 { (3.0 / horizon.ln()).sqrt() * horizon * bounds.eps_tilde } else { 0.0 };
    let rhs = mixing.expert_cost() + horizon * bounds.A_tilde.max(0.0) + spread + constant;
    let alpha = alpha_printed(mixing.horizon());
    Bound::new("Theorem 4.1 at the printed alpha and N", mixing.unsupervised_cost(n), rhs)
        .given("alpha is at most sqrt(3)/(T^2 sqrt(ln T))", mixing.rate <= alpha * (1.0 + 1e-12))
        .given("N >= 2 T^2 (ln T)^{3/2}", n as f64 >= rounds_printed(mixing.horizon()))
}

/// Stronger than Theorem 4.1, for every alpha and n >= 1: coupling at every order leaves no tail,
/// J(pitilde^n) <= J* + (1-p_n)(T(1-a)^{T-1} A~ + (1-(1-a)^{T-1}) W~) + p_n T(T+1)/2.
pub fn coupling(smile: &Smile, n: usize) -> Bound {
    Bound::new("Coupling at every order", smile.mixing.unsupervised_cost(n), smile.bounds(n).B_coup)
}

/// For every alpha and n >= 1, by the performance difference lemma:
/// J(pitilde^n) <= J* + T(1-p_n) A~ + a T^2(T-1) sum_j a p_{j-1}^2 eps_j + p_n T(T+1)/2.
pub fn difference(smile: &Smile, n: usize) -> Bound {
    Bound::new("Performance difference", smile.mixing.unsupervised_cost(n), smile.bounds(n).B_pdl)
}

/// A statement without O(): alpha = 1/T^2 and N >= 2 T^2 ln T give J(pitilde^N) <= J* + T(A~ + eps~) + (T+1)/(2T), for
/// either sign of A~.
pub fn inverse_square(smile: &Smile, n: usize) -> Bound {
    let (bounds, mixing) = (smile.bounds(n), &smile.mixing);
    let horizon = mixing.horizon() as f64;
    let square = horizon * horizon;
    let rhs = mixing.expert_cost() + horizon * (bounds.A_tilde + bounds.eps_tilde) + (horizon + 1.0) / (2.0 * horizon);
    Bound::new("alpha = 1/T^2: T(A~ + eps~) + (T+1)/(2T)", mixing.unsupervised_cost(n), rhs)
        .given("alpha <= 1/T^2", mixing.rate * square <= 1.0 + 1e-12)
        .given("p_N <= 1/T^2", kept(mixing.rate, n) * square <= 1.0 + 1e-12)
}

/// SEARN: J(pitilde^n) <= J* + n b T(1-b)^{T-1} Abar_1 + n b^2 T C(T,2) + p_n T^2, n >= 1: Lemma 4.1 at k = 1 and Lemma
/// 4.2.
pub fn searn(mixing: &Mixing, n: usize) -> Bound {
    let n = n.min(mixing.rounds());
    let rhs = mixing.lemma_4_1(n)[0] + mixing.lemma_4_2(n)[0];
    Bound::new("SEARN: Lemma 4.1 at k = 1 and Lemma 4.2", mixing.unsupervised_cost(n), rhs)
}

/// CPI: J(pi^n) <= J* + sum_j (b T A_1(pi^{j-1}, h_j) + b^2 T(T^2-1)/3).
pub fn conservative(mixing: &Mixing, n: usize) -> Bound {
    Bound::new("CPI: b T A_1 + b^2 T(T^2-1)/3 a round", mixing.cost(n), mixing.conservative(n))
}

/// The step b* = -3 A_1/(2(T^2-1)) that makes CPI's bound least, and the improvement 3T A_1^2/(4(T^2-1)) that it
/// promises; nothing unless A_1 < 0 and T > 1. A step above 1 is taken as 1, and promises what the bound gives there.
pub fn safe_step(disadvantage: f64, horizon: usize) -> Option<(f64, f64)> {
    let horizon = horizon as f64;
    if disadvantage >= 0.0 || disadvantage.is_nan() || horizon <= 1.0 {
        return None;
    }
    let step = (-1.5 * disadvantage / (horizon * horizon - 1.0)).min(1.0);
    let change = step * horizon * disadvantage + step * step * horizon * (horizon * horizon - 1.0) / 3.0;
    Some((step, -change))
}

/// The bounds of Section 3.
pub fn of_forward(forward: &Forward) -> Vec<Bound> {
    vec![theorem_3_1(forward), forward_stakes(forward), forward_printed(forward), forward_worst(forward)]
}

/// The bounds of SMILe after all its rounds, nothing if there are none.
pub fn of_smile(smile: &Smile) -> Vec<Bound> {
    let (mixing, n) = (&smile.mixing, smile.mixing.rounds());
    if n == 0 {
        return Vec::new();
    }
    let mut bounds: Vec<Bound> = (1..=mixing.horizon().min(3)).map(|k| lemma_4_1(mixing, n, k)).collect();
    bounds.extend([lemma_4_2(mixing, n), lemma_4_2_half(mixing, n), lemma_4_2_sharp(mixing, n)]);
    bounds.extend([
        theorem_4_1(smile, n),
        theorem_4_1_printed(smile, n),
        coupling(smile, n),
        difference(smile, n),
        inverse_square(smile, n),
    ]);
    bounds.iter_mut().for_each(|bound| bound.name.insert_str(0, "SMILe: "));
    bounds
}

/// The bounds of SEARN after all its rounds, nothing if there are none.
pub fn of_searn(mixing: &Mixing) -> Vec<Bound> {
    let n = mixing.rounds();
    if n == 0 {
        return Vec::new();
    }
    vec![searn(mixing, n), conservative(mixing, n)]
}
