//! What works.

use super::{CHUNKS, Folder, TAGS, shipped};
use serde_json::Value;

pub const ALGORITHMS: [&str; 14] = [
    "supervised",
    "forward",
    "smile",
    "searn",
    "searn-online",
    "searn-shortcut",
    "cpi",
    "dagger",
    "dagger-online",
    "aggrevate",
    "lols",
    "lols-online",
    "stacked",
    "early-update",
];

/// Those who find costs by rolling out: the expert acts for them and gives no label.
const ROLL_OUTS: [&str; 5] = ["searn", "searn-online", "cpi", "lols", "lols-online"];
const LEARNERS: [&str; 8] = ["perceptron", "logistic", "hinge", "csoaa", "wap", "filter-tree", "svm", "crammer-singer"];

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

#[test]
fn from_a_grammar_to_a_tagger() {
    let folder = Folder::new();
    let grammar = shipped("grammars/dialects.grammar");
    let text = folder.run(&format!("generate --grammar {grammar} --count 200 --seed 3"));
    assert_eq!(text, folder.run(&format!("generate --grammar {grammar} --count 200 --seed 3 --threads 2")));
    assert_ne!(text, folder.run(&format!("generate --grammar {grammar} --count 200 --seed 4")));
    assert_eq!(text.split_terminator("\n\n").count(), 200);
    folder.put("train.txt", &text);
    let tokens = text.lines().filter(|line| !line.is_empty()).count();

    let report = folder.run("train --data train.txt --model m");
    assert!(report.starts_with("200 sentences, ") && report.ends_with("\nwrote m\n"), "{report}");
    assert_eq!(folder.names(), ["m", "train.txt"]);

    let tagged = folder.run_on("tag --model m", text.as_str());
    let right = tagged.lines().filter(|line| !line.is_empty()).filter(|line| {
        let cells: Vec<&str> = line.split(' ').collect();
        assert_eq!(cells.len(), 3);
        cells[1] == cells[2]
    });
    let accuracy = 100.0 * right.count() as f64 / tokens as f64;
    assert!(accuracy > 90.0, "{accuracy}");
    let expected = format!("processed {tokens} tokens\naccuracy: {accuracy:6.2}%\n");
    assert_eq!(folder.run("evaluate --model m --data train.txt"), expected);
    assert_eq!(folder.run_on("evaluate --model m --data -", text), expected);

    let inspected = folder.run("inspect m");
    for fact in [
        "policy          one classifier\n",
        "trained on      train.txt\n",
        "sentences       200\n",
        "order           free\n",
    ] {
        assert!(inspected.contains(fact), "{inspected}");
    }
}

#[test]
fn every_command_as_json() {
    let folder = Folder::new();
    folder.put("c.txt", CHUNKS);
    let trained = folder.json("train --data c.txt --model m --json --rounds 3 --seed 9");
    assert_eq!(trained["model"], "m");
    assert_eq!(trained["about"]["seed"], 9);
    assert_eq!((&trained["about"]["sentences"], &trained["about"]["tokens"]), (&2.into(), &10.into()));
    assert_eq!(trained["rounds"].as_array().map(Vec::len), Some(3));
    assert_eq!(trained["labels"], serde_json::json!(["B-NP", "B-VP", "I-NP", "O"]));

    let inspected = folder.json("inspect m --json");
    assert_eq!(inspected["about"], trained["about"]);
    assert_eq!((&inspected["order"], &inspected["policy"]), (&"iob2".into(), &"one classifier".into()));
    assert_eq!(inspected["weights"], serde_json::json!([1.0]));

    let score = folder.json("evaluate --model m --data c.txt --json");
    assert_eq!((&score["tokens"], &score["right"]), (&10.into(), &10.into()));
    assert_eq!(score["chunks"]["gold"], 5);
    assert_eq!(number(&score["accuracy"]), 1.0);
}

#[test]
fn a_tagged_line_is_the_line_and_its_label() {
    let folder = Folder::new();
    folder.put("t.txt", TAGS);
    folder.run("train --data t.txt --model m --rounds 20");
    let tag = |input: &str| folder.run_on("tag --model m", input);
    assert_eq!(tag("the\nold\nman\nsleeps\n"), "the D\nold A\nman N\nsleeps V\n");
    // Blank lines, several of them, before, between and after.
    assert_eq!(tag("\n\nthe\n \n\t\na\n\n\n"), "\n\nthe D\n \n\t\na D\n\n\n");
    // Ends of lines.
    assert_eq!(tag("the\r\n\r\na\r\n"), "the D\r\n\r\na D\r\n");
    assert_eq!(tag("a\nman"), "a D\nman N\n");
    assert_eq!(tag("the"), "the D\n");
    // Separators, and blanks at the end of a line.
    assert_eq!(tag("a\tX\nman\tY\n"), "a\tX\tD\nman\tY\tN\n");
    assert_eq!(tag("a  X\nman Y  \n"), "a  X D\nman Y N  \n");
    // A byte order mark belongs to no word, and is no token.
    assert_eq!(tag("\u{feff}a\nman\n"), "\u{feff}a D\nman N\n");
    assert_eq!(tag("\u{feff}\na\nman\n"), "\u{feff}\na D\nman N\n");
    assert_eq!(tag(""), "");
    assert_eq!(tag("\n \n"), "\n \n");
}

