//! `rollin inspect`

use super::options::no_such_setting;
use super::report::spoken_json;
use super::tasks::{read_model, with_task};
use super::terminal::{headed, heading, names};
use super::train::to_json;
use super::{Global, print, print_json};
use crate::error::{Error, Result};
use crate::policy::Linear;
use crate::read::input;
use crate::report::{Table, grouped};
use crate::space::Action;
use crate::tasks::{Fact, Learned, Model, Names, Parts, Task};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Tell what is in a model file: where it comes from and what it cost, how large it is, and which features speak for which label.
///
/// A model keeps hashes of its features, no names: a text of the task in which they occur gives them back. That is the one it was trained on, where that still
/// stands there, or any other by --data. What weights say is told where the model decides by sums of weights: not for nets, for mixtures that vote or are drawn from,
/// and for learners of pairs.
#[derive(Args)]
#[command(after_help = super::help::inspect())]
pub struct Inspect {
    /// The model file (- for standard input)
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// The most features to tell of each label, and of what follows what; 0 is none
    #[arg(long, default_value_t = 5, value_name = "N")]
    top: usize,
    /// Tell of this label only
    #[arg(long, value_name = "LABEL")]
    label: Option<String>,
    /// A text from which the names of features are taken [default: what the model was trained on, where it is still there]
    #[arg(long, value_name = "FILE")]
    data: Option<PathBuf>,
}

/// What speaks most for a label, and what most against it.
#[derive(Serialize)]
struct Told {
    label: String,
    #[serde(rename = "for")]
    pro: Vec<Weighted>,
    against: Vec<Weighted>,
}

/// A feature's weight.
#[derive(Serialize)]
struct Weighted {
    /// Its name, or its number where that is not known.
    feature: String,
    weight: f32,
}

/// What a label's coming after another weighs.
#[derive(Serialize)]
struct Step {
    /// None at the start.
    before: Option<String>,
    label: String,
    weight: f32,
}

/// What the weights say.
#[derive(Serialize)]
struct Weights {
    /// Whether names were found.
    names: Option<PathBuf>,
    labels: Vec<Told>,
    transitions: Vec<Step>,
}

impl Inspect {
    pub fn run(&self, global: &Global) -> Result<()> {
        let (bytes, task) = read_model(&self.model)?;
        with_task!(task, T => self.tell(&Model::<T>::from_bytes(&bytes, input::name(&self.model))?, bytes.len(), global))
    }

    fn tell<T: Task>(&self, model: &Model<T>, size: usize, global: &Global) -> Result<()> {
        let (own, parts) = (model.encoding.facts(), model.parts(size));
        let weights = self.weights(model)?;
        let shares: Vec<f64> = match &model.policy {
            Learned::Mixture(mixture) => mixture.members().iter().map(|(weight, _)| *weight).collect(),
            _ => Vec::new(),
        };
        let (kind, reading) = kind(&model.policy);
        let rows: Vec<usize> = model.policy.classifiers().iter().map(|c| c.weights().len()).collect();
        if global.json {
            let mut report = serde_json::json!({
                "model": self.model,
                "task": T::NAME,
                "features": model.encoding.features(),
                "policy": kind,
                "weights": shares,
                "rows": rows,
                "temperatures": model.temperatures,
                "about": model.about,
                "size": parts,
                "top": weights,
            });
            own.into_iter().for_each(|fact| report[fact.name] = fact.value);
            return print_json(&report);
        }
        let mut classifiers = Table::new(["classifier", "weight", "features with weights"]);
        for (i, rows) in rows.iter().enumerate() {
            let weight = shares.get(i).map_or("-".to_owned(), |w| format!("{w:.4}"));
            classifiers.row([(i + 1).to_string(), weight, grouped(*rows as f64)]);
        }
        let (long, lines): (Vec<_>, Vec<_>) =
            own.into_iter().filter(|fact| !fact.text.is_empty()).partition(|fact| fact.text.contains('\n'));
        let long: String = long.iter().map(|fact| format!("\n{}{}\n", heading(fact.name), fact.text)).collect();
        let facts = facts(model, format!("{kind}{reading}"), lines);
        let (bill, sizes) = (headed(&bill(model)), headed(&sizes(&parts)));
        let top = weights.map_or_else(String::new, |weights| weights.text());
        print(&format!("{facts}\n{bill}\n{sizes}\n{}{long}{top}", headed(&classifiers)))
    }

