//! Where a height map lies on a mesh: for each vertex the directions of u and v and the second
//! fundamental form, and from them the typical texel, the range of curvature and the azimuths that
//! a light needs.
//!
//! The form is found after Rusinkiewicz, *Estimating Curvatures and Their Derivatives on Triangle
//! Meshes* (2004): for each triangle the least squares of how its corners' normals differ along its
//! edges, averaged at each vertex by the part of the triangle that is nearest to it. Three numbers
//! per vertex interpolate where principal directions cannot: every point of a sphere is umbilic.

mod azimuths;
mod extent;
mod places;
mod triangle;

use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec3};

pub use azimuths::needed_azimuths;
pub use extent::surface;

use crate::Error;
use places::Places;
use triangle::Triangle;

/// How the texture coordinates lie on the surface at a vertex, and how it is curved there, in the
/// mesh's own space. All zero where nothing can be said: at a vertex without triangles, or where
/// the texture coordinates of all of them have no area.
///
/// In world space, for a linear part M of world from local: M `along_u`, M `along_v`, and
/// `second_form` / |M^-T n| with the local unit normal n. A mirroring M needs nothing else.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct VertexFrame {
    /// Change of the position per unit of u, metres; orthogonal to the vertex normal.
    pub along_u: [f32; 3],
    /// Change of the position per unit of v, metres; orthogonal to the vertex normal.
    pub along_v: [f32; 3],
    /// The second fundamental form II(u,u), II(u,v), II(v,v) in those, metres; positive where the
    /// surface is convex as seen from where the normal points.
    pub second_form: [f32; 3],
}

/// The frame of each vertex of a mesh of `triangles` (indices into the three arrays, which are of
/// equal length). Positions are in metres; normals need not be of unit length, and where one is 0 or
/// not finite the mean of the triangles' stands in for it.
///
/// Any mesh will do. Vertices at one position whose normals agree within 2.5 degrees count as one
/// place, so that a seam of the texture coordinates does not show in the curvature; nor in the
/// directions, where the texture coordinates of both sides differ by whole numbers. A sharp edge,
/// whose normals differ, keeps the curvatures of both its sides. Edges of one, three or more
/// triangles are nothing special. Errors fall with the square of the triangles' edges, and at open
/// borders and other seams, which see one side alone, with the edges themselves. Triangles without area, or with a number that is not finite, are
/// left out; so are, for the directions of u and v alone, those whose texture coordinates have no
/// area. Where triangles of both orientations of uv share a vertex, the directions are those of the
/// orientation with the larger area: split such vertices to have both.
///
/// [`Error::NoUvs`] where there is not one texture coordinate for each position, and
/// [`Error::Value`] for another number of normals or for an index out of range.
///
/// ```
/// # use horizon_shadow::frames::vertex_frames;
/// // A unit square in the plane y = 0 that shows the whole map.
/// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0]];
/// let uvs = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
/// let frames = vertex_frames(&positions, &[[0.0, 1.0, 0.0]; 4], &uvs, &[[0, 2, 1], [1, 2, 3]])?;
/// assert_eq!(frames[0].along_u, [1.0, 0.0, 0.0]);
/// assert_eq!(frames[0].along_v, [0.0, 0.0, 1.0]);
/// assert_eq!(frames[0].second_form, [0.0; 3]);
/// # Ok::<(), horizon_shadow::Error>(())
/// ```
pub fn vertex_frames(
    positions: &[[f32; 3]],
    normals: &[[f32; 3]],
    uvs: &[[f32; 2]],
    triangles: &[[u32; 3]],
) -> Result<Vec<VertexFrame>, Error> {
    check(positions, normals, uvs, triangles)?;
    let normals = usable_normals(positions, normals, triangles);
    let places = Places::new(positions, &normals);
    let mapped = places.mapped(uvs);
    let mut forms = vec![Mean::NONE; places.count];
    // By orientation of the texture coordinates: the mean of two that oppose is neither.
    let mut directions = vec![[Mean::NONE; 2]; mapped.count];
    let mut areas = vec![[0.0; 2]; positions.len()];
    for indices in triangles.iter().map(|indices| indices.map(|index| index as usize)) {
        let Some(triangle) = Triangle::new(indices.map(|index| vector(positions[index]))) else { continue };
        let corner_normals = indices.map(|index| normals[index]);
        let form = triangle.second_form(corner_normals);
        let along_uv = triangle.along_uv(indices.map(|index| uvs[index].map(f64::from)));
        for (corner, &index) in indices.iter().enumerate() {
            let weight = triangle.nearest_areas[corner];
            let bend = triangle.bent_to(corner_normals[corner]);
            if let (Some(place), Some(form)) = (places.of_vertex[index], form) {
                forms[place].add(bend * form * bend.transpose(), weight);
            }
            if let Some((along_uv, orientation)) = along_uv {
                areas[index][orientation] += weight;
                if let Some(mapped) = mapped.of_vertex[index] {
                    directions[mapped][orientation].add(bend * along_uv, weight);
                }
            }
        }
    }
    let of_vertex = |index: usize| {
        let [plain, mirrored] = areas[index];
        let along_uv =
            mapped.of_vertex[index].map(|mapped| directions[mapped][usize::from(plain < mirrored)]);
        let form = places.of_vertex[index].map(|place| forms[place]);
        frame(form.unwrap_or(Mean::NONE).value(), along_uv.unwrap_or(Mean::NONE).value())
    };
    Ok((0..positions.len()).map(of_vertex).collect())
}

