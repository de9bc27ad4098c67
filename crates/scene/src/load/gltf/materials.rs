//! Materials, and which images they use in which way.

use std::collections::HashMap;

use ::gltf::json;
use glam::{Affine2, Vec2, Vec3, Vec4};
use json::extensions::texture::TextureTransform;
use json::texture::{Info, MagFilter, WrappingMode};
use json::validation::Checked;
use serde::Deserialize;

use super::Document;
use crate::load::warnings::Warnings;
use crate::{AlphaMode, Clearcoat, ColorSpace, Error, Material, TextureRef, Wrap};

/// The materials, and the images to decode for them.
#[derive(Default)]
pub(super) struct Table {
    pub(super) materials: Vec<Material>,
    /// Image and colour space of each of the scene's textures.
    pub(super) uses: Vec<(usize, ColorSpace)>,
    texture_of_use: HashMap<(usize, ColorSpace), usize>,
    default_material: Option<usize>,
}

impl Table {
    /// The scene's index of a primitive's material; glTF's default one if it names none.
    pub(super) fn material_index(
        &mut self,
        document: &Document,
        material: Option<json::Index<json::Material>>,
        mesh_name: &str,
    ) -> Result<usize, Error> {
        if let Some(index) = material {
            document.get(&document.root.materials, index, &format!("material of {mesh_name:?}"))?;
            return Ok(index.value());
        }
        let index = *self.default_material.get_or_insert(self.materials.len());
        if index == self.materials.len() {
            self.materials.push(Material {
                name: "default".to_owned(),
                metallic: 1.0,
                ..Material::default()
            });
        }
        Ok(index)
    }

    fn texture(&mut self, image: usize, color_space: ColorSpace) -> usize {
        let uses = &mut self.uses;
        *self.texture_of_use.entry((image, color_space)).or_insert_with(|| {
            uses.push((image, color_space));
            uses.len() - 1
        })
    }
}

/// Reads every material of the file, in its order.
pub(super) fn read(document: &Document, warnings: &mut Warnings) -> Result<Table, Error> {
    let mut table = Table::default();
    for (index, material) in document.root.materials.iter().enumerate() {
        let place = format!("materials[{index}]");
        let mut reader = Reader { document, place, table: &mut table, warnings };
        let material = reader.material(material, index)?;
        table.materials.push(material);
    }
    Ok(table)
}

/// `KHR_materials_clearcoat`, which the gltf crate leaves as plain JSON.
#[derive(Default, Deserialize)]
#[expect(clippy::struct_field_names, reason = "the names are the extension's")]
#[serde(default, rename_all = "camelCase")]
struct ClearcoatJson {
    clearcoat_factor: f32,
    clearcoat_texture: Option<Info>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<Info>,
    clearcoat_normal_texture: Option<json::material::NormalTexture>,
}

struct Reader<'a, 'b> {
    document: &'a Document<'a>,
    place: String,
    table: &'b mut Table,
    warnings: &'b mut Warnings,
}

impl Reader<'_, '_> {
    fn material(&mut self, material: &json::Material, index: usize) -> Result<Material, Error> {
        let pbr = &material.pbr_metallic_roughness;
        let color = pbr.base_color_factor.0;
        let normal = material.normal_texture.as_ref();
        let occlusion = material.occlusion_texture.as_ref();
        Ok(Material {
            name: material.name.clone().unwrap_or_else(|| format!("material {index}")),
            base_color: Vec4::from(color.map(|value| self.unit("baseColorFactor", value))),
            base_color_texture: self.color(pbr.base_color_texture.as_ref(), "baseColorTexture")?,
            metallic: self.unit("metallicFactor", pbr.metallic_factor.0),
            roughness: self.unit("roughnessFactor", pbr.roughness_factor.0),
            metallic_roughness_texture: self
                .data(pbr.metallic_roughness_texture.as_ref(), "metallicRoughnessTexture")?,
            normal_texture: self.normal(normal, "normalTexture")?,
            normal_scale: self.finite("normalTexture.scale", normal.map_or(1.0, |normal| normal.scale), 1.0),
            occlusion_texture: match occlusion {
                Some(json) => {
                    let transform =
                        self.transform(json.extensions.as_ref().map(|extensions| &extensions.others))?;
                    self.texture(
                        json.index,
                        json.tex_coord,
                        transform.as_ref(),
                        ColorSpace::Linear,
                        "occlusionTexture",
                    )?
                }
                None => None,
            },
            occlusion_strength: self
                .unit("occlusionTexture.strength", occlusion.map_or(1.0, |json| json.strength.0)),
            emissive: self.emissive(material),
            emissive_texture: self.color(material.emissive_texture.as_ref(), "emissiveTexture")?,
            alpha_mode: self.alpha_mode(material)?,
            double_sided: material.double_sided,
            clearcoat: self.clearcoat(material)?,
            ..Material::default()
        })
    }