#[test]
fn long_inputs_are_tagged_as_their_sentences_are() {
    let folder = Folder::new();
    folder.put("t.txt", TAGS);
    folder.run("train --data t.txt --model m");
    let sentences: Vec<String> = TAGS
        .split_terminator("\n\n")
        .map(|sentence| sentence.lines().map(|line| format!("{line}\n")).collect())
        .collect();
    let alone: Vec<String> =
        sentences.iter().map(|sentence| folder.run_on("tag --model m", sentence.as_str())).collect();
    // More than two blocks of 65,536 lines.
    let repeated = |of: &[String]| (0..10_000).flat_map(|_| of).fold(String::new(), |all, one| all + one + "\n");
    let input = repeated(&sentences);
    assert!(input.lines().count() > 2 * 65_536);
    assert!(folder.run_on("tag --model m", input.as_str()) == repeated(&alone));
    assert!(folder.run_on("tag --model m --threads 1", input) == repeated(&alone));
}

/// `evaluate` sees the whole corpus at once, `tag` block after block: a sampled mixture draws the same for each sentence.
#[test]
fn sampled_mixtures_draw_by_sentence_and_not_by_block() {
    let folder = Folder::new();
    let grammar = shipped("grammars/dialects.grammar");
    folder.put("t.txt", folder.run(&format!("generate --grammar {grammar} --count 40")));
    folder.run("train --data t.txt --model m --algorithm smile --learner perceptron --reading sampled --rounds 4");
    folder.put("long.txt", folder.run(&format!("generate --grammar {grammar} --count 8000 --seed 2")));
    let tagged = folder.run_on("tag --model m", folder.get("long.txt"));
    assert!(tagged.lines().count() > 2 * 65_536);
    let columns = tagged.lines().map(|line| line.split(' ').collect::<Vec<_>>()).filter(|line| line.len() == 3);
    let right = columns.filter(|line| line[1] == line[2]).count();
    assert_eq!(folder.json("evaluate --model m --data long.txt --json")["right"], right);
}

#[test]
fn runs_and_threads_give_the_same_bytes() {
    let folder = Folder::new();
    let grammar = shipped("grammars/dialects.grammar");
    folder.put("t.txt", folder.run(&format!("generate --grammar {grammar} --count 60")));
    for algorithm in ["dagger-online", "dagger", "smile", "searn"] {
        let train = format!("train --data t.txt --algorithm {algorithm} --learner perceptron --reading sampled");
        folder.run(&format!("{train} --threads 1 --model one"));
        folder.run(&format!("{train} --threads 2 --model two"));
        folder.run(&format!("{train} --threads 2 --model again"));
        assert!(folder.get("one") == folder.get("two"), "{algorithm}");
        assert!(folder.get("two") == folder.get("again"), "{algorithm}");
        let tag = |threads| folder.run_on(&format!("tag --model one --threads {threads}"), folder.get("t.txt"));
        assert_eq!(tag(1), tag(2), "{algorithm}");
    }
    folder.run("train --data t.txt --model again --algorithm searn --learner perceptron --reading sampled --seed 2");
    assert!(folder.get("one") != folder.get("again"));
}

#[test]
fn spans_are_scored_as_by_conlleval() {
    let folder = Folder::new();
    folder.put("c.txt", CHUNKS);
    folder.run("train --data c.txt --model m --rounds 20");
    let expected = "\
processed 10 tokens with 5 phrases; found: 5 phrases; correct: 5.
accuracy: 100.00%; precision: 100.00%; recall: 100.00%; FB1: 100.00
               NP: precision: 100.00%; recall: 100.00%; FB1: 100.00  3
               VP: precision: 100.00%; recall: 100.00%; FB1: 100.00  2
";
    assert_eq!(folder.run("evaluate --model m --data c.txt"), expected);
    // A label that training never saw is an error of the model, one of ten here, and the span another type's.
    folder.put("other.txt", CHUNKS.replacen("B-VP", "B-XP", 1));
    let score = folder.json("evaluate --model m --data other.txt --json");
    assert_eq!((&score["tokens"], &score["right"]), (&10.into(), &9.into()));
    assert!(folder.run("evaluate --model m --data other.txt").contains("XP: precision:   0.00%; recall:   0.00%"));
    // The labels stand elsewhere.
    folder.put("moved.txt", CHUNKS.replace(" B", " x B").replace(" I", " x I").replace(" O", " x O"));
    assert_eq!(folder.run("evaluate --model m --data moved.txt --label-column 3"), expected);
}

