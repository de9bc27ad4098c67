//! Whether samples follow a density: Pearson's test over bins of directions, for tests alone.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::frame::Frame;

/// A division of the sphere into bins by circles about an axis and by half planes through it.
pub(crate) struct Bins {
    frame: Frame,
    /// Angles from the axis, from 0 up; pi where they divide the whole sphere.
    circles: Vec<f64>,
    turns: usize,
}

impl Bins {
    /// Bins of equal solid angle about an axis.
    pub(crate) fn even(axis: DVec3, rings: usize, turns: usize) -> Self {
        let circle = |ring: usize| (1.0 - 2.0 * ring as f64 / rings as f64).acos();
        Self { frame: Frame::new(axis), circles: (0..=rings).map(circle).collect(), turns }
    }

    /// Bins whose circles are `narrowest` and then grow by equal factors.
    pub(crate) fn growing(axis: DVec3, narrowest: f64, rings: usize, turns: usize) -> Self {
        let circle = |ring: usize| narrowest * (PI / narrowest).powf(ring as f64 / (rings - 1) as f64);
        let circles = std::iter::once(0.0).chain((0..rings).map(circle)).collect();
        Self { frame: Frame::new(axis), circles, turns }
    }

    /// Bins of equal solid angle within an angle of an axis, and the rest of the sphere.
    pub(crate) fn within(axis: DVec3, angle: f64, rings: usize, turns: usize) -> Self {
        let circle = |ring: usize| 2.0 * ((ring as f64 / rings as f64).sqrt() * (0.5 * angle).sin()).asin();
        let circles = (0..=rings).map(circle).chain([PI]).collect();
        Self { frame: Frame::new(axis), circles, turns }
    }

    fn len(&self) -> usize {
        (self.circles.len() - 1) * self.turns
    }

    fn index(&self, direction: DVec3) -> usize {
        let local = self.frame.local_from_world(direction);
        let angle = local.x.hypot(local.y).atan2(local.z);
        let ring = self.circles.partition_point(|&circle| circle <= angle).clamp(1, self.circles.len() - 1);
        let turn = local.y.atan2(local.x).rem_euclid(TAU) / TAU * self.turns as f64;
        (ring - 1) * self.turns + (turn as usize).min(self.turns - 1)
    }

    fn direction(&self, angle: f64, azimuth: f64) -> DVec3 {
        let (sine, cosine) = angle.sin_cos();
        let local = DVec3::new(sine * azimuth.cos(), sine * azimuth.sin(), cosine);
        self.frame.world_from_local(local).normalize()
    }

    /// The integral of a density over a bin.
    fn mass(&self, density: &dyn Fn(DVec3) -> f64, bin: usize) -> f64 {
        let (ring, turn) = (bin / self.turns, bin % self.turns);
        let azimuth = |turn: usize| TAU * turn as f64 / self.turns as f64;
        let rect = [self.circles[ring], self.circles[ring + 1], azimuth(turn), azimuth(turn + 1)];
        integrate(&|angle, azimuth| density(self.direction(angle, azimuth)) * angle.sin(), rect, 1e-5)
    }
}

/// What came of a test.
#[derive(Debug)]
pub(crate) struct Outcome {
    /// The chance that samples of the density would differ from it by as much.
    pub(crate) p_value: f64,
    /// The density's integral.
    pub(crate) total: f64,
}

/// Draws `count` samples (None: nothing was drawn) and compares how many fall into each bin with
/// the integrals of the density. What the density lacks to one is expected to be None.
pub(crate) fn test(
    bins: &Bins,
    density: &dyn Fn(DVec3) -> f64,
    sample: &mut dyn FnMut() -> Option<DVec3>,
    count: usize,
) -> Outcome {
    let mut found = vec![0.0; bins.len() + 1];
    for _ in 0..count {
        found[sample().map_or(bins.len(), |direction| bins.index(direction))] += 1.0;
    }
    let masses: Vec<f64> = (0..bins.len()).map(|bin| bins.mass(density, bin)).collect();
    let total: f64 = masses.iter().sum();
    let lost = (1.0 - total).max(0.0);
    let expected: Vec<f64> = masses.iter().chain([&lost]).map(|mass| mass * count as f64).collect();
    Outcome { p_value: p_value(&found, &expected), total }
}

/// Pearson's test; bins of fewer than five expected samples are pooled. A sample where none can
/// be is a certain failure.
pub(crate) fn p_value(found: &[f64], expected: &[f64]) -> f64 {
    let (mut statistic, mut cells) = (0.0, 0);
    let (mut pooled_found, mut pooled_expected) = (0.0, 0.0);
    let mut add = |found: f64, expected: f64| {
        statistic += (found - expected).powi(2) / expected;
        cells += 1;
    };
    for (&found, &expected) in found.iter().zip(expected) {
        if expected >= 5.0 {
            add(found, expected);
            continue;
        }
        // A few in 10^5 fall on the other side of an edge by rounding.
        if expected <= 1e-6 && found > 2.0 {
            return 0.0;
        }
        pooled_found += found;
        pooled_expected += expected;
    }
    if pooled_expected >= 5.0 {
        add(pooled_found, pooled_expected);
    } else if pooled_found > pooled_expected + 25.0 {
        return 0.0;
    }
    if cells < 2 { 1.0 } else { upper_gamma(0.5 * (cells - 1) as f64, 0.5 * statistic) }
}

