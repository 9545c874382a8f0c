//! Closed forms in the horizon T, the mixing rate a (alpha or beta) and the round n.
//!
//! p_n = (1-a)^n is the expert's share after n rounds, w_j = a p_{j-1} the weight of SMILe's j-th classifier,
//! beta_n = (1-p_{n-1})/(1-p_n) the share that the older classifiers keep among all classifiers. Rates are from
//! [`SLOWEST`] to 1.

/// The smallest rate that is accepted: a hundred times slower, and 1 - a is 1.
pub const SLOWEST: f64 = 1e-15;

/// p_n = (1-a)^n.
pub fn kept(rate: f64, n: usize) -> f64 {
    if n == 0 { 1.0 } else { (n as f64 * (-rate).ln_1p()).exp() }
}

/// 1 - p_n, without cancellation.
pub fn gone(rate: f64, n: usize) -> f64 {
    if n == 0 { 0.0 } else { -(n as f64 * (-rate).ln_1p()).exp_m1() }
}

/// The sum of p_0, ..., p_{n-1}: (1-p_n)/a.
pub fn shares(rate: f64, n: usize) -> f64 {
    gone(rate, n) / rate
}

/// 1 - beta_n = a p_{n-1}/(1-p_n), n >= 1.
pub fn newest(rate: f64, n: usize) -> f64 {
    // Never above 1 by rounding: its complement's logarithm is taken.
    if n <= 1 { 1.0 } else { (rate * kept(rate, n - 1) / gone(rate, n)).min(1.0) }
}

/// beta_n, n >= 1.
pub fn older(rate: f64, n: usize) -> f64 {
    gone(rate, n.saturating_sub(1)) / gone(rate, n.max(1))
}

/// The least N with p_N <= 1/T^2, so that Lemma 4.2 costs at most 1; as a float, for it can be astronomic.
pub fn rounds(rate: f64, horizon: usize) -> f64 {
    if horizon <= 1 {
        return 0.0;
    }
    let exact = 2.0 * (horizon as f64).ln() / -(-rate).ln_1p();
    // A quotient that is a whole number but for rounding is that number.
    let nearest = exact.round();
    if (exact - nearest).abs() <= 1e-12 * nearest { nearest.max(1.0) } else { exact.ceil() }
}

/// Theorem 4.1's alpha: sqrt(3)/(T^2 sqrt(ln T)); infinite for T = 1.
pub fn alpha_printed(horizon: usize) -> f64 {
    let horizon = horizon as f64;
    3f64.sqrt() / (horizon * horizon * horizon.ln().sqrt())
}

/// Theorem 4.1's N: 2 T^2 (ln T)^{3/2}, which is sqrt(3) times (2/alpha) ln T at its alpha.
pub fn rounds_printed(horizon: usize) -> f64 {
    let horizon = horizon as f64;
    2.0 * horizon * horizon * horizon.ln().powf(1.5)
}

/// The N of alpha = 1/T^2: 2 T^2 ln T.
pub fn rounds_inverse_square(horizon: usize) -> f64 {
    let horizon = horizon as f64;
    2.0 * horizon * horizon * horizon.ln()
}

/// ln C(n,k) for k = 0, ..., n.
pub fn log_choose(n: usize) -> Vec<f64> {
    let mut factorial = vec![0.0; n + 1];
    for i in 1..=n {
        factorial[i] = factorial[i - 1] + (i as f64).ln();
    }
    (0..=n).map(|k| factorial[n] - factorial[k] - factorial[n - k]).collect()
}

/// C(n,k), 0 for k > n; multiplied up, so exact while it is below 2^53.
pub fn choose(n: usize, k: usize) -> f64 {
    if k > n {
        return 0.0;
    }
    let k = k.min(n - k);
    (0..k).fold(1.0, |product, i| (product * (n - i) as f64 / (i + 1) as f64).round())
}

/// The probabilities of 0, ..., n successes in n trials that each succeed with probability p = 1 - q; both are given,
/// for one of them may be too near to 1 to tell.
pub fn binomial(n: usize, p: f64, q: f64) -> Vec<f64> {
    let power = |count: usize, base: f64| if count == 0 { 0.0 } else { count as f64 * base.ln() };
    let logs = log_choose(n);
    logs.iter().enumerate().map(|(k, log)| (log + power(k, p) + power(n - k, q)).exp()).collect()
}

