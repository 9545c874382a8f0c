//! A problem small enough to write down: the notation of Section 2 of Ross & Bagnell (2010), in tables.

use super::table::Table;
use crate::error::{Error, Result};
use ndarray::{Array1, Array2, Array3, ArrayView1, Axis};

/// The longest horizon that is accepted. Exact laws hold T tables at once; this keeps a mistyped T from exhausting
/// memory.
pub const LONGEST: usize = 2_000;

/// A finite-horizon Markov decision process with a deterministic expert, checked when it is made.
///
/// S states, A actions, T steps. An episode starts in state s with probability `start[s]`; action a in state s costs
/// `cost[s,a]` in \[0, 1\] and leads to s' with probability `next[s,a,s']`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mdp {
    horizon: usize,
    start: Array1<f64>,
    next: Array3<f64>,
    cost: Array2<f64>,
    expert: Vec<usize>,
}

/// Everything an [`Mdp`] is made of; shapes as in its documentation.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    /// T, at least 1.
    pub horizon: usize,
    /// `start[s]`, the paper's initial distribution; `mu` in JSON.
    pub start: Array1<f64>,
    /// `next[s,a,s']`; `P` in JSON.
    pub next: Array3<f64>,
    /// `cost[s,a]`; `C` in JSON.
    pub cost: Array2<f64>,
    /// `expert[s]`, an action.
    pub expert: Vec<usize>,
}

impl Mdp {
    /// Checks the parts and puts them together.
    ///
    /// # Errors
    /// [`Error::Instance`] names the first value that is wrong by its JSON path, such as `P[2][0]`: a shape that does
    /// not fit, a probability that is negative or not finite, a distribution whose sum differs from 1 by more than
    /// 1e-9, a cost outside \[0, 1\], an expert's action that does not exist, no or too many steps.
    pub fn new(parts: Parts) -> Result<Self> {
        let Parts { horizon, start, next, cost, expert } = parts;
        let (states, actions) = cost.dim();
        if horizon == 0 || horizon > LONGEST {
            return Err(Error::instance("T", horizon.to_string(), format!("from 1 to {LONGEST}")));
        }
        if states == 0 || actions == 0 {
            return Err(Error::instance("C", format!("{states} states, {actions} actions"), "at least one of each"));
        }
        same("mu", "states", start.len(), states)?;
        same("P", "states", next.dim().0, states)?;
        same("P[0]", "actions", next.dim().1, actions)?;
        same("P[0][0]", "states", next.dim().2, states)?;
        same("expert", "states", expert.len(), states)?;
        distribution("mu", start.view())?;
        for (s, rows) in next.outer_iter().enumerate() {
            for (a, row) in rows.outer_iter().enumerate() {
                distribution(&format!("P[{s}][{a}]"), row)?;
            }
        }
        for ((s, a), c) in cost.indexed_iter() {
            if !(0.0..=1.0).contains(c) {
                return Err(Error::instance(format!("C[{s}][{a}]"), c.to_string(), "a cost from 0 to 1"));
            }
        }
        if let Some((s, a)) = expert.iter().enumerate().find(|(_, a)| **a >= actions) {
            return Err(Error::instance(
                format!("expert[{s}]"),
                a.to_string(),
                format!("an action from 0 to {}", actions - 1),
            ));
        }
        Ok(Mdp { horizon, start, next, cost, expert })
    }

    /// S.
    pub fn states(&self) -> usize {
        self.cost.nrows()
    }

    /// A.
    pub fn actions(&self) -> usize {
        self.cost.ncols()
    }

    /// T.
    pub fn horizon(&self) -> usize {
        self.horizon
    }

    /// `start[s]`.
    pub fn start(&self) -> &Array1<f64> {
        &self.start
    }

    /// `next[s,a,s']`.
    pub fn next(&self) -> &Array3<f64> {
        &self.next
    }

    /// `cost[s,a]`.
    pub fn cost(&self) -> &Array2<f64> {
        &self.cost
    }

    /// `expert[s]`.
    pub fn expert(&self) -> &[usize] {
        &self.expert
    }

    /// The expert as a table, pi*.
    pub fn star(&self) -> Table {
        Table::sure(&self.expert, self.actions())
    }

    /// The same problem with the imitation loss e(s,a) = I(a != pi*(s)) for its cost.
    pub fn imitation(&self) -> Self {
        let mut cost = Array2::ones(self.cost.dim());
        for (mut row, &a) in cost.outer_iter_mut().zip(&self.expert) {
            row[a] = 0.0;
        }
        Mdp { cost, ..self.clone() }
    }

    /// An error unless `table` is over this problem's states and actions.
    pub(super) fn admit(&self, table: &Table) -> Result<()> {
        let (states, actions) = table.rows().dim();
        if (states, actions) == self.cost.dim() {
            return Ok(());
        }
        let expected = format!("{} states, {} actions", self.states(), self.actions());
        Err(Error::argument("policy", format!("a table of {states} states, {actions} actions"), expected))
    }

    /// The chain that the policy makes: `[s,s']`, the sum over a of pi(a|s) P(s'|s,a). O(S^2 A), O(S^2) for a
    /// deterministic policy.
    pub(super) fn chain(&self, table: &Table) -> Array2<f64> {
        let mut chain = Array2::zeros((self.states(), self.states()));
        for (s, mut row) in chain.outer_iter_mut().enumerate() {
            for (a, &probability) in table.rows().row(s).iter().enumerate() {
                if probability != 0.0 {
                    row.scaled_add(probability, &self.next.index_axis(Axis(0), s).row(a));
                }
            }
        }
        chain
    }

    /// C_pi(s), the expected immediate cost.
    pub(super) fn charge(&self, table: &Table) -> Array1<f64> {
        (table.rows() * &self.cost).sum_axis(Axis(1))
    }

    /// e_pi(s), the probability of another action than the expert's.
    pub(super) fn errors(&self, table: &Table) -> Array1<f64> {
        let miss = |(row, &a): (ArrayView1<'_, f64>, &usize)| {
            row.iter().enumerate().filter(|(b, _)| *b != a).map(|(_, p)| p).sum::<f64>()
        };
        table.rows().outer_iter().zip(&self.expert).map(miss).collect()
    }
}

/// An error unless there are `expected` of `what` at `at`.
pub(super) fn same(at: &str, what: &str, found: usize, expected: usize) -> Result<()> {
    if found == expected {
        return Ok(());
    }
    Err(Error::instance(at, format!("{found} {what}"), expected.to_string()))
}

/// An error unless `row` is a probability distribution.
pub(super) fn distribution(at: &str, row: ArrayView1<'_, f64>) -> Result<()> {
    for (i, p) in row.iter().enumerate() {
        // A comparison that is false for what is not a number.
        if !(*p >= 0.0 && p.is_finite()) {
            return Err(Error::instance(format!("{at}[{i}]"), p.to_string(), "a probability"));
        }
    }
    let sum = row.sum();
    if (sum - 1.0).abs() > 1e-9 {
        return Err(Error::instance(at, format!("sums to {sum}"), "1"));
    }
    Ok(())
}
