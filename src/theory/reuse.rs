//! The exact laws of SMILe's data sets when samples are reused: Algorithms 4.2 and 4.3 as printed, and repaired.
//!
//! Both algorithms keep an old trajectory when its policy would have been the same, and otherwise run a new one. The
//! printed new one is not right: given that the new classifier acts at all, it puts it at *one* uniform step and lets
//! the rest be drawn freely, which makes the number of its uses size-biased instead of conditioned on not being 0. It
//! overuses the newest classifier.
//!
//! Repairs: for 4.2 the step of the *first* use is tau with probability a(1-a)^{tau-1}/(1-(1-a)^T), with the old policy
//! before and the mixture after; for 4.3 the same over the k steps at which classifiers act, with 1-beta_n for a.
//!
//! All laws are `[t,s]`, the state distribution of every step, or `[1,s]`, its average. Everything here is polynomial:
//! recursions over the steps of the kind of [`korder`](super::korder), with a flag for "the newest classifier has
//! acted". A round takes 10 products of a (t+1) x S matrix with a chain per step, 5 when only averages are kept (and 10
//! in the last round): O(N T^2 S (S + T)) in all. Memory: O(N T^2 S) for all laws, O(N T S) for averages.

use super::closed::{binomial, fresh42, fresh43, gone, kept, newest, older};
use super::evaluate::{average, push};
use super::korder::{Prefixes, Split, blend};
use super::mdp::Mdp;
use super::mixing::{Mixing, Proposal};
use super::table::Table;
use crate::error::{Error, Result};
use ndarray::{Array1, Array2, Array3, ArrayView2, Axis};

/// The laws of N rounds. Lists "from 0" start with D_0, the expert's trajectories; index n-1 elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Reuse {
    /// beta_n: the share of classifier steps that the classifiers before round n keep.
    pub older: Vec<f64>,
    /// `split[n-1][k]`: c_{n,k}, the probability that classifiers act at k of the T steps of pi^n.
    pub split: Vec<Vec<f64>>,
    /// The expected share of new trajectories of Algorithm 4.2.
    pub fresh42: Vec<f64>,
    /// That of Algorithm 4.3.
    pub fresh43: Vec<f64>,
    /// d of pi^n, from 0: what a data set should be.
    pub truth: Vec<Array2<f64>>,
    /// `by_count[n-1][k,t,s]`: D_k^{pi*}(pitilde^n), trajectories of pi^n at which classifiers act at k steps.
    pub by_count: Vec<Array3<f64>>,
    /// A new trajectory of Algorithm 4.2 as printed.
    pub printed42: Vec<Array2<f64>>,
    /// A new trajectory of Algorithm 4.2 repaired.
    pub exact42: Vec<Array2<f64>>,
    /// The data set of Algorithm 4.2 as printed if the last one was right.
    pub onestep42: Vec<Array2<f64>>,
    /// The data set of Algorithm 4.2 as printed, from 0.
    pub chain42: Vec<Array2<f64>>,
    /// `printed43[n-1][k-1,t,s]`: a new trajectory of Algorithm 4.3 as printed.
    pub printed43: Vec<Array3<f64>>,
    /// `exact43[n-1][k-1,t,s]`: a new trajectory of Algorithm 4.3 repaired.
    pub exact43: Vec<Array3<f64>>,
    /// The right side of Lemma 4.3 as printed: the data set of Algorithm 4.3 if the last one was right.
    pub lemma43: Vec<Array2<f64>>,
    /// The data set of Algorithm 4.3 as printed, from 0.
    pub chain43: Vec<Array2<f64>>,
}

/// What is kept of a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Detail {
    /// Every step.
    Steps,
    /// The average over the steps, as a single row.
    Mean,
}

impl Detail {
    /// What is kept of `[t,s]`.
    fn of(self, law: Array2<f64>) -> Array2<f64> {
        match self {
            Detail::Steps => law,
            Detail::Mean => average(&law).insert_axis(Axis(0)),
        }
    }

    /// Room for the laws `[k,t,s]` of `count` values of k.
    fn room(self, mdp: &Mdp, count: usize) -> Array3<f64> {
        let rows = if self == Detail::Steps { mdp.horizon() } else { 1 };
        Array3::zeros((count, rows, mdp.states()))
    }

    /// Adds step t, `law[k,s]`, to `laws[k,t,s]`.
    fn add(self, laws: &mut Array3<f64>, (t, horizon): (usize, usize), law: &ArrayView2<'_, f64>) {
        match self {
            Detail::Steps => laws.index_axis_mut(Axis(1), t).assign(law),
            Detail::Mean => laws.index_axis_mut(Axis(1), 0).scaled_add(1.0 / horizon as f64, law),
        }
    }
}

