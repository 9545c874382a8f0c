//! How sure a policy is of what it does: calibrated probabilities of its actions.
//!
//! A classifier's scores become probabilities by its temperature ([`crate::learner::calibrate`]), which is found on episodes that nobody learned from, in the
//! states that the policy itself reaches there. What is given is the probability of the action that was taken:
//!
//! - for one classifier, also one that is searched with or comes second, its own at the state where the action was taken;
//! - for one classifier per step, that of the step's;
//! - for a mixture, however it is read, the chance that a member that is drawn by its weight, and then an action that is drawn by the member's probabilities,
//!   would be this one: the mean of the members' probabilities, each by a temperature of its own. A mixture whose members disagree is
//!   less sure than each of them.

use super::AnyClassifier;
use super::model::Learned;
use crate::learner::{Examples, Setting, calibrate};
use crate::policy::{Calibrated, NeuralMemory};
use crate::roll;
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Episode, Features, Problem, Space, StateOf};
use crate::worker::{Visit, Worker};

impl Learned {
    /// The temperatures of its classifiers, found on these episodes of `problem`, which it did not learn from. Of two readings only the second's are
    /// found this way, untold: [`super::Task::calibrate`] does it all.
    pub fn calibrate<P: Problem>(&self, problem: &P, episodes: &[usize], seed: Seed) -> Vec<f32>
    where
        P::Space: Space<View = Features>,
        StateOf<P>: Clone,
    {
        match self {
            Learned::Ladder(ladder) => {
                let step = |(t, classifier): (usize, &AnyClassifier)| {
                    let (examples, _) = roll::labels_at(problem, self, t, episodes, seed);
                    temperature(problem, classifier, &examples)
                };
                ladder.steps().iter().enumerate().map(step).collect()
            }
            Learned::Stacked(stages) => {
                let first = roll::labels(problem, &stages.first, episodes, seed).0.examples;
                let (stacked, _) = stages.stacked(problem, 0, seed);
                let second = roll::labels(&stacked, &stages.second, episodes, seed).0.examples;
                vec![temperature(problem, &stages.first.0, &first), temperature(&stacked, &stages.second.0, &second)]
            }
            _ => {
                let examples = roll::labels(problem, self, episodes, seed).0.examples;
                self.classifiers().iter().map(|classifier| temperature(problem, classifier, &examples)).collect()
            }
        }
    }

    /// How sure it was of what it did in all episodes of `problem` by [`Learned::perform_from`]: the probability of each action.
    pub fn sure_from<P: Problem>(&self, problem: &P, done: Done<'_>) -> Vec<f32>
    where
        P::Space: Space<View = Features>,
    {
        let calibrated: Vec<Calibrated<&AnyClassifier>> = (self.classifiers().into_iter().zip(done.temperatures))
            .map(|(classifier, temperature)| Calibrated { classifier, temperature: *temperature })
            .collect();
        let last = calibrated.len().saturating_sub(1);
        match self {
            Learned::Stacked(stages) => {
                let (stacked, _) = stages.stacked(problem, done.number, done.seed);
                replay(&stacked, done, &calibrated, |_| [(1.0, last)])
            }
            Learned::Mixture(mixture) => {
                let members: Vec<(f64, usize)> =
                    mixture.members().iter().enumerate().map(|(i, (weight, _))| (*weight, i)).collect();
                replay(problem, done, &calibrated, |_| members.iter().copied())
            }
            Learned::Ladder(_) => replay(problem, done, &calibrated, |t| [(1.0, t.min(last))]),
            Learned::Beam(_) | Learned::Readings { .. } => replay(problem, done, &calibrated, |_| [(1.0, last)]),
        }
    }
}

/// What a policy did, and what it takes to tell how sure it was.
#[derive(Clone, Copy, Debug)]
pub struct Done<'a> {
    /// What it did, episode after episode.
    pub actions: &'a [Action],
    /// The number of the first episode in the series that it performed.
    pub number: usize,
    /// The seed that it performed with.
    pub seed: Seed,
    /// The temperature of each of its classifiers.
    pub temperatures: &'a [f32],
}

/// The temperature of one classifier.
fn temperature<P: Problem>(problem: &P, classifier: &AnyClassifier, examples: &Examples<Features>) -> f32
where
    P::Space: Space<View = Features>,
{
    calibrate(classifier, Setting::of(problem), examples).temperature
}

/// At step t of the same ways the probability of the action is the weighted mean of those of the `members`, which are among `calibrated`.
fn replay<P: Problem, I: IntoIterator<Item = (f64, usize)>>(
    problem: &P,
    done: Done<'_>,
    calibrated: &[Calibrated<&AnyClassifier>],
    members: impl Fn(usize) -> I,
) -> Vec<f32>
where
    P::Space: Space<View = Features>,
{
    let mut sure = Vec::with_capacity(done.actions.len());
    let mut memories: Vec<NeuralMemory> = calibrated.iter().map(|_| NeuralMemory::default()).collect();
    let mut probabilities = Vec::new();
    let mut probability = |visit: &mut Visit<'_, P>, action: Action| {
        let (t, sight, mut mean) = (visit.t(), visit.sight(), 0.0);
        for (weight, i) in members(t) {
            let (Some(classifier), Some(memory)) = (calibrated.get(i), memories.get_mut(i)) else { continue };
            classifier.probabilities(&sight, memory, &mut probabilities);
            let place = sight.legal.place(action);
            mean += weight * place.map_or(0.0, |place| f64::from(probabilities[place]));
        }
        mean.min(1.0) as f32
    };
    retrace(problem, done, |visit, action| sure.push(probability(visit, action)));
    sure
}

/// Goes the same ways again: `see` is shown each state and the action that was taken there.
pub(super) fn retrace<P: Problem>(problem: &P, done: Done<'_>, mut see: impl FnMut(&mut Visit<'_, P>, Action)) {
    let mut worker = Worker::new(problem);
    let mut actions = done.actions.iter();
    for index in 0..problem.episodes() {
        let seed = done.seed.child(Purpose::Episode, (done.number + index) as u64);
        worker.episode(Episode { index, seed }, |visit| {
            let action = *actions.next()?;
            see(visit, action);
            Some(action)
        });
    }
}
