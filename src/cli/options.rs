//! Options that several commands share.

use super::tasks::Verbs;
use super::terminal::tell;
use crate::corpus::Corpus;
use crate::error::{Error, Result};
use crate::learner::{CrammerSinger, Csoaa, FilterTree, Hinge, Logistic, Net, Perceptron, Svm, Wap};
use crate::read::input;
use crate::read::template::Template;
use crate::tasks::graph::Visit;
use crate::tasks::tagging::{self, LabelColumn, Order};
use crate::tasks::{AnyLearner, Data, MOST_UNITS, Task};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};

/// Reads a corpus from a file, packed or not, or from standard input where `path` is `-`.
pub fn read_corpus<T: Task>(path: &Path) -> Result<T::Data> {
    T::parse(&input::bytes(path)?, input::name(path))
}

/// How a corpus is understood.
#[derive(Args)]
#[command(next_help_heading = "Columns and features")]
pub struct Reading {
    /// Feature template in the pattern language of CRF++ and Wapiti [default: one that looks at all columns before the labels']
    #[arg(long, value_name = "FILE")]
    pub template: Option<PathBuf>,
    /// The column the labels stand in, from 0 [default: the last]
    #[arg(long, value_name = "N")]
    pub label_column: Option<usize>,
    /// Which label may follow which [default: iob2 if all labels are O, B-X or I-X and keep to that rule, bilou if some are L-X, U-X, E-X or S-X, too,
    /// otherwise free]
    #[arg(long, value_enum, value_name = "RULE")]
    pub order: Option<OrderName>,
    /// Change labels that break the rule to those of the spans that conlleval reads in them, and say so on standard error
    #[arg(long)]
    pub repair: bool,
    /// Learn from the first N sentences only [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub first: Option<u64>,
    /// The longest span that a segmenter takes, in tokens, at most 64 [default: 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=64))]
    pub span: Option<u8>,
    /// The moves of a parser [default: arc-hybrid]
    #[arg(long, value_enum, value_name = "NAME")]
    pub system: Option<SystemName>,
    /// Leave out features that are seen fewer times, in tagging those of the words alone [default: parsing 2, tagging 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..))]
    pub cutoff: Option<u8>,
    /// The side of the largest square patch of pixels that a reader of letters sees, 1 to 3 [default: 1]
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u8).range(1..=3))]
    pub patch: Option<u8>,
    /// How many of the letters before it sees, at most 25 [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(..=25))]
    pub history: Option<u8>,
    /// Let it see how many letters are still to come, too
    #[arg(long)]
    pub rest: bool,
    /// How often it goes over a word, 1 to 8 [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=8))]
    pub times: Option<u8>,
    /// The order in which the nodes of a graph are labelled [default: bfs]
    #[arg(long, value_enum, value_name = "ORDER")]
    pub visit: Option<VisitName>,
    /// What a step to terrain a, b, ... costs, which only the expert of navigation knows [default: 1,2,4,8,16]
    #[arg(long, value_delimiter = ',', value_name = "COSTS", allow_negative_numbers = true)]
    pub costs: Option<Vec<f64>>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum VisitName {
    /// As they stand in the file
    File,
    /// The first in the file, then those reached from it, the nearest first
    Bfs,
    /// Those with the most edges first
    Degree,
}

