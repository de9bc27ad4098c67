//! Triangle meshes and their placement.

mod tangents;

use std::collections::HashMap;

use glam::{Mat4, Vec2, Vec3, Vec4};

/// An indexed triangle mesh in local space. All vertex arrays have the same length, except
/// that `uvs` and `tangents` are empty where the surface has no texture coordinates.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The mesh's name in its file, or the shape's name.
    pub name: String,
    /// Vertex positions in metres.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals.
    pub normals: Vec<Vec3>,
    /// Unit tangents along +u in `xyz`, and the sign of the bitangent in `w`
    /// (bitangent = w * cross(normal, tangent)), as in glTF: the bitangent runs along -v, which
    /// is up in the image.
    pub tangents: Vec<Vec4>,
    /// Texture coordinates; (0, 0) is the first texel of the first row.
    pub uvs: Vec<Vec2>,
    /// Counter-clockwise corners, as indices into the vertex arrays.
    pub triangles: Vec<[u32; 3]>,
}

/// A mesh with a material, placed in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The node's name.
    pub name: String,
    /// Index into `Scene::meshes`.
    pub mesh: usize,
    /// Index into `Scene::materials`.
    pub material: usize,
    /// World from local space; affine, and possibly mirroring.
    pub world_from_local: Mat4,
}

impl Mesh {
    /// Gives every vertex without a usable normal (none at all, not finite, or zero) a smooth
    /// one, and makes the others unit length.
    ///
    /// A smooth normal is the mean of the normals of the adjoining triangles, weighted by their
    /// angle at the vertex; vertices at the same position count as one, so that a seam of the
    /// texture coordinates does not show. Degenerate triangles do not count; where no other is
    /// left, the normal is +Y.
    pub fn fill_normals(&mut self) {
        self.normals.truncate(self.positions.len());
        self.normals.resize(self.positions.len(), Vec3::ZERO);
        if self.normals.iter().all(|normal| unit(*normal).is_some()) {
            self.normals.iter_mut().for_each(|normal| *normal = unit(*normal).unwrap_or(Vec3::Y));
            return;
        }
        let sums = self.angle_weighted_normals();
        for (normal, position) in self.normals.iter_mut().zip(&self.positions) {
            let smooth = || unit(sums.get(&position_key(*position)).copied()?);
            *normal = unit(*normal).or_else(smooth).unwrap_or(Vec3::Y);
        }
    }

    /// Replaces all normals by those of the triangles: no vertex is shared between triangles
    /// afterwards. Tangents are dropped, since they were orthogonal to the old normals.
    ///
    /// Triangles with an index out of range are removed.
    pub fn set_flat_normals(&mut self) {
        let has_uvs = self.uvs.len() == self.positions.len();
        let mut flat = Self { name: std::mem::take(&mut self.name), ..Self::default() };
        for triangle in &self.triangles {
            let Some(corners) = self.corners(*triangle) else { continue };
            let normal = triangle_normal(corners).unwrap_or(Vec3::Y);
            let first = flat.positions.len() as u32;
            flat.positions.extend(corners);
            flat.normals.extend([normal; 3]);
            if has_uvs {
                flat.uvs.extend(triangle.map(|index| self.uvs[index as usize]));
            }
            flat.triangles.push([first, first + 1, first + 2]);
        }
        *self = flat;
    }

    /// Adds another mesh's vertices and triangles. Texture coordinates and tangents survive only
    /// where both meshes have them.
    pub fn append(&mut self, other: &Self) {
        let first = self.positions.len() as u32;
        let keep_uvs = self.uvs.len() == self.positions.len() && other.uvs.len() == other.positions.len();
        let keep_tangents =
            self.tangents.len() == self.positions.len() && other.tangents.len() == other.positions.len();
        self.positions.extend_from_slice(&other.positions);
        self.normals.extend_from_slice(&other.normals);
        self.uvs.extend_from_slice(&other.uvs);
        self.tangents.extend_from_slice(&other.tangents);
        if !keep_uvs {
            self.uvs.clear();
        }
        if !keep_tangents {
            self.tangents.clear();
        }
        self.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|index| index + first)));
    }

    /// The smallest box around all finite positions, as its least and greatest corner; `None`
    /// where there are none.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.positions.iter().filter(|position| position.is_finite()).fold(None, |bounds, &position| {
            let (least, greatest) = bounds.unwrap_or((position, position));
            Some((least.min(position), greatest.max(position)))
        })
    }

    /// The corners of a triangle, if all its indices are in range.
    fn corners(&self, triangle: [u32; 3]) -> Option<[Vec3; 3]> {
        let [a, b, c] = triangle.map(|index| self.positions.get(index as usize).copied());
        Some([a?, b?, c?])
    }

    /// For each position the sum of the adjoining triangles' normals times their angles.
    fn angle_weighted_normals(&self) -> HashMap<[u32; 3], Vec3> {
        let mut sums = HashMap::with_capacity(self.positions.len());
        for &triangle in &self.triangles {
            let Some(corners) = self.corners(triangle) else { continue };
            let Some(normal) = triangle_normal(corners) else { continue };
            for corner in 0..3 {
                let [here, next, last] = [0, 1, 2].map(|step| corners[(corner + step) % 3]);
                let angle = match (unit(next - here), unit(last - here)) {
                    (Some(to_next), Some(to_last)) => to_next.angle_between(to_last),
                    _ => 0.0,
                };
                *sums.entry(position_key(here)).or_insert(Vec3::ZERO) += normal * angle;
            }
        }
        sums
    }
}

/// A position's bits, where -0 and 0 are the same.
fn position_key(position: Vec3) -> [u32; 3] {
    position.to_array().map(|value| if value == 0.0 { 0 } else { value.to_bits() })
}

/// The unit normal of a counter-clockwise triangle, unless it is degenerate.
fn triangle_normal([a, b, c]: [Vec3; 3]) -> Option<Vec3> {
    unit(unit(b - a)?.cross(unit(c - a)?))
}

/// The vector at length 1, for any length that is neither 0 nor infinite: dividing by the
/// largest component first keeps the square of the length in range.
pub(crate) fn unit(vector: Vec3) -> Option<Vec3> {
    let largest = vector.abs().max_element();
    if !vector.is_finite() || largest == 0.0 {
        return None;
    }
    Some((vector / largest).normalize()).filter(|vector| vector.is_finite())
}
