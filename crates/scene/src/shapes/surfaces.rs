//! Shapes that are one smooth surface over u and v.

use glam::Vec3;

use super::grid::{Point, cells, half_turn_sin_cos, surface, turn_rad};
use crate::Mesh;
use crate::mesh::unit;

/// A sphere of radius 1 around the origin, of `segments` (3..=1024) rows from pole to pole and
/// twice as many columns. u runs counter-clockwise seen from above and begins at +Z.
pub fn sphere(segments: u32) -> Mesh {
    let rows = cells(segments, 3);
    surface("sphere", 2 * rows, rows, |u, v| {
        let (sin_azimuth, cos_azimuth) = turn_rad(u).sin_cos();
        let (sin_polar, cos_polar) = half_turn_sin_cos(v);
        let normal = Vec3::new(sin_polar * sin_azimuth, cos_polar, sin_polar * cos_azimuth);
        Point { position: normal, normal, tangent: Vec3::new(cos_azimuth, 0.0, -sin_azimuth) }
    })
}

/// A square of 2 x 2 in the plane y = 0 that faces +Y, of `segments` (1..=1024) cells a side. u
/// runs along +X and v along +Z.
pub fn plane(segments: u32) -> Mesh {
    let count = cells(segments, 1);
    surface("plane", count, count, |u, v| Point {
        position: Vec3::new(2.0 * u - 1.0, 0.0, 2.0 * v - 1.0),
        normal: Vec3::Y,
        tangent: Vec3::X,
    })
}

/// A torus around the Y axis of outer radius 1, whose tube has the radius `tube_radius`
/// (0.01..=0.49), of `segments` (3..=1024) cells around the tube and twice as many around the
/// axis. v begins at the top of the tube and runs over the outside.
pub fn torus(tube_radius: f32, segments: u32) -> Mesh {
    let tube = tube_radius.clamp(0.01, 0.49);
    let rows = cells(segments, 3);
    surface("torus", 2 * rows, rows, |u, v| {
        let (sin_axis, cos_axis) = turn_rad(u).sin_cos();
        let (sin_tube, cos_tube) = turn_rad(v).sin_cos();
        let outward = Vec3::new(sin_axis, 0.0, cos_axis);
        let normal = outward * sin_tube + Vec3::Y * cos_tube;
        Point {
            position: outward * (1.0 - tube) + normal * tube,
            normal,
            tangent: Vec3::new(cos_axis, 0.0, -sin_axis),
        }
    })
}

/// The saddle y = (x^2 - z^2) / 2 over -1..1 in x and z, seen from above, of `segments`
/// (1..=1024) cells a side: a surface of negative curvature.
pub fn saddle(segments: u32) -> Mesh {
    let count = cells(segments, 1);
    surface("saddle", count, count, |u, v| {
        let (x, z) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        Point {
            position: Vec3::new(x, (x * x - z * z) / 2.0, z),
            normal: Vec3::new(-x, 1.0, z).normalize(),
            tangent: Vec3::new(1.0, x, 0.0),
        }
    })
}

/// A superellipsoid of half-extent 1, of `segments` (4..=1024) rows from pole to pole and twice
/// as many columns. `east_west` shapes the outline seen from above and `north_south` the one
/// seen from the side, each 0.1 (a box) over 1 (round) to 2 (an octahedron's straight edges).
pub fn superellipsoid(east_west: f32, north_south: f32, segments: u32) -> Mesh {
    let around = east_west.clamp(0.1, 2.0);
    let along = north_south.clamp(0.1, 2.0);
    // A multiple of four, so that rows and columns lie on the planes of symmetry.
    let rows = cells(segments, 4).next_multiple_of(4);
    surface("superellipsoid", 2 * rows, rows, |u, v| {
        let (sin_azimuth, cos_azimuth) = evenly_around(u, around);
        let (sin_polar, cos_polar) = evenly_along(v, along);
        let position = Vec3::new(
            power(sin_polar, along) * power(sin_azimuth, around),
            power(cos_polar, along),
            power(sin_polar, along) * power(cos_azimuth, around),
        );
        // The normal of a superellipsoid is a point of its dual, of the exponents 2 - e.
        let dual = Vec3::new(
            power(sin_polar, 2.0 - along) * power(sin_azimuth, 2.0 - around),
            power(cos_polar, 2.0 - along),
            power(sin_polar, 2.0 - along) * power(cos_azimuth, 2.0 - around),
        );
        let normal = unit(dual).unwrap_or(Vec3::Y);
        Point { position, normal, tangent: Vec3::new(cos_azimuth, 0.0, -sin_azimuth) }
    })
}

/// |x|^exponent with the sign of x.
fn power(x: f32, exponent: f32) -> f32 {
    x.abs().powf(exponent).copysign(x)
}

/// Sine and cosine of the parameter angle whose point (power(sin), power(cos)) lies in the
/// direction u turns: rows of equal u would crowd at the corners of a box-like shape.
fn evenly_around(u: f32, exponent: f32) -> (f32, f32) {
    let (sin, cos) = snapped(turn_rad(u).sin_cos());
    parameter_of(sin, cos, exponent)
}

/// The same from pole to pole.
fn evenly_along(v: f32, exponent: f32) -> (f32, f32) {
    let (sin, cos) = snapped(half_turn_sin_cos(v));
    parameter_of(sin, cos, exponent)
}

/// Rounding errors next to 0 set to 0, since a small power makes them large.
fn snapped((sin, cos): (f32, f32)) -> (f32, f32) {
    let snap = |x: f32| if x.abs() < 1e-6 { 0.0 } else { x };
    (snap(sin), snap(cos))
}

/// The unit vector (s, c) for which (power(s, e), power(c, e)) points along (sin, cos).
fn parameter_of(sin: f32, cos: f32, exponent: f32) -> (f32, f32) {
    let (s, c) = (power(sin, exponent.recip()), power(cos, exponent.recip()));
    let length = s.hypot(c);
    (s / length, c / length)
}
