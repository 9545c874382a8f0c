//! Checkpoints: untrusted input. The first two bytes choose a trainer and a learner; with the highest bit of the first the rest are a state, without it
//! they are edits of the one that a real training kept. Training goes on for a round from whatever is taken for a state.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::learner::Net;
use rollin::tasks::{AnyLearner, Trainer, sealed, tagging};
use rollin::trainer::{Checkpoint, Dagger, EarlyUpdate, Forward, Lols, Run, Searn, Smile, Stacking, Supervised};
use std::path::PathBuf;
use std::sync::OnceLock;

struct Bench {
    problem: tagging::TaggingProblem,
    trainers: Vec<Trainer>,
    learners: Vec<AnyLearner>,
    folder: PathBuf,
    /// What each trainer keeps with each learner.
    kept: Vec<OnceLock<Vec<u8>>>,
}

fn bench() -> &'static Bench {
    static BENCH: OnceLock<Bench> = OnceLock::new();
    BENCH.get_or_init(|| {
        let trainers = vec![
            Trainer::Supervised(Supervised::default()),
            Trainer::Forward(Forward::default()),
            Trainer::Smile(Smile { rounds: 3, ..Smile::default() }),
            Trainer::Searn(Searn { rounds: 3, ..Searn::default() }),
            Trainer::Dagger(Dagger { rounds: 3, ..Dagger::default() }),
            Trainer::DaggerOnline(Dagger { rounds: 3, ..Dagger::default() }),
            Trainer::LolsOnline(Lols { rounds: 3, ..Lols::default() }),
            Trainer::Stacked(Stacking::default()),
            Trainer::EarlyUpdate(EarlyUpdate { width: 2, rounds: 3 }),
        ];
        let learners = vec![
            AnyLearner::Perceptron(Default::default()),
            AnyLearner::Logistic(Default::default()),
            AnyLearner::Csoaa(Default::default()),
            AnyLearner::FilterTree(Default::default()),
            AnyLearner::Svm(Default::default()),
            AnyLearner::Net(Net { units: 2, passes: 1, ..Net::default() }),
        ];
        let kept = (0..trainers.len() * learners.len()).map(|_| OnceLock::new()).collect();
        let folder = std::env::temp_dir().join(format!("rollin-fuzz-{}", std::process::id()));
        Bench { problem: tagging::doc::problem().expect("a small problem"), trainers, learners, folder, kept }
    })
}

impl Bench {
    /// One round more.
    fn go_on(&self, trainer: usize, learner: usize) {
        let keep = Checkpoint::resume(&self.folder, &[("seed", "3")]).expect("nobody else uses it");
        let run = Run { stop: &|| true, ..Run::new(3).kept(Some(keep)) };
        let _ = self.trainers[trainer].train(&self.problem, &self.learners[learner], &run);
    }

    fn file(&self) -> PathBuf {
        self.folder.join("training.checkpoint")
    }

    /// The body of a real checkpoint.
    fn kept(&self, trainer: usize, learner: usize) -> &[u8] {
        self.kept[trainer * self.learners.len() + learner].get_or_init(|| {
            let _ = std::fs::remove_dir_all(&self.folder);
            self.go_on(trainer, learner);
            let bytes = std::fs::read(self.file()).unwrap_or_default();
            let ends: Vec<usize> = (0..bytes.len()).filter(|i| bytes[*i] == b'\n').take(2).collect();
            bytes[ends.last().map_or(0, |end| end + 1)..].to_vec()
        })
    }
}

fuzz_target!(|data: &[u8]| {
    let [first, second, rest @ ..] = data else { return };
    let bench = bench();
    let (trainer, learner) = (usize::from(first & 127) % bench.trainers.len(), usize::from(*second) % bench.learners.len());
    let body = match first & 128 {
        0 => {
            let mut body = bench.kept(trainer, learner).to_vec();
            for edit in rest.chunks_exact(4) {
                let at = usize::from(u16::from_le_bytes([edit[0], edit[1]])) % (body.len() + 1);
                match edit[2] % 3 {
                    0 if at < body.len() => body[at] = edit[3],
                    1 => body.insert(at, edit[3]),
                    _ => body.truncate(body.len().max(1) - 1),
                }
            }
            body
        }
        _ => [b"{\"seed\":\"3\"}\n", rest].concat(),
    };
    // The head of a model file has the same length and checksum.
    let file = sealed(body);
    let head = file.iter().position(|byte| *byte == b'\n').expect("two lines of head");
    std::fs::create_dir_all(&bench.folder).expect("a folder");
    std::fs::write(bench.file(), [b"rollin checkpoint 1", &file[head..]].concat()).expect("a file");
    bench.go_on(trainer, learner);
});
