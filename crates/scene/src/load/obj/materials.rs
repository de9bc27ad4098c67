//! Materials of an MTL library.
//!
//! | MTL | becomes |
//! |---|---|
//! | `Kd` | base colour, linear |
//! | `d`, else `1 - Tr` | opacity; below 1 the material blends |
//! | `Ke` | emissive |
//! | `Ns` | `shininess`, and the roughness r with n = 2 / r^4 - 2 |
//! | `Ks` | `ks`, unless it is what exporters write for any material: absent, grey 0.5, or white |
//! | `illum` 0 or 1 | `ks` of 0: the material has no highlight |
//! | `Pr`, `Pm` | roughness (`Ns` then does not count) and metallic |
//! | `map_Kd`, `map_Ke`, `norm` | base colour, emissive and normal texture |
//!
//! Everything else is ignored. Nothing in a library stops the scene from loading: what cannot be
//! used is a warning.

use glam::{Affine2, Vec3};

use crate::{AlphaMode, Material, TextureRef, Wrap};

/// A scene's material of one that tobj parsed, in which textures are indices.
pub(super) fn material(mtl: tobj::Material) -> Material {
    let plain = Material::default();
    let other = |keyword: &str| mtl.unknown_param.get(keyword);
    let unit_number = |keyword: &str| Some(other(keyword)?.parse::<f32>().ok()?.min(1.0));
    let color = mtl.diffuse.map_or(Vec3::ONE, Vec3::from).min(Vec3::ONE);
    let opacity = mtl.dissolve.or_else(|| Some(1.0 - unit_number("Tr")?)).unwrap_or(1.0).min(1.0);
    let mut material = Material {
        base_color: color.extend(opacity),
        base_color_texture: texture(mtl.diffuse_texture.as_ref()),
        emissive: mtl.emissive.map_or(Vec3::ZERO, Vec3::from),
        emissive_texture: texture(other("map_Ke")),
        normal_texture: texture(other("norm")),
        metallic: unit_number("Pm").unwrap_or(plain.metallic),
        alpha_mode: if opacity < 1.0 { AlphaMode::Blend } else { plain.alpha_mode },
        ks: specular(&mtl),
        ..plain
    };
    if let Some(roughness) = unit_number("Pr") {
        material.roughness = roughness;
    } else if let Some(exponent) = mtl.shininess {
        material.roughness = (2.0 / (exponent + 2.0)).powf(0.25);
        material.shininess = Some(exponent);
    }
    if material.emissive_texture.is_some() && material.emissive == Vec3::ZERO {
        material.emissive = Vec3::ONE;
    }
    Material { name: mtl.name, ..material }
}

fn texture(index: Option<&String>) -> Option<TextureRef> {
    let texture = index?.parse().ok()?;
    let texture_from_vertex_uv = Affine2::IDENTITY;
    Some(TextureRef { texture, texture_from_vertex_uv, wrap: [Wrap::Repeat; 2], nearest: false })
}

fn specular(mtl: &tobj::Material) -> Option<Vec3> {
    if matches!(mtl.illumination_model, Some(0 | 1)) {
        return Some(Vec3::ZERO);
    }
    let ks = Vec3::from(mtl.specular?).min(Vec3::ONE);
    (ks != Vec3::splat(0.5) && ks != Vec3::ONE).then_some(ks)
}
