//! Options that several commands share.

use crate::corpus::Corpus;
use crate::error::{Error, Result};
use crate::learner::{CrammerSinger, Csoaa, FilterTree, Logistic, Perceptron, Svm, Wap};
use crate::read::{conll, template::Template};
use crate::tasks::tagging::{AnyLearner, Encoding, LabelColumn, Order, Trainer};
use crate::trainer::{Dagger, Forward, Reuse, Searn, Smile, Supervised};
use clap::{Args, ValueEnum};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Reads a corpus from a file, or from standard input where `path` is `-`.
pub fn read_corpus(path: &Path) -> Result<Corpus> {
    if path != Path::new("-") {
        return conll::read_file(path);
    }
    let mut text = Vec::new();
    std::io::stdin().lock().read_to_end(&mut text).map_err(|error| Error::io("read", "<stdin>", error))?;
    conll::parse(&text, "<stdin>".as_ref(), 1)
}

/// Refuses a corpus that has fewer columns than `encoding` looks at.
pub fn check_columns(encoding: &Encoding, corpus: &Corpus) -> Result<()> {
    let (needed, found) = (encoding.template.columns(), corpus.columns.len());
    if found >= needed {
        return Ok(());
    }
    let expected = format!("at least {}, because the model looks at column {} (from 0)", columns(needed), needed - 1);
    Err(Error::data(corpus.place(0, 0), columns(found), expected))
}

/// So many columns, in words.
pub fn columns(n: usize) -> String {
    if n == 1 { "1 column".to_owned() } else { format!("{n} columns") }
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
    /// Which label may follow which [default: iob2 if all labels are O, B-X or I-X and keep to that rule, otherwise free]
    #[arg(long, value_enum, value_name = "RULE")]
    pub order: Option<OrderName>,
    /// Learn from the first N sentences only [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub first: Option<u64>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum OrderName {
    /// Any label after any other
    Free,
    /// I-X only after B-X or I-X
    Iob2,
}

impl Reading {
    /// Reads the corpus at `path` as far as it is to be used.
    pub fn corpus(&self, path: &Path) -> Result<Corpus> {
        let mut corpus = read_corpus(path)?;
        if let Some(first) = self.first {
            corpus.truncate(usize::try_from(first).unwrap_or(usize::MAX));
        }
        Ok(corpus)
    }

    pub fn labels(&self) -> LabelColumn {
        self.label_column.map_or(LabelColumn::Last, LabelColumn::At)
    }

    pub fn order(&self) -> Option<Order> {
        self.order.map(|name| match name {
            OrderName::Free => Order::Free,
            OrderName::Iob2 => Order::Bio,
        })
    }

    /// The template, by default one for what `corpus` has before its labels. None may look at the labels themselves.
    pub fn template(&self, corpus: &Corpus) -> Result<Template> {
        let labels = self.labels().in_corpus(corpus)?;
        let Some(path) = &self.template else {
            if labels == 0 {
                let expected =
                    "above 0, or come with a --template: the default one looks at the columns before the labels'";
                return Err(Error::argument("--label-column", 0, expected));
            }
            return Ok(Template::default_for(labels));
        };
        let template = Template::read_file(path)?;
        match template.refers_to(labels) {
            Some(place) => {
                Err(Error::data(place.clone(), format!("column {labels}, that of the labels"), "another column"))
            }
            None => Ok(template),
        }
    }
}

/// An order's name, as it is given on the command line.
pub fn order_name(order: Order) -> &'static str {
    match order {
        Order::Free => "free",
        Order::Bio => "iob2",
    }
}

/// A trainer's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Algorithm {
    /// Imitate the expert on the expert's own states
    Supervised,
    /// One classifier per step (Ross & Bagnell 2010, Algorithm 3.1)
    Forward,
    /// Stochastic mixing iterative learning (Algorithm 4.1)
    Smile,
    /// Search and learn, rolling out every action
    Searn,
    /// SEARN with the expert's own cost-to-go in place of roll-outs
    SearnShortcut,
    /// Dataset aggregation: fit anew on all labels after each round
    Dagger,
    /// Dataset aggregation with one online learner that goes on learning
    DaggerOnline,
}

