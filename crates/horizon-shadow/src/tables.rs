//! What the horizon tables of a height map hold, and how large they are.

use gpu_context::wgpu;

use crate::{Error, Gpu, Tables};

/// Everything that decides the content of the tables, besides the heights.
///
/// Lengths are in texels: the mean length of a texel on the surface, and the curvature and height
/// of the relief against it, are what the host knows (see [`crate::Surface`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableDesc {
    /// Texels of the height map along u and v.
    pub size: [u32; 2],
    /// Directions around the normal, 4..=64. Azimuth i points along (cos, sin)(2 pi i / azimuths)
    /// in texels, x along +u and y along +v.
    pub azimuths: u32,
    /// What is stored for each texel and azimuth.
    pub contents: Contents,
    /// What lies beyond the map along u and v.
    pub wrap: [Wrap; 2],
    /// Least and greatest normal curvature of the base surface, 1 / texel, convex positive.
    pub curvature_per_texel: [f32; 2],
    /// Height of the map's value 1 above its value 0, in texels; not negative.
    pub texels_per_height: f32,
    /// How far the search goes, in texels, 2..=4096.
    pub radius_texels: f32,
}

/// What is stored for each texel and azimuth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Contents {
    /// The horizon of the flat surface, as published: `Rg8Unorm` of angle and distance (or
    /// `R8Unorm` of the distance alone), filtered by the sampler.
    Published(Tables),
    /// The flat surface's horizon angle alone: `R8Unorm`.
    Flat,
    /// The horizons beyond one texel for so many curvatures, 1..=4, as packed integers.
    Candidates {
        /// How many.
        count: u32,
        /// Bits of each.
        precision: Precision,
    },
}

/// Bits of a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Precision {
    /// 16 bits: slope and distance in bounded codes.
    Compact,
    /// 32 bits: 16 for each.
    Full,
}

/// What lies beyond the edge of a height map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The map again.
    Repeat,
    /// The texels of the edge.
    Clamp,
}

/// Texels along each side of a tile of the extents.
pub const TILE_TEXELS: u32 = 8;
/// Texels along each side of what a moment of the finest level is taken over.
pub const MOMENT_TEXELS: u32 = 4;
/// Curvatures whose least and greatest turn the farthest candidate by less than this (radians) share
/// one candidate.
const SAME_CURVATURE_RAD: f32 = 1e-4;

impl TableDesc {
    /// Whether every number is in its range; [`Error::Value`] names the first that is not.
    pub fn check(&self) -> Result<(), Error> {
        let [width, height] = self.size;
        check("height map's width", width, width >= 1, "at least 1 texel")?;
        check("height map's height", height, height >= 1, "at least 1 texel")?;
        check("azimuths", self.azimuths, (4..=64).contains(&self.azimuths), "4 to 64")?;
        if let Contents::Candidates { count, .. } = self.contents {
            check("candidates", count, (1..=4).contains(&count), "1 to 4")?;
        }
        let [least, greatest] = self.curvature_per_texel;
        let ordered = least <= greatest && least.abs() <= 1e3 && greatest.abs() <= 1e3;
        let curvatures = format!("{least}..{greatest}");
        check("curvature per texel", curvatures, ordered, "least <= greatest, each in -1000..=1000")?;
        let scale = self.texels_per_height;
        check("texels per height", scale, (0.0..=1e6).contains(&scale), "0 to 1e6")?;
        let radius = self.radius_texels;
        check("radius in texels", radius, (2.0..=4096.0).contains(&radius), "2 to 4096")
    }

