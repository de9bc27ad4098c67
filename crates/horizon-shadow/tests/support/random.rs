//! Numbers, reliefs and tables that look random and are the same every time.

use horizon_shadow::{Wrap, model::Relief};

use super::{CONTENTS_COMPACT, Parameters, Tables};

/// A counter-based generator (splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// 0..1
    pub fn unit(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, least: f64, greatest: f64) -> f64 {
        least + (greatest - least) * self.unit()
    }
}

/// A repeating relief of several octaves, 0..1.
pub fn rough(size: [u32; 2], seed: u64) -> Vec<f32> {
    let value = |x: u32, y: u32, octave: u32| {
        Random(seed ^ (u64::from(x) << 40) ^ (u64::from(y) << 20) ^ u64::from(octave)).unit()
    };
    let mut heights = Vec::new();
    for y in 0..size[1] {
        for x in 0..size[0] {
            let mut sum = 0.0;
            for octave in 0..4 {
                let cell = 16_u32 >> octave;
                let cells = [size[0].div_ceil(cell), size[1].div_ceil(cell)];
                let (i, j) = (x / cell, y / cell);
                let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
                let fx = smooth(f64::from(x % cell) / f64::from(cell));
                let fy = smooth(f64::from(y % cell) / f64::from(cell));
                let corner = |a, b| value((i + a) % cells[0], (j + b) % cells[1], octave);
                let row = |b| corner(0, b) * (1.0 - fx) + corner(1, b) * fx;
                sum += 0.5_f64.powi(octave as i32) * (row(0) * (1.0 - fy) + row(1) * fy);
            }
            heights.push((sum / 1.875) as f32);
        }
    }
    heights
}

/// Parameters of a repeating map on a plane of one texel a metre.
pub fn parameters(size: [u32; 2], method: u32) -> Parameters {
    Parameters {
        size: size.map(|texels| texels as f32),
        uv_scale: [1.0; 2],
        heights: [0.0, 1.0],
        height_scale_m: 4.0,
        texels_per_height: 4.0,
        curvature: [0.0, 0.02],
        radius_texels: 24.0,
        slope_scale: horizon_shadow::codes::SLOPE_SCALE,
        azimuths: 16,
        candidates: 2,
        contents: CONTENTS_COMPACT,
        wrap: 3,
        baked_azimuths: [u32::MAX; 2],
        method,
        march_steps: 64,
        flags: 0,
        reserved: [0; 3],
    }
}

/// Tables whose every code is random: what they say need not be true of the relief. The published ones
/// stay near the middle of their range, because samplers blend neighbours with few bits.
pub fn tables(size: [u32; 2], parameters: Parameters, heights: Vec<f32>, seed: u64) -> Tables {
    let mut random = Random(seed);
    let texels = (size[0] * size[1] * parameters.azimuths) as usize;
    let tiles = (size[0].div_ceil(8) * size[1].div_ceil(8) * parameters.azimuths) as usize;
    Tables {
        parameters,
        heights,
        published: (0..texels).map(|_| [0, 0].map(|_: u8| 120 + (random.word() % 21) as u8)).collect(),
        candidates: (0..texels).map(|_| random.word() as u32).collect(),
        words: 1,
        extents: vec![[0, 255]; tiles],
        moments: vec![[0.0, 0.1, 0.0, 0.1]; parameters.azimuths as usize],
        moments_size: [1, 1],
    }
}

pub fn relief(tables: &Tables) -> Relief {
    let p = &tables.parameters;
    let wrap = |bit| if p.wrap & bit != 0 { Wrap::Repeat } else { Wrap::Clamp };
    Relief::new(p.size.map(|texels| texels as u32), &tables.heights, p.heights, [wrap(1), wrap(2)])
}
