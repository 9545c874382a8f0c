//! Model files.
//!
//! A magic line with the version, a line with the body's length and checksum, then the body: one line of JSON that says what
//! follows, and the numbers, little-endian, one array after the other:
//!
//! 1. the hashes of the static features, u64, in the order of their numbers;
//! 2. for each history line the hashes of its contexts, u64;
//! 3. for each classifier the numbers of the features that have weights, u32, ascending, then their rows, f32.
//!
//! A file is read as untrusted input: no length in it is believed before the bytes are there. It is written beside its
//! target and renamed, so a file that exists is whole.

use super::encoding::{Dictionary, Encoding, MOST_LABELS};
use super::space::{MAX_ORDER, Tagging};
use super::tagger::{About, Learned, Tagger};
use super::transitions::{Order, Transitions};
use crate::error::{Error, Result};
use crate::output::write_whole;
use crate::policy::{Columns, Greedy, Ladder, Linear, Mixture, Reading, Weights};
use crate::read::template::Template;
use crate::space::Stacked;
use crate::trainer::{Beam, MOST_WIDTH, MOST_WINDOW, TwoStage};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

/// What a model file begins with, but for the version.
const MAGIC: &str = "rollin model ";
/// The version that is written, and the only one that is read.
const VERSION: u32 = 1;

/// What a body says of itself.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    task: String,
    template: String,
    labels: Vec<String>,
    label_column: usize,
    order: Order,
    features: usize,
    contexts: Vec<usize>,
    policy: Shape,
    columns: Columns,
    /// How many features have weights, for each classifier.
    rows: Vec<usize>,
    about: About,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
enum Shape {
    Mixture { reading: Reading, weights: Vec<f64> },
    Ladder,
    Beam { width: usize },
    Stacked { window: usize },
}

impl Tagger {
    /// The model as the bytes of a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let classifiers = self.policy.classifiers();
        let header = Header {
            task: "tagging".into(),
            template: self.encoding.template.text().into(),
            labels: self.encoding.labels.clone(),
            label_column: self.encoding.label_column,
            order: self.encoding.transitions.order(),
            features: self.encoding.features.len(),
            contexts: self.encoding.contexts.iter().map(Dictionary::len).collect(),
            policy: match &self.policy {
                Learned::Mixture(mixture) => Shape::Mixture {
                    reading: mixture.reading(),
                    weights: mixture.members().iter().map(|(weight, _)| *weight).collect(),
                },
                Learned::Ladder(_) => Shape::Ladder,
                Learned::Beam(beam) => Shape::Beam { width: beam.width },
                Learned::Stacked(stages) => Shape::Stacked { window: stages.window },
            },
            columns: self.columns(),
            rows: classifiers.iter().map(|c| c.weights.len()).collect(),
            about: self.about.clone(),
        };
        let json = serde_json::to_vec(&header).unwrap_or_default();
        let keys: usize = header.features + header.contexts.iter().sum::<usize>();
        let numbers: usize = classifiers.iter().map(|c| c.weights.len() * (1 + c.weights.columns())).sum();
        let length = json.len() + 1 + 8 * keys + 4 * numbers;

