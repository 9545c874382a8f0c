//! Weights of mixtures and what is drawn by them; nobody asks an expert who is not there.

use crate::common::{
    Constant, Labels, agree, any_corpora, fixed, learners, problem, rolls_out, sample, tokens, trainers,
};
use proptest::prelude::*;
use rollin::learner::Perceptron;
use rollin::policy::{Member, Mixture, Policy, Reading};
use rollin::roll::Shortcut;
use rollin::roll::perform;
use rollin::space::{CostToGo, Expert, Imitation};
use rollin::tasks::tagging::{Gold, Position, Tagging};
use rollin::tasks::{Learned, Trainer};
use rollin::trainer::{
    Aggrevate, Cpi, Dagger, EarlyUpdate, Forward, Lols, Run, Schedule, Searn, Smile, Stacking, Supervised,
};
use rollin::worker::Ledger;
use rollin::{Purpose, Seed};
use std::sync::atomic::{AtomicU64, Ordering};

fn weights<C>(mixture: &Mixture<C>) -> Vec<f64> {
    mixture.members().iter().map(|(weight, _)| *weight).collect()
}

/// After n rounds at this rate: the weights by the formulas, and the mixture by its updates.
fn grown(rate: f64, n: usize, searn: bool) -> (Vec<f64>, f64, Mixture<usize>) {
    let mut mixture = Mixture::of_expert();
    for i in 0..n {
        if searn { mixture.blend(rate, i) } else { mixture.replace_expert(rate, i) }
    }
    let power = |i: usize| if searn { n - 1 - i } else { i };
    let formula = (0..n).map(|i| rate * (1.0 - rate).powi(power(i) as i32)).collect();
    (formula, (1.0 - rate).powi(n as i32), mixture)
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12
}

proptest! {
    #![proptest_config(fixed(1000))]

    /// SMILe gives classifier i alpha (1-alpha)^(i-1) and SEARN beta (1-beta)^(n-i); the expert keeps (1-rate)^n. All
    /// is a distribution at every time, and without the expert the same ratios make one.
    #[test]
    fn weights_follow_the_formulas(rate in prop_oneof![Just(1.0), 1e-3..1.0], n in 0usize..60, searn: bool) {
        let (formula, expert, mixture) = grown(rate, n, searn);
        let found = weights(&mixture);
        prop_assert!(close(mixture.expert(), expert) && found.len() == n);
        prop_assert!(found.iter().zip(&formula).all(|(w, f)| close(*w, *f) && *w >= 0.0), "{found:?} {formula:?}");
        prop_assert!(close(found.iter().sum::<f64>() + mixture.expert(), 1.0));
        prop_assert!(mixture.members().iter().map(|(_, i)| *i).eq(0..n));

        let alone = mixture.without_expert();
        if n == 0 {
            prop_assert_eq!(alone.expert(), 1.0);
        } else {
            let (kept, rest) = (weights(&alone), 1.0 - expert);
            prop_assert_eq!(alone.expert(), 0.0);
            prop_assert!(close(kept.iter().sum::<f64>(), 1.0) && kept.iter().all(|w| *w >= 0.0));
            prop_assert!(kept.iter().zip(&formula).all(|(w, f)| (w - f / rest).abs() <= 1e-12 / rest));
        }
    }

    /// In SMILe a classifier's weight never changes again; in SEARN it shrinks by the same factor in every round.
    #[test]
    fn later_rounds_leave_smiles_weights_alone(rate in 1e-3..0.999, n in 1usize..30) {
        let (smile, searn) = (grown(rate, n, false).2, grown(rate, n, true).2);
        let (smile_next, searn_next) = (grown(rate, n + 1, false).2, grown(rate, n + 1, true).2);
        prop_assert_eq!(&weights(&smile_next)[..n], &weights(&smile)[..]);
        prop_assert!(weights(&searn_next).iter().zip(weights(&searn)).all(|(w, v)| *w == v * (1.0 - rate)));
        // One is the other's mirror image.
        prop_assert!(weights(&smile).iter().zip(weights(&searn).iter().rev()).all(|(a, b)| close(*a, *b)));
    }

    /// Every number in [0, 1) draws a member with weight; the borders lie where the weights add up.
    #[test]
    fn draws_land_between_the_sums(rate in 0.05..1.0, n in 1usize..12, unit in 0.0f64..1.0, searn: bool) {
        let (formula, expert, mixture) = grown(rate, n, searn);
        let borders: Vec<f64> =
            formula.iter().chain([&expert]).scan(0.0, |sum, w| { *sum += w; Some(*sum) }).collect();
        prop_assume!(borders.iter().all(|border| (unit - border).abs() > 1e-9));
        let place = borders.iter().position(|border| unit < *border);
        let expected = match place.expect("the weights sum to 1") {
            i if i == n => Member::Expert,
            i => Member::Classifier(i),
        };
        prop_assert_eq!(mixture.draw(unit), expected);
        prop_assert!(matches!(mixture.without_expert().draw(unit), Member::Classifier(_)));
    }

    /// Whatever is trained is without expert: its weights are those of its updates, renormalised, to the bit.
    #[test]
    fn trained_weights_are_the_renormalised_ones(
        rate in prop_oneof![Just(1.0), 0.05..1.0],
        rounds in 1usize..6,
        sentences in any_corpora(3, 4),
    ) {
        let (problem, learner, run) = (problem(&sentences), Perceptron { passes: 1 }, Run::new(3));
        let smile = Smile { alpha: rate, rounds, ..Smile::default() }.train(&problem, &learner, &run).unwrap().policy;
        let searn = Searn { beta: rate, rounds, ..Searn::default() }.train(&problem, &learner, &run).unwrap().policy;
        for (policy, is_searn) in [(smile, false), (searn, true)] {
            prop_assert_eq!(policy.expert(), 0.0);
            prop_assert_eq!(weights(&policy), weights(&grown(rate, rounds, is_searn).2.without_expert()));
        }
    }
}

