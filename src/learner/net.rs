//! A net of one hidden layer, by backpropagation.

use super::{Examples, Learner, Lesson, Online, Setting, Target, reduce};
use crate::policy::{Classifier, Columns, Linear, Neural, NeuralMemory, Weights, forward};
use crate::seed::{Purpose, Seed};
use crate::space::{Action, Features, Sight};
use rand::RngExt;
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

/// A net of one hidden layer of sigmoid units over sparse binary input ([`Neural`]), by backpropagation in small batches; its loss is the
/// logistic loss over the legal actions. A 0-1 learner.
///
/// What a unit first gives a feature is drawn evenly from ±1/√n, n the number of features of the example in which it first occurs. A classifier of
/// another width to start from is not used.
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
    /// Units of the hidden layer.
    pub units: usize,
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
        Net { units: 64, passes: 10, batch: 16, rate: 0.005, step: Step::Adam }
    }
}

/// What is kept of weights beside them: their gradient in the batch, its running mean and that of its square, one behind the other, each as
/// long as the weights.
const BESIDE: usize = 3;

/// The weights of the input.
#[derive(Clone, Debug)]
struct Input {
    weights: Weights,
    /// What is kept beside them, row after row as in the weights.
    beside: Vec<f32>,
}

impl Input {
    /// The weights of `feature` and what is kept beside them.
    fn row(&mut self, feature: u32) -> (&mut [f32], &mut [f32]) {
        let (place, width) = (self.weights.make_place(feature), BESIDE * self.weights.stride());
        if self.beside.len() < (place + 1) * width {
            self.beside.resize((place + 1) * width, 0.0);
        }
        (self.weights.row_mut(feature), &mut self.beside[place * width..(place + 1) * width])
    }
}

/// A net in the making.
#[derive(Clone, Debug)]
pub struct NetCourse {
    seed: Seed,
    input: Input,
    /// What [`Neural`] has but for its input.
    dense: Vec<f32>,
    /// What is kept beside that.
    beside: Vec<f32>,
    actions: usize,
    units: Vec<f32>,
    scores: Vec<f32>,
    /// The slopes of the loss at what goes into the units.
    slopes: Vec<f32>,
    /// The features of the batch, each once, in the order of their first occurrence.
    touched: Vec<u32>,
    /// The last batch each feature was in, from 1.
    batches: Vec<u32>,
    pending: usize,
    /// The number of the batch at hand, from 1.
    time: u32,
}

impl NetCourse {
    /// What the net gives for the features at hand.
    fn score(&mut self, fixed: &[u32], dynamic: &[u32]) {
        for &feature in fixed.iter().chain(dynamic) {
            if self.input.weights.row(feature).is_none() {
                let scale = 1.0 / ((fixed.len() + dynamic.len()) as f32).sqrt();
                let mut rng = self.seed.child(Purpose::Learner, u64::from(feature)).rng();
                let (row, _) = self.input.row(feature);
                row[..self.units.len()].iter_mut().for_each(|w| *w = scale * (2.0 * rng.random::<f32>() - 1.0));
            }
        }
        self.slopes.clear();
        self.slopes.resize(self.input.weights.stride(), 0.0);
        self.input.weights.add_to(fixed, &mut self.slopes);
        self.input.weights.add_to(dynamic, &mut self.slopes);
        let width = self.units.len();
        self.units.copy_from_slice(&self.slopes[..width]);
        forward(&self.dense, &mut self.units, &mut self.scores);
    }

