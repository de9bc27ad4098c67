//! What the host lends for one `prepare`.

use std::ops::Range;

use crate::Wrap;

/// Everything that the tables depend on.
#[derive(Clone, Debug)]
pub struct Frame<'a> {
    /// The height map; `None` where the surface has none: then nothing is made and nothing costs.
    pub height_map: Option<HeightMap<'a>>,
    /// The surface that it lies on.
    pub surface: Surface,
    /// Which azimuths are needed, bit i for azimuth i; [`u64::MAX`] for all. Others are neither
    /// searched nor written.
    pub needed_azimuths: u64,
}

/// A height map on the GPU.
#[derive(Clone, Debug)]
pub struct HeightMap<'a> {
    /// A two-dimensional view of any format that a shader can load as f32 (R8Unorm, R16Float,
    /// R32Float ...); red counts. Heights that are not finite count as `least`.
    pub view: &'a wgpu::TextureView,
    /// Changed by the host whenever the heights change.
    pub revision: u64,
    /// Rows that changed since the revision before, `None` where any may have.
    pub changed_rows: Option<Range<u32>>,
    /// Least and greatest height of the map, finite; heights beyond are brought into the range.
    pub range: [f32; 2],
    /// Metres between the map's 0 and 1.
    pub height_scale_m: f32,
    /// How often the map repeats over 0..1 of the mesh's uv, along u and v.
    pub uv_scale: [f32; 2],
    /// What lies beyond the map along u and v.
    pub wrap: [Wrap; 2],
}

/// What the tables must suit: see [`crate::frames`] for how it follows from a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Typical length of a texel of the map on the surface, metres.
    pub texel_m: f32,
    /// Least and greatest normal curvature, 1 / metre, convex positive.
    pub curvature_per_m: [f32; 2],
}
