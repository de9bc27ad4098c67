//! Wavefront OBJ with its MTL materials.
//!
//! The text is parsed here rather than by the tobj crate: that one panics on short colours and on
//! extreme indices, mixes up corners where only some have a normal, takes lines for triangles,
//! and says nothing about where a file is wrong. Polygons are triangulated, missing normals made
//! smooth, and v turned over (OBJ counts it from the bottom row). There is one mesh for each
//! object and material.

mod materials;
mod parse;
mod polygon;

use std::collections::HashMap;
use std::path::Path;

use glam::{Vec2, Vec3};

use super::warnings::Warnings;
use super::{repair, short_name};
use crate::{Error, Instance, Limits, Mesh, Scene};
use parse::{Face, Source};

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
    let text = String::from_utf8_lossy(bytes);
    let source = parse::parse(name, &text, limits, &mut warnings)?;
    let mut library = materials::load(&source.libraries, folder, limits, &mut warnings);
    let mut builders: Vec<Builder> = Vec::new();
    let mut builder_of: HashMap<(usize, Option<usize>), usize> = HashMap::new();
    let mut vertices = 0_u64;
    for face in &source.faces {
        let index = *builder_of.entry((face.object, face.material)).or_insert_with(|| {
            builders.push(Builder::new(&source, face));
            builders.len() - 1
        });
        let Some(builder) = builders.get_mut(index) else { continue };
        vertices += builder.add(name, &source, face)?;
        let totals =
            [(vertices, "vertices", limits.vertices), (builders.len() as u64, "nodes", limits.nodes)];
        for (total, what, limit) in totals {
            if total > limit {
                let found = format!("{total} {what} so far");
                let expected = format!("at most {limit} (Limits::{what})");
                return Err(Error::new(name, format!("line {}", face.line), found, expected));
            }
        }
    }
    let mut scene = Scene { name: short_name(name), ..Scene::default() };
    for builder in builders {
        let material = library.material_index(builder.material.as_deref(), &mut warnings);
        let mut mesh = builder.finish();
        for message in repair::repair(&mut mesh) {
            warnings.add(format!("object {:?}", mesh.name), message);
        }
        let world_from_local = glam::Mat4::IDENTITY;
        scene.instances.push(Instance {
            name: mesh.name.clone(),
            mesh: scene.meshes.len(),
            material,
            world_from_local,
        });
        scene.meshes.push(mesh);
    }
    scene.materials = library.materials;
    scene.textures = library.textures;
    scene.warnings = warnings.into_vec();
    Ok(scene)
}

/// A mesh that grows face by face.
struct Builder {
    material: Option<String>,
    mesh: Mesh,
    vertex_of_corner: HashMap<[u32; 3], u32>,
}

impl Builder {
    fn new(source: &Source, face: &Face) -> Self {
        let name = source.objects.get(face.object).cloned().unwrap_or_default();
        let material = face.material.and_then(|material| source.materials.get(material)).cloned();
        let mesh = Mesh { name, ..Mesh::default() };
        Self { material, mesh, vertex_of_corner: HashMap::new() }
    }

    /// Adds a polygon and returns how many vertices are new.
    fn add(&mut self, name: &str, source: &Source, face: &Face) -> Result<u64, Error> {
        let before = self.mesh.positions.len();
        let mut polygon = Vec::with_capacity(face.corner_count);
        for &corner in source.corners.iter().skip(face.first_corner).take(face.corner_count) {
            let vertex = match self.vertex_of_corner.get(&corner) {
                Some(&vertex) => vertex,
                None => self.add_vertex(name, source, face, corner)?,
            };
            polygon.push(vertex);
        }
        let positions: Vec<Vec3> =
            polygon.iter().filter_map(|&vertex| self.mesh.positions.get(vertex as usize).copied()).collect();
        let corner = |index: usize| polygon.get(index).copied().unwrap_or_default();
        self.mesh
            .triangles
            .extend(polygon::triangulate(&positions).into_iter().map(|triangle| triangle.map(corner)));
        Ok((self.mesh.positions.len() - before) as u64)
    }

    fn add_vertex(
        &mut self,
        name: &str,
        source: &Source,
        face: &Face,
        corner: [u32; 3],
    ) -> Result<u32, Error> {
        let [position, uv, normal] = corner;
        let out_of_range = |what: &str, index: u32, count: usize| {
            let expected = format!("1 to {count}, of those that the file has");
            Error::new(
                name,
                format!("line {}", face.line),
                format!("{what} {}", u64::from(index) + 1),
                expected,
            )
        };
        let positions = &source.positions;
        let position = *positions
            .get(position as usize)
            .ok_or_else(|| out_of_range("position", position, positions.len()))?;
        // Corners without a uv or normal get one that `finish` and the repair recognise.
        let uv = match source.uvs.get(uv as usize) {
            Some(uv) => Vec2::new(uv.x, 1.0 - uv.y),
            None if uv == parse::NONE => Vec2::NAN,
            None => return Err(out_of_range("texture coordinate", uv, source.uvs.len())),
        };
        let normal = match source.normals.get(normal as usize) {
            Some(normal) => *normal,
            None if normal == parse::NONE => Vec3::ZERO,
            None => return Err(out_of_range("normal", normal, source.normals.len())),
        };
        let vertex = self.mesh.positions.len() as u32;
        self.mesh.positions.push(position);
        self.mesh.uvs.push(uv);
        self.mesh.normals.push(normal);
        self.vertex_of_corner.insert(corner, vertex);
        Ok(vertex)
    }

    /// The mesh, without the arrays in which no corner had anything.
    fn finish(mut self) -> Mesh {
        if self.mesh.uvs.iter().all(|uv| uv.is_nan()) {
            self.mesh.uvs.clear();
        }
        if self.mesh.normals.iter().all(|normal| *normal == Vec3::ZERO) {
            self.mesh.normals.clear();
        }
        self.mesh
    }
}
