//! The reference image of a scene: a CPU path tracer on obvhs, with the variance of each pixel.

pub mod film;
mod settings;

pub use film::{Film, Identity, Merge, fingerprint};
pub use settings::{Lobe, PixelFilter, Settings};
