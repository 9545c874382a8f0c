//! What can be written down in the middle of training and read again: bit by bit the same.
//!
//! Numbers are little-endian; a list is its length and then what is in it. What is read is untrusted: no length is believed before the bytes are
//! there, and numbers of features, actions and rows are those of the setting or nothing is read at all. Scratch is not kept.

use super::{Examples, Setting, Target};
use crate::output::Arrays;
use crate::policy::{
    Columns, Ladder, Linear, Mixture, Neural, Outputs, Reading, Rows, Weights, put_rows_of, take_rows,
};
use crate::seed::Seed;
use crate::space::{Action, Actions, Dense, DenseRows, Features, NO_ROW, Store, StoredFeatures, View};

/// Something that a checkpoint can hold, in spaces whose view is `V`.
///
/// ```
/// use rollin::learner::{Kept, Setting};
/// use rollin::learner::Arrays;
/// use rollin::space::{Dense, Width};
///
/// let setting = Setting::<Dense> { shared: &Width(2), actions: 3 };
/// let mut bytes = Vec::new();
/// Kept::<Dense>::put(&(7usize, f64::NAN), &mut bytes);
/// let (count, cost) = <(usize, f64)>::take(&mut Arrays::of(&bytes), setting).unwrap();
/// assert!(count == 7 && cost.is_nan());
/// assert!(<(usize, f64)>::take(&mut Arrays::of(&bytes[..9]), setting).is_none());
/// ```
pub trait Kept<V: View>: Sized {
    /// Appends what [`Kept::take`] makes it of.
    fn put(&self, to: &mut Vec<u8>);

    /// What was put, for this setting; `None` when that is not what stands there.
    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self>;

    /// Whether training that begins with `start` can go on with this: what `start` was begun with and must not change is the same.
    fn follows(&self, start: &Self) -> bool {
        let _ = start;
        true
    }
}

/// More than can have been counted of anything: whatever is counted on from there does not overflow.
pub(crate) const MOST_COUNTED: u64 = u64::MAX / 4;

/// A number is so many bytes.
macro_rules! number {
    ($number:ty, $bytes:literal) => {
        impl<V: View> Kept<V> for $number {
            #[inline]
            fn put(&self, to: &mut Vec<u8>) {
                to.extend_from_slice(&self.to_le_bytes());
            }
            #[inline]
            fn take(from: &mut Arrays<'_>, _: Setting<'_, V>) -> Option<Self> {
                from.take::<$bytes>(1)?.first().map(|bytes| <$number>::from_le_bytes(*bytes))
            }
        }
    };
}
number!(u8, 1);
number!(u32, 4);
number!(i32, 4);
number!(u64, 8);
number!(f32, 4);
number!(f64, 8);

impl<V: View> Kept<V> for usize {
    fn put(&self, to: &mut Vec<u8>) {
        Kept::<V>::put(&(*self as u64), to);
    }
    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        u64::take(from, setting)?.try_into().ok()
    }
}

impl<V: View> Kept<V> for bool {
    fn put(&self, to: &mut Vec<u8>) {
        to.push(u8::from(*self));
    }
    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        match u8::take(from, setting)? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }
}

impl<V: View> Kept<V> for Action {
    fn put(&self, to: &mut Vec<u8>) {
        Kept::<V>::put(&self.0, to);
    }
    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        u32::take(from, setting).map(Action).filter(|action| action.index() < setting.actions)
    }
}

impl<V: View> Kept<V> for Seed {
    fn put(&self, to: &mut Vec<u8>) {
        Kept::<V>::put(&self.number(), to);
    }
    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        u64::take(from, setting).map(Seed::of_number)
    }
}

impl<V: View, A: Kept<V>, B: Kept<V>> Kept<V> for (A, B) {
    fn put(&self, to: &mut Vec<u8>) {
        self.0.put(to);
        self.1.put(to);
    }
    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        Some((A::take(from, setting)?, B::take(from, setting)?))
    }
    fn follows(&self, start: &Self) -> bool {
        self.0.follows(&start.0) && self.1.follows(&start.1)
    }
}

impl<V: View, T: Kept<V>> Kept<V> for Option<T> {
    fn put(&self, to: &mut Vec<u8>) {
        Kept::<V>::put(&self.is_some(), to);
        if let Some(value) = self {
            value.put(to);
        }
    }
    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        match bool::take(from, setting)? {
            true => T::take(from, setting).map(Some),
            false => Some(None),
        }
    }
}

impl<V: View, T: Kept<V>> Kept<V> for Vec<T> {
    fn put(&self, to: &mut Vec<u8>) {
        Kept::<V>::put(&self.len(), to);
        self.iter().for_each(|value| value.put(to));
    }
    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        // Nothing is reserved: a length that is not true ends with the bytes.
        (0..usize::take(from, setting)?).map(|_| T::take(from, setting)).collect()
    }
}

