//! The real trainers on tabular problems, where everything they should find is known exactly.
//!
//! Problems and seeds are fixed, so each test passes always or never. That it should pass is by margin: a choice between actions rests on
//! 40,000 episodes, and problems are only used where the best action of every view leads by a margin that such a sample misses with
//! probability below 1e-9 (Hoeffding).

use ndarray::{Array1, Array2, Array3, Axis};
use rand::RngExt;
use rollin::learner::Tabular as Learner;
use rollin::policy::Greedy;
use rollin::roll::perform;
use rollin::roll::{Mixed, Shortcut};
use rollin::tasks::tabular::{Tabled, Tabular};
use rollin::theory::bounds::safe_step;
use rollin::theory::population::Class;
use rollin::theory::{Mdp, Parts, Table, evaluate, ledgers};
use rollin::trainer::{Aggrevate, Cpi, Dagger, Forward, Rate, Reuse, Run, Searn, Smile, Supervised};
use rollin::{Purpose, Seed};

const EPISODES: usize = 40_000;

/// A random problem of 4 states, seen as 3 views, and 2 actions; horizon 3.
fn random(number: u64) -> (Mdp, Vec<usize>) {
    let mut rng = Seed::new(number).child(Purpose::Episode, 0).rng();
    let (states, actions) = (4, 2);
    let mut distribution = |n: usize| {
        let weights: Vec<f64> = (0..n).map(|_| -rng.random::<f64>().ln()).collect();
        let sum: f64 = weights.iter().sum();
        weights.into_iter().map(move |w| w / sum).collect::<Vec<f64>>()
    };
    let start = Array1::from(distribution(states));
    let rows: Vec<f64> = (0..states * actions).flat_map(|_| distribution(states)).collect();
    let next = Array3::from_shape_vec((states, actions, states), rows).expect("the shape");
    let cost = Array2::from_shape_fn((states, actions), |_| rng.random::<f64>());
    let expert = (0..states).map(|_| rng.random_range(0..actions)).collect();
    let mdp = Mdp::new(Parts { horizon: 3, start, next, cost, expert }).expect("a valid problem");
    (mdp, vec![0, 1, 2, 2])
}

/// The problems on which every choice has at least this margin, of the first hundred.
fn clear<'a>(
    margin: f64,
    choices: impl Fn(&Class<'_>) -> Vec<(Table, f64)> + 'a,
) -> Vec<(Mdp, Vec<usize>, Vec<Table>)> {
    let problems = (0..100).map(random).filter_map(|(mdp, view)| {
        let found = choices(&Class::new(&mdp, &view).expect("a view a state"));
        let tables =
            found.iter().all(|(_, m)| *m >= margin).then(|| found.into_iter().map(|(table, _)| table).collect())?;
        Some((mdp, view, tables))
    });
    let problems: Vec<_> = problems.take(6).collect();
    assert!(problems.len() >= 3, "only {} problems are clear enough", problems.len());
    problems
}

fn space(mdp: &Mdp, view: &[usize]) -> Tabular {
    Tabular::new(mdp.clone(), view).expect("a view a state")
}

#[test]
fn supervised_finds_the_best_of_its_class() {
    // 0-1 loss per step: e^(-2 * 40,000 * 0.03^2) < 1e-31 per view even if the steps of an episode all agreed.
    for (mdp, view, best) in clear(0.03, |class| vec![class.supervised().expect("valid")]) {
        let space = space(&mdp, &view);
        let trained =
            Supervised::default().train(&space.clone().problem(EPISODES), &Learner, &Run::new(3)).expect("trains");
        assert_eq!(space.table_of(&trained.policy.0), best[0]);
    }
}

#[test]
fn forward_finds_the_best_of_its_class() {
    for (mdp, view, best) in clear(0.03, |class| class.forward()) {
        let space = space(&mdp, &view);
        let trained =
            Forward::default().train(&space.clone().problem(EPISODES), &Learner, &Run::new(3)).expect("trains");
        let steps: Vec<Table> = trained.policy.steps().iter().map(|step| space.table_of(step)).collect();
        assert_eq!(steps, best);
    }
}

#[test]
fn smile_finds_the_best_of_its_class_however_it_reuses() {
    let (alpha, rounds) = (0.3, 3);
    for (mdp, view, best) in clear(0.03, |class| class.smile(alpha, rounds).expect("valid")) {
        for reuse in [Reuse::None, Reuse::Coins, Reuse::Sites, Reuse::Ageing] {
            let space = space(&mdp, &view);
            let smile = Smile { alpha, rounds, reuse, ..Smile::default() };
            let trained = smile.train(&space.clone().problem(EPISODES), &Learner, &Run::new(3)).expect("trains");
            let found: Vec<Table> = trained.policy.members().iter().map(|(_, c)| space.table_of(c)).collect();
            assert_eq!(found, best, "{reuse:?}");
        }
    }
}

