//! What changes a fingerprint, and what does not.

use super::{Fnv, OFFSET_BASIS, fingerprint};
use crate::settings::{Lobe, PixelFilter, Settings};
use glam::{Affine2, Vec2, Vec3, Vec4};
use scene::{
    AlphaMode, Camera, Clearcoat, ColorSpace, Environment, HeightMap, HeightRef, Instance, Light, Material,
    Mesh, Scene, Texture, TextureRef, Wrap,
};
use std::collections::HashMap;

/// Everything that is hashed.
#[derive(Clone)]
struct Picture {
    scene: Scene,
    camera: Camera,
    settings: Settings,
}

impl Picture {
    fn fingerprint(&self) -> u128 {
        fingerprint(&self.scene, &self.camera, &self.settings)
    }
}

fn texture_ref() -> TextureRef {
    TextureRef {
        texture: 0,
        texture_from_vertex_uv: Affine2::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        nearest: false,
    }
}

/// A picture that has one of everything, and three lights.
fn picture() -> Picture {
    let mesh = Mesh {
        name: "mesh".into(),
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        normals: vec![Vec3::Z; 3],
        tangents: vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 3],
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
        triangles: vec![[0, 1, 2]],
    };
    let material = Material {
        base_color_texture: Some(texture_ref()),
        metallic_roughness_texture: Some(texture_ref()),
        normal_texture: Some(texture_ref()),
        occlusion_texture: Some(texture_ref()),
        emissive_texture: Some(texture_ref()),
        clearcoat: Clearcoat {
            texture: Some(texture_ref()),
            roughness_texture: Some(texture_ref()),
            normal_texture: Some(texture_ref()),
            ..Clearcoat::default()
        },
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        height: Some(HeightRef { map: 0, height_scale: 1.0, uv_scale: [1.0; 2] }),
        ..Material::default()
    };
    let texture = Texture {
        name: "texture".into(),
        width: 2,
        height: 1,
        rgba: vec![7; 8],
        color_space: ColorSpace::Srgb,
    };
    let map = HeightMap { name: "map".into(), width: 2, height: 1, heights: vec![0.0, 1.0] };
    let instance =
        Instance { name: "instance".into(), mesh: 0, material: 0, world_from_local: glam::Mat4::IDENTITY };
    let lights = vec![
        Light::Directional { direction_world: Vec3::Y, irradiance: Vec3::ONE, angular_diameter_rad: 0.1 },
        Light::Point { position_world: Vec3::Y, intensity: Vec3::ONE, range: 9.0 },
        Light::Spot {
            position_world: Vec3::Y,
            direction_world: Vec3::NEG_Y,
            intensity: Vec3::ONE,
            range: 9.0,
            inner_angle_rad: 0.1,
            outer_angle_rad: 0.2,
        },
    ];
    let scene = Scene {
        name: "scene".into(),
        meshes: vec![mesh],
        materials: vec![material],
        textures: vec![texture],
        height_maps: vec![map],
        instances: vec![instance],
        lights,
        environment: Environment::new("sky", 2, 1, vec![[1.0; 3]; 2]).ok(),
        ..Scene::default()
    };
    let camera = Camera { eye: Vec3::Z, target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 1.0 };
    Picture { scene, camera, settings: Settings::new([4, 3], 8) }
}

