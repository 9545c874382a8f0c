//! A net of one hidden layer, by backpropagation.

use super::inlet::{BESIDE, Inlet, Sensed};
use super::kept::{MOST_COUNTED, take_dense};
use super::{Examples, Kept, Learner, Online, Setting, Target, reduce};
use crate::output::Arrays;
use crate::policy::{Classifier, Layer, Neural, NeuralMemory, Outputs, forward};
use crate::seed::Seed;
use crate::space::{Action, Features, Sight};
use rand::seq::SliceRandom;
use serde::{Deserialize, Serialize};

/// How weights follow the mean gradient of a batch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Step {
    /// Each weight at its own rate (Duchi, Hazan & Singer 2011).
    Adagrad,
    /// Running means of the gradient and its square (Kingma & Ba 2015), 0.9 and 0.999 of each kept. Those of a feature move on only in batches in
    /// which it occurs.
    #[default]
    Adam,
}

/// A net of one hidden layer of sigmoid units ([`Neural`]) over sparse binary features or dense numbers, by backpropagation in small batches; its
/// loss is the logistic loss over the legal actions. A 0-1 learner. Without hidden units it is logistic regression.
///
/// The nets of Ross & Bagnell (2010, section 5) are 1296-32-15, `Net { units: 32, ..Net::default() }` over [`Dense`](crate::space::Dense), and
/// 27152-32-4, the same with [`Outputs::Bits`] over [`Features`], each stopped by [`CrossValidated`](super::CrossValidated).
///
/// What a unit first gives a feature is drawn evenly from ±1/√n, n the number of features of the example in which it first occurs. A classifier of
/// another shape to start from is not used.
///
/// ```
/// use rollin::learner::Net;
/// use rollin::space::{Imitation, doc::{Follow, RealWorld}};
/// use rollin::trainer::{Dagger, Run};
///
/// let problem = Imitation { space: RealWorld, expert: Follow, episodes: 20 };
/// let trained = Dagger::default().train(&problem, &Net { units: 8, ..Net::default() }, &Run::new(1))?;
/// assert_eq!(trained.policy.0.units(), 8);
/// # Ok::<(), rollin::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Net {
    /// Units of the hidden layer; with 0 there is none.
    pub units: usize,
    /// What the outputs are.
    pub outputs: Outputs,
    /// Passes over the examples.
    pub passes: usize,
    /// Examples a batch.
    pub batch: usize,
    /// The rate.
    pub rate: f32,
    /// How weights follow the gradient.
    pub step: Step,
}

impl Default for Net {
    fn default() -> Self {
        Net { units: 64, outputs: Outputs::Actions, passes: 10, batch: 16, rate: 0.005, step: Step::Adam }
    }
}

/// A net in the making.
#[derive(Clone, Debug)]
pub struct NetCourse<V: Sensed = Features> {
    seed: Seed,
    inlet: V::Inlet,
    /// What [`Neural`] has but for its input.
    dense: Vec<f32>,
    /// What is kept beside that.
    beside: Vec<f32>,
    actions: usize,
    coding: Outputs,
    hidden: usize,
    /// What goes into the units, then what they give; padded.
    units: Vec<f32>,
    outputs: Vec<f32>,
    scores: Vec<f32>,
    /// The slopes of the loss at the outputs.
    errors: Vec<f32>,
    /// Those at what goes into the units; padded.
    slopes: Vec<f32>,
    pending: usize,
    /// The number of the batch at hand, from 1.
    time: i32,
}

/// How many columns the input layer of a net has.
fn columns(units: usize, outputs: usize) -> usize {
    if units == 0 { outputs } else { units }
}

