//! Roll-outs against a simulation of their own, and what is recorded of them.

use crate::common::{Labels, any_corpora, deep_problem, fixed, problem, sample};
use proptest::prelude::*;
use rollin::learner::{Csoaa, Learner, Perceptron, Setting, Target, Wap};
use rollin::policy::{Columns, Follow, Linear, Mixture, Policy};
use rollin::roll::{self, RollOut, Shortcut};
use rollin::space::{
    Action, Actions, Episode, Expert, FeatureTable, Features, Imitation, NO_ROW, Problem, Silent, Space,
};
use rollin::tasks::tagging::{Gold, Position, Tagging, TaggingProblem};
use rollin::trainer::Run;
use rollin::worker::{Memo, Worker, all};
use rollin::{Purpose, Seed};

/// What a linear classifier does, the plain way: all weights summed anew, then the best, or the one that beats most.
fn naive_choice(space: &Tagging, state: &Position, classifier: &Linear) -> Action {
    let mut view = Features::default();
    space.look(state, &mut view);
    let mut sums = vec![0f32; classifier.weights.columns()];
    for feature in space.shared().listed(view.row, view.key, &view.dynamic).iter() {
        if let Some(row) = classifier.weights.row(feature) {
            sums.iter_mut().zip(row).for_each(|(sum, w)| *sum += w);
        }
    }
    let legal: Vec<Action> = space.legal(state).iter().collect();
    let score = |a: Action| match classifier.columns {
        Columns::Actions => sums[a.index()],
        Columns::Tree | Columns::Bits => unreachable!("no tree is grown here, and no bit is learned"),
        Columns::Pairs => {
            let beats = |b: &&Action| match a.cmp(b) {
                std::cmp::Ordering::Less => sums[Columns::pair(space.actions(), a.index(), b.index())] >= 0.0,
                std::cmp::Ordering::Equal => false,
                std::cmp::Ordering::Greater => sums[Columns::pair(space.actions(), b.index(), a.index())] < 0.0,
            };
            legal.iter().filter(beats).count() as f32
        }
    };
    let highest = legal.iter().map(|a| score(*a)).fold(f32::NEG_INFINITY, f32::max);
    *legal.iter().find(|a| score(**a) == highest).expect("something is legal")
}

/// What a mixture does at step t of `run`: a number drawn for the step falls to a classifier or, beyond them, to the expert.
fn naive_act(space: &Tagging, state: &Position, mixture: &Mixture<Linear>, run: Seed, t: usize) -> Action {
    let unit = run.child(Purpose::Step, t as u64).child(Purpose::Member, 0).unit();
    let mut sum = 0.0;
    for (weight, classifier) in mixture.members() {
        sum += weight;
        if unit < sum {
            return naive_choice(space, state, classifier);
        }
    }
    if mixture.expert() > 0.0 {
        return Gold.action(space, state).expect("the labels are known");
    }
    naive_choice(space, state, &mixture.members().last().expect("the weights sum to 1").1)
}

/// `action` at step t and then the mixture to the end.
fn naive_cost(
    space: &Tagging,
    mut state: Position,
    action: Action,
    mixture: &Mixture<Linear>,
    run: Seed,
    t: usize,
) -> f64 {
    let mut total = space.step(&mut state, action, run);
    let mut t = t + 1;
    while !space.legal(&state).is_empty() {
        let action = naive_act(space, &state, mixture, run, t);
        total += space.step(&mut state, action, run);
        t += 1;
    }
    total
}

/// How roll-outs are made.
#[derive(Clone, Copy)]
enum How {
    /// One after the other to the end.
    Naive,
    /// Side by side, each of them asking what to do.
    Asking,
    /// Side by side, a policy deciding for all of a step.
    Together,
}

/// A mixture of the expert and three learners that have seen only one sentence, so that they err.
fn mixture(problem: &TaggingProblem, rates: &[f64]) -> Mixture<Linear> {
    let setting = Setting::of(problem);
    let examples = roll::labels(problem, &Follow, &[0], Seed::new(1)).0.examples;
    let perceptron = Perceptron { passes: 1 }.fit(setting, &examples, None, Seed::new(2));
    let wap = Wap { passes: 1, ..Wap::default() }.fit(setting, &examples, None, Seed::new(3));
    let csoaa = Csoaa::default().fit(setting, &examples, None, Seed::new(4));
    let mut mixture = Mixture::of_expert();
    for (rate, classifier) in rates.iter().zip([perceptron, wap, csoaa].into_iter().cycle()) {
        mixture.blend(*rate, classifier);
    }
    mixture
}

