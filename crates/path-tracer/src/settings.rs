//! What a person chooses about a picture.

use std::ops::Range;

use crate::{
    Error,
    film::{MAX_SAMPLES_PER_PIXEL, MAX_SIDE},
};

/// How a picture is traced. Together with the scene and the camera it decides every bit of the
/// result.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Width and height in pixels, each 1..=[`MAX_SIDE`].
    pub size: [u32; 2],
    /// Which samples of every pixel; not empty. `0..n` is a whole picture of n samples a pixel;
    /// disjoint ranges can be traced apart and merged to the same bits.
    pub samples: Range<u32>,
    /// Other seeds give independent pictures.
    pub seed: u64,
    /// How often light is reflected at most: 0 shows what emits, 1 adds direct light, and so on.
    /// What later reflections would bring is missing from the picture.
    pub max_bounces: u32,
    /// What the specular part of every material is.
    pub lobe: Lobe,
    /// Whether surfaces stand in each other's way. Without occlusion the picture is the
    /// *far field*: at the first surface that the camera sees, the integral of its reflectance
    /// over the environment and the lights, as if nothing else were there. Its shading normal is
    /// taken as it is, directions below that normal's horizon bring nothing, and emissive
    /// triangles light nothing. It is what environment-map techniques approximate.
    pub occlusion: bool,
    /// How samples lie in a pixel.
    pub pixel_filter: PixelFilter,
}

impl Settings {
    /// A path-traced picture: GGX, at most 16 bounces, box filter, samples `0..samples_per_pixel`,
    /// seed 0.
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

    /// Refuses what cannot be traced, before memory is taken for it.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let refuse = |setting: &str, found: String, expected: String| {
            Err(Error::new("settings", setting, found, expected))
        };
        if self.size.iter().any(|side| !(1..=MAX_SIDE).contains(side)) {
            let [width, height] = self.size;
            return refuse("size", format!("{width} x {height}"), format!("1 to {MAX_SIDE} pixels a side"));
        }
        if self.samples.is_empty() {
            let Range { start, end } = self.samples;
            return refuse("samples", format!("{start}..{end}"), "at least one sample".into());
        }
        if self.samples.len() as u64 > u64::from(MAX_SAMPLES_PER_PIXEL) {
            let expected = format!("at most {MAX_SAMPLES_PER_PIXEL} a pixel");
            return refuse("samples", self.samples.len().to_string(), expected);
        }
        if let PixelFilter::Gaussian { sigma_pixels } = self.pixel_filter
            && !(0.0..=16.0).contains(&sigma_pixels)
        {
            return refuse(
                "sigma_pixels of the pixel filter",
                sigma_pixels.to_string(),
                "0 to 16 pixels".into(),
            );
        }
        Ok(())
    }
}

/// What the specular part of a material is. The diffuse part is Lambert's in each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Lobe {
    /// glTF's: GGX.
    #[default]
    Ggx,
    /// Blinn's lobe, normalised, with the material's exponent.
    Blinn,
    /// Phong's cone of the glossy-planes technique, with the material's spread.
    PhongCone,
    /// The lobe that the diffuse-envmap technique gives its environment.
    DiffusedEnvironment,
}

/// How the samples of a pixel are spread; every sample has weight 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PixelFilter {
    /// All at the pixel's centre, as a rasteriser samples.
    Point,
    /// Uniformly over the pixel's square.
    Box,
    /// Normally distributed around the centre, not truncated.
    Gaussian {
        /// Standard deviation along x and along y, 0..=16 pixels; 0.5 looks natural.
        sigma_pixels: f32,
    },
}
