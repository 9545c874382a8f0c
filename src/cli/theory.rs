//! `rollin theory`

use super::report::{ReportOptions, Sources};
use super::{Global, print, print_json};
use crate::error::{Error, Result};
use crate::report::{Table, grouped};
use crate::theory::audit::{Audit, audit};
use crate::theory::closed;
use crate::theory::counts::{Counts, Plan};
use crate::theory::instance::Instance;
use clap::{Args, Subcommand};
use serde::Serialize;
use std::path::PathBuf;

mod pages;

/// Exact values, bounds and bills in advance
#[derive(Args)]
#[command(after_help = super::help::theory())]
pub struct Theory {
    #[command(subcommand)]
    question: Question,
}

#[derive(Subcommand)]
enum Question {
    /// Evaluate an instance exactly: every quantity of the paper, every bound with its slack
    Audit(AuditArgs),
    /// Closed forms in the horizon and the mixing rate
    Bounds(BoundsArgs),
    /// Expected expert queries of each algorithm, side by side
    Plan(PlanArgs),
}

#[derive(Args)]
#[command(after_help = super::help::audit())]
struct AuditArgs {
    /// One JSON object with S, A, T, mu, P, C and expert, and optionally pi, pis, hats, N, alpha, phi, m and k_roll;
    /// `-` reads standard input
    #[arg(value_name = "INSTANCE")]
    instance: PathBuf,
    #[command(flatten)]
    report: ReportOptions,
}

#[derive(Args)]
#[command(after_help = super::help::bounds())]
struct BoundsArgs {
    /// T, the steps of an episode
    #[arg(long, value_name = "T")]
    horizon: usize,
    /// SMILe's mixing rate
    #[arg(long, value_name = "A")]
    alpha: f64,
    /// N, the rounds [default: the least with p_N <= 1/T^2]
    #[arg(long, value_name = "N")]
    rounds: Option<usize>,
    #[command(flatten)]
    report: ReportOptions,
}

#[derive(Args)]
#[command(after_help = super::help::plan())]
struct PlanArgs {
    /// T, the steps of an episode
    #[arg(long, value_name = "T")]
    horizon: usize,
    /// SMILe's mixing rate
    #[arg(long, value_name = "A")]
    alpha: f64,
    /// SEARN's mixing rate
    #[arg(long, value_name = "B")]
    beta: f64,
    /// State samples a round
    #[arg(long = "m", value_name = "M")]
    samples: u64,
    /// Actions in a state
    #[arg(long, value_name = "A")]
    actions: usize,
    /// Roll-outs an action
    #[arg(long = "k", value_name = "K")]
    rollouts: u64,
    /// Rounds
    #[arg(long, value_name = "N")]
    rounds: usize,
}

impl Theory {
    pub fn run(&self, global: &Global) -> Result<()> {
        match &self.question {
            Question::Audit(args) => args.run(global),
            Question::Bounds(args) => args.run(global),
            Question::Plan(args) => args.run(global),
        }
    }
}

/// An error unless `value` is from `least` to `most`.
fn within<N: PartialOrd + std::fmt::Display>(name: &'static str, value: N, least: N, most: N) -> Result<N> {
    if value >= least && value <= most {
        return Ok(value);
    }
    Err(Error::argument(name, value, format!("from {least} to {most}")))
}

/// The most steps and rounds that closed forms are evaluated for.
const MOST: usize = 10_000_000;

impl AuditArgs {
    fn run(&self, global: &Global) -> Result<()> {
        self.report.check(&[&self.instance])?;
        let audit = audit(&Instance::read(&self.instance)?)?;
        if global.json { print_json(&audit) } else { print(&readable(&audit)) }?;
        let read = Sources { files: &[("instance", &self.instance)], ..Sources::default() };
        self.report.write(|| pages::audited(&audit), global, &read)
    }
}

fn readable(audit: &Audit) -> String {
    let mut text = format!("{}\n", costs(audit));
    if !audit.theorems.is_empty() {
        text += &format!("{}\n", theorems(audit));
    }
    if let Some(reuse) = &audit.reuse {
        text += &format!("{}\n{}\n", drift_title(reuse), drift(reuse));
    }
    if let Some(counts) = &audit.counts {
        text += &format!("{}\n", bill(counts));
    }
    for reason in &audit.left_out {
        text += &format!("left out: {reason}\n");
    }
    text
}

