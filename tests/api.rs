//! The public interface of the library, a line an item, held against `tests/data/api.txt`: no change goes unseen.
//!
//! `.ci/run` has rustdoc write the interface as JSON and names the file in ROLLIN_API. After a change that is wanted, the same with ROLLIN_API_KEEP=1 writes
//! the list anew:
//!
//! RUSTDOC=.ci/rustdoc RUSTDOCFLAGS="-Zunstable-options --output-format json" cargo doc --no-deps --lib
//! ROLLIN_API_KEEP=1 ROLLIN_API=target/doc/rollin.json cargo test --test api

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
    let now: String = api.items().map(|item| format!("{item}\n")).collect();
    let kept = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/api.txt");
    if std::env::var_os("ROLLIN_API_KEEP").is_some() {
        std::fs::write(kept, &now).expect("the list can be written");
    }
    let before = std::fs::read_to_string(kept).expect("the list is there");
    let differing: Vec<String> = (before.lines().filter(|line| !now.lines().any(|other| other == *line)))
        .map(|line| format!("- {line}"))
        .chain(now.lines().filter(|line| !before.lines().any(|other| other == *line)).map(|line| format!("+ {line}")))
        .collect();
    assert!(differing.is_empty(), "the public interface has changed:\n{}", differing.join("\n"));
}
