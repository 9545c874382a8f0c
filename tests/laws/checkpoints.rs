//! Training that was stopped after any round, or killed at any time, goes on to the bits of training that was not.

use crate::common::{Labels, encoded, learners, sample, trainers};
use rollin::Result;
use rollin::learner::Net;
use rollin::read::template::Template;
use rollin::tasks::tagging::{Encoding, Tagger, TaggingProblem};
use rollin::tasks::{About, AnyLearner, Trainer};
use rollin::tasks::{Learned, Task};
use rollin::trainer::{Checkpoint, Keeping, Progress, Reuse, Run, Smile, Trained};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Every trainer, and every way of reusing trajectories.
fn all_trainers() -> Vec<Trainer> {
    let reuses = [Reuse::Printed42, Reuse::Printed43, Reuse::Coins, Reuse::Sites, Reuse::Ageing];
    let smile = |reuse| Trainer::Smile(Smile { alpha: 0.3, rounds: 4, reuse, warm: true, piece: None });
    let pieces = Smile { alpha: 0.3, rounds: 4, reuse: Reuse::Ageing, piece: Some(2), ..Smile::default() };
    trainers().into_iter().chain(reuses.map(smile)).chain([Trainer::Smile(pieces)]).collect()
}

/// Every learner. The net's batches end in the middle of a round.
fn all_learners() -> Vec<AnyLearner> {
    let net = Net { units: 3, passes: 2, batch: 7, ..Net::default() };
    learners().into_iter().chain([AnyLearner::Net(net)]).collect()
}

/// What must be the same: the model file, the bill, and how each round went but for the time it took.
fn told(encoding: &Encoding, trained: Trained<Learned>) -> (Vec<u8>, String) {
    let rounds: Vec<Progress> = trained.rounds.iter().map(|round| Progress { seconds: 0.0, ..*round }).collect();
    let tagger = Tagger::new(encoding.clone(), trained.policy, About::default()).expect("few features");
    (tagger.to_bytes(), format!("{:?} {rounds:?}", trained.ledger))
}

const OF: [(&str, &str); 1] = [("seed", "3")];

/// Trains, one round a run; returns what the last run brought, and how many there were.
fn in_pieces(
    folder: &Path,
    train: &dyn Fn(&Run<'_, Keeping>) -> Result<Trained<Learned>>,
) -> (Trained<Learned>, usize) {
    for runs in 1.. {
        let keep = Checkpoint::resume(folder, &OF).expect("nobody else uses it");
        let told = AtomicUsize::new(0);
        let watch = |progress: &Progress| told.store(progress.round, Ordering::Relaxed);
        let stop = || runs <= told.load(Ordering::Relaxed);
        let run = Run { watch: &watch, stop: &stop, ..Run::new(3).kept(Some(keep)) };
        let trained = train(&run).expect("it goes on");
        if !trained.stopped {
            return (trained, runs);
        }
    }
    unreachable!("training ends")
}

#[test]
fn every_trainer_goes_on_with_every_learner() {
    let (encoding, problem) = encoded(&sample(Labels::Spans(2), 12));
    for trainer in all_trainers() {
        for learner in all_learners() {
            let plain = trainer.train(&problem, &learner, &Run::new(3)).expect("the settings are in range");
            let rounds = plain.rounds.len();
            let folder = tempfile::tempdir().expect("a folder");
            let (pieced, runs) = in_pieces(folder.path(), &|run| trainer.train(&problem, &learner, run));
            // The second stage of two is not a round that can be done without.
            assert_eq!(runs, if matches!(trainer, Trainer::Stacked(_)) { 1 } else { rounds }, "{trainer:?}");
            assert!(told(&encoding, plain) == told(&encoding, pieced), "{trainer:?} with {learner:?}");
        }
    }
}

/// Two readings are four policies, each a stage; training may end in any of them.
#[test]
fn two_readings_go_on() {
    let sentences = crate::common::corpus(&sample(Labels::Free(3), 10));
    let template = Template::parse("U1:%x[0,0]\nU2:%y[-1]\nU3:%y[1]\n", Path::new("template")).expect("a template");
    let (encoding, space) = Encoding::learn(&sentences, template.into()).expect("features");
    let (problem, learner) = (space.problem(), &learners()[1]);
    for trainer in trainers().into_iter().filter(|trainer| !matches!(trainer, Trainer::Stacked(_))) {
        let train = |run: &Run<'_, Keeping>| {
            Encoding::train(&problem, run, &|problem: &TaggingProblem, run: &Run<'_, Keeping>| {
                trainer.train(problem, learner, run)
            })
        };
        let plain = train(&Run::new(3).kept(None)).expect("a policy");
        // Stopped after a round of each stage.
        let folder = tempfile::tempdir().expect("a folder");
        for asked in [0, 1, 4, 6] {
            let (count, keep) = (AtomicUsize::new(0), Checkpoint::resume(folder.path(), &OF).expect("a checkpoint"));
            let stop = || count.fetch_add(1, Ordering::Relaxed) >= asked;
            let run = Run { stop: &stop, ..Run::new(3).kept(Some(keep)) };
            train(&run).expect("what there is");
        }
        let keep = Checkpoint::resume(folder.path(), &OF).expect("a checkpoint");
        let resumed = train(&Run::new(3).kept(Some(keep))).expect("a policy");
        assert!(told(&encoding, plain) == told(&encoding, resumed), "{trainer:?}");
    }
}

