//! Learners that minimise something: worked by hand, and nowhere near is anything smaller.

use crate::common::{Constant, Labels, fixed, problem, sample, tokens};
use proptest::collection::vec;
use proptest::prelude::*;
use rollin::Seed;
use rollin::learner::{
    CostTree, CrammerSinger, Examples, Learner, Net, Reliability, Ridge, Setting, Step, Svm, Target, calibrate,
};
use rollin::policy::{Calibrated, Classifier, Linear, Valued};
use rollin::roll::{Shortcut, perform};
use rollin::space::{Action, Actions, FeatureTable, Features, Sight};
use rollin::trainer::{Aggrevate, Cpi, Dagger, Forward, Lols, Run, Searn, Smile, Supervised};

/// Examples of a few features, all of them dynamic, all actions legal.
#[derive(Clone, Debug)]
struct Small {
    features: usize,
    actions: usize,
    examples: Vec<(Vec<u32>, Vec<f32>)>,
}

impl Small {
    fn table(&self) -> FeatureTable {
        FeatureTable::new(self.features)
    }

    fn fit<L: Learner<Features>>(&self, learner: &L) -> L::Classifier {
        let mut examples = Examples::default();
        for (dynamic, costs) in &self.examples {
            let view = Features { dynamic: dynamic.clone(), ..Features::default() };
            examples.push(&view, Actions::All(self.actions as u32), Target::Costs(costs));
        }
        learner.fit(Setting { shared: &self.table(), actions: self.actions }, &examples, None, Seed::new(1))
    }

    /// The columns' weights of every feature.
    fn weights(&self, classifier: &Linear) -> Vec<Vec<f64>> {
        let columns = classifier.weights.columns();
        let row = |f: usize| match classifier.weights.row(f as u32) {
            Some(row) => row[..columns].iter().map(|w| f64::from(*w)).collect(),
            None => vec![0.0; columns],
        };
        (0..self.features).map(row).collect()
    }

    fn scores(&self, classifier: &impl Classifier<Features>, dynamic: &[u32]) -> Vec<f32> {
        let view = Features { dynamic: dynamic.to_vec(), ..Features::default() };
        let sight = Sight { shared: &self.table(), view: &view, legal: Actions::All(self.actions as u32) };
        classifier.scores(&sight, &mut Default::default()).to_vec()
    }
}

/// The sum of the weights of these features.
fn sum(w: &[Vec<f64>], features: &[u32], column: usize) -> f64 {
    features.iter().map(|f| w[*f as usize][column]).sum()
}

fn squares(w: &[Vec<f64>]) -> f64 {
    w.iter().flatten().map(|w| w * w).sum()
}

/// What [`CrammerSinger`] minimises.
fn crammer_singer(small: &Small, w: &[Vec<f64>], cost: f64) -> f64 {
    let slack = |(x, costs): &(Vec<u32>, Vec<f32>)| {
        let best = (0..costs.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).expect("some action");
        let margin = |a: usize| sum(w, x, a) - sum(w, x, best) + f64::from(costs[a] - costs[best]);
        (0..costs.len()).map(margin).fold(0.0, f64::max)
    };
    squares(w) / 2.0 + cost * small.examples.iter().map(slack).sum::<f64>()
}

/// What [`Svm`] minimises, for two actions: costs c and d weigh |c - d| (the integral of 1 from the lesser to the greater).
fn svm(small: &Small, w: &[Vec<f64>], cost: f64) -> f64 {
    let slack = |(x, costs): &(Vec<u32>, Vec<f32>)| {
        let more = f64::from(costs[1] - costs[0]);
        more.abs() * (1.0 - more.signum() * sum(w, x, 0)).max(0.0)
    };
    squares(w) / 2.0 + cost * small.examples.iter().map(slack).sum::<f64>()
}

fn ridge(small: &Small, w: &[Vec<f64>], l2: f64) -> f64 {
    let loss = |(x, costs): &(Vec<u32>, Vec<f32>)| {
        let best = (0..costs.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).expect("some action");
        let importance = costs.iter().map(|c| f64::from(c - costs[best])).sum::<f64>() / (costs.len() - 1) as f64;
        let value = -1.0 + 2.0 * best as f64 / (small.actions - 1) as f64;
        importance * (sum(w, x, 0) - value).powi(2)
    };
    l2 * squares(w) + small.examples.iter().map(loss).sum::<f64>()
}