impl<V: Sensed> NetCourse<V> {
    /// A course that begins with these weights.
    fn of(inlet: V::Inlet, dense: Vec<f32>, (hidden, coding, actions): (usize, Outputs, usize)) -> Self {
        let outputs = coding.count(actions);
        NetCourse {
            seed: Seed::new(0),
            inlet,
            beside: vec![0.0; BESIDE * dense.len()],
            dense,
            actions,
            coding,
            hidden,
            units: Vec::new(),
            outputs: vec![0.0; outputs],
            scores: Vec::new(),
            errors: vec![0.0; outputs],
            slopes: Vec::new(),
            pending: 0,
            time: 1,
        }
    }

    /// What the net gives for what is seen at `sight`.
    fn score(&mut self, sight: &Sight<'_, V>) {
        self.inlet.meet(sight, self.seed);
        self.inlet.layer().clear(&mut self.units);
        self.inlet.layer().add(sight, &mut self.units);
        forward(&self.dense, self.hidden, &mut self.units, &mut self.outputs);
        self.coding.scores(self.actions, &self.outputs, &mut self.scores);
    }

    /// Adds the gradient of the example that was scored last to the batch's.
    fn backward(&mut self, sight: &Sight<'_, V>, target: Target<'_>) -> bool {
        let (label, importance) = reduce::as_label(target, sight.legal);
        if importance == 0.0 {
            return false;
        }
        let high = self.scores[sight.legal.best(&self.scores).index()];
        let total: f32 = sight.legal.iter().map(|a| (self.scores[a.index()] - high).exp()).sum();
        self.errors.fill(0.0);
        for action in sight.legal.iter() {
            let share = (self.scores[action.index()] - high).exp() / total;
            let slope = importance * (share - if action == label { 1.0 } else { 0.0 });
            self.coding.add_slope(action.index(), slope, &mut self.errors);
        }
        self.slopes.clear();
        self.slopes.resize(self.units.len(), 0.0);
        let (bias, rest) = self.beside[..self.dense.len()].split_at_mut(self.hidden);
        let (offsets, weights) = rest.split_at_mut(self.errors.len());
        offsets.iter_mut().zip(&self.errors).for_each(|(g, slope)| *g += slope);
        if self.hidden == 0 {
            self.slopes[..self.errors.len()].copy_from_slice(&self.errors);
        } else {
            let v = &self.dense[self.hidden + self.errors.len()..];
            let rows = weights.chunks_exact_mut(self.hidden).zip(v.chunks_exact(self.hidden));
            for ((g, v), error) in rows.zip(&self.errors).filter(|(_, error)| **error != 0.0) {
                g.iter_mut().zip(&self.units).for_each(|(g, h)| *g += error * h);
                self.slopes.iter_mut().zip(v).for_each(|(sum, v)| *sum += error * v);
            }
            for ((slope, h), g) in self.slopes.iter_mut().zip(&self.units).zip(bias) {
                *slope *= h * (1.0 - h);
                *g += *slope;
            }
        }
        self.inlet.learn(sight, &self.slopes);
        self.pending += 1;
        true
    }
}

impl Net {
    /// Changes the weights by the mean gradient of the batch, which begins anew.
    fn step<V: Sensed>(&self, course: &mut NetCourse<V>) {
        if course.pending == 0 {
            return;
        }
        let share = 1.0 / course.pending as f32;
        // Divided by once, multiplied with often.
        let (first, second) = (1.0 - 0.9f32.powi(course.time), 1.0 - 0.999f32.powi(course.time));
        let rates = (self.rate / first, 1.0 / second);
        course.inlet.step(|weights, beside| self.change((weights, beside), share, rates));
        self.change((&mut course.dense, &mut course.beside), share, rates);
        course.pending = 0;
        course.time = course.time.saturating_add(1);
    }

