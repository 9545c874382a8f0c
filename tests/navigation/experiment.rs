//! The experiment of `benches/results/navigation.md`: who generalises to new maps, and what it asks the expert.

use crate::common::{drawn, ratio};
use rollin::learner::Logistic;
use rollin::policy::{Greedy, Reading};
use rollin::space::Features;
use rollin::tasks::navigation::{Cheapest, Eyes, Maps, MaximumMargin, Navigation, Place, Planner};
use rollin::trainer::{Dagger, Run, Smile, Supervised};
use rollin::worker::Ledger;
use rollin::{Purpose, Seed, learner::Learner, space::Imitation};

const SEEDS: u64 = 20;
/// The 97.5 % point of Student's t with 19 degrees of freedom.
const T: f64 = 2.093;

/// Maps with the costs of five terrains drawn log-uniformly from 1 to 20.
fn maps(seed: u64, rough: f64) -> Maps {
    let cost = |terrain| 20f64.powf(Seed::new(seed).child(Purpose::Evaluation, terrain).unit());
    Maps { costs: (0..5).map(cost).collect(), rough, ..Maps::default() }
}

/// Mean and half the width of its 95 % confidence interval over the seeds.
fn interval(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, T * (variance / n).sqrt())
}

type Problem<V> = Imitation<Navigation<V>, Cheapest>;

/// The path cost ratios on `test` after learning on `train`, and the bills: supervised, SMILe sampled, SMILe by its mean, DAgger.
fn learn<V: Eyes, L: Learner<V>>(train: &Problem<V>, test: &Problem<V>, learner: &L, seed: u64) -> [(f64, Ledger); 4] {
    let run = Run::new(seed);
    let smile = Smile { alpha: 0.3, rounds: 5, ..Smile::default() };
    let supervised = Supervised::default().train(train, learner, &run).expect("trains");
    let dagger = Dagger { rounds: 5, ..Dagger::default() }.train(train, learner, &run).expect("trains");
    let smile = smile.train(train, learner, &run).expect("trains");
    let sampled = ratio(test, &smile.policy);
    [
        (ratio(test, &supervised.policy), supervised.ledger),
        (sampled, smile.ledger),
        (ratio(test, &smile.policy.read_as(Reading::Mean)), smile.ledger),
        (ratio(test, &dagger.policy), dagger.ledger),
    ]
}

const NAMES: [&str; 10] = [
    "supervised, planning",
    "SMILe, planning, sampled",
    "SMILe, planning, mean",
    "DAgger, planning",
    "supervised, logistic",
    "SMILe, logistic, sampled",
    "SMILe, logistic, mean",
    "DAgger, logistic",
    "planning, nothing learned: fewest steps",
    "planning, the costs of terrains known",
];

/// One row a method, one column a seed.
fn measure(count: usize, rough: f64) -> Vec<Vec<(f64, Ledger)>> {
    let mut rows = vec![Vec::new(); NAMES.len()];
    for seed in 1..=SEEDS {
        let maps = maps(seed, rough);
        let (train, test) = (drawn::<Place>(&maps, count, seed), drawn::<Place>(&maps, 100, 1000 + seed));
        let found = learn(&train, &test, &MaximumMargin::default(), seed);
        let least = maps.costs.iter().copied().fold(f64::INFINITY, f64::min);
        let known = maps.costs.iter().map(|cost| cost / least - 1.0).collect();
        let bounds =
            [vec![0.0; 5], known].map(|weights| (ratio(&test, &Greedy(Planner { weights })), Ledger::default()));
        let (train, test) = (drawn::<Features>(&maps, count, seed), drawn::<Features>(&maps, 100, 1000 + seed));
        let plain = learn(&train, &test, &Logistic::default(), seed);
        for (row, cell) in rows.iter_mut().zip(found.into_iter().chain(plain).chain(bounds)) {
            row.push(cell);
        }
    }
    rows
}

/// Means with 95 % confidence intervals over 20 seeds, each with its own hidden costs, maps to learn from and 100 new maps.
#[test]
#[ignore = "takes minutes"]
fn published_figures() {
    for (count, rough) in [(10, 0.0), (100, 0.0), (10, 0.5), (100, 0.5)] {
        let rows = measure(count, rough);
        println!(
            "\n{count} maps, rough {rough}\n\n| policy | path cost ratio | labels | expert acts | steps |\n|---|--:|--:|--:|--:|"
        );
        for (name, row) in NAMES.iter().zip(&rows) {
            let (mean, half) = interval(&row.iter().map(|(ratio, _)| *ratio).collect::<Vec<_>>());
            let bill: Ledger = row.iter().map(|(_, bill)| *bill).sum();
            let [labels, acts, steps] = [bill.labels, bill.expert_acts, bill.steps].map(|n| n / SEEDS);
            println!("| {name} | {mean:.4} ± {half:.4} | {labels} | {acts} | {steps} |");
        }
        let difference = |a: usize, b: usize| {
            let gaps: Vec<f64> = rows[a].iter().zip(&rows[b]).map(|((a, _), (b, _))| a - b).collect();
            let (mean, half) = interval(&gaps);
            println!("{} less {}: {mean:.4} ± {half:.4}", NAMES[a], NAMES[b]);
            (mean, half)
        };
        println!();
        let (planned, half) = difference(1, 5);
        assert!(planned + half < 0.0, "planning is to pay");
        for (a, b) in [(1, 0), (2, 0), (3, 0), (5, 4), (7, 4)] {
            difference(a, b);
        }
    }
}
