//! Model files: untrusted input. What comes is taken for the body, and gets a head with the right checksum: otherwise nothing else would ever be reached.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::Seed;
use rollin::corpus::Corpus;
use rollin::tasks::tagging::Tagger;
use rollin::tasks::{Model, graph, navigation, ocr, parsing, sealed, segmenting, tabular};

fuzz_target!(|body: &[u8]| {
    let (path, bytes) = ("fuzz".as_ref(), &sealed(body.to_vec())[..]);
    if let Ok(tagger) = Tagger::from_bytes(bytes, path) {
        let corpus = Corpus::parse("the DT\ncat NN\n").expect("a corpus");
        let _ = tagger.tag(&corpus, Seed::new(1));
        assert!(tagger.to_bytes().len() < 1 << 24);
    }
    let _ = Model::<segmenting::Spans>::from_bytes(bytes, path);
    let _ = Model::<parsing::Encoding>::from_bytes(bytes, path);
    let _ = Model::<ocr::Sightings>::from_bytes(bytes, path);
    let _ = Model::<graph::Encoding>::from_bytes(bytes, path);
    let _ = Model::<navigation::Guide>::from_bytes(bytes, path);
    let _ = Model::<tabular::Chart>::from_bytes(bytes, path);
});
