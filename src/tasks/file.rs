//! Model files.
//!
//! A magic line with the version, a line with the body's length and checksum, then the body: one line of JSON that says what
//! follows, and the numbers, little-endian, one array after the other:
//!
//! 1. the task's own arrays, u64: see [`Task::arrays`];
//! 2. for each classifier the numbers of the features that have weights, u32, ascending, then their rows, f32; then for a net, whose rows are those of
//!    its input layer, the biases of its units and of its outputs and the weights of output by output, f32.
//!
//! A file is read as untrusted input: no length in it is believed before the bytes are there. It is written beside its
//! target and renamed, so a file that exists is whole.

use super::model::{About, Learned, Model};
use super::{AnyClassifier, Task};
use crate::error::{Error, Result};
use crate::output::{Arrays, Seal, checksum, first_line, write_whole};
use crate::policy::{Columns, Greedy, Ladder, Linear, Mixture, Neural, Outputs, Reading, put_rows, take_rows};
use crate::read::input;
use crate::space::Stacked;
use crate::trainer::{Beam, MOST_WIDTH, MOST_WINDOW, TwoStage};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Model files.
const MODEL: Seal = Seal {
    name: "model",
    version: 1,
    stranger: "name a file that `rollin train --model` wrote",
    outdated: "train it again, or use the program that wrote it",
    broken: "copy or train it again",
};

/// What a body says of itself.
#[derive(Serialize, Deserialize)]
struct Header<H> {
    task: String,
    /// What the task says.
    #[serde(flatten)]
    own: H,
    policy: Shape,
    columns: Columns,
    /// Where they are nets: all are of one shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    net: Option<Hidden>,
    /// How many features have weights, for each classifier.
    rows: Vec<usize>,
    about: About,
    /// Left out where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    temperatures: Vec<f32>,
}

/// The shape of a net.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Hidden {
    units: usize,
    outputs: Outputs,
}

/// The most units that a net in a file may have.
pub const MOST_UNITS: usize = 1 << 16;

impl Hidden {
    fn of(classifier: &AnyClassifier) -> Option<Self> {
        match classifier {
            AnyClassifier::Linear(_) => None,
            AnyClassifier::Net(net) => Some(Hidden { units: net.units(), outputs: net.outputs() }),
        }
    }

    /// Reads a net for so many actions and features.
    fn take(
        self,
        (actions, features): (usize, usize),
        count: usize,
        arrays: &mut Arrays<'_>,
    ) -> Result<AnyClassifier, &'static str> {
        let Hidden { units, outputs } = self;
        let ends = outputs.count(actions);
        let input = take_rows((if units == 0 { ends } else { units }, features), Columns::Actions, count, arrays)?;
        let dense = arrays.take::<4>(Neural::<Linear>::size(units, ends)).ok_or("it ends within a net")?;
        let dense = dense.iter().map(|w| f32::from_le_bytes(*w)).collect();
        Ok(AnyClassifier::Net(Neural { actions, outputs, units, input, dense }))
    }
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
enum Shape {
    Mixture {
        reading: Reading,
        weights: Vec<f64>,
    },
    Ladder,
    Beam {
        width: usize,
    },
    Stacked {
        window: usize,
    },
    /// The first so many classifiers are those of the first reading.
    Readings {
        classifiers: usize,
        first: Box<Shape>,
        second: Box<Shape>,
    },
}

impl Shape {
    fn of(policy: &Learned) -> Shape {
        match policy {
            Learned::Mixture(mixture) => Shape::Mixture {
                reading: mixture.reading(),
                weights: mixture.members().iter().map(|(weight, _)| *weight).collect(),
            },
            Learned::Ladder(_) => Shape::Ladder,
            Learned::Beam(beam) => Shape::Beam { width: beam.width },
            Learned::Stacked(stages) => Shape::Stacked { window: stages.window },
            Learned::Readings { first, second } => Shape::Readings {
                classifiers: first.classifiers().len(),
                first: Box::new(Shape::of(first)),
                second: Box::new(Shape::of(second)),
            },
        }
    }

