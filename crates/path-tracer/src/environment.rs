//! Light from the environment map: its radiance, and drawing directions in proportion to it.

#[cfg(test)]
mod tests;

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use scene::Environment;

/// Draws directions with a density in proportion to the *bilinear* radiance, so that a sun is found
/// with its glow into the neighbouring texels, and no direction that shines has density zero.
///
/// The cells are those between four neighbouring texels' centres (half as high at the poles). A
/// cell is chosen by its mean radiance and solid angle; inside it the density is bilinear between
/// the corners, in longitude and in height on the axis. The latter instead of the polar angle
/// spares a factor that is infinite at the poles.
///
/// Takes 20 bytes a texel (its own copy of the radiance, and running sums in f64): 10 MB at
/// 1024 x 512, 671 MB at 8192 x 4096.
pub(crate) struct EnvironmentSampler {
    map: Map,
    intensity: f64,
    /// Sine and cosine of the rotation about +Y.
    rotation: (f64, f64),
    /// For each cell the sum of mean radiances from its row's first to itself.
    row_sums: Vec<f64>,
    /// For each row of cells the sum of radiance times solid angle from the first to itself.
    sums: Vec<f64>,
}

/// A place in the division of the map into cells: column, row and position inside, 0..=1.
struct Place {
    column: usize,
    row: usize,
    along: f64,
    down: f64,
}

impl EnvironmentSampler {
    /// None where no light comes from anywhere, or the map's size is not its number of pixels.
    pub(crate) fn new(environment: &Environment) -> Option<Self> {
        let map = Map::new(environment)?;
        let intensity = f64::from(environment.intensity);
        if !(intensity > 0.0 && intensity.is_finite()) {
            return None;
        }
        let mut row_sums: Vec<f64> = Vec::with_capacity((map.height + 1) * map.width);
        for row in 0..=map.height {
            let means: Vec<f64> = (0..map.width).map(|column| mean(map.corners(column, row))).collect();
            row_sums.extend(running_sums(&means));
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
    /// left of them places the direction inside the cell).
    pub(crate) fn sample(&self, u: [f64; 2]) -> Option<(DVec3, f64)> {
        let (row, left_down) = pick(&self.sums, u[1])?;
        let (column, left_along) = pick(self.row(row), u[0])?;
        let [upper, lower] = raised(self.map.corners(column, row));
        let down = linear(upper[0] + upper[1], lower[0] + lower[1], left_down);
        let along = linear(lerp(upper[0], lower[0], down), lerp(upper[1], lower[1], down), left_along);
        let place = Place { column, row, along, down };
        let own = self.map.direction(&place);
        Some((self.world_from_own(own), self.density(&place)))
    }

    /// The density per steradian with which a unit direction of the world is drawn.
    pub(crate) fn pdf(&self, direction_world: DVec3) -> f64 {
        self.density(&self.map.place(self.own_from_world(direction_world)))
    }

    /// The radiance that arrives from a unit direction of the world.
    pub(crate) fn radiance(&self, direction_world: DVec3) -> [f64; 3] {
        self.map.bilinear(self.own_from_world(direction_world)).map(|value| value * self.intensity)
    }

    fn density(&self, place: &Place) -> f64 {
        let Place { column, row, along, down } = *place;
        let chance = self.chance(column, row);
        if chance <= 0.0 {
            return 0.0;
        }
        let corners = raised(self.map.corners(column, row));
        let [upper, lower] = corners.map(|[left, right]| lerp(left, right, along));
        chance * lerp(upper, lower, down) / (mean(corners) * self.map.solid_angle(row))
    }

    /// The chance of a cell.
    fn chance(&self, column: usize, row: usize) -> f64 {
        let share = |sums: &[f64], index| match sums.last() {
            Some(&total) if total > 0.0 => difference(sums, index) / total,
            _ => 0.0,
        };
        share(&self.sums, row) * share(self.row(row), column)
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

/// A cell's corners, raised a little so that none of them is black beside one that shines.
fn raised(corners: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let least = 1e-3 * mean(corners);
    corners.map(|row| row.map(|corner| corner + least))
}

fn mean(corners: [[f64; 2]; 2]) -> f64 {
    0.25 * corners.as_flattened().iter().sum::<f64>()
}

fn lerp(a: f64, b: f64, share: f64) -> f64 {
    a + (b - a) * share
}

/// The position in 0..=1, under a density that goes linearly from `a` to `b`, below which a share
/// `u` of it lies.
fn linear(a: f64, b: f64, u: f64) -> f64 {
    let root = lerp(a * a, b * b, u).max(0.0).sqrt();
    if a + root > 0.0 { (u * (a + b) / (a + root)).min(1.0) } else { u }
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

    /// Channels added up at a cell's corners: upper left and right, lower left and right.
    fn corners(&self, column: usize, row: usize) -> [[f64; 2]; 2] {
        let sum = |x: usize, y: i64| self.texel(x as i64, y).iter().sum::<f64>();
        [row as i64 - 1, row as i64].map(|y| [sum(column, y), sum(column + 1, y)])
    }

    /// The upper and lower edge of a row of cells as y = cos(polar angle). There is a row more than
    /// of texels; the first and the last reach from a pole to the centres of its texels.
    fn edges(&self, row: usize) -> [f64; 2] {
        [row, row + 1].map(|edge| (PI * ((edge as f64 - 0.5) / self.height as f64).clamp(0.0, 1.0)).cos())
    }

    /// The solid angle of each cell of a row.
    fn solid_angle(&self, row: usize) -> f64 {
        let [top, bottom] = self.edges(row);
        TAU * (top - bottom) / self.width as f64
    }

    /// The unit direction, in the environment's own space, of a place.
    fn direction(&self, place: &Place) -> DVec3 {
        let [top, bottom] = self.edges(place.row);
        let y = lerp(top, bottom, place.down).clamp(-1.0, 1.0);
        let radius = ((1.0 - y) * (1.0 + y)).sqrt();
        let azimuth = TAU * ((place.column as f64 + 0.5 + place.along) / self.width as f64 - 0.5);
        DVec3::new(radius * azimuth.cos(), y, radius * azimuth.sin())
    }

    fn place(&self, own: DVec3) -> Place {
        let [u, v] = uv_of(own);
        let x = u * self.width as f64 - 0.5;
        let column = (x.floor() as i64).rem_euclid(self.width as i64) as usize;
        let row = ((v * self.height as f64 + 0.5) as usize).min(self.height);
        let [top, bottom] = self.edges(row);
        let down = ((top - own.y) / (top - bottom)).clamp(0.0, 1.0);
        Place { column, row, along: x - x.floor(), down }
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
}
