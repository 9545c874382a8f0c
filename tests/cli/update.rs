//! Models that go on learning.

use super::{Folder, TAGS, shipped};

#[test]
fn more_data_make_a_better_tagger() {
    let folder = Folder::new();
    let grammar = shipped("grammars/dialects.grammar");
    let draw = |count, seed| folder.run(&format!("generate --grammar {grammar} --count {count} --seed {seed}"));
    folder.put("first.txt", draw(100, 1));
    folder.put("more.txt", draw(400, 2));
    folder.put("test.txt", draw(300, 3));
    folder.run("train --data first.txt --model m");
    let right = |model: &str| {
        let score = folder.json(&format!("evaluate --model {model} --data test.txt --json"));
        score["right"].as_f64().expect("a count") / score["tokens"].as_f64().expect("a count")
    };
    let report = folder.run("update --model m --data more.txt --output n");
    assert!(report.starts_with("400 sentences more, ") && report.ends_with("\nwrote n\n"), "{report}");
    let (before, after) = (right("m"), right("n"));
    assert!(after > before + 0.02, "{before}, then {after}");

    folder.run("update --model m --data more.txt --output same --threads 1");
    assert!(folder.get("n") == folder.get("same"));
    folder.run("update --model n --data more.txt --output n --rounds 1 --seed 2");
    assert!(folder.get("n") != folder.get("same"));
    let about = &folder.json("inspect n --json")["about"];
    assert_eq!(about["data"], "first.txt, then more.txt, then more.txt");
    assert_eq!(about["sentences"], 900);
    assert_eq!(
        folder.json("update --model m --data more.txt --output x --json")["rounds"].as_array().expect("5").len(),
        5
    );
}

#[test]
fn refusals() {
    let folder = Folder::new();
    folder.put("t.txt", TAGS);
    folder.put("odd.txt", "the D\nman X\n");
    folder.put("chunks.txt", "a B-NP\nman I-NP\nsinks O\n");
    folder.put("broken.txt", "a B-NP\nsinks O\nman I-NP\n");
    folder.put("ahead.template", "U:%x[0,0]\nU:%y[1]\n");
    folder.run("train --data t.txt --model m");
    folder.run("train --data chunks.txt --model chunks.m");
    folder.run("train --data t.txt --model drawn --algorithm smile --reading sampled");
    folder.run("train --data t.txt --model early --algorithm early-update");
    folder.run("train --data t.txt --model ahead --template ahead.template");
    folder.run("train --task segmenting --data chunks.txt --model spans");
    for (line, expected) in [
        ("--model m --data odd.txt", "odd.txt:2:5: label X; expected one of the model's labels: A D N V"),
        (
            "--model chunks.m --data broken.txt",
            "broken.txt:3:5: label I-NP; expected a label that may stand there by iob2",
        ),
        ("--model drawn --data t.txt", "model is not one classifier of a learner"),
        ("--model early --data t.txt", "model is not one classifier of a learner"),
        ("--model ahead --data t.txt", "model is not one classifier of a learner"),
        ("--model spans --data chunks.txt", "task is segmenting, but must be tagging"),
        ("--model m --data t.txt --rounds 0", "rounds is 0, but must be at least 1"),
        ("--model m --data none.txt", "cannot read none.txt"),
        ("--model - --data t.txt", "--model is -, but must be a file"),
    ] {
        let message = folder.refused(&format!("update {line} --output x"));
        assert!(message.contains(expected), "{line}: {message}");
        assert!(!folder.names().contains(&"x".to_owned()), "{line}");
    }
}