    /// The policy of this shape.
    fn policy(self, mut classifiers: Vec<AnyClassifier>) -> Result<Learned, String> {
        Ok(match self {
            Shape::Ladder => Learned::Ladder(Ladder::of(classifiers)),
            Shape::Beam { width } => match <[AnyClassifier; 1]>::try_from(classifiers) {
                Ok([classifier]) if (1..=MOST_WIDTH).contains(&width) => Learned::Beam(Beam { classifier, width }),
                _ => return Err("it is no beam with one classifier".into()),
            },
            Shape::Stacked { window } => match <[AnyClassifier; 2]>::try_from(classifiers) {
                Ok([first, second]) => {
                    Learned::Stacked(TwoStage { first: Greedy(first), second: Greedy(second), window })
                }
                Err(_) => return Err("it has not two stages".into()),
            },
            Shape::Mixture { reading, weights } => {
                if weights.len() != classifiers.len() {
                    return Err("it has not as many weights as classifiers".into());
                }
                let members = weights.into_iter().zip(classifiers).collect();
                Learned::Mixture(Mixture::of(members, reading).map_err(|error| error.to_string())?)
            }
            Shape::Readings { classifiers: of_first, first, second } => {
                if of_first == 0 || of_first >= classifiers.len() {
                    return Err("it has not classifiers for two readings".into());
                }
                let rest = classifiers.split_off(of_first);
                let (first, second) = (first.policy(classifiers)?, second.policy(rest)?);
                Learned::Readings { first: Box::new(first), second: Box::new(second) }
            }
        })
    }
}

/// How many bytes each part of a model file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Parts {
    /// What it says of itself: the first lines.
    pub header: usize,
    /// The task's arrays: eight bytes a number.
    pub dictionaries: usize,
    /// Which features have weights, for each classifier: four bytes a number.
    pub features: usize,
    /// Their weights, and whatever else a classifier has: four bytes a number.
    pub weights: usize,
}

impl<T: Task> Model<T> {
    /// The parts of the file of `size` bytes that the model was read from.
    pub fn parts(&self, size: usize) -> Parts {
        let classifiers = self.policy.classifiers();
        let rows = |c: &&AnyClassifier| c.weights().len();
        let dictionaries = 8 * self.encoding.arrays().iter().map(|array| array.len()).sum::<usize>();
        let features = 4 * classifiers.iter().map(rows).sum::<usize>();
        let weights = |c: &&AnyClassifier| rows(c) * c.weights().columns() + beside(c).len();
        let weights = 4 * classifiers.iter().map(weights).sum::<usize>();
        Parts { header: size.saturating_sub(dictionaries + features + weights), dictionaries, features, weights }
    }

    /// The model as the bytes of a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let classifiers = self.policy.classifiers();
        let header = Header {
            task: T::NAME.into(),
            own: self.encoding.header(),
            policy: Shape::of(&self.policy),
            columns: self.columns(),
            net: classifiers.first().and_then(|c| Hidden::of(c)),
            rows: classifiers.iter().map(|c| c.weights().len()).collect(),
            about: self.about.clone(),
            temperatures: self.temperatures.clone(),
        };
        let json = serde_json::to_vec(&header).unwrap_or_default();
        let arrays = self.encoding.arrays();
        let keys: usize = arrays.iter().map(|array| array.len()).sum();
        let numbers: usize =
            classifiers.iter().map(|c| c.weights().len() * (1 + c.weights().columns()) + beside(c).len()).sum();
        let length = json.len() + 1 + 8 * keys + 4 * numbers;