    /// Changes the weights `w` by what is kept `beside` them; the gradient counts `share` of itself and is zero after. For [`Step::Adam`] there are the
    /// rate and what squares are multiplied with, each for the bias of a mean that began at zero.
    fn change(&self, (w, beside): (&mut [f32], &mut [f32]), share: f32, (adam, second): (f32, f32)) {
        let width = w.len();
        let (g, rest) = beside.split_at_mut(width);
        let (means, squares) = rest.split_at_mut(width);
        let all = w.iter_mut().zip(g).zip(means).zip(squares);
        match self.step {
            Step::Adagrad => all.for_each(|(((w, g), _), square)| {
                let slope = share * std::mem::take(g);
                *square += slope * slope;
                *w -= self.rate * slope / (square.sqrt() + 1e-8);
            }),
            Step::Adam => all.for_each(|(((w, g), mean), square)| {
                let slope = share * std::mem::take(g);
                *mean += 0.1 * (slope - *mean);
                *square += 0.001 * (slope * slope - *square);
                *w -= adam * *mean / ((*square * second).sqrt() + 1e-8);
            }),
        }
    }
}

impl<V: Sensed> Kept<V> for NetCourse<V> {
    fn put(&self, to: &mut Vec<u8>) {
        Kept::<V>::put(&self.coding, to);
        Kept::<V>::put(&self.hidden, to);
        Kept::<V>::put(&self.dense, to);
        Kept::<V>::put(&self.beside, to);
        Kept::<V>::put(&(self.seed, (self.pending, self.time)), to);
        self.inlet.put(to);
    }

    fn take(from: &mut Arrays<'_>, setting: Setting<'_, V>) -> Option<Self> {
        let (coding, hidden, dense) = take_dense(from, setting)?;
        let (beside, (seed, (pending, time))) = <(Vec<f32>, _)>::take(from, setting)?;
        let actions = setting.actions;
        let inlet = V::Inlet::take(from, setting, columns(hidden, coding.count(actions)))?;
        let possible = beside.len() == BESIDE * dense.len() && pending <= MOST_COUNTED as usize;
        let course = NetCourse::of(inlet, dense, (hidden, coding, actions));
        possible.then_some(NetCourse { beside, seed, pending, time, ..course })
    }

    fn follows(&self, start: &Self) -> bool {
        (self.hidden, self.coding) == (start.hidden, start.coding)
    }
}

/// The weights as they are now; features not met so far count nothing.
impl<V: Sensed> Classifier<V> for NetCourse<V> {
    type Memory = NeuralMemory<<V::Layer as Layer<V>>::Memory>;

    fn scores<'m>(&self, sight: &Sight<'_, V>, memory: &'m mut Self::Memory) -> &'m [f32] {
        memory.scores(self.inlet.layer(), &self.dense, (self.hidden, self.coding, self.actions), sight)
    }
}

impl<V: Sensed> Learner<V> for Net {
    type Classifier = Neural<V::Layer>;

    fn fit(
        &self,
        setting: Setting<'_, V>,
        examples: &Examples<V>,
        warm: Option<&Self::Classifier>,
        seed: Seed,
    ) -> Self::Classifier {
        let mut course = self.begin(setting, warm);
        self.seed(&mut course, seed);
        let mut order: Vec<u32> = (0..examples.len() as u32).collect();
        let mut rng = seed.rng();
        for _ in 0..self.passes {
            order.shuffle(&mut rng);
            self.study_some(&mut course, setting, examples, &order);
        }
        self.finish(course)
    }
}

impl<V: Sensed> Online<V> for Net {
    type Course = NetCourse<V>;

    /// Without a seed of its own every course draws the same first weights.
    fn begin(&self, setting: Setting<'_, V>, warm: Option<&Self::Classifier>) -> NetCourse<V> {
        let (actions, outputs) = (setting.actions, self.outputs.count(setting.actions));
        let warm =
            warm.filter(|warm| warm.units == self.units && warm.actions == actions && warm.outputs == self.outputs);
        let mut dense = vec![0.0; Neural::<V::Layer>::size(self.units, outputs)];
        if let Some(warm) = warm {
            dense.copy_from_slice(&warm.dense);
        }
        let inlet = V::Inlet::begin(setting, columns(self.units, outputs), warm.map(|warm| &warm.input));
        NetCourse::of(inlet, dense, (self.units, self.outputs, actions))
    }

