//! The algorithms that the commands train with, and their settings.

use crate::error::{Error, Result};
use crate::seed::Purpose;

use crate::space::experts::Flaw;
use crate::space::{CostToGo, Features, Problem, Space, StateOf};
use crate::tasks::{AnyLearner, Learned, Trainer};
use crate::trainer::{
    Aggrevate, Cpi, Dagger, EarlyUpdate, Forward, Keeping, Lols, MOST_WIDTH, MOST_WINDOW, Rate, Reuse, Run, Schedule,
    Searn, Smile, Stacking, Supervised, Trained,
};
use clap::{Args, ValueEnum};

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
    /// The same with an online learner, which learns as the costs come
    SearnOnline,
    /// SEARN with the expert's own cost-to-go in place of roll-outs
    SearnShortcut,
    /// Conservative policy iteration: SEARN from one state an episode, or only as far as it gains
    Cpi,
    /// Dataset aggregation: fit anew on all labels after each round
    Dagger,
    /// Dataset aggregation with one online learner that goes on learning
    DaggerOnline,
    /// DAgger with the expert's cost-to-go in place of its label
    Aggrevate,
    /// Locally optimal learning to search: roll out with the expert or with what is learned
    Lols,
    /// The same with one online learner, which learns after each sentence
    LolsOnline,
    /// Two stages, the second of which sees the first one's labels all around
    Stacked,
    /// The structured perceptron with a beam and early update; it takes no --learner
    EarlyUpdate,
}