/// a^k C(T,k), the union bound on k or more successes in T trials of probability a; by logarithms, for both factors can
/// be extreme.
pub fn tail(horizon: usize, rate: f64, k: usize) -> f64 {
    if k > horizon {
        return 0.0;
    }
    if horizon <= 50 {
        return rate.powi(k as i32) * choose(horizon, k);
    }
    let log: f64 = (0..k).map(|i| (rate * (horizon - i) as f64 / (i + 1) as f64).ln()).sum();
    log.exp()
}

/// The expected share of new trajectories at a round of Algorithm 4.2: 1-(1-a)^T, the same at every round.
pub fn fresh42(horizon: usize, rate: f64) -> f64 {
    gone(rate, horizon)
}

/// The expected share of new trajectories at round n of Algorithm 4.3 and of its exact repairs: 1-(1-a p_{n-1})^T,
/// below a p_{n-1} T.
pub fn fresh43(horizon: usize, rate: f64, n: usize) -> f64 {
    gone(rate * kept(rate, n.saturating_sub(1)), horizon)
}

/// How far Algorithm 4.2's new trajectories are from their law: the total variation between the number of uses of the
/// new policy given at least one (the zero-truncated binomial) and 1 + Bin(T-1, a), which is the size-biased binomial.
/// 0 iff T = 1 or a is 1.
pub fn bias42(horizon: usize, rate: f64) -> f64 {
    distance(horizon, rate, 1.0 - rate, gone(rate, horizon))
}

/// How far Algorithm 4.3's new trajectories with k classifier steps are from their law at round n >= 1: the same with
/// Bin(k, 1-beta_n).
pub fn bias43(k: usize, rate: f64, n: usize) -> f64 {
    let (new, old) = (newest(rate, n), older(rate, n));
    if k <= 1 || n <= 1 || new == 0.0 { 0.0 } else { distance(k, new, old, gone(new, k)) }
}

/// TV(Bin(n,p) given not 0, Bin(n,p) size-biased): the sum over x of Bin(x) (x/(np) - 1/P(not 0))^+.
fn distance(n: usize, p: f64, q: f64, some: f64) -> f64 {
    let mean = n as f64 * p;
    // Multiplied out: at x = 1 nothing is left, from x = 2 on nothing cancels for small p.
    let excess = |(x, mass): (usize, f64)| mass * (x as f64 * some - mean).max(0.0) / (mean * some);
    binomial(n, p, q).into_iter().enumerate().skip(1).map(excess).sum()
}

/// How much more Algorithm 4.2 uses the newest policy than it should: P(X>=1)(1+(T-1)a)/(Ta). At most about 1.298, for
/// aT near 1.79.
pub fn overuse42(horizon: usize, rate: f64) -> f64 {
    let horizon_f = horizon as f64;
    gone(rate, horizon) * (1.0 + (horizon_f - 1.0) * rate) / (horizon_f * rate)
}

/// The total variation between the label sequences of Algorithm 4.2's data set after n rounds and their law, all
/// classifiers distinguishable: bias42 times 1-(1-a)^{Tn}.
pub fn drift42(horizon: usize, rate: f64, n: usize) -> f64 {
    bias42(horizon, rate) * gone(rate, horizon.saturating_mul(n))
}

/// The same of Algorithm 4.3: the sum over j <= n and k of C(T,k) p_n^{T-k} (1-p_j)^k (1-beta_j^k) bias43; O(n T^2).
pub fn drift43(horizon: usize, rate: f64, n: usize) -> f64 {
    let stay = kept(rate, n);
    let logs = log_choose(horizon);
    let power = |count: usize, base: f64| if count == 0 { 0.0 } else { count as f64 * base.ln() };
    let mut drift = 0.0;
    for j in 2..=n {
        let (all, new) = (gone(rate, j), newest(rate, j));
        for (k, log) in logs.iter().enumerate().skip(2) {
            let mass = (log + power(horizon - k, stay) + power(k, all)).exp();
            if mass > 0.0 {
                drift += mass * gone(new, k) * bias43(k, rate, j);
            }
        }
    }
    drift
}
