//! Baking the tables on the GPU, in compute.
//!
//! Heights are first brought into texels above the least. Then, one azimuth after the other:
//! `bake-sweep.wgsl` finds for each curvature where each texel's horizon lies, in time proportional to
//! the texels whatever the radius; `bake-search.wgsl` looks at the samples around that and at the
//! nearest ones from the texel itself (or, as the check, at all samples), keeps the highest and encodes
//! it; `bake-parts.wgsl` makes extents and moments from the codes, and when all azimuths are done the
//! ambient occlusion. Rows are worked on in strips, and lines in portions, so that no scratch buffer
//! is larger than 64 MiB.

pub mod cpu;
mod parts;
mod pipelines;
mod plan;
mod profile;
mod record;
mod textures;
mod uniforms;

use std::ops::Range;

use gpu_context::{Gpu, Work, wgpu};

pub use pipelines::Baker;
pub use textures::BakedTables;

use crate::{Error, Progress, Search, TableDesc, bindings::bind_group};
use parts::{Part, ambient_parts, azimuth_parts};
use plan::{Scratch, dependent_rows, strips, union};
use profile::Samples;
use record::{Batch, Buffers};
use uniforms::Step;

/// What a bake makes besides the tables; only where these are candidates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Parts {
    /// Moments of the horizons, for visibility under minification.
    pub prefilter: bool,
    /// Ambient occlusion and bent normals. All azimuths are baked for them.
    pub ambient: bool,
}

/// A height map on the GPU, as far as the bake reads it.
#[derive(Clone, Copy, Debug)]
pub struct Heights<'a> {
    /// A two-dimensional view that a shader can load as f32; red counts. Heights that are not finite
    /// count as the least.
    pub view: &'a wgpu::TextureView,
    /// Least and greatest height, finite; heights beyond are brought into the range.
    pub range: [f32; 2],
}

/// The tables of one height map, and what is still to be baked of them.
#[derive(Debug)]
pub struct Bake {
    desc: TableDesc,
    parts: Parts,
    tables: BakedTables,
    heights: wgpu::TextureView,
    range: [f32; 2],
    /// Rows whose relief is to be taken.
    stale_relief: Vec<Range<u32>>,
    /// For each azimuth that is wanted the rows to be baked.
    pending: Vec<Vec<Range<u32>>>,
    /// Rows whose ambient occlusion is to be taken when no azimuth is pending.
    stale_ambient: Vec<Range<u32>>,
    buffers: Option<Buffers>,
    wanted: u64,
    cancelled: bool,
    texels_worked: u64,
}

impl Baker {
    /// Makes the textures; [`record`](Self::record) fills them. `azimuths` has bit i for azimuth i.
    ///
    /// [`Error::Value`] where the description or the range is out of range, [`Error::Gpu`] with a
    /// limit where the device does not allow the size: before memory is taken.
    pub fn start(
        &self,
        gpu: &Gpu,
        desc: &TableDesc,
        heights: &Heights<'_>,
        parts: Parts,
        azimuths: u64,
    ) -> Result<Bake, Error> {
        desc.check_device(gpu)?;
        check_heights(desc, heights)?;
        let mut bake = Bake {
            desc: *desc,
            parts: if desc.candidates() > 0 { parts } else { Parts::default() },
            tables: BakedTables::new(gpu, desc, parts)?,
            heights: heights.view.clone(),
            range: heights.range,
            stale_relief: Vec::new(),
            pending: vec![Vec::new(); desc.azimuths as usize],
            stale_ambient: Vec::new(),
            buffers: None,
            wanted: 0,
            cancelled: false,
            texels_worked: 0,
        };
        bake.want(if parts.ambient { u64::MAX } else { azimuths });
        Ok(bake)
    }

