//! A linear classifier in the making, as a checkpoint holds it.

use super::{BLOCK, Block, Course};
use crate::learner::kept::{MOST_COUNTED, put_linear, take_columns, take_weights};
use crate::learner::{Kept, Setting};
use crate::output::Arrays;
use crate::policy::Linear;
use crate::space::Features;

impl Kept<Features> for Course {
    fn put(&self, to: &mut Vec<u8>) {
        put_linear(self.columns, &self.weights, to);
        Kept::<Features>::put(&self.seen, to);
        // Row after row as the weights, whose order is kept, too.
        Kept::<Features>::put(&self.beside.len(), to);
        self.beside.iter().flatten().for_each(|number| Kept::<Features>::put(number, to));
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, Features>) -> Option<Self> {
        let columns = take_columns(from, setting)?;
        let Linear { actions, mut weights, .. } = take_weights(from, setting, setting.actions, columns)?;
        weights.measure(setting.shared);
        let (seen, count) = <(u64, usize)>::take(from, setting)?;
        if seen > MOST_COUNTED {
            return None;
        }
        let numbers = from.take::<4>(count.checked_mul(BLOCK)?)?;
        let block = |numbers: &[[u8; 4]; BLOCK]| -> Block { numbers.map(f32::from_le_bytes) };
        let beside = numbers.as_chunks::<BLOCK>().0.iter().map(block).collect();
        Some(Course { beside, seen, ..Course::of(actions, columns, weights) })
    }

    fn follows(&self, start: &Self) -> bool {
        self.columns == start.columns
    }
}
