//! Any text is an error or a valid scene. The files that it names are not read.
#![no_main]

use libfuzzer_sys::fuzz_target;
use scene::{Limits, load};

fuzz_target!(|text: &str| {
    if let Ok(scene) = load::scene_file_from_str("fuzz.toml", text, None, &Limits::default()) {
        scene.check().unwrap();
    }
});
