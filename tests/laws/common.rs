//! Random small corpora, all trainers, all learners, and classifiers simple enough to be predicted.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::RngSeed;
use rollin::corpus::Corpus;
use rollin::learner::{CrammerSinger, Csoaa, FilterTree, Hinge, Logistic, Perceptron, Svm, Wap};
use rollin::policy::Classifier;
use rollin::read::template::Template;
use rollin::space::{Action, CostToGo, Episode, Features, Imitation, Problem, Sight, Space};
use rollin::tasks::tagging::{Encoding, TaggingProblem};
use rollin::tasks::{AnyLearner, Trainer};
use rollin::trainer::{
    Aggrevate, Cpi, Dagger, EarlyUpdate, Forward, Lols, Rate, Schedule, Searn, Smile, Stacking, Supervised,
};

/// `cases` cases that are the same in every run.
pub fn fixed(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(2010), failure_persistence: None, ..ProptestConfig::default() }
}

/// Which labels a random corpus has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Labels {
    /// So many, in any order.
    Free(usize),
    /// O and B and I of so many types, by the rule of IOB2.
    Spans(usize),
}

impl Labels {
    pub fn names(self) -> Vec<&'static str> {
        match self {
            Labels::Free(n) => vec!["A", "D", "N", "P", "V"][..n].to_vec(),
            Labels::Spans(types) => vec!["O", "B-NP", "I-NP", "B-VP", "I-VP"][..1 + 2 * types].to_vec(),
        }
    }
}

/// Sentences of words and labels.
pub type Sentences = Vec<Vec<(String, String)>>;

/// Between two and five labels, free or IOB2.
pub fn labels() -> impl Strategy<Value = Labels> {
    prop_oneof![(2usize..=5).prop_map(Labels::Free), (1usize..=2).prop_map(Labels::Spans)]
}

/// Up to `sentences` sentences of 1 to `length` tokens, from a vocabulary of six words; two labels in three go with
/// the word.
pub fn corpora(labels: Labels, sentences: usize, length: usize) -> impl Strategy<Value = Sentences> {
    let token = (0usize..6, 0usize..3, 0usize..60);
    vec(vec(token, 1..=length), 1..=sentences).prop_map(move |drawn| {
        let names = labels.names();
        let spell = |tokens: Vec<(usize, usize, usize)>| {
            let mut before = "O";
            let mut sentence = Vec::new();
            for (word, noise, any) in tokens {
                let mut label = names[if noise > 0 { word % names.len() } else { any % names.len() }];
                if label.starts_with("I-") && (before == "O" || before[1..] != label[1..]) {
                    label = names[names.iter().position(|n| *n == label).expect("it is one of them") - 1];
                }
                before = label;
                sentence.push((format!("w{word}"), label.to_owned()));
            }
            sentence
        };
        drawn.into_iter().map(spell).collect()
    })
}

/// Random corpora of any labels.
pub fn any_corpora(sentences: usize, length: usize) -> impl Strategy<Value = Sentences> {
    labels().prop_flat_map(move |labels| corpora(labels, sentences, length))
}

/// A corpus that is the same in every run: `number` chooses among them.
pub fn drawn<T>(strategy: impl Strategy<Value = T>, number: u64) -> T {
    let config = ProptestConfig { rng_seed: RngSeed::Fixed(number), failure_persistence: None, ..Default::default() };
    let mut runner = proptest::test_runner::TestRunner::new(config);
    strategy.new_tree(&mut runner).expect("nothing is filtered").current()
}

/// `count` sentences of 1 to 12 tokens, the same in every run.
pub fn sample(labels: Labels, count: usize) -> Sentences {
    let sentences = drawn(vec(corpora(labels, 1, 12), count), 7);
    sentences.into_iter().flatten().collect()
}

