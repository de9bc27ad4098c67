//! The structs that shaders read, laid out as in WGSL, and how the scene's values become them.

use crate::View;
use bytemuck::{Pod, Zeroable};
use glam::{Affine2, Vec3};
use scene::{AlphaMode, Clearcoat, HeightRef, Light, Material, TextureRef};

/// The largest finite half float.
const HALF_MAX: f32 = 65504.0;

/// `CompositorView` of compositor/library.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ViewUniform {
    clip_from_world: [[f32; 4]; 4],
    world_from_clip: [[f32; 4]; 4],
    eye_world: [f32; 3],
    near_m: f32,
}

impl ViewUniform {
    pub(crate) fn new(view: &View) -> Self {
        Self {
            clip_from_world: view.clip_from_world.to_cols_array_2d(),
            world_from_clip: view.world_from_clip.to_cols_array_2d(),
            eye_world: view.eye_world.to_array(),
            near_m: view.near_m,
        }
    }
}

/// `Material` of compositor/geometry.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct MaterialUniform {
    base_color: [f32; 4],
    emissive: [f32; 3],
    alpha_cutoff: f32,
    ks: [f32; 3],
    shininess: f32,
    metallic: f32,
    roughness: f32,
    normal_scale: f32,
    occlusion_strength: f32,
    flags: u32,
    unused: [u32; 3],
    texture_from_vertex_uv: [[f32; 4]; 10],
}

const HAS_KS: u32 = 1;
const HAS_SHININESS: u32 = 2;
const HAS_NORMAL_TEXTURE: u32 = 4;

impl MaterialUniform {
    /// The uniform of a material whose values may be anything, and how many of them were brought
    /// into range.
    pub(crate) fn new(material: &Material) -> (Self, usize) {
        let mut repair = Repair::default();
        let cutoff = match material.alpha_mode {
            AlphaMode::Mask { cutoff } => cutoff,
            AlphaMode::Opaque | AlphaMode::Blend => 0.0,
        };
        let flag = |set: bool, bit: u32| if set { bit } else { 0 };
        let uniform = Self {
            base_color: material.base_color.to_array().map(|x| repair.clamp(x, 0.0, 1.0, 0.0)),
            emissive: material.emissive.to_array().map(|x| repair.clamp(x, 0.0, HALF_MAX, 0.0)),
            // A cutoff above 1 hides everything, as glTF says.
            alpha_cutoff: repair.clamp(cutoff, 0.0, 2.0, 0.5),
            ks: material.ks.unwrap_or(Vec3::ZERO).to_array().map(|x| repair.clamp(x, 0.0, 1.0, 0.0)),
            shininess: repair.clamp(material.shininess.unwrap_or(0.0), 0.0, HALF_MAX, 0.0),
            metallic: repair.clamp(material.metallic, 0.0, 1.0, 0.0),
            roughness: repair.clamp(material.roughness, 0.0, 1.0, 1.0),
            normal_scale: repair.clamp(material.normal_scale, -1e3, 1e3, 1.0),
            occlusion_strength: repair.clamp(material.occlusion_strength, 0.0, 1.0, 0.0),
            flags: flag(material.ks.is_some(), HAS_KS)
                | flag(material.shininess.is_some(), HAS_SHININESS)
                | flag(material.normal_texture.is_some(), HAS_NORMAL_TEXTURE),
            unused: [0; 3],
            texture_from_vertex_uv: repair.texture_rows(textures(material)),
        };
        (uniform, repair.count)
    }
}

/// `CompositorRelief` of compositor/relief-library.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ReliefUniform {
    size: [f32; 2],
    uv_scale: [f32; 2],
    height_scale_m: f32,
    unused: [f32; 3],
}

impl ReliefUniform {
    /// Of a height map of `size` texels, which is turned over where its scale is negative.
    pub(crate) fn new(height: &HeightRef, size: [u32; 2]) -> Self {
        Self {
            size: size.map(|side| side as f32),
            uv_scale: height.uv_scale,
            height_scale_m: height.height_scale.abs(),
            unused: [0.0; 3],
        }
    }
}

/// `Coat` of compositor/coat-surface.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct CoatUniform {
    strength: f32,
    roughness: f32,
    has_normal_texture: u32,
    unused: u32,
    texture_from_vertex_uv: [[f32; 4]; 6],
}

impl CoatUniform {
    /// The uniform of a coat whose values may be anything, and how many were brought into range.
    pub(crate) fn new(coat: &Clearcoat) -> (Self, usize) {
        let mut repair = Repair::default();
        let uniform = Self {
            strength: repair.clamp(coat.factor, 0.0, 1.0, 0.0),
            roughness: repair.clamp(coat.roughness, 0.0, 1.0, 0.0),
            has_normal_texture: u32::from(coat.normal_texture.is_some()),
            unused: 0,
            texture_from_vertex_uv: repair.texture_rows(coat_textures(coat)),
        };
        (uniform, repair.count)
    }
}

