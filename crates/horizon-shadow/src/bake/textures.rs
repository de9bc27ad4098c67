//! The textures that a bake fills.

use gpu_context::{Gpu, wgpu};

use super::Parts;
use crate::{Error, MOMENT_TEXELS, TILE_TEXELS, TableDesc};

/// Views of the baked tables, all two-dimensional arrays. What the description does not ask for is
/// one texel of one layer, so that every binding can be filled.
#[derive(Debug)]
pub struct BakedTables {
    /// `Rg8Unorm` (angle, distance) or `R8Unorm` (angle or distance), one layer for each azimuth,
    /// filterable: angle = (code - 0.5) pi, distance = radius * code.
    pub published: wgpu::TextureView,
    /// `R16Uint`, `R32Uint`, `Rg32Uint` or `Rgba32Uint`, one layer for each azimuth: see
    /// [`crate::codes`].
    pub candidates: wgpu::TextureView,
    /// `Rg8Unorm`, one layer for each azimuth and one texel for each tile of [`TILE_TEXELS`]: least
    /// and greatest (sin + 1) / 2 of the horizon.
    pub extents: wgpu::TextureView,
    /// `Rgba16Float`, one layer for each azimuth with mips, the finest of one texel for every
    /// [`MOMENT_TEXELS`]: mean and mean square of the horizon's sine at the least and at the greatest
    /// curvature.
    pub moments: wgpu::TextureView,
    /// `Rgba8Unorm`, layers for the least and greatest curvature, with mips: bent normal's x and y
    /// as (c + 1) / 2, and the cosine-weighted visible fraction.
    pub ambient: wgpu::TextureView,
    memory_bytes: u64,
}

impl BakedTables {
    pub(super) fn new(gpu: &Gpu, desc: &TableDesc, parts: Parts) -> Result<Self, Error> {
        use wgpu::TextureFormat as Format;
        let mut memory_bytes = 0;
        let mut view = |label: &str, used: bool, size: [u32; 2], layers, format, mips| {
            let [width, height] = if used { size } else { [1, 1] };
            let layers = array_layers(gpu, [width, height], if used { layers } else { 1 });
            let levels = if mips { width.max(height).ilog2() + 1 } else { 1 };
            let desc = wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
                mip_level_count: levels,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_DST
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            };
            if used {
                memory_bytes += bytes(&desc);
            }
            let texture = gpu.checked(label, |device| device.create_texture(&desc))?;
            Ok::<_, Error>(texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            }))
        };
        let candidates = desc.candidates() > 0;
        let (published_format, candidates_format) =
            if candidates { (Format::Rg8Unorm, desc.format()) } else { (desc.format(), Format::R32Uint) };
        let tiles = desc.size.map(|side| side.div_ceil(TILE_TEXELS));
        let blocks = desc.size.map(|side| side.div_ceil(MOMENT_TEXELS));
        let (layers, moments, ambient) = (desc.azimuths, parts.prefilter, parts.ambient);
        Ok(Self {
            published: view(
                "horizon-shadow published",
                !candidates,
                desc.size,
                layers,
                published_format,
                false,
            )?,
            candidates: view(
                "horizon-shadow candidates",
                candidates,
                desc.size,
                layers,
                candidates_format,
                false,
            )?,
            extents: view("horizon-shadow extents", candidates, tiles, layers, Format::Rg8Unorm, false)?,
            moments: view(
                "horizon-shadow moments",
                candidates && moments,
                blocks,
                layers,
                Format::Rgba16Float,
                true,
            )?,
            ambient: view(
                "horizon-shadow ambient",
                candidates && ambient,
                desc.size,
                2,
                Format::Rgba8Unorm,
                true,
            )?,
            memory_bytes,
        })
    }

    /// The texture that holds the tables themselves.
    pub(super) fn of(&self, desc: &TableDesc) -> &wgpu::TextureView {
        if desc.candidates() > 0 { &self.candidates } else { &self.published }
    }

    /// Bytes that the textures take, heights not among them.
    pub fn memory_bytes(&self) -> u64 {
        self.memory_bytes
    }
}

/// Layers with which a texture becomes an array on OpenGL too, where wgpu takes one layer for a plain
/// texture and square layers in sixes for cube maps.
fn array_layers(gpu: &Gpu, [width, height]: [u32; 2], layers: u32) -> u32 {
    let is_array = layers > 1 && (width != height || !layers.is_multiple_of(6));
    let is_opengl = gpu.adapter_info().backend == wgpu::Backend::Gl;
    if is_opengl && !is_array { layers + 1 } else { layers }
}

fn bytes(desc: &wgpu::TextureDescriptor<'_>) -> u64 {
    let texel = u64::from(desc.format.block_copy_size(None).unwrap_or(0));
    let level = |level: u32| {
        let side = |side: u32| u64::from((side >> level).max(1));
        side(desc.size.width) * side(desc.size.height) * texel
    };
    u64::from(desc.size.depth_or_array_layers) * (0..desc.mip_level_count).map(level).sum::<u64>()
}
