//! The program's verbs on treebanks.

use super::text;
use assert_cmd::Command;
use tempfile::TempDir;

fn run(folder: &TempDir, line: &str, input: &str) -> (bool, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rollin"));
    let output = command.current_dir(folder.path()).args(line.split_whitespace()).write_stdin(input).output();
    let output = output.expect("the program runs");
    let ok = output.status.success();
    assert!(ok || output.status.code() == Some(2), "{line}: {:?}", output.status);
    (ok, String::from_utf8(if ok { output.stdout } else { output.stderr }).expect("text"))
}

fn good(folder: &TempDir, line: &str, input: &str) -> String {
    let (ok, text) = run(folder, line, input);
    assert!(ok, "{line}: {text}");
    text
}

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("t.conllu"), text(0, 60)).expect("a file");
    std::fs::write(folder.path().join("n.conllu"), text(60, 20)).expect("a file");
    folder
}

#[test]
fn from_a_treebank_to_a_parser() {
    let folder = folder();
    let line = "train --task parsing --data t.conllu --system arc-standard-swap --cutoff 1 --rounds 8 --model m";
    let report = good(&folder, line, "");
    assert!(
        report.starts_with("60 sentences, ") && report.contains(", 8 labels, system arc-standard-swap\n"),
        "{report}"
    );
    // The grammar is learned in full, crossing arcs and all: the input comes back with the trees that were taken from it.
    let new = text(60, 20);
    let blank = new.replace("\tdet\t", "\tobj\t");
    assert_eq!(good(&folder, "tag --model m", &blank), new);
    assert_eq!(good(&folder, "tag --model m", "\n\n"), "\n\n");
    let score = good(&folder, "evaluate --model m --data n.conllu", "");
    assert!(score.contains("LAS: 100.00%\nwithout punctuation: "), "{score}");
    let json: serde_json::Value =
        serde_json::from_str(&good(&folder, "evaluate --model m --data n.conllu --json", "")).expect("JSON");
    assert_eq!(json["all"]["words"], json["all"]["labelled"]);
    let told = good(&folder, "inspect m", "");
    assert!(told.contains("\nsystem          arc-standard-swap\nlabels          advmod case "), "{told}");
    let table = good(
        &folder,
        "compare --task parsing --data t.conllu --test n.conllu --algorithms supervised,dagger-online --cutoff 1",
        "",
    );
    assert!(table.contains("UAS %  LAS %"), "{table}");
}

#[test]
fn refusals() {
    let folder = folder();
    good(&folder, "train --task parsing --data t.conllu --model m --rounds 1", "");
    let says = |line: &str, input: &str, expected: &str| {
        let (ok, message) = run(&folder, line, input);
        assert!(!ok && message.starts_with(&format!("error: {expected}")), "{line}: {message}");
    };
    let bad = text(0, 2).replacen("\t3\tnsubj", "\t2\tnsubj", 1);
    says("tag --model m", &bad, "<stdin>:3:18: head 2; expected another word than this one");
    says(
        "evaluate --model m --data -",
        &text(0, 2).replacen("\tnsubj\t", "\tsubj\t", 1),
        "<stdin>:3:20: relation subj",
    );
    says("evaluate --model m --data n.conllu --label-column 2", "", "--label-column is given");
    says("train --task parsing --data t.conllu --model x --order free", "", "--order is given");
    says(
        "train --data t.conllu --model x --system arc-hybrid",
        "",
        "--system is given, but must be left out: tagging has no",
    );
    says(
        "train --task ocr --data t.conllu --model x --cutoff 2",
        "",
        "--cutoff is given, but must be left out: ocr has no",
    );
    says("compare --task parsing", "", "--data is left out, but must be given");
    assert!(!folder.path().join("x").exists());
}
