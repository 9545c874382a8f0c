//! Rows of weights as bytes.

use super::{Columns, Linear, Weights};
use crate::output::Arrays;

/// Appends the numbers of the features that have weights, ascending, then their rows.
pub(crate) fn put_rows(weights: &Weights, bytes: &mut Vec<u8>) {
    put_rows_of(weights, 0..weights.features() as u32, bytes);
}

/// The same for those of `features`, each of them once, in their order.
pub(crate) fn put_rows_of(weights: &Weights, features: impl Iterator<Item = u32> + Clone, bytes: &mut Vec<u8>) {
    let with_weights = || features.clone().filter_map(|f| weights.row(f).map(|row| (f, row)));
    bytes.extend(with_weights().flat_map(|(feature, _)| feature.to_le_bytes()));
    for (_, row) in with_weights() {
        let at = bytes.len();
        bytes.resize(at + 4 * weights.columns(), 0);
        bytes[at..].as_chunks_mut().0.iter_mut().zip(row).for_each(|(to, w)| *to = w.to_le_bytes());
    }
}

/// Reads one classifier: the numbers of its features, then their rows, which are made in this order.
pub(crate) fn take_rows(
    (actions, features): (usize, usize),
    columns: Columns,
    count: usize,
    arrays: &mut Arrays<'_>,
) -> Result<Linear, &'static str> {
    let width = columns.count(actions);
    let numbers = arrays.take::<4>(count).ok_or("it ends within a list of features")?;
    let all = width.checked_mul(count).ok_or("a classifier is too large")?;
    let values = arrays.take::<4>(all).ok_or("it ends within a classifier's weights")?;
    let mut weights = Weights::new(features, width);
    weights.reserve(count);
    for (i, number) in numbers.iter().enumerate() {
        let feature = u32::from_le_bytes(*number);
        if feature as usize >= features || weights.row(feature).is_some() {
            return Err("a feature with weights does not exist or stands twice");
        }
        let row = values[i * width..(i + 1) * width].iter();
        weights.row_mut(feature).iter_mut().zip(row).for_each(|(w, value)| *w = f32::from_le_bytes(*value));
    }
    Ok(Linear { actions, columns, weights })
}
