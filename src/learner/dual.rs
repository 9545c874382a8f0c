//! What the learners that work in the dual share: examples without repetitions, and one step for each example as it comes up.

use super::kept::{put_linear, take_columns, take_weights};
use super::{Examples, Kept, Lesson, Setting, Target};
use crate::index::Index;
use crate::output::Arrays;
use crate::policy::{Classifier, Columns, Linear, LinearMemory, Weights, best};
use crate::space::{Action, FeatureTable, Features, Listed, Sight, StoredFeatures};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Examples of which equal ones are one, with a count: an aggregate of many rounds holds most of its examples many times, and
/// in the dual n equal examples are one whose variables may be n times as large.
pub(super) struct Batch<'a> {
    table: &'a FeatureTable,
    views: &'a StoredFeatures,
    /// The first of each kind, in their order.
    firsts: Vec<u32>,
    counts: Vec<f32>,
}

impl<'a> Batch<'a> {
    /// The examples that are not equal.
    pub(super) fn of(setting: Setting<'a, Features>, examples: &'a Examples<Features>) -> Self {
        let mut batch =
            Batch { table: setting.shared, views: examples.views(), firsts: Vec::new(), counts: Vec::new() };
        let (mut index, mut hashes) = (Index::default(), Vec::new());
        for i in 0..examples.len() {
            let hash = hash(examples, i);
            index.make_room(&hashes);
            match index.probe(hash, |n| same(examples, batch.firsts[n as usize] as usize, i)) {
                Ok(n) => batch.counts[n as usize] += 1.0,
                Err(place) => {
                    index.take(place, hash, hashes.len() as u32);
                    hashes.push(hash);
                    batch.firsts.push(i as u32);
                    batch.counts.push(1.0);
                }
            }
        }
        batch
    }

    /// How many different examples there are.
    pub(super) fn len(&self) -> usize {
        self.firsts.len()
    }

    /// Which example the `n`-th is, and how many are equal to it.
    pub(super) fn example(&self, n: usize) -> (usize, f32) {
        (self.firsts[n] as usize, self.counts[n])
    }

    /// The features of the `n`-th.
    #[inline]
    pub(super) fn features(&self, n: usize) -> Listed<'a> {
        self.views.listed(self.firsts[n] as usize, self.table)
    }
}

fn hash(examples: &Examples<Features>, i: usize) -> u64 {
    let mut hasher = DefaultHasher::new();
    examples.views().get(i).hash(&mut hasher);
    match examples.target(i) {
        Target::Label(label) => label.hash(&mut hasher),
        Target::Costs(costs) => costs.iter().for_each(|cost| cost.to_bits().hash(&mut hasher)),
    }
    hasher.finish()
}

fn same(examples: &Examples<Features>, i: usize, j: usize) -> bool {
    examples.views().get(i) == examples.views().get(j)
        && examples.target(i) == examples.target(j)
        && examples.same_legal(i, j)
}

/// A linear classifier in the making, of a learner that makes one step in the dual for each example when it comes up.
#[derive(Clone, Debug)]
pub struct Steps {
    actions: usize,
    columns: Columns,
    weights: Weights,
    scores: Vec<f32>,
    change: Vec<f32>,
    votes: Vec<f32>,
}

impl Steps {
    /// No weights, or those of `warm`.
    pub(super) fn begin(columns: Columns, setting: Setting<'_, Features>, warm: Option<&Linear>) -> Self {
        let blank = || Weights::new(setting.shared.features(), columns.count(setting.actions));
        let weights = warm.map_or_else(blank, |warm| warm.weights.clone());
        let (scores, change) = (vec![0.0; weights.stride()], vec![0.0; weights.stride()]);
        Steps { actions: setting.actions, columns, weights, scores, change, votes: Vec::new() }
    }

    /// Adds up the weights of these features.
    #[inline]
    pub(super) fn score(&mut self, features: Listed<'_>) {
        self.scores.fill(0.0);
        self.weights.add_parts(features.parts(), 0, &mut self.scores);
    }

    /// Adds to the weights of these features what `step` writes into a change of zeros, given the lesson, the number of features and the
    /// scores found last.
    #[inline]
    pub(super) fn change(
        &mut self,
        features: Listed<'_>,
        lesson: Lesson<'_>,
        step: impl FnOnce(Lesson<'_>, f32, &[f32], &mut [f32]) -> bool,
    ) {
        self.change.fill(0.0);
        if step(lesson, features.len() as f32, &self.scores, &mut self.change) {
            for feature in features.iter() {
                let row = self.weights.row_mut(feature);
                row.iter_mut().zip(&self.change).for_each(|(w, change)| *w += change);
            }
        }
    }

    /// What is best at `sight` so far; then makes `step`.
    pub(super) fn meet(
        &mut self,
        sight: &Sight<'_, Features>,
        target: Option<Target<'_>>,
        step: impl FnOnce(Lesson<'_>, f32, &[f32], &mut [f32]) -> bool,
    ) -> Action {
        let features = sight.listed();
        self.score(features);
        let choice = best(self.columns, self.actions, &self.scores, sight.legal, &mut self.votes);
        if let Some(target) = target {
            self.change(features, Lesson { actions: self.actions, legal: sight.legal, target }, step);
        }
        choice
    }

    /// Makes `step` at each of `examples`, in their order.
    pub(super) fn study(
        &mut self,
        setting: Setting<'_, Features>,
        examples: &Examples<Features>,
        mut step: impl FnMut(Lesson<'_>, f32, &[f32], &mut [f32]) -> bool,
    ) {
        for i in 0..examples.len() {
            let features = examples.views().listed(i, setting.shared);
            let lesson = Lesson { actions: self.actions, legal: examples.legal(i), target: examples.target(i) };
            self.score(features);
            self.change(features, lesson, &mut step);
        }
    }

    /// What has been learned.
    pub(super) fn finish(self) -> Linear {
        Linear { actions: self.actions, columns: self.columns, weights: self.weights.map_rows(|_, _| {}) }
    }
}

impl Kept<Features> for Steps {
    fn put(&self, to: &mut Vec<u8>) {
        put_linear(self.columns, &self.weights, to);
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, Features>) -> Option<Self> {
        let columns = take_columns(from, setting)?;
        let learned = take_weights(from, setting, setting.actions, columns)?;
        Some(Steps::begin(columns, setting, Some(&learned)))
    }

    fn follows(&self, start: &Self) -> bool {
        self.columns == start.columns
    }
}

/// The weights as they are now.
impl Classifier<Features> for Steps {
    type Memory = LinearMemory;

    fn scores<'m>(&self, sight: &Sight<'_, Features>, memory: &'m mut LinearMemory) -> &'m [f32] {
        memory.scores(self.columns, self.actions, &self.weights, sight)
    }

    #[inline]
    fn choose(&self, sight: &Sight<'_, Features>, memory: &mut LinearMemory) -> Action {
        memory.choose(self.columns, self.actions, &self.weights, sight)
    }
}