    fn emissive(&mut self, material: &json::Material) -> Vec3 {
        let extension =
            material.extensions.as_ref().and_then(|extensions| extensions.emissive_strength.as_ref());
        let strength = extension.map_or(1.0, |extension| extension.emissive_strength.0);
        let factor = Vec3::from(material.emissive_factor.0) * strength;
        Vec3::from(factor.to_array().map(|value| self.finite("emissiveFactor", value, 0.0).max(0.0)))
    }

    fn alpha_mode(&mut self, material: &json::Material) -> Result<AlphaMode, Error> {
        match material.alpha_mode {
            Checked::Valid(json::material::AlphaMode::Opaque) => Ok(AlphaMode::Opaque),
            Checked::Valid(json::material::AlphaMode::Blend) => Ok(AlphaMode::Blend),
            Checked::Valid(json::material::AlphaMode::Mask) => {
                let cutoff = material.alpha_cutoff.unwrap_or_default().0;
                Ok(AlphaMode::Mask { cutoff: self.unit("alphaCutoff", cutoff) })
            }
            Checked::Invalid => {
                let place = format!("{}.alphaMode", self.place);
                Err(self.document.error(place, "an unknown name", "OPAQUE, MASK or BLEND"))
            }
        }
    }

    fn clearcoat(&mut self, material: &json::Material) -> Result<Clearcoat, Error> {
        let others = material.extensions.as_ref().map(|extensions| &extensions.others);
        let Some(value) = others.and_then(|others| others.get("KHR_materials_clearcoat")) else {
            return Ok(Clearcoat::default());
        };
        let json: ClearcoatJson = self.extension(value, "KHR_materials_clearcoat")?;
        if json.clearcoat_normal_texture.as_ref().is_some_and(|normal| (normal.scale - 1.0).abs() > 0.0) {
            self.warn("clearcoatNormalTexture.scale", "is taken as 1");
        }
        Ok(Clearcoat {
            factor: self.unit("clearcoatFactor", json.clearcoat_factor),
            texture: self.data(json.clearcoat_texture.as_ref(), "clearcoatTexture")?,
            roughness: self.unit("clearcoatRoughnessFactor", json.clearcoat_roughness_factor),
            roughness_texture: self
                .data(json.clearcoat_roughness_texture.as_ref(), "clearcoatRoughnessTexture")?,
            normal_texture: self.normal(json.clearcoat_normal_texture.as_ref(), "clearcoatNormalTexture")?,
        })
    }

    fn color(&mut self, info: Option<&Info>, field: &str) -> Result<Option<TextureRef>, Error> {
        self.info(info, ColorSpace::Srgb, field)
    }

    fn data(&mut self, info: Option<&Info>, field: &str) -> Result<Option<TextureRef>, Error> {
        self.info(info, ColorSpace::Linear, field)
    }

