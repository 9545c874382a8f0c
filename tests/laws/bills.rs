//! Labels and the whole bill: exact where nothing is left to chance, within six standard deviations elsewhere.

use crate::common::{Labels, any_corpora, corpora, fixed, learners, problem, rolls_out, sample, tokens, trainers};
use proptest::prelude::*;
use rollin::Seed;
use rollin::space::{Episode, Imitation, Problem, Space};
use rollin::tasks::Trainer;
use rollin::tasks::tagging::TaggingProblem;
use rollin::theory::ledgers::{Expected, Extent};
use rollin::trainer::{
    Aggrevate, Cpi, Dagger, EarlyUpdate, Forward, Lols, Rate, Run, Schedule, Searn, Smile, Stacking,
};
use rollin::worker::{Ledger, Worker};

fn rounds(trainer: &Trainer) -> u64 {
    match trainer {
        Trainer::Supervised(_) | Trainer::Forward(_) => 1,
        Trainer::Smile(smile) => smile.rounds as u64,
        Trainer::Searn(searn) | Trainer::SearnOnline(searn) | Trainer::SearnShortcut(searn) => searn.rounds as u64,
        Trainer::Dagger(dagger) | Trainer::DaggerOnline(dagger) => dagger.rounds as u64,
        Trainer::Cpi(cpi) => cpi.rounds as u64,
        Trainer::Aggrevate(aggrevate) => aggrevate.rounds as u64,
        Trainer::Lols(lols) | Trainer::LolsOnline(lols) => lols.rounds as u64,
        Trainer::Stacked(_) => 2,
        // The expert goes through once.
        Trainer::EarlyUpdate(_) => 1,
    }
}

fn lengths(problem: &TaggingProblem) -> Vec<f64> {
    (0..problem.episodes()).map(|i| problem.space.horizon(i).expect("sentences have lengths") as f64).collect()
}

fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-9 * (1.0 + expected)
}

/// Everything but the acts, which are left to chance. In SEARN the number of roll-outs is, too, unless labels are free.
fn same_but_for_acts(trainer: &Trainer, ledger: Ledger, expected: Expected, free: bool) {
    let found = Expected::from(ledger);
    assert!(near(found.labels, expected.labels), "{trainer:?}: {found:?} for {expected:?}");
    assert!(near(found.examples, expected.examples), "{trainer:?}: {found:?} for {expected:?}");
    if let Trainer::EarlyUpdate(_) = trainer {
        assert!(found.steps <= expected.steps && found.resets <= expected.resets, "{found:?} above {expected:?}");
        assert!(found.resets > 0.0 && found.rollouts == 0.0);
    } else if free && !matches!(trainer, Trainer::Cpi(_)) || !rolls_out(trainer) {
        assert!(near(found.steps, expected.steps), "{trainer:?}: {found:?} for {expected:?}");
        assert!(near(found.rollouts, expected.rollouts), "{trainer:?}: {found:?} for {expected:?}");
        assert!(near(found.resets, expected.resets), "{trainer:?}: {found:?} for {expected:?}");
    }
    let consulted = if rolls_out(trainer) { ledger.expert_acts + ledger.rollout_acts } else { ledger.labels };
    assert_eq!(ledger.queries, consulted, "{trainer:?}: a state is one query, labelled, driven or both");
}

