//! `rollin theory` on the command line: what it prints, and what it refuses.

use assert_cmd::Command;
use serde_json::{Value, json};
use std::io::Write;

fn rollin(args: &[&str]) -> Command {
    let mut command = Command::cargo_bin("rollin").expect("the program is built");
    command.arg("theory").args(args);
    command
}

fn json_of(args: &[&str]) -> Value {
    let output = rollin(args).arg("--json").output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// A small instance with every input.
fn instance() -> Value {
    let line = include_str!("data/theory.jsonl").lines().last().expect("six lines");
    serde_json::from_str(line).expect("JSON")
}

/// What the audit of this text says on standard error, having failed with exit code 2.
fn refusal(text: &str) -> String {
    let output = rollin(&["audit", "-"]).write_stdin(text).output().expect("it runs");
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(output.stdout.is_empty());
    String::from_utf8(output.stderr).expect("UTF-8")
}

#[test]
fn audit_says_everything() {
    let mut file = tempfile::NamedTempFile::new().expect("a file");
    write!(file, "{}", instance()).expect("it is written");
    let path = file.path().to_str().expect("UTF-8");
    let audit = json_of(&["audit", path]);
    for group in ["eval", "forward", "korder", "smile", "searn", "reuse", "counts", "population"] {
        assert!(audit[group].is_object(), "{group}");
    }
    assert_eq!(audit["left_out"], json!([]));
    assert!(audit["theorems"].as_array().expect("a list").iter().all(|bound| bound["slack"].is_f64()));
    let output = rollin(&["audit", path]).output().expect("it runs");
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    for words in ["Theorem 2.1", "Theorem 4.1", "Lemma 4.2", "slack", "expected expert queries"] {
        assert!(text.contains(words), "{words}");
    }
}

#[test]
fn audit_leaves_out_what_has_no_input() {
    let mut small = instance();
    for key in ["pi", "pis", "hats", "phi", "m", "counts"] {
        small.as_object_mut().expect("an object").remove(key);
    }
    let output = rollin(&["audit", "-", "--json"]).write_stdin(small.to_string()).output().expect("it runs");
    let audit: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(audit["eval"]["J_star"].is_number() && audit["forward"].is_null());
    assert_eq!(audit["left_out"].as_array().map(Vec::len), Some(5));
}

#[test]
fn audit_names_the_fault() {
    let change = |pointer: &str, value: Value| {
        let mut instance = instance();
        *instance.pointer_mut(pointer).expect("it is there") = value;
        refusal(&instance.to_string())
    };
    let faults = [
        ("/P/1/0", json!([0.5, 0.4]), "<stdin>: P[1][0]: sums to 0.9; expected 1"),
        ("/P/0/1/0", json!(-1), "P[0][1][0]: -1; expected a probability"),
        ("/P/0", json!([[1, 0]]), "P[0]: 1 rows; expected 2"),
        ("/C/1/1", json!(1.5), "C[1][1]: 1.5; expected a cost from 0 to 1"),
        ("/mu", json!([1, 0, 0]), "mu: 3 numbers; expected 2"),
        ("/mu", json!([0.25, 0.25]), "mu: sums to 0.5; expected 1"),
        ("/expert/1", json!(2), "expert[1]: 2; expected an action from 0 to 1"),
        ("/T", json!(0), "T: 0; expected from 1 to"),
        ("/T", json!(1_000_000_000_000u64), "T: 1000000000000; expected from 1 to"),
        ("/T", json!(3), "pis: 2 policies; expected 3"),
        ("/N", json!(3), "hats: 2 classifiers; expected 3"),
        ("/alpha", json!(0), "alpha: 0; expected a rate from 1e-15 to 1"),
        ("/hats/1/0", json!([0.5, 0.6]), "hats[1][0]: sums to 1.1; expected 1"),
        ("/pis/1/1", json!([1]), "pis[1][1]: 1 numbers; expected 2"),
        ("/phi", json!([]), "phi: 0 numbers; expected 2"),
        ("/m", json!(0), "m: 0; expected from 1"),
        ("/S", json!(3), "mu: 2 numbers; expected 3"),
        ("/S", json!(0), "mu: 2 numbers; expected 0"),
        ("/T", json!(-1), "<stdin>:1:"),
    ];
    for (pointer, value, message) in faults {
        let found = change(pointer, value);
        assert!(found.contains(message), "{pointer}: {found}");
    }
    let found = refusal("{\"S\": 1,\n \"A\": }");
    assert!(found.contains("<stdin>:2:7: expected value"), "{found}");
    assert!(refusal("").contains("<stdin>:1:1"));
    assert!(refusal("{\"S\":0,\"A\":0,\"T\":1,\"mu\":[],\"P\":[],\"C\":[],\"expert\":[]}").contains("0 states"));
    assert!(refusal("{\"S\":1}").contains("missing field `A`"));
}

#[test]
fn audit_refuses_what_is_too_large() {
    // Stands for any endless input: it is not read to its end.
    let blank = vec![b' '; (rollin::theory::instance::LARGEST + 1) as usize];
    let output = rollin(&["audit", "-"]).write_stdin(blank).output().expect("it runs");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("larger than 64 MiB"));
}

#[test]
fn bounds_and_plan_are_closed_forms() {
    let bounds = json_of(&["bounds", "--horizon", "10", "--alpha", "0.1"]);
    assert_eq!(bounds["rounds_to_inverse_square"], 44.0);
    assert_eq!(bounds["rounds_to_inverse_square_printed"], 47.0);
    let one = json_of(&["bounds", "--horizon", "1", "--alpha", "1"]);
    assert_eq!((&one["bias_42"], &one["theorem_4_1_alpha"]), (&json!(0.0), &Value::Null));
    // Astronomic: still an answer, and at once.
    let slow = json_of(&["bounds", "--horizon", "1000000", "--alpha", "1e-15"]);
    assert!(slow["rounds"].as_f64().expect("a number") > 1e16 && slow["drift_43"].is_null());
    let plan = [
        "plan",
        "--horizon",
        "2",
        "--alpha",
        "0.5",
        "--beta",
        "0.5",
        "--m",
        "4",
        "--actions",
        "2",
        "--k",
        "1",
        "--rounds",
        "2",
    ];
    assert_eq!(json_of(&plan), instance_counts());
    for wrong in [["bounds", "--horizon", "0", "--alpha", "0.1"], ["bounds", "--horizon", "5", "--alpha", "1.5"]] {
        assert_eq!(rollin(&wrong).output().expect("it runs").status.code(), Some(2));
    }
    let output = rollin(&["bounds", "--horizon", "5", "--alpha", "NaN"]).output().expect("it runs");
    assert!(String::from_utf8_lossy(&output.stderr).contains("--alpha is NaN"));
}

/// The counts that the audit of the small instance has.
fn instance_counts() -> Value {
    let output = rollin(&["audit", "-", "--json"]).write_stdin(instance().to_string()).output().expect("it runs");
    let audit: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    audit["counts"].clone()
}
