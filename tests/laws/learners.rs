//! Learners: first steps worked by hand, and every trainer with every learner on a task that is easy.

use crate::common::{Labels, learners, problem, sample, tokens, trainers};
use rollin::learner::{
    CrammerSinger, Csoaa, Examples, Learner, Lesson, Logistic, Net, Online, Perceptron, Rule, Setting, Svm, Target, Wap,
};
use rollin::policy::{Classifier, Columns, Linear};
use rollin::space::Sight;
use rollin::space::{Action, Actions, FeatureTable, Features, Space};
use rollin::tasks::Trainer;
use rollin::trainer::{Dagger, Forward, Run, Searn, Smile, Supervised};
use rollin::{Purpose, Seed};
use std::sync::Mutex;

/// Two features and no static part; one example for each view.
struct School {
    table: FeatureTable,
    actions: usize,
    examples: Examples<Features>,
}

impl School {
    fn new(actions: usize) -> Self {
        School { table: FeatureTable::new(2), actions, examples: Examples::default() }
    }

    fn show(mut self, dynamic: &[u32], target: Target<'_>) -> Self {
        let view = Features { dynamic: dynamic.to_vec(), ..Features::default() };
        self.examples.push(&view, Actions::All(self.actions as u32), target);
        self
    }

    fn setting(&self) -> Setting<'_, Features> {
        Setting { shared: &self.table, actions: self.actions }
    }

    /// Teaches these examples in this order, as they come up while acting.
    fn lessons<L: Online<Features>>(&self, learner: &L, course: &mut L::Course, order: &[usize]) {
        for &i in order {
            let (row, key, dynamic) = self.examples.views().get(i);
            let view = Features { row, key, dynamic: dynamic.to_vec() };
            let sight = Sight { shared: &self.table, view: &view, legal: self.examples.legal(i) };
            learner.learn(course, &sight, Some(self.examples.target(i)));
        }
    }

    /// The weights of both features after these examples in this order; averaged, as they are learned.
    fn teach(&self, learner: &impl Online<Features, Classifier = Linear>, order: &[usize]) -> [Vec<f32>; 2] {
        let mut course = learner.begin(self.setting(), None);
        self.lessons(learner, &mut course, order);
        weights(&learner.finish(course))
    }
}

fn weights(classifier: &Linear) -> [Vec<f32>; 2] {
    let columns = classifier.weights.columns();
    [0, 1].map(|f| classifier.weights.row(f).map_or(vec![0.0; columns], |row| row[..columns].to_vec()))
}

fn near(found: &[f32], expected: &[f64]) {
    let close = |(f, e): (&f32, &f64)| (f64::from(*f) - e).abs() < 1e-6 * (1.0 + e.abs());
    assert!(found.len() == expected.len() && found.iter().zip(expected).all(close), "{found:?} for {expected:?}");
}

/// {f0} is 1, then {f0, f1} is 0. At first both score 0, the lowest wins and is wrong: f0 = (-1, 1). Then 1 wins and
/// is wrong: f0 = (0, 0), f1 = (1, -1). The average over both: f0 = (-1, 1)/2, f1 = (1, -1)/2.
#[test]
fn the_averaged_perceptron() {
    let school = School::new(2).show(&[0], Target::Label(Action(1))).show(&[0, 1], Target::Label(Action(0)));
    let [f0, f1] = school.teach(&Perceptron::default(), &[0, 1]);
    assert_eq!((f0, f1), (vec![-0.5, 0.5], vec![0.5, -0.5]));
    // Seen again, {f0} scores (0, 0): the lowest wins and is wrong again, f0 = (-1, 1); averages over three.
    let [f0, f1] = school.teach(&Perceptron::default(), &[0, 1, 0]);
    near(&f0, &[-2.0 / 3.0, 2.0 / 3.0]);
    near(&f1, &[2.0 / 3.0, -2.0 / 3.0]);
    // What is right already changes nothing, but counts in the average: f0 is (-1, 1) after each of two.
    let [f0, _] = school.teach(&Perceptron::default(), &[0, 0]);
    assert_eq!(f0, [-1.0, 1.0]);
}

