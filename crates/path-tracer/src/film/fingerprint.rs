//! A number that tells pictures apart: everything that decides one, hashed.
//!
//! The hash is FNV-1a of 128 bits. It guards against mistakes, such as merging parts of two scenes,
//! not against somebody who wants two scenes to collide.

use crate::settings::{Lobe, PixelFilter, Settings};
use scene::{
    AlphaMode, Camera, Clearcoat, ColorSpace, Environment, HeightMap, HeightRef, Instance, Light, Material,
    Mesh, Scene, Texture, TextureRef, Wrap,
};

/// A hash of everything that decides a picture: meshes, materials, textures, height maps, placement,
/// lights, environment, camera, and all settings except the range of samples.
///
/// Names, warnings and the settings of the real-time techniques decide nothing and do not count, nor
/// does the camera that the scene names besides the one given. Floats count by their bits, where -0
/// equals 0.
pub fn fingerprint(scene: &Scene, camera: &Camera, settings: &Settings) -> u128 {
    SceneHash::new(scene).fingerprint(camera, settings)
}

/// The part of a fingerprint that the scene decides, for many pictures of one scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SceneHash(u128);

impl SceneHash {
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut hash = Fnv(OFFSET_BASIS);
        hash_scene(&mut hash, scene);
        Self(hash.0)
    }

    /// The fingerprint of a picture of the scene.
    pub(crate) fn fingerprint(self, camera: &Camera, settings: &Settings) -> u128 {
        let mut hash = Fnv(self.0);
        hash_camera(&mut hash, camera);
        hash_settings(&mut hash, settings);
        hash.0
    }
}

/// FNV-1a (Fowler, Noll and Vo) of 128 bits.
struct Fnv(u128);

const OFFSET_BASIS: u128 = 0x6c62272e07bb014262b821756295c58d;
const PRIME: u128 = 0x0000000001000000000000000000013b;

impl Fnv {
    fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(PRIME);
        }
    }

    fn integer(&mut self, value: u64) {
        self.bytes(&value.to_le_bytes());
    }

    fn float(&mut self, value: f32) {
        // 0 + -0 is 0.
        self.bytes(&(value + 0.0).to_bits().to_le_bytes());
    }

    fn floats(&mut self, values: impl AsRef<[f32]>) {
        for &value in values.as_ref() {
            self.float(value);
        }
    }

    /// The length first, so that neighbours of unlike lengths cannot be taken for each other.
    fn list<T>(&mut self, items: &[T], mut hash: impl FnMut(&mut Self, &T)) {
        self.integer(items.len() as u64);
        for item in items {
            hash(self, item);
        }
    }

    fn option<T>(&mut self, item: Option<&T>, hash: impl FnOnce(&mut Self, &T)) {
        self.bytes(&[u8::from(item.is_some())]);
        if let Some(item) = item {
            hash(self, item);
        }
    }
}

// Every struct is taken apart by name, so that a field that is added cannot be forgotten here.

fn hash_scene(hash: &mut Fnv, scene: &Scene) {
    let Scene {
        name: _,
        meshes,
        materials,
        textures,
        height_maps,
        instances,
        lights,
        camera: _,
        environment,
        technique_settings: _,
        warnings: _,
    } = scene;
    hash.list(meshes, hash_mesh);
    hash.list(materials, hash_material);
    hash.list(textures, hash_texture);
    hash.list(height_maps, hash_height_map);
    hash.list(instances, hash_instance);
    hash.list(lights, hash_light);
    hash.option(environment.as_ref(), hash_environment);
}

fn hash_mesh(hash: &mut Fnv, mesh: &Mesh) {
    let Mesh { name: _, positions, normals, tangents, uvs, triangles } = mesh;
    hash.list(positions, |hash, position| hash.floats(position.to_array()));
    hash.list(normals, |hash, normal| hash.floats(normal.to_array()));
    hash.list(tangents, |hash, tangent| hash.floats(tangent.to_array()));
    hash.list(uvs, |hash, uv| hash.floats(uv.to_array()));
    hash.list(triangles, |hash, corners| {
        for corner in corners {
            hash.bytes(&corner.to_le_bytes());
        }
    });
}

fn hash_material(hash: &mut Fnv, material: &Material) {
    let Material {
        name: _,
        base_color,
        base_color_texture,
        metallic,
        roughness,
        metallic_roughness_texture,
        normal_texture,
        normal_scale,
        occlusion_texture,
        occlusion_strength,
        emissive,
        emissive_texture,
        alpha_mode,
        double_sided,
        clearcoat,
        ks,
        shininess,
        spread_deg,
        height,
    } = material;
    hash.floats(base_color.to_array());
    hash.floats(emissive.to_array());
    hash.floats([*metallic, *roughness, *normal_scale, *occlusion_strength]);
    for texture in
        [base_color_texture, metallic_roughness_texture, normal_texture, occlusion_texture, emissive_texture]
    {
        hash.option(texture.as_ref(), hash_texture_ref);
    }
    match alpha_mode {
        AlphaMode::Opaque => hash.bytes(&[0]),
        AlphaMode::Mask { cutoff } => {
            hash.bytes(&[1]);
            hash.float(*cutoff);
        }
        AlphaMode::Blend => hash.bytes(&[2]),
    }
    hash.bytes(&[u8::from(*double_sided)]);
    hash_clearcoat(hash, clearcoat);
    hash.option(ks.as_ref(), |hash, ks| hash.floats(ks.to_array()));
    hash.option(shininess.as_ref(), |hash, shininess| hash.float(*shininess));
    hash.option(spread_deg.as_ref(), |hash, spread_deg| hash.float(*spread_deg));
    hash.option(height.as_ref(), hash_height_ref);
}