#[test]
fn every_algorithm_with_every_learner() {
    let folder = Folder::new();
    folder.put("t.txt", TAGS);
    for algorithm in ALGORITHMS {
        for learner in LEARNERS {
            let line = format!("train --data t.txt --model m --algorithm {algorithm} --learner {learner}");
            folder.run(&line);
            let score = folder.json("evaluate --model m --data t.txt --json");
            assert_eq!(score["tokens"], 18);
            // Well above the 1 in 3 of one label everywhere.
            assert!(number(&score["right"]) >= 12.0, "{line}: {score}");
        }
    }
}

#[test]
fn a_mixture_is_read_in_three_ways() {
    let folder = Folder::new();
    folder.put("t.txt", TAGS);
    folder.run("train --data t.txt --model sampled --algorithm smile --rounds 4 --alpha 0.3 --reading sampled");
    let inspected = folder.json("inspect sampled --json");
    let weights: Vec<f64> = inspected["weights"].as_array().expect("a list").iter().map(number).collect();
    assert_eq!((weights.len(), &inspected["policy"]), (4, &"mixture".into()));
    assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{weights:?}");
    assert!(folder.run("inspect sampled").contains("mixture, read as sampled\n"));
    for reading in ["sampled", "vote", "mean"] {
        let train = format!("train --data t.txt --model {reading} --algorithm smile --rounds 4 --alpha 0.3");
        folder.run(&format!("{train} --reading {reading}"));
        // A model that is read in another way does what the one trained for that way does.
        let own = folder.run_on(&format!("tag --model {reading}"), TAGS);
        assert_eq!(folder.run_on(&format!("tag --model sampled --reading {reading}"), TAGS), own, "{reading}");
        let score = folder.json(&format!("evaluate --model sampled --data t.txt --reading {reading} --json"));
        assert!(number(&score["right"]) >= 12.0, "{reading}: {score}");
    }
    // The mean of linear classifiers is one of them.
    assert_eq!(folder.json("inspect mean --json")["policy"], "one classifier");
}

/// Checks what `compare --json` says of these algorithms.
fn check_rows(report: &Value, algorithms: &[&str]) {
    let rows = report["rows"].as_array().expect("a list");
    let names: Vec<&str> = rows.iter().filter_map(|row| row["algorithm"].as_str()).collect();
    assert_eq!(names, algorithms);
    for row in rows {
        let (ledger, expected) = (&row["ledger"], &row["expected"]);
        // Roll-outs ask the expert to act, never for a label.
        let rolls_out = row["algorithm"].as_str().is_some_and(|name| ROLL_OUTS.contains(&name));
        assert_eq!(number(&ledger["labels"]) > 0.0, !rolls_out, "{row}");
        assert!(number(&ledger["queries"]) > 0.0, "{row}");
        assert_eq!(number(&ledger["labels"]), number(&expected["labels"]), "{row}");
        for reading in row["readings"].as_array().expect("a list") {
            assert!((0.0..=100.0).contains(&number(&reading["accuracy"])), "{row}");
            assert!(number(&reading["loss"]) >= 0.0, "{row}");
        }
    }
}

#[test]
fn algorithms_are_compared() {
    let folder = Folder::new();
    folder.put("t.txt", TAGS);
    let line = "compare --data t.txt --test t.txt --algorithms";
    let report = folder.json(&format!("{line} {} --json", ALGORITHMS.join(",")));
    check_rows(&report, &ALGORITHMS);
    assert_eq!(report["best_accuracy"], Value::Null);
    let table = folder.run(&format!("{line} {}", ALGORITHMS.join(",")));
    for algorithm in ALGORITHMS {
        assert!(table.lines().any(|row| row.starts_with(&format!("{algorithm} "))), "{table}");
    }
    // Three readings of each mixture; the other settings go to whom they belong.
    assert_eq!(table.lines().filter(|row| row.starts_with("smile ")).count(), 3);
    let settings = folder.json(&format!("{line} supervised,smile --alpha 0.5 --rounds 2 --json"));
    assert_eq!(
        settings["rows"][1]["trainer"],
        serde_json::json!({"smile": {"alpha": 0.5, "rounds": 2, "warm": false, "reuse": "none"}})
    );
    // Without a test file the last fifth is measured on.
    let split = folder.json("compare --data t.txt --algorithms supervised --json");
    assert_eq!((&split["train"]["sentences"], &split["test"]["sentences"]), (&4.into(), &1.into()));
    folder.put("c.txt", CHUNKS);
    assert!(folder.run("compare --data c.txt --test c.txt --algorithms supervised").contains("F1 %"));
}

