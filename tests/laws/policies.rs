//! What policies do: their memory does not matter, and their readings are what they say.

use crate::common::{
    Constant, Labels, any_corpora, corpora, deep_problem, drawn, fixed, learners, problem, rolls_out, sample, trainers,
};
use proptest::collection::vec;
use proptest::prelude::*;
use rollin::learner::{Examples, Learner, Logistic, Online, Perceptron, Setting, Target};
use rollin::policy::{Classifier, Columns, Greedy, Ladder, Linear, Mixture, Policy, Reading, Weights};
use rollin::roll::perform;
use rollin::space::{Action, Actions, Episode, FeatureTable, Features, Problem, Sight, Space};
use rollin::tasks::tagging::TaggingProblem;
use rollin::tasks::{AnyClassifier, AnyLearner};
use rollin::tasks::{Learned, Trainer};
use rollin::trainer::Run;
use rollin::worker::Worker;
use rollin::{Purpose, Seed};

/// What `policy` does with fresh memory at every step.
fn forgetful<D: Policy<TaggingProblem>>(problem: &TaggingProblem, policy: &D, seed: Seed) -> Vec<Action> {
    let mut worker = Worker::new(problem);
    let mut actions = Vec::new();
    for index in 0..problem.episodes() {
        worker.episode(Episode { index, seed: seed.child(Purpose::Episode, index as u64) }, |visit| {
            let action = policy.act(visit, &mut Default::default());
            actions.push(action);
            Some(action)
        });
    }
    actions
}

/// One memory for everything, and the episodes twice, the second time backwards.
fn remembering<D: Policy<TaggingProblem>>(problem: &TaggingProblem, policy: &D, seed: Seed) -> Vec<Vec<Action>> {
    let mut worker = Worker::new(problem);
    let mut memory = D::Memory::default();
    let n = problem.episodes();
    let mut actions = vec![Vec::new(); n];
    for index in (0..n).chain((0..n).rev()) {
        actions[index].clear();
        worker.episode(Episode { index, seed: seed.child(Purpose::Episode, index as u64) }, |visit| {
            let action = policy.act(visit, &mut memory);
            actions[index].push(action);
            Some(action)
        });
    }
    actions
}

fn memory_does_not_matter(problem: &TaggingProblem) {
    for trainer in trainers() {
        for learner in learners() {
            let policy: Learned = trainer.train(problem, &learner, &Run::new(1)).unwrap().policy;
            for reading in [Reading::Sampled, Reading::Vote, Reading::Mean] {
                let policy = policy.clone().read_as(reading);
                let plain = forgetful(problem, &policy, Seed::new(2));
                assert!(
                    perform(problem, &policy, Seed::new(2)).0.actions == plain,
                    "{trainer:?} {learner:?} {reading:?}"
                );
                assert!(
                    remembering(problem, &policy, Seed::new(2)).concat() == plain,
                    "{trainer:?} {learner:?} {reading:?}"
                );
            }
        }
    }
}

#[test]
fn memory_does_not_matter_in_short_sentences() {
    memory_does_not_matter(&problem(&sample(Labels::Spans(2), 30)));
}

/// A thread remembers 256 rows: in sentences of 300 and 600 tokens slots are used again and again.
#[test]
fn memory_does_not_matter_in_long_sentences() {
    let mut sentences = drawn(vec(corpora(Labels::Free(3), 1, 300), 40), 3).concat();
    sentences.sort_by_key(|sentence| sentence.len());
    let long =
        [&sentences[sentences.len() - 2..].concat()[..], &sentences[sentences.len() / 2 + 5]].map(|s| s.to_vec());
    assert!(long[0].len() > 512, "{} tokens", long[0].len());
    let problem = problem(&long.to_vec());
    let slow = |t: &Trainer| rolls_out(t) || matches!(t, Trainer::Forward(_));
    let no_roll_outs = trainers().into_iter().filter(|t| !slow(t));
    for trainer in no_roll_outs {
        for learner in learners() {
            let policy = trainer.train(&problem, &learner, &Run::new(1)).unwrap().policy;
            for reading in [Reading::Sampled, Reading::Vote] {
                let policy = policy.clone().read_as(reading);
                let plain = forgetful(&problem, &policy, Seed::new(2));
                assert!(perform(&problem, &policy, Seed::new(2)).0.actions == plain, "{trainer:?} {learner:?}");
                assert!(remembering(&problem, &policy, Seed::new(2)).concat() == plain, "{trainer:?} {learner:?}");
            }
        }
    }
}

