//! Surrounding radiance as a latitude-longitude map.

use std::f32::consts::{PI, TAU};

use glam::{Quat, Vec3};

use crate::Error;

/// Radiance from all directions at infinity.
///
/// For a unit direction d in the environment's own space, u = 0.5 + atan2(d.z, d.x) / 2 pi and
/// v = acos(d.y) / pi; v = 0 is the top row. u wraps, v does not.
#[derive(Clone, Debug)]
pub struct Environment {
    /// The file's name, or a built-in's.
    pub name: String,
    /// Texels per row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Linear radiance, `width * height` texels from the top row, each finite and not negative.
    pub pixels: Vec<[f32; 3]>,
    /// Factor on every pixel, finite and not negative.
    pub intensity: f32,
    /// Turn about +Y in radians, counter-clockwise seen from above: world = rotate(rotation) * own.
    pub rotation_rad: f32,
    /// What was replaced when the pixels were read.
    pub repairs: Repairs,
}

impl Environment {
    /// An environment of intensity 1 and no rotation from raw radiance, `width * height` texels
    /// from the top row. Values that are no radiance are replaced and counted in `repairs`. An
    /// error if a side is 0 or the number of pixels does not fit.
    pub fn new(
        name: impl Into<String>,
        width: u32,
        height: u32,
        mut pixels: Vec<[f32; 3]>,
    ) -> Result<Self, Error> {
        let name = name.into();
        let expected = width as usize * height as usize;
        if expected == 0 || pixels.len() != expected {
            let found = format!("{} pixels for {width} x {height}", pixels.len());
            return Err(Error::new(name, "pixels", found, "width * height, at least 1"));
        }
        let repairs = repair(&mut pixels);
        Ok(Self { name, width, height, pixels, intensity: 1.0, rotation_rad: 0.0, repairs })
    }

    /// The unit direction, in the environment's own space, that (u, v) shows; u of any range,
    /// v in 0..=1.
    pub fn direction_of(u: f32, v: f32) -> Vec3 {
        let (sin_azimuth, cos_azimuth) = (TAU * (u - 0.5)).sin_cos();
        let (sin_polar, cos_polar) = (PI * v).sin_cos();
        Vec3::new(sin_polar * cos_azimuth, cos_polar, sin_polar * sin_azimuth)
    }

    /// The (u, v) in 0..=1 that shows a unit direction of the environment's own space.
    pub fn uv_of(direction: Vec3) -> [f32; 2] {
        let u = 0.5 + direction.z.atan2(direction.x) / TAU;
        [u, direction.y.clamp(-1.0, 1.0).acos() / PI]
    }

    /// Radiance as stored (no intensity, no rotation) from a unit direction of the environment's
    /// own space: bilinear between texel centres, where u wraps and v is clamped.
    pub fn sample(&self, direction: Vec3) -> Vec3 {
        let [u, v] = Self::uv_of(direction);
        let x = u * self.width as f32 - 0.5;
        let y = (v * self.height as f32 - 0.5).clamp(0.0, self.height as f32 - 1.0);
        let (column, row) = (x.floor(), y.floor());
        let (x_weight, y_weight) = (x - column, y - row);
        let [column, row] = [column as i64, row as i64];
        let along_row = |row| self.texel(column, row).lerp(self.texel(column + 1, row), x_weight);
        along_row(row).lerp(along_row(row + 1), y_weight)
    }

    /// Radiance from a unit direction of the world, with rotation and intensity.
    pub fn radiance_world(&self, direction_world: Vec3) -> Vec3 {
        let direction_own = Quat::from_rotation_y(-self.rotation_rad) * direction_world;
        self.sample(direction_own) * self.intensity
    }

    /// Mean radiance over the sphere as stored (no intensity): each texel weighted by its solid
    /// angle.
    pub fn mean_radiance(&self) -> Vec3 {
        let mut sum = [0.0_f64; 3];
        for (row, texels) in self.pixels.chunks_exact(self.width as usize).enumerate() {
            let solid_angle = self.texel_solid_angle(row as u32) as f64;
            for texel in texels {
                for (sum, &radiance) in sum.iter_mut().zip(texel) {
                    *sum += radiance as f64 * solid_angle;
                }
            }
        }
        Vec3::from(sum.map(|sum| (sum / (4.0 * std::f64::consts::PI)) as f32))
    }

    /// Solid angle in steradians of one texel of a row.
    pub fn texel_solid_angle(&self, row: u32) -> f32 {
        Self::solid_angle_of_texel(self.width, self.height, row)
    }

    /// The same for a map of any size.
    pub(crate) fn solid_angle_of_texel(width: u32, height: u32, row: u32) -> f32 {
        use std::f64::consts::{PI, TAU};
        let cos_at = |row: f64| (PI * row / height as f64).cos();
        (TAU / width as f64 * (cos_at(row as f64) - cos_at(row as f64 + 1.0))) as f32
    }

    /// The texel of a column of any range and a row that is clamped.
    fn texel(&self, column: i64, row: i64) -> Vec3 {
        let column = column.rem_euclid(self.width as i64);
        let row = row.clamp(0, self.height as i64 - 1);
        let index = (row * self.width as i64 + column) as usize;
        self.pixels.get(index).copied().map_or(Vec3::ZERO, Vec3::from)
    }
}

/// Replaces what is no radiance; see [`Repairs`].
fn repair(pixels: &mut [[f32; 3]]) -> Repairs {
    let largest =
        pixels.as_flattened().iter().copied().filter(|value| value.is_finite()).fold(0.0_f32, f32::max);
    let mut repairs = Repairs::default();
    for value in pixels.as_flattened_mut() {
        if value.is_nan() {
            repairs.nan += 1;
            *value = 0.0;
        } else if *value < 0.0 {
            repairs.negative += 1;
            *value = 0.0;
        } else if value.is_infinite() {
            repairs.infinite += 1;
            *value = largest;
        }
    }
    repairs
}

/// How many channel values of a file were not usable as radiance, and were replaced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// NaN, replaced by 0.
    pub nan: usize,
    /// Infinite, replaced by the largest finite value of the map (or 0 if there is none).
    pub infinite: usize,
    /// Negative, minus infinity included, replaced by 0.
    pub negative: usize,
}

impl Repairs {
    /// All replaced values.
    pub fn total(&self) -> usize {
        self.nan + self.infinite + self.negative
    }
}
