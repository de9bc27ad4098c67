//! Bicubic Bezier patches.

use glam::Vec3;

use super::grid::{Point, cells, surface};
use crate::Mesh;
use crate::mesh::unit;

/// Control points of a bicubic patch: rows along v from the top, in each row along u to the right.
pub(super) type Patch = [[Vec3; 4]; 4];

/// A rolling square of 2 x 2, for `shape = "bezier_patch"`.
pub(super) const WAVE: Patch = [
    wave_row(-1.0, [0.5, -0.6, 0.4, 0.1]),
    wave_row(-1.0 / 3.0, [-0.4, 0.9, -0.5, 0.3]),
    wave_row(1.0 / 3.0, [0.3, -0.5, 0.9, -0.6]),
    wave_row(1.0, [-0.1, 0.5, -0.4, 0.4]),
];

const fn wave_row(z: f32, heights: [f32; 4]) -> [Vec3; 4] {
    [
        Vec3::new(-1.0, heights[0], z),
        Vec3::new(-1.0 / 3.0, heights[1], z),
        Vec3::new(1.0 / 3.0, heights[2], z),
        Vec3::new(1.0, heights[3], z),
    ]
}

/// The bicubic Bezier patch of 4 x 4 control points (rows along v, in each row along u), of
/// `segments` (1..=1024) cells a side. Its front is where u runs to the right and v down.
pub fn bezier_patch(name: &str, control: &[[Vec3; 4]; 4], segments: u32) -> Mesh {
    let count = cells(segments, 1);
    surface(name, count, count, |u, v| patch_point(control, u, v))
}

/// Position, normal and u direction of a patch. Where an edge is drawn together to one point its
/// derivative is 0; there the derivative next to it is taken.
pub(super) fn patch_point(control: &Patch, u: f32, v: f32) -> Point {
    let (position, ..) = derivatives(control, u, v);
    // Away from the edge by little against the patch, by much against f32's precision.
    let inward = |x: f32| x.clamp(1e-3, 1.0 - 1e-3);
    let (_, mut along_u, mut along_v) = derivatives(control, u, v);
    if along_u.length_squared() < 1e-12 || along_v.length_squared() < 1e-12 {
        (_, along_u, along_v) = derivatives(control, inward(u), inward(v));
    }
    Point { position, normal: unit(along_v.cross(along_u)).unwrap_or(Vec3::Y), tangent: along_u }
}

/// Position and the derivatives along u and v.
fn derivatives(control: &Patch, u: f32, v: f32) -> (Vec3, Vec3, Vec3) {
    let rows = control.map(|row| cubic(row, u));
    let (position, along_v) = cubic(rows.map(|(value, _)| value), v);
    let (along_u, _) = cubic(rows.map(|(_, slope)| slope), v);
    (position, along_u, along_v)
}

/// Value and derivative of a cubic Bezier curve. Weights of differences to the nearer end make it
/// exact at both ends, and where all four points are one.
fn cubic(control: [Vec3; 4], t: f32) -> (Vec3, Vec3) {
    let [a, b, c, d] = control;
    let s = 1.0 - t;
    let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
    let end = if t < 0.5 { a } else { d };
    let value = end + control.iter().zip(weights).map(|(&point, weight)| (point - end) * weight).sum::<Vec3>();
    let slope = ((b - a) * (s * s) + (c - b) * (2.0 * s * t) + (d - c) * (t * t)) * 3.0;
    (value, slope)
}