/// One that stood there is gone on from or refused, never panicked at: every byte changed, with the checksum made right again, and every length.
#[test]
fn damage_is_an_error() {
    let (_, problem) = encoded(&sample(Labels::Spans(1), 3));
    let smile = Smile { rounds: 2, reuse: Reuse::Ageing, ..Smile::default() };
    let dagger = rollin::trainer::Dagger { rounds: 2, ..Default::default() };
    let net = AnyLearner::Net(Net { units: 2, passes: 1, ..Net::default() });
    let cases = [
        (Trainer::Smile(smile), AnyLearner::Logistic(Default::default())),
        (Trainer::DaggerOnline(dagger.clone()), AnyLearner::Logistic(Default::default())),
        (Trainer::DaggerOnline(dagger.clone()), AnyLearner::Svm(Default::default())),
        (Trainer::DaggerOnline(dagger.clone()), net.clone()),
        (Trainer::Dagger(dagger), net.clone()),
        (Trainer::EarlyUpdate(rollin::trainer::EarlyUpdate { rounds: 2, width: 2 }), net.clone()),
        (Trainer::Stacked(Default::default()), AnyLearner::Perceptron(Default::default())),
    ];
    for (trainer, learner) in cases {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("training.checkpoint");
        let run = || -> Result<Trained<Learned>> {
            let keep = Checkpoint::resume(folder.path(), &OF)?;
            let first = |rounds: &AtomicUsize| rounds.fetch_add(1, Ordering::Relaxed) >= 1;
            let asked = AtomicUsize::new(0);
            trainer.train(&problem, &learner, &Run { stop: &|| first(&asked), ..Run::new(3).kept(Some(keep)) })
        };
        run().expect("it trains");
        let whole = std::fs::read(&path).expect("a checkpoint");
        let body = whole.iter().enumerate().filter(|(_, byte)| **byte == b'\n').nth(1).expect("two lines").0 + 1;
        let refused = |bytes: &[u8]| {
            std::fs::write(&path, bytes).expect("a file");
            let error = run().expect_err("it is damaged").to_string();
            assert!(error.contains("training.checkpoint") && error.contains("damaged"), "{error}");
        };
        for end in (body..whole.len()).step_by(whole.len() / 40 + 1) {
            refused(&whole[..end]);
        }
        let mut flipped = whole.clone();
        flipped[body + (whole.len() - body) / 2] ^= 1;
        refused(&flipped);
        // Forged: the checksum is right and the state is not. Whatever it says, nothing panics.
        let step = (whole.len() - body) / 150 + 1;
        for place in (body..whole.len()).step_by(step) {
            for value in [0, 1, 0x7f, 0xff] {
                let mut forged = whole[body..].to_vec();
                forged[place - body] = value;
                let head = format!(
                    "rollin checkpoint 1\n{} bytes, checksum {:016x}\n",
                    forged.len(),
                    rapidhash::v3::rapidhash_v3(&forged)
                );
                std::fs::write(&path, [head.into_bytes(), forged].concat()).expect("a file");
                let _ = run();
            }
        }
    }
}

#[test]
fn folders_are_for_one_run_and_one_training() {
    let (_, problem) = encoded(&sample(Labels::Spans(1), 3));
    let folder = tempfile::tempdir().expect("a folder");
    let checkpoint = Checkpoint::begin(folder.path(), &[("--seed", "1"), ("--alpha", "0.1")]).expect("a checkpoint");
    let second = Checkpoint::resume(folder.path(), &[]).expect_err("it is in use").to_string();
    assert!(second.ends_with("another run is using this folder; wait for it, or name another"), "{second}");
    let train =
        |keep| Smile::default().train(&problem, &rollin::learner::Perceptron::default(), &Run::new(1).kept(keep));
    train(checkpoint).expect("it trains");
    let begun = Checkpoint::begin(folder.path(), &[]).expect_err("there is one").to_string();
    assert!(begun.contains("lies there already; go on from it with --resume"), "{begun}");
    let other = Checkpoint::resume(folder.path(), &[("--seed", "2"), ("--beta", "1")]).expect("nobody uses it");
    let error = train(other).expect_err("another training").to_string();
    let problem = "--alpha was 0.1 and is not given, --beta was not given and is 1, --seed was 1 and is 2";
    assert!(error.contains(problem), "{error}");
}
