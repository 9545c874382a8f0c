//! Stochastic mixing (Section 4): pi^n = (1-a) pi^{n-1} + a hat^n from pi^0 = pi*, exactly, with given classifiers.
//!
//! SEARN's hat^n is its n-th classifier, SMILe's mimics pi^{n-1}: hat^n = p_{n-1} hat*^n + (1-p_{n-1}) pitilde^{n-1}.
//! In SMILe pi^n is then p_n pi* + sum_j a p_{j-1} hat*^j: weights stay as they are, where SEARN's old classifiers
//! fade.

use super::closed::{SLOWEST, choose, gone, kept, rounds, shares, tail};
use super::evaluate::{Evaluation, cost, evaluate};
use super::korder::{self, Costs};
use super::mdp::Mdp;
use super::table::Table;
use crate::error::{Error, Result};

/// Which policy a round mixes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proposal {
    /// SMILe, Algorithm 4.1: the new classifier in the expert's place.
    Smile,
    /// SEARN and CPI: the new classifier.
    Searn,
}

/// The policies of stochastic mixing, round by round.
#[derive(Clone, Debug)]
pub struct Mixer {
    proposal: Proposal,
    rate: f64,
    n: usize,
    star: Table,
    policy: Table,
    unsupervised: Option<Table>,
}

impl Mixer {
    /// Round 0: the expert.
    ///
    /// # Errors
    /// A rate outside \[1e-15, 1\].
    pub fn new(mdp: &Mdp, proposal: Proposal, rate: f64) -> Result<Self> {
        if !(SLOWEST..=1.0).contains(&rate) {
            return Err(Error::argument("rate", rate, format!("from {SLOWEST:e} to 1")));
        }
        Ok(Mixer { proposal, rate, n: 0, star: mdp.star(), policy: mdp.star(), unsupervised: None })
    }

    /// pi^n.
    pub fn policy(&self) -> &Table {
        &self.policy
    }

    /// pitilde^n, from the first round on.
    pub fn unsupervised(&self) -> Option<&Table> {
        self.unsupervised.as_ref()
    }

    /// One more round, whose classifier is `hat`; gives hat^n. The classifier fits the problem.
    pub(super) fn advance(&mut self, hat: &Table) -> Table {
        self.n += 1;
        let (before, were, are) = (kept(self.rate, self.n - 1), gone(self.rate, self.n - 1), gone(self.rate, self.n));
        let Some(last) = self.unsupervised.take() else {
            self.policy = Table::mixed([(kept(self.rate, self.n), &self.star), (are, hat)]);
            self.unsupervised = Some(hat.clone());
            return hat.clone();
        };
        let (mixed_in, newest, older) = match self.proposal {
            Proposal::Smile => (Table::mixed([(before, hat), (were, &last)]), self.rate * before, were),
            Proposal::Searn => (hat.clone(), self.rate, (1.0 - self.rate) * were),
        };
        let unsupervised = Table::mixed([(newest / are, hat), (older / are, &last)]);
        self.policy = Table::mixed([(kept(self.rate, self.n), &self.star), (are, &unsupervised)]);
        self.unsupervised = Some(unsupervised);
        mixed_in
    }
}

/// N rounds of stochastic mixing. Lists called "from 0" have the expert, pi^0, first; the others start with round 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Mixing {
    /// What a round mixes in.
    pub proposal: Proposal,
    /// a: SMILe's alpha, SEARN's beta.
    pub rate: f64,
    /// p_n, from 0.
    pub kept: Vec<f64>,
    /// `policies[n]`: pi^n, from 0.
    pub policies: Vec<Table>,
    /// `evaluations[n]`: exact values of pi^n, from 0.
    pub evaluations: Vec<Evaluation>,
    /// `unsupervised[n-1]`: pitilde^n, pi^n without the expert and renormalised.
    pub unsupervised: Vec<Table>,
    /// `unsupervised_costs[n-1]`: J(pitilde^n).
    pub unsupervised_costs: Vec<f64>,
    /// `proposals[n-1]`: hat^n.
    pub proposals: Vec<Table>,
    /// `orders[n-1]`: the k-th order costs of hat^n with respect to pi^{n-1}.
    pub orders: Vec<Costs>,
    horizon: usize,
}

