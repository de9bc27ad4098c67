//! The filters of FLIP, all of them separable.
//!
//! A kernel is symmetric or antisymmetric about its centre, so only the centre and one side are
//! kept: `weights[k]` belongs to the offset `k`, and to `-k` with the kernel's [`Parity`].

use std::f64::consts::PI;

/// What the contrast sensitivity of an opponent channel is made of: Gaussians `a sqrt(pi / b)
/// exp(-pi^2 d^2 / b)` of the distance `d` in degrees, as pairs `(a, b)` (2020, spatial filtering).
const LUMINANCE: [f64; 2] = [1.0, 0.0047];
const RED_GREEN: [f64; 2] = [1.0, 0.0053];
const YELLOW_BLUE: [[f64; 2]; 2] = [[34.1, 0.04], [13.5, 0.025]];

/// Width of the edges and points that the eye detects, in degrees (2020, feature pipeline).
const FEATURE_WIDTH_DEG: f64 = 0.082;

/// All kernels for one viewing distance.
pub(super) struct Filters {
    pub(super) luminance: Kernel,
    pub(super) red_green: Kernel,
    /// Two kernels to be summed after both axes; the weights of each include its share.
    pub(super) yellow_blue: [Kernel; 2],
    /// Across the direction of `edge` and `point`.
    pub(super) smooth: Kernel,
    /// First derivative of a Gaussian.
    pub(super) edge: Kernel,
    /// Second derivative of a Gaussian.
    pub(super) point: Kernel,
    /// The largest offset that any kernel reaches, in pixels.
    pub(super) radius: usize,
}

pub(super) struct Kernel {
    weights: Vec<f32>,
    parity: Parity,
}

#[derive(Clone, Copy)]
enum Parity {
    Even,
    Odd,
    /// Even, and the sum of all weights is 0. The weight of the centre is left to be what makes it
    /// so, without rounding: the feature error is a square root, which would raise a response of
    /// 1e-8 on a plain surface to 1e-4.
    EvenWithoutMean,
}

impl Filters {
    /// `pixels_per_degree` is within the range that the caller has checked.
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let widest = [LUMINANCE, RED_GREEN, YELLOW_BLUE[0], YELLOW_BLUE[1]]
            .map(|[_, b]| b)
            .into_iter()
            .fold(0.0, f64::max);
        let color_radius = radius((widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree);
        let color = |[_, b]: [f64; 2]| {
            sampled(color_radius, |pixels| (-(PI * pixels / pixels_per_degree).powi(2) / b).exp())
        };
        let deviation = 0.5 * FEATURE_WIDTH_DEG * pixels_per_degree;
        let feature_radius = radius(deviation);
        let gaussian = |pixels: f64| (-pixels * pixels / (2.0 * deviation * deviation)).exp();
        let smooth = sampled(feature_radius, gaussian);
        let edge = sampled(feature_radius, |pixels| pixels * gaussian(pixels));
        let point = sampled(feature_radius, |pixels| ((pixels / deviation).powi(2) - 1.0) * gaussian(pixels));
        Self {
            luminance: Kernel::of_unit_sum(&color(LUMINANCE)),
            red_green: Kernel::of_unit_sum(&color(RED_GREEN)),
            yellow_blue: yellow_blue(color),
            smooth: Kernel::of_unit_sum(&smooth),
            edge: Kernel::odd(&edge),
            point: Kernel::of_unit_halves(&point),
            radius: color_radius.max(feature_radius),
        }
    }
}

impl Kernel {
    /// Scaled so that all weights sum to 1.
    fn of_unit_sum(weights: &[f64]) -> Self {
        let sum = both_sides(weights);
        Self::even(weights.iter().map(|weight| weight / sum))
    }

    /// Scaled so that the positive weights sum to 1 and the negative ones to -1.
    fn of_unit_halves(weights: &[f64]) -> Self {
        let sum_of = |sign: f64| {
            both_sides(&weights.iter().map(|weight| (weight * sign).max(0.0)).collect::<Vec<_>>())
        };
        let (positive, negative) = (sum_of(1.0), sum_of(-1.0));
        let scaled = weights.iter().map(|&weight| weight / if weight > 0.0 { positive } else { negative });
        Self { parity: Parity::EvenWithoutMean, ..Self::even(scaled) }
    }

    /// Antisymmetric, scaled so that the positive weights sum to 1.
    fn odd(weights: &[f64]) -> Self {
        let sum: f64 = weights.iter().skip(1).sum();
        Self { weights: weights.iter().map(|weight| (weight / sum) as f32).collect(), parity: Parity::Odd }
    }

    fn even(weights: impl Iterator<Item = f64>) -> Self {
        Self { weights: weights.map(|weight| weight as f32).collect(), parity: Parity::Even }
    }

    /// Adds to each value of `out` the weighted sum of the values around it. `at` gives a stretch of
    /// as many values as `out` has, shifted by an offset that does not exceed the radius.
    pub(super) fn add<'a>(&self, out: &mut [f32], at: impl Fn(isize) -> &'a [f32]) {
        let center = at(0);
        if let (Parity::Even, Some(weight)) = (self.parity, self.weights.first()) {
            out.iter_mut().zip(center).for_each(|(out, value)| *out += weight * value);
        }
        for (k, &weight) in self.weights.iter().enumerate().skip(1) {
            let offset = k as isize;
            let sides = at(-offset).iter().zip(at(offset));
            let places = out.iter_mut().zip(sides);
            match self.parity {
                Parity::Even => places.for_each(|(out, (before, after))| *out += weight * (after + before)),
                Parity::Odd => places.for_each(|(out, (before, after))| *out += weight * (after - before)),
                Parity::EvenWithoutMean => {
                    for ((out, (before, after)), center) in places.zip(center) {
                        *out += weight * ((after - center) + (before - center));
                    }
                }
            }
        }
    }
}

/// The two Gaussians share one unit sum over both axes; each takes the square root of its share.
fn yellow_blue(color: impl Fn([f64; 2]) -> Vec<f64>) -> [Kernel; 2] {
    let amplitude = |[a, b]: [f64; 2]| a * (PI / b).sqrt();
    let total: f64 = YELLOW_BLUE.iter().map(|&term| amplitude(term) * both_sides(&color(term)).powi(2)).sum();
    YELLOW_BLUE.map(|term| {
        let share = (amplitude(term) / total).sqrt();
        Kernel::even(color(term).into_iter().map(|weight| weight * share))
    })
}

/// Where a Gaussian may be cut off.
fn radius(deviation: f64) -> usize {
    (3.0 * deviation).ceil() as usize
}

fn sampled(radius: usize, f: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..=radius).map(|pixels| f(pixels as f64)).collect()
}

/// The sum over the centre and both sides of an even kernel.
fn both_sides(weights: &[f64]) -> f64 {
    2.0 * weights.iter().sum::<f64>() - weights.first().unwrap_or(&0.0)
}
