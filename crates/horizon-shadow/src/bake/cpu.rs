//! The bake on the CPU, brute force over all cores: the same tables as the GPU's brute force.
//!
//! Both take the same steps in f32, and read sines and cosines from the same list, so that codes are
//! the same but where a device contracts a product and a sum or takes another arc tangent: then at
//! most 2 in 1000 differ, by one (on Mesa's software adapter no candidate does).

use std::{
    ops::ControlFlow,
    sync::atomic::{AtomicBool, Ordering},
};

use rayon::prelude::*;

use super::{profile::Samples, uniforms::Step};
use crate::{Contents, Error, Precision, Progress, TableDesc, Wrap, codes::Codes};

/// A height map in memory.
#[derive(Clone, Copy, Debug)]
pub struct HeightField<'a> {
    /// Texels along u and v.
    pub size: [u32; 2],
    /// `width * height` heights, rows from the top. What is not finite counts as the least height.
    pub values: &'a [f32],
    /// Least and greatest height, finite; heights beyond are brought into the range.
    pub range: [f32; 2],
    /// What lies beyond the map along u and v.
    pub wrap: [Wrap; 2],
}

/// Tables in memory, laid out as the GPU's textures: for each azimuth `width * height` texels of
/// [`TableDesc::texel_bytes`] bytes, rows from the top. Azimuths that were not asked for are empty.
#[derive(Clone, Debug, PartialEq)]
pub struct CpuTables {
    /// What they hold.
    pub desc: TableDesc,
    /// The texels of each azimuth.
    pub azimuths: Vec<Vec<u8>>,
}

/// Bakes the azimuths whose bits are set. `observe` hears of the start and of each azimuth that is
/// finished, and stops the bake with [`ControlFlow::Break`]: [`Error::Cancelled`].
///
/// [`Error::Value`] where a number is out of range or there are not `width * height` heights.
pub fn bake(
    heights: &HeightField<'_>,
    desc: &TableDesc,
    azimuths: u64,
    observe: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
) -> Result<CpuTables, Error> {
    desc.check()?;
    super::check_range(heights.range)?;
    let relief = Relief::new(heights, desc)?;
    let wanted = azimuths & (u64::MAX >> (64 - desc.azimuths));
    let mut progress = Progress { done: 0, total: wanted.count_ones() };
    let mut tables = CpuTables { desc: *desc, azimuths: vec![Vec::new(); desc.azimuths as usize] };
    for (azimuth, table) in (0..).zip(&mut tables.azimuths) {
        if wanted >> azimuth & 1 == 0 {
            continue;
        }
        let go_on = observe(progress).is_continue();
        let layer = go_on.then(|| relief.layer(desc, azimuth, &|| observe(progress).is_continue())).flatten();
        let Some(layer) = layer else {
            return Err(Error::Cancelled { done: progress.done, total: progress.total });
        };
        *table = layer;
        progress.done += 1;
    }
    // Nothing is left to stop.
    let _ = observe(progress);
    Ok(tables)
}

/// Heights in texels above the least.
struct Relief {
    size: [u32; 2],
    wrap: [Wrap; 2],
    heights: Vec<f32>,
}

/// The highest point that a texel sees in one azimuth; its tangent is `up / across`.
struct Horizon {
    up: f32,
    across: f32,
    rise: f32,
    sample: u32,
}

impl Relief {
    fn new(field: &HeightField<'_>, desc: &TableDesc) -> Result<Self, Error> {
        let [width, height] = desc.size.map(u64::from);
        if field.size != desc.size || field.wrap != desc.wrap || field.values.len() as u64 != width * height {
            return Err(Error::Value {
                what: "height field",
                found: format!("{} x {} ({} heights)", field.size[0], field.size[1], field.values.len()),
                expected: format!("{width} x {height} heights that wrap as the tables do"),
            });
        }
        let [least, greatest] = field.range;
        let local = |&raw: &f32| {
            let height = if raw.is_finite() { raw } else { least };
            (height.clamp(least, greatest) - least) * desc.texels_per_height
        };
        let heights = field.values.iter().map(local).collect();
        Ok(Self { size: desc.size, wrap: desc.wrap, heights })
    }

    /// One azimuth's table, `None` where `go_on` said no.
    fn layer(&self, desc: &TableDesc, azimuth: u32, go_on: &(dyn Fn() -> bool + Sync)) -> Option<Vec<u8>> {
        let samples = Samples::new(desc, azimuth);
        let step = Step::new(desc, [0.0, 1.0], azimuth, &samples);
        let coder = Coder { desc, step: &step, samples: &samples };
        let row_bytes = (desc.size[0] * desc.texel_bytes()) as usize;
        let mut layer = vec![0; row_bytes * desc.size[1] as usize];
        let stopped = AtomicBool::new(false);
        (0..desc.size[1]).into_par_iter().zip(layer.par_chunks_exact_mut(row_bytes)).for_each(
            |(row, bytes)| {
                if stopped.load(Ordering::Relaxed) || !go_on() {
                    stopped.store(true, Ordering::Relaxed);
                    return;
                }
                let texels = bytes.chunks_exact_mut(desc.texel_bytes() as usize);
                (0..).zip(texels).for_each(|(column, texel)| self.texel(&coder, column, row, texel));
            },
        );
        (!stopped.into_inner()).then_some(layer)
    }

