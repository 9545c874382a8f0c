//! `rollin evaluate`

use super::mistakes::Mistakes;
use super::options::{ReadingName, read_corpus};
use super::report::{ReportOptions, Sources};
use super::tasks::{Verbs, read_model, with_task};
use super::{Global, closed, print, print_json};
use crate::error::Result;
use crate::learner::calibration_error;
use crate::read::input;
use crate::report::{Figure, Matrix, Page, Table};
use crate::seed::Seed;
use crate::tasks::{Data, Model, Score};
use clap::Args;
use std::path::PathBuf;

/// Compare a model's answers with the right ones: token accuracy and, where labels are spans, conlleval's measures per type; for trees
/// UAS and LAS, for handwriting letters and words, for graphs their nodes, for maps the path cost ratio, for tabular problems the exact expected cost.
#[derive(Args)]
#[command(after_help = super::help::evaluate())]
pub struct Evaluate {
    /// The model file (- for standard input)
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// The corpus, with the right labels (- for standard input)
    #[arg(long, value_name = "FILE")]
    data: PathBuf,
    /// The column the right labels stand in, from 0 [default: where they stood in training]
    #[arg(long, value_name = "N")]
    label_column: Option<usize>,
    /// Change right labels that break the model's rule to those of the spans that conlleval reads in them, and say so on standard error
    #[arg(long)]
    repair: bool,
    /// How to choose a label from a mixture of classifiers [default: as the model says]
    #[arg(long, value_enum, value_name = "NAME")]
    reading: Option<ReadingName>,
    /// Tell the commonest confusions and the sentences with the most wrong words, N of each, as far as the task has such things [default for --errors alone: 5]
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "5")]
    errors: Option<usize>,
    #[command(flatten)]
    report: ReportOptions,
}

impl Evaluate {
    pub fn run(&self, global: &Global) -> Result<()> {
        let (bytes, task) = read_model(&self.model)?;
        self.report.check(&[&self.model, &self.data])?;
        with_task!(task, T => self.run_with(Model::<T>::from_bytes(&bytes, input::name(&self.model))?, global))
    }

    fn run_with<T: Verbs>(&self, mut model: Model<T>, global: &Global) -> Result<()> {
        if let Some(reading) = self.reading {
            model = model.read_as(reading.into());
        }
        if let Some(column) = self.label_column {
            model.encoding.set_column(column)?;
        }
        let mut data = read_corpus::<T>(&self.data)?;
        model.encoding.check(&data)?;
        T::mend(&mut data, model.encoding.mending(self.repair))?;
        let space = model.encoding.apply(&data)?;
        let actions = model.perform(space, data.sentences(), 0, Seed::new(global.seed));
        let score = model.encoding.judge(&model.policy, &data, &actions)?;
        let sure = model.sure(&data, &actions, 0, Seed::new(global.seed))?;
        let right = model.encoding.right(&data, &actions)?;
        let mut answers = Matrix::default();
        model.encoding.answers(&data, &actions, &mut |right, given| answers.add(right, given))?;
        let mistakes =
            self.errors.map(|most| Mistakes::of(&model.encoding, &data, &actions, &answers, most)).transpose()?;
        let error = sure.map(|sure| calibration_error(sure.into_iter().zip(right)));
        if global.json {
            let mut report = serde_json::to_value(&score).map_err(|error| closed(error.into()))?;
            if let Some(error) = error {
                report["calibration_error"] = error.into();
            }
            if !answers.is_empty() {
                report["confusion"] = serde_json::to_value(&answers).map_err(|error| closed(error.into()))?;
            }
            if let Some(mistakes) = &mistakes {
                report["errors"] = serde_json::to_value(mistakes).map_err(|error| closed(error.into()))?;
            }
            print_json(&report)?;
        } else {
            let told = error.map(|error| format!("expected calibration error: {:.2}%\n", 100.0 * error));
            let mistakes = mistakes.as_ref().map_or_else(String::new, Mistakes::text);
            print(&(score.text() + &told.unwrap_or_default() + &mistakes))?;
        }
        let read = Sources { files: &[("model", &self.model), ("data", &self.data)], ..Sources::default() };
        let page = || {
            let mut page = page::<T>(&score, error, &answers);
            page.tables.extend(mistakes.iter().flat_map(Mistakes::tables));
            page
        };
        self.report.write(page, global, &read)
    }
}

/// What there is to be seen.
fn page<T: Verbs>(score: &T::Score, error: Option<f64>, answers: &Matrix) -> Page {
    let note = "A row holds the words of one right answer, a column those of one given answer; blue was right, red was wrong, and a cell is the \
                stronger, the larger its share of the row.";
    let mut measures = Table::new(["measure", "value"]);
    for measure in score.measures() {
        measure.percent.iter().for_each(|percent| measures.row([measure.name.to_owned(), format!("{percent:.2}")]));
    }
    if let Some(error) = error {
        measures.row(["expected calibration error %".to_owned(), format!("{:.2}", 100.0 * error)]);
    }
    let mut lines = Table::new(["All measures"]);
    score.text().lines().for_each(|line| lines.row([line]));
    Page {
        title: format!("How good a model for {} is", T::NAME),
        figures: match answers.is_empty() {
            true => Vec::new(),
            false => vec![Figure::matrix("confusion", "What was taken for what", note, answers)],
        },
        tables: vec![("Measures".to_owned(), measures), ("As text".to_owned(), lines)],
        ..Page::default()
    }
}