    /// Adds the gradient of the example that was scored last to the batch's.
    fn backward(&mut self, fixed: &[u32], dynamic: &[u32], lesson: Lesson<'_>) -> bool {
        let (label, importance) = reduce::as_label(lesson.target, lesson.legal);
        if importance == 0.0 {
            return false;
        }
        let width = self.units.len();
        let w = &self.dense[width + self.actions..];
        let (bias, rest) = self.beside[..self.dense.len()].split_at_mut(width);
        let (offsets, outputs) = rest.split_at_mut(self.actions);
        let high = self.scores[lesson.legal.best(&self.scores).index()];
        let total: f32 = lesson.legal.iter().map(|a| (self.scores[a.index()] - high).exp()).sum();
        self.slopes.fill(0.0);
        for action in lesson.legal.iter() {
            let a = action.index();
            let share = (self.scores[a] - high).exp() / total;
            let slope = importance * (share - if action == label { 1.0 } else { 0.0 });
            offsets[a] += slope;
            let row = a * width..(a + 1) * width;
            outputs[row.clone()].iter_mut().zip(&self.units).for_each(|(g, h)| *g += slope * h);
            self.slopes.iter_mut().zip(&w[row]).for_each(|(sum, v)| *sum += slope * v);
        }
        for ((slope, h), g) in self.slopes.iter_mut().zip(&self.units).zip(bias) {
            *slope *= h * (1.0 - h);
            *g += *slope;
        }
        for &feature in fixed.iter().chain(dynamic) {
            let (_, g) = self.input.row(feature);
            g.iter_mut().zip(&self.slopes).for_each(|(g, slope)| *g += slope);
            if std::mem::replace(&mut self.batches[feature as usize], self.time) != self.time {
                self.touched.push(feature);
            }
        }
        self.pending += 1;
        true
    }
}

impl Net {
    /// Changes the weights by the mean gradient of the batch, which begins anew.
    fn step(&self, course: &mut NetCourse) {
        if course.pending == 0 {
            return;
        }
        let (share, time) = (1.0 / course.pending as f32, course.time as i32);
        for feature in course.touched.drain(..) {
            self.change(course.input.row(feature), share, time);
        }
        self.change((&mut course.dense, &mut course.beside), share, time);
        course.pending = 0;
        course.time += 1;
    }

    /// Changes the weights `w` by what is kept `beside` them; the gradient counts `share` of itself and is zero after.
    fn change(&self, (w, beside): (&mut [f32], &mut [f32]), share: f32, time: i32) {
        let width = w.len();
        let (g, rest) = beside.split_at_mut(width);
        let (means, squares) = rest.split_at_mut(width);
        let (first, second) = (1.0 - 0.9f32.powi(time), 1.0 - 0.999f32.powi(time));
        for i in 0..width {
            let slope = share * std::mem::take(&mut g[i]);
            match self.step {
                Step::Adagrad => {
                    squares[i] += slope * slope;
                    w[i] -= self.rate * slope / (squares[i].sqrt() + 1e-8);
                }
                Step::Adam => {
                    means[i] += 0.1 * (slope - means[i]);
                    squares[i] += 0.001 * (slope * slope - squares[i]);
                    w[i] -= self.rate * (means[i] / first) / ((squares[i] / second).sqrt() + 1e-8);
                }
            }
        }
    }

    /// Learns from the example that was scored last, at the end of a batch at once.
    fn learn(&self, course: &mut NetCourse, fixed: &[u32], dynamic: &[u32], lesson: Lesson<'_>) {
        if course.backward(fixed, dynamic, lesson) && course.pending >= self.batch {
            self.step(course);
        }
    }

    /// Learns from example `i`.
    fn take(&self, course: &mut NetCourse, setting: Setting<'_, Features>, examples: &Examples<Features>, i: usize) {
        let (row, dynamic) = examples.views().get(i);
        let fixed = setting.shared.row(row);
        course.score(fixed, dynamic);
        let lesson = Lesson { actions: setting.actions, legal: examples.legal(i), target: examples.target(i) };
        self.learn(course, fixed, dynamic, lesson);
    }
}

/// The weights as they are now; features not met so far count nothing.
impl Classifier<Features> for NetCourse {
    type Memory = NeuralMemory;

    fn scores<'m>(&self, sight: &Sight<'_, Features>, memory: &'m mut NeuralMemory) -> &'m [f32] {
        memory.scores((&self.input.weights, &self.dense), (self.units.len(), self.actions), sight)
    }
}

impl Learner<Features> for Net {
    type Classifier = Neural;

    fn fit(
        &self,
        setting: Setting<'_, Features>,
        examples: &Examples<Features>,
        warm: Option<&Neural>,
        seed: Seed,
    ) -> Neural {
        let mut course = self.begin(setting, warm);
        course.seed = seed;
        let mut order: Vec<u32> = (0..examples.len() as u32).collect();
        let mut rng = seed.rng();
        for _ in 0..self.passes {
            order.shuffle(&mut rng);
            for &i in &order {
                self.take(&mut course, setting, examples, i as usize);
            }
        }
        self.finish(course)
    }
}