impl Algorithm {
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// A learner's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LearnerName {
    /// Averaged perceptron (0-1)
    Perceptron,
    /// Logistic regression, AdaGrad (0-1)
    Logistic,
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
}

impl LearnerName {
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// How SMILe reuses samples, on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ReuseName {
    /// Not at all: Algorithm 4.1
    None,
    /// Algorithm 4.2 as printed
    #[value(name = "4.2")]
    Printed42,
    /// Algorithm 4.3 as printed
    #[value(name = "4.3")]
    Printed43,
    /// The exact form of 4.2
    R1,
    /// The exact form of 4.3
    R2,
    /// Exact, with the fewest new samples
    Ageing,
}

impl From<ReuseName> for Reuse {
    fn from(name: ReuseName) -> Self {
        match name {
            ReuseName::None => Reuse::None,
            ReuseName::Printed42 => Reuse::Printed42,
            ReuseName::Printed43 => Reuse::Printed43,
            ReuseName::R1 => Reuse::Coins,
            ReuseName::R2 => Reuse::Sites,
            ReuseName::Ageing => Reuse::Ageing,
        }
    }
}

/// A trainer's settings.
#[derive(Args)]
#[command(next_help_heading = "The algorithm's settings")]
pub struct TrainerOptions {
    /// Rounds of smile [default: 7], searn, searn-shortcut, dagger and dagger-online [default: 5]
    #[arg(long, value_name = "N")]
    rounds: Option<usize>,
    /// Mixing rate of smile, above 0 and at most 1 [default: 0.2]
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    alpha: Option<f64>,
    /// How smile reuses samples of earlier rounds; `--reuse` alone means ageing [default: none]
    #[arg(long, value_enum, value_name = "HOW", num_args = 0..=1, default_missing_value = "ageing")]
    reuse: Option<ReuseName>,
    /// Mixing rate of searn and searn-shortcut, above 0 and at most 1 [default: 0.3]
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    beta: Option<f64>,
    /// Roll-outs of searn for each action [default: 1]
    #[arg(long, value_name = "N")]
    rollouts: Option<usize>,
    /// Steps of forward that get a classifier of their own [default: 256]
    #[arg(long, value_name = "N")]
    longest: Option<usize>,
    /// Let each new classifier start from the one before (not for supervised and dagger-online)
    #[arg(long)]
    warm: bool,
}

impl TrainerOptions {
    /// Refuses a setting that is out of its range, or given though none of the trainers of these names has it.
    pub fn check(&self, algorithms: &[Algorithm]) -> Result<()> {
        let settings: Vec<_> = algorithms.iter().map(|algorithm| self.settings(*algorithm)).collect();
        for i in 0..settings.first().map_or(0, |all| all.len()) {
            let (name, given, _) = settings[0][i];
            if given && !settings.iter().any(|all| all[i].2) {
                let names: Vec<String> = algorithms.iter().map(|a| a.name()).collect();
                let have = if names.len() == 1 { "has" } else { "have" };
                let expected = format!("left out: {} {have} no such setting", names.join(", "));
                return Err(Error::argument(name, "given", expected));
            }
        }
        let counts = [("--rounds", self.rounds), ("--rollouts", self.rollouts), ("--longest", self.longest)];
        if let Some((name, _)) = counts.iter().find(|(_, count)| *count == Some(0)) {
            return Err(Error::argument(name, 0, "at least 1"));
        }
        for (name, rate) in [("--alpha", self.alpha), ("--beta", self.beta)] {
            if let Some(rate) = rate.filter(|rate| !(*rate > 0.0 && *rate <= 1.0)) {
                return Err(Error::argument(name, rate, "above 0 and at most 1"));
            }
        }
        Ok(())
    }

