//! Any bytes are an error or a valid scene. The material libraries that they name are not read.
#![no_main]

use libfuzzer_sys::fuzz_target;
use scene::{Limits, load};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(scene) = load::obj_from_bytes("fuzz.obj", bytes, None, &Limits::default()) {
        scene.check().unwrap();
    }
});