pub fn corpus(sentences: &Sentences) -> Corpus {
    let mut corpus = Corpus::new("random", 2);
    let mut line = 0;
    for sentence in sentences {
        for (word, label) in sentence {
            line += 1;
            corpus.push(&[word, label], line);
        }
        corpus.end_sentence();
        line += 1;
    }
    corpus
}

/// The word, the word before, the label before, and the label before with the word.
pub const TEMPLATE: &str = "U0:%x[0,0]\nU1:%x[-1,0]\nB\nU2:%y[-1]/%x[0,0]\n";

pub fn template() -> Template {
    Template::parse(TEMPLATE, "small".as_ref()).expect("it is a template")
}

pub fn encoded(sentences: &Sentences) -> (Encoding, TaggingProblem) {
    let learned = Encoding::learn(&corpus(sentences), template().into());
    let (encoding, space) = learned.expect("the corpus is in order");
    (encoding, space.problem())
}

pub fn problem(sentences: &Sentences) -> TaggingProblem {
    encoded(sentences).1
}

/// The same with features of two labels back, alone and with the word: a policy cannot decide by the last label alone.
pub fn deep_problem(sentences: &Sentences) -> TaggingProblem {
    let text = format!("{TEMPLATE}U3:%y[-2]/%y[-1]\nU4:%y[-2]/%x[0,0]\n");
    let template = Template::parse(&text, "deep".as_ref()).expect("it is a template");
    Encoding::learn(&corpus(sentences), template.into()).expect("the corpus is in order").1.problem()
}

pub fn tokens(problem: &impl Problem) -> u64 {
    (0..problem.episodes()).map(|i| problem.space().horizon(i).expect("sentences have lengths") as u64).sum()
}

/// Every trainer, with settings small enough for tests.
pub fn trainers() -> Vec<Trainer> {
    let searn = Searn { beta: 0.4, rounds: 3, samples: 2, warm: false };
    let dagger = Dagger { rounds: 3, warm: false, schedule: None };
    let lols = Lols { beta: 0.5, rounds: 3, warm: false };
    vec![
        Trainer::Supervised(Supervised::default()),
        Trainer::Forward(Forward { warm: true, ..Forward::default() }),
        Trainer::Smile(Smile { alpha: 0.4, rounds: 4, ..Smile::default() }),
        Trainer::Searn(searn.clone()),
        Trainer::SearnOnline(searn.clone()),
        Trainer::SearnShortcut(searn),
        Trainer::Dagger(dagger.clone()),
        Trainer::DaggerOnline(dagger.clone()),
        Trainer::Cpi(Cpi { rate: Rate::Fixed(0.4), rounds: 4, samples: 2, warm: true }),
        Trainer::Dagger(Dagger { schedule: Some(Schedule::Exponential(0.5)), warm: true, ..dagger.clone() }),
        Trainer::DaggerOnline(Dagger { schedule: Some(Schedule::Linear(2)), ..dagger }),
        Trainer::Aggrevate(Aggrevate { rounds: 3, warm: false, schedule: Schedule::Linear(2) }),
        Trainer::Lols(lols.clone()),
        Trainer::LolsOnline(lols),
        Trainer::Stacked(Stacking { folds: 3, window: 1 }),
        Trainer::EarlyUpdate(EarlyUpdate { width: 3, rounds: 4 }),
    ]
}

/// Whether it finds costs by rolling out, and so asks for acts and not for labels.
pub fn rolls_out(trainer: &Trainer) -> bool {
    matches!(
        trainer,
        Trainer::Searn(_) | Trainer::SearnOnline(_) | Trainer::Cpi(_) | Trainer::Lols(_) | Trainer::LolsOnline(_)
    )
}

pub fn learners() -> Vec<AnyLearner> {
    vec![
        AnyLearner::Perceptron(Perceptron::default()),
        AnyLearner::Logistic(Logistic::default()),
        AnyLearner::Hinge(Hinge::default()),
        AnyLearner::Csoaa(Csoaa::default()),
        AnyLearner::Wap(Wap::default()),
        AnyLearner::FilterTree(FilterTree::default()),
        AnyLearner::Svm(Svm::default()),
        AnyLearner::CrammerSinger(CrammerSinger::default()),
    ]
}

