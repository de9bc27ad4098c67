//! From a surface over u and v to a mesh.

use glam::{Vec2, Vec3};

use crate::Mesh;
use crate::mesh::unit;

/// A point of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) position: Vec3,
    /// Outward, unit.
    pub(super) normal: Vec3,
    /// Along +u; made unit and orthogonal to the normal by the mesh.
    pub(super) tangent: Vec3,
}

/// The number of cells along u or v, within what a shape allows.
pub(super) fn cells(asked: u32, least: u32) -> usize {
    asked.clamp(least, 1024) as usize
}

/// Angle in radians of u in 0..=1 around a full turn, with 1 exactly at 0, so that the two
/// sides of the seam meet.
pub(super) fn turn_rad(u: f32) -> f32 {
    std::f32::consts::TAU * (u % 1.0)
}

/// Sine and cosine of v in 0..=1 over a half turn, with a sine of exactly 0 at both ends.
pub(super) fn half_turn_sin_cos(v: f32) -> (f32, f32) {
    let (sin, cos) = (std::f32::consts::PI * v).sin_cos();
    (if v <= 0.0 || v >= 1.0 { 0.0 } else { sin }, cos)
}

/// A mesh of `columns` x `rows` cells of a surface over u and v in 0..=1, with u to the right and
/// v down as seen from outside.
///
/// A row of vertices that all lie at one point (a pole) gets one vertex for each column, in the
/// middle of it, and one triangle for each cell instead of two.
pub(super) fn surface(name: &str, columns: usize, rows: usize, point: impl Fn(f32, f32) -> Point) -> Mesh {
    let mut mesh = Mesh { name: name.into(), ..Mesh::default() };
    let lines: Vec<Line> = (0..=rows)
        .map(|row| {
            let v = row as f32 / rows as f32;
            let is_pole =
                (1..=columns).all(|column| at(&point, column, columns, v) == at(&point, 0, columns, v));
            let line = Line { first: mesh.positions.len() as u32, is_pole };
            let (count, shift) = if is_pole { (columns, 0.5) } else { (columns + 1, 0.0) };
            for column in 0..count {
                let u = (column as f32 + shift) / columns as f32;
                push_vertex(&mut mesh, point(u, v), Vec2::new(u, v));
            }
            line
        })
        .collect();
    for pair in lines.windows(2) {
        let [upper, lower] = pair else { continue };
        for column in 0..columns as u32 {
            let (a, b) = (upper.first + column, upper.first + column + 1);
            let (c, d) = (lower.first + column, lower.first + column + 1);
            if !lower.is_pole {
                mesh.triangles.push([a, c, d]);
            }
            if !upper.is_pole {
                mesh.triangles.push([a, if lower.is_pole { c } else { d }, b]);
            }
        }
    }
    mesh
}

/// One row of vertices.
struct Line {
    first: u32,
    is_pole: bool,
}

fn at(point: &impl Fn(f32, f32) -> Point, column: usize, columns: usize, v: f32) -> Vec3 {
    point(column as f32 / columns as f32, v).position
}

/// Adds a vertex whose bitangent runs along -v.
pub(super) fn push_vertex(mesh: &mut Mesh, point: Point, uv: Vec2) {
    let tangent = unit(point.tangent - point.normal * point.normal.dot(point.tangent))
        .unwrap_or_else(|| point.normal.any_orthonormal_vector());
    mesh.positions.push(point.position);
    mesh.normals.push(point.normal);
    mesh.tangents.push(tangent.extend(1.0));
    mesh.uvs.push(uv);
}
