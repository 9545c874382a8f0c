//! `rollin inspect`

use super::tasks::{read_model, with_task};
use super::train::to_json;
use super::{Global, print, print_json};
use crate::error::Result;
use crate::read::input;
use crate::report::{Table, grouped};
use crate::tasks::{Learned, Model, Task};
use clap::Args;
use std::path::PathBuf;

/// Tell what is in a model file.
#[derive(Args)]
pub struct Inspect {
    /// The model file (- for standard input)
    #[arg(value_name = "MODEL")]
    model: PathBuf,
}

impl Inspect {
    pub fn run(&self, global: &Global) -> Result<()> {
        let (bytes, task) = read_model(&self.model)?;
        with_task!(task, T => self.tell(&Model::<T>::from_bytes(&bytes, input::name(&self.model))?, global))
    }

    fn tell<T: Task>(&self, model: &Model<T>, global: &Global) -> Result<()> {
        let (encoding, about) = (&model.encoding, &model.about);
        let own = encoding.facts();
        let weights: Vec<f64> = match &model.policy {
            Learned::Mixture(mixture) => mixture.members().iter().map(|(weight, _)| *weight).collect(),
            _ => Vec::new(),
        };
        let (kind, reading) = match &model.policy {
            Learned::Mixture(mixture) if mixture.members().len() == 1 => ("one classifier", String::new()),
            Learned::Mixture(mixture) => {
                ("mixture", format!(", read as {}", to_json(&mixture.reading()).trim_matches('"')))
            }
            Learned::Ladder(_) => ("one classifier per step", String::new()),
            Learned::Beam(beam) => ("one classifier with a beam", format!(", {} wide", beam.width)),
            Learned::Stacked(stages) => ("two stages", format!(", window {}", stages.window)),
            Learned::Readings { .. } => ("two readings", String::new()),
        };
        let rows: Vec<usize> = model.policy.classifiers().iter().map(|c| c.weights().len()).collect();
        if global.json {
            let mut report = serde_json::json!({
                "model": self.model,
                "task": T::NAME,
                "features": encoding.features(),
                "policy": kind,
                "weights": weights,
                "rows": rows,
                "temperatures": model.temperatures,
                "about": about,
            });
            own.into_iter().for_each(|fact| report[fact.name] = fact.value);
            return print_json(&report);
        }
        let facts = [
            ("policy", format!("{kind}{reading}")),
            ("trainer", about.trainer.clone()),
            ("learner", about.learner.clone()),
            ("seed", about.seed.to_string()),
            ("trained on", about.data.clone()),
            ("sentences", grouped(about.sentences as f64)),
            ("tokens", grouped(about.tokens as f64)),
            ("expert's labels", grouped(about.ledger.labels as f64)),
            ("expert queries", grouped(about.ledger.queries as f64)),
        ];
        let temperatures: Vec<String> = model.temperatures.iter().map(|t| format!("{t:.3}")).collect();
        let expert = (!about.expert.is_empty()).then(|| ("expert", about.expert.clone()));
        let calibrated = (!temperatures.is_empty()).then(|| ("temperatures", temperatures.join(" ")));
        let (long, lines): (Vec<_>, Vec<_>) =
            own.into_iter().filter(|fact| !fact.text.is_empty()).partition(|fact| fact.text.contains('\n'));
        let facts = facts
            .into_iter()
            .chain(expert)
            .chain(calibrated)
            .chain(lines.into_iter().map(|fact| (fact.name, fact.text)));
        let facts: String = facts.map(|(name, fact)| format!("{name:<16}{fact}\n")).collect();
        let long: String = long.into_iter().map(|fact| format!("\n{}{}\n", fact.name, fact.text)).collect();
        let mut classifiers = Table::new(["classifier", "weight", "features with weights"]);
        for (i, rows) in rows.iter().enumerate() {
            let weight = weights.get(i).map_or("-".to_owned(), |w| format!("{w:.4}"));
            classifiers.row([(i + 1).to_string(), weight, grouped(*rows as f64)]);
        }
        print(&format!("{facts}\n{classifiers}{long}"))
    }
}