        // Models are large: the body is written once, behind a head that waits for its checksum.
        let head = |sum| format!("{MAGIC}{VERSION}\n{}\n", second_line(length, sum)).into_bytes();
        let mut bytes = head(0);
        let start = bytes.len();
        bytes.reserve_exact(length);
        bytes.extend(json);
        bytes.push(b'\n');
        for dictionary in std::iter::once(&self.encoding.features).chain(&self.encoding.contexts) {
            bytes.extend(dictionary.keys().iter().flat_map(|key| key.to_le_bytes()));
        }
        for classifier in classifiers {
            let weights = &classifier.weights;
            let with_weights = || (0..weights.features() as u32).filter_map(|f| weights.row(f).map(|row| (f, row)));
            bytes.extend(with_weights().flat_map(|(feature, _)| feature.to_le_bytes()));
            for (_, row) in with_weights() {
                let at = bytes.len();
                bytes.resize(at + 4 * weights.columns(), 0);
                bytes[at..].as_chunks_mut().0.iter_mut().zip(row).for_each(|(to, w)| *to = w.to_le_bytes());
            }
        }
        let sum = checksum(&bytes[start..]);
        bytes[..start].copy_from_slice(&head(sum));
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
        let bytes = std::fs::read(path).map_err(|source| Error::io("read", path, source))?;
        Tagger::from_bytes(&bytes, path)
    }

    /// Reads a model from the bytes of a file, which `path` names in errors.
    ///
    /// # Errors
    /// When they are no model, of another version, cut short or damaged.
    pub fn from_bytes(bytes: &[u8], path: &Path) -> Result<Self> {
        let body = checked_body(bytes, path)?;
        let broken = |what: &str| damaged(path, &format!("its body is no tagging model: {what}"));
        let (json, arrays) = split_line(body).ok_or_else(|| broken("no header"))?;
        let header: Header = serde_json::from_slice(json).map_err(|error| broken(&error.to_string()))?;
        let mut arrays = Arrays { rest: arrays };

        if header.task != "tagging" {
            return Err(Error::file(path, format!("a model for {}", header.task), "a tagging model is needed"));
        }
        // Whatever its template is blamed for later is not to look like a line of the model file.
        let source = format!("<template in {}>", path.display());
        let template =
            Template::parse(&header.template, source.as_ref()).map_err(|error| broken(&error.to_string()))?;
        let labels = header.labels;
        if labels.is_empty() || labels.len() > MOST_LABELS || !labels.is_sorted_by(|a, b| a < b) {
            return Err(broken("its labels are not a sorted list of names"));
        }
        let far = template.history().iter().flat_map(|line| &line.labels).any(|k| k.unsigned_abs() as usize > MAX_ORDER);
        if far || template.history().len() != header.contexts.len() {
            return Err(broken("its history lines are not those of its template"));
        }
        let mut dictionary = |count: usize| {
            let keys = arrays.take::<8>(count).ok_or_else(|| broken("it ends within a dictionary"))?;
            Dictionary::of(keys.iter().map(|key| u64::from_le_bytes(*key)))
                .ok_or_else(|| broken("a feature stands in it twice"))
        };
        let features = dictionary(header.features)?;
        let contexts = header.contexts.iter().map(|count| dictionary(*count)).collect::<Result<Vec<_>>>()?;
        let transitions = Arc::new(Transitions::new(header.order, &labels));
        if !transitions.go_on() {
            return Err(broken("its order of labels leaves none to go on with"));
        }
        let mut encoding = Encoding {
            template,
            label_column: header.label_column,
            transitions,
            features,
            contexts,
            history: [].into(),
            labels,
        };
        encoding.number_history().map_err(|error| broken(&error.to_string()))?;

        let (actions, features) = (encoding.labels.len(), encoding.features());
        let features = |place: usize| match header.policy {
            Shape::Stacked { window } if place == 1 => {
                Some(window).filter(|w| *w <= MOST_WINDOW).map(|w| features + Stacked::<Tagging>::more(actions, w))
            }
            _ => Some(features),
        };
        let classifiers = header
            .rows
            .iter()
            .enumerate()
            .map(|(place, count)| {
                let features = features(place).ok_or("its window is too wide")?;
                classifier((actions, features), header.columns, *count, &mut arrays)
            })
            .collect::<Result<Vec<_>, &str>>()
            .map_err(&broken)?;
        if !arrays.rest.is_empty() || classifiers.is_empty() {
            return Err(broken("its arrays are not as long as it says"));
        }
        let policy = match header.policy {
            Shape::Ladder => Learned::Ladder(Ladder::of(classifiers)),
            Shape::Beam { width } => match <[Linear; 1]>::try_from(classifiers) {
                Ok([classifier]) if (1..=MOST_WIDTH).contains(&width) => Learned::Beam(Beam { classifier, width }),
                _ => return Err(broken("it is no beam with one classifier")),
            },
            Shape::Stacked { window } => match <[Linear; 2]>::try_from(classifiers) {
                Ok([first, second]) => {
                    Learned::Stacked(TwoStage { first: Greedy(first), second: Greedy(second), window })
                }
                Err(_) => return Err(broken("it has not two stages")),
            },
            Shape::Mixture { reading, weights } => {
                if weights.len() != classifiers.len() {
                    return Err(broken("it has not as many weights as classifiers"));
                }
                let members = weights.into_iter().zip(classifiers).collect();
                Learned::Mixture(Mixture::of(members, reading).map_err(|error| broken(&error.to_string()))?)
            }
        };
        Ok(Tagger { encoding, policy, about: header.about })
    }
}