/// What `policy` does at the start of a sentence of which `labels` labels are possible.
fn first<D: Policy<TaggingProblem>>(policy: &D, problem: &TaggingProblem) -> usize {
    let mut action = Action(0);
    Worker::new(problem).episode(Episode { index: 0, seed: Seed::new(1) }, |visit| {
        action = policy.act(visit, &mut Default::default());
        None
    });
    action.index()
}

fn free(labels: usize) -> TaggingProblem {
    problem(&vec![Labels::Free(labels).names().iter().map(|l| ("w".to_owned(), l.to_string())).collect()])
}

/// The first place of the largest.
fn lowest_best(totals: &[f64]) -> usize {
    totals.iter().position(|t| totals.iter().all(|other| t >= other)).expect("there is one")
}

proptest! {
    #![proptest_config(fixed(1000))]

    /// Weights and scores are small binary fractions, so every sum is exact in any order and ties are common.
    #[test]
    fn vote_and_mean_are_what_they_say(
        labels in 2usize..=5,
        scores in vec(vec(-4i8..=4, 5), 1..6),
        parts in vec(0u8..5, 6),
    ) {
        let problem = free(labels);
        let mut shares: Vec<f64> = parts[..scores.len()].iter().map(|p| f64::from(*p) / 32.0).collect();
        shares[0] += 1.0 - shares.iter().sum::<f64>();
        let members: Vec<(f64, Constant)> = shares
            .iter()
            .zip(&scores)
            .map(|(share, scores)| (*share, Constant(scores[..labels].iter().map(|s| f32::from(*s) / 4.0).collect())))
            .collect();
        let (mut votes, mut means) = (vec![0.0; labels], vec![0.0; labels]);
        for (share, Constant(scores)) in &members {
            let scores: Vec<f64> = scores.iter().map(|s| f64::from(*s)).collect();
            votes[lowest_best(&scores)] += share;
            means.iter_mut().zip(&scores).for_each(|(mean, score)| *mean += share * score);
        }
        let read = |reading| first(&Mixture::of(members.clone(), reading).unwrap(), &problem);
        prop_assert_eq!(read(Reading::Vote), lowest_best(&votes));
        prop_assert_eq!(read(Reading::Mean), lowest_best(&means));
    }
}

#[test]
fn readings_worked_by_hand() {
    let problem = free(3);
    let members = |list: &[(f64, [f32; 3])]| list.iter().map(|(w, s)| (*w, Constant(s.to_vec()))).collect::<Vec<_>>();
    let read = |list: &[(f64, [f32; 3])], reading| first(&Mixture::of(members(list), reading).unwrap(), &problem);
    // Two weak voices for 2 outvote one strong one for 0, but not in the mean: 0.4 * 9 against 0.6 * 1.
    let loud = [(0.4, [9.0, 0.0, 0.0]), (0.3, [0.0, 0.0, 1.0]), (0.3, [0.0, 0.0, 1.0])];
    assert_eq!((read(&loud, Reading::Vote), read(&loud, Reading::Mean)), (2, 0));
    // Ties go to the lowest action, not to the first member.
    let tied = [(0.5, [0.0, 0.0, 1.0]), (0.5, [0.0, 1.0, 0.0])];
    assert_eq!((read(&tied, Reading::Vote), read(&tied, Reading::Mean)), (1, 1));
    // A lone member reads the same in every way.
    let lone = [(1.0, [0.0, 2.0, 2.0])];
    assert_eq!((read(&lone, Reading::Vote), read(&lone, Reading::Mean), read(&lone, Reading::Sampled)), (1, 1, 1));
    assert_eq!(first(&Greedy(Constant(vec![0.0, 2.0, 2.0])), &problem), 1);
}

/// Only legal actions count, however high the others score: I-NP may not begin a sentence.
#[test]
fn illegal_actions_are_never_taken() {
    let sentence = ["B-NP", "I-NP", "O"].map(|label| ("w".to_owned(), label.to_owned())).to_vec();
    let problem = problem(&vec![sentence]);
    assert_eq!(problem.space.legal(&problem.space.start(Episode { index: 0, seed: Seed::new(1) })).len(), 2);
    for reading in [Reading::Sampled, Reading::Vote, Reading::Mean] {
        let one = Constant(vec![-2.0, 5.0, -1.0]);
        let members = vec![(0.5, one.clone()), (0.5, one)];
        assert_eq!(first(&Mixture::of(members, reading).unwrap(), &problem), 2, "{reading:?}");
    }
}

