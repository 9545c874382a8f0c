//! The same seed gives the same bits at any number of threads, for every trainer with every learner.

use crate::common::{Labels, encoded, learners, sample, trainers};
use rayon::ThreadPoolBuilder;
use rollin::Seed;
use rollin::tasks::tagging::{Encoding, Tagger, TaggingProblem};
use rollin::tasks::{About, AnyLearner, Trainer};
use rollin::trainer::Run;
use rollin::worker::Ledger;

fn bytes(encoding: &Encoding, problem: &TaggingProblem, how: (&Trainer, &AnyLearner), seed: u64) -> (Vec<u8>, Ledger) {
    let trained = how.0.train(problem, how.1, &Run::new(seed)).expect("the settings are in range");
    let tagger = Tagger::new(encoding.clone(), trained.policy, About::default()).expect("few features");
    (tagger.to_bytes(), trained.ledger)
}

fn at<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(work)
}

#[test]
fn threads_change_nothing_and_seeds_do() {
    // More than two shards of episodes.
    let (encoding, problem) = encoded(&sample(Labels::Spans(2), 45));
    for trainer in trainers() {
        for learner in learners() {
            let how = (&trainer, &learner);
            let run = |threads, seed| at(threads, || bytes(&encoding, &problem, how, seed));
            let one = run(1, 1);
            assert!(one == run(2, 1) && one == run(5, 1), "{trainer:?} with {learner:?} depends on the threads");
            // Every learner shuffles its examples, so every trainer is random; online DAgger shuffles the episodes.
            assert!(one.0 != run(2, 2).0, "{trainer:?} with {learner:?} does not depend on the seed");
        }
    }
}

#[test]
fn runs_of_a_sampled_mixture_do_not_depend_on_threads() {
    let (_, problem) = encoded(&sample(Labels::Free(4), 60));
    for trainer in trainers() {
        let policy = trainer.train(&problem, &learners()[0], &Run::new(4)).expect("the settings are in range").policy;
        let run = |threads, seed| at(threads, || policy.perform_from(&problem, 0, Seed::new(seed)));
        let (one, bill) = run(1, 1);
        for threads in [2, 5] {
            let (other, other_bill) = run(threads, 1);
            assert!(one.actions == other.actions && one.costs == other.costs && bill == other_bill);
        }
        // Only a mixture draws.
        assert_eq!(one.actions != run(1, 2).0.actions, trainer.mixes(), "{trainer:?}");
    }
}