/// What the policies cost.
fn costs(audit: &Audit) -> Table {
    let mut values = Table::new(["policy", "expected cost of T steps"]);
    let mut row = |name: &str, cost: f64| values.row([name.to_owned(), format!("{cost:.6}")]);
    if let Some(eval) = &audit.eval {
        row("expert", eval.J_star);
        eval.stationary.iter().for_each(|own| row("pi", own.J));
        eval.J_ns.iter().for_each(|cost| row("pis, one a step", *cost));
    }
    if let Some(smile) = &audit.smile {
        smile.J_pi.last().iter().for_each(|cost| row("SMILe, with the expert's share", **cost));
        smile.J_tilde.iter().flatten().last().iter().for_each(|cost| row("SMILe", **cost));
    }
    if let Some(searn) = &audit.searn {
        searn.J_pi.last().iter().for_each(|cost| row("SEARN, with the expert's share", **cost));
        searn.J_tilde.iter().flatten().last().iter().for_each(|cost| row("SEARN", **cost));
    }
    if let Some(best) = &audit.population {
        row("best of the class: supervised", best.J.supervised);
        row("best of the class: forward", best.J.forward);
        row("best of the class: SMILe", best.J.smile_tilde);
        row("best of the class: SEARN", best.J.searn_tilde);
    }
    values
}

/// Every bound with what it bounds.
fn theorems(audit: &Audit) -> Table {
    let mut bounds = Table::new(["bound", "left", "right", "slack", "assumed"]);
    for bound in &audit.theorems {
        let missing: Vec<&str> = bound.hypotheses.iter().filter(|(_, so)| !so).map(|(what, _)| what.as_str()).collect();
        let assumed = if missing.is_empty() { "yes".to_owned() } else { format!("not so: {}", missing.join(", ")) };
        let numbers = [bound.lhs, bound.rhs, bound.slack].map(|x| format!("{x:.6}"));
        bounds.row(std::iter::once(bound.name.clone()).chain(numbers).chain([assumed]));
    }
    bounds
}

/// What [`drift`] holds.
fn drift_title(reuse: &crate::theory::audit::ReuseGroup) -> String {
    let over = match reuse.d_true.first() {
        Some(law) if law.len() > 1 => "averaged over the steps",
        _ => "of the states of all steps together",
    };
    format!("Sample reuse: new trajectories, and the data sets' error in total variation, {over}")
}

/// How far the data sets of sample reuse are from what they should be: total variation, averaged over the laws that are
/// there, one a step or one for all.
fn drift(reuse: &crate::theory::audit::ReuseGroup) -> Table {
    let mut table = Table::new(["round", "new, 4.2", "new, 4.3", "error of 4.2 as printed", "error of 4.3 as printed"]);
    for n in 1..reuse.d_true.len() {
        let distance = |law: &[Vec<f64>]| {
            let pairs = law.iter().flatten().zip(reuse.d_true[n].iter().flatten());
            let sum: f64 = pairs.map(|(a, b)| (a - b).abs()).sum();
            format!("{:.6}", sum / 2.0 / law.len().max(1) as f64)
        };
        let shares = [reuse.new_frac42[n - 1], reuse.new_frac43[n - 1]].map(|share| format!("{:.2}%", 100.0 * share));
        let errors = [distance(&reuse.d_42_paper_chain[n]), distance(&reuse.d_43_paper_chain[n])];
        table.row(std::iter::once(n.to_string()).chain(shares).chain(errors));
    }
    table
}

/// Six digits behind the point where they say something, else six significant ones.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e9).contains(&value.abs()) { format!("{value:.6}") } else { format!("{value:.6e}") }
}

