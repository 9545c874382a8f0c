//! Bodies of requests to the server. The lowest bits of the first byte say whether it is JSON and what is wished for; where JSON is answered, so
//! are the same sentences again, by the same bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::cli::Answerer;
use rollin::tasks::tagging::{Tagger, doc};
use std::sync::OnceLock;

/// A server with a small model that was, as it were, calibrated.
fn server() -> &'static Answerer {
    static SERVER: OnceLock<Answerer> = OnceLock::new();
    SERVER.get_or_init(|| {
        let corpus = doc::corpus().expect("a small corpus");
        let mut tagger = Tagger::train(&corpus).expect("a small model");
        tagger.temperatures = vec![1.0; tagger.policy.classifiers().len()];
        let file = std::env::temp_dir().join(format!("rollin-fuzz-{}.model", std::process::id()));
        tagger.save(&file).expect("room for a file");
        Answerer::load(&file).expect("the model that was written")
    })
}

fuzz_target!(|data: &[u8]| {
    let [wishes, body @ ..] = data else { return };
    let (json, confidence, explain) = (wishes & 1 == 1, wishes & 2 == 2, wishes & 4 == 4);
    let answer = || server().answer(body, json, confidence, explain);
    if let Ok(first) = answer() {
        assert!(answer().is_ok_and(|second| second == first));
    }
});
