//! The trainers that look further: roll-outs of expert and policy, deviations, beams, second stages; and experts that are less than perfect.

use crate::common::{Labels, any_corpora, fixed, problem, sample, tokens};
use proptest::prelude::*;
use rollin::learner::{Csoaa, Learner, Perceptron, Setting, Target};
use rollin::policy::{Follow, Greedy, Linear, Mixture, Policy};
use rollin::roll::{self, Mixed, RollOut, Shortcut, perform};
use rollin::space::experts::{Noisy, Partly, Person, Suboptimal};
use rollin::space::{Action, Actions, Episode, Expert, FeatureTable, Features, Imitation, Problem, Space, Stacked};
use rollin::tasks::tagging::{Gold, Tagging, TaggingProblem};
use rollin::trainer::{
    Aggrevate, Beam, Cpi, Dagger, EarlyUpdate, Lols, Rate, Run, Schedule, Searn, Smile, Stacking, Supervised,
};
use rollin::worker::{Worker, all};
use rollin::{Purpose, Seed};

/// A learner that has seen one sentence only, so that it errs.
fn poor(problem: &TaggingProblem) -> Linear {
    let examples = roll::labels(problem, &Follow, &[0], Seed::new(1)).0.examples;
    Perceptron { passes: 1 }.fit(Setting::of(problem), &examples, None, Seed::new(2))
}

proptest! {
    #![proptest_config(fixed(100))]

    /// Roll-outs that are all the policy's are those of SEARN with one sample, and those that are all the expert's find its
    /// cost-to-go. In between every state has the one or the other.
    #[test]
    fn mixed_roll_outs_are_one_or_the_other(sentences in any_corpora(20, 8), number: u64) {
        let problem = problem(&sentences);
        let policy = Greedy(poor(&problem));
        let (episodes, seed) = (all(&problem), Seed::new(number));
        let targets = |expert: f64| {
            let (round, ledger) = roll::costs(&problem, &policy, &Mixed { expert }, &episodes, seed);
            let costs = (0..round.examples.len()).map(|i| match round.examples.target(i) {
                Target::Costs(costs) => costs.to_vec(),
                Target::Label(_) => panic!("a label was recorded"),
            });
            (costs.collect::<Vec<_>>(), ledger)
        };
        let own = roll::costs(&problem, &policy, &RollOut { samples: 1 }, &episodes, seed).0;
        let known = roll::costs(&problem, &policy, &Shortcut, &episodes, seed).0;
        let ((none, none_bill), (every, every_bill), (half, _)) = (targets(0.0), targets(1.0), targets(0.5));
        for i in 0..none.len() {
            prop_assert_eq!(own.examples.target(i), Target::Costs(&none[i]));
            prop_assert_eq!(known.examples.target(i), Target::Costs(&every[i]));
            prop_assert!(half[i] == none[i] || half[i] == every[i]);
        }
        prop_assert_eq!((none_bill.queries, every_bill.labels), (0, 0));
        prop_assert_eq!(every_bill.queries, every_bill.rollout_acts);
    }

    /// A beam of one does what its classifier does on its own; with the beam as wide as there are paths, the best of all paths is found.
    #[test]
    fn beams_find_the_best_path(sentences in any_corpora(4, 4)) {
        let problem = problem(&sentences);
        let classifier = poor(&problem);
        let greedy = perform(&problem, &Greedy(classifier.clone()), Seed::new(3)).0;
        let beam = |width| Beam { classifier: classifier.clone(), width }.perform(&problem, Seed::new(3)).0;
        let one = beam(1);
        prop_assert_eq!((&one.actions, &one.costs), (&greedy.actions, &greedy.costs));
        // At most 5^4 paths.
        let (found, space) = (beam(1000), &problem.space);
        let mut first = 0;
        for index in 0..problem.episodes() {
            let state = space.start(Episode { index, seed: Seed::new(0) });
            let best = highest(space, &classifier, state);
            let length = space.horizon(index).unwrap();
            let actions = &found.actions[first..first + length];
            prop_assert_eq!(score_of(space, &classifier, index, actions), best, "{:?}", actions);
            first += length;
        }
    }
}

