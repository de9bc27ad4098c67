//! What the horizon tables of a height map hold, and how large they are.

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
    /// How far the search goes, in texels.
    pub radius_texels: f32,
}

/// What is stored for each texel and azimuth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Contents {
    /// The horizon of the flat surface, as published: `Rg8Unorm` of angle and distance (or
    /// `R8Unorm` of the distance alone), filtered by the sampler.
    Published(crate::Tables),
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
