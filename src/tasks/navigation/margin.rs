//! Maximum margin planning (Ratliff, Bagnell & Zinkevich 2006): inverse optimal control as a learner.

use super::plan::Plan;
use super::{Network, Place, World};
use crate::learner::{Examples, Learner, Setting, Target, reduce};
use crate::policy::Classifier;
use crate::seed::Seed;
use crate::space::Sight;
use rand::seq::SliceRandom;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What an edge costs a planner before anything is learned of its features; the largest margin, so that no edge is ever cheaper than nothing.
const STEP: f64 = 1.0;

/// A classifier that plans: an edge costs 1 and the weights w of its features, none of them negative, and the score of an action is how much
/// less the way through its edge costs than the cheapest way to the goal. That is minus (edge cost + planned cost-to-go) up to
/// what all actions of a state have in common, so that mixtures can take means; the best action has score 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Planner {
    /// w: one weight for each feature of edges, not negative; features beyond them add nothing.
    pub weights: Vec<f64>,
}

impl Planner {
    /// What `edge` costs, in the planner's opinion.
    #[inline]
    pub fn cost(&self, network: &Network, edge: usize) -> f64 {
        let weight = |feature: &u32| self.weights.get(*feature as usize).copied().unwrap_or(0.0);
        network.features(edge).iter().fold(STEP, |sum, feature| sum + weight(feature)).max(0.0)
    }
}

/// A thread's scratch for a planner: the ways to the goal that was asked for last. It serves for one world.
#[derive(Debug, Default)]
pub struct PlannerMemory {
    goal: Option<u32>,
    plan: Plan,
    scores: Vec<f32>,
}

impl Classifier<Place> for Planner {
    type Memory = PlannerMemory;

    fn scores<'m>(&self, sight: &Sight<'_, Place>, memory: &'m mut PlannerMemory) -> &'m [f32] {
        let (world, Place { goal, node }) = (sight.shared, *sight.view);
        let (network, end) = world.target(goal);
        if memory.goal != Some(goal) {
            memory.plan.towards(network, end, |edge| self.cost(network, edge));
            memory.goal = Some(goal);
        }
        memory.scores.clear();
        memory.scores.resize(world.legend().actions, 0.0);
        for edge in network.out(node) {
            let through = self.cost(network, edge) + memory.plan.value(network.head(edge));
            memory.scores[network.action(edge).index()] = (memory.plan.value(node) - through) as f32;
        }
        &memory.scores
    }
}

/// Learns what edges cost a planner from what an expert does, such that the planner does as the expert: a linear cost map, where the expert's way
/// has to be cheaper than any other by a margin that grows with how much the other differs.
///
/// The objective is Ratliff, Bagnell & Zinkevich's (2006, section 3): the mean over the examples of w·F(demonstration) - min over all ways
/// of (w·F(way) - loss(way)), plus l2/2 |w|². F sums the features of a way's edges. The loss is `margin` for each state of the way at which the
/// expert said that it does something else. A pass goes through the goals in random order: with all examples of one goal together, a
/// plan at the loss-augmented costs gives the minimum for every state, the difference of the two F is a subgradient (section 3.2), and
/// weights that would be negative become 0 (their projection). Each weight has its own rate (AdaGrad), and the average over all
/// steps is what is learned.
///
/// Here an example is a state with its label, as trainers bring them, and not a whole way. The demonstration from a state follows the labels
/// for the same goal as far as they go, the last of several for one state, and from there the way that the planner thinks cheapest. Where the
/// expert drove all of the episode, labels go all the way, and the objective is the paper's, convex in w; where a learner strayed, the rest
/// of the way is latent.
///
/// ```
/// use rollin::tasks::navigation::{Maps, MaximumMargin, Navigation};
/// use rollin::trainer::{Run, Smile};
///
/// let maps = Maps { width: 8, height: 8, ..Maps::default() };
/// let seed = rollin::Seed::new(1);
/// let space = Navigation::new(maps.world(&maps.grids(10, seed)?, seed)?);
/// let smile = Smile { alpha: 0.5, rounds: 2, ..Smile::default() };
/// let trained = smile.train(&space.problem(), &MaximumMargin::default(), &Run::new(1))?;
/// assert!(trained.policy.members()[0].1.weights.iter().all(|w| *w >= 0.0));
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MaximumMargin {
    /// Passes over the goals.
    pub passes: usize,
    /// AdaGrad's rate, in units of cost where a step costs 1.
    pub rate: f64,
    /// The weight of half the squared norm.
    pub l2: f64,
    /// The margin that a state at which the way differs is worth: from 0 to 1, the cost of a step; what is beyond is taken for the nearest.
    pub margin: f64,
}

impl Default for MaximumMargin {
    fn default() -> Self {
        MaximumMargin { passes: 30, rate: 0.5, l2: 1e-4, margin: 1.0 }
    }
}

/// What the expert said on the ways to one goal.
struct Lesson {
    goal: u32,
    /// Where, the edge that it takes there, and how much it matters.
    labels: Vec<(u32, usize, f64)>,
}