impl From<VisitName> for Visit {
    fn from(name: VisitName) -> Self {
        match name {
            VisitName::File => Visit::File,
            VisitName::Bfs => Visit::Bfs,
            VisitName::Degree => Visit::Degree,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SystemName {
    /// Projective trees only, with an exact dynamic oracle
    #[value(name = "arc-hybrid")]
    Hybrid,
    /// Projective trees only, with an exact dynamic oracle too
    #[value(name = "arc-standard")]
    Standard,
    /// All trees (Nivre 2009)
    #[value(name = "arc-standard-swap")]
    Swap,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum OrderName {
    /// Any label after any other
    Free,
    /// I-X only after B-X or I-X
    Iob2,
    /// U-X alone, or B-X, any number of I-X and L-X; S-X and E-X are read as U-X and L-X
    Bilou,
}

impl From<OrderName> for Order {
    fn from(name: OrderName) -> Self {
        match name {
            OrderName::Free => Order::Free,
            OrderName::Iob2 => Order::Bio,
            OrderName::Bilou => Order::Bilou,
        }
    }
}

/// How labels that break the rule are met.
#[derive(Clone, Copy)]
pub struct Mending {
    /// Whether they are mended.
    pub repair: bool,
    /// What follows where they are not, to be told with the first of them; nothing is told where they will be refused.
    pub otherwise: Option<&'static str>,
    /// Where the labels stand.
    pub labels: LabelColumn,
    /// The rule; by default what the labels suggest.
    pub order: Option<Order>,
}

/// How many labels are told one by one.
const TOLD: usize = 5;

impl Mending {
    /// Mends the labels of `corpus` or tells, on standard error, of the first that breaks the rule.
    pub fn mend(self, corpus: &mut Corpus) -> Result<()> {
        self.mend_column(corpus, self.labels.in_corpus(corpus)?)
    }

    /// The same for labels that stand in `column`, whatever else there is.
    pub fn mend_column(self, corpus: &mut Corpus, column: usize) -> Result<()> {
        if self.repair {
            let mended = tagging::repair(corpus, column, self.order)?;
            mended.iter().take(TOLD).for_each(|mended| tell("note", mended));
            if mended.len() > TOLD {
                tell("note", &format!("{}: {} more labels were changed", corpus.path.display(), mended.len() - TOLD));
            }
        } else if let Some(otherwise) = self.otherwise {
            let (illegal, order) = tagging::illegal(corpus, column, self.order);
            if let Some(first) = illegal.first() {
                let (place, label) = (corpus.place(*first, column), corpus.word(column, *first));
                let more = match illegal.len() {
                    1 => String::new(),
                    n => format!(" and {} more", n - 1),
                };
                tell(
                    "note",
                    &format!("{place}: label {label}{more} may not stand there by {}, {otherwise}", order.name()),
                );
            }
        }
        Ok(())
    }
}

impl Reading {
    /// Refuses options of other tasks than `task`.
    pub fn refuse_others(&self, task: &str) -> Result<()> {
        let options = [
            ("--template", "tagging segmenting", self.template.is_some()),
            ("--label-column", "tagging segmenting", self.label_column.is_some()),
            ("--span", "segmenting", self.span.is_some()),
            ("--order", "tagging", self.order.is_some()),
            ("--repair", "tagging", self.repair),
            ("--system", "parsing", self.system.is_some()),
            ("--cutoff", "tagging parsing", self.cutoff.is_some()),
            ("--patch", "ocr", self.patch.is_some()),
            ("--history", "ocr", self.history.is_some()),
            ("--rest", "ocr", self.rest),
            ("--times", "ocr", self.times.is_some()),
            ("--visit", "graph", self.visit.is_some()),
            ("--costs", "navigation", self.costs.is_some()),
        ];
        match options.iter().find(|(_, of, given)| *given && of.split(' ').all(|of| of != task)) {
            Some((name, ..)) => Err(no_such_setting(name, task)),
            None => Ok(()),
        }
    }

    /// Reads the corpus at `path` as far as it is to be used.
    pub fn corpus<T: Verbs>(&self, path: &Path) -> Result<T::Data> {
        let mut corpus = read_corpus::<T>(path)?;
        if let Some(first) = self.first {
            corpus.truncate(usize::try_from(first).unwrap_or(usize::MAX));
        }
        T::mend(&mut corpus, self.mending())?;
        Ok(corpus)
    }

    /// How labels that break the rule are met.
    pub fn mending(&self) -> Mending {
        let otherwise = "so any label may follow any; --repair mends this, --order free wants it so";
        Mending {
            repair: self.repair,
            // A rule that was asked for is nobody's guess: what breaks it is refused.
            otherwise: self.order.is_none().then_some(otherwise),
            labels: self.labels(),
            order: self.order.map(Order::from),
        }
    }

    pub fn labels(&self) -> LabelColumn {
        self.label_column.map_or(LabelColumn::Last, LabelColumn::At)
    }

    /// The template, by default one for what `corpus` has before its labels. None may look at the labels themselves.
    pub fn template(&self, corpus: &Corpus) -> Result<Template> {
        self.template_or(corpus, Template::default_for)
    }

    /// The same with another default, which is made for so many columns.
    pub fn template_or(&self, corpus: &Corpus, default: impl Fn(usize) -> Template) -> Result<Template> {
        let labels = self.labels().in_corpus(corpus)?;
        let Some(path) = &self.template else {
            if labels == 0 {
                let expected =
                    "above 0, or come with a --template: the default one looks at the columns before the labels'";
                return Err(Error::argument("--label-column", 0, expected));
            }
            return Ok(default(labels));
        };
        read_template(path, labels)
    }
}

/// Reads a template that may not look at the column of labels.
pub fn read_template(path: &Path, labels: usize) -> Result<Template> {
    let template = Template::read_file(path)?;
    match template.refers_to(labels) {
        Some(place) => {
            Err(Error::data(place.clone(), format!("column {labels}, that of the labels"), "another column"))
        }
        None => Ok(template),
    }
}

/// The option `name` is given though `what` has no such thing.
pub fn no_such_setting(name: &'static str, what: &str) -> Error {
    Error::argument(name, "given", format!("left out: {what} has no such setting"))
}

/// A learner's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LearnerName {
    /// Averaged perceptron (0-1)
    Perceptron,
    /// Logistic regression, AdaGrad (0-1)
    Logistic,
    /// The multiclass hinge loss, AdaGrad: fast (cost-sensitive)
    Hinge,
    /// Cost-sensitive one-against-all regression
    Csoaa,
    /// Weighted all pairs (cost-sensitive)
    Wap,
    /// Filter tree: a tournament of actions (cost-sensitive)
    FilterTree,
    /// Support vector machines for all pairs (cost-sensitive)
    Svm,
    /// The multiclass support vector machine (cost-sensitive)
    CrammerSinger,
    /// A net of one hidden layer, Adam (0-1)
    Net,
}

impl LearnerName {
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// A learner with its settings.
#[derive(Args)]
#[command(next_help_heading = "The learner")]
pub struct LearnerOptions {
    /// What fits a classifier to the expert's answers; not for early-update, which learns by itself
    #[arg(long, value_enum, default_value = "logistic", value_name = "NAME")]
    pub learner: LearnerName,
    /// Passes over the examples each time the learner fits, at most for svm and crammer-singer; dagger-online, lols-online and searn-online
    /// make one a round whatever is given [default: 5, wap 3, svm 100, crammer-singer 50, net 10]
    #[arg(long, value_name = "N")]
    passes: Option<usize>,
    /// AdaGrad's rate, or Adam's for net, for every learner but perceptron, svm and crammer-singer [default: 0.1, wap and filter-tree 0.2, net 0.005]
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    rate: Option<f32>,
    /// L2 penalty per example, for every learner but perceptron, svm, crammer-singer and net [default: 0]
    #[arg(long, value_name = "WEIGHT", allow_negative_numbers = true)]
    l2: Option<f32>,
    /// Probability of a mistake below which logistic leaves an example alone: more is faster [default: 0.01]
    #[arg(long, value_name = "P", allow_negative_numbers = true)]
    tolerance: Option<f32>,
    /// What a margin error costs svm and crammer-singer: C [default: 0.1]
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    cost: Option<f32>,
    /// Units in the hidden layer of net, at most 65536; 0 is none [default: 64]
    #[arg(long, value_name = "N")]
    units: Option<usize>,
}

impl LearnerOptions {
    /// Refuses `--passes`, and says why.
    pub fn refuse_passes(&self, why: &str) -> Result<()> {
        match self.passes {
            Some(_) => Err(Error::argument("--passes", "given", format!("left out: {why}"))),
            None => Ok(()),
        }
    }

    pub fn learner(&self) -> Result<AnyLearner> {
        if self.passes == Some(0) {
            return Err(Error::argument("--passes", 0, "at least 1"));
        }
        if let Some(rate) = self.rate.filter(|rate| !(*rate > 0.0 && rate.is_finite())) {
            return Err(Error::argument("--rate", rate, "above 0"));
        }
        if let Some(l2) = self.l2.filter(|l2| !(*l2 >= 0.0 && l2.is_finite())) {
            return Err(Error::argument("--l2", l2, "0 or more"));
        }
        if let Some(tolerance) = self.tolerance.filter(|tolerance| !(*tolerance >= 0.0 && *tolerance < 1.0)) {
            return Err(Error::argument("--tolerance", tolerance, "at least 0 and below 1"));
        }
        if let Some(cost) = self.cost.filter(|cost| !(*cost > 0.0 && cost.is_finite())) {
            return Err(Error::argument("--cost", cost, "above 0"));
        }
        if let Some(units) = self.units.filter(|units| *units > MOST_UNITS) {
            return Err(Error::argument("--units", units, format!("at most {MOST_UNITS}")));
        }
        self.refuse_others()?;
        let given =
            |passes, rate, l2| (self.passes.unwrap_or(passes), self.rate.unwrap_or(rate), self.l2.unwrap_or(l2));
        Ok(match self.learner {
            LearnerName::Perceptron => {
                AnyLearner::Perceptron(Perceptron { passes: self.passes.unwrap_or(Perceptron::default().passes) })
            }
            LearnerName::Logistic => {
                let default = Logistic::default();
                let (passes, rate, l2) = given(default.passes, default.rate, default.l2);
                let tolerance = self.tolerance.unwrap_or(default.tolerance);
                AnyLearner::Logistic(Logistic { passes, rate, l2, tolerance, ..Logistic::default() })
            }
            LearnerName::Hinge => {
                let default = Hinge::default();
                let (passes, rate, l2) = given(default.passes, default.rate, default.l2);
                AnyLearner::Hinge(Hinge { passes, rate, l2 })
            }
            LearnerName::Csoaa => {
                let default = Csoaa::default();
                let (passes, rate, l2) = given(default.passes, default.rate, default.l2);
                AnyLearner::Csoaa(Csoaa { passes, rate, l2 })
            }
            LearnerName::FilterTree => {
                let default = FilterTree::default();
                let (passes, rate, l2) = given(default.passes, default.rate, default.l2);
                AnyLearner::FilterTree(FilterTree { passes, rate, l2 })
            }
            LearnerName::Wap => {
                let default = Wap::default();
                let (passes, rate, l2) = given(default.passes, default.rate, default.l2);
                AnyLearner::Wap(Wap { passes, rate, l2 })
            }
            LearnerName::Svm => {
                let default = Svm::default();
                let (passes, cost) = (self.passes.unwrap_or(default.passes), self.cost.unwrap_or(default.cost));
                AnyLearner::Svm(Svm { passes, cost, ..default })
            }
            LearnerName::CrammerSinger => {
                let default = CrammerSinger::default();
                let (passes, cost) = (self.passes.unwrap_or(default.passes), self.cost.unwrap_or(default.cost));
                AnyLearner::CrammerSinger(CrammerSinger { passes, cost, ..default })
            }
            LearnerName::Net => {
                let default = Net::default();
                let (passes, rate, _) = given(default.passes, default.rate, 0.0);
                AnyLearner::Net(Net { units: self.units.unwrap_or(default.units), passes, rate, ..default })
            }
        })
    }

    /// Refuses a setting that the learner does not have.
    fn refuse_others(&self) -> Result<()> {
        let margin = matches!(self.learner, LearnerName::Svm | LearnerName::CrammerSinger);
        let gradient = !margin && self.learner != LearnerName::Perceptron;
        let settings = [
            ("--rate", self.rate.is_some(), gradient),
            ("--l2", self.l2.is_some(), gradient && self.learner != LearnerName::Net),
            ("--tolerance", self.tolerance.is_some(), self.learner == LearnerName::Logistic),
            ("--cost", self.cost.is_some(), margin),
            ("--units", self.units.is_some(), self.learner == LearnerName::Net),
        ];
        match settings.iter().find(|(_, given, has)| *given && !has) {
            Some((name, ..)) => Err(no_such_setting(name, &self.learner.name())),
            None => Ok(()),
        }
    }
}

/// How a mixture is read, on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ReadingName {
    /// One member drawn at each step: the paper's policy
    Sampled,
    /// The label that most of the weight chooses
    Vote,
    /// The label with the highest mean score; linear classifiers become one
    Mean,
}

impl From<ReadingName> for crate::policy::Reading {
    fn from(name: ReadingName) -> Self {
        match name {
            ReadingName::Sampled => Self::Sampled,
            ReadingName::Vote => Self::Vote,
            ReadingName::Mean => Self::Mean,
        }
    }
}
