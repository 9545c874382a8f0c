//! Two readings of a sentence.

use rollin::corpus::Corpus;
use rollin::learner::Logistic;
use rollin::read::{conll, template::Template};
use rollin::roll::perform;
use rollin::space::{Action, Space};
use rollin::tasks::tagging::{Encoding, Tagger, Tagging};
use rollin::tasks::{About, AnyLearner, Learned, Task, Trainer};
use rollin::trainer::{Dagger, Keeping, Run, Smile, Trained};
use rollin::{Result, Seed};
use std::path::Path;

/// Sentences in which the last word says what all labels are.
fn corpus(count: usize) -> Corpus {
    let sentence = |i: usize| {
        let (word, label) = if (i * i % 7).is_multiple_of(2) { ("a", "A") } else { ("b", "B") };
        format!("x {label}\n").repeat(3 + i % 4) + &format!("{word} {label}\n\n")
    };
    let text: String = (0..count).map(sentence).collect();
    conll::parse(text.as_bytes(), Path::new("corpus"), 1).expect("a corpus")
}

const BEFORE: &str = "U1:%x[0,0]\nU2:%y[-1]\n";
const AHEAD: &str = "U1:%x[0,0]\nU2:%y[-1]\nU3:%y[0]\nU4:%y[0]|%y[1]\n";

fn learn(corpus: &Corpus, template: &str) -> (Encoding, Tagging) {
    let template = Template::parse(template, Path::new("template")).expect("a template");
    Encoding::learn(corpus, template.into()).expect("features")
}

fn train(space: &Tagging, trainer: &Trainer) -> Result<Trained<Learned>> {
    let learner = AnyLearner::Logistic(Logistic::default());
    let train = |problem: &_, run: &Run<'_, Keeping>| trainer.train(problem, &learner, run);
    Encoding::train(&space.clone().problem(), &Run::new(1).kept(None), &train)
}

fn online() -> Trainer {
    Trainer::DaggerOnline(Dagger { rounds: 4, ..Dagger::default() })
}

/// How many of a hundred labels are right.
fn right(template: &str) -> usize {
    let (train_on, test) = (corpus(60), corpus(101));
    let (encoding, space) = learn(&train_on, template);
    let tagger = Tagger::new(encoding, train(&space, &online()).expect("a policy").policy, About::default());
    let tagger = tagger.expect("a tagger");
    let labels = tagger.tag(&test, Seed::new(1)).expect("labels");
    let word = |t: usize| test.word(1, t);
    100 * (0..test.tokens()).filter(|t| tagger.encoding.labels[labels[*t] as usize] == word(*t)).count() / test.tokens()
}

/// Nothing before the last word tells the label; who has read the sentence from its end knows it.
#[test]
fn what_comes_can_be_known() {
    assert!(right(BEFORE) < 80, "{}", right(BEFORE));
    assert_eq!(right(AHEAD), 100);
}

/// The first reading is trained on each half and on the whole, the second on the whole.
#[test]
fn both_readings_are_billed() {
    let (_, space) = learn(&corpus(21), AHEAD);
    let tokens = corpus(21).tokens() as u64;
    for (trainer, rounds) in [(online(), 4), (Trainer::Smile(Smile { rounds: 3, ..Smile::default() }), 3)] {
        let ledger = train(&space, &trainer).expect("a policy").ledger;
        assert_eq!(ledger.labels, 3 * rounds * tokens);
        // Each half is read once more for the labels that the second reading is told.
        assert_eq!(ledger.steps, 3 * rounds * tokens + tokens);
    }
}

/// A reading from the end takes a sentence's labels in the opposite order, and what it said stands at the tokens it said it of.
#[test]
fn the_first_reading_begins_at_the_end() {
    let corpus = corpus(9);
    let (_, space) = learn(&corpus, AHEAD);
    let follow = |space: Tagging| perform(&space.problem(), &rollin::policy::Follow, Seed::new(1)).0.actions;
    let (there, back) = (follow(space.clone()), follow(space.backwards()));
    let mut turned: Vec<Action> = Vec::new();
    for i in 0..corpus.sentences() {
        turned.extend(corpus.sentence(i).rev().map(|token| there[token]));
    }
    assert_eq!(back, turned);
    // With the right labels told, those are the features: U3 at each token and U4 with the next one's.
    let told = space.told(&back);
    let mut state = told.start(rollin::space::Episode { index: 1, seed: Seed::new(1) });
    let mut view = Default::default();
    let mut seen = Vec::new();
    while !told.legal(&state).is_empty() {
        told.look(&state, &mut view);
        assert_eq!(view.dynamic.len(), 2);
        seen.push((view.dynamic[0], view.dynamic[1]));
        told.step(&mut state, there[corpus.sentence(1).start], Seed::new(1));
    }
    // All tokens but the last have the same labels at and behind them; behind the last there is none.
    let (last, rest) = seen.split_last().expect("tokens");
    assert!(rest.iter().all(|pair| *pair == rest[0]) && last.0 == rest[0].0 && last.1 != rest[0].1);
}

#[test]
fn two_readings_are_saved() {
    let (encoding, space) = learn(&corpus(30), AHEAD);
    for trainer in [online(), Trainer::Smile(Smile { rounds: 2, ..Smile::default() })] {
        let policy = train(&space, &trainer).expect("a policy").policy;
        let tagger = Tagger::new(encoding.clone(), policy, About::default()).expect("a tagger");
        let bytes = tagger.to_bytes();
        let again = Tagger::from_bytes(&bytes, Path::new("model")).expect("a model");
        assert_eq!(again.to_bytes(), bytes);
        let test = corpus(41);
        assert_eq!(again.tag(&test, Seed::new(3)).expect("labels"), tagger.tag(&test, Seed::new(3)).expect("labels"));
    }
}

#[test]
fn one_sentence_cannot_be_read_unseen() {
    let (_, space) = learn(&corpus(1), AHEAD);
    let error = train(&space, &online()).expect_err("one sentence");
    assert_eq!(error.to_string(), "sentences is 1, but must be at least 2 for a template that looks ahead");
}
