//! The structured perceptron with early update (Collins & Roark 2004): the classic that the others are measured against.

use super::{Book, Keeper, Run, Shuffled, Trained, check_rounds};
use crate::error::{Error, Result};
use crate::learner::{Examples, Kept, MOST_COUNTED, Setting, Target};
use crate::output::Arrays;
use crate::policy::{Classifier, Columns, Linear, LinearMemory, Weights};
use crate::roll::Performance;
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Episode, FeatureTable, Features, Gather, Listed, Problem, Space, StateOf, ViewOf};
use crate::worker::{Ledger, Visit, Worker, all, sweep};
use serde::{Deserialize, Serialize};

/// The structured perceptron with beam search and early update: paths are scored as wholes, the sum of their steps' linear scores, and as soon
/// as the expert's path falls out of the beam the search stops and the weights move from the best path so far towards the expert's. Weights
/// are averaged over the episodes seen.
///
/// The expert drives once through every episode; nothing it might say of the learner's own states is used. Searching puts the
/// system back to every path in turn: states must be `Clone`.
///
/// ```
/// use rollin::tasks::tagging;
/// use rollin::trainer::{EarlyUpdate, Run};
///
/// let problem = tagging::doc::problem()?;
/// let trained = EarlyUpdate { width: 4, rounds: 20 }.train(&problem, &Run::new(1))?;
/// assert_eq!(trained.ledger.labels, 15);
/// let (done, _) = trained.policy.perform(&problem, rollin::Seed::new(1));
/// assert_eq!(done.costs.iter().sum::<f64>(), 0.0);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EarlyUpdate {
    /// Paths in the beam, while training and after.
    pub width: usize,
    /// Rounds over the episodes.
    pub rounds: usize,
}

impl Default for EarlyUpdate {
    fn default() -> Self {
        EarlyUpdate { width: 4, rounds: 5 }
    }
}

/// The widest beam.
pub(crate) const MOST_WIDTH: usize = 1024;

/// A classifier that is searched with: of the paths in a beam that has the highest sum of scores is taken. It looks ahead, so it is no
/// [`Policy`](crate::policy::Policy), which acts where it stands.
#[derive(Clone, Debug)]
pub struct Beam<C> {
    /// What scores the steps.
    pub classifier: C,
    /// Paths in the beam; 1 is greedy.
    pub width: usize,
}

impl<C> Beam<C> {
    /// The best paths through the problem's episodes.
    pub fn perform<P: Problem>(&self, problem: &P, seed: Seed) -> (Performance, Ledger)
    where
        C: Classifier<ViewOf<P>>,
        StateOf<P>: Clone,
    {
        self.perform_from(problem, 0, seed)
    }

    /// The same for a part of a longer series, as [`roll::perform_from`](crate::roll::perform_from).
    pub fn perform_from<P: Problem>(&self, problem: &P, first: usize, seed: Seed) -> (Performance, Ledger)
    where
        C: Classifier<ViewOf<P>>,
        StateOf<P>: Clone,
    {
        sweep(problem, &all(problem), seed, |worker, memory: &mut C::Memory, episode, done: &mut Performance| {
            let seed = seed.child(Purpose::Episode, (first + episode.index) as u64);
            let score =
                |visit: &mut Visit<'_, P>, scores: &mut Vec<f32>| score(&self.classifier, visit, memory, scores);
            let best = worker.beam(Episode { seed, ..episode }, self.width, score, |_| true).swap_remove(0);
            done.actions.extend(best.actions);
            done.costs.push(best.cost);
        })
    }
}

/// The scores of the legal actions at `visit`, in order.
fn score<P: Problem, C: Classifier<ViewOf<P>>>(
    classifier: &C,
    visit: &mut Visit<'_, P>,
    memory: &mut C::Memory,
    scores: &mut Vec<f32>,
) {
    let sight = visit.sight();
    let all = classifier.scores(&sight, memory);
    scores.extend(sight.legal.iter().map(|action| all[action.index()]));
}

