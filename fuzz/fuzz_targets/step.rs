//! The STEP reader on arbitrary bytes: `cargo +nightly fuzz run step` in the project's root folder.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    if let Ok(model) = torse::io::step::read::read(data) {
        assert!(!model.faces.is_empty());
    }
});
