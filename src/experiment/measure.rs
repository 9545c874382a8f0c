//! What is measured in games, and how sure one can be of it.

use super::Goal;
use crate::policy::Policy;
use crate::seed::Seed;
use crate::space::{Problem, StateOf};
use crate::worker::{all, sweep};
use serde::{Deserialize, Serialize};

/// How a game went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// How far it went, in the game's unit.
    pub distance: f64,
    /// Falls, in a game that goes on after them per lap made.
    pub falls: f64,
    /// 1 if it was won, else 0.
    pub won: f64,
}

/// How all of the problem's games went with `policy`, by what `outcome` makes of their ends.
pub(super) fn outcomes<P: Problem, D: Policy<P>>(
    problem: &P,
    policy: &D,
    seed: Seed,
    outcome: impl Fn(&StateOf<P>) -> Outcome + Sync,
) -> Vec<Outcome> {
    let play = |worker: &mut crate::worker::Worker<'_, P>, memory: &mut D::Memory, episode, done: &mut Vec<Outcome>| {
        let (_, end) = worker.run(episode, |visit| Some(policy.act(visit, memory)));
        done.push(outcome(&end));
    };
    sweep(problem, &all(problem), seed, play).0
}

/// Numbers of which only count, sum and sum of squares are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// How many.
    pub count: u64,
    /// Their sum.
    pub sum: f64,
    /// The sum of their squares.
    pub squares: f64,
}

impl Spread {
    /// Takes in one more.
    pub fn add(&mut self, x: f64) {
        self.count += 1;
        self.sum += x;
        self.squares += x * x;
    }

    /// Their mean; not a number where there is none.
    pub fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }

    /// The estimated variance of one; 0 for a single one.
    pub fn variance(&self) -> f64 {
        let n = self.count as f64;
        if self.count < 2 { 0.0 } else { ((self.squares - self.sum * self.sum / n) / (n - 1.0)).max(0.0) }
    }
}

/// What was measured of games of one grade.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// How far they went.
    pub distance: Spread,
    /// Falls.
    pub falls: Spread,
    /// Games won.
    pub won: Spread,
}

impl Measured {
    /// Takes in one more game.
    pub fn add(&mut self, outcome: Outcome) {
        self.distance.add(outcome.distance);
        self.falls.add(outcome.falls);
        self.won.add(outcome.won);
    }

    /// What counts.
    pub fn goal(&self, goal: Goal) -> Spread {
        match goal {
            Goal::Distance => self.distance,
            Goal::Falls => self.falls,
        }
    }
}

/// A mean and half the width of its 95% confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// The mean.
    pub mean: f64,
    /// Half the width.
    pub half: f64,
}

impl Interval {
    /// The mean over strata of equal weight, each measured by `spreads`, for the policy at hand: from the normal distribution.
    pub fn stratified(spreads: &[Spread]) -> Self {
        let strata = spreads.len() as f64;
        let variance: f64 = spreads.iter().map(|s| s.variance() / s.count as f64).sum();
        Interval { mean: spreads.iter().map(Spread::mean).sum::<f64>() / strata, half: 1.96 * variance.sqrt() / strata }
    }

    /// The mean over independent trainings of the means in `values`: from Student's t distribution. Of one, nothing is known.
    pub fn repeated(values: &[f64]) -> Self {
        let mut spread = Spread::default();
        values.iter().for_each(|x| spread.add(*x));
        let n = values.len();
        let half = if n < 2 { f64::INFINITY } else { student(n - 1) * (spread.variance() / n as f64).sqrt() };
        Interval { mean: spread.mean(), half }
    }

    /// Its lower end.
    pub fn low(&self) -> f64 {
        self.mean - self.half
    }

    /// Its upper end.
    pub fn high(&self) -> f64 {
        self.mean + self.half
    }
}

/// The 97.5% quantile of Student's t distribution: from tables for up to ten degrees of freedom, beyond by the first terms of its expansion around the
/// normal one (Abramowitz & Stegun 1964, 26.7.5), right to three digits.
fn student(freedom: usize) -> f64 {
    const TABLE: [f64; 10] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228];
    if (1..=TABLE.len()).contains(&freedom) {
        return TABLE[freedom - 1];
    }
    let (z, n) = (1.959_964_f64, freedom as f64);
    let (first, second) = ((z.powi(3) + z) / 4.0, (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0);
    let third = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
    z + first / n + second / n.powi(2) + third / n.powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spread(values: &[f64]) -> Spread {
        let mut spread = Spread::default();
        values.iter().for_each(|x| spread.add(*x));
        spread
    }

    #[test]
    fn intervals_by_hand() {
        assert_eq!((spread(&[1.0, 2.0, 6.0]).mean(), spread(&[1.0, 2.0, 6.0]).variance()), (3.0, 7.0));
        // Means 1 and 5; variances of the means 2/2 and 8/2; half of 1.96 sqrt(1 + 4).
        let both = Interval::stratified(&[spread(&[0.0, 2.0]), spread(&[3.0, 7.0])]);
        assert!((both.mean - 3.0).abs() < 1e-12 && (both.half - 0.98 * 5.0f64.sqrt()).abs() < 1e-12, "{both:?}");
        // Standard error sqrt(2 / 2) = 1, one degree of freedom.
        assert_eq!(Interval::repeated(&[1.0, 3.0]), Interval { mean: 2.0, half: 12.706 });
        assert_eq!(Interval::repeated(&[4.0]).half, f64::INFINITY);
    }

    /// From tables of Student's t.
    #[test]
    fn quantiles_beyond_the_table() {
        for (freedom, t) in [(9, 2.262), (11, 2.201), (20, 2.086), (30, 2.042), (120, 1.980)] {
            assert!((student(freedom) - t).abs() < 1.5e-3, "{freedom}: {}", student(freedom));
        }
    }
}