/// The expert's paths: what is seen on them, and what is done there. `None` for a path on which the expert was silent.
#[derive(Default)]
struct Reference {
    views: Examples<Features>,
    paths: Vec<(usize, Option<Vec<Action>>)>,
}

impl Gather for Reference {
    fn absorb(&mut self, later: Self) {
        let shift = self.views.len();
        self.views.absorb(later.views);
        self.paths.extend(later.paths.into_iter().map(|(start, path)| (start + shift, path)));
    }
}

impl EarlyUpdate {
    /// Trains on `problem`. It learns by itself: there is no learner to choose.
    ///
    /// # Errors
    /// When the beam's width is not from 1 to 1024, there are no rounds or the problem has no episodes.
    pub fn train<P: Problem>(
        &self,
        problem: &P,
        run: &Run<'_, impl Keeper<Features, Averaged>>,
    ) -> Result<Trained<Beam<Linear>>>
    where
        P::Space: Space<View = Features>,
        StateOf<P>: Clone,
    {
        check_rounds(self.rounds)?;
        if !(1..=MOST_WIDTH).contains(&self.width) {
            return Err(Error::argument("width", self.width, format!("from 1 to {MOST_WIDTH}")));
        }
        let mut book = Book::open(problem, run)?;
        let start = run.seed.child(Purpose::Round, 0);
        let (reference, bill) = expert_paths(problem, start);
        let mut learned = book.resume(Averaged::new(problem.space()))?;
        if book.done() == 0 {
            book.bill(((), bill));
        }
        let mut episodes = Shuffled::after(book.done(), problem, run.seed);
        while book.next(self.rounds).is_some() {
            let mut worker = Worker::new(problem);
            let mut course = Course { table: problem.space().shared(), reference: &reference, learned: &mut learned };
            for index in episodes.next() {
                // The episode of the expert's path: under the same randomness.
                let episode = Episode { index, seed: start.child(Purpose::Episode, index as u64) };
                course.learn(&mut worker, episode, self.width);
            }
            book.bill(((), worker.ledger()));
            book.round(self.rounds, f64::NAN, &learned)?;
        }
        Ok(book.close(Beam { classifier: learned.finish(), width: self.width }))
    }
}

/// Lets the expert drive through all episodes.
fn expert_paths<P: Problem>(problem: &P, seed: Seed) -> (Reference, Ledger)
where
    P::Space: Space<View = Features>,
{
    sweep(problem, &all(problem), seed, |worker, (): &mut (), episode, reference: &mut Reference| {
        let (views, mut path) = (&mut reference.views, Some(Vec::new()));
        let first = views.len();
        worker.episode(episode, |visit| {
            let label = visit.label();
            path = label.and_then(|label| {
                visit.record(|sight| views.push(sight.view, sight.legal, Target::Label(label)));
                path.take().map(|path| [path, vec![label]].concat())
            });
            Some(visit.expert())
        });
        reference.paths.push((first, path));
    })
}

/// Weights, and what their average will be made of: what [`EarlyUpdate`] knows after a round.
#[derive(Clone, Debug)]
pub struct Averaged {
    linear: Linear,
    /// The sums of the weights' changes times when they came.
    changes: Weights,
    seen: usize,
}

impl Averaged {
    fn new<S: Space<View = Features>>(space: &S) -> Self {
        let actions = space.actions();
        let weights = Weights::new(space.shared().features(), actions);
        let changes = weights.clone();
        Averaged { linear: Linear { actions, columns: Columns::Actions, weights }, changes, seen: 0 }
    }

    /// The weights' average over the episodes seen.
    fn finish(self) -> Linear {
        let (changes, seen) = (self.changes, self.seen.max(1) as f32);
        // Both have their rows in the same order: they were always changed together.
        let weights = self.linear.weights.map_rows(|place, row| {
            row.iter_mut().zip(changes.at(place)).for_each(|(w, changes)| *w -= *changes / seen);
        });
        Linear { weights, ..self.linear }
    }
}