fn hash_clearcoat(hash: &mut Fnv, clearcoat: &Clearcoat) {
    let Clearcoat { factor, texture, roughness, roughness_texture, normal_texture } = clearcoat;
    hash.floats([*factor, *roughness]);
    for texture in [texture, roughness_texture, normal_texture] {
        hash.option(texture.as_ref(), hash_texture_ref);
    }
}

fn hash_texture_ref(hash: &mut Fnv, reference: &TextureRef) {
    let TextureRef { texture, texture_from_vertex_uv, wrap, nearest } = reference;
    hash.integer(*texture as u64);
    hash.floats(texture_from_vertex_uv.to_cols_array());
    for wrap in wrap {
        hash.bytes(&[match wrap {
            Wrap::Repeat => 0,
            Wrap::Mirror => 1,
            Wrap::Clamp => 2,
        }]);
    }
    hash.bytes(&[u8::from(*nearest)]);
}

fn hash_height_ref(hash: &mut Fnv, reference: &HeightRef) {
    let HeightRef { map, height_scale, uv_scale } = reference;
    hash.integer(*map as u64);
    hash.float(*height_scale);
    hash.floats(uv_scale);
}

fn hash_texture(hash: &mut Fnv, texture: &Texture) {
    let Texture { name: _, width, height, rgba, color_space } = texture;
    hash.integer(u64::from(*width));
    hash.integer(u64::from(*height));
    hash.integer(rgba.len() as u64);
    hash.bytes(rgba);
    hash.bytes(&[match color_space {
        ColorSpace::Srgb => 0,
        ColorSpace::Linear => 1,
    }]);
}

fn hash_height_map(hash: &mut Fnv, map: &HeightMap) {
    let HeightMap { name: _, width, height, heights } = map;
    hash.integer(u64::from(*width));
    hash.integer(u64::from(*height));
    hash.list(heights, |hash, height| hash.float(*height));
}

fn hash_instance(hash: &mut Fnv, instance: &Instance) {
    let Instance { name: _, mesh, material, world_from_local } = instance;
    hash.integer(*mesh as u64);
    hash.integer(*material as u64);
    hash.floats(world_from_local.to_cols_array());
}

fn hash_light(hash: &mut Fnv, light: &Light) {
    match light {
        Light::Directional { direction_world, irradiance, angular_diameter_rad } => {
            hash.bytes(&[0]);
            hash.floats(direction_world.to_array());
            hash.floats(irradiance.to_array());
            hash.float(*angular_diameter_rad);
        }
        Light::Point { position_world, intensity, range } => {
            hash.bytes(&[1]);
            hash.floats(position_world.to_array());
            hash.floats(intensity.to_array());
            hash.float(*range);
        }
        Light::Spot {
            position_world,
            direction_world,
            intensity,
            range,
            inner_angle_rad,
            outer_angle_rad,
        } => {
            hash.bytes(&[2]);
            hash.floats(position_world.to_array());
            hash.floats(direction_world.to_array());
            hash.floats(intensity.to_array());
            hash.floats([*range, *inner_angle_rad, *outer_angle_rad]);
        }
    }
}

fn hash_environment(hash: &mut Fnv, environment: &Environment) {
    let Environment { name: _, width, height, pixels, intensity, rotation_rad, repairs: _ } = environment;
    hash.integer(u64::from(*width));
    hash.integer(u64::from(*height));
    hash.list(pixels, |hash, pixel| hash.floats(pixel));
    hash.floats([*intensity, *rotation_rad]);
}

fn hash_camera(hash: &mut Fnv, camera: &Camera) {
    let Camera { eye, target, up, fov_y_rad } = camera;
    for vector in [eye, target, up] {
        hash.floats(vector.to_array());
    }
    hash.float(*fov_y_rad);
}

fn hash_settings(hash: &mut Fnv, settings: &Settings) {
    let Settings { size, samples: _, seed, max_bounces, lobe, occlusion, pixel_filter } = settings;
    for &side in size {
        hash.integer(u64::from(side));
    }
    hash.integer(*seed);
    hash.integer(u64::from(*max_bounces));
    hash.bytes(&[match lobe {
        Lobe::Ggx => 0,
        Lobe::Blinn => 1,
        Lobe::PhongCone => 2,
        Lobe::DiffusedEnvironment => 3,
    }]);
    hash.bytes(&[u8::from(*occlusion)]);
    match pixel_filter {
        PixelFilter::Point => hash.bytes(&[0]),
        PixelFilter::Box => hash.bytes(&[1]),
        PixelFilter::Gaussian { sigma_pixels } => {
            hash.bytes(&[2]);
            hash.integer((f64::from(*sigma_pixels) + 0.0).to_bits());
        }
    }
}

#[cfg(test)]
mod tests;