/// The expected queries as a table.
fn bill(counts: &Counts) -> Table {
    let mut table = Table::new(["algorithm", "expected expert queries", "standard deviation"]);
    let mut row = |name: &str, mean: f64, variance: Option<f64>| {
        let spread = variance.map_or("-".to_owned(), |variance| grouped(variance.max(0.0).sqrt()));
        table.row([name.to_owned(), grouped(mean), spread]);
    };
    row("supervised", counts.supervised_labels, Some(0.0));
    row("forward", counts.forward_labels, Some(0.0));
    row("forward, as printed: the expert drives on", counts.forward_literal, Some(0.0));
    row("SMILe", counts.smile_labels, Some(0.0));
    row("SMILe, reuse 4.2", counts.smile42_labels, Some(counts.smile42_var));
    row("SMILe, reuse 4.3", counts.smile43_labels, Some(counts.smile43_var));
    row("SMILe, reuse by ageing labels", counts.flip_labels, counts.flip_var);
    row("SEARN, a query where the expert could act", counts.searn_eager, Some(0.0));
    row("SEARN, a query where the expert acts", counts.searn_lazy, Some(counts.searn_lazy_var));
    row("SEARN, one state a roll-in, where it could", counts.searn_eager_one_state, None);
    row("SEARN, one state a roll-in, where it acts", counts.searn_lazy_one_state, None);
    row("SEARN, the paper's order at beta = T^-3", counts.searn_headline, None);
    table
}

/// Closed forms; `None` where the sums would be too long.
#[derive(Serialize)]
struct Closed {
    horizon: usize,
    alpha: f64,
    rounds: f64,
    kept: f64,
    rounds_to_inverse_square: f64,
    rounds_to_inverse_square_printed: f64,
    lemma_4_2: f64,
    lemma_4_2_half: f64,
    lemma_4_1_tail: f64,
    theorem_4_1_alpha: Option<f64>,
    theorem_4_1_rounds: f64,
    inverse_square_rounds: f64,
    inverse_square_constant: f64,
    new_share_42: f64,
    new_share_43_first: f64,
    new_share_43_last: f64,
    samples_42: f64,
    samples_43: Option<f64>,
    samples_43_bound: f64,
    samples_without_reuse: f64,
    bias_42: f64,
    overuse_42: f64,
    drift_42: Option<f64>,
    drift_43: Option<f64>,
}

impl BoundsArgs {
    fn run(&self, global: &Global) -> Result<()> {
        let horizon = within("--horizon", self.horizon, 1, MOST / 10)?;
        let alpha = within("--alpha", self.alpha, closed::SLOWEST, 1.0)?;
        let wanted = closed::rounds(alpha, horizon);
        let rounds = match self.rounds {
            Some(rounds) => within("--rounds", rounds, 1, MOST)? as f64,
            None => wanted.max(1.0),
        };
        self.report.check(&[])?;
        let forms = Closed::of(horizon, alpha, rounds, wanted);
        if global.json { print_json(&forms) } else { print(&forms.table().to_string()) }?;
        self.report.write(|| pages::closed(&forms), global, &Sources::default())
    }
}

impl Closed {
    fn of(horizon: usize, alpha: f64, rounds: f64, wanted: f64) -> Self {
        // Rounds beyond what is summed are still summed in closed form where there is one.
        let n = (rounds <= MOST as f64).then_some(rounds as usize);
        let (steps, log) = (horizon as f64, (-alpha).ln_1p());
        let kept = (rounds * log).exp();
        let before = if rounds > 1.0 { ((rounds - 1.0) * log).exp() } else { 1.0 };
        let fresh = closed::fresh42(horizon, alpha);
        let short = n.filter(|n| *n as f64 * steps * steps <= 2e8);
        let alpha_printed = closed::alpha_printed(horizon);
        Closed {
            horizon,
            alpha,
            rounds,
            kept,
            rounds_to_inverse_square: wanted,
            rounds_to_inverse_square_printed: (2.0 / alpha * steps.ln()).ceil(),
            lemma_4_2: kept * steps * steps,
            lemma_4_2_half: kept * steps * (steps + 1.0) / 2.0,
            lemma_4_1_tail: rounds * closed::tail(horizon, alpha, 3) * steps,
            theorem_4_1_alpha: alpha_printed.is_finite().then_some(alpha_printed),
            theorem_4_1_rounds: closed::rounds_printed(horizon).ceil(),
            inverse_square_rounds: closed::rounds_inverse_square(horizon).ceil(),
            inverse_square_constant: (steps + 1.0) / (2.0 * steps),
            new_share_42: fresh,
            new_share_43_first: closed::fresh43(horizon, alpha, 1),
            new_share_43_last: closed::gone(alpha * before, horizon),
            samples_42: 1.0 + (rounds - 1.0) * fresh,
            samples_43: n.map(|n| 1.0 + (1..n).map(|n| closed::fresh43(horizon, alpha, n)).sum::<f64>()),
            samples_43_bound: steps + 1.0,
            samples_without_reuse: rounds,
            bias_42: closed::bias42(horizon, alpha),
            overuse_42: closed::overuse42(horizon, alpha),
            drift_42: n.map(|n| closed::drift42(horizon, alpha, n)),
            drift_43: short.map(|n| closed::drift43(horizon, alpha, n)),
        }
    }

