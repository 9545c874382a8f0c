//! Grammars of levels and of tracks.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::tasks::{kart, platformer};

fuzz_target!(|text: &str| {
    let _ = kart::Tracks::parse("fuzz", text);
    let _ = platformer::Levels::parse("fuzz", text);
});
