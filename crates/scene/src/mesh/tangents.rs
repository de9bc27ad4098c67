//! Tangents by `MikkTSpace`, the space that normal maps are baked in.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec3, Vec4};

use super::{Mesh, unit};

/// A corner is compared with its vertex and the newest copies of that, as many as this. Without a
/// bound, a fan of triangles that all disagree would take quadratic time; with it, some corners get
/// a copy though an old one agrees.
const MOST_COMPARED: usize = 32;

impl Mesh {
    /// Gives a mesh with texture coordinates and normals its tangents: unit length, orthogonal
    /// to the normal, `w` either 1 or -1.
    ///
    /// Tangents that are there already are kept, and repaired where they are not usable. New
    /// ones are those of `MikkTSpace`, with `w` as glTF defines it; a vertex whose triangles
    /// disagree is split. Where texture coordinates are degenerate any direction orthogonal to
    /// the normal is taken. A mesh without texture coordinates ends without tangents.
    pub fn fill_tangents(&mut self) {
        let count = self.positions.len();
        if self.uvs.len() != count || self.normals.len() != count {
            self.tangents.clear();
            return;
        }
        if self.tangents.len() != count {
            self.tangents = vec![Vec4::ZERO; count];
            self.generate();
        }
        for (tangent, normal) in self.tangents.iter_mut().zip(&self.normals) {
            *tangent = orthonormal(*tangent, *normal);
        }
    }

    /// Runs `MikkTSpace` and distributes its tangents, which belong to corners, to vertices.
    fn generate(&mut self) {
        let count = self.positions.len();
        if self.triangles.as_flattened().iter().any(|&index| index as usize >= count) {
            return;
        }
        let corners = vec![None; self.triangles.len() * 3];
        let mut faces = Faces { mesh: self, corners };
        // Its only error is a face that is no triangle, and there is none.
        if generate_tangents(&mut faces).is_err() {
            return;
        }
        let corners = faces.corners;
        self.assign(&corners);
    }

    /// Gives each corner's vertex the corner's tangent. The first corner of a vertex decides;
    /// corners that disagree with the copies of their vertex so far get a new copy. Returns the
    /// number of comparisons.
    fn assign(&mut self, corners: &[Option<Vec4>]) -> usize {
        // The newest copy of each vertex, and of each copy the one before: a list through one array.
        let mut next_copy: Vec<Option<u32>> = vec![None; self.positions.len()];
        let mut assigned = vec![false; self.positions.len()];
        let mut comparisons = 0;
        for (corner, tangent) in corners.iter().enumerate() {
            let Some(tangent) = *tangent else { continue };
            let (triangle, place) = (corner / 3, corner % 3);
            let original = self.triangles[triangle][place];
            let first = original as usize;
            if !assigned[first] {
                assigned[first] = true;
                self.tangents[first] = tangent;
                continue;
            }
            let copies = std::iter::successors(Some(original), |copy| next_copy[*copy as usize]);
            let agreeing = copies.take(MOST_COMPARED).find(|copy| {
                comparisons += 1;
                agree(self.tangents[*copy as usize], tangent)
            });
            self.triangles[triangle][place] = agreeing.unwrap_or_else(|| {
                let copy = self.copy_vertex(first, tangent);
                next_copy.push(next_copy[first]);
                next_copy[first] = Some(copy);
                copy
            });
        }
        comparisons
    }

    /// Appends a copy of a vertex with another tangent, and returns its index.
    fn copy_vertex(&mut self, vertex: usize, tangent: Vec4) -> u32 {
        let copy = self.positions.len() as u32;
        self.positions.push(self.positions[vertex]);
        self.normals.push(self.normals[vertex]);
        self.uvs.push(self.uvs[vertex]);
        self.tangents.push(tangent);
        copy
    }
}

/// Whether two tangents may share a vertex: within about a tenth of a degree, and of one hand.
fn agree(a: Vec4, b: Vec4) -> bool {
    a.w * b.w > 0.0 && a.truncate().dot(b.truncate()) > 0.999_998
}

