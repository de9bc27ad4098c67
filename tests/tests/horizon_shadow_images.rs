//! Bumps in whole frames against the path tracer, which traces the displaced surface and shares no
//! code with them: maps, frames of meshes, tables, and how visibility meets the light.

use compositor::{Compositor, Settings};
use glam::{Mat4, Vec3};
use gpu_context::Gpu;
use horizon_shadow::Method;
use path_tracer::{PathTracer, PixelFilter};
use scene::{Camera, HeightRef, Instance, Light, Material, Mesh, Scene, builtin, shapes};
use std::ops::ControlFlow;
use validation::{Shot, compositor, gpu};

const SIZE: [u32; 2] = [160, 160];

/// Rough, diffuse and grey, with bumps, under a low sun and nothing else.
fn bumpy(mesh: Mesh, map: &str, height_scale: f32, uv_scale: [f32; 2], turn: Mat4) -> Scene {
    Scene {
        name: "bumps".into(),
        meshes: vec![mesh],
        materials: vec![Material {
            metallic: 0.0,
            roughness: 1.0,
            height: Some(HeightRef { map: 0, height_scale, uv_scale }),
            ..Material::default()
        }],
        height_maps: vec![builtin::height_map(map).expect("a built-in map")],
        instances: vec![Instance { name: "object".into(), mesh: 0, material: 0, world_from_local: turn }],
        lights: vec![Light::Directional {
            direction_world: Vec3::new(0.8, 0.3, 0.35).normalize(),
            irradiance: Vec3::splat(3.0),
            angular_diameter_rad: 0.0,
        }],
        ..Scene::default()
    }
}

/// From far above, so that what is raised is hardly seen elsewhere than where it lies.
fn from_above(half_width_m: f32) -> Camera {
    let eye = Vec3::new(0.0, 60.0, 0.0);
    Camera { eye, target: Vec3::ZERO, up: Vec3::NEG_Z, fov_y_rad: 2.0 * (half_width_m / 60.0).atan() }
}

/// Which pixels the light reaches: those with a tenth of the light that faces it.
fn lit(radiance: impl Iterator<Item = f64>) -> Vec<bool> {
    const FACING: f64 = 3.0 * 0.8 / std::f64::consts::PI;
    radiance.map(|value| value > 0.02 * FACING).collect()
}

fn traced(scene: &Scene, camera: &Camera) -> Vec<bool> {
    let settings = path_tracer::Settings {
        max_bounces: 1,
        pixel_filter: PixelFilter::Point,
        ..path_tracer::Settings::new(SIZE, 4)
    };
    let film = PathTracer::new(scene)
        .and_then(|tracer| tracer.render(camera, &settings, &|_| ControlFlow::Continue(())))
        .unwrap_or_else(|error| panic!("{error}"));
    lit(film.mean().into_iter().map(|pixel| f64::from(pixel[1])))
}

/// The part of the pixels that a method has on the wrong side, of those that lie in the surface.
fn wrong(
    gpu: &Gpu,
    compositor: &mut Compositor,
    scene: &Scene,
    camera: &Camera,
    method: Option<Method>,
    truth: &[bool],
) -> f64 {
    let technique = method.map(|method| horizon_shadow::Settings {
        method,
        prefilter: false,
        ..horizon_shadow::Settings::SHEEN
    });
    // The shadow map would throw the same shadows once more.
    let settings = Settings { horizon_shadow: technique, shadow_map: None, ..Settings::default() };
    let shot = Shot::new(gpu, compositor, scene, camera, SIZE, &settings);
    let found = lit(shot.pixels.iter().map(|pixel| pixel.radiance[1]));
    let inside = shot.pixels.iter().map(|pixel| {
        let [x, y] = [pixel.x, pixel.y].map(|at| 2.0 * (f64::from(at) + 0.5) / f64::from(SIZE[0]) - 1.0);
        pixel.is_covered && x.hypot(y) < 0.8
    });
    let counted: Vec<bool> =
        inside.zip(found.iter().zip(truth)).filter(|(inside, _)| *inside).map(|(_, (a, b))| a != b).collect();
    counted.iter().filter(|&&differs| differs).count() as f64 / counted.len() as f64
}

/// Ours may have `most` of the pixels on the wrong side: where the light grazes the relief, whose
/// normals the two programs interpolate differently.
fn check(scene: &Scene, camera: &Camera, most: f64) {
    let gpu = gpu();
    let mut compositor = compositor(&gpu);
    let truth = traced(scene, camera);
    let mut of = |method| wrong(&gpu, &mut compositor, scene, camera, method, &truth);
    let none = of(Some(Method::None));
    let ours = of(Some(Method::Sheen));
    let certified = of(Some(Method::Certified));
    println!("none {none:.4}, sheen {ours:.4}, certified {certified:.4}");
    assert!(ours < most && certified < most, "{ours} {certified}");
    assert!(ours < 0.45 * none, "{ours} of {none}");
}

#[test]
fn craters_on_a_plane_have_the_shadows_of_the_traced_relief() {
    let scene = bumpy(shapes::plane(16), "craters", 0.12, [1.0, 1.0], Mat4::IDENTITY);
    check(&scene, &from_above(1.0), 0.053);
}

#[test]
fn scales_on_a_ball_have_the_shadows_of_the_traced_relief() {
    let turn = Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let scene = bumpy(shapes::sphere(128), "reptile_skin", 0.03, [4.0, 2.0], turn);
    check(&scene, &from_above(0.8), 0.092);
}