/// Costs 4, 0, 2 are the label 1 with importance (4+2)/2 = 3, for the perceptron and for logistic regression alike.
#[test]
fn costs_through_the_learners_of_labels() {
    let school = School::new(3).show(&[0], Target::Costs(&[4.0, 0.0, 2.0]));
    assert_eq!(school.teach(&Perceptron::default(), &[0])[0], [-3.0, 3.0, 0.0]);
    let (lesson, mut gradient) = (lesson(&school, 0), [0.0; 3]);
    assert!(Logistic::default().gradient(lesson, &[0.0; 3], &mut gradient));
    near(&gradient, &[1.0, -2.0, 1.0]);
    // Costs are counted from the cheapest: 5, 1, 3 are the same.
    let shifted = School::new(3).show(&[0], Target::Costs(&[5.0, 1.0, 3.0]));
    assert_eq!(shifted.teach(&Perceptron::default(), &[0])[0], [-3.0, 3.0, 0.0]);
    // Where nothing is at stake nothing is learned.
    let even = School::new(3).show(&[0], Target::Costs(&[2.0; 3]));
    for found in [even.teach(&Perceptron::default(), &[0]), even.teach(&Logistic::default(), &[0])] {
        assert_eq!(found, [vec![0.0; 3], vec![0.0; 3]]);
    }
}

fn lesson(school: &School, i: usize) -> Lesson<'_> {
    Lesson { actions: school.actions, legal: school.examples.legal(i), target: school.examples.target(i) }
}

/// AdaGrad's first step is the rate against the gradient's sign, whatever its size. The second, for {f0} seen twice
/// with scores (r, -r): p = 1/(1+e^(-2r)), g = 1-p, w = r + r g / sqrt(1/4 + g^2). The average of both is learned.
#[test]
fn logistic_regression() {
    let logistic = Logistic { rate: 0.1, ..Logistic::default() };
    let school = School::new(2).show(&[0], Target::Label(Action(0))).show(&[0], Target::Costs(&[0.0, 7.0]));
    near(&school.teach(&logistic, &[0])[0], &[0.1, -0.1]);
    near(&school.teach(&logistic, &[1])[0], &[0.1, -0.1]);
    let g = 1.0 - 1.0 / (1.0 + (-0.2f64).exp());
    let second = 0.1 + 0.1 * g / (0.25 + g * g).sqrt();
    near(&school.teach(&logistic, &[0, 0])[0], &[(0.1 + second) / 2.0, -(0.1 + second) / 2.0]);
    // With importance 7 in the second example its gradient is seven times as large.
    let heavy = 0.1 + 0.1 * (7.0 * g) / (0.25 + 49.0 * g * g).sqrt();
    near(&school.teach(&logistic, &[0, 1])[0], &[(0.1 + heavy) / 2.0, -(0.1 + heavy) / 2.0]);
    // The penalty adds l2 w to the gradient.
    let l2 = 0.5;
    let g = g - l2 * 0.1;
    let held = 0.1 + 0.1 * g / (0.25 + g * g).sqrt();
    let found = school.teach(&Logistic { l2: l2 as f32, ..logistic }, &[0, 0]);
    near(&found[0], &[(0.1 + held) / 2.0, -(0.1 + held) / 2.0]);
    // Three actions, of which the first is not legal: half of the chance is each of the others', and the first is
    // left alone.
    let legal = [Action(1), Action(2)];
    let some = Lesson { actions: 3, legal: Actions::Only(&legal), target: Target::Label(Action(2)) };
    let mut gradient = [0.0; 3];
    assert!(Logistic::default().gradient(some, &[50.0, 0.0, 0.0], &mut gradient));
    near(&gradient, &[0.0, 0.5, -0.5]);
}

/// Costs 1, 3, 2 are 0, 2, 1 from the cheapest. First step: the dearer two go down by the rate. Second: the gradients
/// are cost minus prediction, 2 - r and 1 - r.
#[test]
fn one_against_all_regression() {
    let r = 0.1;
    let csoaa = Csoaa { rate: r as f32, ..Csoaa::default() };
    let school = School::new(3).show(&[0, 1], Target::Costs(&[1.0, 3.0, 2.0])).show(&[1], Target::Label(Action(1)));
    let [f0, f1] = school.teach(&csoaa, &[0]);
    near(&f0, &[0.0, -r, -r]);
    assert_eq!(f0, f1);
    near(&school.teach(&csoaa, &[1])[1], &[-r, 0.0, -r]);
    // Both features have the weight -r each: the score is -2r.
    let second = |cost: f64| {
        let g = cost - 2.0 * r;
        -r - r * g / (cost * cost + g * g).sqrt()
    };
    near(&school.teach(&csoaa, &[0, 0])[0], &[0.0, (second(2.0) - r) / 2.0, (second(1.0) - r) / 2.0]);
}

