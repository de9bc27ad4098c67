//! glTF 2.0: `.gltf` with its buffers and images beside or inside it, and `.glb`.
//!
//! The JSON is parsed by the gltf crate; everything that it points at is checked here before it
//! is followed, since that crate's own readers trust accessors, views and indices. Supported:
//! the node hierarchy, triangle lists, strips and fans, metallic-roughness materials, the first
//! perspective camera, and the extensions in [`SUPPORTED_EXTENSIONS`]. Skins, morph targets,
//! animations, vertex colours, points and lines are left out with a warning.

mod accessors;
mod buffers;
mod container;
mod images;
mod materials;
mod nodes;
mod primitives;
mod uri;

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

use ::gltf::json;
use rayon::prelude::*;

use super::short_name;
use super::warnings::Warnings;
use crate::{Error, Instance, Limits, Scene};

/// Extensions that a file may require.
const SUPPORTED_EXTENSIONS: [&str; 5] = [
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// What every step of loading one file needs.
struct Document<'a> {
    name: &'a str,
    folder: Option<&'a Path>,
    limits: &'a Limits,
    root: &'a json::Root,
    buffers: Vec<Cow<'a, [u8]>>,
}

impl Document<'_> {
    fn error(
        &self,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Error {
        Error::new(self.name, place, found, expected)
    }

    /// The element of one of the file's arrays that an index names.
    fn get<'b, T>(&self, array: &'b [T], index: json::Index<T>, place: &str) -> Result<&'b T, Error> {
        array.get(index.value()).ok_or_else(|| {
            self.error(place, format!("index {}", index.value()), format!("an index below {}", array.len()))
        })
    }
}

/// Loads a glTF from memory: a `.glb` if the bytes begin with `glTF`, else `.gltf` JSON.
///
/// `name` stands in messages; `folder` is where its buffers and images may be read from, `None`
/// for a file that must bring everything along. Errors name the place in the JSON.
pub fn gltf_from_bytes(
    name: &str,
    bytes: &[u8],
    folder: Option<&Path>,
    limits: &Limits,
) -> Result<Scene, Error> {
    let (json, binary_chunk) = container::split(name, bytes)?;
    let root = container::parse(name, json, limits)?;
    let mut warnings = Warnings::new(name);
    check_extensions(name, &root, &mut warnings)?;
    check_counts(name, &root, limits)?;
    let mut document = Document { name, folder, limits, root: &root, buffers: Vec::new() };
    document.buffers = buffers::load(&document, binary_chunk)?;

    let mut hierarchy = nodes::walk(&document, &mut warnings)?;
    let parts = read_parts(&document, &hierarchy.placements, &mut warnings)?;
    let mut table = materials::read(&document, &mut warnings)?;
    let mut scene = Scene { name: short_name(name), ..Scene::default() };
    place_instances(&document, &hierarchy.placements, parts, &mut table, &mut scene)?;
    scene.textures = images::decode(&document, &table.uses)?;
    scene.materials = table.materials;
    scene.lights = std::mem::take(&mut hierarchy.lights);
    scene.camera = hierarchy.camera.map(|camera| nodes::aim_at_scene(camera, scene.bounds()));
    warn_about_ignored(&root, &mut warnings);
    scene.warnings = warnings.into_vec();
    Ok(scene)
}

fn check_extensions(name: &str, root: &json::Root, warnings: &mut Warnings) -> Result<(), Error> {
    let supported = |extension: &str| SUPPORTED_EXTENSIONS.contains(&extension);
    if let Some(index) = root.extensions_required.iter().position(|extension| !supported(extension)) {
        let required = root.extensions_required.get(index).map_or("", String::as_str);
        let expected = format!("one of the supported extensions {}", SUPPORTED_EXTENSIONS.join(", "));
        return Err(Error::new(
            name,
            format!("extensionsRequired[{index}]"),
            format!("{required:?}"),
            expected,
        ));
    }
    for (index, extension) in root.extensions_used.iter().enumerate().filter(|(_, used)| !supported(used)) {
        warnings.add(format!("extensionsUsed[{index}]"), format!("the extension {extension} is ignored"));
    }
    Ok(())
}

fn check_counts(name: &str, root: &json::Root, limits: &Limits) -> Result<(), Error> {
    let counts = [
        ("nodes", root.nodes.len(), limits.nodes),
        ("images", root.images.len(), limits.textures),
        ("materials", root.materials.len(), limits.materials),
    ];
    for (place, count, limit) in counts {
        if count as u64 > limit {
            return Err(Error::new(name, place, format!("{count} {place}"), format!("at most {limit}")));
        }
    }
    Ok(())
}

/// A primitive as a mesh of the scene, with its material in the file.
struct Part {
    mesh: crate::Mesh,
    material: Option<json::Index<json::Material>>,
}

/// Reads each mesh that is placed, once, as one part per primitive with triangles.
fn read_parts(
    document: &Document,
    placements: &[nodes::Placement],
    warnings: &mut Warnings,
) -> Result<HashMap<usize, Vec<Part>>, Error> {
    let mut placed: Vec<usize> = placements.iter().map(|placement| placement.mesh).collect();
    placed.sort_unstable();
    placed.dedup();
    let sources = primitives::sources(document, &placed, warnings)?;
    let read: Vec<_> = sources.par_iter().map(|source| primitives::read(document, source)).collect();
    let mut parts: HashMap<usize, Vec<Part>> = HashMap::new();
    for (source, result) in sources.iter().zip(read) {
        let (mesh, notes) = result?;
        warnings.extend(notes);
        parts.entry(source.mesh).or_default().push(Part { mesh, material: source.primitive.material });
    }
    Ok(parts)
}

/// One instance per placement and primitive. A mesh that is placed often is stored once.
fn place_instances(
    document: &Document,
    placements: &[nodes::Placement],
    parts: HashMap<usize, Vec<Part>>,
    table: &mut materials::Table,
    scene: &mut Scene,
) -> Result<(), Error> {
    let mut stored: HashMap<usize, Vec<(usize, usize)>> = HashMap::new();
    let mut parts: Vec<_> = parts.into_iter().collect();
    parts.sort_unstable_by_key(|(mesh, _)| *mesh);
    for (mesh, parts) in parts {
        for part in parts {
            let material = table.material_index(document, part.material, &part.mesh.name)?;
            stored.entry(mesh).or_default().push((scene.meshes.len(), material));
            scene.meshes.push(part.mesh);
        }
    }
    for placement in placements {
        let stored = stored.get(&placement.mesh).map_or(&[][..], Vec::as_slice);
        if (scene.instances.len() + stored.len()) as u64 > document.limits.nodes {
            let found = format!("more than {} placed primitives", document.limits.nodes);
            return Err(document.error("nodes", found, format!("at most {}", document.limits.nodes)));
        }
        scene.instances.extend(stored.iter().map(|&(mesh, material)| Instance {
            name: placement.name.clone(),
            mesh,
            material,
            world_from_local: placement.world_from_local,
        }));
    }
    Ok(())
}

fn warn_about_ignored(root: &json::Root, warnings: &mut Warnings) {
    if !root.animations.is_empty() {
        warnings.add("animations", format!("{} animations are ignored", root.animations.len()));
    }
    if !root.skins.is_empty() {
        warnings
            .add("skins", format!("{} skins are ignored: meshes stand in their rest pose", root.skins.len()));
    }
}