impl Kept<Features> for Averaged {
    fn put(&self, to: &mut Vec<u8>) {
        let changes = Linear { weights: self.changes.clone(), ..self.linear };
        self.linear.put(to);
        changes.put(to);
        Kept::<Features>::put(&self.seen, to);
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, Features>) -> Option<Self> {
        let (linear, (changes, seen)) = <(Linear, (Linear, usize))>::take(from, setting)?;
        let changes = changes.weights;
        let same = |feature: u32| linear.weights.place(feature) == changes.place(feature);
        let counted = seen as u64 <= MOST_COUNTED;
        let possible = counted && linear.columns == Columns::Actions && (0..changes.features() as u32).all(same);
        (possible && changes.columns() == linear.weights.columns()).then_some(Averaged { linear, changes, seen })
    }
}

/// Learning in progress.
struct Course<'p> {
    table: &'p FeatureTable,
    reference: &'p Reference,
    learned: &'p mut Averaged,
}

impl Course<'_> {
    /// Searches until the right path has fallen out of the beam, or to the end; then, where the best path is not the right one, moves the
    /// weights from the one to the other, from where they part.
    fn learn<P: Problem>(&mut self, worker: &mut Worker<'_, P>, episode: Episode, width: usize)
    where
        P::Space: Space<View = Features>,
        StateOf<P>: Clone,
    {
        let Course { table, reference, learned: Averaged { linear, changes, seen } } = self;
        let (first, Some(right)) = &reference.paths[episode.index] else { return };
        let mut memory = LinearMemory::default();
        let paths = worker.beam(
            episode,
            width,
            |visit, scores| score(linear, visit, &mut memory, scores),
            |paths| paths.iter().any(|path| right.starts_with(&path.actions)),
        );
        let best = &paths[0].actions;
        if best != right.get(..best.len()).unwrap_or_default() {
            let parts = best.iter().zip(right).take_while(|(a, b)| a == b).count();
            let mut change = |listed: Listed<'_>, action: Action, by: f32| {
                for feature in listed.iter() {
                    linear.weights.row_mut(feature)[action.index()] += by;
                    changes.row_mut(feature)[action.index()] += *seen as f32 * by;
                }
            };
            let reached = paths.iter().map(|path| path.actions.len()).max().unwrap_or(0);
            for (t, action) in right.iter().enumerate().take(reached).skip(parts) {
                change(reference.views.views().listed(first + t, table), *action, 1.0);
            }
            worker.episode(episode, |visit| {
                let action = *best.get(visit.t())?;
                if visit.t() >= parts {
                    change(visit.sight().listed(), action, -1.0);
                }
                Some(action)
            });
        }
        *seen += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tasks::tagging::doc;

    /// The expert's paths are the sentences; and once the search finds the right path of one, its weights stay as they are.
    #[test]
    fn what_is_right_moves_nothing() {
        let problem = doc::problem().expect("a corpus");
        let reference = expert_paths(&problem, Seed::new(1)).0;
        let lengths: Vec<usize> = reference.paths.iter().map(|(_, path)| path.as_ref().map_or(0, Vec::len)).collect();
        assert_eq!((reference.views.len(), lengths), (15, vec![4, 5, 3, 3]));
        let mut learned = Averaged::new(problem.space());
        let mut course = Course { table: problem.space().shared(), reference: &reference, learned: &mut learned };
        let mut worker = Worker::new(&problem);
        let episode = Episode { index: 0, seed: Seed::new(1) };
        for _ in 0..20 {
            course.learn(&mut worker, episode, 2);
        }
        let before = course.learned.linear.clone();
        course.learn(&mut worker, episode, 2);
        assert!(!before.weights.is_empty() && course.learned.linear == before);
    }
}
