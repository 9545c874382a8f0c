//! Segmentation through the verbs, and how sure labels are.

use super::{CHUNKS, Folder, TAGS, shipped};

/// Five times the sentences of the small corpora, so that a tenth can be set aside.
fn many(text: &str) -> String {
    format!("{}\n", text.trim_end()).repeat(10).replace("\n\n\n", "\n\n").replace(". . O\nthe", ". . O\n\nthe")
}

#[test]
fn segmenting_through_the_verbs() {
    let folder = Folder::new();
    folder.put("c.txt", CHUNKS);
    let report = folder.run("train --task segmenting --data c.txt --model m --rounds 20 --span 4");
    assert!(report.starts_with("2 sentences, 10 tokens, 2 spans\n"), "{report}");
    let score = folder.json("evaluate --model m --data c.txt --json");
    assert_eq!((&score["right"], &score["chunks"]["correct"]), (&10.into(), &5.into()));
    let tagged = folder.run_on("tag --model m", "\nthe D\r\nold A\nman N\n\n \na D\nman N");
    assert_eq!(tagged, "\nthe D B-NP\r\nold A I-NP\nman N I-NP\n\n \na D B-NP\nman N I-NP\n");
    let inspected = folder.json("inspect m --json");
    let spans = serde_json::json!([{"type": "NP", "longest": 3}, {"type": "VP", "longest": 1}]);
    assert_eq!((&inspected["task"], &inspected["spans"]), (&"segmenting".into(), &spans));
    assert!(folder.run("inspect m").contains("spans           NP 1-3, VP 1-1\n"));
    let names =
        "supervised,forward,smile,searn,searn-shortcut,dagger,dagger-online,aggrevate,lols,stacked,early-update";
    let compared = folder.json(&format!(
        "compare --task segmenting --data c.txt --test c.txt --algorithms {names} --rounds 5 --json --quiet"
    ));
    let rows = compared["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 11);
    for row in rows {
        assert!(row["readings"][0]["f1"].as_f64().is_some_and(|f1| f1 > 60.0), "{row}");
    }
    folder.says(
        "train --task segmenting --data c.txt --model n --label-column 1",
        "c.txt:1:5: label D; expected labels of spans: O, or B-, I-, L-, U-, E- or S- and a type",
    );
    folder.says(
        "train --task segmenting --data c.txt --model n --repair",
        "--repair is given, but must be left out: segmenting has no such setting",
    );
    folder.says(
        "train --data c.txt --model n --span 3",
        "--span is given, but must be left out: tagging has no such setting",
    );
}

/// The last column of each token's line.
fn last(tagged: &str) -> Vec<f64> {
    let cells = tagged.lines().filter_map(|line| line.split([' ', '\t']).next_back());
    cells.filter(|cell| !cell.is_empty()).map(|cell| cell.parse().expect("a number")).collect()
}

#[test]
fn labels_come_with_their_probability() {
    let folder = Folder::new();
    let grammar = shipped("grammars/dialects.grammar");
    folder.put("t.txt", folder.run(&format!("generate --grammar {grammar} --count 200")));
    let test = folder.run(&format!("generate --grammar {grammar} --count 100 --seed 9"));
    folder.put("test.txt", &test);
    for options in [
        "",
        "--algorithm smile --rounds 3",
        "--algorithm smile --rounds 3 --reading sampled",
        "--algorithm forward",
        "--algorithm stacked",
        "--algorithm early-update",
        "--learner svm",
        "--learner filter-tree",
    ] {
        folder.run(&format!("train --data t.txt --model m --calibrate --quiet {options}"));
        let plain = folder.run_on("tag --model m", test.as_str());
        let sure = folder.run_on("tag --model m --confidence", test.as_str());
        assert_eq!(sure, folder.run_on("tag --model m --confidence --threads 1", test.as_str()));
        // The same labels, and one column more.
        for (plain, sure) in plain.lines().zip(sure.lines()) {
            assert!(sure.is_empty() && plain.is_empty() || sure.starts_with(&format!("{plain} ")), "{sure}");
        }
        let sure = last(&sure);
        assert!(sure.iter().all(|p| (0.0..=1.0).contains(p)), "{options}");
        let score = folder.json("evaluate --model m --data test.txt --json");
        let (error, accuracy) = (score["calibration_error"].as_f64(), score["accuracy"].as_f64());
        let mean = sure.iter().sum::<f64>() / sure.len() as f64;
        // The error is no less than the distance of the means.
        let distance = (mean - accuracy.expect("a number")).abs();
        assert!(error.is_some_and(|error| error >= distance - 1e-4 && error < 0.1), "{options}: {error:?} {distance}");
    }
    let text = folder.run("evaluate --model m --data test.txt");
    assert!(text.lines().last().is_some_and(|line| line.starts_with("expected calibration error: ")), "{text}");
    assert!(folder.run("inspect m").contains("temperatures    "));
}

/// Two readings, and spans: all tokens of a span are as sure as it.
#[test]
fn readings_and_spans_are_calibrated_too() {
    let folder = Folder::new();
    folder.put("c.txt", many(CHUNKS));
    folder.run(&format!(
        "train --data c.txt --model m --calibrate --template {}",
        shipped("grammars/chunking-ahead.template")
    ));
    assert!(folder.json("inspect m --json")["temperatures"].as_array().is_some_and(|t| t.len() == 2));
    assert!(last(&folder.run_on("tag --model m --confidence", CHUNKS)).iter().all(|p| *p > 0.5 && *p <= 1.0));
    folder.run("train --task segmenting --data c.txt --model m --calibrate");
    let sure = last(&folder.run_on("tag --model m --confidence", "the D\nold A\nman N\nsleeps V\n"));
    assert_eq!((sure.len(), sure[0], sure[0]), (4, sure[1], sure[2]));
    assert!(
        folder.json("evaluate --model m --data c.txt --json")["calibration_error"].as_f64().is_some_and(|e| e < 0.2)
    );
}

#[test]
fn confidence_is_refused_where_there_is_none() {
    let folder = Folder::new();
    folder.put("t.txt", TAGS);
    folder.run("train --data t.txt --model m");
    folder.says_on(
        "tag --model m --confidence",
        "the\n",
        "m: a model that was not calibrated; train it with --calibrate, and with the --reading that it is used with",
    );
    assert_eq!(folder.json("evaluate --model m --data t.txt --json").get("calibration_error"), None);
    folder.says(
        "train --data t.txt --model n --calibrate",
        "t.txt: too few sentences to set a tenth aside: 5; give at least 10, or leave --calibrate out",
    );
    folder.put("many.txt", many(TAGS));
    folder.run("train --data many.txt --model m --calibrate --algorithm smile --rounds 2 --reading vote");
    assert_eq!(last(&folder.run_on("tag --model m --confidence --reading sampled", "the\n")).len(), 1);
    // Its two classifiers become one, of which nothing is known.
    folder.refused_on("tag --model m --confidence --reading mean", "the\n");
    assert_eq!(folder.run_on("tag --model m --reading mean", "the\n"), "the D\n");
    folder.put("bank", "1\ta\t_\tX\t_\t_\t0\troot\t_\t_\n\n".repeat(10));
    folder.says(
        "train --task parsing --data bank --model n --calibrate",
        "--calibrate is given, but must be left out: parsing has no such setting",
    );
}
