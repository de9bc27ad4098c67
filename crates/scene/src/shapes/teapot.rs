//! A teapot-like pot of Bezier patches: our own control points, after no existing model.
//!
//! Body and lid are one profile turned about the Y axis; spout and handle are tubes in the plane
//! z = 0. Each of the three is a stack of strips, each strip four patches around.

use glam::{Vec2, Vec3};

use super::bezier::{Patch, patch_point};
use super::grid::{Point, cells, surface};
use crate::Mesh;

/// A ring of control points is an ellipse around `centre` with the half-axes `from` (where u
/// begins) and `side` (a quarter turn on).
#[derive(Clone, Copy)]
struct Ring {
    centre: Vec3,
    from: Vec3,
    side: Vec3,
}

/// Four rings make a strip; consecutive strips share a ring.
type Strip = [Ring; 4];

/// A pot with lid, spout and handle that stands on the plane y = 0 around the Y axis: 1.02 high
/// and from x = -1.06 (handle) to x = 1.08 (spout). Each patch has `segments` (2..=64)
/// cells a side. Body, spout and handle are each closed and reach into one another.
pub fn teapot(segments: u32) -> Mesh {
    let segments = cells(segments, 2).min(64);
    let mut mesh = Mesh { name: "teapot".into(), ..Mesh::default() };
    for part in [strips(&body()), strips(&spout()), strips(&handle())] {
        let count = part.len() as f32;
        for (index, strip) in part.iter().enumerate() {
            let mut piece = surface("", 4 * segments, segments, |u, v| strip_point(strip, u, v));
            // v runs once over the whole part.
            piece.uvs.iter_mut().for_each(|uv| uv.y = (index as f32 + uv.y) / count);
            mesh.append(&piece);
        }
    }
    mesh
}

/// The strips of a list of rings; the list's length is a multiple of three, plus one.
fn strips(rings: &[Ring]) -> Vec<Strip> {
    rings.windows(4).step_by(3).filter_map(|window| Strip::try_from(window).ok()).collect()
}

/// A point of a strip with u once around it.
fn strip_point(strip: &Strip, u: f32, v: f32) -> Point {
    let quarter = (4.0 * u).floor().clamp(0.0, 3.0);
    patch_point(&quarter_patch(strip, quarter as usize), 4.0 * u - quarter, v)
}

/// The patch over one quarter of a strip.
fn quarter_patch(strip: &Strip, quarter: usize) -> Patch {
    /// Length of the handles of a cubic that is nearest to a quarter circle.
    const HANDLE: f32 = 0.552_284_8;
    strip.map(|ring| {
        let axes = [ring.from, ring.side, -ring.from, -ring.side];
        let (start, end) = (axes[quarter], axes[(quarter + 1) % 4]);
        [start, start + end * HANDLE, end + start * HANDLE, end].map(|offset| ring.centre + offset)
    })
}

/// The profile from the knob of the lid to the middle of the bottom, as (radius, y).
fn body() -> Vec<Ring> {
    const PROFILE: [(f32, f32); 28] = [
        (0.0, 1.02), // The knob.
        (0.095, 1.02),
        (0.125, 0.93),
        (0.062, 0.875),
        (0.03, 0.847), // The lid, up to its edge.
        (0.22, 0.83),
        (0.37, 0.765),
        (0.378, 0.757), // The groove between lid and rim.
        (0.376, 0.748),
        (0.384, 0.748),
        (0.396, 0.772), // The rim.
        (0.436, 0.768),
        (0.442, 0.735),
        (0.57, 0.69), // The belly.
        (0.74, 0.55),
        (0.72, 0.34),
        (0.704, 0.172),
        (0.55, 0.11),
        (0.43, 0.07),
        (0.405, 0.06), // The foot.
        (0.44, 0.03),
        (0.43, 0.0),
        (0.39, 0.0),
        (0.39, 0.03),
        (0.34, 0.03),
        (0.22, 0.03), // The bottom.
        (0.11, 0.03),
        (0.0, 0.03),
    ];
    let ring = |(radius, y): (f32, f32)| Ring {
        centre: Vec3::Y * y,
        from: Vec3::Z * radius,
        side: Vec3::X * radius,
    };
    PROFILE.map(ring).to_vec()
}

/// A ring of a tube in the plane z = 0 between two points of that plane; `half_width` along z is
/// positive for a tube that runs towards -X with `from` on top, negative towards +X.
fn tube_ring(from: (f32, f32), to: (f32, f32), half_width: f32) -> Ring {
    let (from, to) = (Vec2::from(from), Vec2::from(to));
    Ring {
        centre: from.midpoint(to).extend(0.0),
        from: ((from - to) / 2.0).extend(0.0),
        side: Vec3::Z * half_width,
    }
}

/// A point as a ring: the closed end of a tube.
fn tip(x: f32, y: f32) -> Ring {
    tube_ring((x, y), (x, y), 0.0)
}

/// From inside the belly to the lip, and back into the mouth.
fn spout() -> Vec<Ring> {
    vec![
        tip(0.5, 0.33),
        tube_ring((0.5, 0.4), (0.5, 0.26), -0.07),
        tube_ring((0.5, 0.48), (0.5, 0.16), -0.15),
        tube_ring((0.56, 0.5), (0.58, 0.13), -0.17),
        tube_ring((0.84, 0.5), (0.92, 0.13), -0.17),
        tube_ring((0.78, 0.66), (0.92, 0.42), -0.075),
        tube_ring((0.9, 0.76), (0.985, 0.67), -0.058),
        tube_ring((0.93, 0.785), (1.01, 0.73), -0.053),
        tube_ring((0.95, 0.8), (1.04, 0.755), -0.055),
        tube_ring((0.975, 0.815), (1.08, 0.765), -0.06),
        tube_ring((0.98, 0.81), (1.07, 0.77), -0.055),
        tube_ring((0.96, 0.775), (1.02, 0.745), -0.045),
        tube_ring((0.935, 0.72), (0.965, 0.695), -0.03),
        tube_ring((0.925, 0.70), (0.95, 0.68), -0.02),
        tube_ring((0.925, 0.695), (0.94, 0.68), -0.01),
        tip(0.93, 0.685),
    ]
}

/// From the shoulder out, down and back into the belly; `from` is the outer side.
fn handle() -> Vec<Ring> {
    vec![
        tip(-0.46, 0.6),
        tube_ring((-0.46, 0.62), (-0.46, 0.58), 0.02),
        tube_ring((-0.46, 0.65), (-0.46, 0.56), 0.05),
        tube_ring((-0.52, 0.665), (-0.52, 0.57), 0.06),
        tube_ring((-0.78, 0.74), (-0.76, 0.645), 0.06),
        tube_ring((-1.05, 0.75), (-0.95, 0.66), 0.055),
        tube_ring((-1.06, 0.48), (-0.975, 0.465), 0.05),
        tube_ring((-1.066, 0.32), (-0.988, 0.35), 0.048),
        tube_ring((-0.92, 0.2), (-0.88, 0.28), 0.048),
        tube_ring((-0.6, 0.17), (-0.6, 0.25), 0.05),
        tube_ring((-0.56, 0.168), (-0.56, 0.25), 0.05),
        tube_ring((-0.56, 0.19), (-0.56, 0.23), 0.02),
        tip(-0.56, 0.21),
    ]
}