#[test]
fn searn_finds_the_best_of_its_class() {
    // Costs-to-go differ by at most 3, 2 and 1 at the three steps, 6 in sum: e^(-2 * 40,000 * 0.2^2 / 12^2) < 1e-9.
    let (beta, rounds) = (0.3, 2);
    for (mdp, view, best) in clear(0.2, |class| class.searn(beta, rounds).expect("valid")) {
        let space = space(&mdp, &view);
        let searn = Searn { beta, rounds, ..Searn::default() };
        let trained = searn.train(&space.clone().problem(EPISODES), &Learner, &Run::new(3)).expect("trains");
        let found: Vec<Table> = trained.policy.members().iter().map(|(_, c)| space.table_of(c)).collect();
        assert_eq!(found, best);
        // The first round's mixture is the expert, so there the shortcut is exact.
        let first = Searn { rounds: 1, ..searn };
        let short =
            first.train_by(&space.clone().problem(EPISODES), &Learner, &Shortcut, &Run::new(3)).expect("trains");
        assert_eq!(space.table_of(&short.policy.members()[0].1), best[0]);
    }
}

/// One example an episode, of a step drawn of three: three times its costs stand for the sum, differences within 18 for those within 12 of
/// SEARN's test above, and four times as many episodes: e^(-2 * 160,000 * 0.2^2 / 18^2) < 1e-16 a view.
#[test]
fn cpi_finds_the_best_of_its_class() {
    let (beta, rounds) = (0.3, 2);
    for (mdp, view, best) in clear(0.2, |class| class.searn(beta, rounds).expect("valid")) {
        let space = space(&mdp, &view);
        let cpi = Cpi { rate: Rate::Fixed(beta), rounds, ..Cpi::default() };
        let trained = cpi.train(&space.clone().problem(4 * EPISODES), &Learner, &Run::new(3)).expect("trains");
        let found: Vec<Table> = trained.policy.members().iter().map(|(_, c)| space.table_of(c)).collect();
        assert_eq!(found, best);
    }
}

/// An expert that is bad for the costs is improved on: the first classifier's disadvantage is below 0, so training goes on, and the step that theory
/// allows makes the mixture cheaper by what it promises. The disadvantage is measured on 40,000 episodes twice, of costs within 3: a standard
/// error below 0.02, and only experts that are 0.15 from perfect are looked at.
#[test]
fn cpi_improves_on_a_bad_expert() {
    let mut improved = 0;
    for (mdp, _) in (0..8).map(random) {
        let view = [0, 1, 2, 3];
        let (problem, expert) = (space(&mdp, &view).problem(EPISODES), evaluate(&mdp, &mdp.star()).expect("valid"));
        let cpi = Cpi { rate: Rate::Advantage, rounds: 2, ..Cpi::default() };
        let trained = cpi.train(&problem, &Learner, &Run::new(1)).expect("trains");
        let first = space(&mdp, &view).table_of(&trained.policy.members()[0].1);
        // A_1: what one uniformly drawn step of it adds.
        let steps = (expert.advantages() * first.rows()).sum_axis(Axis(2));
        let disadvantage = (&expert.visits * &steps).sum() / 3.0;
        assert!(disadvantage <= 0.0, "what sees everything is no worse than the expert: {disadvantage}");
        if disadvantage < -0.15 {
            improved += 1;
            assert_eq!(trained.rounds.len(), 2);
            let (step, gain) = safe_step(disadvantage, 3).expect("a gain");
            let blended = Table::mixture(&[(1.0 - step, &mdp.star()), (step, &first)]).expect("weights");
            assert!(evaluate(&mdp, &blended).expect("valid").cost <= expert.cost - gain);
        }
    }
    assert!(improved >= 2, "only {improved} experts were bad enough");
}

/// In the first round the expert drives and its cost-to-go is what goes on: AggreVaTe looks for what SEARN looks for, by cost-to-go, by roll-outs
/// and by single deviations. Those stand for the sum with 3 * 2 times a cost of at most 3, 2 or 1: a standard deviation of at most 13, of the
/// mean of 160,000 at most 0.033, a sixth of the margin.
#[test]
fn aggrevate_finds_the_best_of_its_class() {
    for (mdp, view, best) in clear(0.2, |class| class.searn(0.5, 1).expect("valid")) {
        let space = space(&mdp, &view);
        let (problem, run) = (space.clone().problem(4 * EPISODES), Run::new(3));
        let aggrevate = Aggrevate { rounds: 1, ..Aggrevate::default() };
        let trained = [
            aggrevate.train(&problem, &Learner, &run).expect("trains"),
            aggrevate.train_by(&problem, &Learner, &Shortcut, &run).expect("trains"),
            aggrevate.train_by(&problem, &Learner, &Mixed { expert: 1.0 }, &run).expect("trains"),
        ];
        for trained in trained {
            assert_eq!(space.table_of(&trained.policy.0), best[0]);
        }
    }
}