impl Mixing {
    /// Mixes in `hats[n-1]` at round n: O(N T S^2 (T + A)), most of it for the k-th order costs. Memory: O(N S A T).
    ///
    /// # Errors
    /// A rate outside \[1e-15, 1\], or a table of the wrong shape.
    pub fn of(mdp: &Mdp, proposal: Proposal, hats: &[Table], rate: f64) -> Result<Self> {
        let mut mixer = Mixer::new(mdp, proposal, rate)?;
        let mut mixing = Mixing {
            proposal,
            rate,
            kept: vec![1.0],
            evaluations: vec![evaluate(mdp, mixer.policy())?],
            policies: vec![mixer.policy().clone()],
            unsupervised: Vec::new(),
            unsupervised_costs: Vec::new(),
            proposals: Vec::new(),
            orders: Vec::new(),
            horizon: mdp.horizon(),
        };
        for (i, hat) in hats.iter().enumerate() {
            mdp.admit(hat)?;
            let mixed_in = mixer.advance(hat);
            mixing.orders.push(korder::costs(mdp, &mixing.policies[i], &mixed_in)?);
            mixing.proposals.push(mixed_in);
            mixing.kept.push(kept(rate, i + 1));
            mixing.evaluations.push(evaluate(mdp, mixer.policy())?);
            mixing.policies.push(mixer.policy().clone());
            let unsupervised = mixer.unsupervised().unwrap_or(hat).clone();
            mixing.unsupervised_costs.push(cost(mdp, &unsupervised));
            mixing.unsupervised.push(unsupervised);
        }
        Ok(mixing)
    }

    /// N.
    pub fn rounds(&self) -> usize {
        self.proposals.len()
    }

    /// T.
    pub fn horizon(&self) -> usize {
        self.horizon
    }

    /// J(pi*).
    pub fn expert_cost(&self) -> f64 {
        self.evaluations[0].cost
    }

    /// J(pi^n); n above N is taken as N.
    pub fn cost(&self, n: usize) -> f64 {
        self.evaluations[n.min(self.rounds())].cost
    }

    /// J(pitilde^n); n above N is taken as N, and without a round it is J(pi*).
    pub fn unsupervised_cost(&self, n: usize) -> f64 {
        match self.unsupervised_costs.get(n.min(self.rounds()).wrapping_sub(1)) {
            Some(cost) => *cost,
            None => self.expert_cost(),
        }
    }

    /// The weights of pi^n: the expert's, then those of classifiers 1, ..., n.
    pub fn weights(&self, n: usize) -> Vec<f64> {
        let classifier = |j: usize| match self.proposal {
            Proposal::Smile => self.rate * kept(self.rate, j - 1),
            Proposal::Searn => self.rate * kept(self.rate, n - j),
        };
        std::iter::once(kept(self.rate, n)).chain((1..=n).map(classifier)).collect()
    }

    /// The weights of pitilde^n: those of classifiers 1, ..., n.
    pub fn unsupervised_weights(&self, n: usize) -> Vec<f64> {
        self.weights(n).iter().skip(1).map(|weight| weight / gone(self.rate, n)).collect()
    }

    /// The least N with p_N <= 1/T^2.
    pub fn rounds_wanted(&self) -> f64 {
        rounds(self.rate, self.horizon)
    }

    /// Lemma 4.1's right side after n <= N rounds, for k = 1, ..., T:
    /// J* + n sum_{i<=k} a^i C(T,i) (1-a)^{T-i} Abar_i + n a^{k+1} T C(T,k+1).
    pub fn lemma_4_1(&self, n: usize) -> Vec<f64> {
        let (horizon, orders) = (self.horizon, &self.orders[..n.min(self.rounds())]);
        let mut sum = self.expert_cost();
        let bound = |k: usize| {
            let total: f64 = orders.iter().map(|orders| orders.disadvantages[k]).sum();
            sum += tail(horizon, self.rate, k) * kept(self.rate, horizon - k) * total;
            sum + orders.len() as f64 * tail(horizon, self.rate, k + 1) * horizon as f64
        };
        (1..=horizon).map(bound).collect()
    }