proptest! {
    #![proptest_config(fixed(24))]

    /// For every trainer with every learner on random corpora of any kind.
    #[test]
    fn labels_are_exact(sentences in any_corpora(40, 12)) {
        let problem = problem(&sentences);
        let (n, extent) = (tokens(&problem), Extent::of(&problem));
        let free = problem.space.transitions().order() == rollin::tasks::tagging::Order::Free;
        for trainer in trainers() {
            for learner in learners() {
                let trained = trainer.train(&problem, &learner, &Run::new(1)).unwrap();
                let ledger = trained.ledger;
                let labels = if rolls_out(&trainer) { 0 } else { rounds(&trainer) * n };
                prop_assert_eq!(ledger.labels, labels, "{:?} with {:?}", trainer, learner);
                let states = if let Trainer::Cpi(_) = trainer { problem.episodes() as u64 } else { n };
                prop_assert_eq!(ledger.examples, rounds(&trainer) * states);
                same_but_for_acts(&trainer, ledger, trainer.expected(&extent), free);
                // The last entry of the book is the bill, and it never goes down.
                prop_assert_eq!(trained.rounds.last().unwrap().ledger, ledger);
                prop_assert!(trained.rounds.windows(2).all(|two| two[0].ledger.steps < two[1].ledger.steps));
            }
        }
    }

    /// Supervised, forward and DAgger leave nothing to chance; nor does a mixture with rate 1.
    #[test]
    fn bills_without_chance_are_exact(sentences in corpora(Labels::Free(3), 20, 8)) {
        let problem = problem(&sentences);
        let extent = Extent::of(&problem);
        let whole = Dagger { rounds: 2, warm: true, schedule: None };
        let lols = |beta| Lols { beta, rounds: 3, warm: true };
        let searn = Searn { beta: 1.0, rounds: 2, samples: 3, warm: true };
        let certain = [
            Trainer::Supervised(Default::default()),
            Trainer::Forward(Default::default()),
            Trainer::Dagger(whole.clone()),
            Trainer::DaggerOnline(whole.clone()),
            Trainer::Dagger(Dagger { schedule: Some(Schedule::Exponential(0.0)), ..whole.clone() }),
            Trainer::DaggerOnline(Dagger { schedule: Some(Schedule::First), ..whole }),
            Trainer::Aggrevate(Aggrevate { rounds: 3, warm: true, schedule: Schedule::Linear(1) }),
            Trainer::Lols(lols(1.0)),
            Trainer::Lols(lols(0.0)),
            Trainer::LolsOnline(lols(1.0)),
            Trainer::LolsOnline(lols(0.0)),
            Trainer::Stacked(Stacking { folds: 4, window: 2 }),
            Trainer::Smile(Smile { alpha: 1.0, rounds: 3, warm: true, ..Smile::default() }),
            Trainer::Searn(searn.clone()),
            Trainer::SearnOnline(searn.clone()),
            Trainer::SearnShortcut(searn),
        ];
        for trainer in certain {
            let ledger = trainer.train(&problem, &learners()[0], &Run::new(1)).unwrap().ledger;
            let (found, expected) = (Expected::from(ledger), trainer.expected(&extent));
            let pairs = [
                (found.labels, expected.labels), (found.expert_acts, expected.expert_acts),
                (found.rollout_acts, expected.rollout_acts), (found.queries, expected.queries),
                (found.rollouts, expected.rollouts), (found.resets, expected.resets),
                (found.steps, expected.steps), (found.examples, expected.examples),
            ];
            prop_assert!(pairs.iter().all(|(f, e)| near(*f, *e)), "{trainer:?}: {found:?} for {expected:?}");
        }
    }
}

/// Six standard deviations, from sums of independent terms: a fixed seed, so this passes always or never.
fn within(found: u64, expected: f64, variance: f64, what: &str) {
    let off = (found as f64 - expected).abs();
    assert!(off <= 6.0 * variance.sqrt() + 1e-6, "{what}: {found} for {expected} +- {}", variance.sqrt());
    assert!(variance > 100.0, "{what}: too little chance to test");
}

/// The sum of p(1-p) over the rounds, p the expert's share in each.
fn spread(rate: f64, rounds: usize) -> f64 {
    (0..rounds as i32).map(|i| (1.0 - rate).powi(i)).map(|p| p * (1.0 - p)).sum()
}

/// Whether the expert acts is one independent draw at each step of a roll-in: a round's acts have variance S p (1-p).
#[test]
fn the_experts_acts_are_as_many_as_predicted() {
    for labels in [Labels::Free(4), Labels::Spans(2)] {
        let problem = problem(&sample(labels, 300));
        let (extent, n) = (Extent::of(&problem), tokens(&problem) as f64);
        for (rate, rounds) in [(0.1, 6), (0.4, 4), (0.7, 3)] {
            let smile = Trainer::Smile(Smile { alpha: rate, rounds, warm: true, ..Smile::default() });
            let searn = Trainer::SearnShortcut(Searn { beta: rate, rounds, ..Searn::default() });
            for trainer in [smile, searn] {
                for seed in 1..=2 {
                    let ledger = trainer.train(&problem, &learners()[0], &Run::new(seed)).unwrap().ledger;
                    let expected = trainer.expected(&extent);
                    within(ledger.expert_acts, expected.expert_acts, n * spread(rate, rounds), &format!("{trainer:?}"));
                }
            }
        }
    }
}