#[test]
fn sampled_costs_agree_with_exact_ones() {
    for number in 0..10 {
        let (mdp, view) = random(number);
        let space = space(&mdp, &view);
        let problem = space.clone().problem(EPISODES);
        let smile = Smile { alpha: 0.4, rounds: 2, ..Smile::default() };
        let mixture = smile.train(&problem, &Learner, &Run::new(number)).expect("trains").policy;
        let tables: Vec<Table> = mixture.members().iter().map(|(_, c)| space.table_of(c)).collect();
        let members: Vec<(f64, &Table)> = mixture.members().iter().map(|(w, _)| *w).zip(&tables).collect();
        let exact = evaluate(&mdp, &Table::mixture(&members).expect("weights")).expect("valid").cost;
        let (done, ledger) = perform(&problem, &mixture, Seed::new(number));
        let mean = done.costs.iter().sum::<f64>() / EPISODES as f64;
        let variance = done.costs.iter().map(|cost| (cost - mean).powi(2)).sum::<f64>() / EPISODES as f64;
        // Seven standard errors: 3e-12 for each of ten.
        let error = (variance / EPISODES as f64).sqrt();
        assert!((mean - exact).abs() < 7.0 * error, "{mean} for {exact}, standard error {error}");
        assert_eq!(ledger.queries, 0);
    }
}

#[test]
fn bills_agree_with_expectations() {
    let (mdp, view) = random(1);
    let problem = space(&mdp, &view).problem(EPISODES);
    let extent = ledgers::Extent::of(&problem);
    let (m, horizon) = (EPISODES as f64, 3.0);
    for reuse in [Reuse::None, Reuse::Printed42, Reuse::Coins, Reuse::Ageing] {
        let smile = Smile { alpha: 0.3, rounds: 4, reuse, ..Smile::default() };
        let ledger = smile.train(&problem, &Learner, &Run::new(9)).expect("trains").ledger;
        let expected = ledgers::smile(&extent, &smile);
        // Each round's labels are T times a binomial of m, its expert acts a sum of m numbers in [0, T].
        let error = horizon * (m * 3.0 / 4.0).sqrt();
        assert!((ledger.labels as f64 - expected.labels).abs() <= 7.0 * error, "{reuse:?}: {ledger:?}, {expected:?}");
        assert!(
            (ledger.expert_acts as f64 - expected.expert_acts).abs() <= 7.0 * error,
            "{reuse:?}: {ledger:?}, {expected:?}"
        );
        if reuse == Reuse::None {
            assert_eq!(ledger.labels as f64, expected.labels);
        }
    }
    let searn = Searn { beta: 0.3, rounds: 2, samples: 2, ..Searn::default() };
    let ledger = searn.train(&problem, &Learner, &Run::new(9)).expect("trains").ledger;
    let expected = ledgers::searn(&extent, &searn);
    assert_eq!((ledger.rollouts as f64, ledger.steps as f64), (expected.rollouts, expected.steps));
    // Roll-outs share their randomness: at most 3 draws for m episodes, 2 samples, each counted at most 6 times.
    let error = 6.0 * (m * 2.0 * 3.0).sqrt();
    assert!((ledger.rollout_acts as f64 - expected.rollout_acts).abs() <= 7.0 * error, "{ledger:?}, {expected:?}");
    let dagger = Dagger { rounds: 3, ..Dagger::default() };
    let ledger = dagger.train(&problem, &Learner, &Run::new(9)).expect("trains").ledger;
    assert_eq!(ledgers::Expected::from(ledger), ledgers::dagger(&extent, &dagger));
}

#[test]
fn greedy_policies_cost_what_tables_say() {
    let (mdp, view) = random(2);
    let space = space(&mdp, &view);
    let problem = space.clone().problem(EPISODES);
    let trained = Supervised::default().train(&problem, &Learner, &Run::new(1)).expect("trains");
    let exact = evaluate(&mdp, &space.table_of(&trained.policy.0)).expect("valid").cost;
    let (done, _) =
        perform::<rollin::space::Imitation<Tabular, Tabled>, Greedy<_>>(&problem, &trained.policy, Seed::new(4));
    let mean = done.costs.iter().sum::<f64>() / EPISODES as f64;
    // Costs are in [0, 3]: the standard error is at most 1.5 / 200.
    assert!((mean - exact).abs() < 7.0 * 1.5 / 200.0);
}