proptest! {
    #![proptest_config(fixed(150))]

    /// Roll-outs that remember cost the same to the bit as those that do not, action for action, and so does their bill; and so where a policy decides for
    /// all states of a step together.
    #[test]
    fn remembering_changes_nothing_but_the_time(
        sentences in any_corpora(6, 9),
        rates in prop::collection::vec(0.05f64..1.0, 1..5),
        drop_expert: bool,
        deep: bool,
        number: u64,
    ) {
        let problem = if deep { deep_problem(&sentences) } else { problem(&sentences) };
        prop_assert_eq!(problem.space.is_trellis(), !deep);
        let grown = mixture(&problem, &rates);
        let mixture = if drop_expert { grown.without_expert() } else { grown };
        let all_costs = |how: How| {
            let (mut worker, mut memory, mut memo, mut costs) = (Worker::new(&problem), Default::default(), Memo::default(), Vec::new());
            for index in 0..problem.episodes() {
                let seed = Seed::new(number).child(Purpose::Episode, index as u64);
                worker.episode(Episode { index, seed }, |visit| {
                    match how {
                        How::Naive => {
                            let legal = visit.legal();
                            costs.extend(legal.iter().map(|action| {
                                visit.roll_out(action, seed, |visit| mixture.act(visit, &mut memory))
                            }));
                        }
                        How::Asking => costs.extend(visit.roll_outs(seed, &mut memo, |visit| mixture.act(visit, &mut memory))),
                        How::Together => costs.extend(visit.roll_outs_by(seed, &mut memo, &mixture, &mut memory)),
                    }
                    Some(mixture.act(visit, &mut memory))
                });
            }
            (costs.into_iter().map(f64::to_bits).collect::<Vec<u64>>(), worker.ledger())
        };
        let naive = all_costs(How::Naive);
        prop_assert_eq!(&all_costs(How::Asking), &naive);
        prop_assert_eq!(&all_costs(How::Together), &naive);
    }

    /// Where the label before is all that is looked at, a label costs the same and leads to the same whatever stands before it.
    #[test]
    fn a_trellis_is_one(sentences in any_corpora(6, 9), turns in prop::collection::vec(prop::array::uniform2(0..1000usize), 9)) {
        let Imitation { space, .. } = problem(&sentences);
        for index in 0..space.sentences() {
            let mut states = [0, 1].map(|_| space.start(Episode { index, seed: Seed::new(1) }));
            for turn in &turns {
                let [one, other] = states.each_ref().map(|state| space.legal(state));
                prop_assert_eq!(one.is_empty(), other.is_empty());
                if one.is_empty() {
                    break;
                }
                for action in one.iter().filter(|action| other.contains(*action)) {
                    let [led, also] = states.each_ref().map(|state| {
                        let mut state = state.clone();
                        (space.step(&mut state, action, Seed::new(2)), space.signature(&state))
                    });
                    prop_assert_eq!(led, also);
                }
                let taken = [one.nth(turn[0] % one.len()), other.nth(turn[1] % other.len())];
                for (state, action) in states.iter_mut().zip(taken) {
                    space.step(state, action, Seed::new(3));
                }
            }
        }
    }

    /// At every state of every roll-in, for every action: the same cost as the simulation, step by step, with the
    /// same keys. What the policy does during the roll-in is the same, too, though roll-outs lie between, which share
    /// its scratch.
    #[test]
    fn roll_outs_cost_what_a_simulation_says(
        sentences in any_corpora(6, 8),
        rates in prop::collection::vec(0.05f64..1.0, 1..5),
        drop_expert: bool,
        number: u64,
    ) {
        let problem = deep_problem(&sentences);
        let space = &problem.space;
        let grown = mixture(&problem, &rates);
        let mixture = if drop_expert { grown.without_expert() } else { grown };
        let mut worker = Worker::new(&problem);
        let mut memory = Default::default();
        for index in 0..problem.episodes() {
            let episode = Episode { index, seed: Seed::new(number).child(Purpose::Episode, index as u64) };
            let mut mirror = space.start(episode);
            worker.episode(episode, |visit| {
                for k in 0..2 {
                    let run = episode.seed.child(Purpose::RollOut, k);
                    for action in visit.legal().iter() {
                        let found = visit.roll_out(action, run, |visit| mixture.act(visit, &mut memory));
                        let expected = naive_cost(space, mirror.clone(), action, &mixture, run, visit.t());
                        assert_eq!(found, expected, "{action:?} in {mirror:?}");
                    }
                }
                let action = mixture.act(visit, &mut memory);
                assert_eq!(action, naive_act(space, &mirror, &mixture, episode.seed, visit.t()));
                space.step(&mut mirror, action, visit.seed());
                Some(action)
            });
        }
    }

    /// Recorded costs are the means over the samples, counted from the cheapest, and stand in the order of the states.
    #[test]
    fn recorded_costs_are_relative_to_the_cheapest(
        sentences in any_corpora(20, 6),
        rate in 0.1f64..0.9,
        samples in 1usize..4,
    ) {
        let problem = problem(&sentences);
        let space = &problem.space;
        let mixture = mixture(&problem, &[rate, rate]);
        let seed = Seed::new(77);
        let (round, ledger) = roll::costs(&problem, &mixture, &RollOut { samples }, &all(&problem), seed);
        let mut i = 0;
        for index in 0..problem.episodes() {
            let run = seed.child(Purpose::Episode, index as u64);
            let mut state = space.start(Episode { index, seed: run });
            for t in 0.. {
                let legal = space.legal(&state);
                if legal.is_empty() {
                    break;
                }
                let cost = |action| {
                    let one = |k| naive_cost(space, state.clone(), action, &mixture, run.child(Purpose::RollOut, k), t);
                    (0..samples as u64).map(one).sum::<f64>() / samples as f64
                };
                let costs: Vec<f64> = legal.iter().map(cost).collect();
                let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
                let Target::Costs(recorded) = round.examples.target(i) else { panic!("a label was recorded") };
                prop_assert!(round.examples.legal(i).iter().eq(legal.iter()));
                prop_assert!(recorded.len() == costs.len() && recorded.contains(&0.0));
                let relative: Vec<f32> = costs.iter().map(|cost| (cost - least) as f32).collect();
                prop_assert_eq!(recorded, relative);
                let action = naive_act(space, &state, &mixture, run, t);
                space.step(&mut state, action, run);
                i += 1;
            }
        }
        prop_assert_eq!((round.examples.len(), ledger.examples), (i, i as u64));
    }

    /// While the expert drives alone, rolling out finds its cost-to-go: SEARN's first round has the examples of the
    /// shortcut's.
    #[test]
    fn the_first_round_of_searn_is_the_shortcuts(sentences in any_corpora(30, 8), samples in 1usize..3) {
        let problem = problem(&sentences);
        let expert = Mixture::<Linear>::of_expert();
        let (episodes, seed) = (all(&problem), Run::new(1).seed.child(Purpose::Round, 1));
        let (rolled, ledger) = roll::costs(&problem, &expert, &RollOut { samples }, &episodes, seed);
        let (known, known_ledger) = roll::costs(&problem, &expert, &Shortcut, &episodes, seed);
        prop_assert_eq!((rolled.examples.len(), rolled.cost), (known.examples.len(), known.cost));
        prop_assert_eq!(known.cost, 0.0);
        for i in 0..known.examples.len() {
            prop_assert_eq!(rolled.examples.target(i), known.examples.target(i));
            prop_assert!(rolled.examples.legal(i).iter().eq(known.examples.legal(i).iter()));
            prop_assert_eq!(rolled.examples.views().get(i), known.examples.views().get(i));
        }
        prop_assert_eq!((known_ledger.rollouts, known_ledger.resets, known_ledger.rollout_acts), (0, 0, 0));
        prop_assert_eq!(ledger.rollout_acts + ledger.rollouts, ledger.steps - ledger.examples);
    }
}

