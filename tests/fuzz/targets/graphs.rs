//! Graphs, and a labeller's features of them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::tasks::Task;
use rollin::tasks::graph::{Encoding, Visit};

fuzz_target!(|text: &[u8]| {
    if let Ok(graphs) = Encoding::parse(text, "fuzz".as_ref()) {
        let _ = Encoding::learn(&graphs, Visit::default());
    }
});
