//! Measures that look at pixels one by one.
//!
//! `x` stands for a channel of the image that was found, `y` for the same channel of its
//! reference. Sums are taken in f64, in an order that does not depend on the number of threads.

use crate::{Error, Image, image::is_finite};
use rayon::prelude::*;

/// The share of the mean squared reference that keeps the relative error of dark pixels finite.
const EPSILON: f64 = 0.01;

/// Pixels that one thread sums up before the sums of all are added in order.
const CHUNK: usize = 1 << 14;

/// All numbers of [`compare`]. None is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// See [`relative_mse`].
    pub relative_mse: f64,
    /// See [`mean_absolute`].
    pub mean_absolute: f64,
    /// See [`bias`].
    pub mean_signed: f64,
    /// The bias as a share of the mean of the reference, `energy_ratio - 1`.
    pub relative_bias: f64,
    /// See [`energy_ratio`].
    pub energy_ratio: f64,
    /// What 99.9 % of the pixels do not exceed; see [`percentile`].
    pub percentile_99_9: f64,
    /// The largest absolute difference of a channel, in the unit of the images.
    pub largest: f64,
    /// Pixels left out because a channel of either image is NaN or infinite. A careful caller
    /// accepts only 0.
    pub non_finite: usize,
    /// Pixels that the numbers above are about; at least 1.
    pub compared: usize,
}

/// Everything that a report says about `found`. Fails where the sizes differ, and where no pixel is
/// finite in both images.
pub fn compare(found: &Image, reference: &Image) -> Result<Errors, Error> {
    let pairs = Pairs::new(found, reference)?;
    let sums = pairs.sums();
    let mut largest = pairs.largest_differences();
    let energy_ratio = ratio(sums.found, sums.reference);
    Ok(Errors {
        relative_mse: pairs.relative_mse(&sums),
        mean_absolute: sums.absolute / sums.values(),
        mean_signed: sums.signed / sums.values(),
        relative_bias: energy_ratio - 1.0,
        energy_ratio,
        percentile_99_9: nearest_rank(&mut largest, 0.999),
        largest: nearest_rank(&mut largest, 1.0),
        non_finite: pairs.found.len() - sums.pixels,
        compared: sums.pixels,
    })
}

/// Relative mean squared error, without unit, 0 or more: the mean of `(x - y)^2 / (y^2 + eps)` over
/// all channels of all pixels, where `eps` is 0.01 of the mean of `y^2`. Scaling both images alike
/// does not change it.
///
/// A black reference has nothing to be relative to: the result is then 0 for a black image and
/// infinite for any other. Non-finite pixels are left out, of `eps` too ([`compare`] counts them).
/// Fails as [`compare`].
///
/// Where the reference is itself an estimate, its noise adds [`noise_relative_mse`] on average.
pub fn relative_mse(found: &Image, reference: &Image) -> Result<f64, Error> {
    let pairs = Pairs::new(found, reference)?;
    Ok(pairs.relative_mse(&pairs.sums()))
}

/// The mean of `|x - y|` over all channels, in the unit of the images, 0 or more. Non-finite pixels
/// are left out ([`compare`] counts them). Fails as [`compare`].
pub fn mean_absolute(found: &Image, reference: &Image) -> Result<f64, Error> {
    let sums = Pairs::new(found, reference)?.sums();
    Ok(sums.absolute / sums.values())
}

/// The mean of `x - y` over all channels, in the unit of the images: positive where the image is
/// too bright. Non-finite pixels are left out ([`compare`] counts them). Fails as [`compare`].
pub fn bias(found: &Image, reference: &Image) -> Result<f64, Error> {
    let sums = Pairs::new(found, reference)?.sums();
    Ok(sums.signed / sums.values())
}

/// The sum of `x` over the sum of `y`, over all channels: 1 where no light is lost or made up.
///
/// Two images that both sum to 0 have the ratio 1; where only the reference does, it is infinite,
/// with the sign of the image's sum. Sums that cancel because of negative values make a ratio that
/// says little. Non-finite pixels are left out ([`compare`] counts them). Fails as [`compare`].
pub fn energy_ratio(found: &Image, reference: &Image) -> Result<f64, Error> {
    let sums = Pairs::new(found, reference)?.sums();
    Ok(ratio(sums.found, sums.reference))
}

