//! The two reductions between the kinds of learners, by which every trainer runs with every learner.
//!
//! - A label is a cost of 1 on every other action (exact: 0-1 loss is the cost that is 1 everywhere but at the label).
//! - Costs are a label, the cheapest action, with an importance: the mean of what the other legal actions cost more. For two actions
//!   this is Zadrozny, Langford & Abe's (2003) reduction, exact; for more it keeps the best action and how much is at stake,
//!   and forgets how the others rank.

use super::Target;
use crate::space::{Action, Actions};

/// The label that `target` stands for and its importance; the lowest of equally cheap actions. Importance 0: nothing is at stake.
pub fn as_label(target: Target<'_>, legal: Actions<'_>) -> (Action, f32) {
    match target {
        Target::Label(action) => (action, if legal.len() > 1 { 1.0 } else { 0.0 }),
        Target::Costs(costs) => {
            let (place, least) = costs
                .iter()
                .enumerate()
                .fold((0, f32::INFINITY), |best, (i, c)| if *c < best.1 { (i, *c) } else { best });
            let others = costs.len().saturating_sub(1).max(1) as f32;
            (legal.nth(place), costs.iter().map(|c| c - least).sum::<f32>() / others)
        }
    }
}

/// Writes the cost of each legal action that `target` stands for, the cheapest at 0.
pub fn as_costs(target: Target<'_>, legal: Actions<'_>, costs: &mut Vec<f32>) {
    costs.clear();
    match target {
        Target::Label(label) => costs.extend(legal.iter().map(|a| if a == label { 0.0 } else { 1.0 })),
        Target::Costs(given) => {
            let least = given.iter().copied().fold(f32::INFINITY, f32::min);
            costs.extend(given.iter().map(|c| c - least));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worked_by_hand() {
        let legal = Actions::Only(&[Action(1), Action(3), Action(4)]);
        assert_eq!(as_label(Target::Costs(&[3.0, 1.0, 2.0]), legal), (Action(3), 1.5));
        assert_eq!(as_label(Target::Costs(&[1.0, 1.0, 4.0]), legal), (Action(1), 1.5));
        assert_eq!(as_label(Target::Costs(&[2.0, 2.0, 2.0]), legal), (Action(1), 0.0));
        assert_eq!(as_label(Target::Label(Action(4)), legal), (Action(4), 1.0));
        assert_eq!(as_label(Target::Label(Action(0)), Actions::All(1)), (Action(0), 0.0));
        let mut costs = Vec::new();
        as_costs(Target::Label(Action(3)), legal, &mut costs);
        assert_eq!(costs, [1.0, 0.0, 1.0]);
        as_costs(Target::Costs(&[3.0, 1.0, 2.0]), legal, &mut costs);
        assert_eq!(costs, [2.0, 0.0, 1.0]);
    }
}
