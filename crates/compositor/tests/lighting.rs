//! Background, environment light and direct light against the host's own arithmetic.

mod support;

use compositor::Settings;
use glam::{Mat4, Vec3, Vec4};
use scene::{Camera, Environment, Light, Material, Scene, shapes};
use std::f32::consts::PI;
use support::*;

const SIZE: [u32; 2] = [96, 64];

/// A map that is different everywhere and nowhere symmetric.
fn gradients() -> Environment {
    let (width, height) = (64_u32, 32_u32);
    let texel = |index: u32| {
        let (x, y) = ((index % width) as f32 / width as f32, (index / width) as f32 / height as f32);
        let bump = if x > 0.2 && x < 0.3 && y < 0.4 { 3.0 } else { 0.0 };
        [0.2 + x, 0.1 + y * y, 0.5 + 0.5 * (2.0 * PI * x).sin() + bump]
    };
    let mut environment =
        Environment::new("gradients", width, height, (0..width * height).map(texel).collect()).unwrap();
    (environment.intensity, environment.rotation_rad) = (1.5, 0.7);
    environment
}

#[test]
fn the_background_is_the_environment_in_each_direction() {
    let gpu = gpu();
    let environment = gradients();
    let scene = Scene { environment: Some(environment.clone()), ..Scene::default() };
    let up_there = Vec3::new(0.1, 1.0, 0.05);
    for target in [Vec3::NEG_Z, Vec3::X, Vec3::new(-1.0, -0.4, 0.1), up_there, -up_there] {
        let camera = Camera { eye: Vec3::ZERO, target, up: Vec3::Y, fov_y_rad: 1.2 };
        let pixels = render(&gpu, &scene, &camera, SIZE);
        for (x, y) in pixels.all() {
            let direction = pixel_direction(&camera, SIZE, x, y);
            let expected = environment.radiance_world(direction);
            let found = pixels.radiance(x, y);
            // Filtering with 8-bit weights between texels that differ by at most 3 * 1.5.
            assert!(found.distance(expected) < 0.04, "{found} at ({x}, {y}), expected {expected}");
            assert_eq!(pixels.hdr.texel(x, y).unwrap()[3].to_bits(), 0.0_f32.to_bits());
        }
    }
}

#[test]
fn surfaces_in_a_uniform_environment_shine_like_it() {
    let gpu = gpu();
    let white = Environment::new("white", 8, 4, vec![[0.5; 3]; 32]).unwrap();
    let lit = |material: Material| {
        let mut scene = scene_of(shapes::sphere(64), material, Mat4::IDENTITY);
        scene.environment = Some(white.clone());
        render(&gpu, &scene, &camera_at(5.0), SIZE)
    };
    let diffuse = lit(Material {
        ks: Some(Vec3::ZERO),
        base_color: Vec4::new(1.0, 0.5, 0.25, 1.0),
        ..Material::default()
    });
    for (x, y) in diffuse.all().filter(|&(x, y)| diffuse.is_covered(x, y)) {
        let found = diffuse.radiance(x, y);
        assert!(found.distance(Vec3::new(0.5, 0.25, 0.125)) < 0.01, "{found} at ({x}, {y})");
        assert!(diffuse.hdr.texel(x, y).unwrap()[3] > 0.999);
    }
    let mirror = lit(Material { metallic: 1.0, roughness: 0.0, ..Material::default() });
    for (x, y) in mirror.all() {
        assert!(mirror.radiance(x, y).distance(Vec3::splat(0.5)) < 0.01, "({x}, {y})");
    }
    // A mirror needs no chain: one pass, and the reason.
    let work = mirror.work.get("diffuse-envmap").unwrap();
    assert_eq!((work.passes, work.skipped), (1, Some(diffuse_envmap::NO_CHAIN_NEEDED)));
}

#[test]
fn a_mirror_shows_the_environment_where_it_is() {
    let gpu = gpu();
    let environment = gradients();
    let material = Material { metallic: 1.0, roughness: 0.0, ..Material::default() };
    let mut scene = scene_of(wall(), material, Mat4::from_scale(Vec3::splat(9.0)));
    scene.environment = Some(environment.clone());
    let camera = Camera { eye: Vec3::new(1.0, 0.5, 3.0), ..camera_at(3.0) };
    let pixels = render(&gpu, &scene, &camera, SIZE);
    for (x, y) in pixels.all() {
        let direction = pixel_direction(&camera, SIZE, x, y);
        let expected = environment.radiance_world(direction * Vec3::new(1.0, 1.0, -1.0));
        let found = pixels.radiance(x, y);
        assert!(found.distance(expected) < 0.05, "{found} at ({x}, {y}), expected {expected}");
    }
}

/// Position on the wall z = 0 at a pixel.
fn on_wall(camera: &Camera, x: u32, y: u32) -> Vec3 {
    let direction = pixel_direction(camera, SIZE, x, y);
    camera.eye - direction * (camera.eye.z / direction.z)
}

/// Renders a wall that fills the picture and compares every pixel with a function of position.
fn compare_wall(
    material: Material,
    light: Light,
    tolerance: f32,
    expected: impl Fn(Vec3, Vec3) -> Vec3,
) -> f32 {
    let gpu = gpu();
    let mut scene = scene_of(wall(), material, Mat4::from_scale(Vec3::splat(9.0)));
    scene.lights.push(light);
    let camera = Camera { eye: Vec3::new(0.8, -0.3, 3.0), ..camera_at(3.0) };
    let pixels = render(&gpu, &scene, &camera, SIZE);
    let mut brightest = 0.0_f32;
    for (x, y) in pixels.all() {
        let position = on_wall(&camera, x, y);
        let expected = expected(position, (camera.eye - position).normalize());
        let found = pixels.radiance(x, y);
        let difference = (found - expected).abs();
        let bound = expected * tolerance + Vec3::splat(2e-4);
        assert!(difference.cmple(bound).all(), "{found} at ({x}, {y}), expected {expected}");
        brightest = brightest.max(expected.max_element());
    }
    brightest
}