type Change = (&'static str, fn(&mut Picture));

/// One change by the expression that makes it.
macro_rules! changes {
    ($($picture:ident => $change:expr;)*) => {
        [$((stringify!($change), (|$picture: &mut Picture| { $change; }) as fn(&mut Picture))),*]
    };
}

fn mesh(picture: &mut Picture) -> &mut Mesh {
    &mut picture.scene.meshes[0]
}

fn material(picture: &mut Picture) -> &mut Material {
    &mut picture.scene.materials[0]
}

fn color(picture: &mut Picture) -> &mut TextureRef {
    material(picture).base_color_texture.as_mut().unwrap()
}

fn height(picture: &mut Picture) -> &mut HeightRef {
    material(picture).height.as_mut().unwrap()
}

fn environment(picture: &mut Picture) -> &mut Environment {
    picture.scene.environment.as_mut().unwrap()
}

const ANOTHER: Vec3 = Vec3::new(0.5, 0.25, 0.125);

fn geometry_changes() -> Vec<Change> {
    changes! {
        p => mesh(p).positions[1].y = 0.5;
        p => mesh(p).positions.push(Vec3::ZERO);
        p => mesh(p).normals[1] = Vec3::X;
        p => mesh(p).tangents[1].w = -1.0;
        p => mesh(p).uvs[1].y = 0.5;
        p => mesh(p).triangles[0] = [1, 2, 0];
        p => mesh(p).triangles.push([0, 1, 2]);
        p => p.scene.meshes.push(Mesh::default());
        p => p.scene.instances[0].mesh = 1;
        p => p.scene.instances[0].material = 1;
        p => p.scene.instances[0].world_from_local.w_axis.x = 0.5;
        p => p.scene.instances.clear();
        p => p.scene.height_maps[0].width = 1;
        p => p.scene.height_maps[0].height = 2;
        p => p.scene.height_maps[0].heights[1] = 0.5;
        p => height(p).map = 1;
        p => height(p).height_scale = 2.0;
        p => height(p).uv_scale[1] = 2.0;
        p => material(p).height = None;
    }
    .to_vec()
}

fn material_changes() -> Vec<Change> {
    changes! {
        p => material(p).base_color.w = 0.5;
        p => material(p).metallic = 0.5;
        p => material(p).roughness = 0.5;
        p => material(p).normal_scale = 0.5;
        p => material(p).occlusion_strength = 0.5;
        p => material(p).emissive = ANOTHER;
        p => material(p).alpha_mode = AlphaMode::Opaque;
        p => material(p).alpha_mode = AlphaMode::Blend;
        p => material(p).alpha_mode = AlphaMode::Mask { cutoff: 0.25 };
        p => material(p).double_sided = true;
        p => material(p).clearcoat.factor = 0.5;
        p => material(p).clearcoat.roughness = 0.5;
        p => material(p).ks = Some(Vec3::ZERO);
        p => material(p).ks = Some(Vec3::ONE);
        p => material(p).shininess = Some(0.0);
        p => material(p).shininess = Some(1.0);
        p => material(p).spread_deg = Some(0.0);
        p => material(p).spread_deg = Some(1.0);
        p => material(p).base_color_texture = None;
        p => material(p).metallic_roughness_texture = None;
        p => material(p).normal_texture = None;
        p => material(p).occlusion_texture = None;
        p => material(p).emissive_texture = None;
        p => material(p).clearcoat.texture = None;
        p => material(p).clearcoat.roughness_texture = None;
        p => material(p).clearcoat.normal_texture = None;
        p => color(p).texture = 1;
        p => color(p).texture_from_vertex_uv.translation.x = 0.5;
        p => color(p).wrap[0] = Wrap::Mirror;
        p => color(p).wrap[1] = Wrap::Mirror;
        p => color(p).wrap[1] = Wrap::Clamp;
        p => color(p).nearest = true;
        p => p.scene.textures[0].width = 1;
        p => p.scene.textures[0].height = 2;
        p => p.scene.textures[0].rgba[7] = 8;
        p => p.scene.textures[0].color_space = ColorSpace::Linear;
        p => p.scene.materials.push(Material::default());
    }
    .to_vec()
}

fn light_changes() -> Vec<Change> {
    /// A light whose numbers are all different from those of the picture's at `index`, one by one.
    fn light(picture: &mut Picture, index: usize, field: usize) {
        let vector = |own: &mut Vec3, number: usize| {
            if field == number {
                *own = ANOTHER;
            }
        };
        let number = |own: &mut f32, number: usize| {
            if field == number {
                *own = 0.75;
            }
        };
        match &mut picture.scene.lights[index] {
            Light::Directional { direction_world, irradiance, angular_diameter_rad } => {
                vector(direction_world, 0);
                vector(irradiance, 1);
                number(angular_diameter_rad, 2);
            }
            Light::Point { position_world, intensity, range } => {
                vector(position_world, 0);
                vector(intensity, 1);
                number(range, 2);
            }
            Light::Spot {
                position_world,
                direction_world,
                intensity,
                range,
                inner_angle_rad,
                outer_angle_rad,
            } => {
                vector(position_world, 0);
                vector(direction_world, 1);
                vector(intensity, 2);
                number(range, 3);
                number(inner_angle_rad, 4);
                number(outer_angle_rad, 5);
            }
        }
    }
    changes! {
        p => light(p, 0, 0);
        p => light(p, 0, 1);
        p => light(p, 0, 2);
        p => light(p, 1, 0);
        p => light(p, 1, 1);
        p => light(p, 1, 2);
        p => light(p, 2, 0);
        p => light(p, 2, 1);
        p => light(p, 2, 2);
        p => light(p, 2, 3);
        p => light(p, 2, 4);
        p => light(p, 2, 5);
        p => p.scene.lights.swap(0, 1);
        p => environment(p).width = 1;
        p => environment(p).height = 2;
        p => environment(p).pixels[1][2] = 0.5;
        p => environment(p).intensity = 0.5;
        p => environment(p).rotation_rad = 0.5;
        p => p.scene.environment = None;
    }
    .to_vec()
}

fn view_changes() -> Vec<Change> {
    changes! {
        p => p.camera.eye.x = 0.5;
        p => p.camera.target.x = 0.5;
        p => p.camera.up.x = 0.5;
        p => p.camera.fov_y_rad = 0.5;
        p => p.settings.size = [3, 4];
        p => p.settings.seed = 1;
        p => p.settings.seed = 1 << 63;
        p => p.settings.max_bounces = 1;
        p => p.settings.lobe = Lobe::Blinn;
        p => p.settings.lobe = Lobe::PhongCone;
        p => p.settings.lobe = Lobe::DiffusedEnvironment;
        p => p.settings.occlusion = false;
        p => p.settings.pixel_filter = PixelFilter::Point;
        p => p.settings.pixel_filter = PixelFilter::Gaussian { sigma_pixels: 0.5 };
        p => p.settings.pixel_filter = PixelFilter::Gaussian { sigma_pixels: 0.25 };
    }
    .to_vec()
}

#[test]
fn every_change_gives_another_fingerprint() {
    let mut seen = HashMap::from([(picture().fingerprint(), "no change")]);
    let changes = [geometry_changes(), material_changes(), light_changes(), view_changes()].concat();
    assert!(changes.len() > 80);
    for (name, change) in changes {
        let mut changed = picture();
        change(&mut changed);
        if let Some(other) = seen.insert(changed.fingerprint(), name) {
            panic!("the same after {name} as after {other}");
        }
    }
}

#[test]
fn what_decides_nothing_does_not_count() {
    let expected = picture().fingerprint();
    let changes: [Change; _] = changes! {
        p => p.scene.name = "other".into();
        p => p.scene.meshes[0].name = "other".into();
        p => p.scene.textures[0].name = "other".into();
        p => p.scene.materials[0].name = "other".into();
        p => p.scene.height_maps[0].name = "other".into();
        p => p.scene.instances[0].name = "other".into();
        p => environment(p).name = "other".into();
        p => environment(p).repairs.nan = 3;
        p => p.scene.camera = Some(p.camera);
        p => p.settings.samples = 100..200;
        p => mesh(p).positions[0] = -Vec3::ZERO;
        p => p.camera.eye = Vec3::new(-0.0, 0.0, 1.0);
    };
    for (name, change) in changes {
        let mut changed = picture();
        change(&mut changed);
        assert_eq!(changed.fingerprint(), expected, "{name}");
    }
}

#[test]
fn the_hash_is_fnv_1a() {
    let hash = |text: &str| {
        let mut hash = Fnv(OFFSET_BASIS);
        hash.bytes(text.as_bytes());
        hash.0
    };
    // Published values of the 128-bit FNV-1a.
    assert_eq!(hash("a"), 0xd228cb696f1a8caf78912b704e4a8964);
    assert_eq!(hash("ab"), 0x08809544bbab1be95aa0733055b69a62);
    assert_eq!(hash("abc"), 0xa68d622cec8b5822836dbc7977af7f3b);
}
