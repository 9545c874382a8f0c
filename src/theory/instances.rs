//! Problems with closed forms at which bounds are tight, or printed procedures wrong. In all of them action 0 is the
//! expert's.

use super::mdp::{Mdp, Parts};
use super::table::Table;
use crate::error::{Error, Result};
use ndarray::{Array1, Array2, Array3, array};

/// A deterministic problem: `moves[s][a]` is the next state, `cost[s][a]` the cost; the episode starts in state 0.
fn deterministic(horizon: usize, moves: &[[usize; 2]], cost: &[[f64; 2]]) -> Result<Mdp> {
    let states = moves.len();
    let next = Array3::from_shape_fn((states, 2, states), |(s, a, to)| f64::from(u8::from(moves[s][a] == to)));
    let cost = Array2::from_shape_fn((states, 2), |(s, a)| cost[s][a]);
    let start = Array1::from_shape_fn(states, |s| f64::from(u8::from(s == 0)));
    Mdp::new(Parts { horizon, start, next, cost, expert: vec![0; states] })
}

/// A probability, or an error that calls it `name`.
fn probability(name: &'static str, value: f64) -> Result<f64> {
    // A comparison that is false for what is not a number.
    if (0.0..=1.0).contains(&value) { Ok(value) } else { Err(Error::argument(name, value, "from 0 to 1")) }
}

/// Theorem 2.1 is tight here: a problem and a classifier of 0-1 loss `eps` under the expert's states that costs (1 -
/// eps T) J* + T^2 eps.
///
/// State 0 starts, 1 is good, 2 is bad, both for ever. The classifier errs in state 0 only, with probability eps T. The
/// expert pays `cost` a step, J* = cost T; the error and the bad state cost 1.
///
/// # Errors
/// eps T or the cost outside \[0, 1\]: eps <= 1/T, which the paper does not say.
pub fn tight(horizon: usize, eps: f64, cost: f64) -> Result<(Mdp, Table)> {
    let error = probability("eps * horizon", eps * horizon as f64)?;
    let cost = probability("cost", cost)?;
    let mdp = deterministic(horizon, &[[1, 2], [1, 1], [2, 2]], &[[cost, 1.0], [cost, 1.0], [1.0, 1.0]])?;
    Ok((mdp, Table::new("hat", array![[1.0 - error, error], [1.0, 0.0], [1.0, 0.0]])?))
}

/// A classifier that errs with probability `error` at every step on the track, and never comes back:
/// J = T - (1 - cost) sum_{t<=T} (1-error)^t, about error T(T+1)/2.
///
/// # Errors
/// The error or the cost outside \[0, 1\].
pub fn cliff(horizon: usize, error: f64, cost: f64) -> Result<(Mdp, Table)> {
    let (error, cost) = (probability("error", error)?, probability("cost", cost)?);
    let mdp = deterministic(horizon, &[[0, 1], [1, 1]], &[[cost, 1.0], [1.0, 1.0]])?;
    Ok((mdp, Table::new("hat", array![[1.0 - error, error], [1.0, 0.0]])?))
}

/// Lemma 4.2's sharp form is attained here: one step of the expert saves the rest of the episode. The classifier costs
/// T, its mixture with an expert's share of p costs sum_{t<=T} (1-p)^t.
///
/// # Errors
/// No or too many steps.
pub fn rescue(horizon: usize) -> Result<(Mdp, Table)> {
    let mdp = deterministic(horizon, &[[1, 0], [1, 1]], &[[0.0, 1.0], [0.0, 0.0]])?;
    Ok((mdp, Table::deterministic(&[1, 0], 2)?))
}

/// Sample reuse as printed is wrong here: state 0 is left for state 1 by one action, for ever. Gives the classifier
/// that stays, as the expert does, and the one that moves.
///
/// With T = 2 the state after one round that mixes in the moving classifier is 1 with probability a; a data set of
/// Algorithm 4.2 has a + a^2(1-a)/2. After a staying and a moving round it is a(1-a); Lemma 4.3 adds
/// a^2(1-a)^2/(2(2-a)).
///
/// # Errors
/// No or too many steps.
pub fn departure(horizon: usize) -> Result<(Mdp, [Table; 2])> {
    let mdp = deterministic(horizon, &[[0, 1], [1, 1]], &[[0.0, 0.0], [1.0, 1.0]])?;
    Ok((mdp, [Table::deterministic(&[0, 0], 2)?, Table::deterministic(&[1, 1], 2)?]))
}
