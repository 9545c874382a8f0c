//! The page of an experiment.

use crate::balance::plan;
use crate::findings;
use rollin::experiment::{Findings, claims, page};
use roxmltree::{Document, Node, ParsingOptions};

/// The cells of a figure's table.
fn rows(page: &Document<'_>, figure: &str) -> Vec<Vec<String>> {
    let found = page.descendants().find(|node| node.attribute("id") == Some(figure)).expect("the figure");
    let row = |row: Node<'_, '_>| row.children().filter_map(|cell| cell.text().map(str::to_owned)).collect::<Vec<_>>();
    let named = |node: &Node<'_, '_>| node.tag_name().name() == "tr";
    found
        .descendants()
        .filter(named)
        .skip(1)
        .map(row)
        .map(|row| row.into_iter().filter(|text| text != "\n").collect())
        .collect()
}

fn check(found: &Findings) {
    let text = page(found, &claims(found)).html();
    assert!(text.len() < 500_000, "{} bytes", text.len());
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let page = Document::parse_with_options(&text, options).expect("well formed");
    for (figure, along) in [("queries", true), ("rounds", false)] {
        let mut rows = rows(&page, figure).into_iter();
        for method in &found.plan.methods {
            for round in found.rounds(&method.name) {
                let row = rows.next().expect("a row a point");
                let main = found.main(&method.name, round).expect("it was measured");
                let x = if along { found.bill(&method.name, round, |ledger| ledger.queries) } else { round as f64 };
                let ends = if main.half.is_finite() {
                    [main.low(), main.high()].map(|x| x.to_string())
                } else {
                    ["-", "-"].map(str::to_owned)
                };
                assert_eq!(row[..2], [method.name.clone(), format!("round {round}")]);
                assert_eq!(row[2..4], [x, main.mean].map(|x| x.to_string()));
                assert!(row.len() == 4 || row[4..] == ends, "{row:?}");
                assert_eq!(
                    row.len() == 6,
                    found.main(&method.name, round).is_some_and(|main| main.half.is_finite()),
                    "{row:?}"
                );
            }
        }
        assert_eq!(rows.next(), None);
    }
    assert!(found.plan.methods.iter().all(|method| text.contains(&method.name)));
}

#[test]
fn pages_hold_the_findings() {
    check(&findings(&plan(&["supervised", "smile", "dagger", "forward", "searn"])));
    let mut again = plan(&["supervised", "smile"]);
    again.trainings = 3;
    check(&findings(&again));
}

/// An experiment far larger than those of the paper stays a page that a telephone can hold.
#[test]
fn many_points_stay_a_page() {
    let mut found = findings(&plan(&["supervised", "smile"]));
    let points = found.points.clone();
    let methods = found.plan.methods.clone();
    for copy in 1..6 {
        let name = |name: &str| format!("{name}-{copy}");
        found.plan.methods.extend(methods.iter().cloned().map(|mut method| {
            method.name = name(&method.name);
            method
        }));
        found.points.extend(points.iter().cloned().map(|mut point| {
            point.method = name(&point.method);
            point
        }));
    }
    // Each method has four rounds; five times as many.
    let points = found.points.clone();
    for more in 1..5 {
        found.points.extend(points.iter().cloned().map(|mut point| {
            point.round += 4 * more;
            point
        }));
    }
    check(&found);
}