/// 100,000 keyed draws, chi-square: chance of failing below 2.1e-9 for each of 16 mixtures if the seed were free; it
/// is fixed.
#[test]
fn draws_are_as_frequent_as_weights() {
    for (i, (rate, n, searn)) in [0.2, 0.5]
        .into_iter()
        .flat_map(|r| [(r, 1), (r, 4)])
        .flat_map(|(r, n)| [(r, n, false), (r, n, true)])
        .enumerate()
    {
        let (formula, expert, mixture) = grown(rate, n, searn);
        let rest = 1.0 - expert;
        let without: Vec<f64> = std::iter::once(0.0).chain(formula.iter().map(|w| w / rest)).collect();
        let with: Vec<f64> = std::iter::once(expert).chain(formula).collect();
        for (mixture, shares) in [(mixture.clone(), with), (mixture.without_expert(), without)] {
            let mut counts = vec![0; n + 1];
            for step in 0..100_000 {
                let seed = Seed::new(i as u64).child(Purpose::Step, step).child(Purpose::Member, 0);
                counts[match mixture.draw(seed.unit()) {
                    Member::Expert => 0,
                    Member::Classifier(k) => k + 1,
                }] += 1;
            }
            agree(&counts, &shares).unwrap();
        }
    }
}

/// The same through a whole run: constant classifiers show which member acted. About 6,500 steps; chance of failing
/// below 2.1e-9 each if the seed were free; it is fixed. Consecutive steps are drawn independently: pairs have the
/// products of the weights.
#[test]
fn runs_draw_members_anew_at_every_step() {
    let problem = problem(&sample(Labels::Free(4), 1000));
    let shares = [0.4, 0.3, 0.2, 0.1];
    let members = shares.iter().enumerate().map(|(a, w)| (*w, Constant::always(a, 4))).collect();
    let mixture = Mixture::of(members, Default::default()).unwrap();
    let (done, ledger) = perform(&problem, &mixture, Seed::new(11));
    assert_eq!((ledger.queries, ledger.steps), (0, tokens(&problem)));
    let (mut counts, mut pairs) = ([0; 4], [0; 16]);
    done.actions.iter().for_each(|a| counts[a.index()] += 1);
    // Pairs that do not overlap.
    done.actions.as_chunks::<2>().0.iter().for_each(|[a, b]| pairs[4 * a.index() + b.index()] += 1);
    agree(&counts, &shares).unwrap();
    let products: Vec<f64> = shares.iter().flat_map(|a| shares.map(|b| a * b)).collect();
    agree(&pairs, &products).unwrap();
}

