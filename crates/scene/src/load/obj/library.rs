//! Checks MTL material libraries, and rewrites them as the plain one that tobj is given.
//!
//! tobj gives up a whole library at the first odd number, and panics on a colour of one number.
//! What it cannot take is left out here with a warning that names the line. Textures are loaded,
//! and their indices stand in the rewritten text.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use super::NO_MATERIAL;
use super::scan::Scan;
use crate::load::confined::read_within;
use crate::load::texture_budget::TextureBudget;
use crate::load::warnings::Warnings;
use crate::{ColorSpace, Error, Limits, Texture};

/// Reads every library that can be read from the folder, and adds a plain material for each that
/// the OBJ uses and none of them has. Returns the text for tobj, and the textures.
pub(super) fn read(
    name: &str,
    scan: &Scan,
    folder: Option<&Path>,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<(String, Vec<Texture>), Error> {
    let mut scanner = Scanner {
        folder,
        limits,
        budget: TextureBudget::new(limits),
        warnings,
        place: String::new(),
        material_count: 0,
        materials: HashSet::new(),
        texture_of_file: HashMap::new(),
        text: String::new(),
        textures: Vec::new(),
    };
    let mut seen = HashSet::new();
    for (line, file) in scan.libraries.iter().filter(|(_, file)| seen.insert(file)) {
        scanner.place = format!("line {line}");
        match read_within(folder, &with_slashes(file), limits) {
            Ok(bytes) => scanner.library(file, &String::from_utf8_lossy(&bytes)),
            Err(refused) => scanner
                .warn(&format!("mtllib is ignored: found {}, expected {}", refused.found, refused.expected)),
        }
    }
    for group in &scan.groups {
        if scanner.materials.contains(&group.material) {
            continue;
        }
        if !scanner.material(&group.material) {
            let expected = format!("at most {} (Limits::materials)", limits.materials);
            return Err(Error::new(name, format!("line {}", group.line), "one material more", expected));
        }
        if group.material != NO_MATERIAL {
            scanner.place = format!("material {:?}", group.material);
            scanner.warn("a material that no library has is replaced by a plain one");
        }
    }
    Ok((scanner.text, scanner.textures))
}

/// Windows programs write backslashes between folders.
fn with_slashes(file: &str) -> String {
    file.replace('\\', "/")
}

struct Scanner<'a> {
    folder: Option<&'a Path>,
    limits: &'a Limits,
    budget: TextureBudget<'a>,
    warnings: &'a mut Warnings,
    place: String,
    material_count: u64,
    /// The names of the materials so far.
    materials: HashSet<String>,
    texture_of_file: HashMap<(String, ColorSpace), Option<usize>>,
    text: String,
    textures: Vec<Texture>,
}

impl Scanner<'_> {
    fn warn(&mut self, message: &str) {
        self.warnings.add(&self.place, message);
    }

    fn write(&mut self, keyword: &str, rest: &str) {
        for part in [keyword, " ", rest, "\n"] {
            self.text += part;
        }
    }

    fn library(&mut self, file: &str, text: &str) {
        // Statements before the first material belong to none.
        let mut in_material = false;
        for (index, line) in text.lines().enumerate() {
            self.place = format!("{file} line {}", index + 1);
            let (keyword, rest) = super::keyword_and_rest(line);
            if keyword == "newmtl" {
                in_material = self.material(&super::name(rest));
                if !in_material {
                    self.warn("materials beyond Limits::materials are ignored");
                }
            } else if in_material {
                self.statement(keyword, rest);
            }
        }
    }

    /// Begins a material, unless there are as many as may be.
    fn material(&mut self, name: &str) -> bool {
        let fits = self.material_count < self.limits.materials;
        if fits {
            self.material_count += 1;
            self.materials.insert(name.to_owned());
            self.write("newmtl", name);
        }
        fits
    }

    fn statement(&mut self, keyword: &str, rest: &str) {
        match keyword {
            "Kd" | "Ks" | "Ke" => self.numbers(keyword, rest, 3),
            "Ns" | "d" | "Tr" | "Pr" | "Pm" => self.numbers(keyword, rest, 1),
            "illum" if rest.parse::<u8>().is_ok() => self.write(keyword, rest),
            "map_Kd" | "map_Ke" => self.texture(keyword, rest, ColorSpace::Srgb),
            "norm" => self.texture(keyword, rest, ColorSpace::Linear),
            _ if keyword.starts_with("map_") || matches!(keyword, "bump" | "disp" | "decal" | "refl") => {
                self.warn(&format!("{keyword} is ignored"));
            }
            _ => {}
        }
    }

    /// Numbers of at least 0; one may stand for all three of a colour.
    fn numbers(&mut self, keyword: &str, rest: &str, count: usize) {
        let words: Vec<&str> = rest.split_whitespace().take(count).collect();
        let all_usable = words.iter().all(|word| is_usable(word));
        let what = if count == 1 { "a number" } else { "three numbers" };
        match words[..] {
            [one] if all_usable => self.write(keyword, &[one].repeat(count).join(" ")),
            [_, _, _] if all_usable => self.write(keyword, &words.join(" ")),
            _ => self.warn(&format!("{keyword} without {what} of at least 0 is ignored")),
        }
    }

    fn texture(&mut self, keyword: &str, rest: &str, color_space: ColorSpace) {
        let key = (with_slashes(without_options(rest)), color_space);
        let known = self.texture_of_file.get(&key).copied();
        let texture = known.unwrap_or_else(|| self.load_texture(&key.0, color_space));
        self.texture_of_file.insert(key, texture);
        if let Some(texture) = texture {
            self.write(keyword, &texture.to_string());
        }
    }

    fn load_texture(&mut self, file: &str, color_space: ColorSpace) -> Option<usize> {
        if self.textures.len() as u64 >= self.limits.textures {
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
                self.textures.push(texture);
                Some(self.textures.len() - 1)
            }
            Err((found, expected)) => {
                self.warn(&format!("a texture is ignored: found {found}, expected {expected}"));
                None
            }
        }
    }
}

/// Whether a word is a finite number of at least 0.
fn is_usable(word: &str) -> bool {
    word.parse().is_ok_and(|number: f32| number.is_finite() && number >= 0.0)
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
