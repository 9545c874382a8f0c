//! CoNLL-U, and a parser's features of whatever tree comes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::read::conllu;
use rollin::tasks::parsing::{Encoding, Settings};

fuzz_target!(|text: &[u8]| {
    if let Ok(bank) = conllu::parse(text, "fuzz".as_ref(), 1) {
        let _ = Encoding::learn(&bank, &Settings { cutoff: 1, ..Settings::default() });
    }
});
