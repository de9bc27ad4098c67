//! A map of errors and what can be said about it in a few numbers.

use super::magma::magma;

/// The colour of a pixel without an error in a heat map: none of magma's.
const NOT_COMPARED: [u8; 3] = [0, 255, 0];

/// An error for each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) values: Vec<f32>,
}

/// What the published tool prints about an error map, all in 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// The mean.
    pub mean: f64,
    /// The error at which half of the sum of all errors is reached, errors taken in rising order.
    pub weighted_median: f32,
    /// The error at which a quarter of the sum is reached.
    pub weighted_quartile_1: f32,
    /// The error at which three quarters of the sum are reached.
    pub weighted_quartile_3: f32,
    /// The smallest error.
    pub min: f32,
    /// The largest error.
    pub max: f32,
    /// Pixels left out of the numbers above because a channel of either image is NaN or infinite.
    pub non_finite: usize,
}

impl ErrorMap {
    /// Pixels in a row.
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub const fn height(&self) -> usize {
        self.height
    }

    /// The error of each pixel in 0..=1, row by row from the top; NaN where the pixel was not
    /// finite in both images.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The mean error, over all pixels that were finite in both images.
    pub fn mean(&self) -> f64 {
        self.statistics().mean
    }

    /// Pixels that were not finite in both images.
    pub fn non_finite(&self) -> usize {
        self.values.iter().filter(|value| value.is_nan()).count()
    }

    /// The numbers that the published tool prints.
    pub fn statistics(&self) -> Statistics {
        let mut sorted: Vec<f32> = self.values.iter().copied().filter(|value| !value.is_nan()).collect();
        sorted.sort_unstable_by(f32::total_cmp);
        let sum: f64 = sorted.iter().map(|&value| f64::from(value)).sum();
        Statistics {
            mean: sum / sorted.len() as f64,
            weighted_median: weighted_quantile(&sorted, 0.5 * sum),
            weighted_quartile_1: weighted_quantile(&sorted, 0.25 * sum),
            weighted_quartile_3: weighted_quantile(&sorted, 0.75 * sum),
            min: sorted.first().copied().unwrap_or(0.0),
            max: sorted.last().copied().unwrap_or(0.0),
            non_finite: self.values.len() - sorted.len(),
        }
    }

    /// The map in the colours of [`magma`], 8-bit sRGB, row by row from the top. Pixels that were not
    /// finite in both images are pure green.
    pub fn heat_map(&self) -> Vec<[u8; 3]> {
        self.values.iter().map(|&value| if value.is_nan() { NOT_COMPARED } else { magma(value) }).collect()
    }
}

/// The first value at which the running sum exceeds `target`.
fn weighted_quantile(sorted: &[f32], target: f64) -> f32 {
    let mut running = 0.0;
    let reached = sorted.iter().find(|&&value| {
        running += f64::from(value);
        running > target
    });
    reached.or(sorted.last()).copied().unwrap_or(0.0)
}
