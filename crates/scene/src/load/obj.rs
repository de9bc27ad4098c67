//! Wavefront OBJ with its MTL materials.
//!
//! tobj parses both, from texts that were checked and made plain: see `scan` and `library`.
//! Polygons are triangulated, missing normals made smooth, and v turned over (OBJ counts it from
//! the bottom row). There is one mesh for each object and material.

mod library;
mod materials;
mod polygon;
mod scan;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use glam::{Vec2, Vec3};

use super::warnings::Warnings;
use super::{repair, short_name};
use crate::{Error, Instance, Limits, Mesh, Scene};

/// The material of faces that name none.
const NO_MATERIAL: &str = "default";

/// Loads an OBJ from memory.
///
/// `name` stands in messages; `folder` is where its material libraries and textures may be read
/// from. What is wrong with those is a warning; an error about the OBJ itself names the line.
pub fn obj_from_bytes(
    name: &str,
    bytes: &[u8],
    folder: Option<&Path>,
    limits: &Limits,
) -> Result<Scene, Error> {
    let mut warnings = Warnings::new(name);
    let mut scan = scan::scan(name, &String::from_utf8_lossy(bytes), limits, &mut warnings)?;
    let (library, textures) = library::read(name, &scan, folder, limits, &mut warnings)?;
    let (models, parsed) = parse(name, &scan.take_text(), &library)?;
    let vertices = models.iter().map(|model| model.mesh.positions.len() as u64 / 3).sum::<u64>();
    if vertices > limits.vertices {
        let expected = format!("at most {} (Limits::vertices)", limits.vertices);
        return Err(Error::new(name, "the whole file", format!("{vertices} vertices"), expected));
    }
    let mut scene = Scene {
        name: short_name(name),
        materials: parsed.into_iter().map(materials::material).collect(),
        textures,
        ..Scene::default()
    };
    for (model, group) in models.into_iter().zip(scan.groups) {
        let mut mesh = mesh(group.object, &model.mesh);
        for message in repair::repair(&mut mesh) {
            warnings.add(format!("object {:?}", mesh.name), message);
        }
        scene.instances.push(Instance {
            name: mesh.name.clone(),
            mesh: scene.meshes.len(),
            // The library has every material that a group names.
            material: model.mesh.material_id.unwrap_or_default(),
            world_from_local: glam::Mat4::IDENTITY,
        });
        scene.meshes.push(mesh);
    }
    scene.warnings = warnings.into_vec();
    Ok(scene)
}

/// The keyword of a line and what follows it, without comment.
fn keyword_and_rest(line: &str) -> (&str, &str) {
    let line = line.split('#').next().unwrap_or_default().trim();
    let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    (keyword, rest.trim())
}

/// The name of an object or material. It is cut, so that a long one takes little memory where
/// many meshes bear it.
fn name(rest: &str) -> String {
    if rest.is_empty() { NO_MATERIAL.to_owned() } else { rest.chars().take(200).collect() }
}

/// Runs tobj on texts that were checked: one model for each group of faces, and all materials.
fn parse(name: &str, obj: &str, library: &str) -> Result<(Vec<tobj::Model>, Vec<tobj::Material>), Error> {
    let options = tobj::LoadOptions { single_index: true, ..tobj::LoadOptions::default() };
    let load_library = |_: &Path| tobj::load_mtl_buf(&mut library.as_bytes());
    // No text from the scan is known to make tobj panic. Should one do so, that is an error of
    // this file and not the end of the program.
    let loaded = catch_unwind(AssertUnwindSafe(|| {
        let (models, materials) = tobj::load_obj_buf(&mut obj.as_bytes(), &options, load_library)?;
        Ok((models, materials?))
    }));
    let found = match loaded {
        Ok(Ok(loaded)) => return Ok(loaded),
        Ok(Err(error)) => tobj::LoadError::to_string(&error),
        Err(_) => "a panic of the parser".to_owned(),
    };
    Err(Error::new(name, "the whole file", found, "an OBJ that tobj can parse"))
}

/// A mesh of tobj's flat arrays.
fn mesh(name: String, parsed: &tobj::Mesh) -> Mesh {
    let positions = vectors(&parsed.positions);
    let mut mesh = Mesh {
        name,
        triangles: triangles(parsed, &positions),
        positions,
        normals: vectors(&parsed.normals),
        uvs: parsed.texcoords.as_chunks().0.iter().map(|&[u, v]| Vec2::new(u, 1.0 - v)).collect(),
        ..Mesh::default()
    };
    // Corners without a uv or normal got one that the repair recognises; here no corner has any.
    if mesh.uvs.iter().all(|uv| uv.is_nan()) {
        mesh.uvs.clear();
    }
    if mesh.normals.iter().all(|normal| *normal == Vec3::ZERO) {
        mesh.normals.clear();
    }
    mesh
}

fn vectors(numbers: &[f32]) -> Vec<Vec3> {
    numbers.as_chunks::<3>().0.iter().map(|vector| Vec3::from(*vector)).collect()
}

/// All faces as triangles.
fn triangles(parsed: &tobj::Mesh, positions: &[Vec3]) -> Vec<[u32; 3]> {
    // No number of corners is stated where all faces are triangles.
    if parsed.face_arities.is_empty() {
        return parsed.indices.as_chunks().0.to_vec();
    }
    let mut triangles = Vec::with_capacity(parsed.indices.len());
    let mut rest = parsed.indices.as_slice();
    for &corner_count in &parsed.face_arities {
        let Some((face, others)) = rest.split_at_checked(corner_count as usize) else { break };
        rest = others;
        let corners: Vec<Vec3> =
            face.iter().filter_map(|&vertex| positions.get(vertex as usize).copied()).collect();
        let vertex = |corner: usize| face.get(corner).copied().unwrap_or_default();
        triangles.extend(polygon::triangulate(&corners).into_iter().map(|triangle| triangle.map(vertex)));
    }
    triangles
}
