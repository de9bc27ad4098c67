//! Procedural shapes: unit-sized, with normals, texture coordinates and tangents.
//!
//! Each is a mesh of counter-clockwise triangles seen from outside (closed shapes) or from above
//! (open ones). On each, u runs to the right and v down as one looks at the surface, so that an
//! image on it reads the right way round. Tessellation counts are clamped to the range that each
//! function states.

mod bezier;
mod grid;
mod solids;
mod surfaces;
mod teapot;

pub use bezier::bezier_patch;
pub use solids::{cuboid, cylinder};
pub use surfaces::{plane, saddle, sphere, superellipsoid, torus};
pub use teapot::teapot;

use crate::Mesh;

/// The names that [`by_name`] knows.
pub const NAMES: [&str; 9] =
    ["sphere", "plane", "torus", "cylinder", "saddle", "box", "superellipsoid", "bezier_patch", "teapot"];

/// A shape by its name in scene files, with a tessellation that looks smooth from near; `None`
/// if the name is not in [`NAMES`].
pub fn by_name(name: &str) -> Option<Mesh> {
    Some(match name {
        "sphere" => sphere(64),
        "plane" => plane(1),
        "torus" => torus(0.3, 64),
        "cylinder" => cylinder(96),
        "saddle" => saddle(64),
        "box" => cuboid(),
        "superellipsoid" => superellipsoid(0.4, 0.4, 64),
        "bezier_patch" => bezier_patch("bezier_patch", &bezier::WAVE, 32),
        "teapot" => teapot(12),
        _ => return None,
    })
}
