//! What a person tunes.

use crate::tables::Precision;

/// Settings of horizon-shadow. Changing them never rebuilds a pipeline; those that decide what the
/// tables hold ([`azimuths`](Self::azimuths) and what follows it) bake the tables anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// How a point in shadow is told from a lit one.
    pub method: Method,
    /// Steps of [`Method::Marched`], 1..=1024. Few miss thin bumps, many are slow.
    pub march_steps: u32,
    /// Whether surfaces whose bumps are smaller than a pixel take prefiltered visibility. Only
    /// [`Method::Sheen`] and [`Method::Certified`]. Takes 4/3 bytes a texel and azimuth.
    pub prefilter: bool,
    /// Whether the least and greatest horizon of tiles of 8 x 8 texels decide first: two small loads
    /// where all the rest is left out on plainly lit or dark ground. Pays on GPUs, which leave out a
    /// branch that neighbouring pixels agree on; software adapters run both sides of it. Only
    /// [`Method::Sheen`] and [`Method::Certified`].
    pub tiles: bool,
    /// Whether ambient occlusion and bent normals are baked as well: 32/3 bytes a texel.
    pub ambient: bool,
    /// Directions around the normal for which horizons are stored, 4..=64. Few lose thin bumps
    /// between them; memory and bake time are proportional.
    pub azimuths: u32,
    /// Horizon candidates a texel and azimuth, 1..=4: what the envelope is taken of. Only
    /// [`Method::Sheen`] and [`Method::Certified`]; one is exact where the curvature is constant.
    pub candidates: u32,
    /// Bits of a candidate.
    pub precision: Precision,
    /// Which of the paper's two table layouts [`Method::Paper`] and [`Method::Exact`] read.
    pub tables: Tables,
    /// How the horizons are searched while baking.
    pub search: Search,
    /// How far bumps may lie that cast a shadow, in texels, 2..=4096.
    pub radius_texels: f32,
    /// Azimuths that one `prepare` bakes at most, 1 or more: spreads long bakes over frames.
    pub azimuths_per_prepare: u32,
}

/// How visibility is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// No shadows: everything is visible. Bump-mapped normals alone.
    None,
    /// The horizon map of a flat surface (Forsyth), whatever the curvature.
    Flat,
    /// As published: eqs. 1 to 4, on interpolated tables, with the sign of eq. 3 and the missing
    /// height of eq. 4 put right.
    Paper,
    /// The paper's tables, with the exact curved horizon in place of eqs. 2 and 3.
    Exact,
    /// The nearest texels traced, and beyond them the upper envelope of several candidates.
    Sheen,
    /// As [`Sheen`](Self::Sheen) where bounds decide; pixels between the bounds are marched.
    Certified,
    /// The relief marched on its curved profile in [`Settings::march_steps`] steps.
    Marched,
}

/// The paper's two table layouts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Tables {
    /// Horizon angle and distance: two bytes a texel and azimuth.
    BetaAndDistance,
    /// Distance alone; the angle follows from the heights (eq. 4): one byte.
    DistanceAndHeight,
}

/// How the GPU searches horizons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Search {
    /// One sweep along each line, with the hull of what lies ahead: time in proportion to the
    /// texels.
    Sweep,
    /// Every texel looks at every sample within the radius: the check.
    BruteForce,
}

impl Settings {
    /// The better method: two candidates of 16 bits, 32 azimuths.
    pub const SHEEN: Self = Self {
        method: Method::Sheen,
        march_steps: 64,
        prefilter: true,
        tiles: false,
        ambient: false,
        azimuths: 32,
        candidates: 2,
        precision: Precision::Compact,
        tables: Tables::BetaAndDistance,
        search: Search::Sweep,
        radius_texels: 64.0,
        azimuths_per_prepare: u32::MAX,
    };
    /// The method as published.
    pub const PAPER: Self = Self { method: Method::Paper, prefilter: false, ..Self::SHEEN };
    /// As exact as marching, at a fraction of its time.
    pub const CERTIFIED: Self = Self { method: Method::Certified, ..Self::SHEEN };
}

impl Default for Settings {
    fn default() -> Self {
        Self::SHEEN
    }
}
