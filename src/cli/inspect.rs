//! `rollin inspect`

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
    /// The model
    #[arg(value_name = "MODEL")]
    model: PathBuf,
}

impl Inspect {
    pub fn run(&self, global: &Global) -> Result<()> {
        let tagger = Tagger::load(&self.model)?;
        let (encoding, about) = (&tagger.encoding, &tagger.about);
        let weights: Vec<f64> = match &tagger.policy {
            Learned::Mixture(mixture) => mixture.members().iter().map(|(weight, _)| *weight).collect(),
            Learned::Ladder(_) => Vec::new(),
        };
        let (kind, reading) = match &tagger.policy {
            Learned::Mixture(mixture) if mixture.members().len() == 1 => ("one classifier", String::new()),
            Learned::Mixture(mixture) => {
                ("mixture", format!(", read as {}", to_json(&mixture.reading()).trim_matches('"')))
            }
            Learned::Ladder(_) => ("one classifier per step", String::new()),
        };
        let rows: Vec<usize> = tagger.policy.classifiers().iter().map(|c| c.weights.len()).collect();
        if global.json {
            return print_json(&serde_json::json!({
                "model": self.model,
                "task": "tagging",
                "labels": encoding.labels,
                "order": encoding.transitions.order(),
                "template": encoding.template.text(),
                "features": encoding.features(),
                "policy": kind,
                "weights": weights,
                "rows": rows,
                "about": about,
            }));
        }
        let mut facts = Table::default();
        facts.row(["policy".to_owned(), format!("{kind}{reading}")]);
        facts.row(["trainer", &about.trainer]);
        facts.row(["learner", &about.learner]);
        facts.row(["seed".to_owned(), about.seed.to_string()]);
        facts.row(["trained on".to_owned(), about.data.clone()]);
        facts.row(["sentences".to_owned(), grouped(about.sentences as f64)]);
        facts.row(["tokens".to_owned(), grouped(about.tokens as f64)]);
        facts.row(["expert's labels".to_owned(), grouped(about.ledger.labels as f64)]);
        facts.row(["expert queries".to_owned(), grouped(about.ledger.queries as f64)]);
        facts.row(["order".to_owned(), to_json(&encoding.transitions.order()).trim_matches('"').to_owned()]);
        facts.row(["labels".to_owned(), encoding.labels.join(" ")]);
        let mut classifiers = Table::new(["classifier", "weight", "features with weights"]);
        for (i, rows) in rows.iter().enumerate() {
            let weight = weights.get(i).map_or("-".to_owned(), |w| format!("{w:.4}"));
            classifiers.row([(i + 1).to_string(), weight, grouped(*rows as f64)]);
        }
        print(&format!("{facts}\n{classifiers}\ntemplate\n{}\n", encoding.template.text().trim_end()))
    }
}