    fn info(
        &mut self,
        info: Option<&Info>,
        space: ColorSpace,
        field: &str,
    ) -> Result<Option<TextureRef>, Error> {
        let Some(info) = info else { return Ok(None) };
        let transform = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.as_ref());
        self.texture(info.index, info.tex_coord, transform, space, field)
    }

    fn normal(
        &mut self,
        normal: Option<&json::material::NormalTexture>,
        field: &str,
    ) -> Result<Option<TextureRef>, Error> {
        let Some(normal) = normal else { return Ok(None) };
        let transform = self.transform(normal.extensions.as_ref().map(|extensions| &extensions.others))?;
        self.texture(normal.index, normal.tex_coord, transform.as_ref(), ColorSpace::Linear, field)
    }

    /// `KHR_texture_transform` where the gltf crate leaves it as plain JSON.
    fn transform(
        &self,
        extensions: Option<&serde_json::Map<String, serde_json::Value>>,
    ) -> Result<Option<TextureTransform>, Error> {
        let value = extensions.and_then(|extensions| extensions.get("KHR_texture_transform"));
        value.map(|value| self.extension(value, "KHR_texture_transform")).transpose()
    }

    fn extension<T: serde::de::DeserializeOwned>(
        &self,
        value: &serde_json::Value,
        name: &str,
    ) -> Result<T, Error> {
        let place = format!("{}, {name}", self.place);
        T::deserialize(value)
            .map_err(|error| self.document.error(place, error.to_string(), "what the extension defines"))
    }

    /// A texture in a colour space. One that uses a second set of texture coordinates is left out.
    fn texture(
        &mut self,
        index: json::Index<json::Texture>,
        tex_coord: u32,
        transform: Option<&TextureTransform>,
        color_space: ColorSpace,
        field: &str,
    ) -> Result<Option<TextureRef>, Error> {
        let document = self.document;
        let texture =
            document.get(&document.root.textures, index, &format!("{}.{field}.index", self.place))?;
        let place = format!("textures[{}]", index.value());
        document.get(&document.root.images, texture.source, &format!("{place}.source"))?;
        let set = transform.and_then(|transform| transform.tex_coord).unwrap_or(tex_coord);
        if set != 0 {
            self.warn(
                field,
                &format!("uses TEXCOORD_{set}; only set 0 is read, and the texture is left out"),
            );
            return Ok(None);
        }
        let (wrap, nearest) = match texture.sampler {
            Some(sampler) => {
                let sampler = document.get(&document.root.samplers, sampler, &format!("{place}.sampler"))?;
                let nearest = matches!(sampler.mag_filter, Some(Checked::Valid(MagFilter::Nearest)));
                ([wrap(sampler.wrap_s), wrap(sampler.wrap_t)], nearest)
            }
            None => ([Wrap::Repeat; 2], false),
        };
        let texture_from_vertex_uv = affine(transform);
        if !texture_from_vertex_uv.is_finite() {
            return Err(document.error(
                format!("{}.{field}", self.place),
                "a transform that is not finite",
                "finite numbers",
            ));
        }
        let texture = self.table.texture(texture.source.value(), color_space);
        Ok(Some(TextureRef { texture, texture_from_vertex_uv, wrap, nearest }))
    }

    /// A number that belongs in 0..1.
    fn unit(&mut self, field: &str, value: f32) -> f32 {
        if !(0.0..=1.0).contains(&value) {
            self.warn(field, &format!("{value} is outside 0..1 and is clamped"));
        }
        if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) }
    }

    fn finite(&mut self, field: &str, value: f32, otherwise: f32) -> f32 {
        if value.is_finite() {
            return value;
        }
        self.warn(field, &format!("is not finite and is taken as {otherwise}"));
        otherwise
    }

    fn warn(&mut self, field: &str, message: &str) {
        self.warnings.add(&self.place, format!("{field} {message}"));
    }
}

fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }
}

/// Scale, then turn, then offset. Counter-clockwise is as seen in the image, whose v points down.
fn affine(transform: Option<&TextureTransform>) -> Affine2 {
    let Some(transform) = transform else { return Affine2::IDENTITY };
    let (scale, offset) = (Vec2::from(transform.scale.0), Vec2::from(transform.offset.0));
    Affine2::from_scale_angle_translation(scale, -transform.rotation.0, offset)
}
