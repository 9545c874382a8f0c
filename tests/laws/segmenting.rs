//! Spans: the expert is optimal however the sentence was cut before, every trainer learns to cut, and what comes out is IOB2.

use crate::common::{Sentences, corpus, fixed, is_optimal, learners, trainers};
use proptest::collection::vec;
use proptest::prelude::*;
use rollin::Seed;
use rollin::corpus::Corpus;
use rollin::read::conll::{self, Block};
use rollin::read::template::Template;
use rollin::space::{CostToGo, Episode, Expert, Space};
use rollin::tasks::segmenting::{Divider, Segmenter, Settings, Spans};
use rollin::tasks::tagging::{LabelColumn, Order, illegal};
use rollin::tasks::{About, Data, ProblemOf, Task, Trainer};
use rollin::trainer::{Run, Supervised};

/// Two words that begin spans of two types, one that goes on with them, and one outside.
fn cities(sentences: &[Vec<(usize, usize)>]) -> Sentences {
    let sentence = |spans: &Vec<(usize, usize)>| {
        let mut tokens = Vec::new();
        for (length, kind) in spans {
            let kind = ["X", "Y"][*kind];
            match length {
                0 => tokens.push(("o".to_owned(), "O".to_owned())),
                length => {
                    tokens.push((format!("{kind}{length}"), format!("B-{kind}")));
                    tokens.extend((1..*length).map(|_| ("i".to_owned(), format!("I-{kind}"))));
                }
            }
        }
        tokens
    };
    sentences.iter().map(sentence).collect()
}

fn drawn(sentences: usize, spans: usize, longest: usize) -> impl Strategy<Value = Sentences> {
    vec(vec((0usize..=longest, 0usize..2), 1..=spans), 1..=sentences).prop_map(|mut drawn| {
        drawn[0].push((1, 0));
        cities(&drawn)
    })
}

fn settings(longest: u32) -> Settings {
    let template = Template::parse("U0:%x[0,0]\nU1:%x[1,0]\nB\nU2:%y[-1]%y[-2]%x[0,0]\n", "small".as_ref()).unwrap();
    Settings { template, labels: LabelColumn::Last, longest }
}

fn learned(corpus: &Corpus, longest: u32) -> (Spans, ProblemOf<Spans>) {
    Spans::learn(corpus, settings(longest)).expect("spans")
}

/// What the program would write for `corpus`.
fn written(model: &Segmenter, corpus: &Corpus, seed: u64) -> Corpus {
    let space = model.encoding.apply(corpus).unwrap();
    let actions = model.perform(space, corpus.sentences(), 0, Seed::new(seed));
    let mut text = Vec::new();
    corpus.write(&mut text, Default::default()).unwrap();
    let block = Block { bytes: text, first_line: 1 };
    let read = block.corpus("random".as_ref()).unwrap().unwrap();
    let mut out = Vec::new();
    model.encoding.write(&block, Some((&read, &actions)), &mut out).unwrap();
    conll::parse(&out, "written".as_ref(), 1).unwrap()
}

proptest! {
    #![proptest_config(fixed(60))]

    /// Also where spans are longer than any action.
    #[test]
    fn the_expert_is_optimal(sentences in drawn(2, 2, 3), longest in 1u32..=3) {
        let (_, problem) = learned(&corpus(&sentences), longest);
        if let Err(what) = is_optimal(&problem) {
            return Err(TestCaseError::fail(what));
        }
    }

    /// Labels as odd as may be: what is right is what conlleval reads in them, and who follows the expert gets all of it.
    #[test]
    fn the_expert_spells_the_spans(tokens in vec(vec("O|[BILUES]-[XY]", 1..6), 1..5)) {
        let mut sentences: Sentences =
            tokens.into_iter().map(|labels| labels.into_iter().map(|label| ("w".to_owned(), label)).collect()).collect();
        sentences[0].push(("w".into(), "B-X".into()));
        let corpus = corpus(&sentences);
        let (spans, problem) = learned(&corpus, 8);
        let mut actions = Vec::new();
        for index in 0..problem.episodes {
            let (mut state, mut cost) = (problem.space.start(Episode { index, seed: Seed::new(0) }), 0.0);
            while !problem.space.legal(&state).is_empty() {
                let action = Divider.action(&problem.space, &state).unwrap();
                cost += problem.space.step(&mut state, action, Seed::new(0));
                actions.push(action);
            }
            prop_assert_eq!(cost, 0.0);
        }
        let score = spans.score(&corpus, &actions).unwrap();
        prop_assert_eq!((score.accuracy(), score.chunks().correct), (1.0, score.chunks().gold));
    }

    /// Any trainer and learner, any words: IOB2 comes out, and the model that is read again says the same.
    #[test]
    fn everybody_writes_iob2(
        train in drawn(12, 4, 4), other in drawn(5, 4, 4), which in 0usize..15, kind in 0usize..8, longest in 1u32..=5,
    ) {
        let (spans, problem) = learned(&corpus(&train), longest);
        let trained = trainers()[which].train(&problem, &learners()[kind], &Run::new(5)).unwrap();
        let model = Segmenter::new(spans, trained.policy, About::default()).unwrap();
        let other = corpus(&other);
        let tagged = written(&model, &other, 3);
        prop_assert_eq!((tagged.tokens(), tagged.columns.len()), (other.tokens(), 3));
        prop_assert!(illegal(&tagged, 2, Some(Order::Bio)).0.is_empty());
        let bytes = model.to_bytes();
        let again = Segmenter::from_bytes(&bytes, "model".as_ref()).unwrap();
        prop_assert!(again.to_bytes() == bytes);
        prop_assert_eq!(written(&again, &other, 3), tagged);
    }
}