/// The scores of the legal actions in a state.
fn scores(space: &Tagging, classifier: &Linear, state: &<Tagging as Space>::State) -> Vec<(Action, f64)> {
    let mut view = Default::default();
    space.look(state, &mut view);
    let sight = rollin::space::Sight { shared: space.shared(), view: &view, legal: space.legal(state) };
    let mut memory = Default::default();
    let scores = rollin::policy::Classifier::scores(classifier, &sight, &mut memory);
    sight.legal.iter().map(|action| (action, f64::from(scores[action.index()]))).collect()
}

/// The highest score of any path from here, by trying all.
fn highest(space: &Tagging, classifier: &Linear, state: <Tagging as Space>::State) -> i64 {
    fn search(space: &Tagging, classifier: &Linear, state: <Tagging as Space>::State, so_far: f64) -> f64 {
        if space.legal(&state).is_empty() {
            return so_far;
        }
        let after = scores(space, classifier, &state).into_iter().map(|(action, score)| {
            let mut next = state.clone();
            space.step(&mut next, action, Seed::new(0));
            search(space, classifier, next, so_far + score)
        });
        after.fold(f64::NEG_INFINITY, f64::max)
    }
    rounded(search(space, classifier, state, 0.0))
}

/// The score of one path.
fn score_of(space: &Tagging, classifier: &Linear, index: usize, actions: &[Action]) -> i64 {
    let mut state = space.start(Episode { index, seed: Seed::new(0) });
    let mut sum = 0.0;
    for action in actions {
        let scores = scores(space, classifier, &state);
        sum += scores.iter().find(|(a, _)| a == action).expect("the action is legal").1;
        space.step(&mut state, *action, Seed::new(0));
    }
    rounded(sum)
}

fn rounded(sum: f64) -> i64 {
    (sum * 1e4).round() as i64
}

/// With every state looked at, CPI at a fixed rate is SEARN but for the sampling: here on sentences of one word, to the bit.
#[test]
fn cpi_on_single_steps_is_searn() {
    let words = sample(Labels::Free(4), 60).into_iter().map(|sentence| sentence[..1].to_vec()).collect();
    let problem = problem(&words);
    let (rounds, samples) = (3, 2);
    let cpi = Cpi { rate: Rate::Fixed(0.3), rounds, samples, warm: false };
    let searn = Searn { beta: 0.3, rounds, samples, warm: false };
    let cpi = cpi.train(&problem, &Csoaa::default(), &Run::new(1)).unwrap();
    let searn = searn.train(&problem, &Csoaa::default(), &Run::new(1)).unwrap();
    assert_eq!(cpi.policy.members(), searn.policy.members());
    // SEARN goes on to the end of the sentence, CPI does not; that is all.
    assert_eq!(cpi.ledger.rollouts, searn.ledger.rollouts);
    assert_eq!(cpi.ledger.steps + tokens(&problem) * rounds as u64, searn.ledger.steps);
}

/// CPI by its own rate ends at once where the expert is perfect, and goes on where it is not.
#[test]
fn conservative_policy_iteration_goes_as_far_as_it_gains() {
    let good = problem(&sample(Labels::Free(4), 200));
    let cpi = Cpi { rate: Rate::Advantage, rounds: 3, ..Cpi::default() };
    let trained = cpi.train(&good, &Csoaa::default(), &Run::new(1)).unwrap();
    assert_eq!((trained.rounds.len(), trained.policy.members().len()), (1, 1));
    let Imitation { space, episodes, .. } = good;
    let bad = Imitation { space, expert: Suboptimal::new(Gold, 0.8, Seed::new(4)).unwrap(), episodes };
    let trained = cpi.train(&bad, &Csoaa::default(), &Run::new(1)).unwrap();
    assert_eq!(trained.rounds.len(), 3);
    let costs: Vec<f64> = trained.rounds.iter().map(|round| round.cost).collect();
    // The steps are tiny: what is gained by them is less than what an evaluation tells, so no more is asked than that it is measured.
    assert!(costs.iter().all(|cost| *cost > 0.0), "{costs:?}");
}