    /// Records the next `at_most` azimuths that are wanted and not baked. [`Error::Cancelled`] where
    /// the bake was cancelled. `Work::passes` counts compute passes.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        bake: &mut Bake,
        search: Search,
        at_most: u32,
    ) -> Result<Work, Error> {
        if bake.cancelled {
            let Progress { done, total } = bake.progress();
            return Err(Error::Cancelled { done, total });
        }
        let mut passes = self.take_relief(gpu, encoder, bake)?;
        let azimuths = (0..bake.desc.azimuths).filter(|&azimuth| !bake.pending[azimuth as usize].is_empty());
        for azimuth in azimuths.take(at_most as usize).collect::<Vec<_>>() {
            passes += self.fill_azimuth(gpu, encoder, bake, search, azimuth)?;
            let rows = bake.pending[azimuth as usize].drain(..);
            bake.stale_ambient.extend(rows);
        }
        if bake.pending.iter().all(Vec::is_empty) {
            union(&mut bake.stale_ambient);
            passes += self.fill_ambient(gpu, encoder, bake)?;
            bake.stale_ambient.clear();
            bake.buffers = None;
        }
        Ok(Work::done(passes))
    }

    /// Brings the relief up to date where an azimuth waits for it.
    fn take_relief(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        bake: &mut Bake,
    ) -> Result<u32, Error> {
        if bake.pending.iter().all(Vec::is_empty) {
            return Ok(0);
        }
        let [width, height] = bake.desc.size;
        let buffers = if let Some(buffers) = bake.buffers.take() {
            buffers
        } else {
            bake.stale_relief = bake.desc.all_rows();
            Buffers::new(gpu, u64::from(width) * u64::from(height))?
        };
        let steps: Vec<_> =
            bake.stale_relief.drain(..).map(|rows| bake_rows(&bake.desc, bake.range, rows)).collect();
        let mut passes = 0;
        if !steps.is_empty() {
            let heights = gpu.checked("horizon-shadow's heights", |device| {
                let view = wgpu::BindingResource::TextureView(&bake.heights);
                bind_group(device, "horizon-shadow heights", &self.heights_layout, [view])
            })?;
            let mut batch = Batch::new(gpu, self, &buffers, &steps, &[])?;
            for step in &steps {
                batch.take_relief(encoder, &heights, step);
            }
            passes = batch.passes;
        }
        bake.buffers = Some(buffers);
        Ok(passes)
    }

    fn fill_azimuth(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        bake: &mut Bake,
        search: Search,
        azimuth: u32,
    ) -> Result<u32, Error> {
        let Some(buffers) = &mut bake.buffers else { return Ok(0) };
        let samples = Samples::new(&bake.desc, azimuth);
        let all_rows = Step::new(&bake.desc, bake.range, azimuth, &samples);
        let mut all_strips = Vec::new();
        for rows in &bake.pending[azimuth as usize] {
            let (strips, scratch) = strips(&bake.desc, &all_rows, &samples, search, rows);
            buffers.grow(gpu, scratch)?;
            all_strips.extend(strips);
            bake.texels_worked += u64::from(rows.end - rows.start) * u64::from(bake.desc.size[0]);
        }
        let parts = if bake.desc.candidates() > 0 {
            let changed = &bake.pending[azimuth as usize];
            azimuth_parts(&bake.desc, &bake.tables, &all_rows, changed, bake.parts.prefilter)
        } else {
            Vec::new()
        };
        buffers.grow(gpu, scratch_of(&parts))?;
        let mut steps: Vec<_> =
            all_strips.iter().flat_map(|strip| strip.sweeps.iter().chain([&strip.search])).copied().collect();
        steps.extend(parts.iter().map(|part| part.step));
        let textures = self.part_textures(gpu, &bake.tables, &bake.tables.moments)?;
        let mut batch = Batch::new(gpu, self, buffers, &steps, &samples.profile)?;
        let target = bake.tables.of(&bake.desc).texture();
        for strip in &all_strips {
            batch.fill(encoder, strip, target, azimuth);
        }
        for part in &parts {
            batch.make(encoder, &textures, part);
        }
        Ok(batch.passes)
    }

    fn fill_ambient(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        bake: &mut Bake,
    ) -> Result<u32, Error> {
        let Some(buffers) = bake.buffers.as_mut().filter(|_| bake.parts.ambient) else { return Ok(0) };
        let samples = Samples::new(&bake.desc, 0);
        let all_rows = Step::new(&bake.desc, bake.range, 0, &samples);
        let parts = ambient_parts(&bake.tables, &all_rows, &bake.stale_ambient);
        buffers.grow(gpu, scratch_of(&parts))?;
        let steps: Vec<_> = parts.iter().map(|part| part.step).collect();
        let textures = self.part_textures(gpu, &bake.tables, &bake.tables.ambient)?;
        let mut batch = Batch::new(gpu, self, buffers, &steps, &[])?;
        for part in &parts {
            batch.make(encoder, &textures, part);
        }
        Ok(batch.passes)
    }

    /// The bindings of a part: the candidates, and the texture whose coarser levels are made.
    fn part_textures(
        &self,
        gpu: &Gpu,
        tables: &BakedTables,
        finer: &wgpu::TextureView,
    ) -> Result<wgpu::BindGroup, Error> {
        let views = [&tables.candidates, finer].map(wgpu::BindingResource::TextureView);
        gpu.checked("horizon-shadow's parts", |device| {
            bind_group(device, "horizon-shadow parts", &self.parts_layout, views)
        })
        .map_err(Error::from)
    }
}

