//! Feature templates, and what they find in a corpus.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::corpus::Corpus;
use rollin::read::template::Template;

fuzz_target!(|text: &str| {
    let Ok(template) = Template::parse(text, "fuzz".as_ref()) else { return };
    let corpus = Corpus::parse("The DT X\ncat-2 NN Y\n\n\u{e9}t\u{e9} NN Z\n").expect("a corpus");
    let Ok(bound) = template.bind(&corpus) else { return };
    let mut features = Vec::new();
    for i in 0..corpus.sentences() {
        for token in corpus.sentence(i) {
            features.clear();
            bound.observe(corpus.sentence(i), token, &mut features);
        }
    }
});
