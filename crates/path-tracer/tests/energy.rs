//! Scenes whose radiance is known without tracing: nothing is lost, and nothing is added.

mod common;

use common::{add, camera, furnace, lamp, matt, mean, render, settings};
use glam::{Mat4, Vec3, Vec4};
use path_tracer::{Lobe, Settings};
use scene::{Material, Scene, shapes};

/// Every pixel of a scene in an even light of radiance 1 that reflects all of it.
fn assert_white(scene: &Scene, settings: &Settings, what: &str) {
    let film = render(scene, &camera([0.0, 0.5, 5.0], [0.0; 3]), settings);
    let (mean, error) = mean(&film);
    let largest = film.mean().as_flattened().iter().map(|value| (value - 1.0).abs()).fold(0.0, f32::max);
    println!("{what}: mean {mean:.9}, standard error {error:.1e}, largest difference {largest:.1e}");
    assert!((mean - 1.0).abs() < 1e-3 && largest < 1e-3, "{what}: {mean} {largest}");
}

#[test]
fn a_white_sphere_in_a_furnace_cannot_be_seen() {
    let mut scene = furnace(1.0);
    add(&mut scene, shapes::sphere(32), matt(1.0), Mat4::IDENTITY);
    assert_white(&scene, &settings(32, 16), "Lambert sphere");
    let mirror = Material { ks: Some(Vec3::ONE), metallic: 1.0, roughness: 0.0, ..matt(1.0) };
    let mut scene = furnace(1.0);
    add(&mut scene, shapes::sphere(32), mirror, Mat4::IDENTITY);
    assert_white(&scene, &settings(32, 16), "mirror sphere");
}

#[test]
fn white_surfaces_that_see_each_other_cannot_be_seen() {
    let mut scene = furnace(1.0);
    add(&mut scene, shapes::torus(0.4, 32), matt(1.0), Mat4::IDENTITY);
    add(&mut scene, shapes::plane(1), matt(1.0), Mat4::from_translation(Vec3::NEG_Y));
    let all = Settings { max_bounces: 10_000, ..settings(24, 32) };
    assert_white(&scene, &all, "torus over a plane");
}

/// Inside a closed sphere that emits E and reflects a share a of what it meets, the radiance is
/// E / (1 - a) everywhere.
#[test]
fn a_closed_sphere_has_its_known_radiance() {
    for albedo in [0.0_f32, 0.5, 0.8] {
        let mut scene = Scene::default();
        let wall = Material { emissive: Vec3::ONE, ..matt(albedo) };
        add(&mut scene, shapes::sphere(32), wall, Mat4::IDENTITY);
        let all = Settings { max_bounces: 10_000, ..settings(24, 64) };
        let film = render(&scene, &camera([0.3, 0.1, 0.2], [0.0; 3]), &all);
        let (mean, error) = mean(&film);
        let expected = f64::from(1.0 / (1.0 - albedo));
        println!("albedo {albedo}: {mean:.6} +- {error:.1e}, expected {expected:.6}");
        assert!((mean - expected).abs() < (4.0 * error).max(1e-6), "{mean} {error}");
        assert!((mean / expected - 1.0).abs() < 5e-3);
    }
}
