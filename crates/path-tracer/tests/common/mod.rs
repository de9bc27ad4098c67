//! Small scenes whose light is known.

#![allow(dead_code, reason = "each test program uses a part")]

use std::ops::ControlFlow;

use glam::{Mat4, Vec3, Vec4};
use path_tracer::{Film, PathTracer, PixelFilter, Settings};
use scene::{Camera, Environment, Instance, Material, Mesh, Scene};

/// A scene of one light grey environment.
pub(crate) fn furnace(radiance: f32) -> Scene {
    let environment = Environment::new("furnace", 4, 2, vec![[radiance; 3]; 8]).unwrap();
    Scene { name: "test".into(), environment: Some(environment), ..Scene::default() }
}

/// Places a mesh with a material.
pub(crate) fn add(scene: &mut Scene, mesh: Mesh, material: Material, world_from_local: Mat4) {
    scene.meshes.push(mesh);
    scene.materials.push(material);
    scene.instances.push(Instance {
        name: String::new(),
        mesh: scene.meshes.len() - 1,
        material: scene.materials.len() - 1,
        world_from_local,
    });
}

/// A Lambert surface without gloss.
pub(crate) fn matt(albedo: f32) -> Material {
    Material {
        base_color: Vec4::new(albedo, albedo, albedo, 1.0),
        ks: Some(Vec3::ZERO),
        double_sided: true,
        ..Material::default()
    }
}

/// A matt black surface that emits.
pub(crate) fn lamp(radiance: f32) -> Material {
    Material { emissive: Vec3::splat(radiance), double_sided: false, ..matt(0.0) }
}

pub(crate) fn camera(eye: [f32; 3], target: [f32; 3]) -> Camera {
    Camera { eye: eye.into(), target: target.into(), up: Vec3::Y, fov_y_rad: 0.6 }
}

/// A square picture through the pixels' centres.
pub(crate) fn settings(side: u32, samples_per_pixel: u32) -> Settings {
    Settings { pixel_filter: PixelFilter::Point, ..Settings::new([side; 2], samples_per_pixel) }
}

pub(crate) fn render(scene: &Scene, camera: &Camera, settings: &Settings) -> Film {
    let film =
        PathTracer::new(scene).unwrap().render(camera, settings, &|_| ControlFlow::Continue(())).unwrap();
    assert_eq!((film.invalid(), film.clamped()), (0, 0));
    film
}

/// The mean over all pixels and channels, and its standard error.
pub(crate) fn mean(film: &Film) -> (f64, f64) {
    let values = film.mean();
    let count = 3.0 * values.len() as f64;
    let sum = |values: &[[f32; 3]]| values.as_flattened().iter().map(|&value| f64::from(value)).sum::<f64>();
    // Channels of one pixel are the same samples.
    let variance = 3.0 * sum(&film.variance_of_mean());
    (sum(&values) / count, variance.sqrt() / count)
}
