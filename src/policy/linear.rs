//! Linear classifiers over sparse binary features.

use super::weights::{MOST_ADDED, ROUNDING, Weights};
use super::{Classifier, Outputs};
use crate::space::{Action, Actions, Features, Front, NO_ROW, Sight};
use serde::{Deserialize, Serialize};
use std::borrow::Borrow;
use std::ops::Range;

/// What the columns of a linear classifier stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Columns {
    /// One per action: its score.
    Actions,
    /// One per pair of actions i < j, (0,1), (0,2), ..., (1,2), ...: positive where i is better. An action's score is how many of the
    /// legal others it beats.
    Pairs,
    /// One per match of a balanced single-elimination tournament: where actions i..k split before j, column j-1, positive where the winner
    /// of i..j is better than that of j..k. The champion's score is 1, all others' 0.
    Tree,
    /// One per bit of the action's number: [`Outputs::Bits`].
    Bits,
}

impl Columns {
    /// How many columns `actions` actions need.
    pub fn count(self, actions: usize) -> usize {
        match self {
            Columns::Actions => actions,
            Columns::Pairs => actions * actions.saturating_sub(1) / 2,
            Columns::Tree => actions.saturating_sub(1),
            Columns::Bits => Outputs::Bits.count(actions),
        }
    }

    /// The column of the pair i < j.
    #[inline]
    pub fn pair(actions: usize, i: usize, j: usize) -> usize {
        i * actions - i * (i + 1) / 2 + (j - i - 1)
    }
}

/// A linear classifier: an action's score is a sum of weights over the features at hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// How many actions there are.
    pub actions: usize,
    /// What the columns of the weights are.
    pub columns: Columns,
    /// The weights.
    pub weights: Weights,
}

impl Linear {
    /// The classifier whose weights are the weighted mean of these: its scores are the mean of theirs, at the cost of one. `None` when
    /// there is none, or their scores are counts of pairs, which such a mean does not give.
    pub fn mean<L: Borrow<Linear>>(members: &[(f64, L)]) -> Option<Linear> {
        let first = members.first()?.1.borrow();
        if members.iter().any(|(_, m)| m.borrow().columns != Columns::Actions) {
            return None;
        }
        let mut weights = Weights::new(first.weights.features(), first.weights.columns());
        weights.reserve_all();
        for (share, member) in members {
            let member = member.borrow();
            for feature in 0..member.weights.features() as u32 {
                if let Some(row) = member.weights.row(feature) {
                    weights.row_mut(feature).iter_mut().zip(row).for_each(|(sum, w)| *sum += *share as f32 * w);
                }
            }
        }
        Some(Linear { actions: first.actions, columns: Columns::Actions, weights })
    }
}

/// How many static rows' scores a thread remembers: longer sentences only cost time.
const FIXED: usize = 256;
/// How many views' scores a thread remembers as far as they are near: those of the few rows that roll-outs pass before they meet.
const NEAR: usize = 128;

/// A thread's scratch for a linear classifier: what was summed up before and can be of use again.
#[derive(Default)]
pub struct LinearMemory {
    /// The weights' version that everything here is of.
    version: u64,
    /// Over static parts, by their rows.
    fixed: Sums,
    /// Over static and keyed parts, by row and key.
    near: Sums,
    /// What each of those decides, and by how much.
    decided: Vec<(Action, f32)>,
    /// The last sums, one for each column of the weights that everything here is of.
    sums: Vec<f32>,
    /// Scores that are not remembered.
    passing: Vec<f32>,
}

/// Sums by what they are of, each at the place that this has; what comes to the same place takes it over.
#[derive(Default)]
struct Sums {
    keys: Vec<(u32, u32)>,
    sums: Vec<f32>,
}

/// The key of a place where nothing is.
const NOTHING: (u32, u32) = (NO_ROW, u32::MAX);

impl Sums {
    fn new(places: usize, stride: usize) -> Self {
        Sums { keys: vec![NOTHING; places], sums: vec![0.0; places * stride] }
    }

    /// The place of `key`, and whether it has it.
    #[inline]
    fn place(&self, key: (u32, u32)) -> (usize, bool) {
        // A mask, because there is a power of two of them: a remainder takes as long as half of a choice.
        let place = (key.0.wrapping_mul(37).wrapping_add(key.1)) as usize & (self.keys.len() - 1);
        (place, self.keys[place] == key)
    }

    /// The sums at `place`, to be written.
    #[inline]
    fn write(&mut self, place: usize, key: (u32, u32), stride: usize) -> &mut [f32] {
        self.keys[place] = key;
        &mut self.sums[place * stride..(place + 1) * stride]
    }

