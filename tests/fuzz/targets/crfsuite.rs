//! Attributes as crfsuite writes them: what is read can be written and read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::read::crfsuite;

fuzz_target!(|text: &[u8]| {
    let Ok(items) = crfsuite::parse(text, "fuzz".as_ref(), 1) else { return };
    let mut again = Vec::new();
    if crfsuite::write(&items, &mut again).is_ok() {
        let again = crfsuite::parse(&again, "again".as_ref(), 1).expect("what was written can be read");
        assert_eq!((again.labels.columns, again.names), (items.labels.columns, items.names));
    }
});
