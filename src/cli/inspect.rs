//! `rollin inspect`

use super::options::order_name;
use super::train::to_json;
use super::{Global, print, print_json};
use crate::error::Result;
use crate::report::{Table, grouped};
use crate::tasks::tagging::{Learned, Tagger};
use clap::Args;
use std::path::PathBuf;

/// Tell what is in a model file.
#[derive(Args)]
pub struct Inspect {
    /// The model file
    #[arg(value_name = "MODEL")]
    model: PathBuf,
}

impl Inspect {
    pub fn run(&self, global: &Global) -> Result<()> {
        let tagger = Tagger::load(&self.model)?;
        let (encoding, about) = (&tagger.encoding, &tagger.about);
        let weights: Vec<f64> = match &tagger.policy {
            Learned::Mixture(mixture) => mixture.members().iter().map(|(weight, _)| *weight).collect(),
            Learned::Ladder(_) | Learned::Beam(_) | Learned::Stacked(_) => Vec::new(),
        };
        let (kind, reading) = match &tagger.policy {
            Learned::Mixture(mixture) if mixture.members().len() == 1 => ("one classifier", String::new()),
            Learned::Mixture(mixture) => {
                ("mixture", format!(", read as {}", to_json(&mixture.reading()).trim_matches('"')))
            }
            Learned::Ladder(_) => ("one classifier per step", String::new()),
            Learned::Beam(beam) => ("one classifier with a beam", format!(", {} wide", beam.width)),
            Learned::Stacked(stages) => ("two stages", format!(", window {}", stages.window)),
        };
        let rows: Vec<usize> = tagger.policy.classifiers().iter().map(|c| c.weights.len()).collect();
        if global.json {
            return print_json(&serde_json::json!({
                "model": self.model,
                "task": "tagging",
                "labels": encoding.labels,
                "order": order_name(encoding.transitions.order()),
                "template": encoding.template.text(),
                "features": encoding.features(),
                "policy": kind,
                "weights": weights,
                "rows": rows,
                "about": about,
            }));
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
            ("order", order_name(encoding.transitions.order()).to_owned()),
            ("labels", encoding.labels.join(" ")),
        ];
        let facts: String = facts.iter().map(|(name, fact)| format!("{name:<16}{fact}\n")).collect();
        let mut classifiers = Table::new(["classifier", "weight", "features with weights"]);
        for (i, rows) in rows.iter().enumerate() {
            let weight = weights.get(i).map_or("-".to_owned(), |w| format!("{w:.4}"));
            classifiers.row([(i + 1).to_string(), weight, grouped(*rows as f64)]);
        }
        print(&format!("{facts}\n{classifiers}\ntemplate\n{}\n", encoding.template.text().trim_end()))
    }
}
