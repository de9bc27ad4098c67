//! FLIP: the difference that a person sees who flips between two images.
//!
//! [`ldr`] is for images as they are displayed, [`hdr`] for radiance: it takes at each pixel the
//! worst of many exposures. Both are symmetric in what is compared, except that [`hdr`] derives its
//! exposures from the reference alone.
//! Sources, cited in the code by their year and step:
//! - 2020: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild, "FLIP: A Difference
//!   Evaluator for Alternating Images", Proceedings of the ACM on Computer Graphics and Interactive
//!   Techniques 3(2).
//! - 2021: Andersson, Nilsson, Shirley, Akenine-Moller, "Visualizing Errors in Rendered High Dynamic
//!   Range Images", Eurographics short papers.
//!
//! The numbers are those of the authors' own evaluator to 4e-5, and in most pixels to 2e-6; the
//! crate's tests hold them.
//!
//! Two routes lead from the images to the error. Colours are blurred as the eye blurs each opponent
//! channel, and compared in a perceptual space; edges and points are found in the luminance, and
//! where they differ, the difference in colour is raised. Beyond the border the nearest pixel goes
//! on.
//!
//! Pixels that are not finite in both images are black in both for their neighbours' sake, and have
//! no error themselves: see [`ErrorMap::values`]. Negative values count as 0.

mod color;
mod filters;
mod magma;
mod map;
mod tile;
mod tone_mapper;

pub use magma::magma;
pub use map::{ErrorMap, Statistics};
pub use tone_mapper::{Exposures, ToneMapper};

use crate::{Error, Image, image::is_finite};
use rayon::prelude::*;
use tile::{Evaluator, Tile};

/// The usual viewing condition: a display 0.7 m wide with 3840 pixels, seen from 0.7 m.
/// (The published tool takes 67.02 where it is given none.)
pub const PIXELS_PER_DEGREE: f32 = 67.0;

/// The result of [`hdr`].
#[derive(Clone, Debug, PartialEq)]
pub struct Hdr {
    /// The largest error of each pixel at any exposure.
    pub map: ErrorMap,
    /// The exposures that were tried.
    pub exposures: Exposures,
    /// For each pixel the index of the exposure at which its error is largest, the first of equals;
    /// see [`Exposures::stops`]. 0 where there is no error.
    pub exposure_map: Vec<u16>,
}

/// The difference of two displayed images: linear RGB in 0..=1 (see [`Image::from_srgb`]); what
/// lies outside is clamped. `pixels_per_degree` of visual angle is usually [`PIXELS_PER_DEGREE`], and
/// lies in 1..=1000.
///
/// Fails where the sizes differ, where no pixel is finite in both images, and where
/// `pixels_per_degree` is out of range.
pub fn ldr(found: &Image, reference: &Image, pixels_per_degree: f32) -> Result<ErrorMap, Error> {
    let evaluator = evaluator(found, reference, pixels_per_degree)?;
    let displayed = |pixel: [f32; 3]| pixel.map(|value| value.clamp(0.0, 1.0));
    let map = each_tile(found, reference, |tile, size, pixel| {
        let errors =
            evaluator.errors(tile, size, |i| displayed(pixel(found, i)), |i| displayed(pixel(reference, i)));
        errors.into_iter().map(|error| (error, 0)).collect()
    });
    Ok(map.0)
}

/// The difference of two images of radiance in linear RGB, with the tone mapper
/// [`ToneMapper::Aces`] and automatic exposures, as in [`hdr_with`].
pub fn hdr(found: &Image, reference: &Image, pixels_per_degree: f32) -> Result<Hdr, Error> {
    hdr_with(found, reference, pixels_per_degree, ToneMapper::default(), None)
}

/// The difference of two images of radiance in linear RGB: at each pixel the largest [`ldr`] of all
/// `exposures`, each displayed with `tone_mapper` (2021, HDR-FLIP). Without given exposures takes
/// [`Exposures::automatic`] of the reference.
///
/// Fails as [`ldr`] does, where exposures are out of range, and where there are none and the
/// reference is black.
pub fn hdr_with(
    found: &Image,
    reference: &Image,
    pixels_per_degree: f32,
    tone_mapper: ToneMapper,
    exposures: Option<Exposures>,
) -> Result<Hdr, Error> {
    let evaluator = evaluator(found, reference, pixels_per_degree)?;
    let exposures = exposures.map_or_else(|| Exposures::automatic(reference, tone_mapper), Ok)?;
    exposures.check()?;
    let (map, exposure_map) = each_tile(found, reference, |tile, size, pixel| {
        let mut worst = vec![(0.0, 0); tile.rows.len() * tile.columns.len()];
        for index in 0..exposures.count {
            let scale = exposures.stops(index).exp2();
            let displayed = |image, i| tone_mapper.apply(pixel(image, i).map(|value| value.max(0.0) * scale));
            let errors = evaluator.errors(tile, size, |i| displayed(found, i), |i| displayed(reference, i));
            for (worst, error) in worst.iter_mut().zip(errors) {
                if error > worst.0 {
                    *worst = (error, index as u16);
                }
            }
        }
        worst
    });
    Ok(Hdr { map, exposures, exposure_map })
}

/// Checks what both kinds of FLIP need.
fn evaluator(found: &Image, reference: &Image, pixels_per_degree: f32) -> Result<Evaluator, Error> {
    found.check_same_size(reference)?;
    if !(1.0..=1000.0).contains(&pixels_per_degree) {
        let found = f64::from(pixels_per_degree);
        return Err(Error::OutOfRange { name: "pixels per degree", found, expected: "1 to 1000" });
    }
    if !(0..found.pixels().len()).any(|i| is_compared(found, reference, i)) {
        return Err(Error::NothingFinite { pixels: found.pixels().len() });
    }
    Ok(Evaluator::new(f64::from(pixels_per_degree)))
}

fn is_compared(found: &Image, reference: &Image, i: usize) -> bool {
    is_finite(&found.pixels()[i]) && is_finite(&reference.pixels()[i])
}

/// Puts together what `errors` makes of each tile: errors and exposures. It is given the tile, the
/// size of the images, and what reads a pixel of either.
fn each_tile<F>(found: &Image, reference: &Image, errors: F) -> (ErrorMap, Vec<u16>)
where
    F: Fn(&Tile, [usize; 2], &dyn Fn(&Image, usize) -> [f32; 3]) -> Vec<(f32, u16)> + Sync,
{
    let (width, height) = (found.width(), found.height());
    let pixel =
        |image: &Image, i: usize| if is_compared(found, reference, i) { image.pixels()[i] } else { [0.0; 3] };
    let tiles: Vec<_> = Tile::all(width, height)
        .into_par_iter()
        .map(|tile| (errors(&tile, [width, height], &pixel), tile))
        .collect();
    let mut values = vec![f32::NAN; width * height];
    let mut exposures = vec![0; width * height];
    for (errors, tile) in tiles {
        let columns = tile.columns.clone();
        let places = tile.rows.flat_map(|y| columns.clone().map(move |x| y * width + x));
        for (i, (error, exposure)) in places.zip(errors) {
            if is_compared(found, reference, i) {
                values[i] = error;
                exposures[i] = exposure;
            }
        }
    }
    (ErrorMap { width, height, values }, exposures)
}
