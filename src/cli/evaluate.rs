//! `rollin evaluate`

use super::options::{ReadingName, check_columns, read_corpus};
use super::{Global, print, print_json};
use crate::corpus::Corpus;
use crate::error::Result;
use crate::score::{Scheme, Score};
use crate::seed::Seed;
use crate::tasks::tagging::{Encoding, LabelColumn, Tagger};
use clap::Args;
use std::path::PathBuf;

/// Compare a model's labels with the right ones: token accuracy and, where labels are spans, conlleval's measures per type.
#[derive(Args)]
pub struct Evaluate {
    /// The model file
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// The corpus, with the right labels (- for standard input)
    #[arg(long, value_name = "FILE")]
    data: PathBuf,
    /// The column the right labels stand in, from 0 [default: where they stood in training]
    #[arg(long, value_name = "N")]
    label_column: Option<usize>,
    /// How to choose a label from a mixture of classifiers [default: as the model says]
    #[arg(long, value_enum, value_name = "NAME")]
    reading: Option<ReadingName>,
}

impl Evaluate {
    pub fn run(&self, global: &Global) -> Result<()> {
        let mut tagger = Tagger::load(&self.model)?;
        if let Some(reading) = self.reading {
            tagger.policy = tagger.policy.read_as(reading.into());
        }
        if let Some(column) = self.label_column {
            tagger.encoding.label_column = column;
        }
        let corpus = read_corpus(&self.data)?;
        LabelColumn::At(tagger.encoding.label_column).in_corpus(&corpus)?;
        check_columns(&tagger.encoding, &corpus)?;
        let labels = tagger.tag(&corpus, Seed::new(global.seed))?;
        let score = score(&corpus, &tagger.encoding, &labels)?;
        if global.json {
            return print_json(&score);
        }
        if score.scheme().is_spans() {
            return print(&score.to_string());
        }
        print(&format!("processed {} tokens\naccuracy: {:6.2}%\n", score.tokens(), 100.0 * score.accuracy()))
    }
}

/// The score of `labels` against the right ones in `corpus`. Where a right label was never seen in training, the model is wrong.
pub fn score(corpus: &Corpus, encoding: &Encoding, labels: &[u32]) -> Result<Score> {
    let column = &corpus.columns[LabelColumn::At(encoding.label_column).in_corpus(corpus)?];
    let mut scheme = Scheme::new(&encoding.labels);
    let ids: Vec<u32> = column.values.iter().map(|name| scheme.id(name)).collect();
    let gold: Vec<u32> = column.cells.iter().map(|cell| ids[*cell as usize]).collect();
    let mut score = Score::new(scheme);
    for i in 0..corpus.sentences() {
        let sentence = corpus.sentence(i);
        score.add(&gold[sentence.clone()], &labels[sentence])?;
    }
    Ok(score)
}
