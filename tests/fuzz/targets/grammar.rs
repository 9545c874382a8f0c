//! Grammars: what is one generates, and labels what it generated.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::Seed;
use rollin::grammar::Grammar;

fuzz_target!(|text: &str| {
    let Ok(grammar) = Grammar::parse("fuzz", text) else { return };
    for sentence in grammar.generate(3, Seed::new(1)) {
        grammar.label(&sentence.words).expect("the grammar made it");
    }
});