/// Costs 0, 1, 1, 3 have v = 0, 1, 1, 5/3; the weight of a pair is the difference, and at score 0 the gradient half
/// of it, down where the first of the pair is cheaper.
#[test]
fn weighted_all_pairs() {
    let school = School::new(4).show(&[0], Target::Costs(&[0.0, 1.0, 1.0, 3.0])).show(&[1], Target::Label(Action(2)));
    let mut gradient = [0.0; 6];
    assert!(Wap::default().gradient(lesson(&school, 0), &[0.0; 6], &mut gradient));
    // Pairs (0,1) (0,2) (0,3) (1,2) (1,3) (2,3).
    near(&gradient, &[-0.5, -0.5, -5.0 / 6.0, 0.0, -1.0 / 3.0, -1.0 / 3.0]);
    let mut gradient = [0.0; 6];
    assert!(Wap::default().gradient(lesson(&school, 1), &[0.0; 6], &mut gradient));
    near(&gradient, &[0.0, 0.5, 0.0, 0.5, 0.0, -0.5]);

    let r = f64::from(Wap::default().rate);
    let mut course = Wap::default().begin(school.setting(), None);
    school.lessons(&Wap::default(), &mut course, &[0, 1]);
    let learned = Wap::default().finish(course);
    let [f0, f1] = weights(&learned);
    // The first step counts in both examples' averages, the second in one.
    near(&f0, &[r, r, r, 0.0, r, r]);
    near(&f1, &[0.0, -r / 2.0, 0.0, -r / 2.0, 0.0, r / 2.0]);
    assert_eq!(learned.columns, Columns::Pairs);

    // Who beats whom: by f0 0 beats all, 1 beats 2 (a tie goes to the lower) and 3, 2 beats 3.
    let votes = |dynamic: &[u32], legal: Actions<'_>| {
        let view = Features { dynamic: dynamic.to_vec(), ..Features::default() };
        learned.scores(&Sight { shared: &school.table, view: &view, legal }, &mut Default::default()).to_vec()
    };
    assert_eq!(votes(&[0], Actions::All(4)), [3.0, 2.0, 1.0, 0.0]);
    assert_eq!(votes(&[1], Actions::All(4)), [2.0, 1.0, 3.0, 0.0]);
    // Only legal pairs are asked.
    assert_eq!(votes(&[0], Actions::Only(&[Action(1), Action(3)])), [0.0, 1.0, 0.0, 0.0]);
}

/// Every learner tells two words apart, from labels as from costs, and starts from where it is told to.
#[test]
fn learners_learn_and_start_warm() {
    fn check<L: Online<Features, Classifier = Linear>>(learner: &L) {
        let labels = School::new(2).show(&[0], Target::Label(Action(0))).show(&[1], Target::Label(Action(1)));
        let costs = School::new(2).show(&[0], Target::Costs(&[1.0, 4.0])).show(&[1], Target::Costs(&[2.0, 0.0]));
        for school in [labels, costs] {
            let fitted = learner.fit(school.setting(), &school.examples, None, Seed::new(1));
            let choose = |classifier: &Linear, feature: u32| {
                let view = Features { dynamic: vec![feature], ..Features::default() };
                let sight = Sight { shared: &school.table, view: &view, legal: Actions::All(2) };
                classifier.choose(&sight, &mut Default::default())
            };
            assert_eq!((choose(&fitted, 0), choose(&fitted, 1)), (Action(0), Action(1)));
            let again = learner.finish(learner.begin(school.setting(), Some(&fitted)));
            assert_eq!(weights(&again), weights(&fitted), "a warm start that learns nothing is where it started");
            let seeded =
                |n| learner.fit(school.setting(), &school.examples, None, Seed::new(n).child(Purpose::Learner, 0));
            assert!(seeded(1) == seeded(1));
        }
    }
    check(&Perceptron::default());
    check(&Logistic::default());
    check(&Csoaa::default());
    check(&Wap::default());
    check(&Svm::default());
    check(&CrammerSinger::default());
}

