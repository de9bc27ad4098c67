//! The procedural shapes with their frames in closed form.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};
use horizon_shadow::frames::VertexFrame;
use scene::{Mesh, shapes};

/// A smooth surface over u and v.
pub(crate) struct Shape {
    pub(crate) name: &'static str,
    pub(crate) mesh: fn(u32) -> Mesh,
    /// The frame at u, v.
    pub(crate) frame: fn(f64, f64) -> VertexFrame,
    /// Whether u = 0 is u = 1, and v = 0 is v = 1.
    pub(crate) is_closed: [bool; 2],
}

pub(crate) const TUBE: f64 = 0.3;

pub(crate) const ALL: [Shape; 6] = [
    Shape { name: "plane", mesh: shapes::plane, frame: plane, is_closed: [false; 2] },
    Shape { name: "sphere", mesh: shapes::sphere, frame: sphere, is_closed: [true, false] },
    Shape { name: "cylinder", mesh: wall, frame: cylinder, is_closed: [true, false] },
    Shape { name: "torus", mesh: torus_mesh, frame: torus, is_closed: [true; 2] },
    Shape { name: "saddle", mesh: shapes::saddle, frame: saddle, is_closed: [false; 2] },
    Shape { name: "Bezier patch", mesh: bezier_mesh, frame: bezier, is_closed: [false; 2] },
];

/// A frame from the derivatives of a position and its unit normal.
fn frame(u: DVec3, v: DVec3, second_form: [f64; 3]) -> VertexFrame {
    VertexFrame {
        along_u: u.as_vec3().to_array(),
        along_v: v.as_vec3().to_array(),
        second_form: second_form.map(|x| x as f32),
    }
}

fn plane(_: f64, _: f64) -> VertexFrame {
    frame(DVec3::X * 2.0, DVec3::Z * 2.0, [0.0; 3])
}

/// Its second form is its first.
fn sphere(u: f64, v: f64) -> VertexFrame {
    let ((sin_u, cos_u), (sin_v, cos_v)) = ((TAU * u).sin_cos(), (PI * v).sin_cos());
    frame(
        TAU * sin_v * DVec3::new(cos_u, 0.0, -sin_u),
        PI * DVec3::new(cos_v * sin_u, -sin_v, cos_v * cos_u),
        [TAU * TAU * sin_v * sin_v, 0.0, PI * PI],
    )
}

fn cylinder(u: f64, _: f64) -> VertexFrame {
    let (sin, cos) = (TAU * u).sin_cos();
    frame(TAU * DVec3::new(cos, 0.0, -sin), DVec3::NEG_Y * 2.0, [TAU * TAU, 0.0, 0.0])
}

fn torus(u: f64, v: f64) -> VertexFrame {
    let ((sin_u, cos_u), (sin_v, cos_v)) = ((TAU * u).sin_cos(), (TAU * v).sin_cos());
    let reach = 1.0 - TUBE + TUBE * sin_v;
    frame(
        TAU * reach * DVec3::new(cos_u, 0.0, -sin_u),
        TAU * TUBE * DVec3::new(sin_u * cos_v, -sin_v, cos_u * cos_v),
        [TAU * TAU * reach * sin_v, 0.0, TAU * TAU * TUBE],
    )
}

fn saddle(u: f64, v: f64) -> VertexFrame {
    let (x, z) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let bend = 4.0 / (1.0 + x * x + z * z).sqrt();
    frame(2.0 * DVec3::new(1.0, x, 0.0), 2.0 * DVec3::new(0.0, -z, 1.0), [-bend, 0.0, bend])
}

const CONTROL_HEIGHTS: [[f32; 4]; 4] =
    [[0.3, -0.2, 0.4, 0.1], [-0.4, 0.5, -0.1, 0.3], [0.1, -0.3, 0.6, -0.2], [0.0, 0.4, -0.4, 0.2]];

/// Sheared in its plane, so that u and v are not orthogonal.
fn control() -> [[Vec3; 4]; 4] {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let (x, z) = (column as f32 / 1.5 - 1.0, row as f32 / 1.5 - 1.0);
            Vec3::new(x + 0.4 * z, CONTROL_HEIGHTS[row][column], z)
        })
    })
}

fn bezier_mesh(segments: u32) -> Mesh {
    shapes::bezier_patch("patch", &control(), segments)
}

fn bezier(u: f64, v: f64) -> VertexFrame {
    let weights = |t: f64| {
        let s = 1.0 - t;
        [
            [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
            [-3.0 * s * s, 3.0 * s * s - 6.0 * s * t, 6.0 * s * t - 3.0 * t * t, 3.0 * t * t],
            [6.0 * s, 6.0 * t - 12.0 * s, 6.0 * s - 12.0 * t, 6.0 * t],
        ]
    };
    let (by_u, by_v, control) = (weights(u), weights(v), control());
    let derivative = |u: usize, v: usize| -> DVec3 {
        (0..16).map(|i| control[i / 4][i % 4].as_dvec3() * by_u[u][i % 4] * by_v[v][i / 4]).sum()
    };
    let (u, v) = (derivative(1, 0), derivative(0, 1));
    let normal = v.cross(u).normalize();
    frame(u, v, [derivative(2, 0), derivative(1, 1), derivative(0, 2)].map(|second| -normal.dot(second)))
}

fn torus_mesh(segments: u32) -> Mesh {
    shapes::torus(TUBE as f32, segments)
}

/// The cylinder without its discs, with rows of its own.
fn wall(segments: u32) -> Mesh {
    let mut mesh = shapes::plane(segments);
    for i in 0..mesh.positions.len() {
        let [u, v] = mesh.uvs[i].to_array();
        let (sin, cos) = (std::f32::consts::TAU * (u % 1.0)).sin_cos();
        mesh.normals[i] = Vec3::new(sin, 0.0, cos);
        mesh.positions[i] = Vec3::new(sin, 1.0 - 2.0 * v, cos);
    }
    mesh
}
