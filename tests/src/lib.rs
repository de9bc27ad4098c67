//! The harness of everything that is measured across crates, and of the tests that need it.
//!
//! [`technique`] says what a technique registers, [`techniques`] holds the registrations. The
//! programs `compare`, `bench`, `stress` and `figures` run them.
//!
//! [`Shot`] is a frame with everything that a reference needs to know about each pixel.
//! [`Reference`] is what diffuse-envmap converges to: its integrals come from
//! [`diffuse_envmap::model`], and its camera, rotation and reflectance are written down here a
//! second time, so that a mistake of the shaders is not inherited.
//!
//! The functions of this page panic where a test has to stop.

mod bench;
mod bindings;
mod compare;
mod context;
mod figures;
pub mod program;
mod reference;
mod report;
mod shot;
mod stress;
pub mod technique;
pub mod techniques;
mod truths;

pub use context::{Context, Scope, StatusLine};
pub use reference::{Reference, specular_reflectance};
pub use shot::{Pixel, Shot, pixel_direction};
pub use truths::path_traced;

use compositor::{Compositor, Desc, wgpu};
use glam::Mat4;
use gpu_context::{Gpu, HeadlessDesc};
use scene::{Environment, Instance, Material, Mesh, Scene};
use std::path::PathBuf;

/// A device without a window.
///
/// # Panics
/// Where there is no graphics adapter.
pub fn gpu() -> Gpu {
    Gpu::headless(&HeadlessDesc::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A compositor that has rendered nothing yet. Tests keep one for all their frames, because drivers
/// take longer to compile its shaders than to draw a small picture.
///
/// # Panics
/// Where its shaders do not compile.
pub fn compositor(gpu: &Gpu) -> Compositor {
    let desc = Desc { display_format: wgpu::TextureFormat::Rgba8UnormSrgb };
    Compositor::new(gpu, &desc).unwrap_or_else(|error| panic!("{error}"))
}

/// A file of the test data: below `SHEEN_TEST_DATA`, or else `shared/data` beside the repository.
/// Where it is absent, says so and returns nothing.
pub fn test_data(file: &str) -> Option<PathBuf> {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data"));
    let path = std::env::var_os("SHEEN_TEST_DATA").map_or_else(beside, PathBuf::from).join(file);
    if !path.exists() {
        println!("skipped: test data absent ({file})");
        return None;
    }
    Some(path)
}

/// A scene of one instance under an environment.
pub fn scene_of(mesh: Mesh, material: Material, world_from_local: Mat4, environment: Environment) -> Scene {
    Scene {
        name: "test".into(),
        meshes: vec![mesh],
        materials: vec![material],
        instances: vec![Instance { name: "object".into(), mesh: 0, material: 0, world_from_local }],
        environment: Some(environment),
        ..Scene::default()
    }
}