    /// Searches and encodes all of a texel's horizons.
    fn texel(&self, coder: &Coder<'_>, column: u32, row: u32, bytes: &mut [u8]) {
        let step = coder.step;
        let height = self.heights[(row * self.size[0] + column) as usize];
        let code_bytes = (step.code_bits / 8) as usize;
        for (node, target) in (0..step.nodes).zip(bytes.chunks_exact_mut(code_bytes)) {
            let kappa = step.kappas[node as usize];
            let profile = &coder.samples.profile[(node * step.profile_row) as usize..];
            let from_centre = 1.0 + kappa * height;
            let mut best = Horizon { up: -1e4, across: 1.0, rise: 0.0, sample: 0 };
            for sample in step.first_sample..=step.last_sample {
                let [s, c, cosine, _] = profile[sample as usize];
                let x = column as f32 + sample as f32 * step.advance[0];
                let y = row as f32 + sample as f32 * step.advance[1];
                let rise = self.height(x, y) - height;
                let across = (from_centre + kappa * rise) * s;
                let up = rise * cosine - from_centre * c;
                if across > 0.0 && up * best.across > best.up * across {
                    best = Horizon { up, across, rise, sample };
                }
            }
            let code = coder.encode(&best, node, height);
            target.copy_from_slice(&code.to_le_bytes()[..code_bytes]);
        }
    }

    /// Bilinear height; texel centres are at whole numbers.
    fn height(&self, x: f32, y: f32) -> f32 {
        let ([x0, x1], fraction_x) = self.neighbours(x, 0);
        let ([y0, y1], fraction_y) = self.neighbours(y, 1);
        let at = |x: usize, y: usize| self.heights[y * self.size[0] as usize + x];
        let above = at(x0, y0) + (at(x1, y0) - at(x0, y0)) * fraction_x;
        let below = at(x0, y1) + (at(x1, y1) - at(x0, y1)) * fraction_x;
        above + (below - above) * fraction_y
    }

    /// The texels on either side of a coordinate, on the map, and where it lies between them.
    fn neighbours(&self, at: f32, axis: usize) -> ([usize; 2], f32) {
        let low = at.floor();
        let extent = self.size[axis] as f32;
        let wrapped = |at: f32| {
            let turned = match self.wrap[axis] {
                Wrap::Repeat => at - extent * (at / extent).floor(),
                Wrap::Clamp => at,
            };
            turned.clamp(0.0, extent - 1.0) as usize
        };
        ([wrapped(low), wrapped(low + 1.0)], at - low)
    }
}

/// Encodes horizons as `bake-search.wgsl` does.
struct Coder<'a> {
    desc: &'a TableDesc,
    step: &'a Step,
    samples: &'a Samples,
}

impl Coder<'_> {
    fn encode(&self, horizon: &Horizon, node: u32, height: f32) -> u32 {
        let distance = horizon.sample as f32 * self.step.spacing;
        let tangent = horizon.up / horizon.across;
        let Contents::Candidates { precision, .. } = self.desc.contents else {
            return if horizon.sample == 0 { 0 } else { self.published(tangent, distance) };
        };
        let codes = Codes::new(precision, self.desc.radius_texels);
        if horizon.sample == 0 {
            return codes.none();
        }
        let slope = match precision {
            Precision::Compact => self.adjusted(&codes, node, height, tangent, distance),
            Precision::Full => None,
        };
        codes.encode(slope.unwrap_or(horizon.rise / distance), distance)
    }

    /// The slope that keeps the tangent at this curvature where the distance was rounded.
    fn adjusted(&self, codes: &Codes, node: u32, height: f32, tangent: f32, distance: f32) -> Option<f32> {
        let kappa = self.step.kappas[node as usize];
        let points = self.step.nodes * self.step.profile_row;
        let index = points + node * (codes.greatest_distance_code() + 1) + codes.distance_code(distance);
        let [s, c, cosine, rounded] = self.samples.profile[index as usize];
        let divisor = (cosine - tangent * kappa * s) * rounded;
        (divisor > 1e-3).then(|| (1.0 + kappa * height) * (tangent * s + c) / divisor)
    }

    fn published(&self, tangent: f32, distance: f32) -> u32 {
        let angle_code = ((tangent.atan() / std::f32::consts::PI + 0.5) * 255.0 + 0.5).floor() as u32;
        let fraction = (distance / self.desc.radius_texels).clamp(0.0, 1.0);
        let distance_code = (fraction * 255.0 + 0.5).floor() as u32;
        match self.desc.contents {
            Contents::Flat => angle_code,
            Contents::Published(crate::Tables::DistanceAndHeight) => distance_code,
            _ => angle_code | distance_code << 8,
        }
    }
}
