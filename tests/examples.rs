//! Every example is run, and its own assertions hold.

#[path = "../examples/tagger.rs"]
mod tagger;

#[test]
fn tagger_runs() {
    tagger::main().expect("the example runs");
}
