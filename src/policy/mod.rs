//! Those who act: the expert, a [`Classifier`] on its own ([`Greedy`]), a stochastic [`Mixture`] of classifiers and expert, a
//! [`Ladder`] with one classifier per step.

mod calibrated;
mod ladder;
mod linear;
mod mixture;
mod neural;
mod outputs;
mod rows;
mod tree;
mod value;
mod weights;

pub use calibrated::Calibrated;
pub use ladder::Ladder;
pub(crate) use linear::LinearMemory;
pub use linear::{Columns, Linear};
pub(crate) use linear::{best, tournament};
pub(crate) use mixture::MixtureMemory;
pub use mixture::{Member, Mixture, Reading};
pub(crate) use neural::NeuralMemory;
pub(crate) use neural::forward;
pub use neural::{Layer, Neural, Rows};
pub use outputs::Outputs;
pub(crate) use rows::{put_rows, put_rows_of, take_rows};
pub(crate) use tree::Node;
pub use tree::Tree;
pub use value::Valued;
pub(crate) use value::value_of;
pub use weights::Weights;
pub(crate) use weights::reserve_some;

use crate::seed::Seed;
use crate::space::{Action, Front, Problem, Sight, View, ViewOf};
use crate::worker::Visit;

/// Something that acts in a problem's space.
pub trait Policy<P: Problem>: Sync {
    /// Scratch that a thread keeps between steps, such as scores computed before. It must not change what the policy does, and belongs
    /// to this policy alone.
    type Memory: Default + Send;

    /// The action taken at `visit`. Whatever is random about it is keyed by the visit's seed.
    fn act(&self, visit: &mut Visit<'_, P>, memory: &mut Self::Memory) -> Action;

    /// Writes into `actions` what it does in each state of `front`, where that follows from a glance: the same as [`Policy::act`], nobody asked and
    /// nothing drawn but below the seed of the step. To leave a `None` as it is is always right.
    fn act_at_once(&self, front: &Front<'_, ViewOf<P>>, memory: &mut Self::Memory, actions: &mut [Option<Action>]) {
        let _ = (front, memory, actions);
    }

    /// Whether it is known to do always as the expert does. `false` is always right.
    fn is_expert(&self) -> bool {
        false
    }

    /// Whether it does as the expert does at the step of this seed, whatever the state is. `false` is always right.
    fn leaves_to_expert(&self, step: Seed, memory: &mut Self::Memory) -> bool {
        let _ = (step, memory);
        self.is_expert()
    }
}

/// A trained function from views to actions.
pub trait Classifier<V: View>: Send + Sync {
    /// Scratch that a thread keeps between calls; it belongs to this classifier alone.
    type Memory: Default + Send;

    /// One score per action of the space, higher is better; those of illegal actions mean nothing.
    fn scores<'m>(&self, sight: &Sight<'_, V>, memory: &'m mut Self::Memory) -> &'m [f32];

    /// The legal action with the highest score, the lowest of equals.
    fn choose(&self, sight: &Sight<'_, V>, memory: &mut Self::Memory) -> Action {
        sight.legal.best(self.scores(sight, memory))
    }

    /// What it would choose, where that follows from a [glance](crate::space::Space::glance) already, which is all that `sight` is. `None` is always
    /// right.
    fn choose_at_once(&self, sight: &Sight<'_, V>, memory: &mut Self::Memory) -> Option<Action> {
        let _ = (sight, memory);
        None
    }

    /// The same for all states of `front`, side by side in `actions`.
    fn choose_all_at_once(&self, front: &Front<'_, V>, memory: &mut Self::Memory, actions: &mut [Option<Action>]) {
        for (sight, action) in front.sights().zip(actions) {
            *action = self.choose_at_once(&sight, memory);
        }
    }
}

impl<V: View, C: Classifier<V>> Classifier<V> for &C {
    type Memory = C::Memory;
    fn scores<'m>(&self, sight: &Sight<'_, V>, memory: &'m mut Self::Memory) -> &'m [f32] {
        (**self).scores(sight, memory)
    }
    #[inline]
    fn choose(&self, sight: &Sight<'_, V>, memory: &mut Self::Memory) -> Action {
        (**self).choose(sight, memory)
    }
    #[inline]
    fn choose_at_once(&self, sight: &Sight<'_, V>, memory: &mut Self::Memory) -> Option<Action> {
        (**self).choose_at_once(sight, memory)
    }
    #[inline]
    fn choose_all_at_once(&self, front: &Front<'_, V>, memory: &mut Self::Memory, actions: &mut [Option<Action>]) {
        (**self).choose_all_at_once(front, memory, actions);
    }
}

/// What `classifier` chooses at `visit`, looking no closer than it must.
#[inline]
fn choose_at<P: Problem, C: Classifier<ViewOf<P>>>(
    classifier: &C,
    visit: &mut Visit<'_, P>,
    memory: &mut C::Memory,
) -> Action {
    let known = visit.glance().and_then(|sight| classifier.choose_at_once(&sight, memory));
    known.unwrap_or_else(|| classifier.choose(&visit.sight(), memory))
}

/// The policy that always does as the expert does.
#[derive(Clone, Copy, Debug, Default)]
pub struct Follow;

impl<P: Problem> Policy<P> for Follow {
    type Memory = ();
    fn act(&self, visit: &mut Visit<'_, P>, (): &mut ()) -> Action {
        visit.expert()
    }
    fn is_expert(&self) -> bool {
        true
    }
}

/// A classifier that acts on its own.
#[derive(Clone, Debug)]
pub struct Greedy<C>(pub C);

impl<P: Problem, C: Classifier<ViewOf<P>>> Policy<P> for Greedy<C> {
    type Memory = C::Memory;
    #[inline]
    fn act(&self, visit: &mut Visit<'_, P>, memory: &mut C::Memory) -> Action {
        choose_at(&self.0, visit, memory)
    }
    #[inline]
    fn act_at_once(&self, front: &Front<'_, ViewOf<P>>, memory: &mut C::Memory, actions: &mut [Option<Action>]) {
        self.0.choose_all_at_once(front, memory, actions);
    }
}