/// Learning from examples that were kept is learning from them as they come up.
#[test]
fn studying_is_learning_while_acting() {
    fn check<L: Online<Features, Classifier: PartialEq>>(learner: &L) -> (L::Course, L::Classifier) {
        let mut school = School::new(3);
        for i in 0..40u64 {
            let draw = |t: u64| Seed::new(i).child(Purpose::Step, t).unit();
            let features: &[u32] = [&[0][..], &[1], &[0, 1]][(3.0 * draw(0)) as usize];
            let costs = [1, 2, 3].map(|t| draw(t) as f32);
            let label = Target::Label(Action((3.0 * draw(4)) as u32));
            school = school.show(features, if i % 2 == 0 { label } else { Target::Costs(&costs) });
        }
        let [mut acting, mut studying] = [0, 1].map(|_| learner.begin(school.setting(), None));
        school.lessons(learner, &mut acting, &(0..40).collect::<Vec<_>>());
        learner.study(&mut studying, school.setting(), &school.examples);
        let learned = learner.finish(acting);
        let empty = learner.finish(learner.begin(school.setting(), None));
        assert!(learned != empty && learned == learner.finish(studying));
        let mut course = learner.begin(school.setting(), None);
        learner.study(&mut course, school.setting(), &school.examples);
        (course, learned)
    }
    /// Where nothing is averaged, a course scores as what it ends with.
    fn same<C: Classifier<Features>, D: Classifier<Features>>((course, learned): (C, D)) {
        let table = FeatureTable::new(2);
        for dynamic in [vec![], vec![0], vec![1], vec![0, 1]] {
            let view = Features { dynamic, ..Features::default() };
            let sight = Sight { shared: &table, view: &view, legal: Actions::All(3) };
            let (mut before, mut after) = Default::default();
            assert_eq!(course.scores(&sight, &mut before), learned.scores(&sight, &mut after));
        }
    }
    check(&Perceptron::default());
    check(&Logistic::default());
    check(&Wap::default());
    same(check(&Svm::default()));
    same(check(&CrammerSinger::default()));
    same(check(&Net { units: 5, batch: 8, ..Net::default() }));
}

/// A word says its label, but for one, whose label is that of the word before: the expert is always imitable.
#[test]
fn every_trainer_with_every_learner_learns_an_easy_task() {
    let names = ["A", "D", "N", "V"];
    let sentence = |i: u64| {
        let draw = |t: u64| (Seed::new(i).child(Purpose::Step, t).unit() * 5.0) as usize;
        let mut before = "A";
        let length = 1 + (Seed::new(i).unit() * 9.0) as u64;
        let mut words = Vec::new();
        for t in 0..length {
            let word = draw(t);
            let label = names.get(word).copied().unwrap_or(before);
            before = label;
            words.push((format!("w{word}"), label.to_owned()));
        }
        words
    };
    let problem = problem(&(0..40).map(sentence).collect());
    for trainer in trainers() {
        for learner in learners() {
            let trained = trainer.train(&problem, &learner, &Run::new(1)).unwrap();
            let (done, _) = trained.policy.perform_from(&problem, 0, Seed::new(2));
            let accuracy = 1.0 - done.costs.iter().sum::<f64>() / tokens(&problem) as f64;
            // CPI learns from one state a sentence.
            let least = if let Trainer::Cpi(_) = trainer { 0.8 } else { 0.95 };
            assert!(accuracy > least, "{trainer:?} with {learner:?}: {accuracy}");
        }
    }
}

/// The perceptron, keeping count of the examples it was given each time.
struct Counting(Mutex<Vec<u64>>);

impl Learner<Features> for Counting {
    type Classifier = Linear;
    fn fit(
        &self,
        setting: Setting<'_, Features>,
        examples: &Examples<Features>,
        warm: Option<&Linear>,
        seed: Seed,
    ) -> Linear {
        self.0.lock().unwrap().push(examples.len() as u64);
        Perceptron::default().fit(setting, examples, warm, seed)
    }
}

/// DAgger learns from all rounds so far, SMILe and SEARN from the last alone, forward training from one step.
#[test]
fn trainers_hand_on_what_they_should() {
    let problem = problem(&sample(Labels::Free(3), 8));
    let (n, run) = (tokens(&problem), Run::new(1));
    let counts = |train: &dyn Fn(&Counting)| {
        let learner = Counting(Mutex::default());
        train(&learner);
        learner.0.into_inner().unwrap()
    };
    let dagger = Dagger { rounds: 3, ..Dagger::default() };
    let smile = Smile { rounds: 3, ..Smile::default() };
    let searn = Searn { rounds: 3, ..Searn::default() };
    assert_eq!(counts(&|l| drop(Supervised::default().train(&problem, l, &run).unwrap())), [n]);
    assert_eq!(counts(&|l| drop(dagger.train(&problem, l, &run).unwrap())), [n, 2 * n, 3 * n]);
    assert_eq!(counts(&|l| drop(smile.train(&problem, l, &run).unwrap())), [n, n, n]);
    assert_eq!(counts(&|l| drop(searn.train(&problem, l, &run).unwrap())), [n, n, n]);
    let steps = counts(&|l| drop(Forward::default().train(&problem, l, &run).unwrap()));
    let reach = |t: u64| (0..8).filter(|i| problem.space.horizon(*i).unwrap() as u64 > t).count() as u64;
    assert_eq!(steps, (0..steps.len() as u64).map(reach).collect::<Vec<_>>());
}