    /// Writes the sums over these features there, those of the columns in `span`.
    #[inline(never)] // What is known is found without it.
    fn sum_up(&mut self, place: usize, key: (u32, u32), weights: &Weights, features: &[u32], span: Range<usize>) {
        weights.sum_parts([(features, 0)], span, self.write(place, key, weights.stride()));
    }

    #[inline]
    fn read(&self, place: usize, stride: usize) -> &[f32] {
        &self.sums[place * stride..(place + 1) * stride]
    }
}

impl LinearMemory {
    /// Forgets what is not of `weights` as they are now.
    #[inline]
    fn belong_to(&mut self, weights: &Weights) {
        if self.version != weights.version || self.sums.len() != weights.stride() {
            self.forget(weights);
        }
    }

    fn forget(&mut self, weights: &Weights) {
        let stride = weights.stride();
        if self.sums.len() != stride {
            (self.fixed, self.near) = (Sums::new(FIXED, stride), Sums::new(NEAR, stride));
            self.decided = vec![(Action(0), 0.0); NEAR];
            self.sums = vec![0.0; stride];
        } else {
            self.fixed.keys.fill(NOTHING);
            self.near.keys.fill(NOTHING);
        }
        self.version = weights.version;
    }

    /// The sums over the static part of `view`, from memory where they are there: those of the columns in `span`.
    #[inline(always)]
    fn fixed<'m>(
        fixed: &'m mut Sums,
        weights: &Weights,
        sight: &Sight<'_, Features>,
        span: &Range<usize>,
    ) -> &'m [f32] {
        // Both ends in blocks, sixteen bits each: where the start is not 0, no row is wider.
        let key = (sight.view.row, (span.start as u32) << 13 | (span.end / 8) as u32);
        let (place, known) = fixed.place(key);
        if !known {
            fixed.sum_up(place, key, weights, sight.shared.row(sight.view.row), span.clone());
        }
        &fixed.read(place, weights.stride())[span.clone()]
    }

    /// The sums over all parts of the view; zero in columns that no legal action needs, where that is worth it.
    #[inline]
    fn sum<'m>(&'m mut self, columns: Columns, weights: &Weights, sight: &Sight<'_, Features>) -> &'m [f32] {
        self.belong_to(weights);
        let span = weights.span(columns, sight.legal);
        if span.len() < weights.stride() {
            self.sums.fill(0.0);
        }
        let sums = &mut self.sums[span.clone()];
        sums.copy_from_slice(LinearMemory::fixed(&mut self.fixed, weights, sight, &span));
        let [_, keyed, dynamic] = sight.listed().parts();
        weights.add_parts([keyed, dynamic], span.start, sums);
        &self.sums
    }

    /// One score an action, by weights whose columns stand for `columns`.
    #[inline]
    pub(crate) fn scores<'m>(
        &'m mut self,
        columns: Columns,
        actions: usize,
        weights: &Weights,
        sight: &Sight<'_, Features>,
    ) -> &'m [f32] {
        match columns {
            Columns::Actions => &self.sum(columns, weights, sight)[..actions],
            columns => {
                let mut counts = std::mem::take(&mut self.passing);
                votes(columns, actions, self.sum(columns, weights, sight), sight.legal, &mut counts);
                self.passing = counts;
                &self.passing
            }
        }
    }

    /// The legal action with the highest score, the lowest of equals.
    ///
    /// Where weights are measured, the static and the keyed part of the view are summed up once and decide alone if the rest cannot turn the decision.
    #[inline]
    pub(crate) fn choose(
        &mut self,
        columns: Columns,
        actions: usize,
        weights: &Weights,
        sight: &Sight<'_, Features>,
    ) -> Action {
        if columns == Columns::Actions && !weights.measured {
            return self.choose_once(weights, sight);
        }
        if columns != Columns::Actions || sight.shared.keyed(sight.view.row).is_empty() {
            return sight.legal.best(self.scores(columns, actions, weights, sight));
        }
        let far = &sight.view.dynamic;
        if far.is_empty() {
            return self.choose_by_key(actions, weights, sight);
        }
        let place = self.near(actions, weights, sight);
        let (action, margin) = self.decided[place];
        if weights.reach(far) < margin && far.len() <= MOST_ADDED {
            return action;
        }
        self.sums.copy_from_slice(self.near.read(place, weights.stride()));
        weights.add_to(far, &mut self.sums);
        sight.legal.best(&self.sums[..actions])
    }

    /// What [`LinearMemory::choose`] chooses whatever the dynamic part of the view is, if it does not turn on that.
    #[inline]
    pub(crate) fn choose_at_once(
        &mut self,
        columns: Columns,
        actions: usize,
        weights: &Weights,
        sight: &Sight<'_, Features>,
    ) -> Option<Action> {
        let measured = columns == Columns::Actions && weights.measured;
        if !measured || sight.shared.keyed(sight.view.row).is_empty() {
            return None;
        }
        let most = weights.most();
        if most == 0.0 {
            return Some(self.choose_by_key(actions, weights, sight));
        }
        let place = self.near(actions, weights, sight);
        let (action, margin) = self.decided[place];
        (most < margin).then_some(action)
    }

    /// The choice of the static and the keyed part of the view.
    #[inline]
    fn choose_by_key(&mut self, actions: usize, weights: &Weights, sight: &Sight<'_, Features>) -> Action {
        self.belong_to(weights);
        let fixed = LinearMemory::fixed(&mut self.fixed, weights, sight, &(0..weights.stride()));
        weights.add_onto(fixed, (sight.shared.keyed(sight.view.row), sight.view.key), &mut self.sums);
        sight.legal.best(&self.sums[..actions])
    }

    /// The same for all states of `front`.
    pub(crate) fn choose_all_at_once(
        &mut self,
        columns: Columns,
        actions: usize,
        weights: &Weights,
        front: &Front<'_, Features>,
        chosen: &mut [Option<Action>],
    ) {
        if columns == Columns::Actions && weights.measured && weights.most() == 0.0 {
            match weights.stride() {
                8 => return self.choose_by_keys::<8>(weights, front, chosen),
                16 => return self.choose_by_keys::<16>(weights, front, chosen),
                24 => return self.choose_by_keys::<24>(weights, front, chosen),
                32 => return self.choose_by_keys::<32>(weights, front, chosen),
                _ => {}
            }
        }
        for (sight, chosen) in front.sights().zip(chosen) {
            *chosen = self.choose_at_once(columns, actions, weights, &sight);
        }
    }

    /// The same where nothing can turn what static and keyed parts decide, and with the sums held in registers.
    fn choose_by_keys<const N: usize>(
        &mut self,
        weights: &Weights,
        front: &Front<'_, Features>,
        chosen: &mut [Option<Action>],
    ) {
        self.belong_to(weights);
        let (mut row, mut fixed) = (NO_ROW, [0.0; N]);
        for (sight, chosen) in front.sights().zip(chosen) {
            let keyed = sight.shared.keyed(sight.view.row);
            if keyed.is_empty() {
                continue;
            }
            if sight.view.row != row {
                row = sight.view.row;
                fixed.copy_from_slice(LinearMemory::fixed(&mut self.fixed, weights, &sight, &(0..N)));
            }
            let sums = weights.added([(keyed, sight.view.key)], 0, fixed);
            *chosen = Some(sight.legal.best(&sums));
        }
    }

    /// The place of the sums over the static and the keyed part of the view, and of what they decide.
    #[inline]
    fn near(&mut self, actions: usize, weights: &Weights, sight: &Sight<'_, Features>) -> usize {
        self.belong_to(weights);
        let stride = weights.stride();
        let key = (sight.view.row, sight.view.key);
        let (place, known) = self.near.place(key);
        if !known {
            let sums = self.near.write(place, key, stride);
            let fixed = LinearMemory::fixed(&mut self.fixed, weights, sight, &(0..stride));
            weights.add_onto(fixed, (sight.shared.keyed(key.0), key.1), sums);
            self.decided[place] = decide(sight.legal, &sums[..actions]);
        }
        place
    }

    /// The same where no static part is seen twice, and nothing is worth remembering: weights that were not measured are not there to roll out.
    #[inline]
    fn choose_once(&mut self, weights: &Weights, sight: &Sight<'_, Features>) -> Action {
        self.passing.clear();
        self.passing.resize(weights.stride(), 0.0);
        let span = weights.span(Columns::Actions, sight.legal);
        weights.add_parts(sight.listed().parts(), span.start, &mut self.passing[span]);
        sight.legal.best(&self.passing)
    }
}

