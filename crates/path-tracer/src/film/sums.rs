//! The sums of one pixel, as integers.

/// The greatest radiance of a sample; one beyond is brought back to it and counted.
pub const MAX_RADIANCE: f64 = (1_u64 << 30) as f64;

/// Fraction bits of a radiance. With 30 bits before the point and 24 of the number of samples, a
/// sum stays within 95 bits: three limbs of a file.
pub(super) const SUM_FRACTION_BITS: u32 = 41;

/// Fraction bits of the square of a radiance. With 60 bits before the point and 24 of the number of
/// samples, a sum stays within 127 bits.
pub(super) const SQUARE_FRACTION_BITS: u32 = 43;

/// Sums over the samples of one pixel, per channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelSums {
    /// Radiance in units of 2^-41.
    pub(super) sum: [u128; 3],
    /// Its square in units of 2^-43.
    pub(super) square: [u128; 3],
    pub(super) invalid: u32,
    pub(super) clamped: u32,
}

impl PixelSums {
    /// Adds the linear RGB radiance of one sample.
    ///
    /// A sample with a NaN, infinite or negative channel is no radiance: it is counted as invalid
    /// and adds nothing. Channels beyond [`MAX_RADIANCE`] are brought back to it, and the sample is
    /// counted as clamped.
    pub fn add(&mut self, radiance: [f64; 3]) {
        if !radiance.iter().all(|value| value.is_finite() && *value >= 0.0) {
            self.invalid = self.invalid.saturating_add(1);
            return;
        }
        if radiance.iter().any(|&value| value > MAX_RADIANCE) {
            self.clamped = self.clamped.saturating_add(1);
        }
        for (channel, value) in radiance.into_iter().enumerate() {
            let value = value.min(MAX_RADIANCE);
            self.sum[channel] = self.sum[channel].saturating_add(fixed(value, SUM_FRACTION_BITS));
            let square = fixed(value * value, SQUARE_FRACTION_BITS);
            self.square[channel] = self.square[channel].saturating_add(square);
        }
    }

    /// Adds the sums of other samples.
    pub fn merge(&mut self, other: &Self) {
        for channel in 0..3 {
            self.sum[channel] = self.sum[channel].saturating_add(other.sum[channel]);
            self.square[channel] = self.square[channel].saturating_add(other.square[channel]);
        }
        self.invalid = self.invalid.saturating_add(other.invalid);
        self.clamped = self.clamped.saturating_add(other.clamped);
    }

    /// The mean radiance over `count` samples, 0 for none.
    pub fn mean(&self, count: u32) -> [f32; 3] {
        self.sum.map(|sum| if count == 0 { 0.0 } else { mean(sum, SUM_FRACTION_BITS, count) as f32 })
    }

    /// The variance of the mean over `count` samples: the unbiased variance of a sample over their
    /// number. Infinite below two samples.
    pub fn variance_of_mean(&self, count: u32) -> [f32; 3] {
        std::array::from_fn(|channel| {
            if count < 2 {
                return f32::INFINITY;
            }
            let mean_value = mean(self.sum[channel], SUM_FRACTION_BITS, count);
            let mean_square = mean(self.square[channel], SQUARE_FRACTION_BITS, count);
            // Rounding can bring a constant below zero.
            let spread = (mean_square - mean_value * mean_value).max(0.0);
            (spread / f64::from(count - 1)) as f32
        })
    }

    /// Samples that were no radiance.
    pub fn invalid(&self) -> u32 {
        self.invalid
    }

    /// Samples that were brought back to [`MAX_RADIANCE`].
    pub fn clamped(&self) -> u32 {
        self.clamped
    }

    /// Whether `count` samples can have made these sums.
    pub(super) fn is_possible(&self, count: u32) -> bool {
        let most = |value: f64, bits: u32| fixed(value, bits).saturating_mul(u128::from(count));
        let largest_sum = most(MAX_RADIANCE, SUM_FRACTION_BITS);
        let largest_square = most(MAX_RADIANCE * MAX_RADIANCE, SQUARE_FRACTION_BITS);
        self.sum.iter().all(|&sum| sum <= largest_sum)
            && self.square.iter().all(|&square| square <= largest_square)
            && self.invalid.checked_add(self.clamped).is_some_and(|odd| odd <= count)
    }
}

/// A number in units of 2^-`bits`, rounded to the nearest. Scaling by a power of two is exact, so
/// that this is the only rounding.
fn fixed(value: f64, bits: u32) -> u128 {
    (value * (1_u64 << bits) as f64).round_ties_even() as u128
}

fn mean(sum: u128, bits: u32, count: u32) -> f64 {
    sum as f64 / f64::from(count) / (1_u64 << bits) as f64
}