/// Where the expert is bad most of the time, LOLS, which looks at costs and rolls out with itself, does better than the expert, and
/// imitating its labels does not.
#[test]
fn lols_improves_on_a_bad_expert() {
    let Imitation { space, episodes, .. } = problem(&sample(Labels::Free(4), 300));
    let bad = Imitation { space, expert: Suboptimal::new(Gold, 0.7, Seed::new(4)).unwrap(), episodes };
    let cost = |policy: &dyn Fn() -> f64| policy() / tokens(&bad) as f64;
    let sum = |done: roll::Performance| done.costs.iter().sum::<f64>();
    let expert = cost(&|| sum(perform(&bad, &Follow, Seed::new(1)).0));
    let (learner, run) = (Csoaa::default(), Run::new(1));
    let dagger =
        cost(&|| sum(perform(&bad, &Dagger::default().train(&bad, &learner, &run).unwrap().policy, Seed::new(1)).0));
    let lols = Lols::default();
    let fitted = cost(&|| sum(perform(&bad, &lols.train(&bad, &learner, &run).unwrap().policy, Seed::new(1)).0));
    let online = cost(&|| sum(perform(&bad, &lols.train_online(&bad, &learner, &run).unwrap().policy, Seed::new(1)).0));
    assert!(expert > 0.4 && dagger > 0.4, "the expert is too good: {expert}, {dagger}");
    assert!(fitted < 0.8 * expert && online < 0.8 * expert, "{fitted} and {online} for {expert}");
}

/// The regrets that LOLS reports are those that trying every action shows; where only the one rolls out there is only that one.
#[test]
fn regrets_are_what_deviations_would_gain() {
    let problem = problem(&sample(Labels::Free(3), 60));
    let n = problem.episodes() as f64;
    let lols = |beta, rounds| Lols { beta, rounds, warm: false };
    let learner = Csoaa { passes: 1, ..Csoaa::default() };
    for beta in [0.0, 1.0] {
        let trained = lols(beta, 2).train(&problem, &learner, &Run::new(1)).unwrap();
        assert_eq!(trained.rounds[0].regret, None);
        let regret = trained.rounds[1].regret.unwrap();
        assert_eq!((regret.reference.is_some(), regret.deviations.is_some()), (beta == 1.0, beta == 0.0));
        // What the first round learned drove the second; the same seed learns it again.
        let driver = lols(beta, 1).train(&problem, &learner, &Run::new(1)).unwrap().policy;
        let mut over = 0.0;
        let mut worker = Worker::new(&problem);
        let (mut memory, mut costs) = (Default::default(), Vec::new());
        for index in 0..problem.episodes() {
            worker.episode(Episode { index, seed: Seed::new(9) }, |visit| {
                costs.clear();
                let tried = visit.legal().iter().map(|action| match beta == 1.0 {
                    true => visit.roll_out(action, Seed::new(9), |visit| visit.expert()),
                    false => visit.roll_out(action, Seed::new(9), |visit| driver.act(visit, &mut memory)),
                });
                let tried: Vec<f64> = tried.collect();
                let action = driver.act(visit, &mut memory);
                let place = visit.legal().place(action).unwrap();
                over += tried[place] - tried.iter().copied().fold(f64::INFINITY, f64::min);
                costs.extend(tried);
                Some(action)
            });
        }
        let found = regret.reference.or(regret.deviations).unwrap();
        assert!((found - over / n).abs() < 1e-9 && over > 0.0, "{found} for {}", over / n);
        // With free labels and a perfect expert its roll-outs show exactly what the policy loses.
        if beta == 1.0 {
            assert!((trained.rounds[1].cost - found).abs() < 1e-9);
        }
    }
}