impl Kept<Features> for StoredFeatures {
    fn put(&self, to: &mut Vec<u8>) {
        Kept::<Features>::put(&self.len(), to);
        for (row, key, dynamic) in (0..self.len()).map(|i| self.get(i)) {
            Kept::<Features>::put(&row, to);
            Kept::<Features>::put(&key, to);
            Kept::<Features>::put(&(dynamic.len() as u32), to);
            dynamic.iter().for_each(|feature| Kept::<Features>::put(feature, to));
        }
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, Features>) -> Option<Self> {
        let (mut stored, mut view) = (StoredFeatures::default(), Features::default());
        for _ in 0..usize::take(from, setting)? {
            (view.row, view.key) = (u32::take(from, setting)?, u32::take(from, setting)?);
            let dynamic = u32::take(from, setting)? as usize;
            view.dynamic.clear();
            view.dynamic.extend(from.take::<4>(dynamic)?.iter().map(|feature| u32::from_le_bytes(*feature)));
            let known = view.row == NO_ROW || (view.row as usize) < setting.shared.rows();
            let named = |feature: u32| (feature as usize) < setting.shared.features();
            if !known || !setting.shared.listed(view.row, view.key, &view.dynamic).iter().all(named) {
                return None;
            }
            stored.push(&view);
        }
        Some(stored)
    }
}

impl Kept<Dense> for DenseRows {
    fn put(&self, to: &mut Vec<u8>) {
        Kept::<Dense>::put(&self.len(), to);
        (0..self.len()).flat_map(|i| self.get(i)).for_each(|x| Kept::<Dense>::put(x, to));
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, Dense>) -> Option<Self> {
        let (mut stored, mut view) = (DenseRows::default(), Dense::default());
        let count = usize::take(from, setting)?;
        if setting.shared.0 == 0 && count > 0 {
            return None;
        }
        for _ in 0..count {
            view.0.clear();
            view.0.extend(from.take::<4>(setting.shared.0)?.iter().map(|x| f32::from_le_bytes(*x)));
            stored.push(&view);
        }
        Some(stored)
    }
}

impl<V: View<Store: Kept<V>>> Kept<V> for Examples<V> {
    fn put(&self, to: &mut Vec<u8>) {
        self.views().put(to);
        let sets: Vec<Actions<'_>> = self.sets().collect();
        Kept::<V>::put(&sets.len(), to);
        for set in sets {
            let (all, only) = match set {
                Actions::All(count) => (count, Vec::new()),
                Actions::Only(list) => (0, list.to_vec()),
            };
            Kept::<V>::put(&(all, only), to);
        }
        for i in 0..self.len() {
            Kept::<V>::put(&self.set(i), to);
            match self.target(i) {
                Target::Label(label) => Kept::<V>::put(&Some(label), to),
                Target::Costs(costs) => {
                    Kept::<V>::put(&None::<Action>, to);
                    costs.iter().for_each(|cost| Kept::<V>::put(cost, to));
                }
            }
        }
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        let views = V::Store::take(from, setting)?;
        let sets = Vec::<(u32, Vec<Action>)>::take(from, setting)?;
        let possible = |(all, only): &(u32, Vec<Action>)| match all {
            0 => !only.is_empty() && only.is_sorted_by(|a, b| a.0 < b.0),
            all => *all as usize <= setting.actions,
        };
        if !sets.iter().all(possible) {
            return None;
        }
        let (mut examples, mut view, mut costs) = (Examples::default(), V::default(), Vec::new());
        for i in 0..views.len() {
            let legal = match sets.get(u32::take(from, setting)? as usize)? {
                (0, list) => Actions::Only(list),
                (all, _) => Actions::All(*all),
            };
            let target = match <Option<Action> as Kept<V>>::take(from, setting)? {
                Some(label) => Target::Label(label),
                None => {
                    costs.clear();
                    costs.extend(from.take::<4>(legal.len())?.iter().map(|cost| f32::from_le_bytes(*cost)));
                    Target::Costs(&costs)
                }
            };
            views.recall(i, &mut view);
            examples.push(&view, legal, target);
        }
        Some(examples)
    }
}

/// Appends the rows of `weights` in the order in which they were made, so that they will be made in it again.
pub(super) fn put_weights(weights: &Weights, to: &mut Vec<u8>) {
    let mut made: Vec<(usize, u32)> =
        (0..weights.features() as u32).filter_map(|f| weights.place(f).map(|place| (place, f))).collect();
    made.sort_unstable();
    Kept::<Features>::put(&made.len(), to);
    put_rows_of(weights, made.iter().map(|(_, feature)| *feature), to);
}

/// What columns can stand for, each at the number by which it is kept.
const COLUMNS: [Columns; 4] = [Columns::Actions, Columns::Pairs, Columns::Tree, Columns::Bits];

/// The number of `value` in a list of all there are.
fn number<T: PartialEq>(value: &T, all: &[T]) -> u8 {
    all.iter().position(|other| other == value).unwrap_or(0) as u8
}

/// Appends what the columns stand for, then the weights.
pub(super) fn put_linear(columns: Columns, weights: &Weights, to: &mut Vec<u8>) {
    to.push(number(&columns, &COLUMNS));
    put_weights(weights, to);
}