/// In roll-outs the draw of step t' belongs to episode, sample and t' and is shared by all roll-outs that pass t':
/// one from each of the t'-1 states before it for each of A actions. So a round's acts have variance k p (1-p) sum
/// over t' of (A (t'-1))^2.
#[test]
fn roll_out_acts_are_as_many_as_predicted() {
    let problem = problem(&sample(Labels::Free(3), 120));
    let (extent, n, actions) = (Extent::of(&problem), tokens(&problem) as f64, problem.space.actions() as f64);
    let squares: f64 = lengths(&problem)
        .iter()
        .map(|l| (0..*l as usize).map(|before| (actions * before as f64).powi(2)).sum::<f64>())
        .sum();
    for samples in [1, 3] {
        for (beta, rounds) in [(0.2, 3), (0.6, 3)] {
            let trainer = Trainer::Searn(Searn { beta, rounds, samples, warm: false });
            let ledger = trainer.train(&problem, &learners()[0], &Run::new(1)).unwrap().ledger;
            let (expected, what) = (trainer.expected(&extent), format!("{trainer:?}"));
            same_but_for_acts(&trainer, ledger, expected, true);
            let spread = spread(beta, rounds);
            within(ledger.expert_acts, expected.expert_acts, n * spread, &what);
            within(ledger.rollout_acts, expected.rollout_acts, samples as f64 * squares * spread, &what);
            within(ledger.queries, expected.queries, (n + samples as f64 * squares) * spread, &what);
        }
    }
}

/// One independent draw a step of a round's roll-ins, with a share that follows the schedule.
#[test]
fn schedules_are_driven_as_often_as_predicted() {
    let problem = problem(&sample(Labels::Spans(2), 300));
    let (extent, n) = (Extent::of(&problem), tokens(&problem) as f64);
    for schedule in [Schedule::Exponential(0.6), Schedule::Linear(4)] {
        let dagger = Dagger { rounds: 5, warm: true, schedule: Some(schedule) };
        let aggrevate = Aggrevate { rounds: 5, warm: true, schedule };
        let spread: f64 = (1..=5).map(|i| schedule.share(i)).map(|p| p * (1.0 - p)).sum();
        for trainer in [Trainer::Dagger(dagger.clone()), Trainer::DaggerOnline(dagger), Trainer::Aggrevate(aggrevate)] {
            let ledger = trainer.train(&problem, &learners()[0], &Run::new(3)).unwrap().ledger;
            within(ledger.expert_acts, trainer.expected(&extent).expert_acts, n * spread, &format!("{trainer:?}"));
        }
    }
}

/// LOLS draws once a state who rolls out, for all A actions: the acts of a round have variance beta (1-beta) sum (A (L-t))^2.
/// Of CPI's rounds only bounds are used: a state's roll-outs and the steps before it are at most k A L + L acts.
#[test]
fn drawn_roll_outs_are_as_many_as_predicted() {
    let problem = problem(&sample(Labels::Free(3), 200));
    let extent = Extent::of(&problem);
    let squares = |of: &dyn Fn(f64) -> f64| lengths(&problem).iter().map(|l| of(*l)).sum::<f64>();
    let rests = squares(&|l| (0..l as usize).map(|rest| (3.0 * rest as f64).powi(2)).sum());
    for beta in [0.3, 0.8] {
        let lols = Lols { beta, rounds: 4, warm: false };
        for (trainer, rounds) in [(Trainer::Lols(lols.clone()), 3.0), (Trainer::LolsOnline(lols), 4.0)] {
            let ledger = trainer.train(&problem, &learners()[0], &Run::new(1)).unwrap().ledger;
            let expected = trainer.expected(&extent).rollout_acts;
            within(ledger.rollout_acts, expected, rounds * beta * (1.0 - beta) * rests, &format!("{trainer:?}"));
        }
    }
    let cpi = Cpi { rate: Rate::Fixed(0.3), rounds: 3, samples: 2, warm: false };
    let trainer = Trainer::Cpi(cpi);
    let (ledger, expected) =
        (trainer.train(&problem, &learners()[0], &Run::new(1)).unwrap().ledger, trainer.expected(&extent));
    let most = 3.0 * squares(&|l| (7.0 * l).powi(2)) / 4.0;
    within(ledger.queries, expected.queries, most, "cpi");
    within(ledger.rollout_acts, expected.rollout_acts, most, "cpi");
    within(ledger.steps, expected.steps, most, "cpi");
    assert_eq!(ledger.rollouts as f64, expected.rollouts);
}