/// The second stage sees the labels around: where a word's label is that of the next word, no first stage can know it, and two can.
#[test]
fn a_second_stage_sees_what_comes_after() {
    // Labels A and D follow from words a and d; x has the label of the word after it.
    let sentence = |i: u64| {
        let draw = |t: u64| Seed::new(i).child(Purpose::Step, t).unit() < 0.5;
        let mut words = Vec::new();
        for t in 0..6 {
            let (word, label) = if draw(t) { ("a", "A") } else { ("d", "D") };
            words.push(("x".to_owned(), label.to_owned()));
            words.push((word.to_owned(), label.to_owned()));
        }
        words
    };
    let problem = problem(&(0..60).map(sentence).collect());
    let learner = Perceptron::default();
    let right = |costs: Vec<f64>| 1.0 - costs.iter().sum::<f64>() / tokens(&problem) as f64;
    let one = Supervised::default().train(&problem, &learner, &Run::new(1)).unwrap().policy;
    let two = Stacking { folds: 5, window: 1 }.train(&problem, &learner, &Run::new(1)).unwrap().policy;
    let (one, two) = (perform(&problem, &one, Seed::new(1)).0, two.perform(&problem, Seed::new(1)).0);
    assert!(right(one.costs.clone()) < 0.9, "{}", right(one.costs));
    assert!(right(two.costs.clone()) > 0.99, "{}", right(two.costs));
    // Any trainer will do for the second stage.
    let smile = Smile { rounds: 3, ..Smile::default() };
    let stacking = Stacking { folds: 5, window: 1 };
    let by = stacking.train_by(&problem, &learner, &Run::new(1), |stacked, run| smile.train(stacked, &learner, run));
    let by = by.unwrap();
    assert_eq!(by.ledger.labels, 4 * tokens(&problem));
    assert!(right(by.policy.perform(&problem, Seed::new(1)).0.costs) > 0.95);
}

/// A state of a stacked space shows the labels around it, one feature a place, and nothing else changes.
#[test]
fn stacked_views_worked_by_hand() {
    let problem =
        problem(&vec![[("a", "A"), ("b", "D"), ("c", "A")].map(|(w, l)| (w.to_owned(), l.to_owned())).to_vec()]);
    let (space, own) = (&problem.space, problem.space.shared().features() as u32);
    let stacked = Stacked::new(space, 1, vec![vec![Action(1), Action(0), Action(1)]]);
    let mut state = stacked.start(Episode { index: 0, seed: Seed::new(1) });
    // Three places of three features each: A, D, none.
    for expected in [[2, 3 + 1, 6], [1, 3, 6 + 1], [0, 3 + 1, 6 + 2]] {
        let (mut view, mut plain) = (Default::default(), rollin::space::Features::default());
        stacked.look(&state, &mut view);
        let more: Vec<u32> = view.dynamic.iter().filter(|f| **f >= own).map(|f| f - own).collect();
        assert_eq!(more, expected);
        space.look(&space.start(Episode { index: 0, seed: Seed::new(1) }), &mut plain);
        assert_eq!(view.dynamic.len(), plain.dynamic.len() + 3);
        stacked.step(&mut state, Action(0), Seed::new(1));
    }
    assert!(stacked.legal(&state).is_empty());
    assert_eq!(stacked.shared().features(), own as usize + Stacked::<Tagging>::more(2, 1));
}