impl Reuse {
    /// The laws for the rounds of `mixing`, which mixed in `hats`, step by step.
    ///
    /// # Errors
    /// A mixing that is not SMILe's, or not of these classifiers and this problem.
    pub fn of(mdp: &Mdp, mixing: &Mixing, hats: &[Table]) -> Result<Self> {
        Reuse::follow(mdp, mixing, hats, Detail::Steps)
    }

    /// The same averaged over the steps, for problems whose laws are too many to hold: every law has one row, d(s).
    /// `by_count`, `printed43` and `exact43` are those of the last round only, and empty in the others.
    ///
    /// ```
    /// use ndarray::Axis;
    /// use rollin::theory::{instances, mixing::Smile, reuse::Reuse};
    ///
    /// let (mdp, hats) = instances::departure(5)?;
    /// let mixing = Smile::of(&mdp, &hats, 0.3)?.mixing;
    /// let (steps, means) = (Reuse::of(&mdp, &mixing, &hats)?, Reuse::means(&mdp, &mixing, &hats)?);
    /// let (law, mean) = (&steps.chain43[2], &means.chain43[2]);
    /// assert_eq!((law.dim(), mean.dim()), ((5, 2), (1, 2)));
    /// assert!((law.sum_axis(Axis(0)) / 5.0 - mean.row(0)).iter().all(|gap| gap.abs() < 1e-15));
    /// let (laws, mean) = (&steps.exact43[1], &means.exact43[1]);
    /// assert_eq!((laws.dim(), mean.dim()), ((5, 5, 2), (5, 1, 2)));
    /// assert!((laws.sum_axis(Axis(1)) / 5.0 - mean.index_axis(Axis(1), 0)).iter().all(|gap| gap.abs() < 1e-15));
    /// assert!(means.exact43[0].is_empty() && means.by_count[0].is_empty() && means.printed43[0].is_empty());
    /// # Ok::<(), rollin::Error>(())
    /// ```
    ///
    /// # Errors
    /// As for [`Reuse::of`].
    pub fn means(mdp: &Mdp, mixing: &Mixing, hats: &[Table]) -> Result<Self> {
        Reuse::follow(mdp, mixing, hats, Detail::Mean)
    }

    fn follow(mdp: &Mdp, mixing: &Mixing, hats: &[Table], detail: Detail) -> Result<Self> {
        if mixing.proposal != Proposal::Smile || mixing.rounds() != hats.len() || mixing.horizon() != mdp.horizon() {
            return Err(Error::argument("mixing", "of another run", "SMILe with these classifiers on this problem"));
        }
        mixing.policies.iter().chain(hats).try_for_each(|table| mdp.admit(table))?;
        let mut reuse = Reuse::begin(mixing, detail);
        // D_n^k of the printed Algorithm 4.3; at k = 0 always the expert's.
        let mut buckets = detail.room(mdp, mdp.horizon() + 1);
        buckets.index_axis_mut(Axis(0), 0).assign(&reuse.truth[0]);
        let star = mdp.chain(&mixing.policies[0]);
        for (n, table) in (1..).zip(hats) {
            let (hat, new) = (mdp.chain(table), mdp.chain(&mixing.unsupervised[n - 1]));
            reuse.first(mdp, mixing, n, detail);
            let cast = Cast { mdp, star: &star, hat: &hat, new: &new, detail };
            let (by_count, printed) = cast.printed();
            reuse.second(mixing.rate, n, &printed, &mut buckets);
            let none = || Array3::zeros((0, 0, 0));
            let exact = if detail == Detail::Mean && n < hats.len() {
                none()
            } else {
                // At round 1 there is no older classifier, and none is ever drawn.
                let old = if n == 1 { hat.clone() } else { mdp.chain(&mixing.unsupervised[n - 2]) };
                cast.exact(&old, reuse.older[n - 1])
            };
            if detail == Detail::Mean && n > 1 {
                (reuse.by_count[n - 2], reuse.printed43[n - 2]) = (none(), none());
            }
            reuse.by_count.push(by_count);
            reuse.printed43.push(printed);
            reuse.exact43.push(exact);
        }
        Ok(reuse)
    }