/// Scratch memory that some parts need.
fn scratch_of(parts: &[Part<'_>]) -> Scratch {
    let encoded = parts.iter().map(Part::encoded_bytes).max().unwrap_or(0);
    Scratch { encoded, ..Scratch::default() }
}

/// The step that takes the relief of some rows.
fn bake_rows(desc: &TableDesc, range: [f32; 2], rows: Range<u32>) -> Step {
    Step {
        size: desc.size,
        rows: [rows.start, rows.end],
        least_height: range[0],
        greatest_height: range[1],
        texels_per_height: desc.texels_per_height,
        ..Step::default()
    }
}

fn check_range([least, greatest]: [f32; 2]) -> Result<(), Error> {
    if least.is_finite() && greatest.is_finite() && least <= greatest {
        return Ok(());
    }
    Err(Error::Value {
        what: "range of heights",
        found: format!("{least}..{greatest}"),
        expected: "finite, the least first".to_owned(),
    })
}

fn check_heights(desc: &TableDesc, heights: &Heights<'_>) -> Result<(), Error> {
    check_range(heights.range)?;
    let texture = heights.view.texture();
    if [texture.width(), texture.height()] == desc.size {
        return Ok(());
    }
    Err(Error::Value {
        what: "height map's size",
        found: format!("{} x {}", texture.width(), texture.height()),
        expected: format!("{} x {}", desc.size[0], desc.size[1]),
    })
}

impl Bake {
    /// What is baked.
    pub fn desc(&self) -> &TableDesc {
        &self.desc
    }

    /// The textures; layers of azimuths that are not in [`baked_azimuths`](Self::baked_azimuths) hold
    /// nothing yet.
    pub fn tables(&self) -> &BakedTables {
        &self.tables
    }

    /// Bit i where azimuth i is baked.
    pub fn baked_azimuths(&self) -> u64 {
        let waiting = self.pending.iter().enumerate().filter(|(_, rows)| !rows.is_empty());
        self.wanted & !waiting.fold(0, |bits, (azimuth, _)| bits | 1 << azimuth)
    }

    /// How far the bake has come.
    pub fn progress(&self) -> Progress {
        Progress { done: self.baked_azimuths().count_ones(), total: self.wanted.count_ones() }
    }

    /// Texels that were searched so far, summed over the azimuths.
    pub fn texels_worked(&self) -> u64 {
        self.texels_worked
    }

    /// Asks for further azimuths.
    pub fn want(&mut self, azimuths: u64) {
        for (azimuth, rows) in self.pending.iter_mut().enumerate() {
            if (azimuths & !self.wanted) >> azimuth & 1 == 1 {
                *rows = self.desc.all_rows();
            }
        }
        self.wanted |= azimuths & (u64::MAX >> (64 - self.desc.azimuths));
    }

    /// Says that the heights of these rows have changed: what depends on them is baked again by the
    /// next calls of [`Baker::record`]. The view may be another than before, of the same size; the
    /// range must be the same, since all heights count from the least.
    pub fn rows_changed(&mut self, heights: &Heights<'_>, rows: Range<u32>) -> Result<(), Error> {
        check_heights(&self.desc, heights)?;
        let rows = rows.start.min(self.desc.size[1])..rows.end.min(self.desc.size[1]);
        let whole = heights.range.map(f32::to_bits) != self.range.map(f32::to_bits);
        let rows = if whole { 0..self.desc.size[1] } else { rows };
        self.heights = heights.view.clone();
        self.range = heights.range;
        if rows.start >= rows.end {
            return Ok(());
        }
        for azimuth in (0..self.desc.azimuths).filter(|azimuth| self.wanted >> azimuth & 1 == 1) {
            let samples = Samples::new(&self.desc, azimuth);
            let pending = &mut self.pending[azimuth as usize];
            pending.extend(dependent_rows(&self.desc, &samples, &rows));
            union(pending);
        }
        self.stale_relief.push(rows);
        union(&mut self.stale_relief);
        Ok(())
    }

    /// Stops the bake; the tables stay as they are, and recording fails from now on.
    pub fn cancel(&mut self) {
        self.cancelled = true;
    }

    /// Whether it was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled
    }
}