    /// Each setting's name, whether it is given, and whether `algorithm` has it.
    fn settings(&self, algorithm: Algorithm) -> [(&'static str, bool, bool); 7] {
        use Algorithm::{DaggerOnline, Forward as F, Searn as S, SearnShortcut, Smile as M, Supervised as U};
        [
            ("--rounds", self.rounds.is_some(), !matches!(algorithm, U | F)),
            ("--alpha", self.alpha.is_some(), algorithm == M),
            ("--reuse", self.reuse.is_some(), algorithm == M),
            ("--beta", self.beta.is_some(), matches!(algorithm, S | SearnShortcut)),
            ("--rollouts", self.rollouts.is_some(), algorithm == S),
            ("--longest", self.longest.is_some(), algorithm == F),
            ("--warm", self.warm, !matches!(algorithm, U | DaggerOnline)),
        ]
    }

    /// The trainer of this name with these settings.
    pub fn trainer(&self, algorithm: Algorithm) -> Trainer {
        use Algorithm::{
            Dagger as D, DaggerOnline, Forward as F, Searn as S, SearnShortcut, Smile as M, Supervised as U,
        };
        let searn = || {
            let default = Searn::default();
            Searn {
                beta: self.beta.unwrap_or(default.beta),
                rounds: self.rounds.unwrap_or(default.rounds),
                samples: self.rollouts.unwrap_or(default.samples),
                warm: self.warm,
            }
        };
        let dagger = || {
            let default = Dagger::default();
            Dagger { rounds: self.rounds.unwrap_or(default.rounds), warm: self.warm }
        };
        match algorithm {
            U => Trainer::Supervised(Supervised {}),
            F => {
                let longest = self.longest.unwrap_or(Forward::default().longest);
                Trainer::Forward(Forward { warm: self.warm, longest })
            }
            M => {
                let default = Smile::default();
                Trainer::Smile(Smile {
                    alpha: self.alpha.unwrap_or(default.alpha),
                    rounds: self.rounds.unwrap_or(default.rounds),
                    warm: self.warm,
                    reuse: self.reuse.map_or(default.reuse, Reuse::from),
                })
            }
            S => Trainer::Searn(searn()),
            SearnShortcut => Trainer::SearnShortcut(searn()),
            D => Trainer::Dagger(dagger()),
            DaggerOnline => Trainer::DaggerOnline(dagger()),
        }
    }
}

/// A learner with its settings.
#[derive(Args)]
#[command(next_help_heading = "The learner")]
pub struct LearnerOptions {
    /// What fits a classifier to the expert's answers
    #[arg(long, value_enum, default_value = "logistic", value_name = "NAME")]
    pub learner: LearnerName,
    /// Passes over the examples each time the learner fits, at most for svm and crammer-singer; dagger-online makes one a round
    /// whatever is given [default: 5, wap 3, svm 100, crammer-singer 50]
    #[arg(long, value_name = "N")]
    passes: Option<usize>,
    /// AdaGrad's rate, for every learner but perceptron, svm and crammer-singer [default: 0.1, wap and filter-tree 0.2]
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    rate: Option<f32>,
    /// L2 penalty per example, for every learner but perceptron, svm and crammer-singer [default: 0]
    #[arg(long, value_name = "WEIGHT", allow_negative_numbers = true)]
    l2: Option<f32>,
    /// What a margin error costs svm and crammer-singer: C [default: 0.1]
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    cost: Option<f32>,
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
        if let Some(cost) = self.cost.filter(|cost| !(*cost > 0.0 && cost.is_finite())) {
            return Err(Error::argument("--cost", cost, "above 0"));
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
                AnyLearner::Logistic(Logistic { passes, rate, l2 })
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
        })
    }

    /// Refuses a setting that the learner does not have.
    fn refuse_others(&self) -> Result<()> {
        let margin = matches!(self.learner, LearnerName::Svm | LearnerName::CrammerSinger);
        let gradient = !margin && self.learner != LearnerName::Perceptron;
        let settings = [
            ("--rate", self.rate.is_some(), gradient),
            ("--l2", self.l2.is_some(), gradient),
            ("--cost", self.cost.is_some(), margin),
        ];
        match settings.iter().find(|(_, given, has)| *given && !has) {
            Some((name, ..)) => {
                let expected = format!("left out: {} has no such setting", self.learner.name());
                Err(Error::argument(name, "given", expected))
            }
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
