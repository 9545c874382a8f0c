//! What the paper says of its experiments, held against what came out.

use super::{Findings, Goal, Interval, Measured, Teaching};
use serde::Serialize;
use std::ops::Range;

/// A claim about two intervals.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Claim {
    /// The claim.
    pub text: String,
    /// What is said to be better, or not worse.
    pub left: Interval,
    /// Than what.
    pub right: Interval,
    /// Whether it came out.
    pub holds: bool,
}

/// How two intervals are held against each other.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// They are disjoint, and the left one is better.
    Better,
    /// The left one is not wholly on the worse side of the right one.
    NotWorse,
}

/// One side of a claim: a method after a round, on some grades.
type Side<'a> = (&'a str, usize, Range<usize>);

/// SMILe at the two rates of the paper.
const SLOW: &str = "smile-0.1";
const FAST: &str = "smile-0.2";

/// The claims that can be made with the methods there are: those of Ross & Bagnell (2010, section 5, figures 2 and 4), and the order that Ross, Gordon &
/// Bagnell (2011) found.
pub fn claims(findings: &Findings) -> Vec<Claim> {
    let what = match findings.goal {
        Goal::Distance => "mean distance",
        Goal::Falls => "falls a lap",
    };
    let better = |text: String, left: &str, right: &str| {
        judge(findings, text, Kind::Better, end(findings, left), end(findings, right))
    };
    let early = (end(findings, SLOW).1 > 5).then(|| {
        let text = "after five rounds SMILe is not behind supervised imitation at its end";
        let five = (SLOW, 5, 0..findings.grades.len());
        judge(findings, text.into(), Kind::NotWorse, five, end(findings, "supervised"))
    });
    let mut claims = Vec::new();
    claims.extend(better(
        format!("SMILe's {what} is better than supervised imitation's, at equal data"),
        SLOW,
        "supervised",
    ));
    claims.extend(of_grades(findings));
    claims.extend(better(
        format!("with nets that start from the one before, SMILe's {what} is better than supervised imitation's"),
        "smile-warm",
        "supervised",
    ));
    claims.extend(better(format!("SMILe ends with better {what} at alpha 0.1 than at 0.2"), SLOW, FAST));
    claims.extend(early.flatten());
    claims.extend(of_reuse(findings, "smile-4.3", "Algorithm 4.3"));
    claims.extend(of_reuse(findings, "smile-ageing", "ageing"));
    claims.extend(better(format!("DAgger's {what} is better than SMILe's, at equal data"), "dagger", SLOW));
    claims.extend(better(
        format!("DAgger's {what} is better than supervised imitation's, at equal data"),
        "dagger",
        "supervised",
    ));
    claims
}

/// The end of a method, on all grades.
fn end<'a>(findings: &Findings, method: &'a str) -> Side<'a> {
    (method, findings.rounds(method).last().copied().unwrap_or(0), 0..findings.grades.len())
}

/// What is said of easy and hard levels.
fn of_grades(findings: &Findings) -> Vec<Claim> {
    let grades = findings.grades.len();
    if grades <= 5 {
        return Vec::new();
    }
    let on = |method: &'static str, grades: Range<usize>| (method, end(findings, method).1, grades);
    let same = "the same on the harder half of the levels";
    let easy = "supervised imitation does better on the three easiest difficulties than on the harder half";
    let hard = || on("supervised", 5..grades);
    let both = [
        judge(findings, same.into(), Kind::Better, on(SLOW, 5..grades), hard()),
        judge(findings, easy.into(), Kind::Better, on("supervised", 0..3), hard()),
    ];
    both.into_iter().flatten().collect()
}

/// What is said of reuse.
fn of_reuse(findings: &Findings, method: &str, name: &str) -> Vec<Claim> {
    let same = format!("with reuse by {name} SMILe is not behind SMILe without, after as many rounds");
    let equal = judge(findings, same, Kind::NotWorse, end(findings, method), end(findings, SLOW));
    let cheaper = affordable(findings, SLOW, method).and_then(|round| {
        let text = format!("it is better than SMILe without for as many labels (round {round})");
        let side = (SLOW, round, 0..findings.grades.len());
        judge(findings, text, Kind::Better, end(findings, method), side)
    });
    equal.into_iter().chain(cheaper).collect()
}

/// The last round after which `without` had used no more labels than `with` at its end; the first if it had always used more.
fn affordable(findings: &Findings, without: &str, with: &str) -> Option<usize> {
    let end = *findings.rounds(with).last()?;
    let most = findings.bill(with, end, |ledger| ledger.labels);
    let rounds = findings.rounds(without);
    let mut within =
        rounds.iter().copied().filter(|round| findings.bill(without, *round, |ledger| ledger.labels) <= most);
    within.next_back().or(rounds.first().copied())
}

fn judge(findings: &Findings, text: String, kind: Kind, left: Side<'_>, right: Side<'_>) -> Option<Claim> {
    let goal = |measured: &Measured| measured.goal(findings.goal);
    let of = |(method, round, grades): Side<'_>| findings.interval((method, round), grades, goal);
    let (left, right) = (of(left)?, of(right)?);
    let (better, worse) = match findings.goal {
        Goal::Distance => (left, right),
        Goal::Falls => (right, left),
    };
    let holds = match kind {
        Kind::Better => better.low() > worse.high(),
        Kind::NotWorse => better.high() >= worse.low(),
    };
    Some(Claim { text, left, right, holds })
}

impl Findings {
    /// Whether a method of this name is in the plan and rolls out.
    pub(super) fn rolls_out(&self, name: &str) -> bool {
        let of = |method: &&super::Method| method.name == name;
        self.plan.methods.iter().find(of).is_some_and(|method| matches!(method.teaching, Teaching::Searn(_)))
    }
}
