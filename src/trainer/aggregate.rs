//! What trainers know that learn anew from all they have seen, after each round.

use crate::error::{Error, Result};
use crate::learner::{Examples, Kept, Setting};
use crate::output::Arrays;
use crate::policy::{Greedy, Mixture};
use crate::space::View;

/// The examples of all rounds so far, and what was learned from them: what [`Supervised`](super::Supervised), [`Dagger`](super::Dagger),
/// [`Aggrevate`](super::Aggrevate) and [`Lols`](super::Lols) know after a round.
pub struct Aggregate<V: View, C> {
    /// D: the examples.
    pub(super) examples: Examples<V>,
    /// pihat, once there is one.
    pub(super) learned: Option<C>,
}

impl<V: View, C> Default for Aggregate<V, C> {
    fn default() -> Self {
        Aggregate { examples: Examples::default(), learned: None }
    }
}

impl<V: View, C> Aggregate<V, C> {
    /// pi_i = beta_i pi* + (1-beta_i) pihat_i with `share` for beta_i; pi* where nothing was learned yet.
    pub(super) fn policy(&self, share: f64) -> Mixture<&C> {
        self.learned.as_ref().map_or_else(Mixture::of_expert, |learned| Mixture::shared(share, learned))
    }

    /// What was learned last.
    ///
    /// # Errors
    /// When there was no round.
    pub(super) fn finish(self) -> Result<Greedy<C>> {
        self.learned.map(Greedy).ok_or_else(|| Error::argument("rounds", 0, "at least 1"))
    }
}

impl<V: View<Store: Kept<V>>, C: Kept<V>> Kept<V> for Aggregate<V, C> {
    fn put(&self, to: &mut Vec<u8>) {
        self.examples.put(to);
        self.learned.put(to);
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        let (examples, learned) = Kept::take(from, setting)?;
        Some(Aggregate { examples, learned })
    }
}