    /// What the weights say, where they are summed up and anything is asked of them.
    fn weights<T: Task>(&self, model: &Model<T>) -> Result<Option<Weights>> {
        let asked = self.label.is_some() || self.data.is_some();
        if asked && !T::NAMED {
            let option = if self.label.is_some() { "--label" } else { "--data" };
            return Err(no_such_setting(option, T::NAME));
        }
        let labels: Vec<String> =
            (0..model.encoding.actions() as u32).map(|a| model.encoding.label(Action(a))).collect();
        if let Some(label) = self.label.as_ref().filter(|label| !labels.contains(label)) {
            let known: Vec<&str> = labels.iter().map(String::as_str).collect();
            return Err(Error::argument("--label", label, format!("one of {}", names(label, &known))));
        }
        let sums = model.policy.sums();
        let Some(linear) = sums.as_ref().and_then(|steps| steps.first()).filter(|_| T::NAMED && self.top > 0) else {
            return Ok(None);
        };
        let (from, name) = self.names(model)?;
        let told = |(action, label): (usize, &String)| self.told(linear, action, label, &name);
        let wanted = |(_, label): &(usize, &String)| self.label.as_ref().is_none_or(|wanted| wanted == *label);
        Ok(Some(Weights {
            names: from,
            labels: labels.iter().enumerate().filter(wanted).map(told).collect(),
            transitions: self.transitions(model, linear, &labels),
        }))
    }

    /// What tells the names of features, and which file it has them from.
    fn names<'m, T: Task>(&self, model: &'m Model<T>) -> Result<(Option<PathBuf>, Names<'m>)> {
        let read = |path: &Path| model.names(&T::parse(&input::bytes(path)?, input::name(path))?);
        if let Some(path) = &self.data {
            return Ok((Some(path.clone()), read(path)?));
        }
        // Nobody asked for it: where it is gone or is another one by now, there are no names.
        let path = Path::new(&model.about.data);
        match path.is_file().then(|| read(path)) {
            Some(Ok(names)) => Ok((Some(path.to_owned()), names)),
            _ => Ok((None, Box::new(|_| None))),
        }
    }

    /// What speaks most for and against the label that is `action`; of equals the first.
    fn told(&self, linear: &Linear, action: usize, label: &str, name: &Names<'_>) -> Told {
        let numbers = 0..linear.weights.features() as u32;
        let weight = |feature: u32| Some((feature, linear.weights.row(feature)?[action])).filter(|(_, w)| *w != 0.0);
        let mut all: Vec<(u32, f32)> = numbers.filter_map(weight).collect();
        all.sort_by(|(_, a), (_, b)| b.total_cmp(a));
        let tell = |(feature, weight): &(u32, f32)| Weighted {
            feature: name(*feature).unwrap_or_else(|| format!("feature {feature}")),
            weight: *weight,
        };
        let pro = all.iter().take_while(|(_, w)| *w > 0.0).take(self.top).map(tell).collect();
        let against = all.iter().rev().take_while(|(_, w)| *w < 0.0).take(self.top).map(tell).collect();
        Told { label: label.to_owned(), pro, against }
    }

    /// The strongest of what the label before alone says of the next one.
    fn transitions<T: Task>(&self, model: &Model<T>, linear: &Linear, labels: &[String]) -> Vec<Step> {
        let mut steps: Vec<Step> = Vec::new();
        for (before, feature) in model.encoding.transitions() {
            let before = before.map(|action| labels[action.index()].clone());
            let wanted = |label: &String| self.label.as_ref().is_none_or(|w| w == label || Some(w) == before.as_ref());
            let row = linear.weights.row(feature).unwrap_or_default();
            let some = labels.iter().zip(row).filter(|(label, weight)| **weight != 0.0 && wanted(label));
            steps.extend(some.map(|(label, weight)| Step {
                before: before.clone(),
                label: label.clone(),
                weight: *weight,
            }));
        }
        steps.sort_by(|a, b| b.weight.abs().total_cmp(&a.weight.abs()));
        steps.truncate(2 * self.top);
        steps
    }
}

