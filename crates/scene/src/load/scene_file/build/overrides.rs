//! Material keys of an object, laid over the materials of its file.

use std::collections::HashMap;

use glam::Vec4;

use super::Builder;
use crate::load::scene_file::keys::ObjectKeys;
use crate::{Error, HeightRef, Instance, Material, Texture, TextureRef};

const ROUGHNESS_CHANNEL: usize = 1;
const METALLIC_CHANNEL: usize = 2;

impl Builder<'_> {
    /// Gives the instances of one object copies of their materials with the object's own values.
    /// Without material keys they keep the file's.
    pub(super) fn override_materials(
        &mut self,
        keys: &ObjectKeys,
        instances: &mut [Instance],
    ) -> Result<(), Error> {
        let height = self.height_ref(keys)?;
        let plain = keys.base_color.is_none()
            && keys.metallic.is_none()
            && keys.roughness.is_none()
            && keys.ks.is_none()
            && keys.shininess.is_none()
            && keys.spread_deg.is_none()
            && height.is_none();
        if plain {
            return Ok(());
        }
        let mut copies: HashMap<usize, usize> = HashMap::new();
        for instance in instances {
            let copy = match copies.get(&instance.material) {
                Some(&copy) => copy,
                None => self.overridden(keys, instance.material, height.clone())?,
            };
            copies.insert(instance.material, copy);
            instance.material = copy;
        }
        Ok(())
    }

    fn height_ref(&mut self, keys: &ObjectKeys) -> Result<Option<HeightRef>, Error> {
        let map = match (&keys.height_map, &keys.builtin_height_map) {
            (Some(file), None) => self.height_map(file)?,
            (None, Some(name)) => self.builtin_height_map(name)?,
            (Some(_), Some(_)) => {
                return Err(self.error("height_map or builtin_height_map", "both", "one of them"));
            }
            (None, None) => return self.no_stray_keys(keys).map(|()| None),
        };
        let height_scale =
            self.in_range("height_scale", keys.height_scale.unwrap_or(1.0), f32::MIN, f32::MAX)?;
        let uv_scale = keys.uv_scale.map_or([1.0; 2], |scale| scale.0);
        for scale in uv_scale {
            self.in_range("uv_scale", scale, f32::MIN, f32::MAX)?;
        }
        Ok(Some(HeightRef { map, height_scale, uv_scale }))
    }

    /// An error where an object without a height map says how it lies.
    fn no_stray_keys(&self, keys: &ObjectKeys) -> Result<(), Error> {
        let stray = [("height_scale", keys.height_scale.is_some()), ("uv_scale", keys.uv_scale.is_some())];
        match stray.iter().find(|(_, is_given)| *is_given) {
            Some((key, _)) => Err(self.error(key, "it without a height_map", "a height_map beside it")),
            None => Ok(()),
        }
    }

    /// Adds a copy of a material with the keys laid over it.
    fn overridden(
        &mut self,
        keys: &ObjectKeys,
        index: usize,
        height: Option<HeightRef>,
    ) -> Result<usize, Error> {
        if self.scene.materials.len() as u64 >= self.limits.materials {
            let expected = format!("at most {} (Limits::materials)", self.limits.materials);
            return Err(self.error("material keys", "one material more", expected));
        }
        let mut material = self.scene.materials.get(index).cloned().unwrap_or_default();
        if let Some(color) = &keys.base_color {
            material.base_color = self.base_color(color, &material)?;
            material.base_color_texture = None;
        }
        if let Some(metallic) = keys.metallic {
            material.metallic = self.in_range("metallic", metallic, 0.0, 1.0)?;
        }
        if let Some(roughness) = keys.roughness {
            material.roughness = self.in_range("roughness", roughness, 0.0, 1.0)?;
            // An exponent of the file describes the old roughness.
            material.shininess = None;
        }
        self.replace_metallic_roughness(&mut material, keys.metallic.is_some(), keys.roughness.is_some())?;
        if let Some(ks) = keys.ks {
            material.ks = Some(self.color("ks", ks.0)?);
        }
        if let Some(shininess) = keys.shininess {
            material.shininess = Some(self.in_range("shininess", shininess, 0.0, f32::MAX)?);
        }
        if let Some(spread_deg) = keys.spread_deg {
            material.spread_deg = Some(self.in_range("spread_deg", spread_deg, 0.0, 90.0)?);
        }
        if height.is_some() {
            material.height = height;
        }
        self.scene.materials.push(material);
        Ok(self.scene.materials.len() - 1)
    }

    /// Three numbers keep the file's opacity, four replace it.
    fn base_color(&self, color: &[f32], material: &Material) -> Result<Vec4, Error> {
        for &number in color {
            self.in_range("base_color", number, 0.0, 1.0)?;
        }
        match *color {
            [red, green, blue] => Ok(Vec4::new(red, green, blue, material.base_color.w)),
            [red, green, blue, opacity] => Ok(Vec4::new(red, green, blue, opacity)),
            _ => Err(self.error("base_color", format!("{} numbers", color.len()), "3 or 4 numbers")),
        }
    }

    /// Metallic and roughness share a texture: where only one of them is replaced, its channel
    /// becomes 1 in a copy of the texture, so that the factor alone counts.
    fn replace_metallic_roughness(
        &mut self,
        material: &mut Material,
        metallic: bool,
        roughness: bool,
    ) -> Result<(), Error> {
        let Some(reference) = &mut material.metallic_roughness_texture else { return Ok(()) };
        match (metallic, roughness) {
            (false, false) => {}
            (true, true) => material.metallic_roughness_texture = None,
            (true, false) => {
                reference.texture = self.with_full_channel(reference.texture, METALLIC_CHANNEL)?;
            }
            (false, true) => {
                reference.texture = self.with_full_channel(reference.texture, ROUGHNESS_CHANNEL)?;
            }
        }
        Ok(())
    }

    fn with_full_channel(&mut self, index: usize, channel: usize) -> Result<usize, Error> {
        if let Some(&copy) = self.textures_with_channel.get(&(index, channel)) {
            return Ok(copy);
        }
        let Some(texture) = self.scene.textures.get(index) else { return Ok(index) };
        let bytes = self.texture_bytes() + texture.rgba.len() as u64;
        if bytes > self.limits.texture_bytes || self.scene.textures.len() as u64 >= self.limits.textures {
            let expected = "textures within Limits::textures and Limits::texture_bytes";
            return Err(self.error("metallic, roughness", "one texture more", expected));
        }
        let mut copy: Texture = texture.clone();
        copy.rgba.iter_mut().skip(channel).step_by(4).for_each(|value| *value = 255);
        self.scene.textures.push(copy);
        self.textures_with_channel.insert((index, channel), self.scene.textures.len() - 1);
        Ok(self.scene.textures.len() - 1)
    }
}

/// Every texture that a material uses.
pub(super) fn texture_refs(material: &mut Material) -> impl Iterator<Item = &mut TextureRef> {
    [
        &mut material.base_color_texture,
        &mut material.metallic_roughness_texture,
        &mut material.normal_texture,
        &mut material.occlusion_texture,
        &mut material.emissive_texture,
        &mut material.clearcoat.texture,
        &mut material.clearcoat.roughness_texture,
        &mut material.clearcoat.normal_texture,
    ]
    .into_iter()
    .flatten()
}
