//! Columns: what is read can be written and read again, as a whole and in blocks.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::corpus::{Corpus, Separator};
use rollin::read::conll::Blocks;

fuzz_target!(|text: &[u8]| {
    let Ok(corpus) = Corpus::parse(text) else { return };
    let mut again = Vec::new();
    if corpus.write(&mut again, Separator::Tab).is_ok() {
        let again = Corpus::parse(&again).expect("what was written can be read");
        assert_eq!((again.columns, again.starts), (corpus.columns.clone(), corpus.starts.clone()));
    }
    let blocks: usize = Blocks::new(text, 2)
        .map(|block| block.expect("memory can be read").corpus("blocks".as_ref()).expect("a part of a corpus is one"))
        .map(|part| part.map_or(0, |part| part.tokens()))
        .sum();
    assert_eq!(blocks, corpus.tokens());
});
