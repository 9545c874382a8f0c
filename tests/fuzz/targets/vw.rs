//! Attributes as vw writes them: what is read can be written and read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::read::vw;

fuzz_target!(|text: &[u8]| {
    let Ok(items) = vw::parse(text, "fuzz".as_ref(), 1) else { return };
    let mut again = Vec::new();
    if vw::write(&items, &mut again).is_ok() {
        let again = vw::parse(&again, "again".as_ref(), 1).expect("what was written can be read");
        assert_eq!((again.labels.columns, again.names), (items.labels.columns, items.names));
    }
});
