//! What is learned about: a [`Space`] of states, the [`View`] that a policy has of a state, the [`Expert`] to be imitated, and
//! the [`Problem`] that holds them together.
//!
//! A state need not be `Clone`. Supervised training, forward training, SMILe, DAgger and AggreVaTe's single deviations only step forward and ask
//! the expert; whatever rolls out alternatives (SEARN, CPI, LOLS) or searches with a beam demands `State: Clone`, because a reset *is* a clone. The main practical argument of Ross
//! & Bagnell (2010, section 4), that SMILe needs no resets, is thereby checked by the compiler:
//!
//! ```compile_fail,E0277
//! use rollin::learner::Perceptron;
//! use rollin::space::{Imitation, doc::{Follow, RealWorld}};
//! use rollin::trainer::{Run, Searn};
//!
//! // A `RealWorld`'s state cannot be cloned: nobody can put a car back to where it was a second ago.
//! let problem = Imitation { space: RealWorld, expert: Follow, episodes: 10 };
//! Searn::default().train(&problem, &Perceptron::default(), &Run::new(1)); // error: `Moment: Clone` is not satisfied
//! ```
//!
//! With SMILe in SEARN's place the same program compiles:
//!
//! ```
//! use rollin::learner::Perceptron;
//! use rollin::space::{Imitation, doc::{Follow, RealWorld}};
//! use rollin::trainer::{Run, Smile};
//!
//! let problem = Imitation { space: RealWorld, expert: Follow, episodes: 10 };
//! let trained = Smile::default().train(&problem, &Perceptron::default(), &Run::new(1))?;
//! assert_eq!(trained.ledger.resets, 0);
//! # Ok::<(), rollin::Error>(())
//! ```

mod actions;
mod dense;
pub mod doc;
pub mod experts;
mod features;
mod marathon;
mod stacked;

pub use actions::{Action, Actions};
pub(crate) use dense::DenseRows;
pub use dense::{Dense, Width};
pub(crate) use features::StoredFeatures;
pub use features::{FeatureTable, Features, Listed, NO_ROW};
pub use marathon::Marathon;
pub(crate) use marathon::Runner;
pub use stacked::{Second, Stacked};

use crate::seed::Seed;

/// One run through a space, from a start to the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Episode {
    /// Which one, from 0: the sentence of a corpus, the level of a game.
    pub index: usize,
    /// Everything random in it hangs below this node.
    pub seed: Seed,
}

/// A system in which decisions are made one after the other: a sentence that is tagged, a car that is steered.
pub trait Space: Sync {
    /// Where a run stands. What needs resets asks for `State: Clone` in its own signature.
    type State;
    /// What a policy may see of a state.
    type View: View;

    /// The state at which `episode` starts.
    fn start(&self, episode: Episode) -> Self::State;

    /// The actions that are legal in `state`; none when the episode is over.
    fn legal<'a>(&'a self, state: &'a Self::State) -> Actions<'a>;

    /// Writes what a policy may see of `state` into `view`, whatever stood there before.
    fn look(&self, state: &Self::State, view: &mut Self::View);

    /// Writes into `view` what little can be told of `state` at once, if that may be enough to decide by; returns whether it did. Of [`Features`] that is
    /// the row and the key, as [`Space::look`] writes them. `false` is always right.
    fn glance(&self, state: &Self::State, view: &mut Self::View) -> bool {
        let _ = (state, view);
        false
    }

    /// Takes `action`, which is legal in `state`, and returns its immediate cost C(s,a). Whatever is random hangs below `seed`.
    fn step(&self, state: &mut Self::State, action: Action, seed: Seed) -> f64;

    /// How many actions there are; every legal action is below it.
    fn actions(&self) -> usize;

    /// How many steps the episode numbered `index` has, where that is known before it is run.
    fn horizon(&self, index: usize) -> Option<usize> {
        let _ = index;
        None
    }

    /// A number that tells `state` apart from all states of the same step of the same episode whose future may differ: states with equal
    /// signatures have equal views, legal actions, expert's answers and, under the same randomness, equal futures. `None`, where there is
    /// no such number, is always right; roll-outs then remember nothing.
    fn signature(&self, state: &Self::State) -> Option<u64> {
        let _ = state;
        None
    }

    /// Whether the space is a trellis: whether at the same step of the same episode, under the same randomness, an action costs the same in all states in which it is legal and leads to
    /// states of the same signature, and of the states of a step all are over or none. Roll-outs then know where an action leads that was taken at that step before. `false` is always
    /// right.
    fn is_trellis(&self) -> bool {
        false
    }

    /// What all views of this space share, such as the static features of a corpus.
    fn shared(&self) -> &<Self::View as View>::Shared;
}

/// What a policy may see of a state, in a form that a worker reuses from state to state.
pub trait View: Default + Send {
    /// What all views of a space have in common and refer to.
    type Shared: Sync;
    /// A collection of remembered views: what a learner learns from.
    type Store: Store<Self>;
}

