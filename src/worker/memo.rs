//! What is left of a run, remembered.

use super::Ledger;
use crate::seed::Seed;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// What roll-outs with the same randomness and the same policy found out about the states they passed: states of the same step and
/// the same [`signature`](crate::space::Space::signature) have the same future, so it need not be run twice.
///
/// Only the computing is saved: a remembered future is billed as if it had been run.
#[derive(Clone, Debug, Default)]
pub struct Memo {
    run: Option<Seed>,
    rests: HashMap<(usize, u64), Rest, BuildHasherDefault<Mixed>>,
}

/// What comes after a state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    pub cost: f64,
    pub bill: Ledger,
}

impl Memo {
    /// Forgets everything unless it belongs to `run`.
    pub(super) fn belong_to(&mut self, run: Seed) {
        if self.run != Some(run) {
            self.run = Some(run);
            self.rests.clear();
        }
    }

    /// What is known to come after the state with this signature at step `t`.
    pub(super) fn find(&self, t: usize, signature: u64) -> Option<Rest> {
        self.rests.get(&(t, signature)).copied()
    }

    /// Remembers what comes after it.
    pub(super) fn keep(&mut self, t: usize, signature: u64, rest: Rest) {
        self.rests.insert((t, signature), rest);
    }
}

/// A quick hash of a step and a signature.
#[derive(Clone, Copy, Default)]
struct Mixed(u64);

impl Hasher for Mixed {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.write_u64(u64::from(*byte)));
    }
    fn write_u64(&mut self, n: u64) {
        self.0 = (self.0.rotate_left(23) ^ n).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
    fn write_usize(&mut self, n: usize) {
        self.write_u64(n as u64);
    }
}
