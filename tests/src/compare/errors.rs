//! The errors of one picture against one truth.

use super::Errors;
use crate::technique::{CustomMetric, Failure, Metric, TruthImage};
use compositor::{ToneCurve, tone_map};
use image_error::{
    Image,
    flip::{self, ErrorMap, PIXELS_PER_DEGREE},
};

/// What was measured of a picture.
#[derive(Debug)]
pub(crate) struct Measured {
    /// All errors that have a meaning here.
    pub(crate) errors: Errors,
    /// Pixels that count and are not finite.
    pub(crate) non_finite: usize,
    /// FLIP of the tone-mapped pictures; of a table |x - y| / (|y| + mean |y| / 10), 0..=1.
    pub(crate) map: Map,
}

/// An error for each pixel, in the colours of magma.
#[derive(Debug)]
pub(crate) struct Map {
    /// Pixels per row.
    pub(crate) width: usize,
    /// Rows.
    pub(crate) height: usize,
    /// Three bytes a pixel from the top row.
    pub(crate) rgb: Vec<u8>,
}

/// The errors of a picture. With an exposure it is also seen as a person sees it.
pub(crate) fn measure(
    found: &Image,
    truth: &TruthImage,
    custom: &[CustomMetric],
    exposure_ev: Option<f32>,
) -> Result<Measured, Failure> {
    let (chosen, reference) = (masked(found, truth)?, masked(&truth.image, truth)?);
    let numbers = image_error::compare(&chosen, &reference)?;
    let mean = mean_absolute_value(&reference);
    let mut errors = Errors::from([
        (Metric::RelativeMse.name(), numbers.relative_mse),
        (Metric::MeanAbsolute.name(), numbers.mean_absolute / mean),
        (Metric::Bias.name(), numbers.mean_signed.abs() / mean),
        (Metric::Percentile999.name(), numbers.percentile_99_9 / mean),
    ]);
    let map;
    if let Some(exposure_ev) = exposure_ev {
        let seen = beside_mask(found, truth)?;
        let reference = beside_mask(&truth.image, truth)?;
        let ldr = flip::ldr(
            &displayed(&seen, exposure_ev)?,
            &displayed(&reference, exposure_ev)?,
            PIXELS_PER_DEGREE,
        )?;
        errors.insert(Metric::Flip.name(), mean_where(&ldr, truth));
        // A black truth gives no exposures, and HDR-FLIP no number.
        if mean > 0.0 {
            let hdr = flip::hdr(&seen, &reference, PIXELS_PER_DEGREE)?;
            errors.insert(Metric::HdrFlip.name(), mean_where(&hdr.map, truth));
        }
        let rgb = ldr.heat_map().into_iter().flatten().collect();
        map = Map { width: ldr.width(), height: ldr.height(), rgb };
    } else {
        map = relative_map(found, truth, mean);
    }
    errors.extend(custom.iter().map(|metric| (metric.name, (metric.of)(found, truth))));
    Ok(Measured { errors, non_finite: numbers.non_finite, map })
}

/// What a table shows in place of FLIP.
fn relative_map(found: &Image, truth: &TruthImage, mean: f64) -> Map {
    let counts = |index: usize| truth.mask.as_ref().is_none_or(|mask| mask[index]);
    let error = |found: f32, truth: f32| (found - truth).abs() / (truth.abs() + 0.1 * mean as f32);
    let color = |(index, (found, truth)): (usize, (&[f32; 3], &[f32; 3]))| {
        let errors = found.iter().zip(truth).map(|(&found, &truth)| error(found, truth));
        let worst = errors.fold(0.0, f32::max);
        flip::magma(if counts(index) { worst.min(1.0) } else { 0.0 })
    };
    let pixels = found.pixels().iter().zip(truth.image.pixels()).enumerate();
    Map { width: found.width(), height: found.height(), rgb: pixels.flat_map(color).collect() }
}

/// The pixels that count, in a row.
fn masked(image: &Image, truth: &TruthImage) -> Result<Image, Failure> {
    let Some(mask) = &truth.mask else { return Ok(image.clone()) };
    if image.pixels().len() != mask.len() {
        // Let the comparison say it.
        return Ok(image.clone());
    }
    let kept = image.pixels().iter().zip(mask).filter(|(_, counts)| **counts).map(|(pixel, _)| *pixel);
    Ok(Image::row(kept.collect())?)
}