/// Everything that a policy can see of a state.
pub struct Sight<'a, V: View> {
    /// What all views of the space share.
    pub shared: &'a V::Shared,
    /// The view of the state.
    pub view: &'a V,
    /// The actions that are legal there.
    pub legal: Actions<'a>,
}

/// States of the same step of the same run, of each of which as much can be seen as is told [at a glance](Space::glance).
pub struct Front<'a, V: View> {
    /// What all views of the space share.
    pub shared: &'a V::Shared,
    /// The node of the seed tree that belongs to the step.
    pub seed: Seed,
    views: &'a [V],
    legal: &'a [Actions<'a>],
}

impl<'a, V: View> Front<'a, V> {
    /// The states of these `views`, in which these actions are `legal`.
    pub(crate) fn new(shared: &'a V::Shared, seed: Seed, views: &'a [V], legal: &'a [Actions<'a>]) -> Self {
        Front { shared, seed, views, legal }
    }

    /// What can be seen of each of them.
    pub fn sights(&self) -> impl ExactSizeIterator<Item = Sight<'a, V>> + '_ {
        let sight = |(view, legal): (&'a V, &Actions<'a>)| Sight { shared: self.shared, view, legal: *legal };
        self.views.iter().zip(self.legal).map(sight)
    }
}

/// A collection of views.
pub trait Store<V>: Gather + Sync {
    /// Remembers `view`, which becomes the last.
    fn push(&mut self, view: &V);
    /// Writes view number `i` into `view`, whatever stood there before.
    fn recall(&self, i: usize, view: &mut V);
    /// Appends a copy of all of `other`.
    fn extend_from(&mut self, other: &Self);
    /// How many views there are.
    fn len(&self) -> usize;
    /// Whether there is none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Something that is gathered piece by piece, in order.
pub trait Gather: Default + Send {
    /// Appends all of `later`, in its order, after all that is here.
    fn absorb(&mut self, later: Self);
}

impl Gather for () {
    fn absorb(&mut self, (): ()) {}
}

impl<T: Send> Gather for Vec<T> {
    fn absorb(&mut self, mut later: Self) {
        if self.is_empty() {
            *self = later;
        } else {
            self.append(&mut later);
        }
    }
}

/// The one to be imitated.
pub trait Expert<S: Space>: Sync {
    /// What the expert does in the state at hand: the best action that is legal *there*, also after mistakes that it would
    /// never have made itself. `None` where it has nothing to say.
    fn action(&self, space: &S, state: &S::State) -> Option<Action>;

    /// The answer that an expert gives whose answers are random: what is drawn hangs below `seed`, the node of this step of this run. This
    /// is what a [`Visit`](crate::worker::Visit) asks; all others answer as [`Expert::action`] does.
    fn answer(&self, space: &S, state: &S::State, seed: Seed) -> Option<Action> {
        let _ = seed;
        self.action(space, state)
    }

    /// What roll-outs of the expert come to, where that is known without a trial: writes the cost from here to the end, for each legal action in
    /// order, when it is taken now and the expert acts ever after, and gives the number of steps from here to the end, of all of them together, none of
    /// which the expert is silent at. Costs must be those of the trials to the bit. `None`, and anything in `costs`, is always right.
    fn foresee(&self, space: &S, state: &S::State, costs: &mut Vec<f64>) -> Option<u64> {
        let _ = (space, state, costs);
        None
    }
}

/// An expert whose cost-to-go is known.
pub trait CostToGo<S: Space>: Expert<S> {
    /// Writes the cost from here to the end, for each legal action in order, when it is taken now and the expert acts ever after.
    fn costs(&self, space: &S, state: &S::State, costs: &mut Vec<f64>);
}

/// The expert who never answers: for policies that act on their own.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl<S: Space> Expert<S> for Silent {
    fn action(&self, _: &S, _: &S::State) -> Option<Action> {
        None
    }
}

/// A space, the expert in it and the episodes to learn from: what a trainer is given.
pub trait Problem: Sync {
    /// Its space.
    type Space: Space;
    /// Its expert.
    type Expert: Expert<Self::Space>;
    /// The space.
    fn space(&self) -> &Self::Space;
    /// The expert.
    fn expert(&self) -> &Self::Expert;
    /// How many episodes make a round.
    fn episodes(&self) -> usize;
}

/// The state of a problem's space.
pub type StateOf<P> = <<P as Problem>::Space as Space>::State;
/// The view of a problem's space.
pub type ViewOf<P> = <<P as Problem>::Space as Space>::View;
/// What the views of a problem's space share.
pub type SharedOf<P> = <ViewOf<P> as View>::Shared;

/// The plain [`Problem`]: its three parts, side by side.
#[derive(Clone, Debug)]
pub struct Imitation<S, E> {
    /// The space.
    pub space: S,
    /// The expert.
    pub expert: E,
    /// How many episodes make a round.
    pub episodes: usize,
}

impl<S: Space, E: Expert<S>> Problem for Imitation<S, E> {
    type Space = S;
    type Expert = E;
    fn space(&self) -> &S {
        &self.space
    }
    fn expert(&self) -> &E {
        &self.expert
    }
    fn episodes(&self) -> usize {
        self.episodes
    }
}