    /// What Lemma 4.2 allows for dropping the expert from pi^n: as printed p_n T^2, with the expert's first step
    /// costing the steps left p_n T(T+1)/2, and exactly T - sum_{t<=T} (1-p_n)^t, which is attained.
    pub fn lemma_4_2(&self, n: usize) -> [f64; 3] {
        let (p, horizon) = (kept(self.rate, n), self.horizon as f64);
        let sharp = (1..=self.horizon).map(|t| gone(p, t)).sum();
        [p * horizon * horizon, p * horizon * (horizon + 1.0) / 2.0, sharp]
    }

    /// The bound of conservative policy iteration after n <= N rounds, J* + sum_{j<=n} (b T A_1 + b^2 T(T^2-1)/3).
    pub fn conservative(&self, n: usize) -> f64 {
        let (b, horizon) = (self.rate, self.horizon as f64);
        let step =
            |orders: &Costs| b * horizon * orders.disadvantages[1] + b * b * horizon * (horizon * horizon - 1.0) / 3.0;
        self.expert_cost() + self.orders.iter().take(n).map(step).sum::<f64>()
    }

    /// Abar_1 after n <= N rounds: the mean of A_1(pi^{j-1}, hat^j).
    pub fn mean_disadvantage(&self, n: usize) -> f64 {
        let sum: f64 = self.orders.iter().take(n).map(|orders| orders.disadvantages[1]).sum();
        sum / n.clamp(1, self.rounds().max(1)) as f64
    }
}

/// What SMILe's bounds are stated in; index j-1 for round j.
#[derive(Clone, Debug, PartialEq)]
pub struct Smile {
    /// The rounds.
    pub mixing: Mixing,
    /// eps_j: the 0-1 loss of hat*^j under d of pi^{j-1}.
    pub errors: Vec<f64>,
    /// W_j = sum_t e_t (T-t+1), e_t the 0-1 loss under d^t; at most T^2 eps_j.
    pub weighted_errors: Vec<f64>,
    /// A_1(pi^{j-1}, hat*^j | pi*): how much worse than the expert hat*^j is at one uniform step.
    pub given_expert: Vec<f64>,
}

/// The right sides of the bounds on SMILe after n rounds. `*_pi` bound J(pi^n), the others J(pitilde^n).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[allow(non_snake_case)]
pub struct SmileBounds {
    /// A~: the mean of A_1(pi^{j-1}, hat*^j | pi*) with weights a p_{j-1}/(1-p_n).
    pub A_tilde: f64,
    /// eps~: that of eps_j.
    pub eps_tilde: f64,
    /// W~: that of W_j.
    pub W_tilde: f64,
    /// Theorem 4.1 by its own proof (Lemma 4.1 at k = 2) with explicit constants, before Lemma 4.2:
    /// J* + (1-p_n)(T(1-a)^{T-1} A~ + a T^2(T-1)(1-a)^{T-2} eps~) + n a^3 T C(T,3).
    pub B_paper_pi: f64,
    /// By coupling at every order: J* + (1-p_n)(T(1-a)^{T-1} A~ + (1-(1-a)^{T-1}) W~).
    pub B_coup_pi: f64,
    /// The same with T^2 eps~ for W~.
    pub B_coup_eps_pi: f64,
    /// By the performance difference lemma: J* + T(1-p_n) A~ + a T^2(T-1) sum_j a p_{j-1}^2 eps_j.
    pub B_pdl_pi: f64,
    /// `B_paper_pi` + p_n T^2.
    pub B_paper: f64,
    /// `B_coup_pi` + p_n T(T+1)/2.
    pub B_coup: f64,
    /// `B_coup_eps_pi` + p_n T(T+1)/2.
    pub B_coup_eps: f64,
    /// `B_pdl_pi` + p_n T(T+1)/2.
    pub B_pdl: f64,
    /// Lemma 4.2 as printed: J(pi^n) + p_n T^2.
    pub lemma42_rhs: f64,
    /// J(pi^n) + p_n T(T+1)/2.
    pub lemma42_half_rhs: f64,
    /// J(pi^n) + T - sum_{t<=T} (1-p_n)^t.
    pub lemma42_sharp_rhs: f64,
}

