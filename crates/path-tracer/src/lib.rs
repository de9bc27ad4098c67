//! The reference image of a scene: a CPU path tracer on obvhs, with the variance of each pixel.

#[allow(dead_code)]
mod bsdf;
#[cfg(test)]
mod chi_squared;
#[allow(dead_code)]
mod environment;
#[allow(dead_code)]
mod frame;
mod settings;

pub use settings::Lobe;