/// Six throws of a die: a step costs what is thrown, and 10 times the action on top.
struct Dice(FeatureTable);

impl Space for Dice {
    type State = usize;
    type View = Features;
    fn start(&self, _: Episode) -> usize {
        0
    }
    fn legal<'a>(&'a self, t: &'a usize) -> Actions<'a> {
        if *t < 6 { Actions::All(3) } else { Actions::NONE }
    }
    fn look(&self, t: &usize, view: &mut Features) {
        view.row = NO_ROW;
        view.dynamic.clear();
        view.dynamic.push(*t as u32);
    }
    fn step(&self, t: &mut usize, action: Action, seed: Seed) -> f64 {
        *t += 1;
        10.0 * f64::from(action.0) + seed.child(Purpose::Step, 0).unit()
    }
    fn actions(&self) -> usize {
        3
    }
    fn shared(&self) -> &FeatureTable {
        &self.0
    }
}

/// Under one run the actions of a deviation meet the same throws: their costs differ by what they cost themselves and
/// by nothing else. Another run throws anew.
#[test]
fn actions_that_are_compared_share_their_luck() {
    let problem = Imitation { space: Dice(FeatureTable::new(6)), expert: Silent, episodes: 1 };
    let mut worker = Worker::new(&problem);
    let mut luck = Vec::new();
    worker.episode(Episode { index: 0, seed: Seed::new(1) }, |visit| {
        for k in 0..2 {
            let run = Seed::new(1).child(Purpose::RollOut, k);
            let costs: Vec<f64> = (0..3).map(|a| visit.roll_out(Action(a), run, |visit| visit.expert())).collect();
            assert!(
                (costs[1] - costs[0] - 10.0).abs() < 1e-12 && (costs[2] - costs[0] - 20.0).abs() < 1e-12,
                "{costs:?}"
            );
            luck.push(costs[0]);
        }
        // A silent expert takes the lowest action.
        Some(visit.expert())
    });
    assert_eq!(luck.len(), 12);
    assert!(luck.as_chunks::<2>().0.iter().all(|[a, b]| a != b));
    // Step t throws the same whichever state of the episode the roll-out began in.
    let throws = |k: usize| luck.iter().skip(k).step_by(2).copied().collect::<Vec<f64>>();
    let throw = |k, t| Seed::new(1).child(Purpose::RollOut, k).child(Purpose::Step, t).child(Purpose::Step, 0).unit();
    for k in 0..2 {
        for (from, total) in throws(k).iter().enumerate() {
            let expected: f64 = (from as u64..6).map(|t| throw(k as u64, t)).sum();
            assert!((total - expected).abs() < 1e-12, "from step {from}");
        }
    }
    assert_eq!((worker.ledger().rollouts, worker.ledger().queries), (36, 0));
}

