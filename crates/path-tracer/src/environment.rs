//! Light from the environment map: its radiance, and drawing directions in proportion to it.

#[cfg(test)]
mod tests;

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use scene::Environment;

/// Draws directions with a density that is constant over each texel and in proportion to the mean
/// of the *bilinear* radiance there. That mean takes in the texel's eight neighbours, so no
/// direction that shines has density zero, and a texel's glow into its neighbours is found too.
///
/// Takes 20 bytes a texel: its own copy of the radiance, and running sums in f64.
pub(crate) struct EnvironmentSampler {
    map: Map,
    intensity: f64,
    /// Sine and cosine of the rotation about +Y.
    rotation: (f64, f64),
    /// For each texel the sum of the weights from its row's first to itself.
    row_sums: Vec<f64>,
    /// For each row the sum of weights times solid angle from the first row to itself.
    sums: Vec<f64>,
}

impl EnvironmentSampler {
    /// None where no light comes from anywhere, or the map's size is not its number of pixels.
    pub(crate) fn new(environment: &Environment) -> Option<Self> {
        let map = Map::new(environment)?;
        let intensity = f64::from(environment.intensity);
        if !(intensity > 0.0 && intensity.is_finite()) {
            return None;
        }
        let mut row_sums: Vec<f64> = Vec::with_capacity(map.pixels.len());
        for row in 0..map.height {
            row_sums.extend(running_sums(&map.mean_weights(row)));
        }
        let row_weights: Vec<f64> = row_sums
            .chunks_exact(map.width)
            .enumerate()
            .map(|(row, sums)| sums.last().copied().unwrap_or(0.0) * map.solid_angle(row))
            .collect();
        let sums = running_sums(&row_weights);
        let total = sums.last().copied().unwrap_or(0.0);
        let turn = f64::from(environment.rotation_rad);
        let rotation = if turn.is_finite() { turn.sin_cos() } else { (0.0, 1.0) };
        (total > 0.0 && total.is_finite()).then_some(Self { map, intensity, rotation, row_sums, sums })
    }

    /// A direction in world space and its density per steradian, from two numbers of 0..1 (with
    /// all digits of an f64: one of them chooses among rows, the other among columns, and what is
    /// left of them places the direction inside the texel).
    pub(crate) fn sample(&self, u: [f64; 2]) -> Option<(DVec3, f64)> {
        let (row, down) = pick(&self.sums, u[1])?;
        let (column, along) = pick(self.row(row), u[0])?;
        let [top, bottom] = self.map.edges(row);
        let y = (top + (bottom - top) * down).clamp(-1.0, 1.0);
        let radius = ((1.0 - y) * (1.0 + y)).sqrt();
        let azimuth = TAU * ((column as f64 + along) / self.map.width as f64 - 0.5);
        let own = DVec3::new(radius * azimuth.cos(), y, radius * azimuth.sin());
        Some((self.world_from_own(own), self.density(column, row)))
    }

    /// The density per steradian with which a unit direction of the world is drawn.
    pub(crate) fn pdf(&self, direction_world: DVec3) -> f64 {
        let [u, v] = uv_of(self.own_from_world(direction_world));
        let index = |at: f64, count: usize| ((at * count as f64) as usize).min(count - 1);
        self.density(index(u, self.map.width), index(v, self.map.height))
    }

    /// The radiance that arrives from a unit direction of the world.
    pub(crate) fn radiance(&self, direction_world: DVec3) -> [f64; 3] {
        self.map.bilinear(self.own_from_world(direction_world)).map(|value| value * self.intensity)
    }

    fn density(&self, column: usize, row: usize) -> f64 {
        let share = |sums: &[f64], index| match sums.last() {
            Some(&total) if total > 0.0 => difference(sums, index) / total,
            _ => 0.0,
        };
        share(&self.sums, row) * share(self.row(row), column) / self.map.solid_angle(row)
    }

    fn row(&self, row: usize) -> &[f64] {
        self.row_sums.get(row * self.map.width..(row + 1) * self.map.width).unwrap_or(&[])
    }

    fn own_from_world(&self, v: DVec3) -> DVec3 {
        let (sine, cosine) = self.rotation;
        DVec3::new(cosine * v.x - sine * v.z, v.y, sine * v.x + cosine * v.z)
    }

    fn world_from_own(&self, v: DVec3) -> DVec3 {
        let (sine, cosine) = self.rotation;
        DVec3::new(cosine * v.x + sine * v.z, v.y, cosine * v.z - sine * v.x)
    }
}