impl Algorithm {
    pub fn name(self) -> String {
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
    /// Rounds [default: smile 7, all others 5]; not for supervised, forward and stacked
    #[arg(long, value_name = "N")]
    rounds: Option<usize>,
    /// Mixing rate of smile, above 0 and at most 1 [default: 0.2]
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    alpha: Option<f64>,
    /// How smile reuses samples of earlier rounds; `--reuse` alone means ageing [default: none]
    #[arg(long, value_enum, value_name = "HOW", num_args = 0..=1, default_missing_value = "ageing")]
    reuse: Option<ReuseName>,
    /// Mixing rate of searn, searn-online, searn-shortcut and cpi, above 0 and at most 1 [default: 0.3]
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    beta: Option<f64>,
    /// Let cpi find its rate from what is gained, and end where nothing is: with a perfect expert at once
    #[arg(long, conflicts_with = "beta")]
    conservative: bool,
    /// How often the expert drives in round 1, 2, ... of dagger, dagger-online and aggrevate: first (in the first round only),
    /// exponential:P or linear:N [default: first; dagger-online: never]
    #[arg(long, value_name = "HOW", value_parser = Schedule::parse)]
    schedule: Option<Schedule>,
    /// Probability that lols and lols-online roll out with the expert [default: 0.5]
    #[arg(long, value_name = "P", allow_negative_numbers = true)]
    reference: Option<f64>,
    /// Parts of the data of stacked, each labelled by a classifier of the others [default: 5]
    #[arg(long, value_name = "K")]
    folds: Option<usize>,
    /// Labels before and after that the second stage of stacked sees [default: 2]
    #[arg(long, value_name = "N")]
    window: Option<usize>,
    /// Paths in the beam of early-update [default: 4]
    #[arg(long, value_name = "N")]
    width: Option<usize>,
    /// Roll-outs of searn, searn-online and cpi for each action [default: 1]
    #[arg(long, value_name = "N")]
    rollouts: Option<usize>,
    /// Steps of forward that get a classifier of their own [default: 256]
    #[arg(long, value_name = "N")]
    longest: Option<usize>,
    /// An expert who is less than perfect: noisy:P (any other answer with probability P), suboptimal:P (always the same other answer, in a share P of
    /// all places) or silent:P (no answer with probability P); predicted bills are those of one who always answers [default: none]
    #[arg(long, value_name = "HOW", value_parser = Flaw::parse, default_value = "none", hide_default_value = true)]
    expert: Flaw,
    /// Let each new classifier start from the one before (not for supervised, stacked, early-update and what is online)
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
        if let Flaw::Noisy(_) | Flaw::Suboptimal(_) = self.expert
            && let Some(costly) =
                algorithms.iter().find(|a| matches!(a, Algorithm::SearnShortcut | Algorithm::Aggrevate))
        {
            let expected =
                format!("left out: {} asks what actions cost, and not for answers that may be wrong", costly.name());
            return Err(Error::argument("--expert", "given", expected));
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
        if let Some(chance) = self.reference.filter(|chance| !(0.0..=1.0).contains(chance)) {
            return Err(Error::argument("--reference", chance, "from 0 to 1"));
        }
        let ranges = [("--folds", self.folds, 2, usize::MAX), ("--window", self.window, 0, MOST_WINDOW)];
        for (name, value, least, most) in ranges.into_iter().chain([("--width", self.width, 1, MOST_WIDTH)]) {
            if let Some(value) = value.filter(|value| !(least..=most).contains(value)) {
                let range =
                    if most == usize::MAX { format!("at least {least}") } else { format!("from {least} to {most}") };
                return Err(Error::argument(name, value, range));
            }
        }
        Ok(())
    }

    /// Each setting's name, whether it is given, and whether `algorithm` has it.
    fn settings(&self, algorithm: Algorithm) -> [(&'static str, bool, bool); 13] {
        use Algorithm::{
            Aggrevate as A, Cpi as C, Dagger as D, DaggerOnline, EarlyUpdate as E, Forward as F, Lols as L, LolsOnline,
            Searn as S, SearnOnline, SearnShortcut, Smile as M, Stacked as K, Supervised as U,
        };
        [
            ("--rounds", self.rounds.is_some(), !matches!(algorithm, U | F | K)),
            ("--alpha", self.alpha.is_some(), algorithm == M),
            ("--reuse", self.reuse.is_some(), algorithm == M),
            ("--beta", self.beta.is_some(), matches!(algorithm, S | SearnOnline | SearnShortcut | C)),
            ("--rollouts", self.rollouts.is_some(), matches!(algorithm, S | SearnOnline | C)),
            ("--longest", self.longest.is_some(), algorithm == F),
            ("--warm", self.warm, !matches!(algorithm, U | DaggerOnline | LolsOnline | K | E)),
            ("--conservative", self.conservative, algorithm == C),
            ("--schedule", self.schedule.is_some(), matches!(algorithm, D | DaggerOnline | A)),
            ("--reference", self.reference.is_some(), matches!(algorithm, L | LolsOnline)),
            ("--folds", self.folds.is_some(), algorithm == K),
            ("--window", self.window.is_some(), algorithm == K),
            ("--width", self.width.is_some(), algorithm == E),
        ]
    }

    /// The trainer of this name with these settings.
    pub fn trainer(&self, algorithm: Algorithm) -> Trainer {
        match algorithm {
            Algorithm::Supervised => Trainer::Supervised(Supervised::default()),
            Algorithm::Forward => {
                let longest = self.longest.unwrap_or(Forward::default().longest);
                Trainer::Forward(Forward { warm: self.warm, longest })
            }
            Algorithm::Smile => Trainer::Smile(self.smile()),
            Algorithm::Searn => Trainer::Searn(self.searn()),
            Algorithm::SearnOnline => Trainer::SearnOnline(self.searn()),
            Algorithm::SearnShortcut => Trainer::SearnShortcut(self.searn()),
            Algorithm::Cpi => Trainer::Cpi(self.cpi()),
            Algorithm::Dagger => Trainer::Dagger(self.dagger()),
            Algorithm::DaggerOnline => Trainer::DaggerOnline(self.dagger()),
            Algorithm::Aggrevate => Trainer::Aggrevate(self.aggrevate()),
            Algorithm::Lols => Trainer::Lols(self.lols()),
            Algorithm::LolsOnline => Trainer::LolsOnline(self.lols()),
            Algorithm::Stacked => {
                let Stacking { folds, window } = Stacking::default();
                let (folds, window) = (self.folds.unwrap_or(folds), self.window.unwrap_or(window));
                Trainer::Stacked(Stacking { folds, window })
            }
            Algorithm::EarlyUpdate => {
                let EarlyUpdate { width, rounds } = EarlyUpdate::default();
                let (width, rounds) = (self.width.unwrap_or(width), self.rounds.unwrap_or(rounds));
                Trainer::EarlyUpdate(EarlyUpdate { width, rounds })
            }
        }
    }

    /// How the expert falls short, as it was asked for; nothing where it does not.
    pub fn flaw(&self) -> String {
        match self.expert {
            Flaw::None => String::new(),
            Flaw::Noisy(chance) => format!("noisy:{chance}"),
            Flaw::Suboptimal(share) => format!("suboptimal:{share}"),
            Flaw::Silent(chance) => format!("silent:{chance}"),
        }
    }

    /// Trains on `problem` with the expert that was asked for, by `trainer` and `learner`.
    pub fn train<P: Problem>(
        &self,
        problem: &P,
        (trainer, learner): (&Trainer, &AnyLearner),
        run: &Run<'_, Keeping>,
    ) -> Result<Trained<Learned>>
    where
        P::Space: Space<View = Features>,
        P::Expert: CostToGo<P::Space> + Clone,
        StateOf<P>: Clone,
    {
        let habits = run.seed.child(Purpose::Expert, 0);
        trainer.train(&self.expert.of(problem, habits)?, learner, run)
    }

    fn smile(&self) -> Smile {
        let default = Smile::default();
        Smile {
            alpha: self.alpha.unwrap_or(default.alpha),
            rounds: self.rounds.unwrap_or(default.rounds),
            warm: self.warm,
            reuse: self.reuse.map_or(default.reuse, Reuse::from),
            piece: None,
        }
    }

    fn searn(&self) -> Searn {
        let default = Searn::default();
        Searn {
            beta: self.beta.unwrap_or(default.beta),
            rounds: self.rounds.unwrap_or(default.rounds),
            samples: self.rollouts.unwrap_or(default.samples),
            warm: self.warm,
        }
    }

    fn cpi(&self) -> Cpi {
        let default = Cpi::default();
        Cpi {
            rate: if self.conservative { Rate::Advantage } else { self.beta.map_or(default.rate, Rate::Fixed) },
            rounds: self.rounds.unwrap_or(default.rounds),
            samples: self.rollouts.unwrap_or(default.samples),
            warm: self.warm,
        }
    }

    fn dagger(&self) -> Dagger {
        let default = Dagger::default();
        Dagger { rounds: self.rounds.unwrap_or(default.rounds), warm: self.warm, schedule: self.schedule }
    }

    fn aggrevate(&self) -> Aggrevate {
        let default = Aggrevate::default();
        Aggrevate {
            rounds: self.rounds.unwrap_or(default.rounds),
            warm: self.warm,
            schedule: self.schedule.unwrap_or(default.schedule),
        }
    }

    fn lols(&self) -> Lols {
        let default = Lols::default();
        Lols {
            beta: self.reference.unwrap_or(default.beta),
            rounds: self.rounds.unwrap_or(default.rounds),
            warm: self.warm,
        }
    }
}