/// The legal action with the highest score, the lowest of equals, and how far the others can come up without beating it, however their sums are
/// rounded: the further one is behind, the more rounding may do, but less than that.
fn decide(legal: Actions<'_>, scores: &[f32]) -> (Action, f32) {
    let (best, high, second) = legal.best_two_by(|a| scores[a.index()]);
    (best, (high - second) * (1.0 - ROUNDING) - ROUNDING * high.abs())
}

/// The champion of the legal actions' tournament; every match, its column and the two that meet, is shown to `watch`. Of equals
/// the left one wins.
pub(crate) fn tournament(
    actions: usize,
    columns: &[f32],
    legal: Actions<'_>,
    watch: &mut impl FnMut(usize, Action, Action),
) -> Option<Action> {
    fn winner(
        range: std::ops::Range<usize>,
        columns: &[f32],
        legal: Actions<'_>,
        watch: &mut impl FnMut(usize, Action, Action),
    ) -> Option<Action> {
        if range.len() <= 1 {
            let action = Action(range.start as u32);
            return (!range.is_empty() && legal.contains(action)).then_some(action);
        }
        let middle = range.start.midpoint(range.end);
        let left = winner(range.start..middle, columns, legal, watch);
        let right = winner(middle..range.end, columns, legal, watch);
        match (left, right) {
            (Some(left), Some(right)) => {
                watch(middle - 1, left, right);
                Some(if columns[middle - 1] >= 0.0 { left } else { right })
            }
            (left, right) => left.or(right),
        }
    }
    winner(0..actions, columns, legal, watch)
}

