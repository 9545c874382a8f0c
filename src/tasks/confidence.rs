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

use super::model::Learned;
use crate::learner::{Examples, Setting, calibrate};
use crate::policy::{Calibrated, Linear, LinearMemory};
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
                let step = |(t, classifier): (usize, &Linear)| {
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

    /// How sure it was of `actions`, which are what it did in all episodes of `problem` by [`Learned::perform_from`] with the same number and seed. The
    /// temperatures are those of its classifiers.
    pub fn sure_from<P: Problem>(
        &self,
        problem: &P,
        actions: &[Action],
        number: usize,
        sureness: Sureness<'_>,
    ) -> Vec<f32>
    where
        P::Space: Space<View = Features>,
    {
        let Sureness { temperatures, seed } = sureness;
        let calibrated: Vec<Calibrated<&Linear>> = (self.classifiers().into_iter().zip(temperatures))
            .map(|(classifier, temperature)| Calibrated { classifier, temperature: *temperature })
            .collect();
        let last = calibrated.len().saturating_sub(1);
        match self {
            Learned::Stacked(stages) => {
                let (stacked, _) = stages.stacked(problem, number, seed);
                replay(&stacked, actions, (number, seed), &calibrated, |_| [(1.0, last)])
            }
            Learned::Mixture(mixture) => {
                let members: Vec<(f64, usize)> =
                    mixture.members().iter().enumerate().map(|(i, (weight, _))| (*weight, i)).collect();
                replay(problem, actions, (number, seed), &calibrated, |_| members.iter().copied())
            }
            Learned::Ladder(_) => replay(problem, actions, (number, seed), &calibrated, |t| [(1.0, t.min(last))]),
            Learned::Beam(_) | Learned::Readings { .. } => {
                replay(problem, actions, (number, seed), &calibrated, |_| [(1.0, last)])
            }
        }
    }
}

/// What [`Learned::sure_from`] goes by.
#[derive(Clone, Copy, Debug)]
pub struct Sureness<'a> {
    /// The temperature of each classifier.
    pub temperatures: &'a [f32],
    /// The seed that the policy performed with.
    pub seed: Seed,
}

/// The temperature of one classifier.
fn temperature<P: Problem>(problem: &P, classifier: &Linear, examples: &Examples<Features>) -> f32
where
    P::Space: Space<View = Features>,
{
    calibrate(classifier, Setting::of(problem), examples).temperature
}

/// Goes the same ways again; at step t the probability of the action is the weighted mean of those of the `members`, which are among `calibrated`.
fn replay<P: Problem, I: IntoIterator<Item = (f64, usize)>>(
    problem: &P,
    actions: &[Action],
    (number, seed): (usize, Seed),
    calibrated: &[Calibrated<&Linear>],
    members: impl Fn(usize) -> I,
) -> Vec<f32>
where
    P::Space: Space<View = Features>,
{
    let (mut worker, mut sure) = (Worker::new(problem), Vec::with_capacity(actions.len()));
    let mut memories: Vec<LinearMemory> = calibrated.iter().map(|_| LinearMemory::default()).collect();
    let mut probabilities = Vec::new();
    let mut probability = |visit: &mut Visit<'_, P>, action: Action| {
        let (t, sight, mut mean) = (visit.t(), visit.sight(), 0.0);
        for (weight, i) in members(t) {
            calibrated[i].probabilities(&sight, &mut memories[i], &mut probabilities);
            let place = sight.legal.place(action);
            mean += weight * place.map_or(0.0, |place| f64::from(probabilities[place]));
        }
        mean.min(1.0) as f32
    };
    for index in 0..problem.episodes() {
        let seed = seed.child(Purpose::Episode, (number + index) as u64);
        worker.episode(Episode { index, seed }, |visit| {
            let action = *actions.get(sure.len())?;
            sure.push(probability(visit, action));
            Some(action)
        });
    }
    sure
}