fn smalls(actions: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = Small> {
    (1usize..=4, actions).prop_flat_map(|(features, actions)| {
        let dynamic = proptest::sample::subsequence((0..features as u32).collect::<Vec<_>>(), 1..=features);
        let costs = vec(0u8..=4, actions).prop_map(|c| c.into_iter().map(f32::from).collect());
        vec((dynamic, costs), 1..12).prop_map(move |examples| Small { features, actions, examples })
    })
}

/// Whether `objective` is nowhere smaller than at `w`: along the weights, on the way to 0 and in directions that are drawn, at three distances.
fn least(w: &[Vec<f64>], objective: impl Fn(&[Vec<f64>]) -> f64) -> Result<(), TestCaseError> {
    let here = objective(w);
    let mut draws = (0..).map(|i| Seed::new(i).unit() - 0.5);
    let (rows, columns) = (w.len(), w[0].len());
    for n in 0..200 {
        let direction: Vec<Vec<f64>> = (0..rows)
            .map(|r| {
                let one = |c: usize| if n / 2 == r * columns + c { 1.0 - 2.0 * (n % 2) as f64 } else { 0.0 };
                let drawn = n / 2 >= rows * columns;
                (0..columns).map(|c| if drawn { draws.next().expect("endless") } else { one(c) }).collect()
            })
            .collect();
        for step in [1.0, 0.1, 0.02] {
            let moved: Vec<Vec<f64>> =
                (w.iter().zip(&direction)).map(|(w, d)| w.iter().zip(d).map(|(w, d)| w + step * d).collect()).collect();
            prop_assert!(here <= objective(&moved) + 1e-4 * (1.0 + here), "{here} but {}", objective(&moved));
        }
    }
    let shrunk: Vec<Vec<f64>> = w.iter().map(|w| w.iter().map(|w| 0.98 * w).collect()).collect();
    prop_assert!(here <= objective(&shrunk) + 1e-4 * (1.0 + here));
    Ok(())
}

proptest! {
    #![proptest_config(fixed(300))]

    #[test]
    fn support_vector_machines_find_the_least(small in smalls(2..=2), cost in 0.05f32..2.0) {
        let learner = Svm { cost, passes: 5000, tolerance: 1e-5 };
        let w = small.weights(&small.fit(&learner));
        least(&w, |w| svm(&small, w, f64::from(cost)))?;
    }

    #[test]
    fn crammer_and_singer_find_the_least(small in smalls(2..=4), cost in 0.05f32..2.0) {
        let learner = CrammerSinger { cost, passes: 5000, tolerance: 1e-4 };
        let w = small.weights(&small.fit(&learner));
        least(&w, |w| crammer_singer(&small, w, f64::from(cost)))?;
    }

    #[test]
    fn ridge_regression_finds_the_least(small in smalls(2..=5), l2 in 0.01f32..3.0) {
        let classifier: Valued = small.fit(&Ridge { l2, ..Ridge::default() });
        let predict = |f: u32| {
            let view = Features { dynamic: vec![f], ..Features::default() };
            let sight = Sight { shared: &small.table(), view: &view, legal: Actions::All(small.actions as u32) };
            f64::from(classifier.predict(&sight, &mut Default::default()))
        };
        let w: Vec<Vec<f64>> = (0..small.features as u32).map(|f| vec![predict(f)]).collect();
        least(&w, |w| ridge(&small, w, f64::from(l2)))?;
    }

    /// A tree of one split against every other: costs lie nowhere closer to the means of two halves.
    #[test]
    fn a_tree_of_one_split_is_the_best_of_all(small in smalls(2..=4)) {
        let tree = small.fit(&CostTree { depth: 1, leaf: 1 });
        let counted = |costs: &[f32]| {
            let least = costs.iter().copied().fold(f32::INFINITY, f32::min);
            costs.iter().map(|c| f64::from(c - least)).collect::<Vec<_>>()
        };
        let distance = |predicted: &dyn Fn(&[u32]) -> Vec<f64>| -> f64 {
            let of = |(x, costs): &(Vec<u32>, Vec<f32>)| -> f64 {
                predicted(x).iter().zip(counted(costs)).map(|(p, c)| (p - c).powi(2)).sum()
            };
            small.examples.iter().map(of).sum()
        };
        let mean = |of: &dyn Fn(&[u32]) -> bool| {
            let half: Vec<Vec<f64>> = small.examples.iter().filter(|(x, _)| of(x)).map(|(_, c)| counted(c)).collect();
            let mean = |a: usize| half.iter().map(|c| c[a]).sum::<f64>() / half.len().max(1) as f64;
            (0..small.actions).map(mean).collect::<Vec<_>>()
        };
        let grown = distance(&|x| small.scores(&tree, x).iter().map(|s| -f64::from(*s)).collect());
        for feature in 0..small.features as u32 {
            let split = [mean(&|x| !x.contains(&feature)), mean(&|x| x.contains(&feature))];
            let other = distance(&|x| split[usize::from(x.contains(&feature))].clone());
            prop_assert!(grown <= other + 1e-4, "{grown} above {other}");
        }
    }
}

/// ½w² + C max(0, 1 - w) is least at min(C, 1); n equal examples are one with n C.
#[test]
fn one_example_and_many_equal_ones() {
    for (count, cost, expected) in [(1, 0.25, 0.25), (3, 0.25, 0.75), (5, 0.25, 1.0), (1, 7.0, 1.0)] {
        let small = Small { features: 1, actions: 2, examples: vec![(vec![0], vec![0.0, 1.0]); count] };
        let found = small.weights(&small.fit(&Svm { cost, ..Svm::default() }));
        assert!((found[0][0] - expected).abs() < 1e-6, "{found:?}");
        // Both actions have weights here, w and -w: w² + C max(0, 1 - 2w) is least at min(C, 1/2).
        let found = small.weights(&small.fit(&CrammerSinger { cost, ..CrammerSinger::default() }));
        let expected = (f64::from(cost) * count as f64).min(0.5);
        assert!((found[0][0] - expected).abs() < 1e-3 && (found[0][1] + expected).abs() < 1e-3, "{found:?}");
    }
}

/// Values -1, 0 and 1: two examples of the feature say 1, one says 0, so w (3 + l2) = 2; what is between two actions goes to the nearer.
#[test]
fn ridge_regression_by_hand() {
    let cost = |best: usize| (0..3).map(|a| if a == best { 0.0 } else { 1.0 }).collect::<Vec<f32>>();
    let examples = vec![(vec![0], cost(2)), (vec![0], cost(2)), (vec![0], cost(1))];
    let small = Small { features: 1, actions: 3, examples };
    for (l2, expected) in [(1.0, 0.5), (0.5, 2.0 / 3.5)] {
        let scores = small.scores(&small.fit(&Ridge { l2, ..Ridge::default() }), &[0]);
        let found = [-1.0, 0.0, 1.0f32].map(|value| -(value - expected).abs());
        assert!(scores.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-5), "{scores:?}");
    }
}

