//! A space in which every state also shows what a first labeller said about the steps around it.

use super::{Action, Actions, CostToGo, Episode, Expert, FeatureTable, Features, Space};
use crate::seed::Seed;

/// The space `S` with further dynamic features: the actions that a first policy took at this step, and at those up to `window` before and
/// after it, when it ran through the same episode. Cohen & Carvalho's (2005) extended instances.
pub struct Stacked<'a, S> {
    space: &'a S,
    window: usize,
    /// Episode i's actions are `actions[starts[i]..starts[i+1]]`.
    starts: Vec<usize>,
    actions: Vec<Action>,
    table: FeatureTable,
}

/// A state, and what step of what episode it is.
#[derive(Clone, Debug)]
pub struct StackedState<T> {
    state: T,
    index: usize,
    t: usize,
}

impl<'a, S: Space<View = Features>> Stacked<'a, S> {
    /// `space`, where the first policy took `actions`, a list for each episode in order; of episodes beyond them nothing is
    /// known.
    pub fn new(space: &'a S, window: usize, actions: Vec<Vec<Action>>) -> Self {
        let mut starts = vec![0];
        starts.extend(actions.iter().scan(0, |end, list| {
            *end += list.len();
            Some(*end)
        }));
        let table = space.shared().widened(Self::more(space.actions(), window));
        Stacked { space, window, starts, actions: actions.concat(), table }
    }

    /// How many features come on top of the space's own: one a place and action, and one a place for "no such step".
    pub fn more(actions: usize, window: usize) -> usize {
        (2 * window + 1) * (actions + 1)
    }
}

impl<S: Space<View = Features>> Space for Stacked<'_, S> {
    type State = StackedState<S::State>;
    type View = Features;

    fn start(&self, episode: Episode) -> Self::State {
        StackedState { state: self.space.start(episode), index: episode.index, t: 0 }
    }

    fn legal<'a>(&'a self, state: &'a Self::State) -> Actions<'a> {
        self.space.legal(&state.state)
    }

    fn look(&self, state: &Self::State, view: &mut Features) {
        self.space.look(&state.state, view);
        let said = match self.starts.get(state.index..state.index + 2) {
            Some([start, end]) => &self.actions[*start..*end],
            _ => &[],
        };
        let (first, width) = (self.space.shared().features(), self.space.actions() + 1);
        view.dynamic.extend((0..2 * self.window + 1).map(|place| {
            let at = (state.t + place).checked_sub(self.window);
            let action = at.and_then(|at| said.get(at)).map_or(width - 1, |action| action.index());
            (first + place * width + action) as u32
        }));
    }

    fn step(&self, state: &mut Self::State, action: Action, seed: Seed) -> f64 {
        state.t += 1;
        self.space.step(&mut state.state, action, seed)
    }

    fn actions(&self) -> usize {
        self.space.actions()
    }

    fn horizon(&self, index: usize) -> Option<usize> {
        self.space.horizon(index)
    }

    /// The space's own: what was said is the same for all states of one step of one episode.
    fn signature(&self, state: &Self::State) -> Option<u64> {
        self.space.signature(&state.state)
    }

    fn shared(&self) -> &FeatureTable {
        &self.table
    }
}

/// The expert of a space as that of its [`Stacked`] one.
pub struct Second<'a, E>(pub &'a E);

impl<S: Space<View = Features>, E: Expert<S>> Expert<Stacked<'_, S>> for Second<'_, E> {
    fn action(&self, space: &Stacked<'_, S>, state: &StackedState<S::State>) -> Option<Action> {
        self.0.action(space.space, &state.state)
    }

    fn answer(&self, space: &Stacked<'_, S>, state: &StackedState<S::State>, seed: Seed) -> Option<Action> {
        self.0.answer(space.space, &state.state, seed)
    }
}

impl<S: Space<View = Features>, E: CostToGo<S>> CostToGo<Stacked<'_, S>> for Second<'_, E> {
    fn costs(&self, space: &Stacked<'_, S>, state: &StackedState<S::State>, costs: &mut Vec<f64>) {
        self.0.costs(space.space, &state.state, costs);
    }
}
