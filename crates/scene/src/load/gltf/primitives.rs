//! Turns primitives into meshes.

use ::gltf::json;
use glam::{Vec2, Vec3, Vec4};
use json::mesh::{Mode, Semantic};
use json::validation::Checked;

use super::Document;
use super::accessors::Accessor;
use crate::load::repair;
use crate::{Error, Mesh};

/// A primitive with triangles that a placed mesh has.
pub(super) struct Source<'a> {
    /// Index of its mesh in the file.
    pub(super) mesh: usize,
    /// The primitive itself.
    pub(super) primitive: &'a json::mesh::Primitive,
    mode: Mode,
    place: String,
    name: String,
}

/// (place, message) pairs, in order.
type Notes = Vec<(String, String)>;

/// The primitives of the placed meshes. Vertices and triangles are counted against the limits
/// here, before any of them is read; points and lines are left out with a warning.
pub(super) fn sources<'a>(
    document: &Document<'a>,
    placed: &[usize],
    warnings: &mut crate::load::warnings::Warnings,
) -> Result<Vec<Source<'a>>, Error> {
    let mut sources = Vec::new();
    let (mut vertices, mut triangles) = (0_u64, 0_u64);
    for (mesh_index, mesh) in
        placed.iter().filter_map(|&index| Some((index, document.root.meshes.get(index)?)))
    {
        for (index, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("meshes[{mesh_index}].primitives[{index}]");
            let Checked::Valid(mode) = primitive.mode else {
                return Err(document.error(place + ".mode", "an unknown number", "0 to 6"));
            };
            if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
                warnings.add(place, "points and lines are left out");
                continue;
            }
            let Some(position) = attribute(primitive, &Semantic::Positions) else {
                warnings.add(place, "a primitive without positions is left out");
                continue;
            };
            let vertex_count = Accessor::open(document, position, &place)?.count;
            let corner_count = match primitive.indices {
                Some(indices) => Accessor::open(document, indices, &place)?.count,
                None => vertex_count,
            };
            let triangle_count = if mode == Mode::Triangles { corner_count / 3 } else { corner_count };
            vertices = vertices.saturating_add(vertex_count);
            triangles = triangles.saturating_add(triangle_count);
            check_total(document, &place, "vertices", vertices, document.limits.vertices)?;
            check_total(document, &place, "triangles", triangles, document.limits.triangles)?;
            let name = mesh.name.clone().unwrap_or_else(|| format!("mesh {mesh_index}"));
            sources.push(Source { mesh: mesh_index, primitive, mode, place, name });
        }
    }
    Ok(sources)
}

fn check_total(document: &Document, place: &str, what: &str, total: u64, limit: u64) -> Result<(), Error> {
    if total <= limit {
        return Ok(());
    }
    Err(document.error(place, format!("{total} {what} so far"), format!("at most {limit} (Limits::{what})")))
}

fn attribute(primitive: &json::mesh::Primitive, semantic: &Semantic) -> Option<json::Index<json::Accessor>> {
    let found =
        primitive.attributes.iter().find(|(key, _)| matches!(key, Checked::Valid(key) if key == semantic));
    found.map(|(_, index)| *index)
}

/// Reads one primitive. Normals and tangents are made where they are missing or unusable.
pub(super) fn read(document: &Document, source: &Source) -> Result<(Mesh, Notes), Error> {
    let Source { primitive, place, .. } = source;
    let mut notes = Notes::new();
    let positions: Vec<Vec3> = match attribute(primitive, &Semantic::Positions) {
        Some(index) => to_vectors(Accessor::open(document, index, place)?.vectors()?),
        None => Vec::new(),
    };
    if let Some(vertex) = positions.iter().position(|position| !position.is_finite()) {
        let found = positions.get(vertex).map_or_else(String::new, ToString::to_string);
        return Err(document.error(format!("{place}, vertex {vertex}"), found, "a finite position"));
    }
    let vertex_count = positions.len();
    let triangles = read_triangles(document, source, vertex_count, &mut notes)?;
    let mut mesh = Mesh { name: source.name.clone(), positions, triangles, ..Mesh::default() };
    if let Some(normals) = read_attribute(document, source, &Semantic::Normals, vertex_count)? {
        mesh.normals = to_vectors::<3, Vec3>(normals);
    }
    if let Some(uvs) = read_attribute(document, source, &Semantic::TexCoords(0), vertex_count)? {
        mesh.uvs = to_vectors::<2, Vec2>(uvs);
    }
    // Given tangents belong to given normals: without those they are made anew.
    if !mesh.normals.is_empty()
        && !mesh.uvs.is_empty()
        && let Some(tangents) = read_attribute(document, source, &Semantic::Tangents, vertex_count)?
    {
        mesh.tangents = to_vectors::<4, Vec4>(tangents);
    }
    note_ignored(primitive, place, &mut notes);
    if mesh.normals.is_empty() {
        // As glTF asks; a smooth surface brings its normals along.
        mesh.set_flat_normals();
    }
    notes.extend(repair::repair(&mut mesh).into_iter().map(|message| (place.clone(), message)));
    Ok((mesh, notes))
}

