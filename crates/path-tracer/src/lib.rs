//! The reference image of a scene: a CPU path tracer on obvhs, with the variance of each pixel.

mod bsdf;
mod camera_rays;
#[cfg(test)]
mod chi_squared;
mod emitters;
mod environment;
pub mod film;
mod frame;
mod geometry;
mod integrator;
mod lamps;
mod random;
mod settings;
mod surface;
mod textures;
mod tracer;
mod world;

pub use film::{Film, Identity, Merge, fingerprint};
pub use geometry::MAX_TRIANGLES;
pub use scene::Error;
pub use settings::{Lobe, PixelFilter, Settings};
pub use tracer::{PathTracer, Progress};
