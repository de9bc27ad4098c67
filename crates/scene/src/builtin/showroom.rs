//! The scene that needs no file: rows of spheres from mirror to matt, and a pot, in the studio.

use glam::{Mat4, Quat, Vec3, Vec4};

use crate::{Camera, Instance, Material, Mesh, Scene, shapes};

/// Roughness of the spheres of a row, left to right.
const ROUGHNESS: [f32; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];

/// Metal spheres before dielectric ones, a pot behind them, on a glossy floor.
pub(super) fn scene() -> Scene {
    let mut scene = Scene { name: "showroom".into(), ..Scene::default() };
    scene.environment = super::environment("studio");
    scene.camera = Some(Camera {
        eye: Vec3::new(0.0, 1.75, 5.2),
        target: Vec3::new(0.0, 0.5, -0.2),
        up: Vec3::Y,
        fov_y_rad: 32.0_f32.to_radians(),
    });

    let floor = material("floor", [0.10, 0.10, 0.11], 0.0, 0.25);
    place(&mut scene, "plane", floor, Mat4::from_scale(Vec3::splat(6.0)));

    for (index, roughness) in ROUGHNESS.into_iter().enumerate() {
        let x = 0.62 * (index as f32 - (ROUGHNESS.len() - 1) as f32 / 2.0);
        let metal = material(&format!("copper, roughness {roughness}"), [0.95, 0.64, 0.54], 1.0, roughness);
        place(&mut scene, "sphere", metal, ball(Vec3::new(x, 0.26, 0.95)));
        let paint =
            material(&format!("blue paint, roughness {roughness}"), [0.04, 0.14, 0.42], 0.0, roughness);
        place(&mut scene, "sphere", paint, ball(Vec3::new(x, 0.26, 0.3)));
    }

    let steel = material("steel", [0.77, 0.78, 0.78], 1.0, 0.12);
    let pot = Mat4::from_scale_rotation_translation(
        Vec3::splat(1.05),
        Quat::from_rotation_y(0.45),
        Vec3::new(0.0, 0.0, -0.95),
    );
    place(&mut scene, "teapot", steel, pot);
    scene
}

/// A sphere of radius 0.26 at a place.
fn ball(centre: Vec3) -> Mat4 {
    Mat4::from_translation(centre) * Mat4::from_scale(Vec3::splat(0.26))
}

fn material(name: &str, color: [f32; 3], metallic: f32, roughness: f32) -> Material {
    let [red, green, blue] = color;
    let base_color = Vec4::new(red, green, blue, 1.0);
    Material { name: name.into(), base_color, metallic, roughness, ..Material::default() }
}

/// Adds an instance with a material of its own; a shape used before is shared.
fn place(scene: &mut Scene, shape: &str, material: Material, world_from_local: Mat4) {
    let known = scene.meshes.iter().position(|mesh: &Mesh| mesh.name == shape);
    let mesh = known.unwrap_or(scene.meshes.len());
    if known.is_none() {
        let Some(made) = shapes::by_name(shape) else { return };
        scene.meshes.push(made);
    }
    let name = format!("{shape}: {}", material.name);
    scene.instances.push(Instance { name, mesh, material: scene.materials.len(), world_from_local });
    scene.materials.push(material);
}
