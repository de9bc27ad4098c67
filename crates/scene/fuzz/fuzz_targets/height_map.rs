//! Any bytes are an error or a whole height map of finite heights.
#![no_main]

use libfuzzer_sys::fuzz_target;
use scene::{Limits, Scene, load};

fuzz_target!(|bytes: &[u8]| {
    let limits = Limits { pixels: 1 << 20, ..Limits::default() };
    if let Ok((map, _)) = load::height_map_from_bytes("fuzz.png", bytes, &limits) {
        Scene { height_maps: vec![map], ..Scene::default() }.check().unwrap();
    }
});
