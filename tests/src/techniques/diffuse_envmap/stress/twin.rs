//! The library's own approximations in f64, written down a second time.

use diffuse_envmap::model::{self, Vec3};
use std::f64::consts::FRAC_PI_2;

/// Root mean square angle of the lobe over t.
pub(super) const WIDTH: f64 = 0.85660;

/// The part of a lobe above the horizon: a logistic curve in place of the Gaussian integral, 0 and 1
/// where the rim touches the horizon.
pub(super) fn above(t: f64, lift: f64) -> f64 {
    let x = lift / (WIDTH * t.max(1e-6));
    let logistic = |x: f64| 1.0 / (1.0 + (-2.26 * x).clamp(-60.0, 60.0).exp());
    let rim = logistic(-FRAC_PI_2 / WIDTH);
    ((logistic(x) - rim) / (1.0 - 2.0 * rim)).clamp(0.0, 1.0)
}

/// The lobe's density convolved with a round source, by a three-point rule along the angle.
pub(super) fn convolved_density(t: f64, spread: f64, angle: f64) -> f64 {
    let sigma = (std::f64::consts::FRAC_1_SQRT_2 * spread).min(0.2 * t);
    let rest = (spread * spread - 2.0 * sigma * sigma).max(0.0);
    let wide = (t * t + rest / (WIDTH * WIDTH)).sqrt().min(1.0);
    let middle = angle.hypot(sigma);
    let step = 3.0_f64.sqrt() * sigma;
    let at = |theta| model::density(wide, theta);
    (4.0 * at(middle) + at((middle - step).abs()) + at(middle + step)) / 6.0
}

/// The direction in which a box that stands for the environment shows what is hit.
pub(super) fn parallax(direction: Vec3, position: Vec3, least: Vec3, greatest: Vec3, centre: Vec3) -> Vec3 {
    if (0..3).any(|i| position[i] <= least[i] || position[i] >= greatest[i]) {
        return direction;
    }
    let distance = |i: usize| {
        let along = if direction[i].abs() < 1e-12 { 1e-12 } else { direction[i] };
        (if along > 0.0 { greatest[i] } else { least[i] } - position[i]) / along
    };
    let nearest = distance(0).min(distance(1)).min(distance(2));
    let hit = model::add_scaled(position, direction, nearest);
    model::normalize_or(model::add_scaled(hit, centre, -1.0), direction)
}

/// The number that a pixel turns the published pattern by.
pub(super) fn pixel_random(x: u32, y: u32) -> f64 {
    let state = x.wrapping_mul(747796405).wrapping_add(y.wrapping_mul(2891336453)).wrapping_add(277803737);
    let mixed = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277803737);
    f64::from(((mixed >> 22) ^ mixed) >> 8) / 16777216.0
}

/// Karis's fit of the GGX split sum for one channel of a colour with the given greatest channel.
pub(super) fn specular_reflectance(ks: f64, greatest_ks: f64, roughness: f64, n_dot_v: f64) -> f64 {
    let along = |slope: f64, start: f64| slope * roughness + start;
    let (rx, ry) = (along(-1.0, 1.0), along(-0.0275, 0.0425));
    let (rz, rw) = (along(-0.572, 1.04), along(0.022, -0.04));
    let a = (rx * rx).min((-9.28 * n_dot_v).exp2()) * rx + ry;
    let bias = (rw + 1.04 * a) * (50.0 * greatest_ks).clamp(0.0, 1.0);
    (ks * (rz - 1.04 * a) + bias).clamp(0.0, 1.0)
}

/// Bands 1 and 2 of harmonics whose factors are `coefficients[1..9]`.
pub(super) fn bands(coefficients: &[Vec3], d: Vec3, band_1: f64, band_2: f64) -> Vec3 {
    let [x, y, z] = d;
    let basis = [
        band_1 * y,
        band_1 * z,
        band_1 * x,
        band_2 * x * y,
        band_2 * y * z,
        band_2 * (3.0 * z * z - 1.0),
        band_2 * x * z,
        band_2 * (x * x - y * y),
    ];
    basis.iter().zip(&coefficients[1..]).fold([0.0; 3], |sum, (&b, &c)| model::add_scaled(sum, c, b))
}

/// The nine polynomials of band 4.
pub(super) fn band_4_basis([x, y, z]: Vec3) -> [f64; 9] {
    let (xx, yy, zz) = (x * x, y * y, z * z);
    [
        x * y * (xx - yy),
        y * z * (3.0 * xx - yy),
        x * y * (7.0 * zz - 1.0),
        y * z * (7.0 * zz - 3.0),
        35.0 * zz * zz - 30.0 * zz + 3.0,
        x * z * (7.0 * zz - 3.0),
        (xx - yy) * (7.0 * zz - 1.0),
        x * z * (xx - 3.0 * yy),
        xx * (xx - 3.0 * yy) - yy * (3.0 * xx - yy),
    ]
}

/// The part of the extended sources that a chain level does not hold, for a finest face of so many
/// texels.
pub(super) fn extended_share(face_size: f64, level: f64) -> f64 {
    (level.max(1.0 - face_size.log2()) + 6.0).clamp(0.0, 1.0)
}

/// A source of light as the tables hold it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    pub(super) axis: Vec3,
    pub(super) spread: f64,
    pub(super) power: Vec3,
    pub(super) extended: bool,
}

/// All sources through a lobe.
pub(super) fn sources(all: &[Source], axis: Vec3, normal: Vec3, t: f64, share: f64, discard: bool) -> Vec3 {
    let rim = (FRAC_PI_2 * t + 0.15).min(std::f64::consts::PI).cos();
    let height = |direction: Vec3| model::dot(normal, direction).clamp(-1.0, 1.0).asin();
    let mut sum = [0.0; 3];
    for source in all.iter().filter(|source| model::dot(source.axis, axis) >= rim) {
        let apart = model::add_scaled(axis, source.axis, -1.0);
        let angle = 2.0 * (0.5 * model::dot(apart, apart).sqrt()).min(1.0).asin();
        let mut part = convolved_density(t, source.spread, angle);
        if discard {
            part *= above(source.spread / WIDTH, height(source.axis));
        }
        sum = model::add_scaled(sum, source.power, part * if source.extended { share } else { 1.0 });
    }
    if discard && t < 0.5 {
        sum = sum.map(|x| x / above(t, height(axis)).max(0.02));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_reflectance_is_the_first() {
        for ks in [0.04, 0.5, 1.0] {
            for roughness in [0.0, 0.3, 1.0] {
                for n_dot_v in [0.0, 0.1, 0.8, 1.0] {
                    let first = crate::specular_reflectance(ks, roughness, n_dot_v);
                    assert!((specular_reflectance(ks, ks, roughness, n_dot_v) - first).abs() < 1e-12);
                }
            }
        }
    }
}
