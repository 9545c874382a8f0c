//! Findings as text.

use super::{Claim, Findings, Goal, Interval};
use crate::report::{Axis, Dot, Figure, Page, Plot, Series, Table, grouped};

/// What counts, in words.
fn unit(findings: &Findings) -> &'static str {
    match findings.goal {
        Goal::Distance => "mean distance",
        Goal::Falls => "falls a lap",
    }
}

/// What was done, in a sentence.
fn head(findings: &Findings) -> String {
    let (plan, unit) = (&findings.plan, unit(findings));
    let over = if plan.trainings > 1 { "trainings" } else { "games" };
    format!(
        "{}: {unit} with 95% confidence intervals over {over}; {} training{} of each method, measured on {} games of each of {} grade{}, seed {}\n",
        plan.game,
        plan.trainings,
        if plan.trainings == 1 { "" } else { "s" },
        plan.games,
        findings.grades.len(),
        if findings.grades.len() == 1 { "" } else { "s" },
        plan.seed,
    )
}

/// All that was found, for a person.
pub fn text(findings: &Findings, claims: &[Claim]) -> String {
    let head = head(findings);
    let judged = if claims.is_empty() { String::new() } else { format!("\n{}", judged(claims)) };
    format!("{head}\n{}\n{}\n{}{judged}", ends(findings), bills(findings), course(findings))
}

/// All that was found, to be looked at.
pub fn page(findings: &Findings, claims: &[Claim]) -> Page {
    let round = |_: &str, round: usize| round as f64;
    let queries = |name: &str, round: usize| findings.bill(name, round, |ledger| ledger.queries);
    let note = match findings.goal {
        Goal::Distance => "Further up is better. Strokes are 95% confidence intervals.",
        Goal::Falls => "Further down is better. Strokes are 95% confidence intervals.",
    };
    let curves = |x, along: &dyn Fn(&str, usize) -> f64| Plot {
        x,
        y: Axis::linear(unit(findings)),
        series: curves(findings, along),
    };
    let mut tables = vec![("At the end".to_owned(), ends(findings)), ("The bill".to_owned(), bills(findings))];
    tables.push(("Round by round".to_owned(), course(findings)));
    if !claims.is_empty() {
        tables.push(("Claims".to_owned(), judged(claims)));
    }
    Page {
        title: format!("Who learns to play: {}", findings.plan.game),
        lead: head(findings),
        figures: vec![
            Figure::plot(
                "queries",
                "What was learned from how many expert queries",
                note,
                &curves(Axis::log("expert queries"), &queries),
            ),
            Figure::plot(
                "rounds",
                "What was learned in how many rounds",
                note,
                &curves(Axis::linear("rounds"), &round),
            ),
        ],
        tables,
        ..Page::default()
    }
}

/// What counts, of every method after every round, with its interval.
fn curves(findings: &Findings, along: &dyn Fn(&str, usize) -> f64) -> Vec<Series> {
    let curve = |name: &str| {
        let dot = |round: usize| {
            let measured = findings.main(name, round)?;
            // Neither falls nor metres are ever fewer than none.
            let interval = measured.half.is_finite().then(|| [measured.low().max(0.0), measured.high()]);
            Some(Dot { x: along(name, round), y: measured.mean, interval, name: format!("round {round}") })
        };
        Series::Line(name.to_owned(), findings.rounds(name).into_iter().filter_map(dot).collect())
    };
    findings.plan.methods.iter().map(|method| curve(&method.name)).collect()
}

/// A mean and what it may be off by.
fn cell(interval: Option<Interval>) -> String {
    let digits = |x: f64| if x.abs() >= 100.0 { 0 } else { 2 };
    match interval {
        None => "-".into(),
        Some(Interval { mean, half }) if half.is_finite() => format!("{mean:.0$} ± {half:.0$}", digits(mean)),
        Some(Interval { mean, .. }) => format!("{mean:.0$}", digits(mean)),
    }
}

/// The end of every method: what it measured, in all and on easy and hard grades.
fn ends(findings: &Findings) -> Table {
    let count = findings.grades.len();
    let graded = count > 1;
    let mut headings = vec!["at the end".to_owned(), "all".to_owned()];
    headings.extend(graded.then(|| findings.grades.clone()).into_iter().flatten());
    headings.extend(["distance", "won %"].map(str::to_owned));
    let mut table = Table::new(headings);
    for method in &findings.plan.methods {
        let name = method.name.as_str();
        let Some(last) = findings.rounds(name).last().copied() else { continue };
        let mut cells = vec![name.to_owned(), cell(findings.main(name, last))];
        let grade = |g| findings.interval((name, last), g..g + 1, |measured| measured.goal(findings.goal));
        let mean = |g: usize| grade(g).map_or("-".into(), |interval: Interval| format!("{:.0}", interval.mean));
        cells.extend(graded.then(|| (0..count).map(mean)).into_iter().flatten());
        cells.push(cell(findings.interval((name, last), 0..count, |measured| measured.distance)));
        let won = findings.interval((name, last), 0..count, |measured| measured.won);
        cells.push(won.map_or("-".into(), |won| format!("{:.1}", 100.0 * won.mean)));
        table.row(cells);
    }
    table
}

/// What every method was billed.
fn bills(findings: &Findings) -> Table {
    let mut table =
        Table::new(["the bill", "rounds", "labels", "expert queries", "resets", "steps", "queries/example"]);
    for method in &findings.plan.methods {
        let name = method.name.as_str();
        let Some(last) = findings.rounds(name).last().copied() else { continue };
        let queries = findings.bill(name, last, |ledger| ledger.queries);
        let examples = findings.bill(name, last, |ledger| ledger.examples);
        table.row([
            name.to_owned(),
            last.to_string(),
            grouped(findings.bill(name, last, |ledger| ledger.labels)),
            grouped(queries),
            grouped(findings.bill(name, last, |ledger| ledger.resets)),
            grouped(findings.bill(name, last, |ledger| ledger.steps)),
            format!("{:.1}", queries / examples),
        ]);
    }
    table
}

/// What was measured after every round, and how many labels had been asked for by then.
fn course(findings: &Findings) -> Table {
    let methods: Vec<&str> = (findings.plan.methods.iter().map(|method| method.name.as_str()))
        .filter(|name| findings.rounds(name).len() > 1 && !findings.rolls_out(name))
        .collect();
    let headings = methods.iter().flat_map(|name| [name.to_string(), "labels".to_owned()]);
    let mut table = Table::new(std::iter::once("round".to_owned()).chain(headings));
    let most = methods.iter().filter_map(|name| findings.rounds(name).last().copied()).max().unwrap_or(0);
    for round in 1..=most {
        let mut cells = vec![round.to_string()];
        for name in &methods {
            let there = !findings.of(name, round).is_empty();
            let labels = || grouped(findings.bill(name, round, |ledger| ledger.labels));
            cells.extend([cell(findings.main(name, round)), if there { labels() } else { "-".into() }]);
        }
        table.row(cells);
    }
    table
}

/// The claims.
fn judged(claims: &[Claim]) -> Table {
    let mut table = Table::new(["claim", "left", "right", ""]);
    for claim in claims {
        let verdict = if claim.holds { "came out" } else { "did not come out" };
        table.row([claim.text.clone(), cell(Some(claim.left)), cell(Some(claim.right)), verdict.to_owned()]);
    }
    table
}
