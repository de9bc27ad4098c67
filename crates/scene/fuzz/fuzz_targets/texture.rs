//! Any bytes are an error or a whole texture.
#![no_main]

use libfuzzer_sys::fuzz_target;
use scene::{ColorSpace, Limits, Scene, load};

fuzz_target!(|bytes: &[u8]| {
    let limits = Limits { pixels: 1 << 20, ..Limits::default() };
    if let Ok(texture) = load::texture::texture_from_bytes("fuzz.png", bytes, ColorSpace::Srgb, &limits) {
        Scene { textures: vec![texture], ..Scene::default() }.check().unwrap();
    }
});
