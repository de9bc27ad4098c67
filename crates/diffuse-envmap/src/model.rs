//! The technique's mathematics in f64: the oracle that the shaders are tested against.
//!
//! Numbers of equations refer to Hirokawa and Ikedo, *A Diffused Environment Mapping*.
//! Directions are unit vectors `[x, y, z]`; roughness is t, 0 (mirror) to 1 (diffuse).

use std::f64::consts::{FRAC_PI_2, PI};

use crate::settings::{Base, Distribution, Horizon};

/// A vector of three components.
pub type Vec3 = [f64; 3];

/// The dot product.
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a + s * b`.
pub fn add_scaled(a: Vec3, b: Vec3, s: f64) -> Vec3 {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

/// The unit vector along `v`, or `fallback` where `v` is too short or not finite.
pub fn normalize_or(v: Vec3, fallback: Vec3) -> Vec3 {
    let length = dot(v, v).sqrt();
    if length > 1e-10 && length.is_finite() { v.map(|x| x / length) } else { fallback }
}

/// Eq. 1: the mirror direction r = v - 2 (n.v) n, for v from the eye to the surface.
pub fn mirror(view: Vec3, normal: Vec3) -> Vec3 {
    add_scaled(view, normal, -2.0 * dot(view, normal))
}

/// Eq. 3: the axis of the lobe, between the mirror direction (t = 0) and the normal (t = 1).
///
/// Where the two cancel (r = -n at t = 0.5) it is the normal.
pub fn base(mirror: Vec3, normal: Vec3, t: f64, mode: Base) -> Vec3 {
    let linear = normalize_or(add_scaled(mirror.map(|x| x * (1.0 - t)), normal, t), normal);
    match mode {
        Base::Lerp => linear,
        Base::Slerp => {
            let angle = dot(mirror, normal).clamp(-1.0, 1.0).acos();
            if !(1e-3..=PI - 1e-3).contains(&angle) {
                return linear;
            }
            let (from, to) = (((1.0 - t) * angle).sin(), (t * angle).sin());
            normalize_or(add_scaled(mirror.map(|x| x * from), normal, to), normal)
        }
    }
}

/// Two unit vectors that complete `z` to a right-handed frame (Duff et al. 2017).
pub fn frame(z: Vec3) -> (Vec3, Vec3) {
    let s = if z[2] >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (s + z[2]);
    let b = z[0] * z[1] * a;
    ([1.0 + s * z[0] * z[0] * a, s * b, -s * z[0]], [b, s + z[1] * z[1] * a, -z[1]])
}

/// The direction at polar angle `theta` and azimuth `phi` about `axis` (eq. 2).
pub fn around(axis: Vec3, theta: f64, phi: f64) -> Vec3 {
    let (x, y) = frame(axis);
    let (sine, cosine) = theta.sin_cos();
    std::array::from_fn(|i| sine * (phi.cos() * x[i] + phi.sin() * y[i]) + cosine * axis[i])
}

/// Eq. 4 with the cosine weight: the angle from the axis for a uniform random number in 0..1.
pub fn sample_angle(t: f64, xi: f64) -> f64 {
    t * (1.0 - xi).max(0.0).sqrt().acos()
}

/// The lobe's density per steradian at an angle from its axis:
/// p = sin(2 theta / t) / (2 pi t sin theta) inside theta < t pi / 2, tending to 1 / (pi t^2)
/// on the axis. Integrates to one over the sphere.
pub fn density(t: f64, theta: f64) -> f64 {
    if t <= 0.0 || theta >= t * FRAC_PI_2 {
        return 0.0;
    }
    if theta < 1e-7 * t {
        return 1.0 / (PI * t * t);
    }
    (2.0 * theta / t).sin() / (2.0 * PI * t * theta.sin())
}

/// The lobe's Legendre coefficients `A_0..=A_max`: the mean of `P_l(cos theta)` over the lobe.
/// Convolving a band l of spherical harmonics with the lobe multiplies it by `A_l`.
pub fn legendre_coefficients(t: f64, max: usize) -> Vec<f64> {
    // sin(2x) is the density of x = theta / t over 0 .. pi/2; Simpson's rule resolves it well
    // past max * t = 20.
    const STEPS: usize = 2000;
    let mut sums = vec![0.0; max + 1];
    for step in 0..=STEPS {
        let x = FRAC_PI_2 * step as f64 / STEPS as f64;
        let simpson = if step == 0 || step == STEPS { 1.0 } else { 2.0 + 2.0 * (step % 2) as f64 };
        let weight = simpson * (2.0 * x).sin() * FRAC_PI_2 / (3.0 * STEPS as f64);
        let values = legendre((t * x).cos(), max);
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += weight * value;
        }
    }
    sums
}

/// The Legendre polynomials `P_0(x)..=P_max(x)`.
pub fn legendre(x: f64, max: usize) -> Vec<f64> {
    let mut values = vec![1.0, x];
    for l in 1..max.max(1) {
        let l_f = l as f64;
        values.push(((2.0 * l_f + 1.0) * x * values[l] - l_f * values[l - 1]) / (l_f + 1.0));
    }
    values.truncate(max + 1);
    values
}

/// A latitude-longitude map in f64, bilinear between texel centres, as a sampler sees it:
/// u wraps, v is clamped.
#[derive(Clone, Debug)]
pub struct Map {
    /// Texels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// RGB texels from the top row, `width * height`.
    pub texels: Vec<[f64; 3]>,
}

impl Map {
    /// The bilinear radiance in a unit direction (the mirror lookup).
    pub fn sample(&self, direction: Vec3) -> [f64; 3] {
        // At the poles u is 0.5, whatever the signs of their zeros.
        let at_pole = direction[0].abs() + direction[2].abs() < 1e-18;
        let longitude = if at_pole { 0.0 } else { direction[2].atan2(direction[0]) };
        let u = 0.5 + longitude / (2.0 * PI);
        let v = direction[1].clamp(-1.0, 1.0).acos() / PI;
        let (x, y) = (u * self.width as f64 - 0.5, v * self.height as f64 - 0.5);
        let (fraction_x, fraction_y) = (x - x.floor(), y - y.floor());
        let column = |offset: i64| (x.floor() as i64 + offset).rem_euclid(self.width as i64) as usize;
        let row = |offset: i64| (y.floor() as i64 + offset).clamp(0, self.height as i64 - 1) as usize;
        let texel = |dx, dy| self.texels[row(dy) * self.width + column(dx)];
        std::array::from_fn(|channel| {
            let top = texel(0, 0)[channel] * (1.0 - fraction_x) + texel(1, 0)[channel] * fraction_x;
            let bottom = texel(0, 1)[channel] * (1.0 - fraction_x) + texel(1, 1)[channel] * fraction_x;
            top * (1.0 - fraction_y) + bottom * fraction_y
        })
    }

    /// The direction of a texel's centre.
    pub fn direction(&self, column: usize, row: usize) -> Vec3 {
        let longitude = ((column as f64 + 0.5) / self.width as f64 - 0.5) * 2.0 * PI;
        let polar = (row as f64 + 0.5) / self.height as f64 * PI;
        [polar.sin() * longitude.cos(), polar.cos(), polar.sin() * longitude.sin()]
    }

    /// The solid angle of a texel of a row, in steradians.
    pub fn solid_angle(&self, row: usize) -> f64 {
        let edge = |row: usize| (PI * row as f64 / self.height as f64).cos();
        2.0 * PI / self.width as f64 * (edge(row) - edge(row + 1))
    }
}

/// The reference integral by `rings * spokes` equal-weight samples of eqs. 2 to 4 about `axis`,
/// stratified in both dimensions. `normal` decides what is below the horizon.
///
/// The result tends to the integral as long as neighbouring samples are closer than a texel:
/// use it for narrow lobes, and [`integrate_over_texels`] for wide ones.
pub fn integrate_over_lobe(
    map: &Map,
    axis: Vec3,
    normal: Vec3,
    t: f64,
    horizon: Horizon,
    rings: usize,
    spokes: usize,
) -> [f64; 3] {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for ring in 0..rings {
        let theta = sample_angle(t, (ring as f64 + 0.5) / rings as f64);
        for spoke in 0..spokes {
            // The golden ratio staggers the rings, so that spokes do not line up with texels.
            let turn = (spoke as f64 + 0.5) / spokes as f64 + ring as f64 * 0.618_033_988_749_895;
            let direction = around(axis, theta, 2.0 * PI * turn);
            if horizon == Horizon::Discard && dot(direction, normal) < 0.0 {
                continue;
            }
            let radiance = map.sample(direction);
            sum = add_scaled(sum, radiance, 1.0);
            count += 1.0;
        }
    }
    if count > 0.0 { sum.map(|x| x / count) } else { map.sample(axis) }
}

/// The published method: `rays` directions of a golden-angle spiral about `axis`, without rotation.
pub fn paper(
    map: &Map,
    axis: Vec3,
    normal: Vec3,
    t: f64,
    horizon: Horizon,
    rays: u32,
    distribution: Distribution,
) -> [f64; 3] {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for ray in 0..rays {
        let xi = (f64::from(ray) + 0.5) / f64::from(rays);
        let theta = match distribution {
            Distribution::Cosine => sample_angle(t, xi),
            Distribution::UniformAngle => t * FRAC_PI_2 * xi,
        };
        let direction = around(axis, theta, 2.0 * PI * (f64::from(ray) * 0.618_033_988_749_895).fract());
        if horizon == Horizon::Keep || dot(direction, normal) >= 0.0 {
            sum = add_scaled(sum, map.sample(direction), 1.0);
            count += 1.0;
        }
    }
    if count > 0.0 { sum.map(|x| x / count) } else { map.sample(axis) }
}

/// The reference integral as a sum over texels, each divided into `parts * parts`: radiance times
/// density times solid angle, renormalised. Exact in the limit of lobes much wider than a part,
/// however bright a texel is.
pub fn integrate_over_texels(
    map: &Map,
    axis: Vec3,
    normal: Vec3,
    t: f64,
    horizon: Horizon,
    parts: usize,
) -> [f64; 3] {
    // A map of the parts has their directions and solid angles.
    let fine = Map { width: map.width * parts, height: map.height * parts, texels: Vec::new() };
    let (mut sum, mut weights) = ([0.0; 3], 0.0);
    for row in 0..fine.height {
        let solid_angle = fine.solid_angle(row);
        for column in 0..fine.width {
            let direction = fine.direction(column, row);
            if horizon == Horizon::Discard && dot(direction, normal) < 0.0 {
                continue;
            }
            let apart = add_scaled(direction, axis, -1.0);
            let weight = density(t, 2.0 * (0.5 * dot(apart, apart).sqrt()).min(1.0).asin()) * solid_angle;
            if weight > 0.0 {
                let radiance =
                    if parts == 1 { map.texels[row * map.width + column] } else { map.sample(direction) };
                sum = add_scaled(sum, radiance, weight);
                weights += weight;
            }
        }
    }
    if weights > 0.0 { sum.map(|x| x / weights) } else { map.sample(axis) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_density_integrates_to_one_and_matches_the_sampling() {
        for t in [0.01, 0.1, 0.5, 0.9, 1.0] {
            let steps = 20_000;
            let (mut total, mut below_median) = (0.0, 0.0);
            let median = sample_angle(t, 0.5);
            for step in 0..steps {
                let theta = t * FRAC_PI_2 * (step as f64 + 0.5) / steps as f64;
                let mass = density(t, theta) * 2.0 * PI * theta.sin() * t * FRAC_PI_2 / steps as f64;
                total += mass;
                if theta < median {
                    below_median += mass;
                }
            }
            assert!((total - 1.0).abs() < 1e-6, "t {t}: {total}");
            assert!((below_median - 0.5).abs() < 1e-4, "t {t}: {below_median}");
        }
    }

    #[test]
    fn at_full_roughness_the_lobe_is_the_cosine() {
        for theta in [0.0, 0.3, 1.0, 1.5] {
            assert!((density(1.0, theta) - f64::cos(theta) / PI).abs() < 1e-12);
        }
        let coefficients = legendre_coefficients(1.0, 4);
        // Ramamoorthi and Hanrahan 2001: 1, 2/3, 1/4, 0, -1/24.
        for (found, expected) in coefficients.iter().zip([1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0]) {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }

    #[test]
    fn the_first_band_has_its_closed_form() {
        for t in [0.05, 0.3, 0.7, 1.0] {
            let closed = 2.0 * (1.0 + (FRAC_PI_2 * t).cos()) / (4.0 - t * t);
            assert!((legendre_coefficients(t, 1)[1] - closed).abs() < 1e-9);
        }
    }

    #[test]
    fn the_root_mean_square_cone_angle_is_49_degrees_times_t() {
        let steps = 100_000;
        let mean: f64 =
            (0..steps).map(|i| sample_angle(1.0, (i as f64 + 0.5) / steps as f64).powi(2)).sum::<f64>()
                / steps as f64;
        assert!((mean.sqrt().to_degrees() - 49.08).abs() < 0.01);
    }

    #[test]
    fn the_base_goes_from_mirror_to_normal_and_survives_cancellation() {
        let (normal, view) = ([0.0, 1.0, 0.0], normalize_or([1.0, -1.0, 0.0], [0.0; 3]));
        let reflected = mirror(view, normal);
        for mode in [Base::Lerp, Base::Slerp] {
            assert!(dot(base(reflected, normal, 0.0, mode), reflected) > 1.0 - 1e-12);
            assert!(dot(base(reflected, normal, 1.0, mode), normal) > 1.0 - 1e-12);
            assert!(dot(base([0.0, -1.0, 0.0], normal, 0.5, mode), normal) > 1.0 - 1e-12);
        }
    }

    #[test]
    fn lerp_dips_below_the_horizon_only_at_grazing_incidence_and_slerp_never() {
        let normal = [0.0, 1.0, 0.0];
        let lowest = |incidence_deg: f64, t: f64, mode| {
            let incidence = incidence_deg.to_radians();
            let axis = base([incidence.sin(), incidence.cos(), 0.0], normal, t, mode);
            // The lobe's lowest direction, in degrees above the horizon.
            90.0 - dot(axis, normal).acos().to_degrees() - 90.0 * t
        };
        let (mut worst_lerp, mut worst_slerp) = (f64::MAX, f64::MAX);
        for step in 0..=1000 {
            let t = step as f64 / 1000.0;
            assert!(lowest(85.2, t, Base::Lerp) > -1e-6);
            worst_lerp = worst_lerp.min(lowest(90.0, t, Base::Lerp));
            worst_slerp = worst_slerp.min(lowest(90.0, t, Base::Slerp));
        }
        assert!((worst_lerp + 4.08).abs() < 0.02, "{worst_lerp}");
        assert!(worst_slerp > -1e-6);
    }

    #[test]
    fn the_two_reference_integrals_agree() {
        let (width, height) = (128, 64);
        let texels = (0..width * height)
            .map(|i| {
                let (x, y) = ((i % width) as f64 / width as f64, (i / width) as f64 / height as f64);
                [1.0 + (2.0 * PI * 3.0 * x).sin() * (3.0 * y).sin(), y, if x < 0.3 { 4.0 } else { 0.1 }]
            })
            .collect();
        let map = Map { width, height, texels };
        let axis = normalize_or([0.3, 0.4, -0.8], [0.0; 3]);
        for t in [0.3, 0.6, 1.0] {
            let a = integrate_over_lobe(&map, axis, axis, t, Horizon::Discard, 256, 512);
            let b = integrate_over_texels(&map, axis, axis, t, Horizon::Discard, 2);
            for channel in 0..3 {
                assert!((a[channel] / b[channel] - 1.0).abs() < 2e-3, "t {t}: {a:?} {b:?}");
            }
        }
    }
}
