//! Training by name: any trainer with any learner, on any task.

use super::learners::AnyLearner;
use super::model::Learned;
use crate::error::Result;
use crate::roll::Shortcut;
use crate::space::{CostToGo, Features, Problem, Space, StateOf};
use crate::theory::ledgers::{self, Expected, Extent};
use crate::trainer::{
    Aggrevate, Cpi, Dagger, EarlyUpdate, Forward, Lols, Run, Searn, Smile, Stacking, Supervised, Trained,
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

impl Trainer {
    /// Trains on `problem` with `learner`, which [`Trainer::EarlyUpdate`] leaves alone.
    ///
    /// # Errors
    /// When a setting is out of its range or the problem has no episodes.
    pub fn train<P: Problem>(&self, problem: &P, learner: &AnyLearner, run: &Run<'_>) -> Result<Trained<Learned>>
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
            Trainer::SearnShortcut(trainer) => trainer.train_by(problem, learner, &Shortcut, run)?.map(Learned::from),
            Trainer::Cpi(trainer) => trainer.train(problem, learner, run)?.map(Learned::from),
            Trainer::Dagger(trainer) => trainer.train(problem, learner, run)?.map(Learned::from),
            Trainer::DaggerOnline(trainer) => trainer.train_online(problem, learner, run)?.map(Learned::from),
            Trainer::Aggrevate(trainer) => trainer.train_by(problem, learner, &Shortcut, run)?.map(Learned::from),
            Trainer::Lols(trainer) => trainer.train(problem, learner, run)?.map(Learned::from),
            Trainer::LolsOnline(trainer) => trainer.train_online(problem, learner, run)?.map(Learned::from),
            Trainer::Stacked(trainer) => trainer.train(problem, learner, run)?.map(Learned::Stacked),
            Trainer::EarlyUpdate(trainer) => trainer.train(problem, run)?.map(Learned::Beam),
        })
    }

    /// What training on a problem of this extent is expected to cost.
    pub fn expected(&self, extent: &Extent) -> Expected {
        match self {
            Trainer::Supervised(supervised) => ledgers::supervised(extent, supervised),
            Trainer::Forward(forward) => ledgers::forward(extent, forward),
            Trainer::Smile(smile) => ledgers::smile(extent, smile),
            Trainer::Searn(searn) => ledgers::searn(extent, searn),
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
        matches!(self, Trainer::Smile(_) | Trainer::Searn(_) | Trainer::SearnShortcut(_) | Trainer::Cpi(_))
    }
}