fn to_vectors<const N: usize, V: From<[f32; N]>>(numbers: Vec<[f32; N]>) -> Vec<V> {
    numbers.into_iter().map(V::from).collect()
}

/// An attribute with one element per vertex, if the primitive has it.
fn read_attribute<const N: usize>(
    document: &Document,
    source: &Source,
    semantic: &Semantic,
    vertex_count: usize,
) -> Result<Option<Vec<[f32; N]>>, Error> {
    let Some(index) = attribute(source.primitive, semantic) else { return Ok(None) };
    let place = format!("{}.attributes.{}", source.place, semantic.to_string());
    let accessor = Accessor::open(document, index, &place)?;
    if accessor.count != vertex_count as u64 {
        let found = format!("{} elements", accessor.count);
        return Err(document.error(place, found, format!("{vertex_count}, one per vertex")));
    }
    accessor.vectors().map(Some)
}

fn note_ignored(primitive: &json::mesh::Primitive, place: &str, notes: &mut Notes) {
    let has = |wanted: fn(&Semantic) -> bool| {
        primitive.attributes.keys().any(|key| matches!(key, Checked::Valid(semantic) if wanted(semantic)))
    };
    if has(|semantic| matches!(semantic, Semantic::Colors(_))) {
        notes.push((place.to_owned(), "vertex colours are ignored".to_owned()));
    }
    if has(|semantic| matches!(semantic, Semantic::Joints(_) | Semantic::Weights(_))) {
        notes.push((place.to_owned(), "skinning is ignored".to_owned()));
    }
    if primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()) {
        notes.push((place.to_owned(), "morph targets are ignored".to_owned()));
    }
}

/// Triangles of a list, strip or fan; every index is below `vertex_count`.
fn read_triangles(
    document: &Document,
    source: &Source,
    vertex_count: usize,
    notes: &mut Notes,
) -> Result<Vec<[u32; 3]>, Error> {
    let corners = match source.primitive.indices {
        Some(index) => Accessor::open(document, index, &source.place)?.indices()?,
        None => (0..vertex_count as u32).collect(),
    };
    if let Some((position, corner)) =
        corners.iter().enumerate().find(|(_, corner)| **corner as usize >= vertex_count)
    {
        let place = format!("{}.indices, element {position}", source.place);
        return Err(document.error(
            place,
            format!("vertex {corner}"),
            format!("a vertex below {vertex_count}"),
        ));
    }
    if source.mode == Mode::Triangles && corners.len() % 3 != 0 {
        let message = format!("{} corners at the end make no triangle and are left out", corners.len() % 3);
        notes.push((source.place.clone(), message));
    }
    Ok(triangles_of(source.mode, &corners))
}

fn triangles_of(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match (mode, corners) {
        (Mode::TriangleStrip, _) => {
            let triples = corners.windows(3).filter_map(|triple| <[u32; 3]>::try_from(triple).ok());
            // Every other triangle of a strip is wound the other way.
            let turn =
                |(index, [a, b, c]): (usize, [u32; 3])| if index % 2 == 0 { [a, b, c] } else { [a, c, b] };
            triples.enumerate().map(turn).collect()
        }
        (Mode::TriangleFan, [first, rest @ ..]) => {
            rest.iter().zip(rest.iter().skip(1)).map(|(&a, &b)| [a, b, *first]).collect()
        }
        _ => corners.chunks_exact(3).filter_map(|triple| triple.try_into().ok()).collect(),
    }
}
