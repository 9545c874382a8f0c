//! What exact answers cost as problems grow: asserts them, then times them.
//!
//! `cargo bench --bench theory`; with `ROLLIN_FULL=1` also one audit of 500 states, 4 actions, 100 steps and 50 rounds,
//! which has to take less than a minute on one core.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use ndarray::{Array1, Array2, Array3};
use rand::RngExt;
use rollin::theory::audit::{Audit, audit};
use rollin::theory::instance::Instance;
use rollin::theory::korder::{costs, orders};
use rollin::theory::mixing::Smile;
use rollin::theory::reuse::Reuse;
use rollin::theory::{Mdp, Parts, Table, closed, evaluate};
use rollin::{Purpose, Seed};
use std::hint::black_box;
use std::time::Instant;

/// S, A, T and N.
#[derive(Clone, Copy)]
struct Size(usize, usize, usize, usize);

impl std::fmt::Display for Size {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "S={} A={} T={} N={}", self.0, self.1, self.2, self.3)
    }
}

/// A dense random instance with every input.
fn instance(Size(states, actions, horizon, rounds): Size) -> Instance {
    let mut rng = Seed::new(1).child(Purpose::Episode, 0).rng();
    let mut rows = |count: usize, n: usize| {
        let mut rows = Array2::from_shape_fn((count, n), |_| -(1.0 - rng.random::<f64>()).ln());
        rows.outer_iter_mut().for_each(|mut row| row /= row.sum());
        rows
    };
    let start: Array1<f64> = rows(1, states).row(0).to_owned();
    let cost = rows(states, actions);
    let next: Array3<f64> =
        rows(states * actions, states).into_shape_with_order((states, actions, states)).expect("the shape");
    let mut tables =
        |count| (0..count).map(|_| Table::new("table", rows(states, actions)).expect("rows")).collect::<Vec<_>>();
    let (hats, ladder, policy) = (tables(rounds), tables(horizon), tables(1).pop());
    let expert = (0..states).map(|s| s * 7 % actions).collect();
    Instance {
        mdp: Mdp::new(Parts { horizon, start, next, cost, expert }).expect("a problem"),
        policy,
        ladder: Some(ladder),
        hats: Some(hats),
        rounds: Some(rounds),
        rate: Some(0.05),
        view: Some((0..states).map(|s| s % 10).collect()),
        samples: Some(1000),
        rollouts: Some(1),
    }
}

/// One size doubled at a time.
const SIZES: [Size; 5] =
    [Size(50, 4, 20, 4), Size(100, 4, 20, 4), Size(50, 8, 20, 4), Size(50, 4, 40, 4), Size(50, 4, 20, 8)];

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(1.0)
}

/// O(T S^2 A). The cost is the same from the front, by states, as from the back, by costs-to-go.
fn evaluation(c: &mut Criterion) {
    let mut group = c.benchmark_group("evaluate");
    for size in
        [Size(100, 4, 50, 0), Size(200, 4, 50, 0), Size(400, 4, 50, 0), Size(200, 8, 50, 0), Size(200, 4, 100, 0)]
    {
        let Instance { mdp, policy, .. } = instance(size);
        let policy = policy.expect("one");
        let found = evaluate(&mdp, &policy).expect("it fits");
        let charge = (policy.rows() * mdp.cost()).sum_axis(ndarray::Axis(1));
        assert!(near(found.visits.dot(&charge).sum(), found.cost));
        group.bench_function(BenchmarkId::from_parameter(size), |b| b.iter(|| evaluate(black_box(&mdp), &policy)));
    }
    group.finish();
}