/// An exclusive or of two features needs two splits, or hidden units, and is beyond every linear classifier.
#[test]
fn trees_and_nets_learn_an_exclusive_or() {
    let cost = |best: usize| if best == 0 { vec![0.0, 1.0] } else { vec![1.0, 0.0] };
    let cases: [(&[u32], usize); 4] = [(&[2], 0), (&[0, 2], 1), (&[1, 2], 1), (&[0, 1, 2], 0)];
    // The first case thrice: of four even ones, no single split explains anything.
    let shown = cases.iter().chain([&cases[0], &cases[0]]);
    let examples = shown.map(|(x, best)| (x.to_vec(), cost(*best))).collect();
    let small = Small { features: 3, actions: 2, examples };
    let net = Net { units: 8, passes: 2000, batch: 2, rate: 0.02, step: Step::Adam, ..Net::default() };
    let adagrad = Net { step: Step::Adagrad, rate: 0.2, ..net.clone() };
    let (tree, net, adagrad) = (small.fit(&CostTree { depth: 2, leaf: 1 }), small.fit(&net), small.fit(&adagrad));
    for (x, best) in cases {
        for scores in [small.scores(&tree, x), small.scores(&net, x), small.scores(&adagrad, x)] {
            assert_eq!(Actions::All(2).best(&scores), Action(best as u32), "{x:?}: {scores:?}");
        }
    }
}

