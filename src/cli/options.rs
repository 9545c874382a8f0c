//! Options that several commands share.

use crate::corpus::Corpus;
use crate::error::{Error, Result};
use crate::learner::{Csoaa, Logistic, Perceptron, Wap};
use crate::read::{conll, template::Template};
use crate::tasks::tagging::{AnyLearner, LabelColumn, Order, Trainer};
use crate::trainer::{Dagger, Forward, Searn, Smile, Supervised};
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

/// How a corpus is understood.
#[derive(Args)]
pub struct Reading {
    /// Feature template in the pattern language of CRF++ and Wapiti [default: one that suits the number of columns]
    #[arg(long, value_name = "FILE")]
    pub template: Option<PathBuf>,
    /// The column the labels stand in, from 0 [default: the last]
    #[arg(long, value_name = "N")]
    pub label_column: Option<usize>,
    /// Which label may follow which [default: iob2 where the labels look like it and keep to it]
    #[arg(long, value_enum, value_name = "RULE")]
    pub order: Option<OrderName>,
    /// Learn from the first N sentences only
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

    /// The template, by default one for what `corpus` has before its labels.
    pub fn template(&self, corpus: &Corpus) -> Result<Template> {
        match &self.template {
            Some(path) => Template::read_file(path),
            None => Ok(Template::default_for(self.labels().in_corpus(corpus)?)),
        }
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
}

/// A trainer's settings.
#[derive(Args)]
pub struct TrainerOptions {
    /// Rounds of smile, searn and dagger
    #[arg(long, value_name = "N")]
    rounds: Option<usize>,
    /// SMILe's mixing rate, above 0 and at most 1
    #[arg(long, value_name = "RATE")]
    alpha: Option<f64>,
    /// SEARN's mixing rate, above 0 and at most 1
    #[arg(long, value_name = "RATE")]
    beta: Option<f64>,
    /// SEARN's roll-outs per action
    #[arg(long, value_name = "N")]
    rollouts: Option<usize>,
    /// Sentences between two looks at the expert in dagger-online
    #[arg(long, value_name = "N")]
    block: Option<usize>,
    /// Let each round's classifier start from the one before
    #[arg(long)]
    warm: bool,
}

impl TrainerOptions {
    /// The trainer of this name with these settings.
    ///
    /// # Errors
    /// When `strict` and a setting is given that the trainer has not.
    pub fn trainer(&self, algorithm: Algorithm, strict: bool) -> Result<Trainer> {
        use Algorithm::{
            Dagger as D, DaggerOnline, Forward as F, Searn as S, SearnShortcut, Smile as M, Supervised as U,
        };
        let applies = [
            ("--rounds", self.rounds.is_some(), !matches!(algorithm, U | F)),
            ("--alpha", self.alpha.is_some(), algorithm == M),
            ("--beta", self.beta.is_some(), matches!(algorithm, S | SearnShortcut)),
            ("--rollouts", self.rollouts.is_some(), algorithm == S),
            ("--block", self.block.is_some(), algorithm == DaggerOnline),
            ("--warm", self.warm, !matches!(algorithm, U | DaggerOnline)),
        ];
        if let Some((name, ..)) = applies.iter().find(|(_, given, meant)| strict && *given && !*meant) {
            return Err(Error::argument(name, "given", format!("left out: {} has no such setting", algorithm.name())));
        }
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
            Dagger {
                rounds: self.rounds.unwrap_or(default.rounds),
                warm: self.warm,
                block: self.block.unwrap_or(default.block),
            }
        };
        Ok(match algorithm {
            U => Trainer::Supervised(Supervised {}),
            F => Trainer::Forward(Forward { warm: self.warm }),
            M => {
                let default = Smile::default();
                Trainer::Smile(Smile {
                    alpha: self.alpha.unwrap_or(default.alpha),
                    rounds: self.rounds.unwrap_or(default.rounds),
                    warm: self.warm,
                })
            }
            S => Trainer::Searn(searn()),
            SearnShortcut => Trainer::SearnShortcut(searn()),
            D => Trainer::Dagger(dagger()),
            DaggerOnline => Trainer::DaggerOnline(dagger()),
        })
    }
}

/// A learner with its settings.
#[derive(Args)]
pub struct LearnerOptions {
    /// The learner
    #[arg(long, value_enum, default_value = "logistic", value_name = "NAME")]
    pub learner: LearnerName,
    /// Passes over the examples each time the learner fits; dagger-online makes one a round
    #[arg(long, value_name = "N")]
    passes: Option<usize>,
    /// AdaGrad's rate, for every learner but the perceptron
    #[arg(long, value_name = "RATE")]
    rate: Option<f32>,
    /// L2 penalty per example, for every learner but the perceptron
    #[arg(long, value_name = "WEIGHT")]
    l2: Option<f32>,
}

impl LearnerOptions {
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
        let given =
            |passes, rate, l2| (self.passes.unwrap_or(passes), self.rate.unwrap_or(rate), self.l2.unwrap_or(l2));
        Ok(match self.learner {
            LearnerName::Perceptron => {
                let named = [("--rate", self.rate.is_some()), ("--l2", self.l2.is_some())];
                if let Some((name, _)) = named.iter().find(|(_, given)| *given) {
                    return Err(Error::argument(name, "given", "left out: the perceptron has no such setting"));
                }
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
            LearnerName::Wap => {
                let default = Wap::default();
                let (passes, rate, l2) = given(default.passes, default.rate, default.l2);
                AnyLearner::Wap(Wap { passes, rate, l2 })
            }
        })
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
