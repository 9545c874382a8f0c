//! The tasks as the command line knows them.

use super::compare::Both;
use super::options::{Mending, Reading, SystemName, no_such_setting};
use super::terminal::names;
use crate::corpus::Corpus;
use crate::error::{Error, Result};
use crate::read::input;
use crate::tasks::{Task, graph, navigation, ocr, parsing, segmenting, tabular, tagging, task_of};
use clap::ValueEnum;
use std::path::Path;

/// What is learned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum TaskName {
    /// One label for every token
    #[default]
    Tagging,
    /// Spans: the length and the label of the next one
    Segmenting,
    /// Dependency trees, from CoNLL-U
    Parsing,
    /// Handwritten words, letter by letter
    Ocr,
    /// Labels for the nodes of graphs
    Graph,
    /// Ways on maps, from what can be seen around
    Navigation,
    /// A small problem whose costs are known exactly, as for `rollin theory`
    Tabular,
}

/// Runs `$body` with `$T` standing for the task of this name.
macro_rules! with_task {
    ($name:expr, $T:ident => $body:expr) => {
        match $name {
            $crate::cli::tasks::TaskName::Tagging => {
                type $T = $crate::tasks::tagging::Encoding;
                $body
            }
            $crate::cli::tasks::TaskName::Segmenting => {
                type $T = $crate::tasks::segmenting::Spans;
                $body
            }
            $crate::cli::tasks::TaskName::Parsing => {
                type $T = $crate::tasks::parsing::Encoding;
                $body
            }
            $crate::cli::tasks::TaskName::Ocr => {
                type $T = $crate::tasks::ocr::Sightings;
                $body
            }
            $crate::cli::tasks::TaskName::Graph => {
                type $T = $crate::tasks::graph::Encoding;
                $body
            }
            $crate::cli::tasks::TaskName::Navigation => {
                type $T = $crate::tasks::navigation::Guide;
                $body
            }
            $crate::cli::tasks::TaskName::Tabular => {
                type $T = $crate::tasks::tabular::Chart;
                $body
            }
        }
    };
}
pub(crate) use with_task;

/// The bytes of a model file, and the task it is for.
pub fn read_model(path: &Path) -> Result<(Vec<u8>, TaskName)> {
    let bytes = input::raw(path)?;
    let path = input::name(path);
    let name = task_of(&bytes, path)?;
    match TaskName::from_str(&name, false) {
        Ok(task) => Ok((bytes, task)),
        Err(_) => {
            let known: Vec<String> = TaskName::value_variants().iter().filter_map(value_name).collect();
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            Err(Error::file(
                path,
                format!("a model for {name}"),
                format!("this program knows {}", names(&name, &known)),
            ))
        }
    }
}

/// The name of a value on the command line.
fn value_name(value: &impl ValueEnum) -> Option<String> {
    Some(value.to_possible_value()?.get_name().to_owned())
}

/// What the command line adds to a task.
pub trait Verbs: Task {
    /// The settings that `options` ask for, for what `data` is.
    fn settings(options: &Reading, data: &Self::Data) -> Result<Self::Settings>;

    /// Looks for the right labels in this column.
    fn set_column(&mut self, column: usize) -> Result<()> {
        let _ = column;
        Err(no_such_setting("--label-column", Self::NAME))
    }

    /// Meets labels that break their rule; there is such a thing in tagging only.
    fn mend(data: &mut Self::Data, how: Mending) -> Result<()> {
        let _ = data;
        if how.repair { Err(no_such_setting("--repair", Self::NAME)) } else { Ok(()) }
    }

    /// How labels are met that break the rule by which this was trained.
    fn mending(&self, repair: bool) -> Mending {
        Mending { repair, otherwise: None, labels: tagging::LabelColumn::Last, order: None }
    }

    /// What to compare on where no data are given.
    fn embedded() -> Option<Result<Both<Self::Data>>> {
        None
    }
}

impl Verbs for tagging::Encoding {
    fn settings(options: &Reading, data: &Corpus) -> Result<tagging::Settings> {
        Ok(tagging::Settings {
            template: Some(options.template(data)?),
            labels: options.labels(),
            order: options.mending().order,
            cutoff: options.cutoff.unwrap_or_default(),
        })
    }

    fn set_column(&mut self, column: usize) -> Result<()> {
        self.label_column = column;
        Ok(())
    }

    fn mend(data: &mut Corpus, how: Mending) -> Result<()> {
        how.mend(data)
    }

    fn mending(&self, repair: bool) -> Mending {
        let order = Some(self.transitions.order()).filter(|order| *order != tagging::Order::Free);
        let otherwise = order.map(|_| "so that the model, which keeps to that, is wrong there; --repair mends this");
        Mending { repair, otherwise, labels: tagging::LabelColumn::At(self.label_column), order }
    }

    fn embedded() -> Option<Result<Both<Corpus>>> {
        Some(super::compare::embedded())
    }
}

impl Verbs for segmenting::Spans {
    fn settings(options: &Reading, data: &Corpus) -> Result<segmenting::Settings> {
        let (labels, longest) = (options.labels(), options.span.map_or(LONGEST, u32::from));
        let template = options.template_or(data, |columns| segmenting::default_template(columns, longest))?;
        Ok(segmenting::Settings { template, labels, longest })
    }

    fn set_column(&mut self, column: usize) -> Result<()> {
        self.set_label_column(column);
        Ok(())
    }
}

/// The longest span where nothing else is asked for: one in a thousand of CoNLL-2000's is longer.
const LONGEST: u32 = 8;

impl Verbs for parsing::Encoding {
    fn settings(options: &Reading, _: &Self::Data) -> Result<parsing::Settings> {
        let default = parsing::Settings::default();
        let system = options.system.map_or(default.system, |name| match name {
            SystemName::Hybrid => parsing::System::ArcHybrid,
            SystemName::Standard => parsing::System::ArcStandard,
            SystemName::Swap => parsing::System::ArcStandardSwap,
        });
        Ok(parsing::Settings { system, cutoff: options.cutoff.unwrap_or(default.cutoff) })
    }
}

impl Verbs for ocr::Sightings {
    fn settings(options: &Reading, _: &Self::Data) -> Result<Self> {
        let default = Self::default();
        let see = ocr::Sightings {
            patch: options.patch.map_or(default.patch, usize::from),
            history: options.history.map_or(default.history, usize::from),
            rest: options.rest,
            passes: options.times.map_or(default.passes, usize::from),
        };
        see.validate().map(|()| see)
    }
}

impl Verbs for graph::Encoding {
    fn settings(options: &Reading, _: &Self::Data) -> Result<graph::Visit> {
        Ok(options.visit.map_or(graph::Visit::default(), graph::Visit::from))
    }
}

impl Verbs for navigation::Guide {
    fn settings(options: &Reading, _: &Self::Data) -> Result<Vec<f64>> {
        Ok(options.costs.clone().unwrap_or_else(|| navigation::Maps::default().costs))
    }
}

impl Verbs for tabular::Chart {
    fn settings(_: &Reading, _: &Self::Data) -> Result<()> {
        Ok(())
    }
}