/// The tangent made unit and orthogonal to the normal; any such direction where that fails.
fn orthonormal(tangent: Vec4, normal: Vec3) -> Vec4 {
    let direction = unit(tangent.truncate())
        .map(|tangent| tangent - normal * normal.dot(tangent))
        // A tangent along the normal leaves only rounding errors behind.
        .filter(|rejected| rejected.length_squared() > 1e-6)
        .and_then(unit)
        .unwrap_or_else(|| unit(normal).unwrap_or(Vec3::Y).any_orthonormal_vector());
    direction.extend(if tangent.w < 0.0 { -1.0 } else { 1.0 })
}

/// A mesh as `MikkTSpace` reads it, and the tangent of each corner as it comes back.
struct Faces<'a> {
    mesh: &'a Mesh,
    corners: Vec<Option<Vec4>>,
}

impl Faces<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }
}

impl Geometry for Faces<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        finite(self.mesh.positions[self.vertex(face, corner)].to_array())
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        finite(self.mesh.normals[self.vertex(face, corner)].to_array())
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        finite(self.mesh.uvs[self.vertex(face, corner)].to_array())
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let Some(space) = space else { return };
        let [x, y, z, w] = space.tangent_encoded();
        // MikkTSpace takes v to run up the image, glTF down: the hand is the other one.
        self.corners[face * 3 + corner] = Some(Vec4::new(x, y, z, -w));
    }
}

/// Zero in place of NaN and infinity, which would spread to neighbours.
fn finite<const N: usize>(values: [f32; N]) -> [f32; N] {
    values.map(|value| if value.is_finite() { value } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    /// A fan of triangles around vertex 0, and tangents for its corners: those at the middle turn
    /// by an angle from triangle to triangle.
    fn fan(count: usize, turn_rad: f32) -> (Mesh, Vec<Option<Vec4>>) {
        let rim = 0..count as u32 * 2;
        let mut mesh = Mesh { positions: vec![Vec3::ZERO], ..Mesh::default() };
        mesh.positions.extend(rim.map(|vertex| Vec3::new(1.0, vertex as f32, 0.0)));
        let vertices = mesh.positions.len();
        mesh.normals = vec![Vec3::Z; vertices];
        mesh.uvs = vec![Vec2::ZERO; vertices];
        mesh.tangents = vec![Vec4::ZERO; vertices];
        mesh.triangles = (0..count as u32).map(|fin| [0, 2 * fin + 1, 2 * fin + 2]).collect();
        let tangent = |fin: usize| {
            let (sin, cos) = (fin as f32 * turn_rad).sin_cos();
            Some(Vec4::new(cos, sin, 0.0, 1.0))
        };
        (mesh, (0..count).flat_map(|fin| [tangent(fin), tangent(0), tangent(0)]).collect())
    }

    fn assert_each_corner_has_its_tangent(mesh: &Mesh, corners: &[Option<Vec4>]) {
        for (vertex, tangent) in mesh.triangles.as_flattened().iter().zip(corners) {
            assert!(agree(mesh.tangents[*vertex as usize], tangent.unwrap()));
            assert!(mesh.positions[*vertex as usize].is_finite());
        }
    }

    #[test]
    fn corners_that_agree_share_a_copy() {
        // Quarter turns: four tangents, whatever the number of triangles.
        let (mut mesh, corners) = fan(4000, std::f32::consts::FRAC_PI_2);
        let vertices = mesh.positions.len();
        mesh.assign(&corners);
        assert_eq!(mesh.positions.len(), vertices + 3);
        assert_each_corner_has_its_tangent(&mesh, &corners);
    }

    #[test]
    fn a_slow_turn_does_not_drift_from_the_first_corner() {
        // Each step agrees with the one before, the last not with the first.
        let (mut mesh, corners) = fan(1000, 1e-3);
        mesh.assign(&corners);
        assert_each_corner_has_its_tangent(&mesh, &corners);
    }

    #[test]
    fn the_work_is_linear_where_all_corners_disagree() {
        let count = 20_000;
        // The golden angle: no two tangents of a few thousand are near each other.
        let (mut mesh, corners) = fan(count, 2.399_963);
        let comparisons = mesh.assign(&corners);
        assert!(comparisons > 0 && comparisons <= MOST_COMPARED * count, "{comparisons}");
        assert_each_corner_has_its_tangent(&mesh, &corners);
    }
}