fn diffuse() -> Material {
    Material { ks: Some(Vec3::ZERO), metallic: 0.0, ..Material::default() }
}

#[test]
fn a_diffuse_wall_reflects_irradiance_over_pi() {
    let direction_world = Vec3::new(0.5, 0.2, 0.6).normalize();
    let irradiance = Vec3::new(3.0, 2.0, 1.0);
    let light = Light::Directional { direction_world, irradiance, angular_diameter_rad: 0.0 };
    // The specular lobe of ks = 0 is Schlick's rise towards grazing alone, below 1e-3 here.
    let brightest = compare_wall(diffuse(), light, 4e-3, |_, _| irradiance * direction_world.z / PI);
    assert!(brightest > 0.5);
    let behind =
        Light::Directional { direction_world: -direction_world, irradiance, angular_diameter_rad: 0.0 };
    compare_wall(diffuse(), behind, 0.0, |_, _| Vec3::ZERO);
}

#[test]
fn a_point_light_falls_off_with_the_square_and_ends_at_its_range() {
    let position_world = Vec3::new(-0.4, 0.3, 0.9);
    let intensity = Vec3::new(1.0, 2.0, 4.0);
    let range = 1.2;
    let light = Light::Point { position_world, intensity, range };
    let brightest = compare_wall(diffuse(), light, 6e-3, |position, _| {
        let distance = position.distance(position_world);
        if distance > range { Vec3::ZERO } else { intensity * position_world.z / (PI * distance.powi(3)) }
    });
    assert!(brightest > 1.0);
}

#[test]
fn a_spot_light_fades_between_its_cones() {
    let position_world = Vec3::new(0.0, 0.0, 2.0);
    let (inner_angle_rad, outer_angle_rad) = (0.15, 0.35);
    let light = Light::Spot {
        position_world,
        direction_world: Vec3::NEG_Z,
        intensity: Vec3::splat(5.0),
        range: f32::INFINITY,
        inner_angle_rad,
        outer_angle_rad,
    };
    compare_wall(diffuse(), light, 6e-3, |position, _| {
        let distance = position.distance(position_world);
        let cosine = position_world.z / distance;
        let fade = (cosine - outer_angle_rad.cos()) / (inner_angle_rad.cos() - outer_angle_rad.cos());
        Vec3::splat(5.0) * fade.clamp(0.0, 1.0).powi(2) * cosine / (PI * distance * distance)
    });
}

/// The textbook microfacet formula in f64: D G F / (4 n.l n.v).
fn ggx(roughness: f64, ks: Vec3, n: Vec3, v: Vec3, l: Vec3) -> Vec3 {
    let h = (v + l).normalize();
    let dot = |a: Vec3, b: Vec3| f64::from(a.dot(b));
    let a2 = roughness.powi(4);
    let d = a2 / (std::f64::consts::PI * (dot(n, h).powi(2) * (a2 - 1.0) + 1.0).powi(2));
    let lambda = |cosine: f64| 0.5 * ((1.0 + a2 * (1.0 / (cosine * cosine) - 1.0)).sqrt() - 1.0);
    let g = 1.0 / (1.0 + lambda(dot(n, l)) + lambda(dot(n, v)));
    let f = ks + (Vec3::ONE - ks) * (1.0 - v.dot(h)).powi(5);
    f * (d * g / (4.0 * dot(n, l) * dot(n, v))) as f32
}

#[test]
fn highlights_are_the_textbooks() {
    let direction_world = Vec3::new(-0.3, 0.1, 0.9).normalize();
    let irradiance = Vec3::splat(2.0);
    let light = Light::Directional { direction_world, irradiance, angular_diameter_rad: 0.0 };
    let ks = Vec3::new(0.9, 0.5, 0.1);
    for roughness in [0.25, 0.5, 1.0] {
        let material = Material {
            base_color: Vec4::new(ks.x, ks.y, ks.z, 1.0),
            metallic: 1.0,
            roughness,
            ..Material::default()
        };
        // Roughness is a half float: a relative error of 2^-11, to the fourth power.
        let brightest = compare_wall(material, light, 8e-3, |_, v| {
            let lobe = ggx(f64::from(roughness), ks, Vec3::Z, v, direction_world);
            lobe * irradiance * direction_world.z
        });
        assert!(brightest > 0.01, "{brightest}");
    }
}

#[test]
fn the_nearest_surface_wins_and_emits() {
    let gpu = gpu();
    let mut scene = scene_of(wall(), Material { emissive: Vec3::X, ..Material::default() }, Mat4::IDENTITY);
    scene.materials.push(Material { emissive: Vec3::Y * 2.0, ..Material::default() });
    for z in [-0.01, 0.01] {
        scene.instances.truncate(1);
        let mut second = scene.instances[0].clone();
        (second.material, second.world_from_local) = (1, Mat4::from_translation(Vec3::Z * z));
        scene.instances.push(second);
        let pixels = render_with(&gpu, &scene, &camera_at(50.0), [64, 64], &Settings::default());
        let expected = if z > 0.0 { Vec3::Y * 2.0 } else { Vec3::X };
        assert_eq!(pixels.radiance(32, 32), expected);
    }
}
