//! Training by name: any trainer with any learner, on any task.

use super::learners::{AnyCourse, AnyLearner};
use super::{AnyClassifier, Learned};
use crate::error::Result;
use crate::policy::{Ladder, Mixture};
use crate::roll::Shortcut;
use crate::space::{Action, CostToGo, Features, Problem, Space, StateOf};
use crate::theory::ledgers::{self, Expected, Extent};
use crate::trainer::{
    Aggregate, Aggrevate, Averaged, Cpi, Dagger, EarlyUpdate, Forward, Keeper, Lols, Rate, Run, Searn, Slots, Smile,
    Stacking, Supervised, Trained,
};
use serde::{Deserialize, Serialize};

/// A trainer with its settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trainer {
    /// [`Supervised`].
    Supervised(Supervised),
    /// [`Forward`].
    Forward(Forward),
    /// [`Smile`].
    Smile(Smile),
    /// [`Searn`] with roll-outs.
    Searn(Searn),
    /// [`Searn`] with roll-outs, online.
    SearnOnline(Searn),
    /// [`Searn`] with the expert's own cost-to-go: [`Shortcut`].
    SearnShortcut(Searn),
    /// [`Cpi`].
    Cpi(Cpi),
    /// [`Dagger`] on the aggregate.
    Dagger(Dagger),
    /// [`Dagger`], online.
    DaggerOnline(Dagger),
    /// [`Aggrevate`] with the expert's own cost-to-go of every action at every step: [`Shortcut`].
    Aggrevate(Aggrevate),
    /// [`Lols`] on the aggregate.
    Lols(Lols),
    /// [`Lols`], online.
    LolsOnline(Lols),
    /// [`Stacking`], both stages supervised.
    Stacked(Stacking),
    /// [`EarlyUpdate`], which takes no learner.
    EarlyUpdate(EarlyUpdate),
}

/// [`Dagger`], online.
impl Default for Trainer {
    fn default() -> Self {
        Trainer::DaggerOnline(Dagger::default())
    }
}

/// A keeper for all trainers of this module, with any learner.
pub trait KeepsAll:
    Keeper<Features, Mixture<AnyClassifier>>
    + Keeper<Features, (Mixture<AnyClassifier>, Slots<Features>)>
    + Keeper<Features, (Mixture<AnyClassifier>, bool)>
    + Keeper<Features, Ladder<AnyClassifier>>
    + Keeper<Features, Aggregate<Features, AnyClassifier>>
    + Keeper<Features, Option<(AnyClassifier, Vec<Vec<Action>>)>>
    + Keeper<Features, AnyCourse>
    + Keeper<Features, Averaged>
{
}

impl<K> KeepsAll for K where
    K: Keeper<Features, Mixture<AnyClassifier>>
        + Keeper<Features, (Mixture<AnyClassifier>, Slots<Features>)>
        + Keeper<Features, (Mixture<AnyClassifier>, bool)>
        + Keeper<Features, Ladder<AnyClassifier>>
        + Keeper<Features, Aggregate<Features, AnyClassifier>>
        + Keeper<Features, Option<(AnyClassifier, Vec<Vec<Action>>)>>
        + Keeper<Features, AnyCourse>
        + Keeper<Features, Averaged>
{
}

impl Trainer {
    /// Trains on `problem` with `learner`, which [`Trainer::EarlyUpdate`] leaves alone.
    ///
    /// # Errors
    /// When a setting is out of its range or the problem has no episodes.
    pub fn train<P: Problem>(
        &self,
        problem: &P,
        learner: &AnyLearner,
        run: &Run<'_, impl KeepsAll>,
    ) -> Result<Trained<Learned>>
    where
        P::Space: Space<View = Features>,
        P::Expert: CostToGo<P::Space>,
        StateOf<P>: Clone,
    {
        Ok(match self {
            Trainer::Supervised(trainer) => trainer.train(problem, learner, run)?.map(Learned::from),
            Trainer::Forward(trainer) => trainer.train(problem, learner, run)?.map(Learned::from),
            Trainer::Smile(trainer) => trainer.train(problem, learner, run)?.map(Learned::from),
            Trainer::Searn(trainer) => trainer.train(problem, learner, run)?.map(Learned::from),
            Trainer::SearnOnline(trainer) => trainer.train_online(problem, learner, run)?.map(Learned::from),
            Trainer::SearnShortcut(trainer) => trainer.train_by(problem, learner, &Shortcut, run)?.map(Learned::from),
            Trainer::Cpi(trainer) => trainer.train(problem, learner, run)?.map(Learned::from),
            Trainer::Dagger(trainer) => trainer.train(problem, learner, run)?.map(Learned::from),
            Trainer::DaggerOnline(trainer) => trainer.train_online(problem, learner, run)?.map(Learned::from),
            Trainer::Aggrevate(trainer) => trainer.train_by(problem, learner, &Shortcut, run)?.map(Learned::from),
            Trainer::Lols(trainer) => trainer.train(problem, learner, run)?.map(Learned::from),
            Trainer::LolsOnline(trainer) => trainer.train_online(problem, learner, run)?.map(Learned::from),
            Trainer::Stacked(trainer) => trainer.train(problem, learner, run)?.map(Learned::from),
            Trainer::EarlyUpdate(trainer) => trainer.train(problem, run)?.map(Learned::from),
        })
    }