    /// What is known before the first round.
    fn begin(mixing: &Mixing, detail: Detail) -> Self {
        let (a, horizon) = (mixing.rate, mixing.horizon());
        let rounds = 1..=mixing.rounds();
        let truth: Vec<_> = mixing.evaluations.iter().map(|own| detail.of(own.visits.clone())).collect();
        Reuse {
            older: rounds.clone().map(|n| older(a, n)).collect(),
            split: rounds.clone().map(|n| binomial(horizon, gone(a, n), kept(a, n))).collect(),
            fresh42: rounds.clone().map(|_| fresh42(horizon, a)).collect(),
            fresh43: rounds.map(|n| fresh43(horizon, a, n)).collect(),
            chain42: truth.iter().take(1).cloned().collect(),
            chain43: truth.iter().take(1).cloned().collect(),
            truth,
            by_count: Vec::new(),
            printed42: Vec::new(),
            exact42: Vec::new(),
            onestep42: Vec::new(),
            printed43: Vec::new(),
            exact43: Vec::new(),
            lemma43: Vec::new(),
        }
    }

    /// Algorithm 4.2 at round n.
    fn first(&mut self, mdp: &Mdp, mixing: &Mixing, n: usize, detail: Detail) {
        let tables = [&mixing.policies[n - 1], &mixing.proposals[n - 1], &mixing.policies[n]];
        let [old, hat, now] = tables.map(|table| mdp.chain(table));
        let (reused, fresh) = (kept(mixing.rate, mdp.horizon()), self.fresh42[n - 1]);
        let printed = detail.of(once(mdp, &now, &hat));
        self.onestep42.push(&self.truth[n - 1] * reused + &printed * fresh);
        let chain = &self.chain42[n - 1] * reused + &printed * fresh;
        self.chain42.push(chain);
        self.exact42.push(detail.of(from_first_use(mdp, [&old, &hat, &now], mixing.rate)));
        self.printed42.push(printed);
    }

    /// Algorithm 4.3 at round n, whose new trajectories are `printed[k-1,t,s]`; before the laws of round n are stored.
    fn second(&mut self, rate: f64, n: usize, printed: &Array3<f64>, buckets: &mut Array3<f64>) {
        let mut lemma = &self.truth[0] * self.split[n - 1][0];
        let mut chain = lemma.clone();
        let (older, share) = (self.older[n - 1], newest(rate, n));
        for (i, run) in printed.outer_iter().enumerate() {
            let k = i + 1;
            let (reused, fresh) = (older.powi(k as i32), gone(share, k));
            let mut bucket = buckets.index_axis_mut(Axis(0), k);
            bucket *= reused;
            bucket.scaled_add(fresh, &run);
            let mass = self.split[n - 1][k];
            chain.scaled_add(mass, &bucket);
            if let Some(before) = self.by_count.last() {
                lemma.scaled_add(mass * reused, &before.index_axis(Axis(0), k));
            }
            lemma.scaled_add(mass * fresh, &run);
        }
        self.lemma43.push(lemma);
        self.chain43.push(chain);
    }
}

/// `[t,s]`: the chain `stay` at every step but one uniform one, whose chain is `swap`; O(T S^2).
fn once(mdp: &Mdp, stay: &Array2<f64>, swap: &Array2<f64>) -> Array2<f64> {
    let horizon = mdp.horizon() as f64;
    let mut law = Array2::zeros((mdp.horizon(), mdp.states()));
    // Sub-distributions: the step has not come, the step is past.
    let (mut before, mut after) = (mdp.start().clone(), Array1::<f64>::zeros(mdp.states()));
    for (t, mut row) in law.outer_iter_mut().enumerate() {
        let (waiting, past) = ((horizon - t as f64) / horizon, &after);
        row.assign(past);
        row.scaled_add(waiting, &before);
        after = push(&after, stay) + push(&before, swap) / horizon;
        before = push(&before, stay);
    }
    law
}

/// `[t,s]`: `old` before the first use of `hat`, `now` after it, the use at tau with probability proportional to
/// (1-a)^{tau-1}; chains, O(T S^2).
fn from_first_use(mdp: &Mdp, [old, hat, now]: [&Array2<f64>; 3], rate: f64) -> Array2<f64> {
    let horizon = mdp.horizon();
    // 1 + (1-a) + ... + (1-a)^{m-1}: the unnormalised probability of a use within m steps.
    let within = |m: usize| gone(rate, m) / rate;
    let mut law = Array2::zeros((horizon, mdp.states()));
    let (mut before, mut after) = (mdp.start().clone(), Array1::<f64>::zeros(mdp.states()));
    for (t, mut row) in law.outer_iter_mut().enumerate() {
        row.assign(&after);
        row.scaled_add(kept(rate, t) * within(horizon - t), &before);
        after = push(&after, now) + push(&before, hat) * kept(rate, t);
        before = push(&before, old);
    }
    law / within(horizon)
}

/// Who acts in a new trajectory of Algorithm 4.3, as chains: the expert, the newest classifier, all of them.
struct Cast<'a> {
    mdp: &'a Mdp,
    star: &'a Array2<f64>,
    hat: &'a Array2<f64>,
    new: &'a Array2<f64>,
    detail: Detail,
}

