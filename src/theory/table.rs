//! Policies as tables of probabilities.

use super::mdp::{Mdp, distribution};
use crate::error::{Error, Result};
use ndarray::Array2;

/// A stationary stochastic policy: `rows[s,a]` is the probability of action a in state s.
#[derive(Clone, Debug, PartialEq)]
pub struct Table(Array2<f64>);

impl Table {
    /// The policy with these rows.
    ///
    /// # Errors
    /// [`Error::Instance`] with a path below `at` when a row is not a distribution (1e-9).
    pub fn new(at: &str, rows: Array2<f64>) -> Result<Self> {
        for (s, row) in rows.outer_iter().enumerate() {
            distribution(&format!("{at}[{s}]"), row)?;
        }
        Ok(Table(rows))
    }

    /// The deterministic policy that takes `choice[s]` in state s; a choice from `actions` on takes no action at all.
    pub(crate) fn sure(choice: &[usize], actions: usize) -> Self {
        Table(Array2::from_shape_fn((choice.len(), actions), |(s, a)| f64::from(u8::from(choice[s] == a))))
    }

    /// The deterministic policy that takes `choice[s]` in state s.
    ///
    /// # Errors
    /// A choice that is not below `actions`.
    pub fn deterministic(choice: &[usize], actions: usize) -> Result<Self> {
        match choice.iter().find(|a| **a >= actions) {
            None => Ok(Table::sure(choice, actions)),
            Some(a) => Err(Error::argument("choice", a, format!("below {actions}, the number of actions"))),
        }
    }

    /// The mixture that draws a member anew at every step: the sum of weight times table.
    ///
    /// # Errors
    /// No members, members of different shapes, or weights that are not a distribution (1e-9).
    pub fn mixture(members: &[(f64, &Table)]) -> Result<Self> {
        let Some((_, first)) = members.first() else {
            return Err(Error::argument("members", "empty", "at least one"));
        };
        if members.iter().any(|(_, table)| table.0.dim() != first.0.dim()) {
            return Err(Error::argument("members", "tables of different shapes", "tables of one shape"));
        }
        let weights: ndarray::Array1<f64> = members.iter().map(|(weight, _)| *weight).collect();
        distribution("weights", weights.view())?;
        Ok(Table::mixed(members.iter().copied()))
    }

    /// The mixture of members that are known to fit, at least one.
    pub(super) fn mixed<'a>(members: impl IntoIterator<Item = (f64, &'a Table)>) -> Self {
        let mut sum: Option<Array2<f64>> = None;
        for (weight, table) in members {
            match &mut sum {
                None => sum = Some(&table.0 * weight),
                Some(sum) => sum.scaled_add(weight, &table.0),
            }
        }
        Table(sum.unwrap_or_default())
    }

    /// `rows[s,a]`.
    pub fn rows(&self) -> &Array2<f64> {
        &self.0
    }

    /// Whether every row puts all its weight on one action.
    pub fn is_deterministic(&self) -> bool {
        self.0.iter().all(|p| *p == 0.0 || *p == 1.0)
    }
}

/// Which table acts at which step: one for all steps, or one a step.
pub trait Schedule {
    /// The table of step t, counted from 0.
    ///
    /// # Errors
    /// There is none.
    fn table(&self, t: usize) -> Result<&Table>;
}

impl Schedule for Table {
    fn table(&self, _: usize) -> Result<&Table> {
        Ok(self)
    }
}

impl Schedule for [Table] {
    fn table(&self, t: usize) -> Result<&Table> {
        self.get(t).ok_or_else(|| Error::argument("policy", format!("{} tables", self.len()), "one for every step"))
    }
}

impl Schedule for [&Table] {
    fn table(&self, t: usize) -> Result<&Table> {
        self.get(t)
            .copied()
            .ok_or_else(|| Error::argument("policy", format!("{} tables", self.len()), "one for every step"))
    }
}

/// The tables of all steps of `mdp`, each of the right shape.
pub(super) fn scheduled<'a>(mdp: &Mdp, policy: &'a (impl Schedule + ?Sized)) -> Result<Vec<&'a Table>> {
    let tables: Vec<&Table> = (0..mdp.horizon()).map(|t| policy.table(t)).collect::<Result<_>>()?;
    for table in &tables {
        mdp.admit(table)?;
    }
    Ok(tables)
}