/// A coat's textures in the order of the shader's bindings: strength, roughness, normal.
pub(crate) fn coat_textures(coat: &Clearcoat) -> [Option<&TextureRef>; 3] {
    [&coat.texture, &coat.roughness_texture, &coat.normal_texture].map(Option::as_ref)
}

/// A material's textures in the order of the shader's bindings: base colour, metallic and
/// roughness, normal, occlusion, emissive.
pub(crate) fn textures(material: &Material) -> [Option<&TextureRef>; 5] {
    [
        &material.base_color_texture,
        &material.metallic_roughness_texture,
        &material.normal_texture,
        &material.occlusion_texture,
        &material.emissive_texture,
    ]
    .map(Option::as_ref)
}

/// Brings values into range and counts those that were not.
#[derive(Default)]
struct Repair {
    count: usize,
}

impl Repair {
    fn clamp(&mut self, value: f32, least: f32, greatest: f32, if_nan: f32) -> f32 {
        let repaired = if value.is_nan() { if_nan } else { value.clamp(least, greatest) };
        self.count += usize::from(repaired.to_bits() != value.to_bits());
        repaired
    }

    /// Two rows for each texture.
    fn texture_rows<const TEXTURES: usize, const ROWS: usize>(
        &mut self,
        textures: [Option<&TextureRef>; TEXTURES],
    ) -> [[f32; 4]; ROWS] {
        let mut rows = [[0.0; 4]; ROWS];
        for (rows, texture) in rows.chunks_exact_mut(2).zip(textures) {
            let map = texture.map_or(Affine2::IDENTITY, |texture| texture.texture_from_vertex_uv);
            rows.copy_from_slice(&self.affine_rows(map));
        }
        rows
    }

    fn affine_rows(&mut self, map: Affine2) -> [[f32; 4]; 2] {
        let map = if map.is_finite() {
            map
        } else {
            self.count += 1;
            Affine2::IDENTITY
        };
        let (x, y, t) = (map.matrix2.x_axis, map.matrix2.y_axis, map.translation);
        [[x.x, y.x, t.x, 0.0], [x.y, y.y, t.y, 0.0]]
    }
}

/// `Background` of compositor/background.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct BackgroundUniform {
    world_from_clip: [[f32; 4]; 4],
    rotation: [f32; 2],
    intensity: f32,
    unused: f32,
}

impl BackgroundUniform {
    pub(crate) fn new(view: &View, rotation_rad: f32, intensity: f32) -> Self {
        Self {
            world_from_clip: view.world_from_clip.to_cols_array_2d(),
            rotation: [rotation_rad.cos(), rotation_rad.sin()],
            intensity,
            unused: 0.0,
        }
    }
}

/// `Light` of compositor/direct-light.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct LightUniform {
    position_world: [f32; 3],
    kind: u32,
    power: [f32; 3],
    range: f32,
    axis_world: [f32; 3],
    spot_scale: f32,
    spot_offset: f32,
    unused: [f32; 3],
}

const DIRECTIONAL: u32 = 0;
const POINT: u32 = 1;
const SPOT: u32 = 2;

impl LightUniform {
    /// The uniform of a light; `None` where the light has no usable position or direction, or
    /// sends nothing: no pass is spent on it.
    pub(crate) fn new(light: &Light) -> Option<Self> {
        let uniform = match *light {
            Light::Directional { direction_world, irradiance, angular_diameter_rad: _ } => Self {
                position_world: direction_world.try_normalize()?.to_array(),
                kind: DIRECTIONAL,
                power: irradiance.to_array(),
                ..Self::zeroed()
            },
            Light::Point { position_world, intensity, range } => Self {
                position_world: position_world.to_array(),
                kind: POINT,
                power: intensity.to_array(),
                range,
                ..Self::zeroed()
            },
            Light::Spot {
                position_world,
                direction_world,
                intensity,
                range,
                inner_angle_rad,
                outer_angle_rad,
            } => {
                let (inner, outer) = (inner_angle_rad.cos(), outer_angle_rad.cos());
                let spot_scale = 1.0 / (inner - outer).max(0.001);
                Self {
                    position_world: position_world.to_array(),
                    kind: SPOT,
                    power: intensity.to_array(),
                    range,
                    axis_world: direction_world.try_normalize()?.to_array(),
                    spot_scale,
                    spot_offset: -outer * spot_scale,
                    ..Self::zeroed()
                }
            }
        };
        uniform.usable()
    }