        // Models are large: the body is written once, behind a head that waits for its checksum.
        let mut bytes = MODEL.head(length, 0);
        let start = bytes.len();
        bytes.reserve_exact(length);
        bytes.extend(json);
        bytes.push(b'\n');
        for array in arrays {
            bytes.extend(array.iter().flat_map(|key| key.to_le_bytes()));
        }
        for classifier in classifiers {
            put_rows(classifier.weights(), &mut bytes);
            bytes.extend(beside(classifier).iter().flat_map(|w| w.to_le_bytes()));
        }
        let sum = checksum(&bytes[start..]);
        bytes[..start].copy_from_slice(&MODEL.head(length, sum));
        bytes
    }

    /// Writes the model to `path`: beside it first, then renamed, so that no half of it is ever there.
    ///
    /// # Errors
    /// When the system refuses; whatever stood at `path` is then still there.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        write_whole(path.as_ref(), &self.to_bytes())
    }

    /// Reads a model from `path`.
    ///
    /// # Errors
    /// When the file cannot be read, is no model, of another version, cut short or damaged.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Model::from_bytes(&input::raw(path)?, input::name(path))
    }

    /// Reads a model from the bytes of a file, which `path` names in errors.
    ///
    /// # Errors
    /// When they are no model, of another version, cut short or damaged.
    pub fn from_bytes(bytes: &[u8], path: &Path) -> Result<Self> {
        let body = MODEL.open(bytes, path)?;
        let broken = |what: &str| MODEL.damaged(path, &format!("its body is no {} model: {what}", T::NAME));
        let (json, arrays) = first_line(body).ok_or_else(|| broken("no header"))?;
        // What is not for every task is the task's: it refuses what it does not know.
        let header: Header<serde_json::Map<String, serde_json::Value>> =
            serde_json::from_slice(json).map_err(|error| broken(&error.to_string()))?;
        if header.task != T::NAME {
            let needed = format!("a {} model is needed", T::NAME);
            return Err(Error::file(path, format!("a model for {}", header.task), needed));
        }
        let own = serde_json::from_value(header.own.into()).map_err(|error| broken(&error.to_string()))?;
        let mut arrays = Arrays::of(arrays);
        let encoding = T::restore(own, &mut arrays, path).map_err(|what| broken(&what))?;

        let (actions, features) = (encoding.actions(), encoding.features());
        if header.net.is_some_and(|net| net.units > MOST_UNITS) {
            return Err(broken("its nets are too wide"));
        }
        let features = |place: usize| match header.policy {
            Shape::Stacked { window } if place == 1 => {
                Some(window).filter(|w| *w <= MOST_WINDOW).map(|w| features + Stacked::<T::Space>::more(actions, w))
            }
            _ => Some(features),
        };
        let classifiers = header
            .rows
            .iter()
            .enumerate()
            .map(|(place, count)| {
                let features = features(place).ok_or("its window is too wide")?;
                match header.net {
                    None => {
                        take_rows((actions, features), header.columns, *count, &mut arrays).map(AnyClassifier::from)
                    }
                    Some(net) => net.take((actions, features), *count, &mut arrays),
                }
            })
            .collect::<Result<Vec<_>, &str>>()
            .map_err(&broken)?;
        if !arrays.is_empty() || classifiers.is_empty() {
            return Err(broken("its arrays are not as long as it says"));
        }
        let temperatures = header.temperatures;
        let possible = temperatures.iter().all(|temperature| *temperature > 0.0 && temperature.is_finite());
        if !possible || !temperatures.is_empty() && temperatures.len() != classifiers.len() {
            return Err(broken("its temperatures are not those of its classifiers"));
        }
        let policy = header.policy.policy(classifiers).map_err(|what| broken(&what))?;
        Ok(Model { encoding, policy, about: header.about, temperatures })
    }
}

/// What a classifier has beside the weights of features.
fn beside(classifier: &AnyClassifier) -> &[f32] {
    match classifier {
        AnyClassifier::Linear(_) => &[],
        AnyClassifier::Net(net) => &net.dense,
    }
}

/// The name of the task that the model in the bytes of a file is for; `path` names it in errors.
///
/// # Errors
/// When they are no model, of another version, cut short or damaged.
pub fn task_of(bytes: &[u8], path: &Path) -> Result<String> {
    #[derive(Deserialize)]
    struct Named {
        task: String,
    }
    let body = MODEL.open(bytes, path)?;
    let json = first_line(body).map_or(body, |(json, _)| json);
    let named: Named =
        serde_json::from_slice(json).map_err(|error| MODEL.damaged(path, &format!("its body is no model: {error}")))?;
    Ok(named.task)
}

/// The bytes of a model file with this body: a head with its length and checksum before it. [`Model::to_bytes`] does so itself.
pub fn sealed(body: Vec<u8>) -> Vec<u8> {
    MODEL.close(body)
}

/// What the body in the bytes of a model file of `task` says of itself, and the arrays behind that; `path` names the file in errors.
///
/// # Errors
/// When they are no model, of another version or task, cut short or damaged.
pub(crate) fn opened<'a, H: DeserializeOwned>(bytes: &'a [u8], path: &Path, task: &str) -> Result<(H, Arrays<'a>)> {
    let name = task_of(bytes, path)?;
    if name != task {
        return Err(Error::file(path, format!("a model for {name}"), format!("a {task} model is needed")));
    }
    let (json, rest) = first_line(MODEL.open(bytes, path)?).ok_or_else(|| MODEL.damaged(path, "no header"))?;
    let header = serde_json::from_slice(json).map_err(|error| MODEL.damaged(path, &error.to_string()))?;
    Ok((header, Arrays::of(rest)))
}
