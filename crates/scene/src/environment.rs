//! Surrounding radiance as a latitude-longitude map.

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

/// How many channel values of a file were not usable as radiance, and were replaced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// NaN, replaced by 0.
    pub nan: usize,
    /// Infinite, replaced by the largest finite value of the map (or 0 if there is none).
    pub infinite: usize,
    /// Negative, replaced by 0.
    pub negative: usize,
}
