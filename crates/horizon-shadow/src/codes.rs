//! The codes of the candidates: how slopes and distances become a few bits. The same as
//! `codes-library.wgsl`, in f32 and in the same order of operations.

use crate::Precision;

/// Slope at which half of the slope code's range is used.
pub const SLOPE_SCALE: f32 = 0.5;

/// How the candidates of one table are coded: the slope in the low bits, the distance above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Codes {
    /// Bits of the slope.
    pub slope_bits: u32,
    /// Bits of the distance.
    pub distance_bits: u32,
    /// The farthest distance, texels.
    pub radius_texels: f32,
}

impl Codes {
    /// The codes of a precision, for distances of 1 to `radius_texels` texels.
    pub const fn new(precision: Precision, radius_texels: f32) -> Self {
        let (slope_bits, distance_bits) = match precision {
            Precision::Compact => (10, 6),
            Precision::Full => (16, 16),
        };
        Self { slope_bits, distance_bits, radius_texels }
    }

    /// The code of a candidate of so large a slope (tangent) at a distance in texels. What is beyond
    /// the codes' ranges, infinite values included, takes the code at their ends, and NaN the least.
    pub fn encode(self, slope: f32, distance_texels: f32) -> u32 {
        self.distance_code(distance_texels) << self.slope_bits | self.slope_code(slope)
    }

    /// Slope (tangent) and distance (texels) of a code.
    pub fn decode(self, code: u32) -> [f32; 2] {
        let slope_code = code & ((1 << self.slope_bits) - 1);
        [self.slope(slope_code), self.distance(code >> self.slope_bits)]
    }

    /// The code of "no candidate": the least slope, one texel away.
    pub const fn none(self) -> u32 {
        1
    }

    /// The code of a slope.
    pub fn slope_code(self, slope: f32) -> u32 {
        let half = self.half();
        let x = if slope.is_infinite() { slope.signum() } else { slope / (SLOPE_SCALE + slope.abs()) };
        // NaN becomes 0 in the conversion to an integer.
        ((half * x + half + 0.5).floor().clamp(1.0, 2.0 * half - 1.0) as u32).max(1)
    }

    /// The slope of a code; 0 exactly for the code of 0.
    pub fn slope(self, code: u32) -> f32 {
        let x = code as f32 / self.half() - 1.0;
        SLOPE_SCALE * x / (1.0 - x.abs()).max(1e-5)
    }

    /// The code of a distance in texels.
    pub fn distance_code(self, distance_texels: f32) -> u32 {
        let fraction = ((distance_texels - 1.0) / (self.radius_texels - 1.0)).clamp(0.0, 1.0);
        (fraction.sqrt() * self.greatest_distance_code() as f32 + 0.5).floor() as u32
    }

    /// The distance of a code, texels.
    pub fn distance(self, code: u32) -> f32 {
        let y = code as f32 / self.greatest_distance_code() as f32;
        1.0 + (self.radius_texels - 1.0) * y * y
    }

    /// The code of the farthest distance.
    pub const fn greatest_distance_code(self) -> u32 {
        (1 << self.distance_bits) - 1
    }

    fn half(self) -> f32 {
        0.5 * (1_u32 << self.slope_bits) as f32
    }
}