/// Of one deviation an episode nothing but the length of the expert's share is left to chance: L-1 acts while it drives alone, L-1-t where t is
/// uniform, of variance (L^2-1)/12, after that.
#[test]
fn single_deviations_are_billed_as_predicted() {
    let problem = problem(&sample(Labels::Spans(2), 200));
    let aggrevate = Aggrevate { rounds: 4, ..Aggrevate::default() };
    let ledger = aggrevate.train(&problem, &rollin::learner::Csoaa::default(), &Run::new(1)).unwrap().ledger;
    let expected = rollin::theory::ledgers::aggrevate(&Extent::of(&problem), &aggrevate);
    let variance = 3.0 * lengths(&problem).iter().map(|l| (l * l - 1.0) / 12.0).sum::<f64>();
    within(ledger.expert_acts, expected.expert_acts, variance, "aggrevate");
    assert_eq!((ledger.examples as f64, ledger.steps as f64), (expected.examples, expected.steps));
    assert_eq!((ledger.labels, ledger.resets, ledger.queries), (0, 0, ledger.expert_acts));
    // With roll-outs of the expert in place of its cost-to-go: the same examples, another bill.
    let free = crate::common::problem(&sample(Labels::Free(3), 30));
    let (aggrevate, extent) = (Aggrevate { rounds: 2, ..aggrevate }, Extent::of(&free));
    let (learner, mixed) = (rollin::learner::Perceptron::default(), rollin::roll::Mixed { expert: 1.0 });
    let ledger = aggrevate.train_by(&free, &learner, &mixed, &Run::new(1)).unwrap().ledger;
    assert_eq!(Expected::from(ledger), rollin::theory::ledgers::aggrevate_rollouts(&extent, &aggrevate));
}

/// A beam of one never goes back.
#[test]
fn a_beam_of_one_needs_no_reset() {
    let problem = problem(&sample(Labels::Free(3), 20));
    for (width, resets) in [(1, false), (2, true)] {
        let trainer = Trainer::EarlyUpdate(EarlyUpdate { width, rounds: 2 });
        let ledger = trainer.train(&problem, &learners()[0], &Run::new(1)).unwrap().ledger;
        assert_eq!(ledger.resets > 0, resets);
        assert!(Expected::from(ledger).resets <= trainer.expected(&Extent::of(&problem)).resets);
    }
}

/// Forward training pays for prefixes only: L(L-1)/2 steps for an episode of length L, and no act of the expert.
#[test]
fn forward_training_pays_for_prefixes() {
    let Imitation { space, expert, .. } = problem(&sample(Labels::Spans(1), 9));
    let problem = Imitation { space, expert, episodes: 9 };
    let trained = Trainer::Forward(Default::default()).train(&problem, &learners()[0], &Run::new(1)).unwrap();
    let steps: f64 = lengths(&problem).iter().map(|l| l * (l - 1.0) / 2.0).sum();
    assert_eq!((trained.ledger.steps as f64, trained.ledger.expert_acts), (steps, 0));
    assert_eq!(trained.policy.classifiers().len() as f64, lengths(&problem).iter().copied().fold(0.0, f64::max));
}

/// Steps beyond the longest get no classifier, no label and no step of the environment.
#[test]
fn forward_training_stops_at_the_longest() {
    let problem = problem(&sample(Labels::Free(3), 20));
    let longest = 4;
    assert!(lengths(&problem).iter().any(|length| *length > longest as f64));
    let trainer = Trainer::Forward(Forward { longest, ..Forward::default() });
    let trained = trainer.train(&problem, &learners()[0], &Run::new(1)).unwrap();
    assert_eq!(trained.policy.classifiers().len(), longest);
    assert_eq!(Expected::from(trained.ledger), trainer.expected(&Extent::of(&problem)));
}

/// However often a state's label is read, and whether the expert drives there as well: one label, one act, one query.
#[test]
fn a_state_is_billed_once() {
    let problem = problem(&sample(Labels::Free(3), 9));
    let mut worker = Worker::new(&problem);
    for index in 0..9 {
        worker.episode(Episode { index, seed: Seed::new(1) }, |visit| {
            let answer = visit.label();
            assert_eq!(answer, visit.label());
            let mut costs = Vec::new();
            visit.costs_to_go(&mut costs);
            assert_eq!(costs.len(), 3);
            assert_eq!(answer, Some(visit.expert()));
            answer
        });
    }
    let n = tokens(&problem);
    assert_eq!(worker.ledger(), Ledger { labels: n, expert_acts: n, queries: n, steps: n, ..Ledger::default() });
}
