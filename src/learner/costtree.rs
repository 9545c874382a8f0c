//! Cost-sensitive decision trees over binary features.

use super::dual::Batch;
use super::{Examples, Learner, Setting, reduce};
use crate::policy::{self, Node};
use crate::seed::Seed;
use crate::space::Features;
use serde::{Deserialize, Serialize};

/// A cost-sensitive decision tree over binary features, grown from the root: a leaf predicts the mean cost of every action, and each split is the
/// one after which the costs lie closest to the means of their leaves, in squared distance, as in regression trees (Breiman et al. 1984, chapter 8);
/// with labels this is the Gini criterion. Of equally good splits the lowest feature's is taken.
///
/// An action counts where it is legal; one that is legal nowhere below a node has the mean of the node above. Nothing in it is random, and a
/// classifier to start from is not used.
///
/// ```
/// use rollin::learner::CostTree;
/// use rollin::space::{Imitation, doc::{Follow, RealWorld}};
/// use rollin::trainer::{Dagger, Run};
///
/// let problem = Imitation { space: RealWorld, expert: Follow, episodes: 20 };
/// let trained = Dagger::default().train(&problem, &CostTree { depth: 3, ..CostTree::default() }, &Run::new(1))?;
/// assert!(trained.policy.0.leaves() <= 8);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CostTree {
    /// How many splits lie between the root and a leaf at most.
    pub depth: usize,
    /// The fewest examples a leaf may have.
    pub leaf: usize,
}

impl Default for CostTree {
    fn default() -> Self {
        CostTree { depth: 20, leaf: 2 }
    }
}

/// Sums over examples, for each action: the costs, and in how many examples it was legal.
type Sums = [f64; 2];

/// The sum of squares that the means of these sums explain.
fn explained(sums: impl Iterator<Item = Sums>) -> f64 {
    sums.filter(|[_, n]| *n > 0.0).map(|[cost, n]| cost * cost / n).sum()
}

/// What a split has to gain at least, so that no rounding makes one.
const LEAST: f64 = 1e-9;

/// A tree that grows.
struct Growth<'a> {
    batch: Batch<'a>,
    actions: usize,
    /// `costs[example, action]`; not a number where it is not legal.
    costs: Vec<f32>,
    /// For each feature the place of its sums among those of the node at hand, 0 where it was not met there.
    places: Vec<u32>,
}

/// A node that waits to be grown: its number, its examples, its distance from the root, the means of the node above.
struct Bud {
    node: usize,
    examples: Vec<u32>,
    depth: usize,
    means: Vec<f64>,
}

impl Growth<'_> {
    /// Adds example `n` to `sums`.
    fn add(&self, n: u32, sums: &mut [Sums]) {
        let n = n as usize;
        let (_, count) = self.batch.example(n);
        for (sum, cost) in sums.iter_mut().zip(&self.costs[n * self.actions..]).filter(|(_, cost)| !cost.is_nan()) {
            sum[0] += f64::from(count) * f64::from(*cost);
            sum[1] += f64::from(count);
        }
    }

    fn weight(&self, examples: &[u32]) -> f64 {
        examples.iter().map(|n| f64::from(self.batch.example(*n as usize).1)).sum()
    }

    fn has(&self, n: u32, feature: u32) -> bool {
        self.batch.features(n as usize).iter().any(|other| other == feature)
    }

    /// The feature that splits `examples`, whose sums are `all`, best, if one splits them at all.
    fn split(&mut self, examples: &[u32], all: &[Sums]) -> Option<u32> {
        let mut met = Vec::new();
        let mut sums: Vec<Sums> = Vec::new();
        for &n in examples {
            for feature in self.batch.features(n as usize).iter() {
                if self.places[feature as usize] == 0 {
                    met.push(feature);
                    self.places[feature as usize] = met.len() as u32;
                    sums.resize(met.len() * self.actions, [0.0; 2]);
                }
                let place = self.places[feature as usize] as usize - 1;
                self.add(n, &mut sums[place * self.actions..][..self.actions]);
            }
        }
        met.iter().for_each(|feature| self.places[*feature as usize] = 0);
        let without = explained(all.iter().copied());
        let mut best = (LEAST * (1.0 + without), None);
        for (feature, present) in met.iter().zip(sums.chunks_exact(self.actions)) {
            let absent = all.iter().zip(present).map(|(all, here)| [all[0] - here[0], all[1] - here[1]]);
            let gain = explained(present.iter().copied()) + explained(absent) - without;
            if gain > best.0 || (gain == best.0 && best.1.is_some_and(|known| feature < known)) {
                best = (gain, Some(feature));
            }
        }
        best.1.copied()
    }

    fn grow(mut self, settings: &CostTree) -> policy::Tree {
        let k = self.actions;
        let mut tree = policy::Tree { nodes: vec![Node::Leaf(0)], scores: Vec::new(), actions: k };
        let mut leaves = 0;
        let all = (0..self.batch.len() as u32).collect();
        // What was legal nowhere is taken for the dearest.
        let dearest = self.costs.iter().copied().fold(0.0, f32::max);
        let mut buds = vec![Bud { node: 0, examples: all, depth: 0, means: vec![f64::from(dearest); k] }];
        while let Some(bud) = buds.pop() {
            let mut sums = vec![[0.0; 2]; k];
            bud.examples.iter().for_each(|n| self.add(*n, &mut sums));
            let mean = |([cost, n], above): (&Sums, &f64)| if *n > 0.0 { cost / n } else { *above };
            let means: Vec<f64> = sums.iter().zip(&bud.means).map(mean).collect();
            let feature = if bud.depth < settings.depth { self.split(&bud.examples, &sums) } else { None };
            let halves = feature.map(|feature| {
                let (present, absent): (Vec<u32>, _) = bud.examples.iter().partition(|n| self.has(**n, feature));
                (feature, absent, present)
            });
            let large = |examples: &[u32]| self.weight(examples) >= settings.leaf.max(1) as f64;
            match halves.filter(|(_, absent, present)| large(absent) && large(present)) {
                Some((feature, absent, present)) => {
                    let next = tree.nodes.len();
                    tree.nodes[bud.node] = Node::Split { feature, absent: next as u32, present: next as u32 + 1 };
                    tree.nodes.extend([Node::Leaf(0); 2]);
                    for (node, examples) in [(next + 1, present), (next, absent)] {
                        buds.push(Bud { node, examples, depth: bud.depth + 1, means: means.clone() });
                    }
                }
                None => {
                    tree.nodes[bud.node] = Node::Leaf(leaves);
                    leaves += 1;
                    tree.scores.extend(means.iter().map(|mean| -*mean as f32));
                }
            }
        }
        tree
    }
}

impl Learner<Features> for CostTree {
    type Classifier = policy::Tree;

    fn fit(
        &self,
        setting: Setting<'_, Features>,
        examples: &Examples<Features>,
        _: Option<&policy::Tree>,
        _: Seed,
    ) -> policy::Tree {
        let k = setting.actions;
        let batch = Batch::of(setting, examples);
        let mut costs = vec![f32::NAN; batch.len() * k];
        let mut scratch = Vec::new();
        for n in 0..batch.len() {
            let (i, _) = batch.example(n);
            reduce::as_costs(examples.target(i), examples.legal(i), &mut scratch);
            for (action, cost) in examples.legal(i).iter().zip(&scratch) {
                costs[n * k + action.index()] = *cost;
            }
        }
        Growth { batch, actions: k, costs, places: vec![0; setting.shared.features()] }.grow(self)
    }
}
