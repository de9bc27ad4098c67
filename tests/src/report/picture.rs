//! Pictures of a report, as PNG.

use crate::technique::{Failure, Shown};
use compositor::{ToneCurve, tone_map};
use image::{ExtendedColorType, ImageEncoder as _, codecs::png::PngEncoder};
use image_error::Image;

/// A PNG of sRGB bytes, three a pixel from the top row.
pub(crate) fn png(width: usize, height: usize, rgb: &[u8]) -> Result<Vec<u8>, Failure> {
    if rgb.len() != 3 * width * height {
        return Err(format!("a picture of {width} x {height} pixels was given {} bytes", rgb.len()).into());
    }
    let mut file = Vec::new();
    PngEncoder::new(&mut file).write_image(rgb, width as u32, height as u32, ExtendedColorType::Rgb8)?;
    Ok(file)
}

/// A PNG of radiance as a person sees it. What is not finite is magenta.
pub(crate) fn radiance_png(image: &Image, exposure_ev: f32) -> Result<Vec<u8>, Failure> {
    let shown = |pixel: &[f32; 3]| {
        if pixel.iter().all(|value| value.is_finite()) {
            tone_map::display_srgb8(*pixel, exposure_ev, ToneCurve::PbrNeutral)
        } else {
            [255, 0, 255]
        }
    };
    let rgb: Vec<u8> = image.pixels().iter().flat_map(shown).collect();
    png(image.width(), image.height(), &rgb)
}

/// A PNG, and its width and height in pixels.
pub(crate) fn shown_png(shown: &Shown) -> Result<(Vec<u8>, [usize; 2]), Failure> {
    match shown {
        Shown::Radiance { image, exposure_ev } => {
            Ok((radiance_png(image, *exposure_ev)?, [image.width(), image.height()]))
        }
        Shown::Display { width, height, rgb } => Ok((png(*width, *height, rgb)?, [*width, *height])),
    }
}

/// Stops that bring the median luminance of the pixels that count to a middle grey of 0.18; 0
/// where they are black.
pub(crate) fn automatic_exposure(image: &Image, mask: Option<&[bool]>) -> f32 {
    let counts = |index: usize| mask.is_none_or(|mask| mask.get(index) == Some(&true));
    let luminance = |[r, g, b]: [f32; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let mut values: Vec<f32> = image
        .pixels()
        .iter()
        .enumerate()
        .filter(|&(index, _)| counts(index))
        .map(|(_, &pixel)| luminance(pixel))
        .filter(|value| value.is_finite() && *value > 0.0)
        .collect();
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).map_or(0.0, |median| (0.18 / median).log2().clamp(-20.0, 20.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_what_counts_becomes_grey() {
        let image = Image::row(vec![[1000.0; 3], [0.72; 3], [0.0; 3], [f32::NAN; 3]]).unwrap();
        let exposure = automatic_exposure(&image, Some(&[false, true, true, true]));
        assert!((exposure + 2.0).abs() < 1e-5, "{exposure}");
        let black = Image::row(vec![[0.0; 3]]).unwrap();
        assert!(automatic_exposure(&black, None) == 0.0);
    }

    #[test]
    fn bytes_that_do_not_fit_are_refused() {
        assert!(png(2, 2, &[0; 11]).is_err());
        let file = png(2, 1, &[255, 0, 0, 0, 0, 255]).unwrap();
        let back = image::load_from_memory(&file).unwrap().to_rgb8();
        assert_eq!((back.dimensions(), back.into_raw()), ((2, 1), vec![255, 0, 0, 0, 0, 255]));
    }
}