/// What a policy is, and how it is read.
fn kind(policy: &Learned) -> (&'static str, String) {
    match policy {
        Learned::Mixture(mixture) if mixture.members().len() == 1 => ("one classifier", String::new()),
        Learned::Mixture(mixture) => {
            ("mixture", format!(", read as {}", to_json(&mixture.reading()).trim_matches('"')))
        }
        Learned::Ladder(_) => ("one classifier per step", String::new()),
        Learned::Beam(beam) => ("one classifier with a beam", format!(", {} wide", beam.width)),
        Learned::Stacked(stages) => ("two stages", format!(", window {}", stages.window)),
        Learned::Readings { .. } => ("two readings", String::new()),
    }
}

/// What a line says: how it came to be, and what the task has to tell.
fn facts<T: Task>(model: &Model<T>, policy: String, own: Vec<Fact>) -> String {
    let about = &model.about;
    let facts = [
        ("policy", policy),
        ("trainer", spoken_json(&about.trainer)),
        ("learner", spoken_json(&about.learner)),
        ("seed", about.seed.to_string()),
        ("trained on", about.data.clone()),
        (T::UNITS.episodes, grouped(about.sentences as f64)),
        (T::UNITS.steps, grouped(about.tokens as f64)),
    ];
    let temperatures: Vec<String> = model.temperatures.iter().map(|t| format!("{t:.3}")).collect();
    let expert = (!about.expert.is_empty()).then(|| ("expert", about.expert.clone()));
    let calibrated = (!temperatures.is_empty()).then(|| ("temperatures", temperatures.join(" ")));
    let stopped = about.stopped.map(|round| ("stopped", format!("before its end, after round {round}")));
    let own = own.into_iter().map(|fact| (fact.name, fact.text));
    let facts = facts.into_iter().chain(expert).chain(stopped).chain(calibrated).chain(own);
    facts.map(|(name, fact)| format!("{name:<16}{fact}\n")).collect()
}

/// What training cost, all of it.
fn bill<T: Task>(model: &Model<T>) -> Table {
    let ledger = &model.about.ledger;
    let mut table = Table::new(["the bill", "measured"]);
    for (name, count) in [
        ("expert queries", ledger.queries),
        ("expert's labels", ledger.labels),
        ("expert acts", ledger.expert_acts),
        ("roll-out acts", ledger.rollout_acts),
        ("roll-outs", ledger.rollouts),
        ("resets", ledger.resets),
        ("steps", ledger.steps),
        ("examples", ledger.examples),
    ] {
        table.row([name.to_owned(), grouped(count as f64)]);
    }
    table
}

/// How large which part of the file is.
fn sizes(parts: &Parts) -> Table {
    let mut table = Table::new(["part of the file", "numbers", "bytes"]);
    let all = parts.header + parts.dictionaries + parts.features + parts.weights;
    for (name, numbers, bytes) in [
        ("header", "-".to_owned(), parts.header),
        ("dictionaries", grouped((parts.dictionaries / 8) as f64), parts.dictionaries),
        ("features", grouped((parts.features / 4) as f64), parts.features),
        ("weights", grouped((parts.weights / 4) as f64), parts.weights),
        ("all", "-".to_owned(), all),
    ] {
        table.row([name.to_owned(), numbers, grouped(bytes as f64)]);
    }
    table
}

impl Weights {
    /// For a person.
    fn text(&self) -> String {
        let mut text = match &self.names {
            Some(path) => format!("\nnames of features from {}\n", path.display()),
            None => {
                "\nno names of features: what the model was trained on is not there; give a text by --data\n".to_owned()
            }
        };
        for told in &self.labels {
            let mut table = Table::new([format!("label {}", told.label), "weight".to_owned()]);
            told.pro.iter().chain(told.against.iter().rev()).for_each(|weighted| {
                table.row([weighted.feature.clone(), format!("{:+.4}", weighted.weight)]);
            });
            text += &format!("\n{}", headed(&table));
        }
        if !self.transitions.is_empty() {
            let mut table = Table::new(["what follows what", "weight"]);
            for step in &self.transitions {
                let before = step.before.as_deref().unwrap_or("_");
                table.row([format!("{before} -> {}", step.label), format!("{:+.4}", step.weight)]);
            }
            text += &format!("\n{}", headed(&table));
        }
        text
    }
}
