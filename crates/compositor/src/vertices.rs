//! Vertices and instances as compositor/vertex.wgsl reads them.

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Mat4};

/// One vertex of compositor/vertex.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct Vertex {
    pub(crate) position: [f32; 3],
    pub(crate) normal: [f32; 3],
    pub(crate) tangent: [f32; 4],
    pub(crate) uv: [f32; 2],
}

impl Vertex {
    pub(crate) const ATTRIBUTES: [wgpu::VertexAttribute; 4] =
        wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x4, 3 => Float32x2];
}

/// One vertex of `DisplacedIn` of compositor/shadow-casters.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct DisplacedVertex {
    pub(crate) position: [f32; 3],
    pub(crate) normal: [f32; 3],
    pub(crate) uv: [f32; 2],
    pub(crate) height_m: f32,
}

impl DisplacedVertex {
    pub(crate) const ATTRIBUTES: [wgpu::VertexAttribute; 4] =
        wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Float32];
}

/// The directions of u and v of a vertex on a surface with a height map: the first two thirds of
/// a [`horizon_shadow::VertexFrame`].
pub(crate) const FRAME_ATTRIBUTES: [wgpu::VertexAttribute; 2] =
    wgpu::vertex_attr_array![10 => Float32x3, 11 => Float32x3];

/// One instance of compositor/vertex.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct InstanceVertex {
    world_from_local_rows: [[f32; 4]; 3],
    world_from_normal_columns: [[f32; 4]; 3],
}

impl InstanceVertex {
    pub(crate) const ATTRIBUTES: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
        4 => Float32x4, 5 => Float32x4, 6 => Float32x4, 7 => Float32x4, 8 => Float32x4, 9 => Float32x4];

    /// `number` tells instances apart; above 65535 they share one.
    pub(crate) fn new(world_from_local: Mat4, number: u32) -> Self {
        let rows = world_from_local.transpose();
        let normals = world_from_normal(Mat3::from_mat4(world_from_local));
        let sign = if is_mirrored(world_from_local) { -1.0 } else { 1.0 };
        Self {
            world_from_local_rows: [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.to_array()),
            world_from_normal_columns: [
                normals.x_axis.extend(sign).to_array(),
                normals.y_axis.extend(number.min(65535) as f32).to_array(),
                normals.z_axis.extend(0.0).to_array(),
            ],
        }
    }
}

/// Whether an instance turns counter-clockwise triangles into clockwise ones.
pub(crate) fn is_mirrored(world_from_local: Mat4) -> bool {
    let matrix = Mat3::from_mat4(world_from_local);
    let scale = matrix.to_cols_array().iter().fold(0.0_f32, |scale, x| scale.max(x.abs()));
    scale > 0.0 && (matrix * (1.0 / scale)).determinant() < 0.0
}

/// Takes normals to the world, up to a positive factor: the cofactors of the matrix with the sign
/// of its determinant, which stay finite where a scale of 0 leaves no inverse.
fn world_from_normal(matrix: Mat3) -> Mat3 {
    let scale = matrix.to_cols_array().iter().fold(0.0_f32, |scale, x| scale.max(x.abs()));
    if scale <= 0.0 {
        return Mat3::IDENTITY;
    }
    let Mat3 { x_axis: x, y_axis: y, z_axis: z } = matrix * (1.0 / scale);
    let cofactors = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if x.dot(y.cross(z)) < 0.0 { cofactors * -1.0 } else { cofactors }
}
