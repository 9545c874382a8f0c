//! The commands in the README and in the guide, run as they stand there. Their Rust examples are documentation tests.
#![cfg(all(feature = "cli", unix))]

use std::path::Path;
use std::process::Command;

/// Every text with commands for users.
const TEXTS: [(&str, &str); 8] = [
    ("README.md", include_str!("../README.md")),
    ("start.md", include_str!("../src/guide/start.md")),
    ("choosing.md", include_str!("../src/guide/choosing.md")),
    ("bill.md", include_str!("../src/guide/bill.md")),
    ("complaints.md", include_str!("../src/guide/complaints.md")),
    ("from_crfsuite.md", include_str!("../src/guide/from_crfsuite.md")),
    ("from_vowpal_wabbit.md", include_str!("../src/guide/from_vowpal_wabbit.md")),
    ("from_wapiti.md", include_str!("../src/guide/from_wapiti.md")),
];

/// What is not run here, and where it is.
const ELSEWHERE: [(&str, &str); 3] = [
    ("cargo ", "the build's own commands run this test"),
    ("rollin experiment ", "takes minutes: tests/experiment has it, smaller"),
    ("rollin drive ", "needs what an experiment leaves: tests/experiment"),
];

const CHUNKS: &str = "Confidence NN B-NP\nin IN B-PP\nthe DT B-NP\npound NN I-NP\nis VBZ B-VP\n. . O\n\n";

const TREE: &str = "1\tthe\tthe\tDET\tDT\t_\t2\tdet\t_\t_\n2\tcat\tcat\tNOUN\tNN\t_\t3\tnsubj\t_\t_\n\
    3\tsleeps\tsleep\tVERB\tVBZ\t_\t0\troot\t_\t_\n\n";

/// Puts what the commands read into `folder`.
fn prepare(folder: &Path) {
    let put = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("the folder takes files");
    for name in ["train.txt", "test.txt"] {
        put(name, &CHUNKS.repeat(20));
    }
    put("new.txt", "the DT\npound NN\n\n");
    put("my.template", "U1:%x[0,0]\nU2:%x[-1,1]/%x[0,1]\nB\n");
    put("train.crf", "B-NP\tw=the\tpos=DT\nI-NP\tw=pound\tpos=NN\n\n");
    put("train.vw", "1 |w the |p DT\n2 |w pound |p NN\n\n");
    for name in ["train.conllu", "test.conllu", "in.conllu"] {
        put(name, &TREE.repeat(3));
    }
    put("problem.json", include_str!("data/theory.jsonl").lines().last().expect("six instances"));
}

/// The lines of the blocks of commands in `text`; a block of a kind that nobody knows how to run fails.
fn commands(text: &str) -> Vec<&str> {
    let (mut kind, mut lines) = (None, Vec::new());
    for line in text.lines() {
        match (line.trim_start().strip_prefix("```"), kind) {
            (Some(_), Some(_)) => kind = None,
            (Some(opened), None) => {
                let known = ["", "sh", "text", "rust", "standalone_crate"];
                assert!(known.contains(&opened), "who runs a block of {opened}?");
                kind = Some(opened);
            }
            (None, Some("sh")) if !line.is_empty() && !line.starts_with('#') => lines.push(line),
            (None, _) => {}
        }
    }
    lines
}

/// The lines of a table of `compare` without their last column, the seconds.
fn table(text: &str) -> Vec<Vec<&str>> {
    let rows = text.lines().skip_while(|line| !line.trim_start().starts_with("reading ")).skip(1);
    let rows = rows.map(|line| line.split_whitespace().collect::<Vec<_>>()).take_while(|cells| cells.len() == 8);
    rows.map(|mut cells| {
        cells.pop();
        cells
    })
    .collect()
}

/// What the README says of accuracy is what this version does.
#[test]
fn the_table_of_the_readme_is_made_again() {
    let output = Command::new(env!("CARGO_BIN_EXE_rollin")).args(["compare", "--quiet"]).output().expect("it runs");
    let (made, told) = (String::from_utf8_lossy(&output.stdout), TEXTS[0].1);
    assert_eq!(table(&made).len(), 9, "{made}");
    assert_eq!(table(&made), table(told));
    let lead = made.lines().next().expect("a line");
    assert!(told.contains(lead), "{lead}");
}

#[test]
fn commands_in_documents_run() {
    let program = Path::new(env!("CARGO_BIN_EXE_rollin"));
    let path = std::env::var("PATH").expect("a path");
    let path = format!("{}:{path}", program.parent().expect("a folder").display());
    for (name, text) in TEXTS {
        let folder = tempfile::tempdir().expect("a temporary folder");
        prepare(folder.path());
        let commands = commands(text);
        assert!(!commands.is_empty(), "{name} has no commands");
        for line in commands {
            if ELSEWHERE.iter().any(|(start, _)| line.starts_with(start)) {
                continue;
            }
            assert!(line.starts_with("rollin ") || line.starts_with("printf "), "{name}: {line}");
            let output = Command::new("sh").args(["-c", line]).env("PATH", &path).current_dir(&folder).output();
            let output = output.expect("there is a shell");
            let errors = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{name}: {line}\n{errors}");
        }
    }
}

/// The sources below `folder`.
fn sources(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("an entry").path();
        match path.extension() {
            None if path.is_dir() => sources(&path, found),
            Some(kind) if kind == "rs" => found.push(path),
            _ => {}
        }
    }
}

/// Statistics have seeds that are written down: nothing in the tests draws from the clock or the system.
#[test]
fn no_test_draws_from_the_clock() {
    let mut found = Vec::new();
    for folder in ["tests", "src"] {
        sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut found);
    }
    assert!(found.len() > 100, "{}", found.len());
    for path in found.iter().filter(|path| !path.ends_with("tests/documents.rs")) {
        let text = std::fs::read_to_string(path).expect("text");
        for source in ["thread_rng", "rand::rng(", "from_os_rng", "SysRng", "from_entropy", "SystemTime"] {
            assert!(!text.contains(source), "{}: {source}", path.display());
        }
    }
}

/// The tests that the page of complaints points to are there.
#[test]
fn tests_in_documents_exist() {
    let mut found = Vec::new();
    for folder in ["tests", "src"] {
        sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut found);
    }
    let code: String = found.iter().map(|path| std::fs::read_to_string(path).expect("text")).collect();
    let page = include_str!("../src/guide/complaints.md");
    let spans = page.split('`').skip(1).step_by(2);
    let names: Vec<&str> =
        spans.filter(|span| span.contains('_') && span.chars().all(|c| c == '_' || c.is_ascii_lowercase())).collect();
    assert!(names.len() > 10, "{names:?}");
    for name in names {
        assert!(code.contains(&format!("fn {name}()")), "{name}");
    }
}
