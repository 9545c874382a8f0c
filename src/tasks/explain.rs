//! Why a policy did what it did: the part of each feature in a score that is a sum.

use super::confidence::{Done, retrace};
use super::model::Learned;
use super::{AnyClassifier, Data, Model, Task};
use crate::error::Result;
use crate::policy::{Classifier, Columns, Linear, LinearMemory};
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Features, Problem, Sight, Space};

/// What one feature says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Its number.
    pub feature: u32,
    /// Its weight for the action that was taken.
    pub chosen: f32,
    /// That for the other one; 0 where there is none.
    pub other: f32,
}

/// Why an action was taken.
///
/// ```
/// use rollin::learner::Logistic;
/// use rollin::tasks::Model;
/// use rollin::tasks::tagging::{Encoding, Settings, doc};
/// use rollin::trainer::{Dagger, Run};
///
/// let corpus = doc::corpus()?;
/// let (encoding, space) = Encoding::learn(&corpus, Settings::default())?;
/// let trained = Dagger::default().train(&space.problem(), &Logistic::default(), &Run::new(1))?;
/// let model = Model::new(encoding, trained.policy, Default::default())?;
/// let seed = rollin::Seed::new(1);
/// let actions = model.perform(model.encoding.apply(&corpus)?, corpus.sentences(), 0, seed);
/// let reasons = model.reasons(&corpus, &actions, 0, seed)?.expect("one linear classifier");
/// let sum = reasons[0].shares.iter().fold(0.0, |sum, share| sum + share.chosen);
/// assert_eq!(sum, reasons[0].scores[0]);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Reason {
    /// The action that was taken.
    pub chosen: Action,
    /// The best of the other legal actions by its score, the lowest of equals; none where none was legal.
    pub other: Option<Action>,
    /// The scores of both. Each is the sum of the weights in `shares`, added up from 0 in their order: the same bits.
    pub scores: [f32; 2],
    /// What the features at hand say, the static ones first, each in the order in which scores add them.
    pub shares: Vec<Share>,
}

impl Reason {
    fn of(linear: &Linear, memory: &mut LinearMemory, sight: &Sight<'_, Features>, chosen: Action) -> Self {
        let scores = linear.scores(sight, memory);
        let others = sight.legal.iter().filter(|action| *action != chosen);
        let better =
            |best: Action, action: Action| if scores[action.index()] > scores[best.index()] { action } else { best };
        let other = others.reduce(better);
        let score = |action: Action| scores[action.index()];
        let weight = |feature: u32, action: Action| linear.weights.row(feature).map_or(0.0, |row| row[action.index()]);
        let share = |feature: u32| Share {
            feature,
            chosen: weight(feature, chosen),
            other: other.map_or(0.0, |other| weight(feature, other)),
        };
        Reason {
            chosen,
            other,
            scores: [score(chosen), other.map_or(0.0, score)],
            shares: sight.listed().iter().map(share).collect(),
        }
    }
}

/// The linear classifier whose columns are scores of actions, if it is one.
fn sum(classifier: &AnyClassifier) -> Option<&Linear> {
    match classifier {
        AnyClassifier::Linear(linear) if linear.columns == Columns::Actions => Some(linear),
        _ => None,
    }
}

impl Learned {
    /// The linear classifiers whose scores decide, one for each step, the last for all that follow: none where what decides is no sum of weights, as with nets, votes
    /// and mixtures that are drawn from. A mixture that is read by its mean is one classifier ([`Learned::read_as`]), so that its sums are exact. Of two
    /// stages or readings the second decides.
    pub fn sums(&self) -> Option<Vec<&Linear>> {
        match self {
            Learned::Mixture(mixture) => match mixture.members() {
                [(_, one)] => Some(vec![sum(one)?]),
                _ => None,
            },
            Learned::Ladder(ladder) => ladder.steps().iter().map(sum).collect(),
            Learned::Beam(beam) => Some(vec![sum(&beam.classifier)?]),
            Learned::Stacked(stages) => Some(vec![sum(&stages.second.0)?]),
            Learned::Readings { second, .. } => second.sums(),
        }
    }

    /// Why it did what it did in all episodes of `problem` by [`Learned::perform_from`]; `None` where that is no sum of weights ([`Learned::sums`]).
    pub fn reasons_from<P: Problem>(&self, problem: &P, done: Done<'_>) -> Option<Vec<Reason>>
    where
        P::Space: Space<View = Features>,
    {
        let steps = self.sums()?;
        match self {
            Learned::Stacked(stages) => {
                let (stacked, _) = stages.stacked(problem, done.number, done.seed);
                reasons(&stacked, done, &steps)
            }
            _ => reasons(problem, done, &steps),
        }
    }
}

/// The same for classifiers that score step by step.
fn reasons<P: Problem>(problem: &P, done: Done<'_>, steps: &[&Linear]) -> Option<Vec<Reason>>
where
    P::Space: Space<View = Features>,
{
    let last = steps.len().checked_sub(1)?;
    let mut memories: Vec<LinearMemory> = steps.iter().map(|_| LinearMemory::default()).collect();
    let mut found = Vec::with_capacity(done.actions.len());
    retrace(problem, done, |visit, action| {
        let step = visit.t().min(last);
        found.push(Reason::of(steps[step], &mut memories[step], &visit.sight(), action));
    });
    Some(found)
}

/// What tells a feature's name by its number, where it is known.
pub type Names<'a> = Box<dyn Fn(u32) -> Option<String> + 'a>;

impl<T: Task> Model<T> {
    /// Why it did `actions`, which is what [`Model::perform`] says it does in all `data`, a part of a longer text that starts with its sentence number
    /// `first`. `None` where what it does is no sum of weights ([`Learned::sums`]).
    ///
    /// # Errors
    /// As [`Task::apply`].
    pub fn reasons(&self, data: &T::Data, actions: &[Action], first: usize, seed: Seed) -> Result<Option<Vec<Reason>>> {
        let done = Done { actions, number: first, seed: seed.child(Purpose::Evaluation, 0), temperatures: &[] };
        Ok(T::reasons(&self.policy, self.encoding.apply(data)?, data.sentences(), done))
    }

    /// The names of the features that occur in `data`, and of those by which a second stage sees what the first said: `said[-1]=B-NP`.
    ///
    /// # Errors
    /// As [`Task::apply`].
    pub fn names(&self, data: &T::Data) -> Result<Names<'_>> {
        let own = self.encoding.names(data)?;
        let (first, width) = (self.encoding.features(), self.encoding.actions() + 1);
        let window = if let Learned::Stacked(stages) = &self.policy { stages.window } else { 0 };
        Ok(Box::new(move |number| match (number as usize).checked_sub(first) {
            None => own(number),
            Some(beyond) => {
                let (place, action) = (beyond / width, beyond % width);
                let said =
                    if action + 1 == width { "_".to_owned() } else { self.encoding.label(Action(action as u32)) };
                Some(format!("said[{}]={said}", place as i64 - window as i64))
            }
        }))
    }
}
