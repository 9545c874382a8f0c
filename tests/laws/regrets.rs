//! The reductions' regret transforms: what a cost-sensitive classifier loses is bounded by what the simpler predictions that it is made of lose,
//! whatever the distribution of costs and however wrong the predictions. Everything is computed exactly, at one view, over distributions of a few cost
//! vectors; the simpler problems are read off the learners themselves, from the gradients that they would follow.

use crate::common::fixed;
use proptest::collection::vec;
use proptest::prelude::*;
use rollin::learner::{Csoaa, FilterTree, Lesson, Rule, Target, Wap, reduce};
use rollin::policy::{Classifier, Columns, Linear, Weights};
use rollin::space::{Action, Actions, FeatureTable, Features, Sight};

/// A distribution of costs in [0, 1]: probabilities and one vector each.
#[derive(Clone, Debug)]
struct World {
    chances: Vec<f64>,
    costs: Vec<Vec<f32>>,
    legal: Vec<Action>,
    actions: usize,
}

/// Between two and seven actions, of which some may be illegal. Half of the worlds have costs that are 0 or 1, and so many ties.
fn worlds() -> impl Strategy<Value = World> {
    (2usize..=7, 1usize..=5, any::<bool>(), vec(any::<bool>(), 7)).prop_flat_map(|(actions, n, coarse, legal)| {
        let mut legal: Vec<Action> = (0..actions as u32).map(Action).filter(|a| legal[a.index()]).collect();
        if legal.len() < 2 {
            legal = (0..actions as u32).map(Action).collect();
        }
        let k = legal.len();
        (vec(1u32..100, n), vec(vec(0u32..=1000, k), n)).prop_map(move |(weights, costs)| {
            let total: u32 = weights.iter().sum();
            let cost = |c: u32| if coarse { (c / 501) as f32 } else { c as f32 / 1000.0 };
            World {
                chances: weights.iter().map(|w| f64::from(*w) / f64::from(total)).collect(),
                costs: costs.iter().map(|costs| costs.iter().map(|c| cost(*c)).collect()).collect(),
                legal: legal.clone(),
                actions,
            }
        })
    })
}

impl World {
    fn legal(&self) -> Actions<'_> {
        Actions::Only(&self.legal)
    }

    /// The same world with a label in place of each cost vector, the lowest of the cheapest actions: it costs 0, all others 1.
    fn labels(mut self) -> World {
        for costs in &mut self.costs {
            let (label, _) = reduce::as_label(Target::Costs(costs), Actions::Only(&self.legal));
            costs.iter_mut().zip(&self.legal).for_each(|(c, a)| *c = if *a == label { 0.0 } else { 1.0 });
        }
        self
    }

    /// The expected cost of each legal action.
    fn expected(&self) -> Vec<f64> {
        let mean = |a: usize| self.chances.iter().zip(&self.costs).map(|(p, costs)| p * f64::from(costs[a])).sum();
        (0..self.legal.len()).map(mean).collect()
    }

    /// What taking `action` costs more than the best is expected to.
    fn regret(&self, action: Action) -> f64 {
        let expected = self.expected();
        let best = expected.iter().copied().fold(f64::INFINITY, f64::min);
        expected[self.legal().place(action).expect("a legal choice")] - best
    }

    /// For each cost vector, the gradient that `rule` would follow at these scores.
    fn gradients(&self, rule: &impl Rule, scores: &[f32]) -> Vec<Vec<f64>> {
        let gradient = |costs: &Vec<f32>| {
            let mut gradient = vec![0.0; scores.len()];
            let target = Target::Costs(costs);
            rule.gradient(Lesson { actions: self.actions, legal: self.legal(), target }, scores, &mut gradient);
            gradient.into_iter().map(f64::from).collect()
        };
        self.costs.iter().map(gradient).collect()
    }

    /// What a classifier with these scores of its columns chooses.
    fn choice(&self, columns: Columns, scores: &[f32]) -> Action {
        let mut weights = Weights::new(1, columns.count(self.actions));
        weights.row_mut(0)[..scores.len()].copy_from_slice(scores);
        let view = Features { dynamic: vec![0], ..Features::default() };
        let sight = Sight { shared: &FeatureTable::new(1), view: &view, legal: self.legal() };
        Linear { actions: self.actions, columns, weights }.choose(&sight, &mut Default::default())
    }
}