    fn learn(&self, course: &mut NetCourse<V>, sight: &Sight<'_, V>, target: Option<Target<'_>>) -> Action {
        course.score(sight);
        let choice = sight.legal.best(&course.scores);
        if let Some(target) = target
            && course.backward(sight, target)
            && course.pending >= self.batch
        {
            self.step(course);
        }
        choice
    }

    fn study(&self, course: &mut NetCourse<V>, setting: Setting<'_, V>, examples: &Examples<V>) {
        let order: Vec<u32> = (0..examples.len() as u32).collect();
        self.study_some(course, setting, examples, &order);
    }

    fn seed(&self, course: &mut NetCourse<V>, seed: Seed) {
        course.seed = seed;
    }

    fn finish(&self, mut course: NetCourse<V>) -> Neural<V::Layer> {
        self.step(&mut course);
        Neural {
            actions: course.actions,
            outputs: course.coding,
            units: course.hidden,
            input: course.inlet.finish(),
            dense: course.dense,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{Actions, Dense, FeatureTable, Width};

    /// How far the steps of a difference go.
    const STEP: f32 = 1e-2;

    /// The gradient of one example against differences of the loss, weight by weight: first those behind the hidden layer, then some of
    /// the input's, each found in the inlet, weight and gradient, by `at`.
    fn check<V: Sensed>(
        net: &Net,
        setting: Setting<'_, V>,
        view: &V,
        legal: Actions<'_>,
        places: &[(u32, usize)],
        at: impl Fn(&mut V::Inlet, (u32, usize)) -> (&mut f32, f32),
    ) -> NetCourse<V> {
        let sight = Sight { shared: setting.shared, view, legal };
        let costs: Vec<f32> = (0..legal.len()).map(|place| if place == 1 { 0.0 } else { 1.5 }).collect();
        let label = legal.nth(1).index();
        let mut course = net.begin(setting, None);
        course.dense.iter_mut().enumerate().for_each(|(i, w)| *w = (i as f32).sin());
        let loss = |course: &mut NetCourse<V>| {
            course.score(&sight);
            let total: f64 = legal.iter().map(|a| f64::from(course.scores[a.index()]).exp()).sum();
            1.5 * (total.ln() - f64::from(course.scores[label]))
        };
        loss(&mut course);
        assert!(course.backward(&sight, Target::Costs(&costs)));
        let near = |found: f32, [up, down]: [f64; 2]| {
            let expected = (up - down) / (2.0 * f64::from(STEP));
            assert!((f64::from(found) - expected).abs() < 1e-3, "{found} for {expected}");
        };
        for i in 0..course.dense.len() {
            let w = course.dense[i];
            let losses = [STEP, -STEP].map(|by| {
                course.dense[i] = w + by;
                loss(&mut course)
            });
            course.dense[i] = w;
            near(course.beside[i], losses);
        }
        for &place in places {
            let (w, found) = at(&mut course.inlet, place);
            let w = *w;
            let losses = [STEP, -STEP].map(|by| {
                *at(&mut course.inlet, place).0 = w + by;
                loss(&mut course)
            });
            *at(&mut course.inlet, place).0 = w;
            near(found, losses);
        }
        course
    }

    #[test]
    fn the_gradient_is_that_of_the_loss() {
        let table = FeatureTable::new(3);
        let (sparse, dense) = (Features { dynamic: vec![0, 2], ..Features::default() }, Dense(vec![0.5, -1.0, 2.0]));
        let some = [Action(0), Action(2), Action(3)];
        for (units, outputs) in [(4, Outputs::Actions), (4, Outputs::Bits), (0, Outputs::Actions), (0, Outputs::Bits)] {
            let net = Net { units, outputs, batch: usize::MAX, ..Net::default() };
            for legal in [Actions::All(5), Actions::Only(&some)] {
                let setting = Setting::<Features> { shared: &table, actions: 5 };
                let places = [(0, 0), (0, 2), (2, 1)];
                let course = check(&net, setting, &sparse, legal, &places, |inlet, (feature, column)| {
                    inlet.sum_all();
                    let (weights, beside) = inlet.row(feature);
                    (&mut weights[column], beside[column])
                });
                assert_eq!(course.inlet.touched, [0, 2]);
                assert!(course.inlet.layer().weights.row(1).is_none());
                let setting = Setting::<Dense> { shared: &Width(3), actions: 5 };
                check(&net, setting, &dense, legal, &[(0, 0), (1, 2), (2, 1)], |inlet, (row, column)| {
                    let (weights, beside) = inlet.parts();
                    let at = row as usize * 8 + column;
                    (&mut weights[at], beside[at])
                });
            }
        }
    }

    /// A batch's gradient is the sum of its examples', however long the batch and the rows are, and a feature that stands twice counts twice.
    #[test]
    fn a_batch_is_the_sum_of_its_examples() {
        let table = FeatureTable::new(10);
        let setting = Setting::<Features> { shared: &table, actions: 4 };
        for units in [4, 12, 30, 40] {
            let net = Net { units, batch: usize::MAX, ..Net::default() };
            let learn = |course: &mut NetCourse, i: u32| {
                let view = Features { dynamic: vec![i % 7, 7 + i % 3, 7 + i % 3], ..Features::default() };
                let sight = Sight { shared: &table, view: &view, legal: Actions::All(4) };
                course.dense.iter_mut().enumerate().for_each(|(k, w)| *w = (k as f32).sin());
                course.score(&sight);
                assert!(course.backward(&sight, Target::Label(Action(i % 4))));
            };
            let gradient = |course: &mut NetCourse, feature| {
                course.inlet.sum_all();
                course.inlet.row(feature).1[..units].to_vec()
            };
            let mut whole = net.begin(setting, None);
            (0..150).for_each(|i| learn(&mut whole, i));
            for feature in 0..10 {
                let mut sum = vec![0.0; units];
                for i in (0..150).filter(|i| [i % 7, 7 + i % 3].contains(&feature)) {
                    let mut alone = net.begin(setting, None);
                    learn(&mut alone, i);
                    sum.iter_mut().zip(gradient(&mut alone, feature)).for_each(|(sum, g)| *sum += g);
                }
                for (found, expected) in gradient(&mut whole, feature).iter().zip(&sum) {
                    assert!((found - expected).abs() < 1e-4, "{units} units: {found} for {expected}");
                }
            }
        }
    }

    /// With all numbers legal the loss over actions is the sum of the losses of the bits, each a sigmoid of its own.
    #[test]
    fn bits_are_sigmoids_of_their_own() {
        let net = Net { units: 3, outputs: Outputs::Bits, ..Net::default() };
        let mut course = net.begin(Setting::<Dense> { shared: &Width(2), actions: 16 }, None);
        course.dense.iter_mut().enumerate().for_each(|(i, w)| *w = (i as f32).cos());
        let view = Dense(vec![0.3, 0.9]);
        let sight = Sight { shared: &Width(2), view: &view, legal: Actions::All(16) };
        course.score(&sight);
        assert!(course.backward(&sight, Target::Label(Action(0b0110))));
        let pressed: Vec<f32> = course.outputs.iter().map(|out| 1.0 / (1.0 + (-out).exp())).collect();
        for (bit, (p, error)) in pressed.iter().zip(&course.errors).enumerate() {
            let expected = p - if [1, 2].contains(&bit) { 1.0 } else { 0.0 };
            assert!((error - expected).abs() < 1e-5, "{bit}: {error} for {expected}");
        }
        let best = sight.legal.best(&course.scores);
        assert!((0..4).all(|bit| (best.0 >> bit & 1 == 1) == (pressed[bit] > 0.5)));
    }
}