impl Online<Features> for Net {
    type Course = NetCourse;

    /// Without a seed of its own every course draws the same first weights.
    fn begin(&self, setting: Setting<'_, Features>, warm: Option<&Neural>) -> NetCourse {
        let (features, actions) = (setting.shared.features(), setting.actions);
        let mut input = Input { weights: Weights::new(features, self.units), beside: Vec::new() };
        let mut dense = vec![0.0; Neural::size(self.units, actions)];
        if let Some(warm) = warm.filter(|warm| warm.units() == self.units && warm.actions() == actions) {
            dense.copy_from_slice(&warm.dense);
            for feature in 0..warm.input.weights.features() as u32 {
                if let Some(row) = warm.input.weights.row(feature) {
                    input.row(feature).0.copy_from_slice(row);
                }
            }
        }
        NetCourse {
            seed: Seed::new(0),
            input,
            beside: vec![0.0; BESIDE * dense.len()],
            dense,
            actions,
            units: vec![0.0; self.units],
            scores: vec![0.0; actions],
            slopes: Vec::new(),
            touched: Vec::new(),
            batches: vec![0; features],
            pending: 0,
            time: 1,
        }
    }

    fn learn(&self, course: &mut NetCourse, sight: &Sight<'_, Features>, target: Option<Target<'_>>) -> Action {
        let (fixed, dynamic) = (sight.shared.row(sight.view.row), &sight.view.dynamic[..]);
        course.score(fixed, dynamic);
        let choice = sight.legal.best(&course.scores);
        if let Some(target) = target {
            self.learn(course, fixed, dynamic, Lesson { actions: course.actions, legal: sight.legal, target });
        }
        choice
    }

    fn study(&self, course: &mut NetCourse, setting: Setting<'_, Features>, examples: &Examples<Features>) {
        (0..examples.len()).for_each(|i| self.take(course, setting, examples, i));
    }

    fn finish(&self, mut course: NetCourse) -> Neural {
        self.step(&mut course);
        let weights = course.input.weights.map_rows(|_, _| {});
        let input = Linear { actions: self.units, columns: Columns::Actions, weights };
        Neural { input, dense: course.dense }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{Actions, FeatureTable};

    /// The gradient of one example against differences of the loss, weight by weight.
    #[test]
    fn the_gradient_is_that_of_the_loss() {
        let (table, net) = (FeatureTable::new(3), Net { units: 4, batch: usize::MAX, ..Net::default() });
        let mut course = net.begin(Setting { shared: &table, actions: 3 }, None);
        course.dense.iter_mut().enumerate().for_each(|(i, w)| *w = (i as f32).sin());
        let legal = [Action(0), Action(2)];
        let costs = Target::Costs(&[1.5, 0.0]);
        let lesson = Lesson { actions: 3, legal: Actions::Only(&legal), target: costs };
        let loss = |course: &mut NetCourse| {
            course.score(&[0], &[2]);
            let total: f64 = legal.iter().map(|a| f64::from(course.scores[a.index()]).exp()).sum();
            1.5 * (total.ln() - f64::from(course.scores[2]))
        };
        loss(&mut course);
        assert!(course.backward(&[0], &[2], lesson));
        let step = 1e-2f32;
        let near = |found: f32, up: f64, down: f64| {
            let expected = (up - down) / (2.0 * f64::from(step));
            assert!((f64::from(found) - expected).abs() < 1e-3, "{found} for {expected}");
        };
        for i in 0..course.dense.len() {
            let w = course.dense[i];
            let [up, down] = [step, -step].map(|by| {
                course.dense[i] = w + by;
                loss(&mut course)
            });
            course.dense[i] = w;
            near(course.beside[i], up, down);
        }
        for (feature, unit) in [(0, 0), (0, 3), (2, 1)] {
            let w = course.input.row(feature).0[unit];
            let [up, down] = [step, -step].map(|by| {
                course.input.row(feature).0[unit] = w + by;
                loss(&mut course)
            });
            course.input.row(feature).0[unit] = w;
            near(course.input.row(feature).1[unit], up, down);
        }
        assert_eq!(course.touched, [0, 2]);
        assert!(course.input.weights.row(1).is_none());
    }
}