/// So small that a binary logistic regression is in doubt: its gradient is half the example's importance, with the sign of what it says.
const DOUBT: f32 = 1e-5;

/// What the binary decisions `scores` lose in sum, weighted by importance, and the sum of all importances.
fn binary(world: &World, gradients: &[Vec<f64>], scores: &[f32]) -> (f64, f64) {
    let (mut regret, mut importance) = (0.0, 0.0);
    for (column, score) in scores.iter().enumerate() {
        // Above 0: the first of the pair is expected to be cheaper.
        let mut expected = 0.0;
        for (chance, gradient) in world.chances.iter().zip(gradients) {
            expected -= 2.0 * chance * gradient[column];
            importance += 2.0 * chance * gradient[column].abs();
        }
        if (expected > 0.0) != (*score >= 0.0) {
            regret += f64::abs(expected);
        }
    }
    (regret, importance)
}

/// Of the gradients: doubt is not quite even, and importances below 2e-4 are left out by the learners.
const SLACK: f64 = 0.01;

fn decisions(world: &World, columns: Columns, says: &[bool]) -> Vec<f32> {
    says[..columns.count(world.actions)].iter().map(|yes| if *yes { DOUBT } else { -DOUBT }).collect()
}

proptest! {
    #![proptest_config(fixed(2000))]

    /// The filter tree (Beygelzimer, Langford & Ravikumar 2009): the cost-sensitive regret is at most the sum of the importance-weighted regrets
    /// of all matches. Divided by the sum of the importances, which for costs in [0, 1] is at most k - 1, that is k - 1 times the binary regret.
    #[test]
    fn the_filter_tree_loses_at_most_what_its_matches_lose(world in worlds(), says in vec(any::<bool>(), 21)) {
        let scores = decisions(&world, Columns::Tree, &says);
        let regret = world.regret(world.choice(Columns::Tree, &scores));
        let (matches, importance) = binary(&world, &world.gradients(&FilterTree::default(), &scores), &scores);
        prop_assert!(regret <= matches + SLACK, "{regret} above {matches}");
        let k = world.legal.len() as f64;
        prop_assert!(importance <= k - 1.0 + SLACK, "{importance} for {k} actions");
        let average = if importance > 0.0 { matches / importance } else { 0.0 };
        prop_assert!(regret <= (k - 1.0) * average + SLACK, "{regret} above {} times {average}", k - 1.0);
    }

    /// Weighted all pairs (Beygelzimer, Dani, Hayes, Langford & Zadrozny 2005): the cost above each example's cheapest is at most twice the weighted
    /// binary *loss*.
    #[test]
    fn weighted_all_pairs_costs_at_most_twice_what_its_pairs_lose(world in worlds(), says in vec(any::<bool>(), 21)) {
        let scores = decisions(&world, Columns::Pairs, &says);
        let place = world.legal().place(world.choice(Columns::Pairs, &scores)).expect("a legal choice");
        let above = |costs: &Vec<f32>| costs[place] - costs.iter().copied().fold(f32::INFINITY, f32::min);
        let gradients = world.gradients(&Wap::default(), &scores);
        let (mut cost, mut loss) = (0.0, 0.0);
        for ((chance, costs), gradient) in world.chances.iter().zip(&world.costs).zip(&gradients) {
            cost += chance * f64::from(above(costs));
            let wrong = |(g, score): (&f64, &f32)| if (*g < 0.0) == (*score >= 0.0) { 0.0 } else { 2.0 * g.abs() };
            loss += chance * gradient.iter().zip(&scores).map(wrong).sum::<f64>();
        }
        prop_assert!(cost <= 2.0 * loss + SLACK, "{cost} above twice {loss}");
    }

    /// For distributions of labels the same holds of the regrets.
    #[test]
    fn all_pairs_of_labels_regret_at_most_twice_what_pairs_do(world in worlds(), says in vec(any::<bool>(), 21)) {
        let world = world.labels();
        let scores = decisions(&world, Columns::Pairs, &says);
        let regret = world.regret(world.choice(Columns::Pairs, &scores));
        let (pairs, _) = binary(&world, &world.gradients(&Wap::default(), &scores), &scores);
        prop_assert!(regret <= 2.0 * pairs + SLACK, "{regret} above twice {pairs}");
    }

    /// One-against-all regression: at most the root of twice the squared regret of the regressions. The gradient's expectation at the scores is the
    /// distance of the prediction from the expected cost, whose square is the regret of squared loss.
    #[test]
    fn one_against_all_loses_at_most_the_root(world in worlds(), predicted in vec(-1500i32..=500, 7)) {
        let scores: Vec<f32> = predicted[..world.actions].iter().map(|p| *p as f32 / 1000.0).collect();
        let regret = world.regret(world.choice(Columns::Actions, &scores));
        let gradients = world.gradients(&Csoaa::default(), &scores);
        let distance = |a: &Action| {
            let mean: f64 = world.chances.iter().zip(&gradients).map(|(p, gradient)| p * gradient[a.index()]).sum();
            mean * mean
        };
        let squares: f64 = world.legal.iter().map(distance).sum();
        prop_assert!(regret <= (2.0 * squares).sqrt() + 1e-5, "{regret} above the root of twice {squares}");
    }

    /// Between two actions, costs as a label with an importance lose nothing: both regrets are one.
    #[test]
    fn labels_with_importance_are_exact_for_two(world in worlds(), second in any::<bool>()) {
        let pair = Actions::Only(&world.legal[..2]);
        let choice = world.legal[usize::from(second)];
        let (mut costs, mut labels) = ([0.0; 2], [0.0; 2]);
        for (chance, vector) in world.chances.iter().zip(&world.costs) {
            let (label, importance) = reduce::as_label(Target::Costs(&vector[..2]), pair);
            for (place, action) in pair.iter().enumerate() {
                costs[place] += chance * f64::from(vector[place]);
                labels[place] += if action == label { 0.0 } else { chance * f64::from(importance) };
            }
        }
        let place = pair.place(choice).expect("one of them");
        let regret = |losses: [f64; 2]| losses[place] - losses[0].min(losses[1]);
        prop_assert!((regret(costs) - regret(labels)).abs() < 1e-6);
    }
}