    fn table(&self) -> Table {
        let mut table = Table::new(["closed form", "value"]);
        let long = |value: Option<f64>| value.map_or("too many rounds".to_owned(), number);
        let share = |value: f64| number(100.0 * value) + "%";
        let mut row = |name: &str, value: String| table.row([name.to_owned(), value]);
        row("rounds N", grouped(self.rounds));
        row("expert's share p_N", number(self.kept));
        row("N for p_N <= 1/T^2", grouped(self.rounds_to_inverse_square));
        row("N as printed, (2/alpha) ln T", grouped(self.rounds_to_inverse_square_printed));
        row("Lemma 4.2: dropping the expert, p_N T^2", number(self.lemma_4_2));
        row("Lemma 4.2, by the steps left, p_N T(T+1)/2", number(self.lemma_4_2_half));
        row("Lemma 4.1's tail at k = 2, N alpha^3 T C(T,3)", number(self.lemma_4_1_tail));
        row("Theorem 4.1's alpha", self.theorem_4_1_alpha.map_or("none".to_owned(), number));
        row("Theorem 4.1's N", grouped(self.theorem_4_1_rounds));
        row("N at alpha = 1/T^2", grouped(self.inverse_square_rounds));
        row("additive constant at alpha = 1/T^2", number(self.inverse_square_constant));
        row("new trajectories a round, Algorithm 4.2", share(self.new_share_42));
        row("new trajectories, Algorithm 4.3, first round", share(self.new_share_43_first));
        row("new trajectories, Algorithm 4.3, last round", share(self.new_share_43_last));
        row("samples in all, in units of m: no reuse", number(self.samples_without_reuse));
        row("  Algorithm 4.2", number(self.samples_42));
        row("  Algorithm 4.3 and its repairs", long(self.samples_43));
        row("  Algorithm 4.3, the paper's bound", number(self.samples_43_bound));
        row("Algorithm 4.2's use of the newest policy, times what it should be", number(self.overuse_42));
        row("total variation of its new trajectories, once", number(self.bias_42));
        row("  accumulated after N rounds, at most", long(self.drift_42));
        row("  Algorithm 4.3, accumulated after N rounds, at most", long(self.drift_43));
        table
    }
}

impl PlanArgs {
    fn run(&self, global: &Global) -> Result<()> {
        let plan = Plan {
            horizon: within("--horizon", self.horizon, 1, MOST)?,
            actions: within("--actions", self.actions, 1, MOST)?,
            rounds: within("--rounds", self.rounds, 1, MOST)?,
            alpha: within("--alpha", self.alpha, closed::SLOWEST, 1.0)?,
            beta: within("--beta", self.beta, closed::SLOWEST, 1.0)?,
            samples: within("--m", self.samples, 1, crate::theory::instance::MOST_SAMPLES)?,
            rollouts: within("--k", self.rollouts, 0, crate::theory::instance::MOST_SAMPLES)?,
        };
        let counts = Counts::of(&plan);
        if global.json { print_json(&counts) } else { print(&bill(&counts).to_string()) }
    }
}