/// The settings of each algorithm reach it, and what it says of itself can be read again from its model.
#[test]
fn settings_reach_their_algorithms() {
    let folder = Folder::new();
    folder.put("t.txt", TAGS);
    let cases = [
        (
            "cpi --beta 0.5 --rollouts 2 --rounds 2",
            r#"{"cpi":{"rate":{"fixed":0.5},"rounds":2,"samples":2,"warm":false}}"#,
        ),
        ("cpi --conservative --warm", r#"{"cpi":{"rate":"advantage","rounds":5,"samples":1,"warm":true}}"#),
        ("dagger --schedule exponential:0.5", r#"{"dagger":{"rounds":5,"warm":false,"schedule":{"exponential":0.5}}}"#),
        ("dagger-online", r#"{"dagger-online":{"rounds":5,"warm":false,"schedule":null}}"#),
        ("aggrevate --schedule linear:3", r#"{"aggrevate":{"rounds":5,"warm":false,"schedule":{"linear":3}}}"#),
        ("lols --reference 0", r#"{"lols":{"beta":0.0,"rounds":5,"warm":false}}"#),
        ("lols-online --reference 1 --rounds 3", r#"{"lols-online":{"beta":1.0,"rounds":3,"warm":false}}"#),
        ("stacked --folds 2 --window 1", r#"{"stacked":{"folds":2,"window":1}}"#),
        ("early-update --width 8 --rounds 6", r#"{"early-update":{"width":8,"rounds":6}}"#),
    ];
    for (settings, trainer) in cases {
        folder.run(&format!("train --data t.txt --model m --algorithm {settings}"));
        assert_eq!(folder.json("inspect m --json")["about"]["trainer"], trainer, "{settings}");
        // What a model file says is what was trained: it labels the same, whole or line by line.
        let once = folder.run_on("tag --model m", TAGS);
        assert_eq!(once, folder.run_on("tag --model m --threads 2", TAGS), "{settings}");
        assert_eq!(once.lines().count(), TAGS.lines().count());
    }
    assert!(folder.run("inspect m").contains("one classifier with a beam, 8 wide\n"));
    assert_eq!(folder.json("inspect m --json")["about"]["learner"], "none");
    folder.run("train --data t.txt --model m --algorithm stacked --window 3");
    assert!(folder.run("inspect m").contains("two stages, window 3\n"));
    // Only LOLS tells what it could have done better.
    let table = |algorithm: &str| folder.run(&format!("train --data t.txt --model m --algorithm {algorithm}"));
    assert!(table("lols-online").contains("regret to the expert") && !table("dagger").contains("regret"));
    let rounds = folder.json("train --data t.txt --model m --algorithm lols --rounds 2 --json");
    assert!(rounds["rounds"][0]["regret"].is_null() && number(&rounds["rounds"][1]["regret"]["reference"]) >= 0.0);
}

#[test]
fn without_data_the_embedded_corpora_are_compared_on() {
    let folder = Folder::new();
    let report = folder.json("compare --first 200 --algorithms supervised,dagger-online --json");
    check_rows(&report, &["supervised", "dagger-online"]);
    assert_eq!(report["train"]["sentences"], 200);
    let best = number(&report["best_accuracy"]);
    assert!((90.0..100.0).contains(&best), "{best}");
    let table = folder.run("compare --first 200 --algorithms supervised");
    assert!(table.contains(&format!("expected to exceed {best:.2} %")), "{table}");
}

#[test]
fn a_template_of_ones_own() {
    let folder = Folder::new();
    folder.put("c.txt", CHUNKS);
    folder.run(&format!("train --data c.txt --model m --template {}", shipped("grammars/chunking.template")));
    let template = std::fs::read_to_string(shipped("grammars/chunking.template")).expect("it is there");
    assert_eq!(folder.json("inspect m --json")["template"], template);
    // With a template of its own, the first column may hold the labels.
    folder.put("turned.txt", "D the\nN man\n\nD a\nN boat\n");
    folder.put("word.template", "U:%x[0,1]\n");
    folder.run("train --data turned.txt --model turned --template word.template --label-column 0");
    assert_eq!(folder.run_on("tag --model turned", "? the\n? man\n"), "? the D\n? man N\n");
}