/// With the same gap g between two scores everywhere, right with share q, the likeliest temperature is g / ln(q / (1 - q)).
#[test]
fn a_temperature_by_hand() {
    let mut examples = Examples::default();
    for i in 0..10 {
        let label = Target::Label(Action(u32::from(i >= 8)));
        examples.push(&Features::default(), Actions::All(2), label);
    }
    let table = FeatureTable::new(0);
    let setting = Setting { shared: &table, actions: 2 };
    let sure = calibrate(Constant(vec![3.0, 0.0]), setting, &examples);
    assert!((f64::from(sure.temperature) - 3.0 / 4.0f64.ln()).abs() < 1e-4, "{}", sure.temperature);
    let measured = Reliability::of(&sure, setting, &examples);
    assert!(measured.error < 1e-5, "{measured:?}");
    let entropy = -(0.8 * 0.8f64.ln() + 0.2 * 0.2f64.ln());
    assert!((measured.loss - entropy).abs() < 1e-5, "{measured:?}");
    // As it was, it was too sure: e^3 / (1 + e^3) for 0.8.
    let before =
        Reliability::of(&Calibrated { classifier: Constant(vec![3.0, 0.0]), temperature: 1.0 }, setting, &examples);
    assert!((before.error - (1.0 / (1.0 + (-3.0f64).exp()) - 0.8)).abs() < 1e-5 && before.loss > measured.loss);
    // Nothing to go by.
    assert_eq!(calibrate(Constant(vec![3.0, 0.0]), setting, &Examples::default()).temperature, 1.0);
}

/// Learners whose classifiers are not linear, under every trainer but those that need them to learn online (the net does that too).
#[test]
fn every_trainer_takes_trees_and_nets() {
    fn check<L: Learner<Features, Classifier: Clone>>(learner: &L) {
        let problem = problem(&sample(Labels::Free(3), 30));
        let (run, all) = (Run::new(1), tokens(&problem) as f64);
        let right = |costs: Vec<f64>| 1.0 - costs.iter().sum::<f64>() / all;
        let supervised = Supervised::default().train(&problem, learner, &run).unwrap().policy;
        let forward = Forward::default().train(&problem, learner, &run).unwrap().policy;
        let smile = Smile::default().train(&problem, learner, &run).unwrap().policy;
        let searn = Searn { rounds: 2, ..Searn::default() }.train(&problem, learner, &run).unwrap().policy;
        let dagger = Dagger::default().train(&problem, learner, &run).unwrap().policy;
        let cpi = Cpi { rounds: 2, ..Cpi::default() }.train(&problem, learner, &run).unwrap().policy;
        let aggrevate = Aggrevate::default().train_by(&problem, learner, &Shortcut, &run).unwrap().policy;
        let lols = Lols { rounds: 2, ..Lols::default() }.train(&problem, learner, &run).unwrap().policy;
        // Two labels in three go with the word; a label is one of three. Forward training sees few examples a step.
        for costs in [
            perform(&problem, &supervised, Seed::new(2)).0.costs,
            perform(&problem, &forward, Seed::new(2)).0.costs,
            perform(&problem, &smile, Seed::new(2)).0.costs,
            perform(&problem, &searn, Seed::new(2)).0.costs,
            perform(&problem, &dagger, Seed::new(2)).0.costs,
            perform(&problem, &aggrevate, Seed::new(2)).0.costs,
            perform(&problem, &lols, Seed::new(2)).0.costs,
        ] {
            assert!(right(costs.clone()) > 0.55, "{}", right(costs));
        }
        // CPI learns from one state a sentence and mixes the expert in.
        assert!(right(perform(&problem, &cpi, Seed::new(2)).0.costs) > 0.4);
    }
    check(&Net { units: 16, rate: 0.02, ..Net::default() });
    check(&CostTree::default());
    let problem = problem(&sample(Labels::Free(3), 30));
    let net = Net { units: 16, rate: 0.02, ..Net::default() };
    let online = |seed| Dagger::default().train_online(&problem, &net, &Run::new(seed)).unwrap().policy;
    assert!(online(1).0 == online(1).0 && online(1).0 != online(2).0);
    let searching = Lols { rounds: 3, ..Lols::default() }.train_online(&problem, &net, &Run::new(1)).unwrap().policy;
    let costs = perform(&problem, &searching, Seed::new(2)).0.costs;
    assert!(1.0 - costs.iter().sum::<f64>() / tokens(&problem) as f64 > 0.55);
    // A net goes on from where it was.
    let setting = Setting::of(&problem);
    let nothing = Net { passes: 0, ..net.clone() }.fit(setting, &Examples::default(), Some(&online(1).0), Seed::new(7));
    let done = |net| perform(&problem, &rollin::policy::Greedy(net), Seed::new(2)).0.actions;
    assert!(done(nothing) == done(online(1).0));
}
