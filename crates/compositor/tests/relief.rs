//! Bump-mapped normals of height maps against the slopes that they are made of.

mod support;

use glam::{Mat4, Vec2, Vec3};
use scene::{Camera, HeightMap, HeightRef, Material, Mesh, Scene, shapes};
use std::f32::consts::TAU;
use support::*;

const SIZE: [u32; 2] = [64, 64];

/// Waves along u and v: whole periods over the map.
fn waves() -> HeightMap {
    let (width, height) = (64_u32, 48_u32);
    let texel = |index: u32| {
        let u = ((index % width) as f32 + 0.5) / width as f32;
        let v = ((index / width) as f32 + 0.5) / height as f32;
        0.3 * (TAU * u).sin() + 0.2 * (TAU * 2.0 * v).cos()
    };
    HeightMap { name: "waves".into(), width, height, heights: (0..width * height).map(texel).collect() }
}

/// The slope of the waves along u and v.
fn slope(uv: Vec2) -> Vec2 {
    Vec2::new(0.3 * TAU * (TAU * uv.x).cos(), -0.2 * TAU * 2.0 * (TAU * 2.0 * uv.y).sin())
}

fn wavy(mesh: Mesh, height_scale: f32, uv_scale: [f32; 2], world_from_local: Mat4) -> Scene {
    let height = Some(HeightRef { map: 0, height_scale, uv_scale });
    let mut scene = scene_of(mesh, Material { height, ..Material::default() }, world_from_local);
    scene.height_maps.push(waves());
    scene
}

/// Position on the plane z = 0 at a pixel.
fn on_wall(camera: &Camera, x: u32, y: u32) -> Vec3 {
    let direction = pixel_direction(camera, SIZE, x, y);
    camera.eye - direction * (camera.eye.z / direction.z)
}

/// Compares a wall whose uv are an affine function of the position. `uv_of` gives them; `along`
/// are their gradients in the plane.
fn compare(scene: &Scene, uv_of: impl Fn(Vec3) -> Vec2, along: [Vec3; 2]) {
    let gpu = gpu();
    let camera = camera_at(2.0);
    let pixels = render(&gpu, scene, &camera, SIZE);
    let height = scene.materials[0].height.as_ref().unwrap();
    let mut largest = 0.0_f32;
    for (x, y) in pixels.all().filter(|&(x, y)| pixels.is_covered(x, y)) {
        let uv_scale = Vec2::from(height.uv_scale);
        let slope = slope(uv_of(on_wall(&camera, x, y)) * uv_scale) * uv_scale * height.height_scale;
        let expected = (Vec3::Z - along[0] * slope.x - along[1] * slope.y).normalize();
        let found = pixels.normal(x, y);
        // Where the expected normal faces away it is bent to the viewer.
        if expected.dot(-pixel_direction(&camera, SIZE, x, y)) > 0.05 {
            assert!(found.distance(expected) < 0.02, "{found} at ({x}, {y}), expected {expected}");
            largest = largest.max(expected.truncate().length());
        }
    }
    assert!(largest > 0.3, "{largest}");
}

#[test]
fn normals_follow_the_slopes_of_the_height_map() {
    // The wall's uv: u to the right and v down, over two metres.
    let uv = |p: Vec3| Vec2::new(0.5 + 0.5 * p.x, 0.5 - 0.5 * p.y);
    let along = [Vec3::X * 0.5, Vec3::Y * -0.5];
    for uv_scale in [[1.0, 1.0], [2.0, 0.5], [-1.0, 1.0]] {
        compare(&wavy(wall(), 0.5, uv_scale, Mat4::IDENTITY), uv, along);
    }
    compare(&wavy(wall(), -0.5, [1.0, 1.0], Mat4::IDENTITY), uv, along);
}

#[test]
fn placing_the_mesh_places_the_relief() {
    // Heights stay metres whatever the scale.
    let scaled = Mat4::from_scale(Vec3::new(2.0, 0.5, 3.0));
    let uv = |p: Vec3| Vec2::new(0.5 + 0.25 * p.x, 0.5 - p.y);
    compare(&wavy(wall(), 0.5, [1.0; 2], scaled), uv, [Vec3::X * 0.25, -Vec3::Y]);

    let mirrored = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let uv = |p: Vec3| Vec2::new(0.5 - 0.5 * p.x, 0.5 - 0.5 * p.y);
    compare(&wavy(wall(), 0.5, [1.0; 2], mirrored), uv, [Vec3::X * -0.5, Vec3::Y * -0.5]);

    let turned = Mat4::from_rotation_z(0.5 * std::f32::consts::PI);
    let uv = |p: Vec3| Vec2::new(0.5 + 0.5 * p.y, 0.5 + 0.5 * p.x);
    compare(&wavy(wall(), 0.5, [1.0; 2], turned), uv, [Vec3::Y * 0.5, Vec3::X * 0.5]);
}

#[test]
fn sheared_and_mirrored_uvs_are_followed() {
    let mut mesh = wall();
    for (uv, p) in mesh.uvs.iter_mut().zip(&mesh.positions) {
        *uv = Vec2::new(0.3 * p.y, 0.5 * p.x + 0.2 * p.y);
    }
    let uv = |p: Vec3| Vec2::new(0.3 * p.y, 0.5 * p.x + 0.2 * p.y);
    compare(&wavy(mesh, 0.5, [1.0; 2], Mat4::IDENTITY), uv, [Vec3::Y * 0.3, Vec3::new(0.5, 0.2, 0.0)]);
}

#[test]
fn a_flat_map_leaves_every_normal_alone() {
    let gpu = gpu();
    let mut scene = wavy(shapes::sphere(32), 0.5, [3.0, 2.0], Mat4::from_scale(Vec3::splat(0.6)));
    scene.height_maps[0].heights.fill(0.25);
    let relief = render(&gpu, &scene, &camera_at(3.0), SIZE);
    scene.materials[0].height = None;
    let plain = render(&gpu, &scene, &camera_at(3.0), SIZE);
    assert!(relief.covered() > 500 && relief.albedo.values == plain.albedo.values);
    for (one, other) in relief.normal_roughness.values.iter().zip(&plain.normal_roughness.values) {
        assert!((one - other).abs() < 1e-3, "{one} {other}");
    }
}

#[test]
fn bumps_smaller_than_a_pixel_average_out() {
    let gpu = gpu();
    let camera = camera_at(4.0);
    let scene = wavy(wall(), 0.5, [200.0, 200.0], Mat4::from_scale(Vec3::splat(3.0)));
    let pixels = render(&gpu, &scene, &camera, SIZE);
    for (x, y) in pixels.all() {
        let normal = pixels.normal(x, y);
        assert!(normal.dot(Vec3::Z) > 0.0, "{normal} at ({x}, {y})");
    }
}
