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

/// The claims that can be made with the methods there are: those of Ross & Bagnell (2010, section 5, figures 2 and 4), and the order that Ross, Gordon &
/// Bagnell (2011) found.
pub fn claims(findings: &Findings) -> Vec<Claim> {
    let all = 0..findings.grades.len();
    let last = |method: &str| findings.rounds(method).last().copied().unwrap_or(0);
    let mut claims = Vec::new();
    let mut claim = |text: String, kind: Kind, left: Side<'_>, right: Side<'_>| {
        claims.extend(judge(findings, text, kind, left, right));
    };
    let end = |method: &'static str| (method, last(method), all.clone());
    let what = match findings.goal {
        Goal::Distance => "mean distance",
        Goal::Falls => "falls a lap",
    };
    let (slow, fast) = ("smile-0.1", "smile-0.2");
    claim(
        format!("SMILe's {what} is better than supervised imitation's, at equal data"),
        Kind::Better,
        end(slow),
        end("supervised"),
    );
    if findings.grades.len() > 5 {
        let hard = 5..findings.grades.len();
        let on = |method: &'static str, grades: &Range<usize>| (method, last(method), grades.clone());
        claim(
            "the same on the harder half of the levels".into(),
            Kind::Better,
            on(slow, &hard),
            on("supervised", &hard),
        );
        let easy = 0..3;
        claim(
            "supervised imitation does better on the three easiest difficulties than on the harder half".into(),
            Kind::Better,
            on("supervised", &easy),
            on("supervised", &hard),
        );
    }
    claim(format!("SMILe ends with better {what} at alpha 0.1 than at 0.2"), Kind::Better, end(slow), end(fast));
    if last(slow) > 5 {
        let early = (slow, 5, all.clone());
        claim(
            "after five rounds SMILe is not behind supervised imitation at its end".into(),
            Kind::NotWorse,
            early,
            end("supervised"),
        );
    }
    for (reuse, name) in [("smile-4.3", "Algorithm 4.3"), ("smile-ageing", "ageing")] {
        claim(
            format!("with reuse by {name} SMILe is not behind SMILe without, round for round"),
            Kind::NotWorse,
            end(reuse),
            end(slow),
        );
        if let Some(round) = affordable(findings, slow, reuse) {
            let as_many = (slow, round, all.clone());
            claim(
                format!("it is better than SMILe without for as many labels (round {round})"),
                Kind::Better,
                end(reuse),
                as_many,
            );
        }
    }
    claim(format!("DAgger's {what} is better than SMILe's, at equal data"), Kind::Better, end("dagger"), end(slow));
    claim(
        format!("DAgger's {what} is better than supervised imitation's, at equal data"),
        Kind::Better,
        end("dagger"),
        end("supervised"),
    );
    claims
}

/// The last round after which `without` had used no more labels than `with` at its end; the first if it had always used more.
fn affordable(findings: &Findings, without: &str, with: &str) -> Option<usize> {
    let end = *findings.rounds(with).last()?;
    let most = findings.bill(with, end, |ledger| ledger.labels);
    let rounds = findings.rounds(without);
    let within = rounds.iter().copied().filter(|round| findings.bill(without, *round, |ledger| ledger.labels) <= most);
    within.max().or(rounds.first().copied())
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
