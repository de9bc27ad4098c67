//! The technique's own integral in f64, exact enough to judge by.
//!
//! The lobe is summed over the map's texels, each divided into parts where the lobe is narrow:
//! bilinear radiance times density times solid angle, renormalised. A midpoint sum of a smooth
//! density converges with the square of the step, however bright a texel is. The density is
//! tabulated over the squared chord, in which it is smooth on the axis too.

use diffuse_envmap::{
    Horizon,
    model::{self, Map, Vec3},
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Steps of the sum per root mean square angle of the lobe: the error is below 2e-4 of the peak
/// even of a single bright texel.
const STEPS_PER_WIDTH: f64 = 32.0;
/// Root mean square angle of the lobe over t, radians.
const WIDTH: f64 = 0.8566;
/// Intervals of the tabulated density.
const INTERVALS: usize = 4096;
/// A texel is divided into no more parts than this per side.
const MOST_PARTS: usize = 64;

/// The integral of the lobe over one map.
#[derive(Debug)]
pub(super) struct Truth<'a> {
    map: &'a Map,
    fineness: usize,
}

/// The density of a lobe as a function of the squared chord between direction and axis.
struct Table {
    values: Vec<f64>,
    per_square: f64,
}

impl Table {
    fn new(t: f64) -> Self {
        let rim = (t * FRAC_PI_2).min(PI);
        let last = (2.0 * (0.5 * rim).sin()).powi(2);
        let angle = |i: usize| 2.0 * (0.5 * (last * i as f64 / INTERVALS as f64).sqrt()).min(1.0).asin();
        let mut values: Vec<f64> = (0..=INTERVALS).map(|i| model::density(t, angle(i))).collect();
        // One beyond the rim, for interpolation.
        values.push(0.0);
        Self { values, per_square: INTERVALS as f64 / last }
    }

    fn at(&self, squared_chord: f64) -> f64 {
        let place = squared_chord.max(0.0) * self.per_square;
        let index = place as usize;
        if index >= INTERVALS {
            return 0.0;
        }
        let fraction = place - index as f64;
        self.values[index] + fraction * (self.values[index + 1] - self.values[index])
    }
}

/// A direction as the sum sees it.
struct Lobe {
    axis: Vec3,
    normal: Vec3,
    horizon: Horizon,
    table: Table,
}

#[derive(Default)]
struct Sum {
    radiance: [f64; 3],
    weight: f64,
}

impl<'a> Truth<'a> {
    /// The integral over a map.
    pub(super) fn new(map: &'a Map) -> Self {
        Self { map, fineness: 1 }
    }

    /// The same with twice as many steps a side, to learn how far the sum is off.
    pub(super) fn finer(map: &'a Map) -> Self {
        Self { map, fineness: 2 }
    }

    /// The mean radiance in the lobe of roughness `t` about the unit vector `axis`, without what
    /// is below the plane of `normal` where `horizon` says so. The mirror lookup at t = 0.
    pub(super) fn radiance(&self, axis: Vec3, normal: Vec3, t: f64, horizon: Horizon) -> [f64; 3] {
        if t <= 0.0 {
            return self.map.sample(axis);
        }
        let step = WIDTH * t / STEPS_PER_WIDTH;
        let texel = PI / self.map.height as f64;
        let parts = ((texel / step).ceil() as usize).clamp(1, MOST_PARTS) * self.fineness;
        let lobe = Lobe { axis, normal, horizon, table: Table::new(t) };
        let mut sum = Sum::default();
        let rim = (t * FRAC_PI_2).min(PI);
        let rows = (self.map.height * parts) as f64;
        let polar = axis[1].clamp(-1.0, 1.0).acos();
        let first = ((polar - rim) / PI * rows).floor().max(0.0) as usize;
        let last = ((polar + rim) / PI * rows).ceil().min(rows) as usize;
        for row in first..last {
            self.add_row(&lobe, rim, row, parts, &mut sum);
        }
        if sum.weight > 0.0 { sum.radiance.map(|x| x / sum.weight) } else { self.map.sample(axis) }
    }