/// Step t is classifier t's, and all steps beyond the last are the last one's.
#[test]
fn ladders_go_step_by_step() {
    let problem = problem(&vec![Labels::Free(4).names().iter().map(|l| ("w".to_owned(), l.to_string())).collect()]);
    let ladder = Ladder::of(vec![Constant::always(2, 4), Constant::always(0, 4), Constant::always(3, 4)]);
    let (done, ledger) = perform(&problem, &ladder, Seed::new(1));
    assert_eq!(done.actions, [2, 0, 3, 3].map(Action));
    assert_eq!(ledger.queries, 0);
    // With the expert still at the end it drives there, and is billed.
    let mut begun = Ladder::new();
    begun.push(Constant::always(2, 4));
    let (done, ledger) = perform(&problem, &begun, Seed::new(1));
    assert_eq!((done.actions, ledger.expert_acts), ([2, 1, 2, 3].map(Action).to_vec(), 3));
}

fn scores(classifier: &AnyClassifier, problem: &TaggingProblem, row: u32, dynamic: Vec<u32>) -> Vec<f32> {
    let view = Features { row, dynamic, ..Features::default() };
    let legal = Actions::All(problem.space.actions() as u32);
    let sight = Sight { shared: problem.space.shared(), view: &view, legal };
    classifier.scores(&sight, &mut Default::default()).to_vec()
}

/// The classifier of the mean weights scores the mean of the scores, for views of every row with random dynamic
/// features.
#[test]
fn the_mean_classifier_scores_the_mean() {
    let problem = problem(&sample(Labels::Free(5), 30));
    for trainer in trainers().into_iter().filter(|trainer| trainer.mixes()) {
        for learner in &learners()[..4] {
            let Learned::Mixture(mixture) = trainer.train(&problem, learner, &Run::new(1)).unwrap().policy else {
                panic!("{trainer:?} trains no mixture")
            };
            let mean = AnyClassifier::mean(mixture.members()).expect("the columns are actions");
            let features = problem.space.shared().features();
            for row in 0..problem.space.shared().rows() as u32 {
                let key = Seed::new(u64::from(row));
                let dynamic: Vec<u32> =
                    (0..3).map(|i| (key.child(Purpose::Step, i).unit() * features as f64) as u32).collect();
                let mut expected = vec![0f64; 5];
                for (weight, member) in mixture.members() {
                    let given = scores(member, &problem, row, dynamic.clone());
                    expected.iter_mut().zip(given).for_each(|(sum, score)| *sum += weight * f64::from(score));
                }
                for (found, expected) in scores(&mean, &problem, row, dynamic).iter().zip(&expected) {
                    let slack = 1e-5 * (1.0 + expected.abs());
                    assert!((f64::from(*found) - expected).abs() < slack, "{found} for {expected}");
                }
            }
        }
    }
    // Counts of beaten rivals have no such mean.
    let wap = trainers()[2].train(&problem, &AnyLearner::Wap(Default::default()), &Run::new(1)).unwrap().policy;
    let Learned::Mixture(mixture) = wap else { panic!("SMILe trains a mixture") };
    assert!(AnyClassifier::mean(mixture.members()).is_none() && AnyClassifier::mean(&[]).is_none());
}

