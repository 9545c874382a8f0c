//! Model files: they come back as they were, and nothing that is not whole is read.

use crate::common::{Labels, any_corpora, corpus, encoded, fixed, learners, sample, trainers};
use proptest::prelude::*;
use rollin::policy::{Greedy, Reading};
use rollin::read::template::Template;
use rollin::tasks::tagging::{Encoding, Tagger, doc};
use rollin::tasks::{About, AnyLearner, Learned, Trainer};
use rollin::trainer::{EarlyUpdate, Forward, Run, Smile, Stacking};
use rollin::{Purpose, Seed};
use std::path::Path;

fn read(bytes: &[u8]) -> rollin::Result<Tagger> {
    Tagger::from_bytes(bytes, Path::new("model"))
}

/// Every trainer with every learner in every reading: the same bytes, the same tags, the same story.
#[test]
fn models_come_back() {
    let sentences = sample(Labels::Spans(2), 20);
    let (encoding, problem) = encoded(&sentences);
    let unlabelled = corpus(&sample(Labels::Free(2), 30));
    for trainer in trainers() {
        for learner in learners() {
            let trained = trainer.train(&problem, &learner, &Run::new(1)).unwrap();
            let about = About { trainer: format!("{trainer:?}"), ledger: trained.ledger, ..About::default() };
            for reading in [Reading::Sampled, Reading::Vote, Reading::Mean] {
                let policy = trained.policy.clone().read_as(reading);
                let tagger = Tagger::new(encoding.clone(), policy.clone(), about.clone()).unwrap();
                let bytes = tagger.to_bytes();
                let again = read(&bytes).unwrap();
                assert!(again.to_bytes() == bytes, "{trainer:?} {learner:?} {reading:?}");
                assert_eq!(again.about, about);
                let seed = Seed::new(8);
                assert_eq!(tagger.tag(&unlabelled, seed).unwrap(), again.tag(&unlabelled, seed).unwrap());
                // Forgetting the features without weights and renumbering the rest has changed nothing either.
                let before = policy.perform_from(&problem, 0, seed.child(Purpose::Evaluation, 0)).0.actions;
                let after = again.tag(&corpus(&sentences), seed).unwrap();
                assert!(before.iter().map(|a| a.0).eq(after), "{trainer:?} {learner:?} {reading:?}");
            }
        }
    }
}

proptest! {
    #![proptest_config(fixed(60))]

    #[test]
    fn models_of_random_corpora_come_back(sentences in any_corpora(40, 12), which in 0usize..15, kind in 0usize..4) {
        let (encoding, problem) = encoded(&sentences);
        let policy = trainers()[which].train(&problem, &learners()[kind], &Run::new(6)).unwrap().policy;
        let bytes = Tagger::new(encoding, policy, About::default()).unwrap().to_bytes();
        let again = read(&bytes).unwrap();
        prop_assert!(again.to_bytes() == bytes);
        prop_assert_eq!(again.tag(&corpus(&sentences), Seed::new(1)).unwrap().len(), problem.space.gold().len());
    }
}

/// A small model of each shape: 700 to 1,500 bytes.
fn small_models() -> Vec<Vec<u8>> {
    let template = Template::parse("U:%x[0,0]\nB\n", "tiny".as_ref()).unwrap();
    let (encoding, space) = Encoding::learn(&doc::corpus().unwrap(), template.into()).unwrap();
    let problem = space.problem();
    let AnyLearner::Perceptron(learner) = &learners()[0] else { unreachable!() };
    let smile = Smile { rounds: 2, ..Smile::default() }.train(&problem, learner, &Run::new(1)).unwrap();
    let forward = Forward::default().train(&problem, learner, &Run::new(1)).unwrap();
    let stacked = Stacking { folds: 2, window: 1 }.train(&problem, learner, &Run::new(1)).unwrap();
    let beam = EarlyUpdate { width: 2, rounds: 2 }.train(&problem, &Run::new(1)).unwrap();
    let (mixture, ladder) = (Learned::from(smile.policy), Learned::from(forward.policy));
    [mixture, ladder, Learned::from(stacked.policy), Learned::from(beam.policy)]
        .map(|p| Tagger::new(encoding.clone(), p, About::default()).unwrap().to_bytes())
        .into()
}

/// Every byte replaced by every other: exhaustive, two thirds of a million files.
#[test]
fn no_damaged_byte_is_missed() {
    for mut bytes in small_models() {
        assert!(read(&bytes).is_ok() && bytes.len() < 2000, "{} bytes", bytes.len());
        for i in 0..bytes.len() {
            let right = bytes[i];
            for wrong in (0..=255).filter(|b| *b != right) {
                bytes[i] = wrong;
                assert!(read(&bytes).is_err(), "byte {i} was {right:#04x}, is {wrong:#04x}, and the model is read");
            }
            bytes[i] = right;
        }
    }
}

#[test]
fn no_missing_end_is_missed() {
    for mut bytes in small_models() {
        for end in 0..bytes.len() {
            let error = read(&bytes[..end]).map(|_| ()).unwrap_err().to_string();
            assert!(error.starts_with("model: "), "{error}");
        }
        bytes.push(0);
        assert!(read(&bytes).is_err());
    }
}

/// A classifier on its own is a mixture of one.
#[test]
fn one_classifier_is_a_mixture() {
    let (encoding, problem) = encoded(&sample(Labels::Free(3), 5));
    let trained = Trainer::Supervised(Default::default()).train(&problem, &learners()[1], &Run::new(1)).unwrap();
    let one = trained.policy.classifiers()[0].clone();
    let bytes = |policy: Learned| Tagger::new(encoding.clone(), policy, About::default()).unwrap().to_bytes();
    assert!(bytes(Greedy(one).into()) == bytes(trained.policy));
}

/// Models of every version of the format that there has been are read, and say what they said when they were written.
#[test]
fn old_models_are_read() {
    let said = [
        ("1/dagger-online", ["D", "N", "N", "V"]),
        ("1/smile", ["D", "N", "V", "V"]),
        ("1/forward", ["D", "N", "V", "V"]),
        ("1/stacked", ["D", "N", "V", "V"]),
        ("1/early-update", ["D", "A", "N", "V"]),
        ("1/net", ["D", "D", "N", "N"]),
    ];
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/models");
    for (name, labels) in said {
        let tagger = Tagger::load(folder.join(name).with_added_extension("model")).expect("an old model");
        assert_eq!(tagger.label(&[["the"], ["old"], ["man"], ["sleeps"]]).expect("labels"), labels, "{name}");
    }
}