/// A roll-out overwrites the view of the state it starts from: what is recorded after it is still that state's.
#[test]
fn a_record_after_roll_outs_is_of_the_state_at_hand() {
    let problem = problem(&sample(Labels::Free(3), 20));
    let mixture = mixture(&problem, &[0.5, 0.5]);
    let (plain, _) = roll::costs(&problem, &mixture, &Shortcut, &all(&problem), Seed::new(3));
    let (rolled, _) = roll::costs(&problem, &mixture, &RollOut { samples: 2 }, &all(&problem), Seed::new(3));
    assert!(plain.cost > 0.0, "the mixture never errs: nothing is tested");
    assert_eq!(plain.cost, rolled.cost);
    for i in 0..plain.examples.len() {
        assert_eq!(plain.examples.views().get(i), rolled.examples.views().get(i));
    }
}

/// The same when the state was looked at before: the policy chooses first, then everything is rolled out, then the
/// choice is made again.
#[test]
fn a_look_after_a_roll_out_is_of_the_state_at_hand() {
    let problem = problem(&sample(Labels::Free(3), 20));
    let mixture = mixture(&problem, &[0.5, 0.5]);
    let mut worker = Worker::new(&problem);
    let mut memory = Default::default();
    for index in 0..problem.episodes() {
        worker.episode(Episode { index, seed: Seed::new(5) }, |visit| {
            let before = visit.sight().view.clone();
            let after_each = visit.legal().iter().map(|action| {
                visit.roll_out(action, Seed::new(6), |visit| mixture.act(visit, &mut memory));
                visit.sight().view.clone()
            });
            for after in after_each.collect::<Vec<_>>() {
                assert_eq!((before.row, &before.dynamic), (after.row, &after.dynamic));
            }
            Some(mixture.act(visit, &mut memory))
        });
    }
}
