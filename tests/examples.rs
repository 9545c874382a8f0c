//! Every example is run, and its own assertions hold.

#[path = "../examples/sorting.rs"]
mod sorting;
#[path = "../examples/tagger.rs"]
mod tagger;

#[test]
fn sorting_runs() {
    sorting::main().expect("the example runs");
}

#[test]
fn tagger_runs() {
    tagger::main().expect("the example runs");
}