/// The beam's classifier, searched with a beam, labels what it was trained on.
#[test]
fn early_updates_learn() {
    let problem = problem(&sample(Labels::Spans(2), 60));
    let right = |width, rounds| {
        let trained = EarlyUpdate { width, rounds }.train(&problem, &Run::new(1)).unwrap();
        assert_eq!((trained.ledger.labels, trained.ledger.expert_acts), (tokens(&problem), tokens(&problem)));
        let done = trained.policy.perform(&problem, Seed::new(1)).0;
        1.0 - done.costs.iter().sum::<f64>() / tokens(&problem) as f64
    };
    // One label in three is noise, of which the words tell nothing.
    assert!(right(4, 10) > 0.7, "{}", right(4, 10));
    assert!(right(4, 10) > right(4, 1));
}

/// How often an expert's answer is right, other or missing, at the states of its own runs.
fn answers(expert: impl Expert<Tagging>, seed: Seed) -> (Vec<Option<Action>>, [f64; 3]) {
    let Imitation { space, episodes, .. } = problem(&sample(Labels::Free(4), 400));
    let problem = Imitation { space, expert, episodes };
    let (mut all, mut counts) = (Vec::new(), [0.0; 3]);
    let mut worker = Worker::new(&problem);
    let mut first = 0;
    for index in 0..episodes {
        worker.episode(Episode { index, seed: seed.child(Purpose::Episode, index as u64) }, |visit| {
            let (answer, gold) = (visit.label(), Action(problem.space.gold()[first + visit.t()]));
            assert!(answer.is_none_or(|action| visit.legal().contains(action)));
            counts[answer.map_or(2, |action| usize::from(action != gold))] += 1.0;
            all.push(answer);
            Some(gold)
        });
        first += problem.space.horizon(index).unwrap();
    }
    let n = all.len() as f64;
    (all, counts.map(|count| count / n))
}

/// A space that does not tell how long its episodes are.
struct Secretive(Tagging);

impl Space for Secretive {
    type State = <Tagging as Space>::State;
    type View = Features;
    fn start(&self, episode: Episode) -> Self::State {
        self.0.start(episode)
    }
    fn legal<'a>(&'a self, state: &'a Self::State) -> Actions<'a> {
        self.0.legal(state)
    }
    fn look(&self, state: &Self::State, view: &mut Features) {
        self.0.look(state, view);
    }
    fn step(&self, state: &mut Self::State, action: Action, seed: Seed) -> f64 {
        self.0.step(state, action, seed)
    }
    fn actions(&self) -> usize {
        self.0.actions()
    }
    fn shared(&self) -> &FeatureTable {
        self.0.shared()
    }
}

impl Expert<Secretive> for Gold {
    fn action(&self, space: &Secretive, state: &<Tagging as Space>::State) -> Option<Action> {
        self.action(&space.0, state)
    }
}

/// Who draws a step of each episode draws the same one where steps must be counted first: the same is learned, for more steps.
#[test]
fn steps_that_are_counted_first_are_the_same() {
    let known = problem(&sample(Labels::Spans(2), 40));
    let unknown = Imitation { space: Secretive(known.space.clone()), expert: Gold, episodes: known.episodes };
    let (learner, run) = (Csoaa::default(), Run::new(5));
    for rate in [Rate::Fixed(0.4), Rate::Advantage] {
        let cpi = Cpi { rate, rounds: 3, ..Cpi::default() };
        let (plain, counted) =
            (cpi.train(&known, &learner, &run).unwrap(), cpi.train(&unknown, &learner, &run).unwrap());
        assert!(
            plain.policy.members() == counted.policy.members() && plain.rounds.len() == counted.rounds.len(),
            "{rate:?}"
        );
        assert_eq!((plain.ledger.examples, plain.ledger.rollouts), (counted.ledger.examples, counted.ledger.rollouts));
        assert!(plain.ledger.steps < counted.ledger.steps);
    }
    let aggrevate = Aggrevate { rounds: 3, ..Aggrevate::default() };
    let plain = aggrevate.train(&known, &learner, &run).unwrap();
    let counted = aggrevate.train(&unknown, &learner, &run).unwrap();
    assert!(plain.policy.0 == counted.policy.0 && plain.ledger.steps < counted.ledger.steps);
}