    fn add_row(&self, lobe: &Lobe, rim: f64, row: usize, parts: usize, sum: &mut Sum) {
        let (columns, rows) = (self.map.width * parts, self.map.height * parts);
        let polar = (row as f64 + 0.5) / rows as f64 * PI;
        let (sine, cosine) = polar.sin_cos();
        let across = lobe.axis[0].hypot(lobe.axis[2]);
        // The longitudes that the lobe reaches on this row: cos(rim) = a cos(longitude) + b.
        let (a, b) = (sine * across, cosine * lobe.axis[1]);
        let reach = if a > 1e-12 { (rim.cos() - b) / a } else { f64::NEG_INFINITY };
        let half = if reach < -1.0 { PI } else { reach.clamp(-1.0, 1.0).acos() };
        let step = TAU / columns as f64;
        let middle = lobe.axis[2].atan2(lobe.axis[0]) + PI;
        let count = if half >= PI { columns } else { (2.0 * half / step).ceil() as usize + 2 };
        let first = ((middle - half) / step).floor() as i64 - 1;
        let y = (row as f64 + 0.5) / parts as f64 - 0.5;
        let line = Line::new(self.map, y);
        // Successive columns by one rotation each; it drifts by 1e-16 a step.
        let mut along = ((first as f64 + 0.5) * step - PI).sin_cos();
        let turn = step.sin_cos();
        for column in first..first + count.min(columns) as i64 {
            let direction = [sine * along.1, cosine, sine * along.0];
            along = (along.0 * turn.1 + along.1 * turn.0, along.1 * turn.1 - along.0 * turn.0);
            let apart = model::add_scaled(direction, lobe.axis, -1.0);
            let mut weight = lobe.table.at(model::dot(apart, apart)) * sine;
            if lobe.horizon == Horizon::Discard {
                // The part of the cell above the horizon, as if it were a disc's width across.
                let cell = PI / rows as f64;
                weight *= (0.5 + model::dot(direction, lobe.normal) / cell).clamp(0.0, 1.0);
            }
            if weight > 0.0 {
                let x = (column as f64 + 0.5) / parts as f64 - 0.5;
                sum.radiance = model::add_scaled(sum.radiance, line.at(x), weight);
                sum.weight += weight;
            }
        }
    }
}

/// Two rows of the map and where between them.
struct Line<'a> {
    upper: &'a [[f64; 3]],
    lower: &'a [[f64; 3]],
    fraction: f64,
}

impl<'a> Line<'a> {
    fn new(map: &'a Map, y: f64) -> Self {
        let row = |offset: i64| {
            let row = (y.floor() as i64 + offset).clamp(0, map.height as i64 - 1) as usize;
            &map.texels[row * map.width..][..map.width]
        };
        Self { upper: row(0), lower: row(1), fraction: y - y.floor() }
    }

    fn at(&self, x: f64) -> [f64; 3] {
        let width = self.upper.len() as i64;
        let left = (x.floor() as i64).rem_euclid(width) as usize;
        let fraction = x - x.floor();
        if fraction == 0.0 && self.fraction == 0.0 {
            return self.upper[left];
        }
        let right = (left + 1) % self.upper.len();
        std::array::from_fn(|c| {
            let mix = |line: &[[f64; 3]]| line[left][c] + fraction * (line[right][c] - line[left][c]);
            let (upper, lower) = (mix(self.upper), mix(self.lower));
            upper + self.fraction * (lower - upper)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> Map {
        let (width, height) = (64, 32);
        let texel = |i: usize| {
            let (x, y) = (i % width, i / width);
            let spot = if (x, y) == (40, 12) { 50.0 } else { 0.0 };
            [1.0 + (x as f64 * 0.3).sin() + spot, y as f64 / 32.0, if x < 20 { 4.0 } else { 0.1 }]
        };
        Map { width, height, texels: (0..width * height).map(texel).collect() }
    }

    #[test]
    fn it_agrees_with_both_integrals_of_the_model() {
        let map = map();
        let truth = Truth::new(&map);
        let spot = map.direction(40, 12);
        for (axis, tilt) in [(spot, 0.05), ([0.0, 1.0, 0.0], 0.0), ([-1.0, 0.0, 0.0], 0.1), (spot, 0.3)] {
            let axis = model::around(axis, tilt, 1.0);
            let normal = model::around(axis, 1.4, 0.3);
            for horizon in [Horizon::Keep, Horizon::Discard] {
                for t in [0.02, 0.1, 0.3, 0.7, 1.0] {
                    let found = truth.radiance(axis, normal, t, horizon);
                    let exact = if t < 0.5 {
                        model::integrate_over_lobe(&map, axis, normal, t, horizon, 512, 1024)
                    } else {
                        model::integrate_over_texels(&map, axis, normal, t, horizon, 12)
                    };
                    for (x, y) in found.iter().zip(exact) {
                        assert!(
                            (x - y).abs() <= 1e-2 * y.max(0.01),
                            "t {t}, {horizon:?}: {found:?}, {exact:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn it_converges() {
        let map = map();
        let axis = model::around(map.direction(40, 12), 0.1, 2.0);
        for t in [0.03, 0.2, 0.6] {
            let [coarse, fine] = [Truth::new(&map), Truth::finer(&map)]
                .map(|truth| truth.radiance(axis, axis, t, Horizon::Keep));
            for (x, y) in coarse.iter().zip(fine) {
                assert!((x - y).abs() <= 2e-3 * y, "t {t}: {coarse:?}, {fine:?}");
            }
        }
    }
}
