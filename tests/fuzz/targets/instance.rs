//! Instances of the theory commands.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rollin::theory::instance::Instance;

fuzz_target!(|text: &[u8]| {
    let _ = Instance::parse("fuzz", text);
});
