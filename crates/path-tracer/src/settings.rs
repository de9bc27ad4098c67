//! What to render and how.

use std::ops::Range;

/// What decides a picture besides its scene and camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Width and height in pixels, 1..=16384 a side.
    pub size: [u32; 2],
    /// Which samples of every pixel; 0..N is the whole.
    pub samples: Range<u32>,
    /// Seed of the random numbers.
    pub seed: u64,
    /// How often light is reflected at most; 0 shows only what the camera sees emitted.
    pub max_bounces: u32,
    /// What the specular part of a material is.
    pub lobe: Lobe,
    /// Whether things stand in the way beyond the first hit.
    pub occlusion: bool,
    /// How a pixel weighs the picture around its centre.
    pub pixel_filter: PixelFilter,
}

/// The specular part of a material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lobe {
    /// Trowbridge-Reitz.
    #[default]
    Ggx,
    /// Blinn's.
    Blinn,
    /// A Phong cone.
    PhongCone,
    /// That of diffuse-envmap.
    DiffusedEnvironment,
}

/// How a pixel weighs the picture around its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PixelFilter {
    /// Its centre alone.
    Point,
    /// Its area.
    Box,
    /// A Gaussian.
    Gaussian {
        /// Standard deviation in pixels.
        sigma_pixels: f32,
    },
}

impl Settings {
    /// A picture by path tracing.
    pub const fn new(size: [u32; 2], samples_per_pixel: u32) -> Self {
        Self {
            size,
            samples: 0..samples_per_pixel,
            seed: 0,
            max_bounces: 16,
            lobe: Lobe::Ggx,
            occlusion: true,
            pixel_filter: PixelFilter::Box,
        }
    }
}