/// About 2,600 independent draws each: six standard deviations are below 0.06.
#[test]
fn experts_err_and_fall_silent_as_often_as_they_should() {
    let (perfect, shares) = answers(Gold, Seed::new(1));
    assert_eq!(shares, [1.0, 0.0, 0.0]);
    let (noisy, shares) = answers(Noisy::new(Gold, 0.3).unwrap(), Seed::new(1));
    assert!(noisy.len() > 2500 && (shares[1] - 0.3).abs() < 0.06 && shares[2] == 0.0, "{shares:?}");
    let (partly, shares) = answers(Partly::new(Gold, 0.3).unwrap(), Seed::new(1));
    assert!((shares[2] - 0.3).abs() < 0.06 && shares[1] == 0.0, "{shares:?}");
    let both = Partly::new(Noisy::new(Gold, 0.5).unwrap(), 0.5).unwrap();
    let (_, shares) = answers(both, Seed::new(1));
    assert!((shares[2] - 0.5).abs() < 0.07 && (shares[1] - 0.25).abs() < 0.06, "{shares:?}");
    // The same seed errs in the same places, another elsewhere; at the borders nothing is left to chance.
    assert_eq!(noisy, answers(Noisy::new(Gold, 0.3).unwrap(), Seed::new(1)).0);
    assert_ne!(noisy, answers(Noisy::new(Gold, 0.3).unwrap(), Seed::new(2)).0);
    assert_ne!(partly, answers(Partly::new(Gold, 0.3).unwrap(), Seed::new(2)).0);
    assert_eq!(perfect, answers(Noisy::new(Gold, 0.0).unwrap(), Seed::new(1)).0);
    assert_eq!(answers(Noisy::new(Gold, 1.0).unwrap(), Seed::new(1)).1, [0.0, 1.0, 0.0]);
    assert_eq!(answers(Partly::new(Gold, 1.0).unwrap(), Seed::new(1)).1, [0.0, 0.0, 1.0]);
    // Bad habits are the same in every run.
    let bad = |habits| Suboptimal::new(Gold, 0.5, Seed::new(habits)).unwrap();
    let (first, shares) = answers(bad(1), Seed::new(1));
    assert!(shares[1] > 0.0 && shares[0] > 0.0, "{shares:?}");
    assert_eq!(first, answers(bad(1), Seed::new(2)).0);
    assert_ne!(first, answers(bad(2), Seed::new(1)).0);
}

/// The experts' chance is keyed: threads do not matter to those who learn from them, whoever rolls out, and every trainer takes them.
#[test]
fn imperfect_experts_serve_every_trainer() {
    let Imitation { space, episodes, .. } = problem(&sample(Labels::Spans(1), 40));
    let expert = Partly::new(Noisy::new(Gold, 0.2).unwrap(), 0.2).unwrap();
    let problem = Imitation { space, expert, episodes };
    let (learner, run) = (Perceptron::default(), Run::new(1));
    let at = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let dagger = Dagger { schedule: Some(Schedule::Linear(3)), ..Dagger::default() };
            let dagger = dagger.train(&problem, &learner, &run).unwrap();
            let searn: (Mixture<Linear>, _) = {
                let trained = Searn { rounds: 2, ..Searn::default() }.train(&problem, &learner, &run).unwrap();
                (trained.policy, trained.ledger)
            };
            let lols = Lols { rounds: 2, ..Lols::default() }.train(&problem, &learner, &run).unwrap();
            let early = EarlyUpdate { rounds: 2, ..EarlyUpdate::default() }.train(&problem, &run).unwrap();
            assert!(dagger.ledger.labels < dagger.ledger.steps, "the expert was never silent");
            let ledgers = (dagger.ledger, searn.1, lols.ledger, early.ledger);
            ((dagger.policy.0, searn.0.members().to_vec(), lols.policy.0, early.policy.classifier), ledgers)
        })
    };
    let one = at(1);
    assert!(one == at(2) && one == at(5));
}