/// u and v in 0..=1 of a unit direction in the environment's own space.
fn uv_of(own: DVec3) -> [f64; 2] {
    // From the longer of sine and cosine: acos alone has no digits near the poles.
    let polar = own.x.hypot(own.z).atan2(own.y);
    [0.5 + own.z.atan2(own.x) / TAU, polar / PI]
}

/// The sums of the weights from the first to each. Next to a sun, weights above zero are raised to
/// a millionth of the mean, lest they drown in rounding and can never be drawn.
fn running_sums(weights: &[f64]) -> Vec<f64> {
    let least = 1e-6 * weights.iter().sum::<f64>() / weights.len() as f64;
    let mut sum = 0.0;
    let mut add = |&weight: &f64| {
        sum += if weight > 0.0 { weight.max(least) } else { 0.0 };
        sum
    };
    weights.iter().map(&mut add).collect()
}

/// The entry whose part of the running sums holds `u` (0..1), and how far into it, 0..1.
fn pick(sums: &[f64], u: f64) -> Option<(usize, f64)> {
    let total = *sums.last()?;
    let target = if u > 0.0 { u.min(1.0 - f64::EPSILON) * total } else { 0.0 };
    // Entries of no weight end where the one before them ends, so they are stepped over.
    let index = sums.partition_point(|&sum| sum <= target).min(sums.len() - 1);
    let part = difference(sums, index);
    let start = sums.get(index)? - part;
    (part > 0.0).then(|| (index, ((target - start) / part).clamp(0.0, 1.0)))
}

/// An entry's own part of running sums.
fn difference(sums: &[f64], index: usize) -> f64 {
    let at = |index| sums.get(index).copied().unwrap_or(0.0);
    if index == 0 { at(0) } else { at(index) - at(index - 1) }
}

/// Texels of a latitude-longitude map; u wraps, v is clamped.
struct Map {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
}

impl Map {
    fn new(environment: &Environment) -> Option<Self> {
        let (width, height) = (environment.width as usize, environment.height as usize);
        let fits = width > 0 && height > 0 && width.checked_mul(height) == Some(environment.pixels.len());
        fits.then(|| Self { width, height, pixels: environment.pixels.clone() })
    }

    /// The row's upper and lower edge as y = cos(polar angle).
    fn edges(&self, row: usize) -> [f64; 2] {
        [row, row + 1].map(|edge| (PI * edge as f64 / self.height as f64).cos())
    }

    /// The solid angle of a row's texels, times width.
    fn solid_angle(&self, row: usize) -> f64 {
        let [top, bottom] = self.edges(row);
        TAU * (top - bottom) / self.width as f64
    }

    fn texel(&self, column: i64, row: i64) -> [f64; 3] {
        let column = column.rem_euclid(self.width as i64) as usize;
        let row = row.clamp(0, self.height as i64 - 1) as usize;
        self.pixels.get(row * self.width + column).map_or([0.0; 3], |texel| texel.map(f64::from))
    }

    fn bilinear(&self, own: DVec3) -> [f64; 3] {
        let [u, v] = uv_of(own);
        let (x, y) = (u * self.width as f64 - 0.5, v * self.height as f64 - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let (right, down) = (x - column, y - row);
        let corner = |dx: i64, dy: i64| self.texel(column as i64 + dx, row as i64 + dy);
        let corners = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
        std::array::from_fn(|i| {
            let upper = corners[0][i] * (1.0 - right) + corners[1][i] * right;
            let lower = corners[2][i] * (1.0 - right) + corners[3][i] * right;
            upper * (1.0 - down) + lower * down
        })
    }

    /// The mean over each texel of a row of the bilinear map, channels added up. Along one axis a
    /// texel's tent leaves 3/4 in itself and 1/8 in each neighbour.
    fn mean_weights(&self, row: usize) -> Vec<f64> {
        let (row, width) = (row as i64, self.width);
        let sum = |column: usize, row: i64| self.texel(column as i64, row).iter().sum::<f64>();
        let tent = |before: f64, own: f64, after: f64| 0.125 * (before + after) + 0.75 * own;
        let down: Vec<f64> =
            (0..width).map(|x| tent(sum(x, row - 1), sum(x, row), sum(x, row + 1))).collect();
        let at = |column: usize| down.get(column % width).copied().unwrap_or(0.0);
        (0..width).map(|x| tent(at(x + width - 1), at(x), at(x + 1))).collect()
    }
}
