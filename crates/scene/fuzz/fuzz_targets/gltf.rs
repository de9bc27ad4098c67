//! Any bytes are an error or a valid scene, as `.gltf` and as `.glb`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use scene::{Limits, load};

fuzz_target!(|bytes: &[u8]| {
    let limits = Limits { vertices: 1 << 20, triangles: 1 << 20, texture_bytes: 1 << 26, ..Limits::default() };
    if let Ok(scene) = load::gltf_from_bytes("fuzz.gltf", bytes, None, &limits) {
        scene.check().unwrap();
    }
});
