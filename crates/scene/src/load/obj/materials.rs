//! MTL material libraries.
//!
//! | MTL | becomes |
//! |---|---|
//! | `Kd` | base colour, linear |
//! | `d`, `1 - Tr` | opacity; below 1 the material blends |
//! | `Ke` | emissive |
//! | `Ns` | `shininess`, and the roughness r with n = 2 / r^4 - 2 |
//! | `Ks` | `ks`, unless it is what exporters write for any material: absent, grey 0.5, or white |
//! | `illum` 0 or 1 | `ks` of 0: the material has no highlight |
//! | `Pr`, `Pm` | roughness (`Ns` then does not count) and metallic |
//! | `map_Kd`, `map_Ke`, `norm` | base colour, emissive and normal texture |
//!
//! Everything else is ignored. Nothing in a library stops the scene from loading: what cannot be
//! used is a warning.

use std::collections::HashMap;
use std::path::Path;

use glam::Vec3;

use crate::load::confined::read_within;
use crate::load::texture_budget::TextureBudget;
use crate::load::warnings::Warnings;
use crate::{AlphaMode, ColorSpace, Limits, Material, Texture, TextureRef, Wrap};

/// Materials by name, with their textures.
#[derive(Default)]
pub(super) struct Library {
    pub(super) materials: Vec<Material>,
    pub(super) textures: Vec<Texture>,
    index_of_name: HashMap<String, usize>,
}

impl Library {
    /// The index of a named material; a plain one for faces without a material, and for a name
    /// that no library has.
    pub(super) fn material_index(&mut self, name: Option<&str>, warnings: &mut Warnings) -> usize {
        let name = name.unwrap_or("default");
        if let Some(&index) = self.index_of_name.get(name) {
            return index;
        }
        if name != "default" {
            warnings.add(
                format!("material {name:?}"),
                "a material that no library has is replaced by a plain one",
            );
        }
        self.add(Material { name: name.to_owned(), ..Material::default() })
    }

    fn add(&mut self, material: Material) -> usize {
        let index = self.materials.len();
        self.index_of_name.insert(material.name.clone(), index);
        self.materials.push(material);
        index
    }
}

/// Loads every library that can be read.
pub(super) fn load(
    libraries: &[(usize, String)],
    folder: Option<&Path>,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Library {
    let mut reader = Reader {
        folder,
        limits,
        budget: TextureBudget::new(limits),
        warnings,
        place: String::new(),
        library: Library::default(),
        texture_of_file: HashMap::new(),
    };
    let mut seen = std::collections::HashSet::new();
    for (line, file) in libraries.iter().filter(|(_, file)| seen.insert(file)) {
        reader.place = format!("line {line}");
        match read_within(folder, &with_slashes(file), limits) {
            Ok(bytes) => reader.read(file, &String::from_utf8_lossy(&bytes)),
            Err(refused) => reader
                .warn(&format!("mtllib is ignored: found {}, expected {}", refused.found, refused.expected)),
        }
    }
    reader.library
}

/// Windows programs write backslashes between folders.
fn with_slashes(file: &str) -> String {
    file.replace('\\', "/")
}

struct Reader<'a> {
    folder: Option<&'a Path>,
    limits: &'a Limits,
    budget: TextureBudget<'a>,
    warnings: &'a mut Warnings,
    place: String,
    library: Library,
    texture_of_file: HashMap<(String, ColorSpace), Option<usize>>,
}

/// A material while its lines are read.
struct Draft {
    material: Material,
    specular: Option<Vec3>,
    has_highlight: bool,
    roughness: Option<f32>,
}