proptest! {
    #![proptest_config(fixed(300))]

    /// A choice is the best of the scores, also where the near part of the view decides alone, and also when the weights have changed since
    /// something was remembered. The margins of small weights are often exactly the reach of the far part.
    #[test]
    fn what_the_near_part_decides_is_the_best_of_all(
        lessons in vec((0u32..3, 0u32..4, vec(12u32..24, 0..3), 0u32..5, 0..3), 1..120),
        fine: bool,
    ) {
        // Two features that follow from row and key, and up to two others.
        let rows = FeatureTable::from_rows(24, vec![0, 2, 3, 4], vec![0, 1, 2, 3]);
        let table = rows.keyed_by(vec![0, 2, 4, 6], vec![4, 4, 4, 5, 4, 6], 12, 2);
        let list: Vec<Action> = [0, 2, 3, 4].map(Action).into();
        let setting = Setting { shared: &table, actions: 5 };
        // Logistic's weights are anything, those of a perceptron are whole numbers.
        let learner = if fine { AnyLearner::Logistic(Logistic::default()) } else { AnyLearner::Perceptron(Perceptron::default()) };
        let (mut course, mut memory) = (learner.begin(setting, None), Default::default());
        let mut examples = Examples::default();
        for (row, key, dynamic, label, learn) in lessons {
            let legal = if key == 3 { Actions::Only(&list) } else { Actions::All(5) };
            let view = Features { row, key, dynamic };
            let sight = Sight { shared: &table, view: &view, legal };
            let best = legal.best(course.scores(&sight, &mut Default::default()));
            prop_assert!(course.choose_at_once(&sight, &mut memory).is_none_or(|at_once| at_once == best));
            prop_assert_eq!(course.choose(&sight, &mut memory), best);
            let target = Target::Label(legal.nth(label as usize % legal.len()));
            // What is learned in passing is not measured; what is studied is.
            match learn {
                0 => {}
                1 => _ = learner.learn(&mut course, &sight, Some(target)),
                _ => {
                    let mut lesson = Examples::default();
                    lesson.push(&view, legal, target);
                    learner.study(&mut course, setting, &lesson);
                    examples.push(&view, legal, target);
                }
            }
        }
        // The same with a classifier that is finished.
        let (fitted, mut memory) = (learner.fit(setting, &examples, None, Seed::new(1)), Default::default());
        for i in 0..examples.len() {
            let (row, _, dynamic) = examples.views().get(i);
            for key in 0..4 {
                let view = Features { row, key, dynamic: dynamic.to_vec() };
                let legal = if key == 3 { Actions::Only(&list) } else { Actions::All(5) };
                let sight = Sight { shared: &table, view: &view, legal };
                let best = legal.best(fitted.scores(&sight, &mut Default::default()));
                prop_assert!(fitted.choose_at_once(&sight, &mut memory).is_none_or(|at_once| at_once == best));
                prop_assert_eq!(fitted.choose(&sight, &mut memory), best);
            }
        }
    }

    /// Where few actions are legal, only their columns are summed up: to the same bits, whatever was remembered of the same row for others.
    #[test]
    fn what_is_not_legal_need_not_be_summed(
        weights in vec(vec(-3f32..3.0, 60), 12),
        sights in vec((0u32..3, vec(4u32..12, 0..6), 0usize..60, 1usize..60, any::<bool>()), 1..40),
    ) {
        let table = FeatureTable::from_rows(12, vec![0, 2, 3, 4], vec![0, 1, 2, 3]);
        let setting = Setting { shared: &table, actions: 60 };
        let mut linear = Linear { actions: 60, columns: Columns::Actions, weights: Weights::new(12, 60) };
        weights.iter().zip(0..).for_each(|(row, feature)| linear.weights.row_mut(feature)[..60].copy_from_slice(row));
        let learner = Logistic::default();
        let (mut course, mut memory) = (learner.begin(setting, Some(&linear)), Default::default());
        for (row, dynamic, first, count, sparse) in sights {
            let among = first..(first + count).min(60);
            let list: Vec<Action> = among.filter(|a| !sparse || a % 3 == first % 3).map(|a| Action(a as u32)).collect();
            let legal = Actions::Only(&list);
            let view = Features { row, key: 0, dynamic };
            let sight = Sight { shared: &table, view: &view, legal };
            let features = || table.row(row).iter().chain(&view.dynamic);
            let sum = |a: &Action| features().fold(0.0, |sum, f| sum + weights[*f as usize][a.index()]);
            let expected: Vec<f32> = list.iter().map(sum).collect();
            let scores = linear.scores(&sight, &mut memory);
            let found: Vec<f32> = list.iter().map(|a| scores[a.index()]).collect();
            prop_assert_eq!(found, expected);
            // What learning decides by is the same.
            let best = course.choose(&sight, &mut Default::default());
            prop_assert_eq!(learner.learn(&mut course, &sight, Some(Target::Label(list[0]))), best);
        }
    }

    /// What a tagger sees at a glance is what it sees when it looks, and views that agree in it agree in what is legal.
    #[test]
    fn a_glance_tells_what_is_legal(sentences in any_corpora(6, 8), number: u64) {
        let problem = deep_problem(&sentences);
        let space = &problem.space;
        let mut seen = std::collections::HashMap::new();
        for index in (0..problem.episodes()).flat_map(|index| [index; 20]) {
            let seed = Seed::new(number).child(Purpose::Episode, seen.len() as u64);
            let (mut state, mut view, mut glance) = (space.start(Episode { index, seed }), Features::default(), Features::default());
            for t in 0.. {
                let legal: Vec<Action> = space.legal(&state).iter().collect();
                if legal.is_empty() {
                    break;
                }
                space.look(&state, &mut view);
                assert!(space.glance(&state, &mut glance) && (glance.row, glance.key) == (view.row, view.key));
                assert_eq!(seen.entry((view.row, view.key)).or_insert_with(|| legal.clone()), &legal);
                let any = seed.child(Purpose::Step, t).unit() * legal.len() as f64;
                space.step(&mut state, legal[any as usize], seed);
            }
        }
    }
}
