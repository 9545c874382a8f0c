//! Nets among the learners of the program: in every trainer, in model files, at any number of threads.

use crate::common::{Labels, corpus, encoded, sample, trainers};
use rollin::Seed;
use rollin::learner::Net;
use rollin::policy::{Outputs, Reading};
use rollin::tasks::tagging::Tagger;
use rollin::tasks::{About, AnyLearner};
use rollin::tasks::{AnyClassifier, Trainer};
use rollin::trainer::Run;

fn net(units: usize, outputs: Outputs) -> AnyLearner {
    AnyLearner::Net(Net { units, outputs, passes: 2, ..Net::default() })
}

/// Whatever is trained with nets comes back from its file and does the same; mixtures of nets have no single net for their mean.
#[test]
fn files_keep_nets() {
    let sentences = sample(Labels::Spans(2), 12);
    let (encoding, problem) = encoded(&sentences);
    for (trainer, learner) in
        trainers().iter().zip([(3, Outputs::Actions), (0, Outputs::Actions), (3, Outputs::Bits)].into_iter().cycle())
    {
        let learner = net(learner.0, learner.1);
        let policy = trainer.train(&problem, &learner, &Run::new(1)).expect("trains").policy;
        if !matches!(trainer, Trainer::EarlyUpdate(_)) {
            assert!(policy.classifiers().iter().all(|c| matches!(c, AnyClassifier::Net(_))), "{trainer:?}");
        }
        let members = policy.classifiers().len();
        let policy = policy.read_as(Reading::Mean);
        assert_eq!(policy.classifiers().len(), members);
        let model = Tagger::new(encoding.clone(), policy, About::default()).expect("few features");
        let bytes = model.to_bytes();
        let again = Tagger::from_bytes(&bytes, "model".as_ref()).expect("it was written");
        assert!(again.to_bytes() == bytes, "{trainer:?}");
        let said = |model: &Tagger| model.tag(&corpus(&sentences), Seed::new(1)).expect("the columns are there");
        assert_eq!(said(&model), said(&again), "{trainer:?}");
        for end in [bytes.len() - 1, bytes.len() - 5] {
            assert!(Tagger::from_bytes(&bytes[..end], "model".as_ref()).is_err());
        }
    }
}

/// First weights are drawn by feature, and examples gathered in order.
#[test]
fn threads_do_not_matter() {
    let (encoding, problem) = encoded(&sample(Labels::Free(4), 20));
    for trainer in trainers().iter().filter(|trainer| trainer.mixes() || matches!(trainer, Trainer::DaggerOnline(_))) {
        let bytes = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let policy = pool
                .install(|| trainer.train(&problem, &net(4, Outputs::Actions), &Run::new(5)))
                .expect("trains")
                .policy;
            Tagger::new(encoding.clone(), policy, About::default()).expect("few features").to_bytes()
        });
        assert!(bytes[0] == bytes[1], "{trainer:?}");
    }
}
