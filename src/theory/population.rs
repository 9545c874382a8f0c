//! Training with infinitely many samples: the best classifiers of a restricted class, exactly.
//!
//! A classifier of the class sees `view[s]` of state s and acts alike, deterministically, wherever that is equal.
//! Supervised training, forward training and SMILe minimise the expected 0-1 loss under their distribution, SEARN
//! minimises Jbar_1^{pi^{n-1}}(.), the cost of one deviation at a uniform step. Ties go to the lowest action. The
//! margin of a choice is the smallest gap, over the values of the view, between the best and the second-best action;
//! choices of a margin near 0 hang on rounding.

use super::evaluate::{average, evaluate, push, visits};
use super::mdp::{Mdp, same};
use super::mixing::{Mixer, Proposal};
use super::table::Table;
use crate::error::Result;
use ndarray::{Array1, Array2, ArrayView1};
use std::collections::BTreeMap;

/// Losses nearer than this are a tie.
const TIE: f64 = 1e-12;

/// The best classifier of a class and its margin; infinite with a single action.
pub type Choice = (Table, f64);

/// The class of all classifiers that act alike in states of equal view.
#[derive(Clone, Debug)]
pub struct Class<'a> {
    mdp: &'a Mdp,
    groups: Vec<Vec<usize>>,
}

impl<'a> Class<'a> {
    /// The class that sees `view[s]` of state s.
    ///
    /// # Errors
    /// Not one view a state.
    pub fn new(mdp: &'a Mdp, view: &[usize]) -> Result<Self> {
        same("phi", "numbers", view.len(), mdp.states())?;
        let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (s, seen) in view.iter().enumerate() {
            groups.entry(*seen).or_default().push(s);
        }
        Ok(Class { mdp, groups: groups.into_values().collect() })
    }

    /// The classifier that minimises the sum over s of `loss[s,a]`.
    fn best(&self, loss: &Array2<f64>) -> Choice {
        let mut choice = vec![0; self.mdp.states()];
        let mut margin = f64::INFINITY;
        for group in &self.groups {
            let total: Array1<f64> =
                (0..loss.ncols()).map(|a| group.iter().map(|s| loss[[*s, a]]).sum::<f64>()).collect();
            let least = total.iter().copied().fold(f64::INFINITY, f64::min);
            // Ties to the lowest action.
            let best = total.iter().position(|value| *value <= least + TIE).unwrap_or(0);
            let others = total.iter().enumerate().filter(|(a, _)| *a != best);
            margin = others.map(|(_, value)| (value - total[best]).max(0.0)).fold(margin, f64::min);
            group.iter().for_each(|s| choice[*s] = best);
        }
        (Table::sure(&choice, self.mdp.actions()), margin)
    }

    /// The classifier with the least 0-1 loss when state s has this weight.
    fn mimic(&self, weight: ArrayView1<'_, f64>) -> Choice {
        let loss =
            Array2::from_shape_fn(
                self.mdp.cost().dim(),
                |(s, a)| {
                    if self.mdp.expert()[s] == a { 0.0 } else { weight[s] }
                },
            );
        self.best(&loss)
    }

    /// d of a policy that fits the problem.
    fn seen(&self, policy: &Table) -> Array1<f64> {
        average(&visits(self.mdp, &vec![policy; self.mdp.horizon()]))
    }

    /// Supervised training: the least 0-1 loss under the expert's own states. O(S^2 (T + A)).
    ///
    /// # Errors
    /// None that this class can have.
    pub fn supervised(&self) -> Result<Choice> {
        Ok(self.mimic(self.seen(&self.mdp.star()).view()))
    }

    /// Forward training: pi_1, ..., pi_T, each the least 0-1 loss under the states that its predecessors lead to.
    /// O(T S^2), for a deterministic classifier takes one row of `next` a state.
    pub fn forward(&self) -> Vec<Choice> {
        let mut now = self.mdp.start().clone();
        let step = |_| {
            let choice = self.mimic(now.view());
            now = push(&now, &self.mdp.chain(&choice.0));
            choice
        };
        (0..self.mdp.horizon()).map(step).collect()
    }

    /// SMILe: hat*^1, ..., hat*^N, each the least 0-1 loss under d of pi^{n-1}. O(N S^2 (T + A)).
    ///
    /// # Errors
    /// A rate outside \[1e-15, 1\].
    pub fn smile(&self, rate: f64, rounds: usize) -> Result<Vec<Choice>> {
        self.rounds(rate, rounds, |policy| Ok(self.mimic(self.seen(policy).view())), Proposal::Smile)
    }

    /// SEARN: h_1, ..., h_N, each the least Jbar_1^{pi^{n-1}}. Its margins are those of T Jbar_1, the sum over the
    /// steps. O(N T S^2 A).
    ///
    /// # Errors
    /// A rate outside \[1e-15, 1\].
    pub fn searn(&self, rate: f64, rounds: usize) -> Result<Vec<Choice>> {
        let deviate = |policy: &Table| {
            let evaluation = evaluate(self.mdp, policy)?;
            let mut loss = Array2::zeros(self.mdp.cost().dim());
            for (visits, q) in evaluation.visits.outer_iter().zip(evaluation.action_value.outer_iter()) {
                for (s, mut row) in loss.outer_iter_mut().enumerate() {
                    row.scaled_add(visits[s], &q.row(s));
                }
            }
            Ok(self.best(&loss))
        };
        self.rounds(rate, rounds, deviate, Proposal::Searn)
    }

    fn rounds(
        &self,
        rate: f64,
        rounds: usize,
        train: impl Fn(&Table) -> Result<Choice>,
        proposal: Proposal,
    ) -> Result<Vec<Choice>> {
        let mut mixer = Mixer::new(self.mdp, proposal, rate)?;
        let mut choices = Vec::new();
        for _ in 0..rounds {
            let choice = train(mixer.policy())?;
            mixer.advance(&choice.0);
            choices.push(choice);
        }
        Ok(choices)
    }
}
