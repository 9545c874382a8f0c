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

/// Sentences of a determiner, a noun and a verb, the words numbered from `first` on.
fn trees(first: usize, count: usize, subject: &str) -> String {
    let sentence = |i: usize| {
        let the = format!("1\tthe{}\t_\tDET\t_\t_\t2\tdet\t_\t_\n", i % 3);
        let noun = format!("2\tn{i}\t_\tNOUN\t_\t_\t3\t{subject}\t_\t_\n");
        the + &noun + &format!("3\tv{}\t_\tVERB\t_\t_\t0\troot\t_\t_\n\n", i % 7)
    };
    (first..first + count).map(sentence).collect()
}

#[test]
fn more_data_make_a_better_parser() {
    let folder = Folder::new();
    folder.put("first.conllu", trees(0, 20, "nsubj") + &trees(100, 2, "obj"));
    folder.put("more.conllu", trees(50, 20, "obj"));
    folder.put("odd.conllu", trees(0, 1, "nsubj:pass"));
    folder.run("train --task parsing --data first.conllu --model m --cutoff 1");
    let las = |model: &str| {
        folder.json(&format!("evaluate --model {model} --data more.conllu --json"))["all"]["las"]
            .as_f64()
            .expect("a share")
    };
    folder.run("update --model m --data more.conllu --output n");
    assert!(las("n") > las("m"), "{} after {}", las("n"), las("m"));
    let count = |model: &str| folder.json(&format!("inspect {model} --json"))["features"].as_u64().expect("a count");
    assert!(count("n") > count("m"));
    assert_eq!(
        folder.refused("update --model m --data odd.conllu --output x"),
        "error: odd.conllu:2:19: relation nsubj:pass; expected one of the model's: det nsubj obj root\n"
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
        ("--model spans --data chunks.txt", "task is segmenting, but must be tagging or parsing"),
        ("--model m --data t.txt --rounds 0", "rounds is 0, but must be at least 1"),
        ("--model m --data none.txt", "cannot read none.txt"),
        ("--model - --data t.txt", "--model is -, but must be a file"),
    ] {
        let message = folder.refused(&format!("update {line} --output x"));
        assert!(message.contains(expected), "{line}: {message}");
        assert!(!folder.names().contains(&"x".to_owned()), "{line}");
    }
}
