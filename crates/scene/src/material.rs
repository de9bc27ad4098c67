//! Surface descriptions: glTF metallic-roughness, and what Sheen's techniques add to it.

use glam::{Affine2, Vec3, Vec4};

/// A surface. Factors multiply their textures, as in glTF.
#[derive(Clone, Debug)]
pub struct Material {
    /// The material's name in its file.
    pub name: String,
    /// Linear albedo (or metal reflectance) and opacity, 0..1.
    pub base_color: Vec4,
    /// sRGB colour and opacity.
    pub base_color_texture: Option<TextureRef>,
    /// 0 = dielectric, 1 = metal.
    pub metallic: f32,
    /// Perceptual roughness 0..1. It is the `t` of diffuse-envmap as well.
    pub roughness: f32,
    /// Roughness in green, metallic in blue; linear.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Tangent-space normals; linear.
    pub normal_texture: Option<TextureRef>,
    /// Scales the x and y of the normal texture.
    pub normal_scale: f32,
    /// Ambient occlusion in red; linear.
    pub occlusion_texture: Option<TextureRef>,
    /// 0 = the occlusion texture has no effect, 1 = full effect.
    pub occlusion_strength: f32,
    /// Linear emitted radiance, `KHR_materials_emissive_strength` multiplied in.
    pub emissive: Vec3,
    /// sRGB colour that multiplies `emissive`.
    pub emissive_texture: Option<TextureRef>,
    /// What the opacity means.
    pub alpha_mode: AlphaMode,
    /// Whether back faces are shaded (with the normal turned to the viewer) or culled.
    pub double_sided: bool,
    /// `KHR_materials_clearcoat`.
    pub clearcoat: Clearcoat,
    /// Specular reflectance at normal incidence, where a scene file overrides glTF's
    /// (0.04 for dielectrics, the base colour for metals).
    pub ks: Option<Vec3>,
    /// Blinn exponent, where a scene file overrides n = 2 / roughness^4 - 2.
    pub shininess: Option<f32>,
    /// Half-angle of the reflection cone in degrees, where a scene file gives one.
    pub spread_deg: Option<f32>,
    /// Height map, where a scene file gives one.
    pub height: Option<HeightRef>,
}

impl Default for Material {
    /// A white, fully rough dielectric. (glTF's own default is metallic; see the loader.)
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec4::ONE,
            base_color_texture: None,
            metallic: 0.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            occlusion_texture: None,
            occlusion_strength: 1.0,
            emissive: Vec3::ZERO,
            emissive_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            clearcoat: Clearcoat::default(),
            ks: None,
            shininess: None,
            spread_deg: None,
            height: None,
        }
    }
}

/// What a material's opacity means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Opacity is ignored.
    #[default]
    Opaque,
    /// Fragments below the cutoff are absent, all others are opaque.
    Mask {
        /// Smallest opacity that is kept, 0..1.
        cutoff: f32,
    },
    /// Opacity blends over what is behind.
    Blend,
}

/// A smooth dielectric layer over the surface (`KHR_materials_clearcoat`).
#[derive(Clone, Debug, Default)]
pub struct Clearcoat {
    /// Strength of the layer, 0 (none) .. 1.
    pub factor: f32,
    /// Strength in red; linear.
    pub texture: Option<TextureRef>,
    /// Perceptual roughness of the layer, 0..1.
    pub roughness: f32,
    /// Roughness in green; linear.
    pub roughness_texture: Option<TextureRef>,
    /// The layer's own tangent-space normals; linear.
    pub normal_texture: Option<TextureRef>,
}

/// How a material uses a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into `Scene::textures`.
    pub texture: usize,
    /// Maps a vertex's uv to the texture's uv (`KHR_texture_transform`).
    pub texture_from_vertex_uv: Affine2,
    /// What lies beyond 0..1, along u and v.
    pub wrap: [Wrap; 2],
    /// True where the file asks for nearest-texel magnification.
    pub nearest: bool,
}

/// What a texture shows beyond 0..1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The texture again.
    #[default]
    Repeat,
    /// The texture mirrored, then again.
    Mirror,
    /// The border texel.
    Clamp,
}

/// How a material uses a height map.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightRef {
    /// Index into `Scene::height_maps`.
    pub map: usize,
    /// Metres between the map's 0 and 1.
    pub height_scale: f32,
    /// How often the map repeats over 0..1 of the vertex uv, along u and v.
    pub uv_scale: [f32; 2],
}
