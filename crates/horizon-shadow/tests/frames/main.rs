//! Frames of vertices: against surfaces in closed form, on meshes that are broken in every way, and
//! under transforms.

#![allow(missing_docs, reason = "tests")]
#![allow(clippy::float_cmp, reason = "what is exact is compared exactly")]

mod analytic;
mod azimuths;
mod broken;
mod extent;
mod shapes;
mod transforms;

use glam::{DVec3, Vec3};
use horizon_shadow::frames::{VertexFrame, vertex_frames};
use scene::Mesh;

/// What the crate takes of a mesh.
#[derive(Clone)]
struct Arrays {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    triangles: Vec<[u32; 3]>,
}

impl Arrays {
    fn of(mesh: &Mesh) -> Self {
        let array = |v: &Vec<Vec3>| v.iter().map(Vec3::to_array).collect::<Vec<_>>();
        Self {
            positions: array(&mesh.positions),
            normals: array(&mesh.normals),
            uvs: mesh.uvs.iter().map(glam::Vec2::to_array).collect(),
            triangles: mesh.triangles.clone(),
        }
    }

    fn frames(&self) -> Vec<VertexFrame> {
        let frames =
            vertex_frames(&self.positions, &self.normals, &self.uvs, &self.triangles).expect("frames");
        assert!(frames.iter().flat_map(numbers).all(f32::is_finite));
        frames
    }
}

/// The nine numbers of a frame.
fn numbers(frame: &VertexFrame) -> [f32; 9] {
    bytemuck::cast(*frame)
}

/// The largest difference of two frames' directions over their lengths, and of their second forms
/// over the squares of the lengths: 1 / metre.
fn apart(found: &VertexFrame, expected: &VertexFrame) -> [f64; 2] {
    let vector = |v: [f32; 3]| Vec3::from(v).as_dvec3();
    let lengths = [vector(expected.along_u).length(), vector(expected.along_v).length()];
    let along = |found, expected, length: f64| (vector(found) - vector(expected)).length() / length;
    let first = along(found.along_u, expected.along_u, lengths[0]).max(along(
        found.along_v,
        expected.along_v,
        lengths[1],
    ));
    let change = vector(found.second_form) - vector(expected.second_form);
    let squares = DVec3::new(lengths[0] * lengths[0], lengths[0] * lengths[1], lengths[1] * lengths[1]);
    [first, (change / squares).abs().max_element()]
}