/// The picture with the truth's own pixels where nothing counts, so that neighbours see no
/// difference there.
fn beside_mask(image: &Image, truth: &TruthImage) -> Result<Image, Failure> {
    let Some(mask) = &truth.mask else { return Ok(image.clone()) };
    let pixels = image.pixels().iter().zip(truth.image.pixels()).zip(mask);
    let finite = |pixel: [f32; 3]| pixel.map(|value| if value.is_finite() { value } else { 0.0 });
    let pixels = pixels.map(|((&pixel, &truth), &counts)| if counts { pixel } else { finite(truth) });
    Ok(Image::new(image.width(), image.height(), pixels.collect())?)
}

fn displayed(image: &Image, exposure_ev: f32) -> Result<Image, Failure> {
    let shown = |&pixel: &[f32; 3]| {
        if pixel.iter().all(|value| value.is_finite()) {
            tone_map::display_linear(pixel, exposure_ev, ToneCurve::PbrNeutral)
        } else {
            pixel
        }
    };
    Ok(Image::new(image.width(), image.height(), image.pixels().iter().map(shown).collect())?)
}

/// The mean of a map over the pixels that count.
fn mean_where(map: &ErrorMap, truth: &TruthImage) -> f64 {
    let counts = |index: usize| truth.mask.as_ref().is_none_or(|mask| mask[index]);
    let values = map.values().iter().enumerate().filter(|&(index, value)| counts(index) && !value.is_nan());
    let (sum, count) =
        values.fold((0.0, 0_usize), |(sum, count), (_, &value)| (sum + f64::from(value), count + 1));
    sum / count.max(1) as f64
}

/// The unit of errors that are relative to the whole; 1 for a black truth.
fn mean_absolute_value(image: &Image) -> f64 {
    let values = || image.pixels().iter().flatten().filter(|value| value.is_finite());
    let mean = values().map(|&value| f64::from(value.abs())).sum::<f64>() / values().count().max(1) as f64;
    if mean > 0.0 { mean } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth(mask: Option<Vec<bool>>) -> TruthImage {
        let image = Image::new(4, 1, vec![[1.0; 3], [1.0; 3], [2.0; 3], [f32::NAN; 3]]).unwrap();
        TruthImage { image, variance_of_mean: None, mask, how: String::new() }
    }

    #[test]
    fn only_pixels_that_count_are_compared() {
        let truth = truth(Some(vec![true, false, true, false]));
        let found = Image::new(4, 1, vec![[1.5; 3], [99.0; 3], [2.0; 3], [7.0; 3]]).unwrap();
        let measured = measure(&found, &truth, &[], None).unwrap();
        assert_eq!(measured.non_finite, 0);
        // Means over two pixels of 1 and 2.
        assert!((measured.errors["mean_absolute"] - 0.25 / 1.5).abs() < 1e-6, "{measured:?}");
        assert!((measured.errors["bias"] - 0.25 / 1.5).abs() < 1e-6, "{measured:?}");
        assert!((measured.errors["percentile_99_9"] - 0.5 / 1.5).abs() < 1e-6, "{measured:?}");
        assert!(!measured.errors.contains_key("flip"));
        // Alike, it is black; where nothing counts too.
        assert_eq!(measured.map.rgb[3..], [flip::magma(0.0); 3].concat());
        assert_eq!(measured.map.rgb[..3], flip::magma(0.5 / 1.15));
    }

    #[test]
    fn flip_sees_no_difference_where_nothing_counts() {
        let truth = truth(Some(vec![true, true, true, false]));
        let found = Image::new(4, 1, vec![[1.0; 3], [1.0; 3], [2.0; 3], [500.0; 3]]).unwrap();
        let measured = measure(&found, &truth, &[], Some(0.0)).unwrap();
        assert!(measured.errors["flip"] == 0.0 && measured.errors["hdr_flip"] == 0.0, "{measured:?}");
        let found = Image::new(4, 1, vec![[1.0; 3], [0.1; 3], [2.0; 3], [500.0; 3]]).unwrap();
        assert!(measure(&found, &truth, &[], Some(0.0)).unwrap().errors["flip"] > 0.05);
    }

    #[test]
    fn pixels_that_are_not_finite_are_counted() {
        let found = Image::new(4, 1, vec![[1.0; 3], [f32::NAN; 3], [2.0; 3], [0.0; 3]]).unwrap();
        let truth = truth(Some(vec![true, true, true, false]));
        assert_eq!(measure(&found, &truth, &[], None).unwrap().non_finite, 1);
        let other_size = Image::row(vec![[1.0; 3]]).unwrap();
        assert!(measure(&other_size, &truth, &[], None).is_err());
    }
}
