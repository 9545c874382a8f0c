//! Maps, and the expert's ways over them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::tasks::Task;
use rollin::tasks::navigation::Guide;

fuzz_target!(|text: &[u8]| {
    if let Ok(maps) = Guide::parse(text, "fuzz".as_ref()) {
        let _ = Guide::learn(&maps, vec![1.0, 2.0, 4.0]);
    }
});