/// Two of the bounds are reached: by a single wrong match, and by two predictions that err by the same in opposite directions.
#[test]
fn the_bounds_are_reached() {
    let legal = vec![Action(0), Action(1)];
    let world = World { chances: vec![1.0], costs: vec![vec![0.0, 1.0]], legal, actions: 2 };
    let wrong = [-DOUBT];
    assert_eq!(world.regret(world.choice(Columns::Tree, &wrong)), 1.0);
    let (matches, importance) = binary(&world, &world.gradients(&FilterTree::default(), &wrong), &wrong);
    assert!((matches - 1.0).abs() < SLACK && (importance - 1.0).abs() < SLACK);
    let world = World { costs: vec![vec![0.0, 0.5]], ..world };
    assert_eq!(world.choice(Columns::Actions, &[-0.25 - 1e-4, -0.25 + 1e-4]), Action(1));
    let squares: f64 = world.gradients(&Csoaa::default(), &[-0.25, -0.25])[0].iter().map(|g| g * g).sum();
    assert!(((2.0 * squares).sqrt() - 0.5).abs() < 1e-3, "{squares}");
}

/// Of costs in general weighted all pairs has no such bound on regrets: here every pair is decided as is best for it, 1 before 0 before 2, and yet 0 is
/// cheaper than 1. Expected values are 0.191, 0.101 and 0.199, expected costs 0.195, 0.205 and 0.209.
#[test]
fn pairs_without_regret_may_have_regret_together() {
    let legal: Vec<Action> = (0..3).map(Action).collect();
    let costs = vec![vec![0.305, 0.005, 0.328], vec![0.0, 0.558, 0.0]];
    let world = World { chances: vec![30.0 / 47.0, 17.0 / 47.0], costs, legal, actions: 3 };
    let scores = [-DOUBT, DOUBT, DOUBT];
    let choice = world.choice(Columns::Pairs, &scores);
    let (pairs, _) = binary(&world, &world.gradients(&Wap::default(), &scores), &scores);
    assert_eq!((choice, pairs), (Action(1), 0.0));
    assert!((world.regret(choice) - 0.01034).abs() < 1e-4, "{}", world.regret(choice));
}