/// Reads one classifier: the numbers of its features, then their rows.
fn classifier(
    (actions, features): (usize, usize),
    columns: Columns,
    count: usize,
    arrays: &mut Arrays<'_>,
) -> Result<Linear, &'static str> {
    let width = columns.count(actions);
    let numbers = arrays.take::<4>(count).ok_or("it ends within a list of features")?;
    let all = width.checked_mul(count).ok_or("a classifier is too large")?;
    let values = arrays.take::<4>(all).ok_or("it ends within a classifier's weights")?;
    let mut weights = Weights::new(features, width);
    weights.reserve(count);
    for (i, number) in numbers.iter().enumerate() {
        let feature = u32::from_le_bytes(*number);
        if feature as usize >= features || weights.row(feature).is_some() {
            return Err("a feature with weights does not exist or stands twice");
        }
        let row = values[i * width..(i + 1) * width].iter();
        weights.row_mut(feature).iter_mut().zip(row).for_each(|(w, value)| *w = f32::from_le_bytes(*value));
    }
    Ok(Linear { actions, columns, weights })
}

/// Little-endian numbers, one array after the other.
struct Arrays<'a> {
    rest: &'a [u8],
}

impl<'a> Arrays<'a> {
    /// The next `count` numbers of `N` bytes each; `None` when they are not there.
    fn take<const N: usize>(&mut self, count: usize) -> Option<&'a [[u8; N]]> {
        let (taken, rest) = self.rest.split_at_checked(count.checked_mul(N)?)?;
        self.rest = rest;
        Some(taken.as_chunks().0)
    }
}

/// The body of a model file, when its length and checksum are right.
fn checked_body<'a>(bytes: &'a [u8], path: &Path) -> Result<&'a [u8]> {
    let no_model = || Error::file(path, "not a rollin model", "name a file that `rollin train --model` wrote");
    let (magic, rest) = split_line(bytes).ok_or_else(no_model)?;
    let version = std::str::from_utf8(magic).ok().and_then(|line| line.strip_prefix(MAGIC)).ok_or_else(no_model)?;
    if version != VERSION.to_string() {
        let problem = format!("a model of format version {version}, but this program reads version {VERSION}");
        return Err(Error::file(path, problem, "train it again, or use the program that wrote it"));
    }
    let (line, body) = split_line(rest).ok_or_else(|| damaged(path, "its second line is missing"))?;
    let (length, sum) = std::str::from_utf8(line)
        .ok()
        .and_then(|line| line.split_once(" bytes, checksum "))
        .and_then(|(length, sum)| Some((length.parse::<usize>().ok()?, u64::from_str_radix(sum, 16).ok()?)))
        .filter(|(length, sum)| line == second_line(*length, *sum).as_bytes())
        .ok_or_else(|| damaged(path, "its second line gives no length and checksum"))?;
    if body.len() != length {
        return Err(damaged(path, &format!("it has {} bytes of {length}", body.len())));
    }
    if checksum(body) != sum {
        return Err(damaged(path, "its checksum is wrong"));
    }
    Ok(body)
}

/// The line that tells the body's length and checksum.
fn second_line(length: usize, sum: u64) -> String {
    format!("{length} bytes, checksum {sum:016x}")
}

fn damaged(path: &Path, what: &str) -> Error {
    Error::file(path, format!("the model is damaged: {what}"), "copy or train it again")
}

/// The first line without its end, and the rest.
fn split_line(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = memchr::memchr(b'\n', bytes)?;
    Some((&bytes[..end], &bytes[end + 1..]))
}

fn checksum(bytes: &[u8]) -> u64 {
    rapidhash::v3::rapidhash_v3(bytes)
}
