// Parameters, height maps and the codes of the tables of horizon-shadow: what baking and looking up
// share. Lengths are in texels, heights in texels above the map's least height, slopes are tangents.

struct HorizonShadowParameters {
    // Texels of the height map.
    size: vec2f,
    // How often the map repeats over 0..1 of the mesh's uv.
    uv_scale: vec2f,
    // The map's own values.
    least_height: f32,
    greatest_height: f32,
    // Metres between the map's 0 and 1.
    height_scale_m: f32,
    // Texels between the map's 0 and 1, as the tables were baked.
    texels_per_height: f32,
    // Normal curvatures that the tables were baked for, 1 / texel, convex positive.
    least_curvature: f32,
    greatest_curvature: f32,
    // How far the tables see.
    radius_texels: f32,
    // Slope at which half of the slope code's range is used.
    slope_scale: f32,
    azimuths: u32,
    // Candidates a texel and azimuth; 0 where the tables are the published ones.
    candidates: u32,
    // HORIZON_SHADOW_CONTENTS_*
    contents: u32,
    // Bit 0: repeats along u; bit 1: along v.
    wrap: u32,
    // Bit i of the pair: azimuth i is baked.
    baked_azimuths: vec2u,
    // HORIZON_SHADOW_METHOD_*
    method: u32,
    march_steps: u32,
    // HORIZON_SHADOW_FLAG_*
    flags: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

const HORIZON_SHADOW_METHOD_NONE: u32 = 0u;
const HORIZON_SHADOW_METHOD_FLAT: u32 = 1u;
const HORIZON_SHADOW_METHOD_PAPER: u32 = 2u;
const HORIZON_SHADOW_METHOD_EXACT: u32 = 3u;
const HORIZON_SHADOW_METHOD_SHEEN: u32 = 4u;
const HORIZON_SHADOW_METHOD_CERTIFIED: u32 = 5u;
const HORIZON_SHADOW_METHOD_MARCHED: u32 = 6u;

const HORIZON_SHADOW_CONTENTS_FLAT: u32 = 0u;
const HORIZON_SHADOW_CONTENTS_BETA_AND_DISTANCE: u32 = 1u;
const HORIZON_SHADOW_CONTENTS_DISTANCE_AND_HEIGHT: u32 = 2u;
const HORIZON_SHADOW_CONTENTS_COMPACT: u32 = 3u;
const HORIZON_SHADOW_CONTENTS_FULL: u32 = 4u;

// The tables hold prefiltered visibility, ambient occlusion, extents of tiles.
const HORIZON_SHADOW_FLAG_PREFILTER: u32 = 1u;
const HORIZON_SHADOW_FLAG_AMBIENT: u32 = 2u;
const HORIZON_SHADOW_FLAG_EXTENTS: u32 = 4u;

// Below this distance Sheen's methods trace the relief; its tables begin there.
const HORIZON_SHADOW_NEAR_TEXELS: f32 = 1.0;
