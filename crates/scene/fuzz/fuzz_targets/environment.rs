//! Any bytes are an error or an environment of finite radiance, as `.hdr` and as `.exr`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use scene::{Limits, Scene, load};

fuzz_target!(|bytes: &[u8]| {
    let limits = Limits { pixels: 1 << 20, ..Limits::default() };
    for name in ["fuzz.hdr", "fuzz.exr"] {
        if let Ok((environment, _)) = load::environment_from_bytes(name, bytes, &limits) {
            Scene { environment: Some(environment), ..Scene::default() }.check().unwrap();
        }
    }
});
