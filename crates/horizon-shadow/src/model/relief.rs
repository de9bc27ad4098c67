//! Height maps in f64.

use crate::Wrap;

/// Heights above the least one, in the map's own units, bilinear between the centres of texels,
/// which lie at whole numbers.
#[derive(Clone, Debug)]
pub struct Relief {
    size: [u32; 2],
    wrap: [Wrap; 2],
    least: f64,
    greatest: f64,
    above_least: Vec<f64>,
}

impl Relief {
    /// `values` row by row; heights that are not finite, and those that are missing, count as
    /// `range[0]`, others are brought into the range.
    pub fn new(size: [u32; 2], values: &[f32], range: [f32; 2], wrap: [Wrap; 2]) -> Self {
        let size = size.map(|texels| texels.max(1));
        let [least, greatest] = range;
        let above = |value: f32| {
            if value.is_finite() { f64::from(value.max(least).min(greatest)) - f64::from(least) } else { 0.0 }
        };
        let mut above_least: Vec<f64> = values.iter().map(|&value| above(value)).collect();
        above_least.resize(size[0] as usize * size[1] as usize, 0.0);
        Self {
            size,
            wrap,
            least: f64::from(least),
            greatest: f64::from(greatest) - f64::from(least),
            above_least,
        }
    }

    /// Texels along u and v.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The least height itself, in the map's units.
    pub fn least(&self) -> f64 {
        self.least
    }

    /// The range's extent, in the map's units.
    pub fn greatest(&self) -> f64 {
        self.greatest
    }

    /// The texel that stands at a place on or beyond the map.
    pub fn wrapped(&self, at: [i64; 2]) -> [u32; 2] {
        let axis = |i: usize| {
            let size = i64::from(self.size[i]);
            match self.wrap[i] {
                Wrap::Repeat => at[i].rem_euclid(size) as u32,
                Wrap::Clamp => at[i].clamp(0, size - 1) as u32,
            }
        };
        [axis(0), axis(1)]
    }

    /// Height of a texel.
    pub fn texel(&self, at: [i64; 2]) -> f64 {
        let [x, y] = self.wrapped(at);
        self.above_least[y as usize * self.size[0] as usize + x as usize]
    }

    /// Height at a point in texels.
    pub fn height(&self, at: [f64; 2]) -> f64 {
        let low = at.map(f64::floor);
        let [fx, fy] = [at[0] - low[0], at[1] - low[1]];
        let [x, y] = low.map(|c| c as i64);
        let row = |y| (1.0 - fx) * self.texel([x, y]) + fx * self.texel([x + 1, y]);
        (1.0 - fy) * row(y) + fy * row(y + 1)
    }

    /// Slope of the bilinear relief along a direction, on the side of the point that lies that way.
    pub fn tangent(&self, at: [f64; 2], direction: [f64; 2]) -> f64 {
        let low = |i: usize| if direction[i] < 0.0 { at[i].ceil() - 1.0 } else { at[i].floor() };
        let (lx, ly) = (low(0), low(1));
        let (fx, fy) = (at[0] - lx, at[1] - ly);
        let (x, y) = (lx as i64, ly as i64);
        let corner = |i, j| self.texel([x + i, y + j]);
        let along_u = (1.0 - fy) * (corner(1, 0) - corner(0, 0)) + fy * (corner(1, 1) - corner(0, 1));
        let along_v = (1.0 - fx) * (corner(0, 1) - corner(0, 0)) + fx * (corner(1, 1) - corner(1, 0));
        direction[0] * along_u + direction[1] * along_v
    }
}
