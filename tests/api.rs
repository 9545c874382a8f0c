//! The public interface of the library, a line an item in the order of the alphabet, held against `tests/data/api.txt`: no change goes unseen. What the
//! prelude names stands there by its name only where all of it has a place of its own.
//!
//! `.ci/run` has rustdoc write the interface as JSON and names the file in ROLLIN_API. After a change that is wanted, the same with ROLLIN_API_KEEP=1 writes
//! the list anew:
//!
//! RUSTDOC=.ci/rustdoc RUSTDOCFLAGS="-Zunstable-options --output-format json" cargo doc --no-deps --lib
//! ROLLIN_API_KEEP=1 ROLLIN_API=target/doc/rollin.json cargo test --test api

use std::collections::BTreeSet;

#[test]
fn the_public_interface_is_as_it_was() {
    let Ok(json) = std::env::var("ROLLIN_API") else {
        eprintln!("skipped: ROLLIN_API is not set");
        return;
    };
    let api = public_api::Builder::from_rustdoc_json(json)
        .omit_auto_derived_impls(true)
        .omit_auto_trait_impls(true)
        .omit_blanket_impls(true)
        .build()
        .expect("the JSON of this compiler's rustdoc");
    let lines: Vec<String> = api.items().map(ToString::to_string).collect();
    let (of_prelude, elsewhere): (Vec<&String>, Vec<&String>) = lines.iter().partition(|line| {
        let path = line.split(' ').find(|word| word.starts_with("rollin::")).unwrap_or_default();
        path.starts_with("rollin::prelude::") && path.split("::").count() > 3 && !line.starts_with("impl")
    });
    // Of a line, what it says without the module that it says it of.
    let again = |line: &&&String| {
        let named = line.split_once("rollin::prelude::").map_or("", |(_, named)| named);
        elsewhere.iter().any(|line| line.strip_suffix(named).is_some_and(|module| module.ends_with("::")))
    };
    let own = of_prelude.iter().filter(|line| !again(line));
    let now: BTreeSet<String> = elsewhere.iter().chain(own).map(|line| (*line).clone()).collect();
    let kept = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/api.txt");
    if std::env::var_os("ROLLIN_API_KEEP").is_some() {
        let text: String = now.iter().map(|line| format!("{line}\n")).collect();
        std::fs::write(kept, text).expect("the list can be written");
    }
    let before = std::fs::read_to_string(kept).expect("the list is there");
    let before: BTreeSet<String> = before.lines().map(str::to_owned).collect();
    let gone = before.difference(&now).map(|line| format!("- {line}"));
    let differing: Vec<String> = gone.chain(now.difference(&before).map(|line| format!("+ {line}"))).collect();
    assert!(differing.is_empty(), "the public interface has changed:\n{}", differing.join("\n"));
}
