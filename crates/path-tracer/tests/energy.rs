//! Scenes whose radiance is known without tracing: nothing is lost, and nothing is added.

mod common;

use common::{add, camera, furnace, matt, mean, render, settings};
use glam::{Mat4, Vec3};
use path_tracer::Settings;
use scene::{Material, Scene, shapes};

/// A scene that reflects all of an even light of radiance 1: its mean is 1 within 1e-3, and its
/// pixels are as far from 1 as their variance says.
fn assert_white(scene: &Scene, settings: &Settings, what: &str) {
    let film = render(scene, &camera([0.0, 0.5, 5.0], [0.0; 3]), settings);
    let (mean, error) = mean(&film);
    let pixels = film.mean().into_iter().zip(film.variance_of_mean());
    let farthest = pixels
        .map(|([value, ..], [variance, ..])| (value - 1.0).abs() / (variance.sqrt() + 1e-6))
        .fold(0.0, f32::max);
    println!("{what}: mean {mean:.6}, standard error {error:.1e}, farthest pixel {farthest:.1} sigma");
    assert!(error < 3e-4 && (mean - 1.0).abs() < 1e-3, "{what}: {mean} +- {error}");
    assert!(farthest < 6.0, "{what}: {farthest}");
}

#[test]
fn a_white_sphere_in_a_furnace_cannot_be_seen() {
    let mut scene = furnace(1.0);
    add(&mut scene, shapes::sphere(32), matt(1.0), Mat4::IDENTITY);
    assert_white(&scene, &settings(32, 256), "Lambert sphere");
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
    let all = Settings { max_bounces: 10_000, ..settings(24, 1024) };
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
