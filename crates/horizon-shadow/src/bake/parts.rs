//! The steps that make extents, moments and ambient occlusion from baked candidates.

use std::ops::Range;

use gpu_context::wgpu;

use super::{
    BakedTables,
    plan::{SCRATCH_BYTES, union},
    uniforms::{Step, pitch_bytes},
};
use crate::{MOMENT_TEXELS, TILE_TEXELS, TableDesc, Wrap};

/// Which pipeline makes a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Extents,
    Moments,
    Ambient,
    Halve,
}

/// One dispatch that writes some rows of a level of one or two layers.
#[derive(Debug)]
pub(super) struct Part<'a> {
    pub(super) kind: Kind,
    pub(super) step: Step,
    pub(super) groups: [u32; 2],
    pub(super) target: &'a wgpu::Texture,
    pub(super) level: u32,
    pub(super) layers: Range<u32>,
    pub(super) rows: Range<u32>,
}

impl Part<'_> {
    /// Bytes that it writes before they are copied to the texture.
    pub(super) fn encoded_bytes(&self) -> u64 {
        u64::from(self.layers.len() as u32 * self.rows.len() as u32) * u64::from(self.step.pitch) * 4
    }
}

/// Extents and moments of one azimuth, where its tables changed in some rows.
pub(super) fn azimuth_parts<'a>(
    desc: &TableDesc,
    tables: &'a BakedTables,
    all_rows: &Step,
    changed: &[Range<u32>],
    prefilter: bool,
) -> Vec<Part<'a>> {
    let mut parts = Vec::new();
    let azimuth = all_rows.azimuth;
    let layers = azimuth..azimuth + 1;
    let extents = tables.extents.texture();
    for rows in cell_rows(desc, changed, TILE_TEXELS) {
        let pitch = pitch_bytes(2 * extents.width()) / 4;
        let step = Step { rows: [rows.start, rows.end], pitch, ..*all_rows };
        let groups = [extents.width().div_ceil(2).div_ceil(32), rows.len() as u32];
        let layers = layers.clone();
        parts.push(Part { kind: Kind::Extents, step, groups, target: extents, level: 0, layers, rows });
    }
    if !prefilter {
        return parts;
    }
    let moments = tables.moments.texture();
    for rows in cell_rows(desc, changed, MOMENT_TEXELS) {
        let pitch = pitch_bytes(8 * moments.width()) / 4;
        let step = Step { rows: [rows.start, rows.end], pitch, ..*all_rows };
        let groups = [moments.width().div_ceil(64), rows.len() as u32];
        let layers = layers.clone();
        parts.push(Part { kind: Kind::Moments, step, groups, target: moments, level: 0, layers, rows });
    }
    parts.extend(coarser_levels(moments, azimuth, all_rows));
    parts
}

/// Ambient occlusion and bent normals of some rows, from all azimuths, and their coarser levels.
pub(super) fn ambient_parts<'a>(
    tables: &'a BakedTables,
    all_rows: &Step,
    changed: &[Range<u32>],
) -> Vec<Part<'a>> {
    let ambient = tables.ambient.texture();
    let pitch = pitch_bytes(4 * ambient.width()) / 4;
    let strip_rows = (SCRATCH_BYTES / (8 * u64::from(pitch))).max(1) as usize;
    let mut parts = Vec::new();
    for range in changed {
        for first in range.clone().step_by(strip_rows) {
            let rows = first..range.end.min(first + strip_rows as u32);
            let step = Step { rows: [rows.start, rows.end], pitch, ..*all_rows };
            let groups = [ambient.width().div_ceil(64), rows.len() as u32];
            let layers = 0..2;
            parts.push(Part { kind: Kind::Ambient, step, groups, target: ambient, level: 0, layers, rows });
        }
    }
    parts.extend((0..2).flat_map(|layer| coarser_levels(ambient, layer, all_rows)));
    parts
}

fn coarser_levels<'a>(
    target: &'a wgpu::Texture,
    layer: u32,
    all_rows: &Step,
) -> impl Iterator<Item = Part<'a>> {
    let texel_bytes = target.format().block_copy_size(None).unwrap_or(4);
    let all_rows = *all_rows;
    (1..target.mip_level_count()).map(move |level| {
        let [width, height] = [target.width(), target.height()].map(|side| (side >> level).max(1));
        let step = Step {
            pitch: pitch_bytes(texel_bytes * width) / 4,
            azimuth: layer,
            level_size: [width, height],
            finer_level: level - 1,
            half_floats: u32::from(target.format() == wgpu::TextureFormat::Rgba16Float),
            ..all_rows
        };
        let groups = [width.div_ceil(64), height];
        let layers = layer..layer + 1;
        Part { kind: Kind::Halve, step, groups, target, level, layers, rows: 0..height }
    })
}

/// The rows of cells of `side` texels which see changed rows, themselves or as the row after their
/// last.
fn cell_rows(desc: &TableDesc, changed: &[Range<u32>], side: u32) -> Vec<Range<u32>> {
    let cells = desc.size[1].div_ceil(side);
    let mut rows = Vec::new();
    for range in changed {
        rows.push(range.start.saturating_sub(1) / side..range.end.div_ceil(side));
        if range.start == 0 && desc.wrap[1] == Wrap::Repeat {
            rows.push(cells - 1..cells);
        }
    }
    union(&mut rows);
    rows
}
