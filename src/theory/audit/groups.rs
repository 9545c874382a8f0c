//! The groups of an audit, with the keys of its JSON.

use crate::theory::mixing::SmileBounds;
use serde::Serialize;

/// Rows of numbers.
pub type Rows = Vec<Vec<f64>>;

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

/// The laws of [`Reuse`](crate::theory::reuse::Reuse).
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
