//! What a truth's own noise shows as an error.
//!
//! A picture that differs from the truth by nothing but noise of the truth's own variance is
//! measured like any method. No error below its errors was measured: the truth cannot tell.

use super::{Errors, measure};
use crate::technique::{CustomMetric, Failure, Metric, TruthImage};
use image_error::{Image, noise_relative_mse};

/// The errors of the noise, `None` where the truth is exact.
pub(super) fn noise(
    truth: &TruthImage,
    custom: &[CustomMetric],
    exposure_ev: Option<f32>,
) -> Result<Option<Errors>, Failure> {
    let Some(variance) = &truth.variance_of_mean else { return Ok(None) };
    let mut errors = measure(&noisy(truth, variance)?, truth, custom, exposure_ev)?.errors;
    // One picture of noise scatters; this one error has a closed form.
    errors.insert(Metric::RelativeMse.name(), expected_relative_mse(truth, variance)?);
    Ok(Some(errors))
}

fn expected_relative_mse(truth: &TruthImage, variance: &[[f32; 3]]) -> Result<f64, Failure> {
    let counts = |index: usize| truth.mask.as_ref().is_none_or(|mask| mask[index]);
    let chosen = || (0..variance.len()).filter(|&index| counts(index));
    let image = Image::row(chosen().map(|index| truth.image.pixels()[index]).collect())?;
    let variance: Vec<[f32; 3]> = chosen().map(|index| variance[index]).collect();
    Ok(noise_relative_mse(&image, &variance)?)
}

/// The truth with normal noise of its variance added.
fn noisy(truth: &TruthImage, variance: &[[f32; 3]]) -> Result<Image, Failure> {
    let mut random = Random(0x5eed);
    let mut value = |value: f32, variance: f32| value + variance.sqrt() * random.normal() as f32;
    let pixels = truth.image.pixels().iter().zip(variance);
    let pixels = pixels.map(|(pixel, variance)| std::array::from_fn(|i| value(pixel[i], variance[i])));
    Ok(Image::new(truth.image.width(), truth.image.height(), pixels.collect())?)
}

/// Random numbers by `SplitMix64` (Steele et al. 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// 64 random bits.
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in 0..1, neither of them included.
    pub(crate) fn uniform(&mut self) -> f64 {
        ((self.bits() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    /// Normal of variance 1 (Box and Muller 1958).
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_of_a_known_variance_is_seen_as_that_error() {
        let (value, variance) = (2.0_f32, 0.04_f32);
        let image = Image::new(64, 64, vec![[value; 3]; 4096]).unwrap();
        let truth = TruthImage {
            image,
            variance_of_mean: Some(vec![[variance; 3]; 4096]),
            mask: None,
            how: String::new(),
        };
        let errors = noise(&truth, &[], None).unwrap().unwrap();
        let expected = 0.04 / (4.0 * 1.01);
        assert!((errors["rel_mse"] / expected - 1.0).abs() < 1e-5, "{errors:?}");
        // The mean of |N(0, 0.2)| is 0.2 sqrt(2 / pi), of 2.
        let expected = 0.1 * (2.0 / std::f64::consts::PI).sqrt();
        assert!((errors["mean_absolute"] / expected - 1.0).abs() < 0.03, "{errors:?}");
        // 12,288 values average the noise away.
        assert!(errors["bias"] < 0.1 * 4.0 / 12288.0_f64.sqrt(), "{errors:?}");
        let exact = TruthImage { variance_of_mean: None, ..truth };
        assert!(noise(&exact, &[], None).unwrap().is_none());
    }
}