/// The examples by goal; those of which nothing can be learned only show the way.
fn lessons(world: &World, examples: &Examples<Place>) -> Vec<Lesson> {
    let mut goals: BTreeMap<u32, Vec<(u32, usize, f64)>> = BTreeMap::new();
    for (i, place) in examples.views().iter().enumerate() {
        let (label, importance) = reduce::as_label(examples.target(i), examples.legal(i));
        let indifferent = importance == 0.0 && matches!(examples.target(i), Target::Costs(_));
        if let Some(edge) = world.target(place.goal).0.edge(place.node, label).filter(|_| !indifferent) {
            goals.entry(place.goal).or_default().push((place.node, edge, f64::from(importance)));
        }
    }
    goals.into_iter().map(|(goal, labels)| Lesson { goal, labels }).collect()
}

/// A planner in the making.
struct Course<'a> {
    how: &'a MaximumMargin,
    planner: Planner,
    /// The sum of each weight's changes times when they came, and of its squared gradients.
    late: Vec<f64>,
    squares: Vec<f64>,
    seen: f64,
    gradient: Vec<f64>,
    /// The edge that the expert takes at a node, for the lesson at hand.
    said: Vec<Option<usize>>,
    plan: Plan,
    tempted: Plan,
}

impl<'a> Course<'a> {
    fn begin(how: &'a MaximumMargin, world: &World, warm: Option<&Planner>) -> Self {
        let roads = world.legend().roads;
        // Weights begin at the cost of a step: features of which nothing is learned are neither cheap nor dear.
        let mut weights = vec![STEP; roads];
        weights.iter_mut().zip(warm.iter().flat_map(|planner| &planner.weights)).for_each(|(w, old)| *w = *old);
        Course {
            how,
            planner: Planner { weights },
            late: vec![0.0; roads],
            squares: vec![0.0; roads],
            seen: 0.0,
            gradient: vec![0.0; roads],
            said: Vec::new(),
            plan: Plan::default(),
            tempted: Plan::default(),
        }
    }

    fn study(&mut self, world: &World, lesson: &Lesson) {
        let (network, goal) = world.target(lesson.goal);
        self.said.clear();
        self.said.resize(network.nodes(), None);
        lesson.labels.iter().for_each(|(node, edge, _)| self.said[*node as usize] = Some(*edge));
        let (planner, said, margin) = (&self.planner, &self.said, self.how.margin.clamp(0.0, STEP));
        self.plan.towards(network, goal, |edge| planner.cost(network, edge));
        self.tempted.towards(network, goal, |edge| {
            let differs = said[network.tail(edge) as usize].is_some_and(|right| right != edge);
            planner.cost(network, edge) - if differs { margin } else { 0.0 }
        });
        self.gradient.fill(0.0);
        let total: f64 = lesson.labels.iter().map(|(_, _, importance)| importance).sum();
        for (node, _, importance) in lesson.labels.iter().filter(|(_, _, importance)| *importance > 0.0) {
            let share = importance / total;
            self.demonstrate(network, *node, lesson.labels.len(), share);
            for edge in self.tempted.way(network, *node) {
                add(&mut self.gradient, network, edge, -share);
            }
        }
        self.descend();
    }

    /// Adds the features of the demonstration from `node`; its labels number at most `longest`, or they go round in circles.
    fn demonstrate(&mut self, network: &Network, node: u32, longest: usize, share: f64) {
        let mut at = node;
        for _ in 0..longest {
            let Some(edge) = self.said[at as usize] else { break };
            add(&mut self.gradient, network, edge, share);
            at = network.head(edge);
        }
        for edge in self.plan.way(network, at) {
            add(&mut self.gradient, network, edge, share);
        }
    }

    fn descend(&mut self) {
        for (f, w) in self.planner.weights.iter_mut().enumerate().filter(|(f, _)| self.gradient[*f] != 0.0) {
            let g = self.gradient[f] + self.how.l2 * *w;
            self.squares[f] += g * g;
            let old = *w;
            *w = (old - self.how.rate * g / (self.squares[f].sqrt() + 1e-20)).max(0.0);
            self.late[f] += self.seen * (*w - old);
        }
        self.seen += 1.0;
    }

    fn finish(self) -> Planner {
        let seen = self.seen.max(1.0);
        // The average of what was never below 0, but for rounding.
        let average = |(w, late): (&f64, &f64)| (w - late / seen).max(0.0);
        Planner { weights: self.planner.weights.iter().zip(&self.late).map(average).collect() }
    }
}

fn add(gradient: &mut [f64], network: &Network, edge: usize, share: f64) {
    network.features(edge).iter().for_each(|feature| gradient[*feature as usize] += share);
}

impl Learner<Place> for MaximumMargin {
    type Classifier = Planner;

    fn fit(
        &self,
        setting: Setting<'_, Place>,
        examples: &Examples<Place>,
        warm: Option<&Planner>,
        seed: Seed,
    ) -> Planner {
        let mut lessons = lessons(setting.shared, examples);
        let mut course = Course::begin(self, setting.shared, warm);
        let mut rng = seed.rng();
        for _ in 0..self.passes {
            lessons.shuffle(&mut rng);
            lessons.iter().for_each(|lesson| course.study(setting.shared, lesson));
        }
        course.finish()
    }
}
