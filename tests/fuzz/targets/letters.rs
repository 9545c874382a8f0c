//! Handwritten letters.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::read::letters;

fuzz_target!(|text: &[u8]| {
    let _ = letters::parse(text, "fuzz".as_ref());
});
