//! What the commands on theory found, to be looked at.

use super::{Closed, bill, costs, drift, drift_title, theorems};
use crate::cli::report::mixture;
use crate::report::{Axis, Dot, Figure, Page, Plot, Series};
use crate::theory::audit::{Audit, SmileGroup};
use crate::theory::closed;

/// An audit as a page.
pub fn audited(audit: &Audit) -> Page {
    let mut figures = Vec::new();
    if !audit.theorems.is_empty() {
        figures.push(truth(audit));
    }
    if let Some(smile) = &audit.smile {
        figures.push(rounds(smile));
        // The weights of pi^n: those of classifiers never change once they are given.
        let weights = smile.p.iter().enumerate();
        let after =
            |(n, kept): (usize, &f64)| [&[*kept][..], &smile.weights[1..(n + 1).min(smile.weights.len())]].concat();
        figures.push(mixture("weights-smile", "SMILe", &weights.map(after).collect::<Vec<_>>()));
    }
    if let Some(searn) = &audit.searn {
        figures.push(mixture("weights-searn", "SEARN", &searn.weights));
    }
    let mut tables = vec![("Costs".to_owned(), costs(audit)), ("Bounds".to_owned(), theorems(audit))];
    if let Some(reuse) = &audit.reuse {
        tables.push((drift_title(reuse), drift(reuse)));
    }
    if let Some(counts) = &audit.counts {
        tables.push(("Expected expert queries".to_owned(), bill(counts)));
    }
    let left_out: Vec<String> = audit.left_out.iter().map(|reason| format!("Left out: {reason}.")).collect();
    Page { title: "Bounds against the truth".to_owned(), lead: left_out.join(" "), figures, tables, ..Page::default() }
}

/// Every bound against what it bounds.
fn truth(audit: &Audit) -> Figure {
    let dot = |bound: &crate::theory::bounds::Bound| {
        let unmet = if bound.applies() { "" } else { "not all it assumes is so" };
        let dots = vec![Dot { x: bound.lhs, y: bound.rhs, name: unmet.to_owned(), ..Dot::default() }];
        Series::Dots(bound.name.clone(), dots)
    };
    let mut series: Vec<Series> = audit.theorems.iter().map(dot).collect();
    series.push(Series::diagonal("no slack", &series));
    let plot = Plot { x: Axis::linear("what is bounded"), y: Axis::linear("the bound"), series };
    let note =
        "Costs of T steps. A bound that holds is on the dashed line or above it; the distance is what it gives away.";
    Figure::plot("bounds", "Bound against truth", note, &plot)
}

/// What SMILe's policies cost after each round, and what is said of them.
fn rounds(smile: &SmileGroup) -> Figure {
    let line = |name: &str, of: &dyn Fn(usize) -> Option<f64>| {
        let dots = (0..smile.p.len()).filter_map(|n| Some(Dot { x: n as f64, y: of(n)?, ..Dot::default() }));
        Series::Line(name.to_owned(), dots.collect())
    };
    let bound =
        |of: fn(&crate::theory::mixing::SmileBounds) -> f64| move |n: usize| Some(of(smile.bounds.get(n)?.as_ref()?));
    let series = vec![
        line("with the expert's share: J(pi^n)", &|n| smile.J_pi.get(n).copied()),
        line("without: J(pi~^n)", &|n| smile.J_tilde.get(n).copied().flatten()),
        line("Theorem 4.1, explicit constants", &bound(|b| b.B_paper)),
        line("coupling at every order", &bound(|b| b.B_coup)),
        line("performance difference", &bound(|b| b.B_pdl)),
        line("Lemma 4.2", &bound(|b| b.lemma42_rhs)),
        line("Lemma 4.2, sharp", &bound(|b| b.lemma42_sharp_rhs)),
    ];
    let plot = Plot { x: Axis::linear("rounds"), y: Axis::log("cost of T steps"), series };
    Figure::plot(
        "rounds",
        "SMILe round by round: cost and bounds",
        "All bounds are on the policy without the expert.",
        &plot,
    )
}

/// How many rounds a curve is drawn for, at most.
const POINTS: usize = 40;

