//! Policies of nets, and the files they are kept in.

use crate::error::{Error, Result};
use crate::policy::{
    Classifier, Columns, Ladder, Layer, Linear, Mixture, MixtureMemory, Neural, Outputs, Policy, Rows, put_rows,
    take_rows,
};
use crate::space::{Action, Dense, FeatureTable, Features, Problem, View, ViewOf, Width};
use crate::tasks::{Arrays, opened, sealed};
use crate::worker::Visit;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A policy that learning a game ends with.
#[derive(Clone, Debug)]
pub enum Driver<C> {
    /// A mixture, or a single classifier.
    Mixture(Mixture<C>),
    /// One classifier per step.
    Ladder(Ladder<C>),
}

impl<P: Problem, C: Classifier<ViewOf<P>>> Policy<P> for Driver<C> {
    type Memory = (MixtureMemory<C::Memory>, Vec<C::Memory>);

    fn act(&self, visit: &mut Visit<'_, P>, memory: &mut Self::Memory) -> Action {
        match self {
            Driver::Mixture(mixture) => mixture.act(visit, &mut memory.0),
            Driver::Ladder(ladder) => ladder.act(visit, &mut memory.1),
        }
    }
}

impl<C> Driver<C> {
    /// The same with every classifier replaced by what `change` makes of it.
    pub fn map<D>(self, change: impl FnMut(C) -> D) -> Driver<D> {
        match self {
            Driver::Mixture(mixture) => Driver::Mixture(mixture.map(change)),
            Driver::Ladder(ladder) => Driver::Ladder(ladder.map(change)),
        }
    }

    /// Its classifiers, and their weights where it is a mixture.
    fn parts(&self) -> (Vec<&C>, Option<Vec<f64>>) {
        match self {
            Driver::Mixture(mixture) => {
                let (weights, nets) = mixture.members().iter().map(|(weight, net)| (*weight, net)).unzip();
                (nets, Some(weights))
            }
            Driver::Ladder(ladder) => (ladder.steps().iter().collect(), None),
        }
    }
}

/// An input layer that can be kept in a file.
pub trait Stored<V: View>: Layer<V> + PartialEq + Sized {
    /// Appends it to `bytes`.
    fn put(&self, bytes: &mut Vec<u8>);

    /// The layer of `columns` columns that comes next; an error says what is wrong with it.
    ///
    /// # Errors
    /// When there is none of this kind for what all views share.
    fn take(shared: &V::Shared, columns: usize, from: &mut Arrays<'_>) -> Result<Self, &'static str>;
}

impl Stored<Features> for Linear {
    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend((self.weights.len() as u32).to_le_bytes());
        put_rows(&self.weights, bytes);
    }

    fn take(shared: &FeatureTable, columns: usize, from: &mut Arrays<'_>) -> Result<Self, &'static str> {
        let count = from.take::<4>(1).ok_or("it ends before a classifier")?[0];
        take_rows((columns, shared.features()), Columns::Actions, u32::from_le_bytes(count) as usize, from)
    }
}

impl Stored<Dense> for Rows {
    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.weights.iter().flat_map(|w| w.to_le_bytes()));
    }

    fn take(shared: &Width, columns: usize, from: &mut Arrays<'_>) -> Result<Self, &'static str> {
        let mut rows = Rows::new(shared.0, columns);
        let values = from.take::<4>(rows.weights.len()).ok_or("it ends within a layer")?;
        rows.weights.iter_mut().zip(values).for_each(|(w, value)| *w = f32::from_le_bytes(*value));
        Ok(rows)
    }
}

/// What a file says of itself.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    task: String,
    actions: usize,
    outputs: Outputs,
    units: usize,
    classifiers: usize,
    /// Those of a mixture; nothing for a ladder.
    weights: Option<Vec<f64>>,
    about: String,
}

/// More units than this are no net of this program's.
const MOST_UNITS: usize = 1 << 16;

impl<I> Driver<Neural<I>> {
    /// It as the bytes of a model file of `task`; `about` says how it came to be.
    pub fn to_bytes<V: View>(&self, task: &str, about: &str) -> Vec<u8>
    where
        I: Stored<V>,
    {
        let (nets, weights) = self.parts();
        let header = Header {
            task: task.to_owned(),
            actions: nets.first().map_or(0, |net| net.actions),
            outputs: nets.first().map_or(Outputs::Actions, |net| net.outputs),
            units: nets.first().map_or(0, |net| net.units),
            classifiers: nets.len(),
            weights,
            about: about.to_owned(),
        };
        let mut body = serde_json::to_vec(&header).unwrap_or_default();
        body.push(b'\n');
        for net in nets {
            net.input.put(&mut body);
            body.extend(net.dense.iter().flat_map(|w| w.to_le_bytes()));
        }
        sealed(body)
    }

    /// What stands in the bytes of a model file of `task`, and how it came to be; `path` names the file in errors.
    ///
    /// # Errors
    /// When it is no model, one of another task, for another game, or damaged.
    pub fn from_bytes<V: View>(
        bytes: &[u8],
        path: &Path,
        (task, shared, actions): (&str, &V::Shared, usize),
    ) -> Result<(Self, String)>
    where
        I: Stored<V>,
    {
        let (header, mut arrays): (Header, _) = opened(bytes, path, task)?;
        let broken = |what: &str| {
            let problem = format!("the model is damaged: its body is no {task} model: {what}");
            Error::file(path, problem, "copy or train it again")
        };
        if header.actions != actions || header.units > MOST_UNITS || header.classifiers == 0 {
            return Err(broken("it is for another game, or has no classifiers"));
        }
        let outputs = header.outputs.count(actions);
        let columns = if header.units == 0 { outputs } else { header.units };
        let net = |_| {
            let input = I::take(shared, columns, &mut arrays)?;
            let size = Neural::<I>::size(header.units, outputs);
            let values = arrays.take::<4>(size).ok_or("it ends within a net")?;
            let dense = values.iter().map(|value| f32::from_le_bytes(*value)).collect();
            Ok(Neural { actions, outputs: header.outputs, units: header.units, input, dense })
        };
        let nets = (0..header.classifiers).map(net).collect::<Result<Vec<_>, &str>>().map_err(broken)?;
        if !arrays.is_empty() {
            return Err(broken("its arrays are not as long as it says"));
        }
        let driver = match header.weights {
            None => Driver::Ladder(Ladder::of(nets)),
            Some(weights) if weights.len() == nets.len() => {
                let members = weights.into_iter().zip(nets).collect();
                Driver::Mixture(Mixture::of(members, Default::default()).map_err(|error| broken(&error.to_string()))?)
            }
            Some(_) => return Err(broken("it has not as many weights as classifiers")),
        };
        Ok((driver, header.about))
    }
}
