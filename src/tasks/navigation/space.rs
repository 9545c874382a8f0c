//! Navigation as a space.

use super::World;
use crate::seed::Seed;
use crate::space::{Action, Actions, CostToGo, Episode, Expert, FeatureTable, Features, Imitation, Space, Store, View};
use std::marker::PhantomData;

/// Navigation: an action takes an edge and costs what the edge costs, until the goal is reached. `V` is what a policy sees: a [`Place`] in
/// the world, for those who plan; or [`Features`], for classifiers.
///
/// No episode hangs: a trip's last step, at its horizon, also costs what is left of the cheapest way, as if the traveller were carried there.
/// So the cost-to-go of the expert is the same with a horizon and without, and no trip is cheaper than the cheapest way.
#[derive(Clone, Debug)]
pub struct Navigation<V = Place> {
    world: World,
    eyes: PhantomData<fn() -> V>,
}

/// Where a trip stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct At {
    /// Which trip.
    pub trip: u32,
    /// At which node.
    pub node: u32,
    /// After how many steps.
    pub t: u32,
}

/// A node and the goal that is to be reached from it; all else a planner finds in the [`World`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The number of the goal.
    pub goal: u32,
    /// The node.
    pub node: u32,
}

impl View for Place {
    type Shared = World;
    type Store = Vec<Place>;
}

impl Store<Place> for Vec<Place> {
    fn push(&mut self, view: &Place) {
        Vec::push(self, *view);
    }

    fn recall(&self, i: usize, view: &mut Place) {
        *view = self[i];
    }

    fn extend_from(&mut self, other: &Self) {
        self.extend_from_slice(other);
    }

    fn len(&self) -> usize {
        Vec::len(self)
    }
}

/// A way to look at a world.
pub trait Eyes: View {
    /// What all views share.
    fn shared(world: &World) -> &Self::Shared;
    /// Writes what is seen at `place`.
    fn look(&mut self, world: &World, place: Place);
}

impl Eyes for Place {
    fn shared(world: &World) -> &World {
        world
    }

    fn look(&mut self, _: &World, place: Place) {
        *self = place;
    }
}

/// The features of the node and of the edges out of it, alone and together with the direction of the goal.
impl Eyes for Features {
    fn shared(world: &World) -> &FeatureTable {
        world.table()
    }

    fn look(&mut self, world: &World, place: Place) {
        world.features(place.goal, place.node, self);
    }
}

impl<V: Eyes> Navigation<V> {
    /// Navigation in `world`.
    pub fn new(world: World) -> Self {
        Navigation { world, eyes: PhantomData }
    }

    /// The world.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The same world with other eyes.
    pub fn seen_as<W: Eyes>(self) -> Navigation<W> {
        Navigation::new(self.world)
    }

    /// The problem of imitating whoever takes the cheapest way, on all trips.
    pub fn problem(self) -> Imitation<Self, Cheapest> {
        let episodes = self.world.trips().len();
        Imitation { space: self, expert: Cheapest, episodes }
    }

    fn place(&self, state: &At) -> Place {
        Place { goal: self.world.goal(state.trip as usize), node: state.node }
    }
}

impl<V: Eyes> Space for Navigation<V> {
    type State = At;
    type View = V;

    fn start(&self, episode: Episode) -> At {
        At { trip: episode.index as u32, node: self.world.trips()[episode.index].start as u32, t: 0 }
    }

    fn legal<'a>(&'a self, state: &'a At) -> Actions<'a> {
        let (network, goal) = self.world.target(self.world.goal(state.trip as usize));
        let over = state.node == goal || state.t as usize >= self.world.trips()[state.trip as usize].horizon;
        if over { Actions::NONE } else { Actions::Only(network.actions(state.node)) }
    }

    fn look(&self, state: &At, view: &mut V) {
        view.look(&self.world, self.place(state));
    }

    fn step(&self, state: &mut At, action: Action, _: Seed) -> f64 {
        let goal = self.world.goal(state.trip as usize);
        let (network, _) = self.world.target(goal);
        let Some(edge) = network.edge(state.node, action) else { return 0.0 };
        state.node = network.head(edge);
        state.t += 1;
        let late = state.t as usize >= self.world.trips()[state.trip as usize].horizon;
        let rest = if late { self.world.cheapest(goal).value(state.node) } else { 0.0 };
        network.cost(edge) + rest
    }

    fn actions(&self) -> usize {
        self.world.legend().actions
    }

    fn signature(&self, state: &At) -> Option<u64> {
        Some(u64::from(state.node))
    }

    fn shared(&self) -> &V::Shared {
        V::shared(&self.world)
    }
}

/// The expert who knows what edges cost and takes the cheapest way: of equals that with the fewest edges, then the lowest action.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cheapest;

impl<V: Eyes> Expert<Navigation<V>> for Cheapest {
    fn action(&self, space: &Navigation<V>, state: &At) -> Option<Action> {
        let goal = space.world.goal(state.trip as usize);
        let edge = space.world.cheapest(goal).next(state.node)?;
        Some(space.world.target(goal).0.action(edge))
    }
}

impl<V: Eyes> CostToGo<Navigation<V>> for Cheapest {
    fn costs(&self, space: &Navigation<V>, state: &At, costs: &mut Vec<f64>) {
        let goal = space.world.goal(state.trip as usize);
        let ((network, _), plan) = (space.world.target(goal), space.world.cheapest(goal));
        costs.clear();
        costs.extend(network.out(state.node).map(|edge| network.cost(edge) + plan.value(network.head(edge))));
    }
}