/// A person is asked once a state, is told of what is illegal, and falls silent at the end of the input or when the screen is gone.
#[test]
fn people_answer_in_words() {
    let space = problem(&vec![vec![("a".to_owned(), "B-NP".to_owned()), ("b".to_owned(), "I-NP".to_owned())]]).space;
    let mut screen = Vec::new();
    {
        let show = |_: &Tagging, state: &<Tagging as Space>::State| format!("{state:?}");
        // 1 is I-NP, which may not come first.
        let person = Person::new(&b"1\nx\n 0 \n\n"[..], &mut screen, show);
        let problem = Imitation { space, expert: person, episodes: 1 };
        let mut worker = Worker::new(&problem);
        let mut answers = Vec::new();
        worker.episode(Episode { index: 0, seed: Seed::new(1) }, |visit| {
            answers.push(visit.label());
            assert_eq!(visit.label(), answers[answers.len() - 1]);
            Some(visit.expert())
        });
        assert_eq!(answers, [Some(Action(0)), None]);
        assert_eq!((worker.ledger().labels, worker.ledger().expert_acts), (1, 1));
        problem.expert.finish().unwrap();
    }
    let screen = String::from_utf8(screen).unwrap();
    assert_eq!(screen.matches("is not legal here").count(), 2, "{screen}");
    assert_eq!(screen.matches("which action (0)? ").count(), 3, "{screen}");

    /// A screen that is gone.
    struct Gone;
    impl std::io::Write for Gone {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(std::io::Error::other("gone"))
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let space = problem(&vec![vec![("a".to_owned(), "A".to_owned())]]).space;
    let person = Person::new(&b"0\n"[..], Gone, |_: &Tagging, _: &<Tagging as Space>::State| String::new());
    let state = space.start(Episode { index: 0, seed: Seed::new(1) });
    assert_eq!((person.action(&space, &state), person.action(&space, &state)), (None, None));
    assert_eq!(person.finish().unwrap_err().to_string(), "gone");
}

/// Every learner may drive LOLS on, online: what it did last is what it now would do.
#[test]
fn courses_act_as_they_have_learned() {
    use rollin::learner::{Examples, Logistic, Online, Wap};
    fn check<L: Online<rollin::space::Features, Classifier = Linear>>(learner: &L, problem: &TaggingProblem) {
        let setting = Setting::of(problem);
        let examples: Examples<_> = roll::labels(problem, &Follow, &all(problem), Seed::new(1)).0.examples;
        let mut course = learner.begin(setting, None);
        learner.study(&mut course, setting, &examples);
        let mut actions = Vec::new();
        let done = perform(problem, &Greedy(&course), Seed::new(1)).0.actions;
        let mut worker = Worker::new(problem);
        for index in 0..problem.episodes() {
            worker.episode(Episode { index, seed: Seed::new(1) }, |visit| {
                let action = learner.learn(&mut course, &visit.sight(), None);
                actions.push(action);
                Some(action)
            });
        }
        assert_eq!(done, actions);
        // Two studies are one of both.
        let mut twice = learner.begin(setting, None);
        let (first, second) = (all(problem), all(problem).split_off(problem.episodes() / 2));
        let part = |episodes: &[usize]| roll::labels(problem, &Follow, episodes, Seed::new(1)).0.examples;
        learner.study(&mut twice, setting, &part(&first[..problem.episodes() / 2]));
        learner.study(&mut twice, setting, &part(&second));
        assert_eq!(learner.finish(twice), learner.finish(course));
    }
    let problem = problem(&sample(Labels::Spans(2), 20));
    check(&Perceptron::default(), &problem);
    check(&Logistic::default(), &problem);
    check(&Wap::default(), &problem);
}