/// [`Gold`], with a counter.
struct Counted(AtomicU64);

impl Counted {
    fn calls(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

impl Expert<Tagging> for Counted {
    fn action(&self, space: &Tagging, state: &Position) -> Option<rollin::space::Action> {
        self.0.fetch_add(1, Ordering::Relaxed);
        Gold.action(space, state)
    }
}

impl CostToGo<Tagging> for Counted {
    fn costs(&self, space: &Tagging, state: &Position, costs: &mut Vec<f64>) {
        Gold.costs(space, state, costs);
    }
}

type CountedProblem = Imitation<Tagging, Counted>;

/// The queries of training are the calls that the expert got, but for roll-outs, which are billed also where their rest is
/// remembered; and the policy never calls it.
fn trained_without<D: Policy<CountedProblem>>(problem: &CountedProblem, before: u64, policy: &D, ledger: Ledger) {
    let calls = problem.expert.calls();
    match ledger.rollouts {
        0 => assert_eq!(ledger.queries, calls - before),
        _ => assert!(ledger.queries >= calls - before),
    }
    assert!(calls > before);
    let (done, bill) = perform(problem, policy, Seed::new(5));
    assert_eq!(problem.expert.calls(), calls, "a policy that should be on its own asked the expert");
    assert_eq!(bill, Ledger { steps: tokens(problem), ..Ledger::default() });
    assert_eq!(done.actions.len() as u64, tokens(problem));
}

proptest! {
    #![proptest_config(fixed(40))]

    #[test]
    fn queries_are_calls_and_no_policy_asks(sentences in any_corpora(12, 8)) {
        let space = problem(&sentences).space;
        let episodes = space.sentences();
        let problem = Imitation { space, expert: Counted(AtomicU64::new(0)), episodes };
        let (learner, run) = (Perceptron { passes: 1 }, Run::new(9));
        let calls = || problem.expert.calls();

        let (before, trained) = (calls(), Supervised::default().train(&problem, &learner, &run).unwrap());
        trained_without(&problem, before, &trained.policy, trained.ledger);
        let (before, trained) = (calls(), Forward::default().train(&problem, &learner, &run).unwrap());
        trained_without(&problem, before, &trained.policy, trained.ledger);
        let (before, trained) = (calls(), Smile::default().train(&problem, &learner, &run).unwrap());
        trained_without(&problem, before, &trained.policy, trained.ledger);
        let searn = Searn { rounds: 2, ..Searn::default() };
        let (before, trained) = (calls(), searn.train(&problem, &learner, &run).unwrap());
        trained_without(&problem, before, &trained.policy, trained.ledger);
        let (before, trained) = (calls(), searn.train_by(&problem, &learner, &Shortcut, &run).unwrap());
        trained_without(&problem, before, &trained.policy, trained.ledger);
        let (before, trained) = (calls(), Dagger::default().train(&problem, &learner, &run).unwrap());
        trained_without(&problem, before, &trained.policy, trained.ledger);
        let (before, trained) = (calls(), Dagger::default().train_online(&problem, &learner, &run).unwrap());
        trained_without(&problem, before, &trained.policy, trained.ledger);
        let half = Dagger { schedule: Some(Schedule::Exponential(0.5)), ..Dagger::default() };
        let (before, trained) = (calls(), half.train(&problem, &learner, &run).unwrap());
        trained_without(&problem, before, &trained.policy, trained.ledger);
        let (before, trained) = (calls(), half.train_online(&problem, &learner, &run).unwrap());
        trained_without(&problem, before, &trained.policy, trained.ledger);
        let (before, trained) = (calls(), Cpi::default().train(&problem, &learner, &run).unwrap());
        trained_without(&problem, before, &trained.policy, trained.ledger);
        let aggrevate = Aggrevate { rounds: 2, ..Aggrevate::default() };
        let (before, trained) = (calls(), aggrevate.train_by(&problem, &learner, &Shortcut, &run).unwrap());
        trained_without(&problem, before, &trained.policy, trained.ledger);
        let lols = Lols { rounds: 2, ..Lols::default() };
        let (before, trained) = (calls(), lols.train(&problem, &learner, &run).unwrap());
        trained_without(&problem, before, &trained.policy, trained.ledger);
        let (before, trained) = (calls(), Stacking::default().train(&problem, &learner, &run).unwrap());
        trained_without(&problem, before, &trained.policy.first, trained.ledger);
        let after = calls();
        prop_assert_eq!(trained.policy.perform(&problem, Seed::new(5)).1.queries, 0);
        let beam = EarlyUpdate { rounds: 2, ..EarlyUpdate::default() };
        let trained = beam.train(&problem, &run).unwrap();
        prop_assert_eq!(trained.ledger.queries, calls() - after);
        prop_assert_eq!(trained.policy.perform(&problem, Seed::new(5)).1.queries, 0);
        prop_assert_eq!(trained.ledger.queries, calls() - after);
    }
}

/// The mixture with its expert still in it does ask: the counter above is not blind.
#[test]
fn a_mixture_with_expert_asks() {
    let problem = problem(&sample(Labels::Free(3), 50));
    let mut mixture = Mixture::of_expert();
    mixture.replace_expert(0.5, Constant::always(0, 3));
    let (_, ledger) = perform(&problem, &mixture, Seed::new(1));
    assert!(ledger.expert_acts > 0 && ledger.expert_acts < ledger.steps);
    assert_eq!(ledger.queries, ledger.expert_acts);
    assert_eq!(perform(&problem, &mixture.without_expert(), Seed::new(1)).1.queries, 0);
}

/// Only those who roll out put the system back, and beams.
#[test]
fn only_roll_outs_need_resets() {
    let problem = problem(&sample(Labels::Spans(2), 12));
    for learner in learners() {
        for trainer in trainers() {
            let ledger = trainer.train(&problem, &learner, &Run::new(2)).unwrap().ledger;
            let rolls_out = rolls_out(&trainer);
            if let Trainer::EarlyUpdate(_) = trainer {
                assert!(ledger.resets > 0 && ledger.rollouts == 0);
                continue;
            }
            assert_eq!(ledger.rollouts, ledger.resets);
            assert_eq!(ledger.resets > 0, rolls_out, "{trainer:?}: {ledger:?}");
            assert!(rolls_out || ledger.rollout_acts == 0);
        }
    }
}

/// A [`Learned`] policy is a mixture or a ladder by its trainer, and reading it otherwise does not bring the expert
/// back.
#[test]
fn no_reading_asks_the_expert() {
    let problem = problem(&sample(Labels::Spans(1), 10));
    for trainer in trainers() {
        let policy: Learned = trainer.train(&problem, &learners()[0], &Run::new(2)).unwrap().policy;
        for reading in [Reading::Sampled, Reading::Vote, Reading::Mean] {
            let (_, ledger) = perform(&problem, &policy.clone().read_as(reading), Seed::new(5));
            assert_eq!((ledger.queries, ledger.expert_acts), (0, 0));
        }
    }
}

/// A ladder meets sentences longer than any it was trained on: the last classifier finishes them, the expert is not
/// asked.
#[test]
fn a_ladder_asks_nobody_beyond_its_end() {
    let mut sentences = sample(Labels::Spans(2), 20);
    sentences.sort_by_key(|sentence| sentence.len());
    let Imitation { space, expert, episodes } = problem(&sentences);
    let short = Imitation { space: space.clone(), expert, episodes: episodes / 2 };
    let all = Imitation { space, expert, episodes };
    assert!(sentences[episodes / 2 - 1].len() < sentences[episodes - 1].len());
    let trained = Forward::default().train(&short, &Perceptron::default(), &Run::new(1)).unwrap();
    assert_eq!(trained.policy.steps().len(), sentences[episodes / 2 - 1].len());
    let (_, ledger) = perform(&all, &trained.policy, Seed::new(1));
    assert_eq!(ledger, Ledger { steps: tokens(&all), ..Ledger::default() });
}