/// The absolute difference that the share `quantile` of all pixels does not exceed (nearest rank),
/// in the unit of the images; a pixel's difference is the largest of its channels. 1 gives the
/// largest difference of all. `quantile` lies in 0..=1, or the call fails; non-finite pixels are
/// left out ([`compare`] counts them). Fails also as [`compare`].
pub fn percentile(found: &Image, reference: &Image, quantile: f64) -> Result<f64, Error> {
    if !(0.0..=1.0).contains(&quantile) {
        return Err(Error::OutOfRange { name: "quantile", found: quantile, expected: "0 to 1" });
    }
    let pairs = Pairs::new(found, reference)?;
    Ok(nearest_rank(&mut pairs.largest_differences(), quantile))
}

/// The fraction of pixels, in 0..=1, with a channel that lies above `threshold` in one image and
/// not in the other: of a visibility, the pixels that are lit instead of in shadow and the reverse.
/// Non-finite pixels are left out ([`compare`] counts them); a threshold that is NaN is refused.
/// Fails also as [`compare`].
pub fn misclassified(found: &Image, reference: &Image, threshold: f32) -> Result<f64, Error> {
    if threshold.is_nan() {
        return Err(Error::OutOfRange { name: "threshold", found: f64::NAN, expected: "a number" });
    }
    let pairs = Pairs::new(found, reference)?;
    let differs =
        |(x, y): &(&[f32; 3], &[f32; 3])| x.iter().zip(*y).any(|(x, y)| (*x > threshold) != (*y > threshold));
    let (wrong, all) = pairs
        .finite()
        .fold((0_usize, 0_usize), |(wrong, all), pair| (wrong + usize::from(differs(&pair)), all + 1));
    Ok(wrong as f64 / all as f64)
}

/// What the noise of a reference adds to a [`relative_mse`] against it, on average: the mean of
/// `variance / (y^2 + eps)` over all channels, with the same `eps`. `variance_of_mean` is the
/// variance of each channel of `reference` as an estimate (sample variance divided by the number of
/// samples), row by row.
///
/// If `y` is the truth `t` plus independent noise of that variance, then
/// `E[(x - y)^2] = (x - t)^2 + variance`. So `relative_mse - noise_relative_mse` estimates the
/// relative error against the truth without the bias that the noise brings; it can be negative where
/// the true error is far below the noise. What remains is the noise in the denominators: a share of
/// about `4 variance / (y (x - t))` of the error, small where the standard deviation is small beside
/// the error. A comparison should not be believed where the noise is not small beside the error it
/// claims to measure. Where the image is itself an independent estimate, add its variance to the
/// reference's before the call.
///
/// An infinite variance, that of a single sample, makes the result infinite: unknown noise is not no
/// noise. Non-finite pixels of the reference are left out; a black reference behaves as in
/// [`relative_mse`]. Fails where a variance is negative or NaN, where the number of variances is not
/// the number of pixels, and where no pixel is finite.
pub fn noise_relative_mse(reference: &Image, variance_of_mean: &[[f32; 3]]) -> Result<f64, Error> {
    let (width, height) = (reference.width(), reference.height());
    let pixels = reference.pixels();
    if variance_of_mean.len() != pixels.len() {
        return Err(Error::Length { width, height, found: variance_of_mean.len() });
    }
    let sums = Pairs::new(reference, reference)?.sums();
    let eps = sums.eps();
    let mut total = 0.0;
    for (pixel, (y, variance)) in pixels.iter().zip(variance_of_mean).enumerate() {
        if !is_finite(y) {
            continue;
        }
        if let Some(&found) = variance.iter().find(|value| value.is_nan() || **value < 0.0) {
            return Err(Error::Variance { pixel, found });
        }
        total +=
            y.iter().zip(variance).map(|(&y, &v)| relative(f64::from(v), f64::from(y), eps)).sum::<f64>();
    }
    Ok(total / sums.values())
}

/// Two images of the same size.
struct Pairs<'a> {
    found: &'a [[f32; 3]],
    reference: &'a [[f32; 3]],
}

/// Sums over all channels of all pixels that are finite in both images.
#[derive(Clone, Copy, Default)]
struct Sums {
    found: f64,
    reference: f64,
    reference_squared: f64,
    signed: f64,
    absolute: f64,
    pixels: usize,
}

