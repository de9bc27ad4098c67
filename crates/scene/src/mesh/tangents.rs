//! Tangents by `MikkTSpace`, the space that normal maps are baked in.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec3, Vec4};

use super::{Mesh, unit};

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
    /// corners that disagree with all copies of their vertex so far get a new copy.
    fn assign(&mut self, corners: &[Option<Vec4>]) {
        // The next copy of each vertex, as a list through this array.
        let mut next_copy: Vec<Option<u32>> = vec![None; self.positions.len()];
        let mut assigned = vec![false; self.positions.len()];
        for (corner, tangent) in corners.iter().enumerate() {
            let Some(tangent) = *tangent else { continue };
            let (triangle, place) = (corner / 3, corner % 3);
            let mut vertex = self.triangles[triangle][place];
            while assigned[vertex as usize] && !agree(self.tangents[vertex as usize], tangent) {
                vertex = next_copy[vertex as usize].unwrap_or_else(|| {
                    let copy = self.copy_vertex(vertex as usize);
                    next_copy[vertex as usize] = Some(copy);
                    next_copy.push(None);
                    assigned.push(false);
                    copy
                });
            }
            self.tangents[vertex as usize] = tangent;
            assigned[vertex as usize] = true;
            self.triangles[triangle][place] = vertex;
        }
    }

    /// Appends a copy of a vertex and returns its index.
    fn copy_vertex(&mut self, vertex: usize) -> u32 {
        let copy = self.positions.len() as u32;
        self.positions.push(self.positions[vertex]);
        self.normals.push(self.normals[vertex]);
        self.uvs.push(self.uvs[vertex]);
        self.tangents.push(self.tangents[vertex]);
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