/// The scores of actions from columns that are not theirs: how many legal others each beats in pairs, who is champion of the tree, or the
/// sum over the bits.
fn votes(of: Columns, actions: usize, columns: &[f32], legal: Actions<'_>, votes: &mut Vec<f32>) {
    if of == Columns::Bits {
        return Outputs::Bits.scores(actions, columns, votes);
    }
    votes.clear();
    votes.resize(actions, 0.0);
    if of == Columns::Tree {
        if let Some(champion) = tournament(actions, columns, legal, &mut |_, _, _| {}) {
            votes[champion.index()] = 1.0;
        }
        return;
    }
    for (place, Action(i)) in legal.iter().enumerate() {
        for Action(j) in legal.iter().skip(place + 1) {
            let better = if columns[Columns::pair(actions, i as usize, j as usize)] >= 0.0 { i } else { j };
            votes[better as usize] += 1.0;
        }
    }
}

/// The legal action that these `columns`, which stand for `of`, are best for; `scratch` is for votes.
#[inline]
pub(crate) fn best(of: Columns, actions: usize, columns: &[f32], legal: Actions<'_>, scratch: &mut Vec<f32>) -> Action {
    if of == Columns::Actions {
        return legal.best(columns);
    }
    votes(of, actions, columns, legal, scratch);
    legal.best(scratch)
}

impl Classifier<Features> for Linear {
    type Memory = LinearMemory;

    #[inline]
    fn scores<'m>(&self, sight: &Sight<'_, Features>, memory: &'m mut LinearMemory) -> &'m [f32] {
        memory.scores(self.columns, self.actions, &self.weights, sight)
    }

    #[inline]
    fn choose(&self, sight: &Sight<'_, Features>, memory: &mut LinearMemory) -> Action {
        memory.choose(self.columns, self.actions, &self.weights, sight)
    }

    #[inline]
    fn choose_at_once(&self, sight: &Sight<'_, Features>, memory: &mut LinearMemory) -> Option<Action> {
        memory.choose_at_once(self.columns, self.actions, &self.weights, sight)
    }

    #[inline]
    fn choose_all_at_once(
        &self,
        front: &Front<'_, Features>,
        memory: &mut LinearMemory,
        actions: &mut [Option<Action>],
    ) {
        memory.choose_all_at_once(self.columns, self.actions, &self.weights, front, actions);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::FeatureTable;
    use proptest::prelude::*;

    proptest! {
        /// One memory for narrow and wide classifiers, measured or not, asked to choose and for scores in any order: the answers are those of a new one.
        #[test]
        fn memory_serves_all_classifiers(
            numbers in prop::array::uniform32(-2..3i8),
            asked in prop::collection::vec((0..4usize, 0..2u32, 0..4u32, any::<bool>()), 1..30),
        ) {
            let rows = FeatureTable::from_rows(6, vec![0, 1, 2], vec![0, 1]);
            let shared = rows.keyed_by(vec![0, 1, 2], vec![2, 2], 6, 0);
            let linear: Vec<Linear> = (0..4).map(|i| {
                let actions = [3, 20][i % 2];
                let mut weights = Weights::new(6, actions);
                for feature in 0..6 {
                    let row = weights.row_mut(feature)[..actions].iter_mut().zip(&numbers[feature as usize..]);
                    row.for_each(|(w, number)| *w = f32::from(*number));
                }
                if i > 1 {
                    weights.measure(&shared);
                }
                Linear { actions, columns: Columns::Actions, weights }
            }).collect();
            let mut memory = LinearMemory::default();
            for (i, row, key, choose) in asked {
                let view = Features { row, key, dynamic: Vec::new() };
                let legal = Actions::All(linear[i].actions as u32);
                let sight = Sight { shared: &shared, view: &view, legal };
                let scores = linear[i].scores(&sight, &mut Default::default()).to_vec();
                match choose {
                    true => {
                        prop_assert_eq!(linear[i].choose(&sight, &mut memory), legal.best(&scores));
                        let at_once = linear[i].choose_at_once(&sight, &mut memory);
                        prop_assert!(at_once.is_none_or(|action| action == legal.best(&scores)));
                    }
                    false => prop_assert_eq!(linear[i].scores(&sight, &mut memory), &scores[..]),
                }
            }
        }
    }
}