/// The significance at which one of `tests` independent tests may fail, if all together may with
/// a chance of 1 % (Sidak).
pub(crate) fn significance(tests: usize) -> f64 {
    1.0 - 0.99_f64.powf(1.0 / tests as f64)
}

/// The regularised upper incomplete gamma function Q(a, x): by its series below x = a + 1, by
/// Lentz's continued fraction above.
fn upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let factor = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > 1e-16 * sum {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        return 1.0 - factor * sum;
    }
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1e300, 1.0 / b);
    let mut fraction = d;
    for i in 1..10_000 {
        let i = f64::from(i);
        let an = -i * (i - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        fraction *= c * d;
        if (c * d - 1.0).abs() < 1e-15 {
            break;
        }
    }
    factor * fraction
}

/// The logarithm of the gamma function, by Stirling's series above 20.
fn ln_gamma(x: f64) -> f64 {
    if x < 20.0 {
        return ln_gamma(x + 1.0) - x.ln();
    }
    let squared = x * x;
    let series =
        (1.0 / 12.0 - (1.0 / 360.0 - (1.0 / 1260.0 - 1.0 / (1680.0 * squared)) / squared) / squared) / x;
    (x - 0.5) * x.ln() - x + 0.5 * TAU.ln() + series
}

/// The integral over a rectangle [x0, x1, y0, y1], by Gauss rules on quarters of it as long as
/// those change the result by more than `tolerance`.
pub(crate) fn integrate(f: &dyn Fn(f64, f64) -> f64, rect: [f64; 4], tolerance: f64) -> f64 {
    fn rule(f: &dyn Fn(f64, f64) -> f64, [x0, x1, y0, y1]: [f64; 4]) -> f64 {
        // Gauss-Legendre of four points.
        const POINTS: [(f64, f64); 4] = [
            (-0.8611363115940526, 0.34785484513745385),
            (-0.33998104358485626, 0.6521451548625461),
            (0.33998104358485626, 0.6521451548625461),
            (0.8611363115940526, 0.34785484513745385),
        ];
        let (half_x, half_y) = (0.5 * (x1 - x0), 0.5 * (y1 - y0));
        let mut sum = 0.0;
        for (a, weight_a) in POINTS {
            for (b, weight_b) in POINTS {
                sum += weight_a * weight_b * f(x0 + half_x * (1.0 + a), y0 + half_y * (1.0 + b));
            }
        }
        sum * half_x * half_y
    }
    fn refine(f: &dyn Fn(f64, f64) -> f64, rect: [f64; 4], whole: f64, tolerance: f64, depth: u32) -> f64 {
        let [x0, x1, y0, y1] = rect;
        let (x, y) = (0.5 * (x0 + x1), 0.5 * (y0 + y1));
        let quarters = [[x0, x, y0, y], [x, x1, y0, y], [x0, x, y, y1], [x, x1, y, y1]];
        let parts = quarters.map(|quarter| rule(f, quarter));
        let sum: f64 = parts.iter().sum();
        if depth == 0 || (depth < 10 && (sum - whole).abs() <= tolerance) {
            return sum;
        }
        (0..4).map(|i| refine(f, quarters[i], parts[i], 0.5 * tolerance, depth - 1)).sum()
    }
    refine(f, rect, rule(f, rect), tolerance, 10)
}

/// Reproducible numbers of 0..1 (`SplitMix64`).
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn three(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.next())
    }
}

#[test]
fn the_gamma_function_has_known_values() {
    // Q(1/2, x) = erfc(sqrt x), Q(1, x) = exp(-x); 95 % quantiles of chi-squared at 10 and 100.
    assert!((upper_gamma(0.5, 1.0) - 0.15729920705028513).abs() < 1e-13);
    assert!((upper_gamma(1.0, 0.3) - (-0.3_f64).exp()).abs() < 1e-14);
    assert!((upper_gamma(5.0, 0.5 * 18.307038053275146) - 0.05).abs() < 1e-12);
    assert!((upper_gamma(50.0, 0.5 * 124.34211340400407) - 0.05).abs() < 1e-12);
    assert!((ln_gamma(0.5) - 0.5 * PI.ln()).abs() < 1e-14);
}

#[test]
fn a_wrong_density_is_found_out() {
    let mut numbers = Numbers(1);
    let mut uniform = || {
        let [u, v, _] = numbers.three();
        let (z, turn) = (1.0 - 2.0 * u, TAU * v);
        let radius = (1.0 - z * z).sqrt();
        Some(DVec3::new(radius * turn.cos(), radius * turn.sin(), z))
    };
    let bins = Bins::even(DVec3::new(0.6, 0.0, 0.8), 10, 20);
    let right = test(&bins, &|_| 0.25 / PI, &mut uniform, 100_000);
    assert!(right.p_value > 0.01 && (right.total - 1.0).abs() < 1e-6, "{right:?}");
    // 6 % more on one side than in the middle.
    let wrong = test(&bins, &|d| 0.25 / PI * (1.0 + 0.06 * d.z), &mut uniform, 100_000);
    assert!(wrong.p_value < 1e-4, "{wrong:?}");
    // 1 % of the samples lost.
    let mut lossy = {
        let mut count = 0;
        move || {
            count += 1;
            if count % 100 == 0 { None } else { uniform() }
        }
    };
    let lossy = test(&bins, &|_| 0.25 / PI, &mut lossy, 100_000);
    assert!(lossy.p_value < 1e-4, "{lossy:?}");
}