    fn usable(mut self) -> Option<Self> {
        let positive = |x: f32| if x > 0.0 { x.min(1e20) } else { 0.0 };
        self.power = self.power.map(positive);
        // The shader squares the range; an infinite one becomes a square that is still finite.
        self.range = positive(self.range).min(1e18);
        let is_finite = self.position_world.iter().all(|x| x.is_finite()) && self.spot_offset.is_finite();
        (is_finite && self.power.iter().any(|&x| x > 0.0)).then_some(self)
    }
}

/// `ToneMap` of compositor/tone-map.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ToneMapUniform {
    exposure: f32,
    unused: [f32; 3],
}

impl ToneMapUniform {
    pub(crate) fn new(exposure_ev: f32) -> Self {
        Self { exposure: crate::tone_map::exposure_factor(exposure_ev), unused: [0.0; 3] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    /// Offset of each member and size of a struct, as WGSL lays it out.
    fn layout(module: &shaders::Module, name: &str) -> (Vec<(String, usize)>, usize) {
        let parsed = naga::front::wgsl::parse_str(&module.source()).unwrap();
        let found = parsed.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
        let naga::TypeInner::Struct { members, span } = &found.unwrap().1.inner else { panic!("{name}") };
        let member = |member: &naga::StructMember| (member.name.clone().unwrap(), member.offset as usize);
        (members.iter().map(member).collect(), *span as usize)
    }

    macro_rules! assert_layout {
        ($rust:ty, $module:expr, $name:literal, [$($field:ident),*]) => {
            let (members, size) = layout(&$module, $name);
            assert_eq!(size, size_of::<$rust>(), $name);
            let expected = [$((stringify!($field).to_owned(), offset_of!($rust, $field))),*];
            for field in expected {
                assert!(members.contains(&field), "{}: {field:?} not in {members:?}", $name);
            }
        };
    }

    #[test]
    fn structs_lie_in_memory_as_the_shaders_read_them() {
        use shaders::{
            COMPOSITOR_BACKGROUND, COMPOSITOR_COAT_SURFACE, COMPOSITOR_GEOMETRY, COMPOSITOR_LIBRARY,
            COMPOSITOR_LIGHTS, COMPOSITOR_RELIEF_LIBRARY, COMPOSITOR_TONE_MAP,
        };
        assert_layout!(
            ViewUniform,
            COMPOSITOR_LIBRARY,
            "CompositorView",
            [clip_from_world, world_from_clip, eye_world, near_m]
        );
        assert_layout!(
            MaterialUniform,
            COMPOSITOR_GEOMETRY,
            "Material",
            [
                base_color,
                emissive,
                alpha_cutoff,
                ks,
                shininess,
                metallic,
                roughness,
                normal_scale,
                occlusion_strength,
                flags,
                texture_from_vertex_uv
            ]
        );
        assert_layout!(
            BackgroundUniform,
            COMPOSITOR_BACKGROUND,
            "Background",
            [world_from_clip, rotation, intensity]
        );
        assert_layout!(
            LightUniform,
            COMPOSITOR_LIGHTS,
            "Light",
            [position_world, kind, power, range, axis_world, spot_scale, spot_offset]
        );
        assert_layout!(
            CoatUniform,
            COMPOSITOR_COAT_SURFACE,
            "Coat",
            [strength, roughness, has_normal_texture, texture_from_vertex_uv]
        );
        assert_layout!(
            ReliefUniform,
            COMPOSITOR_RELIEF_LIBRARY,
            "CompositorRelief",
            [size, uv_scale, height_scale_m]
        );
        assert_layout!(ToneMapUniform, COMPOSITOR_TONE_MAP, "ToneMap", [exposure]);
    }

    #[test]
    fn values_of_a_material_are_brought_into_range_and_counted() {
        let material = Material {
            roughness: f32::NAN,
            metallic: 2.0,
            emissive: Vec3::new(f32::INFINITY, -1.0, 1.0),
            ..Material::default()
        };
        let (uniform, repaired) = MaterialUniform::new(&material);
        assert_eq!(repaired, 4);
        assert_eq!((uniform.roughness, uniform.metallic, uniform.emissive), (1.0, 1.0, [65504.0, 0.0, 1.0]));
        assert_eq!(MaterialUniform::new(&Material::default()).1, 0);
    }

    #[test]
    fn lights_that_send_nothing_have_no_uniform() {
        let light = |intensity| Light::Point { position_world: Vec3::ONE, intensity, range: f32::INFINITY };
        assert_eq!(LightUniform::new(&light(Vec3::ZERO)), None);
        assert_eq!(LightUniform::new(&light(Vec3::splat(f32::NAN))), None);
        assert!(LightUniform::new(&light(Vec3::X)).is_some_and(|light| light.range.is_finite()));
        let nowhere = Light::Directional {
            direction_world: Vec3::ZERO,
            irradiance: Vec3::ONE,
            angular_diameter_rad: 0.0,
        };
        assert_eq!(LightUniform::new(&nowhere), None);
    }
}