/// Worked by hand: gold B I I O with spans of up to two tokens.
#[test]
fn costs_by_hand() {
    let corpus = corpus(&cities(&[vec![(3, 0), (0, 0)], vec![(2, 0)]]));
    let (spans, problem) = learned(&corpus, 2);
    assert_eq!(spans.actions(), 3); // O, X, XX
    let mut state = problem.space.start(Episode { index: 0, seed: Seed::new(0) });
    let mut costs = Vec::new();
    // O: the first is wrong, then XX has one wrong. X: right, then XX has one wrong; XX: right, and one token of three is left.
    Divider.costs(&problem.space, &state, &mut costs);
    assert_eq!(costs, [2.0, 1.0, 1.0]);
    assert_eq!(Divider.action(&problem.space, &state).map(|a| a.0), Some(2));
    assert_eq!(problem.space.step(&mut state, rollin::space::Action(0), Seed::new(0)), 1.0);
    Divider.costs(&problem.space, &state, &mut costs);
    assert_eq!(costs, [2.0, 2.0, 1.0]);
    problem.space.step(&mut state, rollin::space::Action(2), Seed::new(0));
    Divider.costs(&problem.space, &state, &mut costs);
    assert_eq!(costs, [0.0, 1.0]);
    problem.space.step(&mut state, rollin::space::Action(0), Seed::new(0));
    assert!(problem.space.legal(&state).is_empty());
    Divider.costs(&problem.space, &state, &mut costs);
    assert!(costs.is_empty());
}

/// The word says how long the span is: nothing to get wrong, for all trainers with all learners, at any number of threads.
#[test]
fn everybody_learns_to_cut() {
    let drawn = crate::common::drawn(vec(vec((0usize..=3, 0usize..2), 1..5), 40), 11);
    let corpus = corpus(&cities(&drawn));
    let (spans, problem) = learned(&corpus, 3);
    for trainer in trainers().into_iter().filter(|trainer| !matches!(trainer, Trainer::Cpi(_))) {
        for learner in learners() {
            let with = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| trainer.train(&problem, &learner, &Run::new(1)).unwrap())
            };
            let trained = with(2);
            assert_eq!(trained.ledger, with(1).ledger);
            let model = Segmenter::new(spans.clone(), trained.policy, About::default()).unwrap();
            let actions = model.perform(model.encoding.apply(&corpus).unwrap(), corpus.sentences(), 0, Seed::new(2));
            let f1 = spans.score(&corpus, &actions).unwrap().f1();
            assert!(f1 > 0.8, "{f1} by {trainer:?} with {learner:?}");
        }
    }
}

#[test]
fn what_has_no_spans_is_refused() {
    let learn = |text: &str, settings: Settings| {
        let corpus = conll::parse(text.as_bytes(), "text".as_ref(), 1).unwrap();
        Spans::learn(&corpus, settings).map(|_| ()).unwrap_err().to_string()
    };
    let expected = "expected labels of spans: O, or B-, I-, L-, U-, E- or S- and a type";
    assert_eq!(learn("a B-X\nb NN\n", settings(3)), format!("text:2:3: label NN; {expected}"));
    assert_eq!(learn("a O\n", settings(3)), format!("text:1:3: no span in the whole corpus; {expected}"));
    assert_eq!(learn("a B-X\n", settings(0)), "longest span is 0, but must be 1 to 64");
    let template = Template::parse("U:%y[0]\n", "t".as_ref()).unwrap();
    let error = learn("a B-X\n", Settings { template, ..settings(3) });
    assert_eq!(error, "template is looking ahead, but must be one without %y[0] and the like: spans are read once");
}

/// On a real corpus: spans beat nothing at all by far, and the default template takes what it needs.
#[test]
fn chunks_of_a_real_corpus() {
    let Some(folder) = std::env::var_os("ROLLIN_DATA") else {
        eprintln!("skipped: ROLLIN_DATA is not set");
        return;
    };
    let read = |name: &str| conll::read_file(std::path::Path::new(&folder).join("conll2000").join(name)).unwrap();
    let (mut train, mut test) = (read("train.txt"), read("test.txt"));
    train.truncate(1000);
    Data::truncate(&mut test, 300);
    let settings = Settings::default_for(&train, LabelColumn::Last, 8).unwrap();
    let (spans, problem) = Spans::learn(&train, settings).unwrap();
    let learner = rollin::learner::Perceptron::default();
    let trained = Supervised::default().train(&problem, &learner, &Run::new(1)).unwrap();
    let model = Segmenter::new(spans, trained.policy, About::default()).unwrap();
    let actions = model.perform(model.encoding.apply(&test).unwrap(), test.sentences(), 0, Seed::new(1));
    let f1 = model.encoding.score(&test, &actions).unwrap().f1();
    assert!(f1 > 0.87, "{f1}");
}