/// O(T^2 S (S + T)), costs alone O(T^2 S^2 + T^3). The mixture of two policies costs the binomial mean of Jbar_k.
fn order(c: &mut Criterion) {
    let mut group = c.benchmark_group("orders");
    for size in [Size(100, 4, 50, 0), Size(200, 4, 50, 0), Size(200, 4, 100, 0), Size(200, 4, 200, 0)] {
        let Instance { mdp, policy, .. } = instance(size);
        let (star, policy) = (mdp.star(), policy.expect("one"));
        let mixture = Table::mixture(&[(0.9, &star), (0.1, &policy)]).expect("a mixture");
        let exact = evaluate(&mdp, &mixture).expect("it fits").cost;
        let all = orders(&mdp, &star, &policy).expect("they fit").costs;
        let alone = costs(&mdp, &star, &policy).expect("they fit").costs;
        let mass = closed::binomial(size.2, 0.1, 0.9);
        for found in [&all, &alone] {
            assert!(near(mass.iter().zip(found).map(|(p, cost)| p * cost).sum(), exact));
        }
        assert!(all.iter().zip(&alone).all(|(a, b)| near(*a, *b)));
        group.bench_function(BenchmarkId::new("all", size), |b| b.iter(|| orders(black_box(&mdp), &star, &policy)));
        group.bench_function(BenchmarkId::new("costs", size), |b| b.iter(|| costs(black_box(&mdp), &star, &policy)));
    }
    group.finish();
}

/// O(N T^2 S (S + T)). The repaired laws add up to the truth, and averages are averages.
fn laws(c: &mut Criterion) {
    let mut group = c.benchmark_group("reuse");
    group.sample_size(10);
    for size in SIZES {
        let Instance { mdp, hats, rate, .. } = instance(size);
        let (hats, rate) = (hats.expect("some"), rate.expect("one"));
        let mixing = Smile::of(&mdp, &hats, rate).expect("they fit").mixing;
        let (full, means) = (Reuse::of(&mdp, &mixing, &hats), Reuse::means(&mdp, &mixing, &hats));
        let (full, means) = (full.expect("they fit"), means.expect("they fit"));
        for n in 1..=size.3 {
            let repaired =
                &full.truth[n - 1] * (1.0 - full.fresh42[n - 1]) + &full.exact42[n - 1] * full.fresh42[n - 1];
            assert!((repaired - &full.truth[n]).iter().all(|gap| gap.abs() < 1e-12));
            for (law, mean) in [(&full.chain42[n], &means.chain42[n]), (&full.chain43[n], &means.chain43[n])] {
                let average = law.sum_axis(ndarray::Axis(0)) / size.2 as f64;
                assert!((average - mean.row(0)).iter().all(|gap| gap.abs() < 1e-12));
            }
        }
        group.bench_function(BenchmarkId::new("steps", size), |b| {
            b.iter(|| Reuse::of(black_box(&mdp), &mixing, &hats));
        });
        group.bench_function(BenchmarkId::new("means", size), |b| {
            b.iter(|| Reuse::means(black_box(&mdp), &mixing, &hats));
        });
    }
    group.finish();
}

/// An audit that says everything, and of which every bound that applies holds.
fn sound(audit: &Audit) {
    assert!(audit.theorems.len() > 10);
    assert!(audit.theorems.iter().all(|bound| bound.holds() || !bound.applies()));
    let groups = [audit.forward.is_some(), audit.korder.is_some(), audit.smile.is_some(), audit.searn.is_some()];
    assert!(groups.iter().all(|there| *there));
    assert!(audit.reuse.is_some() && audit.counts.is_some() && audit.population.is_some());
}

/// O(N T S (A S + T S + T^2)).
fn everything(c: &mut Criterion) {
    let mut group = c.benchmark_group("audit");
    group.sample_size(10);
    for size in SIZES {
        let instance = instance(size);
        sound(&audit(&instance).expect("it is whole"));
        group.bench_function(BenchmarkId::from_parameter(size), |b| b.iter(|| audit(black_box(&instance))));
    }
    group.finish();
    if std::env::var_os("ROLLIN_FULL").is_some() {
        let size = Size(500, 4, 100, 50);
        let instance = instance(size);
        let clock = Instant::now();
        sound(&audit(&instance).expect("it is whole"));
        let seconds = clock.elapsed().as_secs_f64();
        println!("audit, {size}: {seconds:.1} s");
        assert!(seconds < 60.0, "{seconds} s");
    }
}

criterion_group!(benches, evaluation, order, laws, everything);
criterion_main!(benches);