/// Everything that cannot be repaired.
fn check(
    positions: &[[f32; 3]],
    normals: &[[f32; 3]],
    uvs: &[[f32; 2]],
    triangles: &[[u32; 3]],
) -> Result<(), Error> {
    if uvs.len() != positions.len() {
        return Err(Error::NoUvs { positions: positions.len(), uvs: uvs.len() });
    }
    if normals.len() != positions.len() {
        return Err(Error::Value {
            what: "the number of normals",
            found: normals.len().to_string(),
            expected: format!("one for each of {} positions", positions.len()),
        });
    }
    match triangles.as_flattened().iter().find(|&&index| index as usize >= positions.len()) {
        None => Ok(()),
        Some(index) => Err(Error::Value {
            what: "an index of a triangle",
            found: index.to_string(),
            expected: format!("less than the number of vertices, {}", positions.len()),
        }),
    }
}

/// The vertex normals at unit length; the mean of the triangles' where a vertex has none, and 0
/// where they have none either.
fn usable_normals(positions: &[[f32; 3]], normals: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<DVec3> {
    let mut usable: Vec<DVec3> = normals.iter().map(|&normal| unit(vector(normal))).collect();
    let is_missing: Vec<bool> = usable.iter().map(|&normal| normal == DVec3::ZERO).collect();
    if !is_missing.contains(&true) {
        return usable;
    }
    for indices in triangles {
        let Some(triangle) = Triangle::new(indices.map(|index| vector(positions[index as usize]))) else {
            continue;
        };
        for index in indices.map(|index| index as usize) {
            if is_missing[index] {
                usable[index] += triangle.normal * triangle.area;
            }
        }
    }
    usable.into_iter().map(unit).collect()
}

/// What the host gets of a vertex: from the second fundamental form as a tensor, and the directions of
/// u and v as columns.
fn frame(form: DMat3, along_uv: DMat3) -> VertexFrame {
    let second_form = along_uv.transpose() * form * along_uv;
    let second_form = DVec3::new(second_form.x_axis.x, second_form.x_axis.y, second_form.y_axis.y);
    let [along_u, along_v, second_form] =
        [along_uv.x_axis, along_uv.y_axis, second_form].map(|values| values.as_vec3().to_array());
    let is_finite = [along_u, along_v, second_form].as_flattened().iter().all(|value| value.is_finite());
    if is_finite { VertexFrame { along_u, along_v, second_form } } else { VertexFrame::default() }
}

/// A weighted mean.
#[derive(Clone, Copy)]
struct Mean {
    sum: DMat3,
    weight: f64,
}

impl Mean {
    const NONE: Self = Self { sum: DMat3::ZERO, weight: 0.0 };

    fn add(&mut self, value: DMat3, weight: f64) {
        self.sum += value * weight;
        self.weight += weight;
    }

    /// 0 where nothing was added.
    fn value(&self) -> DMat3 {
        if self.weight > 0.0 { self.sum * self.weight.recip() } else { DMat3::ZERO }
    }
}

fn vector(values: [f32; 3]) -> DVec3 {
    DVec3::from_array(values.map(f64::from))
}

/// The vector at length 1, or 0 where it has no direction. Lengths of f32 have squares in f64.
fn unit(vector: DVec3) -> DVec3 {
    vector.try_normalize().unwrap_or(DVec3::ZERO)
}