impl Smile {
    /// SMILe with the classifiers `hats[j-1]` = hat*^j; the cost is that of [`Mixing::of`].
    ///
    /// # Errors
    /// A rate outside \[1e-15, 1\], or a table of the wrong shape.
    pub fn of(mdp: &Mdp, hats: &[Table], rate: f64) -> Result<Self> {
        let mixing = Mixing::of(mdp, Proposal::Smile, hats, rate)?;
        let mut smile = Smile { mixing, errors: Vec::new(), weighted_errors: Vec::new(), given_expert: Vec::new() };
        let horizon = mdp.horizon() as f64;
        for (hat, evaluation) in hats.iter().zip(&smile.mixing.evaluations) {
            let by_step = evaluation.visits.dot(&mdp.errors(hat));
            smile.errors.push(by_step.sum() / horizon);
            smile.weighted_errors.push(by_step.iter().enumerate().map(|(t, e)| e * (horizon - t as f64)).sum());
            let gap = hat.rows() - mdp.star().rows();
            let mut total = 0.0;
            for (visits, q) in evaluation.visits.outer_iter().zip(evaluation.action_value.outer_iter()) {
                total += visits.dot(&(&gap * &q).sum_axis(ndarray::Axis(1)));
            }
            smile.given_expert.push(total / horizon);
        }
        Ok(smile)
    }

    /// The mean of `values[j-1]` over rounds 1, ..., n with weights a p_{j-1}/(1-p_n).
    fn mean(&self, values: &[f64], n: usize) -> f64 {
        let rate = self.mixing.rate;
        let sum: f64 = values.iter().take(n).enumerate().map(|(i, value)| kept(rate, i) * value).sum();
        if n == 0 { 0.0 } else { sum / shares(rate, n) }
    }

    /// The right sides after 1 <= n <= N rounds; n outside is taken to the nearest.
    pub fn bounds(&self, n: usize) -> SmileBounds {
        let n = n.clamp(usize::from(self.mixing.rounds() > 0), self.mixing.rounds());
        let (a, all) = (self.mixing.rate, gone(self.mixing.rate, n));
        let (steps, horizon) = (self.mixing.horizon, self.mixing.horizon as f64);
        let mean = |values: &[f64]| self.mean(values, n);
        let (disadvantage, error) = (mean(&self.given_expert), mean(&self.errors));
        let weighted = mean(&self.weighted_errors);
        let (star, own) = (self.mixing.expert_cost(), self.mixing.evaluations[n].cost);
        let [printed, half, sharp] = self.mixing.lemma_4_2(n);
        let once = horizon * kept(a, steps - 1);
        let pairs = a * horizon * horizon * (horizon - 1.0);
        let triples = n as f64 * a.powi(3) * horizon * choose(steps, 3);
        let several = gone(a, steps - 1);
        let squares: f64 = self.errors.iter().take(n).enumerate().map(|(i, e)| a * kept(a, i).powi(2) * e).sum();
        let paper = star + all * (once * disadvantage + pairs * kept(a, steps.saturating_sub(2)) * error) + triples;
        let coupled = star + all * (once * disadvantage + several * weighted);
        let coupled_error = star + all * (once * disadvantage + several * horizon * horizon * error);
        let difference = star + horizon * all * disadvantage + pairs * squares;
        SmileBounds {
            A_tilde: disadvantage,
            eps_tilde: error,
            W_tilde: weighted,
            B_paper_pi: paper,
            B_coup_pi: coupled,
            B_coup_eps_pi: coupled_error,
            B_pdl_pi: difference,
            B_paper: paper + printed,
            B_coup: coupled + half,
            B_coup_eps: coupled_error + half,
            B_pdl: difference + half,
            lemma42_rhs: own + printed,
            lemma42_half_rhs: own + half,
            lemma42_sharp_rhs: own + sharp,
        }
    }
}