/// A classifier whose scores are the same everywhere.
#[derive(Clone, Debug)]
pub struct Constant(pub Vec<f32>);

impl Constant {
    /// The one that always prefers `action` of `actions`.
    pub fn always(action: usize, actions: usize) -> Self {
        Constant((0..actions).map(|a| if a == action { 1.0 } else { 0.0 }).collect())
    }
}

impl Classifier<Features> for Constant {
    type Memory = Vec<f32>;
    fn scores<'m>(&self, _: &Sight<'_, Features>, memory: &'m mut Vec<f32>) -> &'m [f32] {
        memory.clone_from(&self.0);
        memory
    }
}

/// Whether counts agree with probabilities, by chi-square. By Laurent and Massart's bound the statistic of d degrees of
/// freedom exceeds d + 2 sqrt(20 d) + 40 with a chance below e^-20 = 2.1e-9.
pub fn agree(counts: &[u64], shares: &[f64]) -> Result<(), String> {
    let total = counts.iter().sum::<u64>() as f64;
    let mut chi = 0.0;
    for (count, share) in counts.iter().zip(shares) {
        let expected = total * share;
        if expected == 0.0 {
            if *count > 0 {
                return Err(format!("{count} draws of something that has no weight"));
            }
            continue;
        }
        assert!(expected > 20.0, "too few draws for a chi-square");
        chi += (*count as f64 - expected).powi(2) / expected;
    }
    let degrees = shares.iter().filter(|share| **share > 0.0).count() as f64 - 1.0;
    let bound = degrees + 2.0 * (20.0 * degrees).sqrt() + 40.0;
    if chi <= bound { Ok(()) } else { Err(format!("chi-square {chi} above {bound}: {counts:?} for {shares:?}")) }
}

/// The least cost from `state` to the end, by trying everything.
fn least<S: Space<State: Clone>>(space: &S, state: &S::State) -> f64 {
    let tried = space.legal(state).iter().map(|action| {
        let mut next = state.clone();
        let cost = space.step(&mut next, action, rollin::Seed::new(0));
        cost + least(space, &next)
    });
    let found = tried.fold(f64::INFINITY, f64::min);
    if found == f64::INFINITY { 0.0 } else { found }
}

/// Checks at every state that can be reached that the expert's costs-to-go are those of trying everything, and that its answer is one of the best. Returns how
/// many states there were.
pub fn is_optimal<S, E>(problem: &Imitation<S, E>) -> Result<usize, String>
where
    S: Space<State: Clone>,
    E: CostToGo<S>,
{
    fn walk<S: Space<State: Clone>, E: CostToGo<S>>(space: &S, expert: &E, state: &S::State) -> Result<usize, String> {
        let legal: Vec<Action> = space.legal(state).iter().collect();
        let (mut costs, mut count) = (Vec::new(), 1);
        if legal.is_empty() {
            return Ok(count);
        }
        expert.costs(space, state, &mut costs);
        let mut all = Vec::new();
        for action in &legal {
            let mut next = state.clone();
            all.push(space.step(&mut next, *action, rollin::Seed::new(0)) + least(space, &next));
            count += walk(space, expert, &next)?;
        }
        let answer = expert.action(space, state).and_then(|answer| legal.iter().position(|a| *a == answer));
        let best = all.iter().copied().fold(f64::INFINITY, f64::min);
        match answer {
            Some(place) if all == costs && all[place] == best => Ok(count),
            _ => Err(format!("{legal:?} cost {all:?}, but the expert says {costs:?} and does {answer:?}")),
        }
    }
    let start = |index| problem.space.start(Episode { index, seed: rollin::Seed::new(0) });
    (0..problem.episodes).map(|index| walk(&problem.space, &problem.expert, &start(index))).sum()
}