/// What columns stand for.
pub(super) fn take_columns(from: &mut Arrays<'_>, setting: Setting<'_, Features>) -> Option<Columns> {
    COLUMNS.get(usize::from(u8::take(from, setting)?)).copied()
}

/// The weights for so many `actions`, or units, as they were put behind what their columns stand for; they are not measured.
pub(super) fn take_weights(
    from: &mut Arrays<'_>,
    setting: Setting<'_, Features>,
    actions: usize,
    columns: Columns,
) -> Option<Linear> {
    let count = usize::take(from, setting)?;
    take_rows((actions, setting.shared.features()), columns, count, from).ok()
}

impl Kept<Features> for Linear {
    fn put(&self, to: &mut Vec<u8>) {
        put_linear(self.columns, &self.weights, to);
    }
    fn take(from: &mut Arrays<'_>, setting: Setting<'_, Features>) -> Option<Self> {
        let columns = take_columns(from, setting)?;
        let mut linear = take_weights(from, setting, setting.actions, columns)?;
        linear.weights.measure(setting.shared);
        Some(linear)
    }
}

/// What outputs can be, each at the number by which it is kept.
const OUTPUTS: [Outputs; 2] = [Outputs::Actions, Outputs::Bits];

impl<V: View> Kept<V> for Outputs {
    fn put(&self, to: &mut Vec<u8>) {
        to.push(number(self, &OUTPUTS));
    }
    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        OUTPUTS.get(usize::from(u8::take(from, setting)?)).copied()
    }
}

/// What a net has but for its input: what the outputs are, the number of units, and the weights; nothing unless they are as many as they must be.
pub(super) fn take_dense<V: View>(
    from: &mut Arrays<'_>,
    setting: Setting<'_, V>,
) -> Option<(Outputs, usize, Vec<f32>)> {
    let (outputs, (units, dense)) = <(Outputs, (usize, Vec<f32>))>::take(from, setting)?;
    let ends = outputs.count(setting.actions);
    let size = ends.checked_add(1)?.checked_mul(units)?.checked_add(ends)?;
    (dense.len() == size).then_some((outputs, units, dense))
}

/// Nets over one kind of view.
macro_rules! net {
    ($view:ty, $input:ty, $put:expr, $take:expr) => {
        impl Kept<$view> for Neural<$input> {
            fn put(&self, to: &mut Vec<u8>) {
                Kept::<$view>::put(&self.outputs, to);
                Kept::<$view>::put(&self.units, to);
                Kept::<$view>::put(&self.dense, to);
                $put(&self.input, to);
            }
            fn take(from: &mut Arrays<'_>, setting: Setting<'_, $view>) -> Option<Self> {
                let (outputs, units, dense) = take_dense(from, setting)?;
                let actions = setting.actions;
                let columns = if units == 0 { outputs.count(actions) } else { units };
                Some(Neural { actions, outputs, units, input: $take(from, setting, columns)?, dense })
            }
        }
    };
}
net!(Features, Linear, |input: &Linear, to: &mut Vec<u8>| put_weights(&input.weights, to), take_layer);
net!(Dense, Rows, |input: &Rows, to: &mut Vec<u8>| Kept::<Dense>::put(&input.weights, to), take_full);

/// The input layer of a net over features.
pub(super) fn take_layer(from: &mut Arrays<'_>, setting: Setting<'_, Features>, columns: usize) -> Option<Linear> {
    take_weights(from, setting, columns, Columns::Actions)
}

/// The input layer of a net over numbers.
pub(super) fn take_full(from: &mut Arrays<'_>, setting: Setting<'_, Dense>, columns: usize) -> Option<Rows> {
    let rows = Rows { columns, weights: Vec::take(from, setting)? };
    (setting.shared.0.checked_mul(rows.stride())? == rows.weights.len()).then_some(rows)
}

impl<V: View, C: Kept<V>> Kept<V> for Mixture<C> {
    fn put(&self, to: &mut Vec<u8>) {
        Kept::<V>::put(&self.expert(), to);
        Kept::<V>::put(&self.members().len(), to);
        for (weight, classifier) in self.members() {
            Kept::<V>::put(weight, to);
            classifier.put(to);
        }
    }

    /// One that is drawn from, as all are while they are trained.
    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        let (expert, members) = <(f64, Vec<(f64, C)>)>::take(from, setting)?;
        let share = |weight: &f64| (0.0..=1.0).contains(weight);
        let possible = share(&expert) && members.iter().all(|(weight, _)| share(weight));
        possible.then(|| Mixture::of_parts(expert, members, Reading::Sampled))
    }
}

impl<V: View, C: Kept<V>> Kept<V> for Ladder<C> {
    fn put(&self, to: &mut Vec<u8>) {
        Kept::<V>::put(&self.steps().len(), to);
        self.steps().iter().for_each(|step| step.put(to));
    }

    /// One whose further steps are the expert's, as they are while it is trained.
    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        let mut ladder = Ladder::new();
        Vec::take(from, setting)?.into_iter().for_each(|step| ladder.push(step));
        Some(ladder)
    }
}