    /// As [`check`](Self::check), and whether the device's limits allow the tables:
    /// [`gpu_context::Error::Limit`] where they do not. Takes no memory.
    pub fn check_device(&self, gpu: &Gpu) -> Result<(), Error> {
        self.check()?;
        gpu_context::upload::check_size(gpu, "height map", self.size[0], self.size[1])?;
        let limits = gpu.device().limits();
        let texels = u64::from(self.size[0]) * u64::from(self.size[1]);
        let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        limit("height map's relief in bytes", 4 * texels, binding)?;
        let pitch = u64::from(self.size[0]) * u64::from(self.texel_bytes()) + 256;
        limit("one azimuth's table in bytes", pitch * u64::from(self.size[1]), binding)?;
        limit("azimuths", self.azimuths.into(), limits.max_texture_array_layers.into())
    }

    /// The curvatures, 1 / texel, whose winners are stored as candidates 0, 1 ...: ascending, evenly
    /// spaced with both ends included; the middle where there is one. One is enough where the range
    /// is so narrow that it does not tell. The published tables know the flat surface's alone.
    pub fn nodes(&self) -> Vec<f32> {
        let Contents::Candidates { count, .. } = self.contents else { return vec![0.0] };
        let [least, greatest] = self.curvature_per_texel;
        if count <= 1 || (greatest - least) * self.radius_texels * 0.5 < SAME_CURVATURE_RAD {
            return vec![0.5 * (least + greatest)];
        }
        let step = (greatest - least) / (count - 1) as f32;
        (0..count).map(|i| if i + 1 == count { greatest } else { least + step * i as f32 }).collect()
    }

    /// Candidates that are stored for each texel and azimuth: as many as [`nodes`](Self::nodes);
    /// 0 where the tables are not candidates.
    pub fn candidates(&self) -> u32 {
        match self.contents {
            Contents::Candidates { .. } => self.nodes().len() as u32,
            Contents::Published(_) | Contents::Flat => 0,
        }
    }

    /// Format of the texture array that holds the tables.
    pub fn format(&self) -> wgpu::TextureFormat {
        use wgpu::TextureFormat as Format;
        match self.contents {
            Contents::Published(Tables::BetaAndDistance) => Format::Rg8Unorm,
            Contents::Published(Tables::DistanceAndHeight) | Contents::Flat => Format::R8Unorm,
            Contents::Candidates { precision, .. } => match (precision, self.candidates()) {
                (Precision::Compact, 1) => Format::R16Uint,
                (Precision::Compact, 2) | (Precision::Full, 1) => Format::R32Uint,
                (Precision::Compact, _) | (Precision::Full, 2) => Format::Rg32Uint,
                (Precision::Full, _) => Format::Rgba32Uint,
            },
        }
    }

    /// Bytes for each texel and azimuth.
    pub fn texel_bytes(&self) -> u32 {
        self.format().block_copy_size(None).unwrap_or(4)
    }

    /// Bytes of the tables as the paper counts them: those of every azimuth, and three bytes a texel
    /// for height and normal; with the extents of tiles where there are candidates, without
    /// prefiltered visibility and ambient occlusion. The paper's own tables take 2 A + 3 bytes a
    /// texel for A azimuths.
    pub fn memory_bytes(&self) -> u64 {
        let texels = u64::from(self.size[0]) * u64::from(self.size[1]);
        let azimuths = u64::from(self.azimuths);
        let tables = texels * (azimuths * u64::from(self.texel_bytes()) + 3);
        let tiles: u64 = self.size.iter().map(|&side| u64::from(side.div_ceil(TILE_TEXELS))).product();
        tables + if self.candidates() > 0 { 2 * azimuths * tiles } else { 0 }
    }
}

fn check(
    what: &'static str,
    found: impl std::fmt::Display,
    holds: bool,
    expected: &str,
) -> Result<(), Error> {
    if holds {
        return Ok(());
    }
    Err(Error::Value { what, found: format!("{found}"), expected: expected.to_owned() })
}

fn limit(what: &str, found: u64, limit: u64) -> Result<(), Error> {
    if found <= limit {
        return Ok(());
    }
    Err(gpu_context::Error::Limit { what: what.to_owned(), found, limit }.into())
}