impl Reader<'_> {
    fn warn(&mut self, message: &str) {
        self.warnings.add(&self.place, message);
    }

    fn read(&mut self, file: &str, text: &str) {
        let mut draft: Option<Draft> = None;
        for (index, line) in text.lines().enumerate() {
            self.place = format!("{file} line {}", index + 1);
            let line = line.split('#').next().unwrap_or_default().trim();
            let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            let rest = rest.trim();
            if keyword == "newmtl" {
                self.finish(draft.take());
                let material = Material { name: rest.to_owned(), ..Material::default() };
                draft = Some(Draft { material, specular: None, has_highlight: true, roughness: None });
            } else if let Some(draft) = &mut draft {
                self.statement(draft, keyword, rest);
            }
        }
        self.finish(draft);
    }

    fn finish(&mut self, draft: Option<Draft>) {
        let Some(Draft { mut material, specular, has_highlight, roughness }) = draft else { return };
        if self.library.materials.len() as u64 >= self.limits.materials {
            self.warn("materials beyond Limits::materials are ignored");
            return;
        }
        let is_default = |specular: &Vec3| *specular == Vec3::splat(0.5) || *specular == Vec3::ONE;
        material.ks = if has_highlight { specular.filter(|ks| !is_default(ks)) } else { Some(Vec3::ZERO) };
        if let Some(roughness) = roughness {
            material.roughness = roughness;
            material.shininess = None;
        }
        if material.base_color.w < 1.0 {
            material.alpha_mode = AlphaMode::Blend;
        }
        self.library.add(material);
    }

    fn statement(&mut self, draft: &mut Draft, keyword: &str, rest: &str) {
        let material = &mut draft.material;
        match keyword {
            "Kd" => {
                if let Some(color) = self.color(keyword, rest) {
                    material.base_color = color.min(Vec3::ONE).extend(material.base_color.w);
                }
            }
            "Ks" => draft.specular = self.color(keyword, rest).map(|color| color.min(Vec3::ONE)),
            "Ke" => material.emissive = self.color(keyword, rest).unwrap_or_default(),
            "d" => material.base_color.w = self.number(keyword, rest).unwrap_or(1.0).min(1.0),
            "Tr" => material.base_color.w = 1.0 - self.number(keyword, rest).unwrap_or(0.0).min(1.0),
            "Ns" => {
                if let Some(exponent) = self.number(keyword, rest) {
                    material.shininess = Some(exponent);
                    material.roughness = (2.0 / (exponent + 2.0)).powf(0.25);
                }
            }
            "Pr" => draft.roughness = self.number(keyword, rest).map(|roughness| roughness.min(1.0)),
            "Pm" => material.metallic = self.number(keyword, rest).unwrap_or(0.0).min(1.0),
            "illum" => draft.has_highlight = !matches!(rest, "0" | "1"),
            "map_Kd" => material.base_color_texture = self.texture(rest, ColorSpace::Srgb),
            "map_Ke" => {
                material.emissive_texture = self.texture(rest, ColorSpace::Srgb);
                if material.emissive_texture.is_some() && material.emissive == Vec3::ZERO {
                    material.emissive = Vec3::ONE;
                }
            }
            "norm" => material.normal_texture = self.texture(rest, ColorSpace::Linear),
            _ if keyword.starts_with("map_") || matches!(keyword, "bump" | "disp" | "decal" | "refl") => {
                self.warn(&format!("{keyword} is ignored"));
            }
            _ => {}
        }
    }

    /// One number of at least 0.
    fn number(&mut self, keyword: &str, text: &str) -> Option<f32> {
        let number = text.split_whitespace().next().and_then(|word| word.parse::<f32>().ok());
        let number = number.filter(|number| number.is_finite() && *number >= 0.0);
        if number.is_none() {
            self.warn(&format!("{keyword} without a number of at least 0 is ignored"));
        }
        number
    }

    /// Three numbers of at least 0, or one for all three.
    fn color(&mut self, keyword: &str, text: &str) -> Option<Vec3> {
        let numbers: Result<Vec<f32>, _> = text.split_whitespace().take(3).map(str::parse).collect();
        let color = match numbers.as_deref() {
            Ok([red, green, blue]) => Some(Vec3::new(*red, *green, *blue)),
            Ok([grey]) => Some(Vec3::splat(*grey)),
            _ => None,
        };
        let color = color.filter(|color| color.is_finite() && color.min_element() >= 0.0);
        if color.is_none() {
            self.warn(&format!("{keyword} without three numbers of at least 0 is ignored"));
        }
        color
    }

    fn texture(&mut self, rest: &str, color_space: ColorSpace) -> Option<TextureRef> {
        let file = with_slashes(without_options(rest));
        let key = (file, color_space);
        let known = self.texture_of_file.get(&key).copied();
        let texture = known.unwrap_or_else(|| self.load_texture(&key.0, color_space));
        self.texture_of_file.insert(key, texture);
        let texture = texture?;
        let texture_from_vertex_uv = glam::Affine2::IDENTITY;
        Some(TextureRef { texture, texture_from_vertex_uv, wrap: [Wrap::Repeat; 2], nearest: false })
    }

    fn load_texture(&mut self, file: &str, color_space: ColorSpace) -> Option<usize> {
        if self.library.textures.len() as u64 >= self.limits.textures {
            self.warn("textures beyond Limits::textures are ignored");
            return None;
        }
        let read =
            read_within(self.folder, file, self.limits).map_err(|refused| (refused.found, refused.expected));
        let decode = |bytes: Vec<u8>| {
            let decoded = self.budget.decode(file, &bytes, color_space);
            decoded.map_err(|error| (format!("{file:?}: {}", error.found), error.expected))
        };
        match read.and_then(decode) {
            Ok(texture) => {
                self.library.textures.push(texture);
                Some(self.library.textures.len() - 1)
            }
            Err((found, expected)) => {
                self.warn(&format!("a texture is ignored: found {found}, expected {expected}"));
                None
            }
        }
    }
}

/// The file name behind options such as `-s 1 1 1` or `-bm 0.5`.
fn without_options(text: &str) -> &str {
    if !text.starts_with('-') {
        return text;
    }
    let is_file = |word: &&str| !word.starts_with('-') && word.contains('.') && word.parse::<f32>().is_err();
    let start = text.split_whitespace().find(is_file).and_then(|word| text.find(word));
    start.and_then(|start| text.get(start..)).unwrap_or_default()
}
