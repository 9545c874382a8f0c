//! The bill of training.

use serde::{Deserialize, Serialize};
use std::iter::Sum;
use std::ops::{Add, AddAssign, Sub};

/// What training has cost so far, in plain numbers that add up, so that the number of threads cannot change the bill.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ledger {
    /// States at which the expert was asked what it would do: once per visited state, however often the answer is read.
    pub labels: u64,
    /// Steps of roll-ins at which the expert drove.
    pub expert_acts: u64,
    /// Steps of roll-outs at which the expert drove.
    pub rollout_acts: u64,
    /// Visits, of roll-ins and roll-outs, at which the expert was consulted at all: a label that is also driven is one query.
    pub queries: u64,
    /// Roll-outs begun.
    pub rollouts: u64,
    /// Times a state was put back: one for each roll-out.
    pub resets: u64,
    /// Steps of the environment, of roll-ins and roll-outs alike.
    pub steps: u64,
    /// Training examples made: states recorded with what is to be learned there.
    pub examples: u64,
}

impl AddAssign for Ledger {
    fn add_assign(&mut self, other: Self) {
        self.labels += other.labels;
        self.expert_acts += other.expert_acts;
        self.rollout_acts += other.rollout_acts;
        self.queries += other.queries;
        self.rollouts += other.rollouts;
        self.resets += other.resets;
        self.steps += other.steps;
        self.examples += other.examples;
    }
}

impl Sub for Ledger {
    type Output = Self;
    /// What was billed since `earlier`, which is a part of this bill.
    fn sub(self, earlier: Self) -> Self {
        Ledger {
            labels: self.labels - earlier.labels,
            expert_acts: self.expert_acts - earlier.expert_acts,
            rollout_acts: self.rollout_acts - earlier.rollout_acts,
            queries: self.queries - earlier.queries,
            rollouts: self.rollouts - earlier.rollouts,
            resets: self.resets - earlier.resets,
            steps: self.steps - earlier.steps,
            examples: self.examples - earlier.examples,
        }
    }
}

impl Add for Ledger {
    type Output = Self;
    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl Sum for Ledger {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Ledger::default(), Add::add)
    }
}
