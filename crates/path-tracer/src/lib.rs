//! The reference image of a scene: a CPU path tracer on obvhs, with the variance of each pixel.
//!
//! It is the ground truth that the real-time techniques are measured against, and shares no shading
//! code with them. [`PathTracer::new`] prepares a [`scene::Scene`], [`PathTracer::render`] traces a
//! picture of it into a [`Film`], which has the mean of each pixel, the variance of that mean, and
//! sums that merge exactly.
//!
//! ```
//! use std::ops::ControlFlow;
//! use path_tracer::{PathTracer, Settings};
//!
//! let scene = scene::builtin::scene();
//! let camera = scene.camera.unwrap_or_else(|| scene.framing_camera(1.5));
//! let tracer = PathTracer::new(&scene)?;
//! let film = tracer.render(&camera, &Settings::new([24, 16], 2), &|_| ControlFlow::Continue(()))?;
//! assert_eq!((film.mean().len(), film.samples_per_pixel()), (24 * 16, 2));
//! # Ok::<(), path_tracer::Error>(())
//! ```
//!
//! # What is traced
//!
//! Unidirectional path tracing with next-event estimation and multiple importance sampling (Veach
//! 1997): at every surface one direction of the environment, one point of the emitting triangles,
//! and every lamp (of more than eight, eight at random) are tried. Russian roulette ends paths without
//! bias. Random numbers are Philox's, a pure function of (pixel, sample, dimension, seed), and sums
//! are integers, so that a film is the same to the last bit on any number of threads and in any
//! partition of its samples.
//!
//! - Materials: glTF's metallic-roughness with clear coat, or another [`Lobe`] for the specular part;
//!   bilinear textures with their transforms and wrap modes; normal maps; alpha masks; blending as
//!   transparency by chance; emission; height maps as dense triangles.
//! - Lights: the environment; emitting triangles; `KHR_lights_punctual`'s points, spots and directional
//!   lights, the last with an angular diameter if they have one.
//! - Camera: a pinhole with a [`PixelFilter`].
//!
//! # What is approximated
//!
//! - Light that would be reflected more than [`Settings::max_bounces`] times is missing.
//! - Surfaces are the triangles they are made of. Where the triangles of a curved surface are large,
//!   light that grazes them shows their edges. Interpolated and mapped normals tilt the reflectance;
//!   what would go below the triangle is mirrored up, so that no energy is lost, and a normal that
//!   faces away from the viewer is bent until it does not, as the compositor does. Neither is
//!   reciprocal.
//! - Back faces of single-sided materials are not there for any ray, as the compositor culls them.
//! - Coats and dielectrics reflect, and nothing refracts: what blends is thin.
//! - Distant discs are seen in reflections, but not by the camera: the compositor has no picture of
//!   them either.
//! - Points and spots have no size: mirrors do not show them. Light that a mirror throws onto a matt
//!   surface (a caustic) is found by chance only where its source is large, and is missing for points.
//! - Occlusion textures are ignored, except by [`Lobe::DiffusedEnvironment`], whose technique has
//!   nothing else.
//! - Textures are looked up at their full resolution.
//!
//! # Limits
//!
//! At most [`MAX_TRIANGLES`] triangles as placed; instances are not shared. Corners are rounded to 2^-24 of the scene's
//! extent about its middle, and everything after that is f64: rays neither meet the surface they
//! leave nor slip between triangles with a common edge, in scenes from 1e-3 m to 1e6 m, however far
//! from the world's origin.
//!
//! # Where to look
//!
//! `integrator.rs` is a path on one page; `world.rs` is what a ray finds; `geometry.rs` where it finds
//! it; `bsdf.rs` how that reflects. The tests are the proof: `tests/energy.rs` (furnaces),
//! `tests/light.rs` (closed forms), `tests/materials.rs`, `tests/reproducible.rs`,
//! `tests/robustness.rs`, and a chi-squared test beside every sampler.

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
