//! Two readings of a sentence: the first from its end, the second from its start, seeing what the first said.

use super::{Encoding, Tagging, TaggingProblem};
use crate::error::{Error, Result};
use crate::roll::Performance;
use crate::seed::{Purpose, Seed};
use crate::space::{Imitation, Silent, Space};
use crate::tasks::{Done, Learned, Reason, Training};
use crate::trainer::{Keeping, Run, Trained};
use crate::worker::Ledger;

/// Parts of the data: each is read first by a policy that was trained on the others, so that the first reading's mistakes in training are
/// those that it will make later (Cohen & Carvalho 2005).
pub const FOLDS: usize = 2;

/// Trains a policy for each reading of `problem` by `train`: any trainer with any learner, told which problem and with what seed. Each of the four policies is
/// a stage of the checkpoint, if there is one.
///
/// # Errors
/// When there are fewer sentences than [`FOLDS`], and whatever `train` returns.
pub fn train(
    problem: &TaggingProblem,
    run: &Run<'_, Keeping>,
    train: &Training<'_, Encoding>,
) -> Result<Trained<Learned>> {
    let sentences = problem.space.part(|i| i < problem.episodes);
    let backwards = sentences.backwards();
    if backwards.sentences() < FOLDS {
        let expected = format!("at least {FOLDS} for a template that looks ahead");
        return Err(Error::argument("sentences", backwards.sentences(), expected));
    }
    let seed = |reading: usize| run.seed.child(Purpose::Reading, reading as u64);
    // What is learned after a policy that was stopped is not what would have been: it is not kept.
    let keep = |reading: usize, stopped: bool| {
        run.keep.as_ref().filter(|_| !stopped).map(|keep| keep.stage(&format!("reading-{reading}")))
    };
    let unseen = |reading, stopped| run.within(seed(reading), keep(reading, stopped));
    let (mut ledger, mut stopped) = (Ledger::default(), false);
    let mut said = vec![Vec::new(); backwards.sentences()];
    for fold in 0..FOLDS {
        let others = backwards.part(|i| i % FOLDS != fold).problem();
        let trained = train(&others, &unseen(2 + fold, stopped))?;
        stopped |= trained.stopped;
        if let Learned::Stacked(_) | Learned::Readings { .. } = trained.policy {
            let expected = "another algorithm: with a template that looks ahead there are two stages already";
            return Err(Error::argument("algorithm", "stacked", expected));
        }
        let part = backwards.part(|i| i % FOLDS == fold);
        let (done, bill) = perform(&trained.policy, part.clone(), 0, seed(2 + fold));
        let mut actions = done.actions.into_iter();
        for (place, i) in (fold..said.len()).step_by(FOLDS).enumerate() {
            said[i] = actions.by_ref().take(part.horizon(place).unwrap_or(0)).collect();
        }
        ledger += trained.ledger;
        ledger += bill;
    }
    let first = train(&backwards.problem(), &unseen(0, stopped))?;
    stopped |= first.stopped;
    let told = sentences.told(&said.concat());
    let last = Run { watch: run.watch, ..unseen(1, stopped) };
    let second = train(&told.problem(), &last)?;
    ledger += first.ledger;
    ledger += second.ledger;
    let policy = Learned::Readings { first: Box::new(first.policy), second: Box::new(second.policy) };
    Ok(Trained { policy, ledger, rounds: second.rounds, stopped: stopped || second.stopped })
}

/// The temperatures of the classifiers of `policy`: those of two readings each in its own, the second told by the first.
pub fn calibrate(policy: &Learned, problem: &TaggingProblem, episodes: &[usize], seed: Seed) -> Vec<f32> {
    let Learned::Readings { first, second } = policy else { return policy.calibrate(problem, episodes, seed) };
    let backwards = problem.space.backwards();
    let (said, _) = perform(first, backwards.clone(), 0, seed.child(Purpose::Reading, 0));
    let told = problem.space.told(&said.actions).problem();
    let first = first.calibrate(&backwards.problem(), episodes, seed);
    [first, second.calibrate(&told, episodes, seed)].concat()
}

/// How sure `policy` was of what [`perform`] says it does: of two readings the second.
pub fn sure(policy: &Learned, space: Tagging, done: Done<'_>) -> Vec<f32> {
    if let Learned::Readings { first, second } = policy {
        let (said, _) = perform(first, space.backwards(), done.number, done.seed.child(Purpose::Reading, 0));
        let temperatures = &done.temperatures[first.classifiers().len().min(done.temperatures.len())..];
        let done = Done { temperatures, seed: done.seed.child(Purpose::Reading, 1), ..done };
        return sure(second, space.told(&said.actions), done);
    }
    let episodes = space.sentences();
    policy.sure_from(&Imitation { space, expert: Silent, episodes }, done)
}

/// Why `policy` did what [`perform`] says it does: of two readings the second.
pub fn reasons(policy: &Learned, space: Tagging, done: Done<'_>) -> Option<Vec<Reason>> {
    if let Learned::Readings { first, second } = policy {
        let (said, _) = perform(first, space.backwards(), done.number, done.seed.child(Purpose::Reading, 0));
        return reasons(second, space.told(&said.actions), Done { seed: done.seed.child(Purpose::Reading, 1), ..done });
    }
    let episodes = space.sentences();
    policy.reasons_from(&Imitation { space, expert: Silent, episodes }, done)
}

/// What `policy` does with the sentences of `space`, the first of which has the number `number` in a longer text: in both readings where
/// it has two.
pub fn perform(policy: &Learned, space: Tagging, number: usize, seed: Seed) -> (Performance, Ledger) {
    if let Learned::Readings { first, second } = policy {
        let (said, bill) = perform(first, space.backwards(), number, seed.child(Purpose::Reading, 0));
        let (done, more) = perform(second, space.told(&said.actions), number, seed.child(Purpose::Reading, 1));
        return (done, bill + more);
    }
    let episodes = space.sentences();
    policy.perform_from(&Imitation { space, expert: Silent, episodes }, number, seed)
}