impl Cast<'_> {
    /// `[k,t,s]`, k = 0, ..., T: at k uniform steps classifiers act, all of them, drawn. And `[k-1,t,s]`: at one of
    /// these steps the newest, at the others all of them.
    ///
    /// For the second, `H_t[j]` is like `F_t[j]` of `korder` with the one step among the first t:
    /// `H_t[j] = (1/t) F_{t-1}[j-1] P_hat + ((j-1)/t) H_{t-1}[j-1] P_new + (1-j/t) H_{t-1}[j] P_star`.
    fn printed(&self) -> (Array3<f64>, Array3<f64>) {
        let (mdp, horizon) = (self.mdp, self.mdp.horizon());
        let (mut by_count, mut laws) = (self.detail.room(mdp, horizon + 1), self.detail.room(mdp, horizon));
        let mut done = Array2::<f64>::zeros((horizon + 1, mdp.states()));
        let (mut split, mut prefixes) = (Split::new(horizon), Prefixes::new(mdp, self.star, self.new));
        for t in 0..horizon {
            let open = prefixes.rows();
            let behind = done.slice_axis(Axis(0), (..t + 1).into());
            self.detail.add(&mut by_count, (t, horizon), &split.weights().dot(&open).view());
            let (mut past, mut ahead) = (split.weights().to_owned(), split.weights().to_owned());
            for ((k, j), weight) in past.indexed_iter_mut() {
                *weight *= j as f64 / k.max(1) as f64;
            }
            ahead -= &past;
            let law = past.dot(&behind) + ahead.dot(&open);
            self.detail.add(&mut laws, (t, horizon), &law.slice_axis(Axis(0), (1..).into()));
            if t + 1 == horizon {
                break;
            }
            let (stay, mut swap) = (behind.dot(self.star), behind.dot(self.new));
            let use_now = open.dot(self.hat);
            for (i, mut row) in swap.outer_iter_mut().enumerate() {
                row *= i as f64 / (i + 1) as f64;
                row.scaled_add(1.0 / (i + 1) as f64, &use_now.row(i));
            }
            blend(&mut done, t + 1, &stay, &swap);
            prefixes.advance();
            split.advance();
        }
        (by_count, laws)
    }

    /// `[k-1,t,s]`: at k uniform steps classifiers act, each the newest with probability 1-beta, given that it is at
    /// least once; otherwise the chain is `old`.
    ///
    /// With `Z_t[j]` the law when all j are older ones and `G_t[j]` the sub-distribution, divided by 1-beta, when some
    /// are not: `G_t[j] = (j/t)(G_{t-1}[j-1] P_new + beta^{j-1} Z_{t-1}[j-1] P_hat) + (1-j/t) G_{t-1}[j] P_star`.
    fn exact(&self, old: &Array2<f64>, beta: f64) -> Array3<f64> {
        let (mdp, horizon) = (self.mdp, self.mdp.horizon());
        let powers: Vec<f64> = (0..=horizon).map(|j| beta.powi(j as i32)).collect();
        // some[m] = (1-beta^m)/(1-beta), without dividing by what can be 0.
        let mut some = vec![0.0; horizon + 1];
        for m in 0..horizon {
            some[m + 1] = some[m] + powers[m];
        }
        let mut laws = self.detail.room(mdp, horizon);
        let mut done = Array2::<f64>::zeros((horizon + 1, mdp.states()));
        let (mut split, mut prefixes) = (Split::new(horizon), Prefixes::new(mdp, self.star, old));
        for t in 0..horizon {
            let open = prefixes.rows();
            let behind = done.slice_axis(Axis(0), (..t + 1).into());
            let mut ahead = split.weights().to_owned();
            for ((k, j), weight) in ahead.indexed_iter_mut() {
                *weight *= powers[j] * some[k.saturating_sub(j)];
            }
            let mut law = split.weights().dot(&behind) + ahead.dot(&open);
            for (mut row, some) in law.outer_iter_mut().zip(&some).skip(1) {
                row /= *some;
            }
            self.detail.add(&mut laws, (t, horizon), &law.slice_axis(Axis(0), (1..).into()));
            if t + 1 == horizon {
                break;
            }
            let (stay, mut swap) = (behind.dot(self.star), behind.dot(self.new));
            let use_now = open.dot(self.hat);
            for (j, mut row) in swap.outer_iter_mut().enumerate() {
                row.scaled_add(powers[j], &use_now.row(j));
            }
            blend(&mut done, t + 1, &stay, &swap);
            prefixes.advance();
            split.advance();
        }
        laws
    }
}