/// Closed forms as a page.
pub fn closed(forms: &Closed) -> Page {
    // Evenly over the rounds, and the last one.
    let last = forms.rounds;
    let mut at: Vec<f64> = (0..=POINTS).map(|i| (last * i as f64 / POINTS as f64).round()).collect();
    at.dedup();
    let (steps, log) = (forms.horizon as f64, (-forms.alpha).ln_1p());
    let line = |name: &str, of: &dyn Fn(f64) -> f64| {
        Series::Line(name.to_owned(), at.iter().map(|n| Dot { x: *n, y: of(*n), ..Dot::default() }).collect())
    };
    let kept = |n: f64| if n == last { forms.kept } else { (n * log).exp() };
    let share = vec![line("p_n", &kept), Series::level("1/T^2", 1.0 / (steps * steps), &[line("", &kept)])];
    let price = vec![
        line("printed: p_n T^2", &|n| kept(n) * steps * steps),
        line("by the steps left: p_n T(T+1)/2", &|n| kept(n) * steps * (steps + 1.0) / 2.0),
        line("sharp: T - sum (1-p_n)^t", &|n| sharp(kept(n), forms.horizon)),
    ];
    let plot = |name: &str, series| Plot { x: Axis::linear("rounds"), y: Axis::log(name), series };
    let mut figures = vec![
        Figure::plot("share", "The expert's share", "", &plot("probability that the expert acts", share)),
        Figure::plot(
            "dropping",
            "Dropping the expert: Lemma 4.2 against the truth",
            "What the policy can cost more, at most, once the expert is dropped: as printed, and two sharper forms, the last of which is attained.",
            &plot("cost of T steps", price),
        ),
    ];
    figures.extend(samples(forms));
    Page {
        title: format!("Closed forms: T = {}, alpha = {}", forms.horizon, forms.alpha),
        figures,
        tables: vec![("All closed forms".to_owned(), forms.table())],
        ..Page::default()
    }
}

/// T - sum_{t=1}^T (1-p)^t.
fn sharp(p: f64, horizon: usize) -> f64 {
    let steps = horizon as f64;
    if p * steps < 1e-4 {
        // Two terms of its series, right to (pT)^2; the sum in closed form would cancel.
        return p * steps * (steps + 1.0) / 2.0 * (1.0 - p * (steps - 1.0) / 3.0);
    }
    if p >= 1.0 { steps } else { steps - (1.0 - p) * closed::gone(p, horizon) / p }
}

/// The samples that SMILe needs by each way of reuse, where they can be summed.
fn samples(forms: &Closed) -> Option<Figure> {
    forms.samples_43?;
    let (rounds, horizon, alpha) = (forms.rounds as usize, forms.horizon, forms.alpha);
    let every = rounds.div_ceil(POINTS).max(1);
    let (mut none, mut one, mut sites) = (Vec::new(), Vec::new(), Vec::new());
    let mut sum = 1.0;
    for n in 1..=rounds {
        if n > 1 {
            sum += closed::fresh43(horizon, alpha, n - 1);
        }
        if n % every == 0 || n == 1 || n == rounds {
            let dot = |y: f64| Dot { x: n as f64, y, ..Dot::default() };
            none.push(dot(n as f64));
            one.push(dot(1.0 + (n as f64 - 1.0) * forms.new_share_42));
            sites.push(dot(sum));
        }
    }
    let series = vec![
        Series::Line("no reuse".to_owned(), none),
        Series::Line("Algorithm 4.2".to_owned(), one),
        Series::Line("Algorithm 4.3 and its repairs".to_owned(), sites),
    ];
    let bound = Series::level("Algorithm 4.3, the paper's bound", forms.samples_43_bound, &series);
    let series = series.into_iter().chain([bound]).collect();
    let plot = Plot { x: Axis::linear("rounds"), y: Axis::linear("samples in all, in units of m"), series };
    Some(Figure::plot(
        "samples",
        "What sample reuse saves",
        "Expected samples after so many rounds, and the bound that the paper gives.",
        &plot,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sharp_form_is_the_sum() {
        for (p, horizon) in [(0.3, 7), (1.0, 5), (1e-5, 9), (1e-3, 50), (1e-12, 1000), (0.9e-5, 10)] {
            let sum: f64 = (1..=horizon).map(|t| closed::gone(p, t)).sum();
            assert!((sharp(p, horizon) / sum - 1.0).abs() < 1e-7, "{p} {horizon}: {} {sum}", sharp(p, horizon));
        }
    }
}