impl<'a> Pairs<'a> {
    /// Fails where the sizes differ or no pixel is finite in both.
    fn new(found: &'a Image, reference: &'a Image) -> Result<Self, Error> {
        found.check_same_size(reference)?;
        let pairs = Self { found: found.pixels(), reference: reference.pixels() };
        if pairs.finite().next().is_none() {
            return Err(Error::NothingFinite { pixels: pairs.found.len() });
        }
        Ok(pairs)
    }

    fn finite(&self) -> impl Iterator<Item = (&'a [f32; 3], &'a [f32; 3])> {
        finite(self.found, self.reference)
    }

    /// `f` of each stretch of pixels, in order.
    fn chunks<T: Send>(&self, f: impl Fn(&'a [[f32; 3]], &'a [[f32; 3]]) -> T + Sync) -> Vec<T> {
        let chunks = self.found.par_chunks(CHUNK).zip(self.reference.par_chunks(CHUNK));
        chunks.map(|(found, reference)| f(found, reference)).collect()
    }

    fn sums(&self) -> Sums {
        let chunks = self.chunks(|found, reference| {
            let mut sums = Sums::default();
            finite(found, reference).for_each(|(x, y)| sums.add(*x, *y));
            sums
        });
        chunks.into_iter().fold(Sums::default(), Sums::merge)
    }

    fn relative_mse(&self, sums: &Sums) -> f64 {
        let eps = sums.eps();
        let chunks = self.chunks(|found, reference| {
            let channels = finite(found, reference).flat_map(|(x, y)| x.iter().zip(y));
            channels
                .map(|(&x, &y)| relative((f64::from(x) - f64::from(y)).powi(2), f64::from(y), eps))
                .sum::<f64>()
        });
        chunks.into_iter().sum::<f64>() / sums.values()
    }

    /// The largest absolute difference of a channel, for each finite pixel.
    fn largest_differences(&self) -> Vec<f64> {
        let difference = |(x, y): (&f32, &f32)| (f64::from(*x) - f64::from(*y)).abs();
        self.finite().map(|(x, y)| x.iter().zip(y).map(difference).fold(0.0, f64::max)).collect()
    }
}

impl Sums {
    fn add(&mut self, found: [f32; 3], reference: [f32; 3]) {
        for (x, y) in found.into_iter().zip(reference) {
            let (x, y) = (f64::from(x), f64::from(y));
            self.found += x;
            self.reference += y;
            self.reference_squared += y * y;
            self.signed += x - y;
            self.absolute += (x - y).abs();
        }
        self.pixels += 1;
    }

    fn merge(self, other: Self) -> Self {
        Self {
            found: self.found + other.found,
            reference: self.reference + other.reference,
            reference_squared: self.reference_squared + other.reference_squared,
            signed: self.signed + other.signed,
            absolute: self.absolute + other.absolute,
            pixels: self.pixels + other.pixels,
        }
    }

    /// The number of channels summed up, at least 3.
    fn values(&self) -> f64 {
        3.0 * self.pixels as f64
    }

    fn eps(&self) -> f64 {
        EPSILON * self.reference_squared / self.values()
    }
}

fn finite<'a>(
    found: &'a [[f32; 3]],
    reference: &'a [[f32; 3]],
) -> impl Iterator<Item = (&'a [f32; 3], &'a [f32; 3])> {
    found.iter().zip(reference).filter(|(x, y)| is_finite(x) && is_finite(y))
}

/// `squared / (y^2 + eps)`, and its limit for a black reference.
fn relative(squared: f64, y: f64, eps: f64) -> f64 {
    if squared == 0.0 { 0.0 } else { squared / (y * y + eps) }
}

/// `found / reference`, and what it is for two zeros.
fn ratio(found: f64, reference: f64) -> f64 {
    match (found == 0.0, reference == 0.0) {
        (true, true) => 1.0,
        (false, true) => f64::INFINITY.copysign(found),
        _ => found / reference,
    }
}

/// The smallest value that at least the share `quantile` of all values does not exceed. There is at
/// least one value.
fn nearest_rank(values: &mut [f64], quantile: f64) -> f64 {
    let rank = (quantile * values.len() as f64).ceil() as usize;
    let index = rank.clamp(1, values.len()) - 1;
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}