    /// What training on a problem of this extent is expected to cost.
    pub fn expected(&self, extent: &Extent) -> Expected {
        match self {
            Trainer::Supervised(supervised) => ledgers::supervised(extent, supervised),
            Trainer::Forward(forward) => ledgers::forward(extent, forward),
            Trainer::Smile(smile) => ledgers::smile(extent, smile),
            Trainer::Searn(searn) | Trainer::SearnOnline(searn) => ledgers::searn(extent, searn),
            Trainer::SearnShortcut(searn) => ledgers::searn_shortcut(extent, searn),
            Trainer::Cpi(cpi) => ledgers::cpi(extent, cpi),
            Trainer::Dagger(dagger) => ledgers::dagger(extent, dagger),
            Trainer::DaggerOnline(dagger) => ledgers::dagger_online(extent, dagger),
            Trainer::Aggrevate(aggrevate) => ledgers::aggrevate_shortcut(extent, aggrevate),
            Trainer::Lols(lols) => ledgers::lols(extent, lols),
            Trainer::LolsOnline(lols) => ledgers::lols_online(extent, lols),
            Trainer::Stacked(_) => ledgers::stacking(extent),
            Trainer::EarlyUpdate(early) => ledgers::early_update(extent, early),
        }
    }

    /// Whether what it trains is a mixture, which can be read in more than one way.
    pub fn mixes(&self) -> bool {
        use Trainer::{Cpi, Searn, SearnOnline, SearnShortcut, Smile};
        matches!(self, Smile(_) | Searn(_) | SearnOnline(_) | SearnShortcut(_) | Cpi(_))
    }

    /// The weights of the mixture pi^n for n = 0, ..., N, the expert's first, where it trains one by a rate that is known beforehand. What it ends with
    /// has those of pi^N without the expert's, in proportion ([`Mixture::without_expert`]).
    ///
    /// ```
    /// use rollin::tasks::Trainer;
    /// use rollin::trainer::{Searn, Smile};
    ///
    /// let smile = Trainer::Smile(Smile { alpha: 0.5, rounds: 2, ..Smile::default() });
    /// assert_eq!(smile.weights(), Some(vec![vec![1.0], vec![0.5, 0.5], vec![0.25, 0.5, 0.25]]));
    /// let searn = Trainer::Searn(Searn { beta: 0.5, rounds: 2, ..Searn::default() });
    /// assert_eq!(searn.weights(), Some(vec![vec![1.0], vec![0.5, 0.5], vec![0.25, 0.25, 0.5]]));
    /// ```
    pub fn weights(&self) -> Option<Vec<Vec<f64>>> {
        type Update = fn(&mut Mixture<()>, f64);
        let blend: Update = |mixture, beta| mixture.blend(beta, ());
        let (rounds, rate, update) = match self {
            Trainer::Smile(smile) => {
                (smile.rounds, smile.alpha, (|mixture, alpha| mixture.replace_expert(alpha, ())) as Update)
            }
            Trainer::Searn(searn) | Trainer::SearnOnline(searn) | Trainer::SearnShortcut(searn) => {
                (searn.rounds, searn.beta, blend)
            }
            Trainer::Cpi(Cpi { rate: Rate::Fixed(beta), rounds, .. }) => (*rounds, *beta, blend),
            _ => return None,
        };
        let mut mixture = Mixture::of_expert();
        let weights = |mixture: &Mixture<()>| -> Vec<f64> {
            std::iter::once(mixture.expert()).chain(mixture.members().iter().map(|(weight, ())| *weight)).collect()
        };
        let mut all = vec![weights(&mixture)];
        for _ in 0..rounds {
            update(&mut mixture, rate);
            all.push(weights(&mixture));
        }
        Some(all)
    }
}
