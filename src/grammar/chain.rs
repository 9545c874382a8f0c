//! Expectations of an absorbing Markov chain by state reduction (Grassmann, Taksar & Heyman 1985): states are taken out
//! from the last to the first, and the chance to leave a state is the sum of its ways out, never 1 minus the chance to
//! stay. Without a subtraction nothing cancels, so a chain that ends once in 10¹² steps is solved to nearly full
//! precision.

use ndarray::{Array1, ArrayView2};

/// What is expected of a chain that ends.
pub(super) struct Expectations {
    /// `visits[a]`: expected visits to a from the start.
    pub(super) visits: Array1<f64>,
    /// `length[a]`: expected states visited from a, a itself included.
    pub(super) length: Array1<f64>,
}

/// Solves the chain that starts at a with chance `start[a]` and steps from a to b with chance `step[a, b]`, where the
/// last column is the end. Infinite or not a number where the chain never ends.
pub(super) fn solve(start: &Array1<f64>, step: ArrayView2<f64>) -> Expectations {
    let states = start.len();
    let mut step = step.to_owned();
    let mut visits = start.clone();
    let mut length = Array1::<f64>::ones(states);
    let mut leave = Array1::<f64>::zeros(states);
    for n in (0..states).rev() {
        leave[n] = (0..n).map(|b| step[[n, b]]).sum::<f64>() + step[[n, states]];
        for a in 0..n {
            let through = step[[a, n]] / leave[n];
            for b in (0..n).chain([states]) {
                step[[a, b]] += through * step[[n, b]];
            }
            length[a] += through * length[n];
        }
        for b in 0..n {
            visits[b] += visits[n] / leave[n] * step[[n, b]];
        }
    }
    for n in 0..states {
        let (mut visited, mut total) = (visits[n], length[n]);
        for a in 0..n {
            visited += visits[a] * step[[a, n]];
            total += step[[n, a]] * length[a];
        }
        visits[n] = visited / leave[n];
        length[n] = total / leave[n];
    }
    Expectations { visits, length }
}
