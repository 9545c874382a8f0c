//! The theory against worked instances: exact rationals printed as numbers, computed by an independent program.
//!
//! Six small instances with numbers worked by hand always run. The 60 larger ones are read from
//! `$ROLLIN_DATA/../theory/vectors.jsonl`.

use rollin::theory::audit::audit;
use rollin::theory::instance::Instance;
use serde_json::Value;
use std::path::PathBuf;

/// The first place where `found` does not hold what `expected` holds, to 1e-9; keys that only `found` has do not
/// matter.
fn difference(at: &str, found: &Value, expected: &Value) -> Option<String> {
    match (found, expected) {
        (Value::Number(found), Value::Number(expected)) => {
            let (found, expected) = (found.as_f64()?, expected.as_f64()?);
            // Written so that a NaN differs.
            let near = (found - expected).abs() <= 1e-9;
            (!near).then(|| format!("{at}: {found} for {expected}"))
        }
        (Value::Array(found), Value::Array(expected)) if found.len() == expected.len() => {
            let pairs = found.iter().zip(expected).enumerate();
            pairs.into_iter().find_map(|(i, (found, expected))| difference(&format!("{at}[{i}]"), found, expected))
        }
        (Value::Object(found), Value::Object(expected)) => expected.iter().find_map(|(key, expected)| {
            difference(&format!("{at}.{key}"), found.get(key).unwrap_or(&Value::String("nothing".into())), expected)
        }),
        (found, expected) if found == expected => None,
        (found, expected) => Some(format!("{at}: {found} for {expected}").chars().take(200).collect()),
    }
}

fn vectors() -> Option<PathBuf> {
    let path = PathBuf::from(std::env::var_os("ROLLIN_DATA")?).join("../theory/vectors.jsonl");
    path.exists().then_some(path)
}

/// Audits every line of `text` and compares what it says it should be; gives the number of lines and of keys compared.
fn check(path: &str, text: &str) -> (usize, usize) {
    let mut wrong = Vec::new();
    let (mut lines, mut keys) = (0, 0);
    for line in text.lines() {
        lines += 1;
        let expected: Value = serde_json::from_str(line).expect("JSON");
        let instance = Instance::parse(path, line.as_bytes()).expect("an instance");
        let found = serde_json::to_value(audit(&instance).expect("an audit")).expect("JSON");
        for group in ["eval", "forward", "korder", "smile", "searn", "reuse", "counts", "population"] {
            for (key, expected) in expected[group].as_object().into_iter().flatten() {
                keys += 1;
                wrong.extend(difference(&format!("{group}.{key}"), &found[group][key], expected).map(|d| (lines, d)));
            }
        }
    }
    assert!(wrong.is_empty(), "{} differences\n{}", wrong.len(), summary(&wrong));
    (lines, keys)
}

#[test]
fn six_by_hand() {
    assert_eq!(check("tests/data/theory.jsonl", include_str!("data/theory.jsonl")), (6, 102));
}

#[test]
fn sixty_instances() {
    let Some(path) = vectors() else {
        println!("skipped: ROLLIN_DATA is not set, or has no ../theory/vectors.jsonl");
        return;
    };
    let text = std::fs::read_to_string(&path).expect("it exists");
    assert_eq!(check("vectors.jsonl", &text), (60, 60 * 83));
}

/// The first difference of every key.
fn summary(wrong: &[(usize, String)]) -> String {
    let mut seen = std::collections::BTreeMap::new();
    for (line, text) in wrong {
        let key = text.split([':', '[']).next().unwrap_or(text).to_owned();
        let entry = seen.entry(key).or_insert((0, *line, text));
        entry.0 += 1;
    }
    seen.values().map(|(count, line, text)| format!("{count:4}  line {line}: {text}\n")).collect()
}
