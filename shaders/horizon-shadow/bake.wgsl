// What the passes of a bake share: their bindings and the relief. Distances and heights are in
// texels, heights above the map's least.

struct HorizonShadowBake {
    size: vec2u,
    // The rows that are worked on: the first, and the one after the last.
    rows: vec2u,
    // From one sample of the azimuth to the next.
    advance: vec2f,
    // Its length.
    spacing: f32,
    radius: f32,
    // Samples that may be the horizon.
    first_sample: u32,
    last_sample: u32,
    // Least and greatest curvature.
    curvatures: vec2f,
    // Curvatures whose horizons are stored.
    kappas: vec4f,
    nodes: u32,
    // HORIZON_SHADOW_CONTENTS_*
    contents: u32,
    // Bit 0: repeats along x; bit 1: along y.
    wrap: u32,
    // 1 where each texel looks at every sample, 0 where the sweep has found where to look.
    brute_force: u32,
    least_height: f32,
    greatest_height: f32,
    texels_per_height: f32,
    slope_scale: f32,
    // Words of a row of `encoded`.
    pitch: u32,
    // Bits of one code, and codes and words of what one invocation writes.
    code_bits: u32,
    unit_codes: u32,
    unit_words: u32,
    // The sweep: the curvature node, whether lines run along y, and whether against the axis.
    node: u32,
    along_y: u32,
    backward: u32,
    // Texels that a line moves sideways for each texel along the axis.
    drift: f32,
    line_first: i32,
    lines: u32,
    // Texels of a line that one invocation fills, and how many it looks ahead.
    block: u32,
    reach: u32,
    first_invocation: u32,
    invocations: u32,
    azimuth: u32,
    azimuths: u32,
    // A coarser level: its size, the level that it is made from, and whether texels are four half
    // floats or four bytes. `azimuth` is the layer.
    level_size: vec2u,
    finer_level: u32,
    half_floats: u32,
    // Points of the profile for each node.
    profile_row: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

@group(0) @binding(0) var<uniform> bake: HorizonShadowBake;
@group(0) @binding(1) var<storage, read_write> relief: array<f32>;
// [s, c, cos(gamma), distance] of each node's samples, then of its distance codes.
@group(0) @binding(2) var<storage, read_write> profile: array<vec4f>;
// Sample at which the sweep saw the horizon, for each node of each texel of the rows; 0 for none.
@group(0) @binding(3) var<storage, read_write> winners: array<u32>;
@group(0) @binding(4) var<storage, read_write> encoded: array<u32>;
// The sweep's scratch memory.
@group(0) @binding(5) var<storage, read_write> points: array<vec2f>;
@group(0) @binding(6) var<storage, read_write> links: array<u32>;

// A whole coordinate brought to the map, 0..size - 1.
fn bake_wrapped(at: f32, size: u32, repeats: bool) -> u32 {
    let extent = f32(size);
    let turned = select(at, at - extent * floor(at / extent), repeats);
    return u32(clamp(turned, 0.0, extent - 1.0));
}

// Bilinear height at a point; texel centres are at whole numbers.
fn bake_height(at: vec2f) -> f32 {
    let low = floor(at);
    let fraction = at - low;
    let repeats = vec2<bool>((bake.wrap & 1u) != 0u, (bake.wrap & 2u) != 0u);
    let x0 = bake_wrapped(low.x, bake.size.x, repeats.x);
    let x1 = bake_wrapped(low.x + 1.0, bake.size.x, repeats.x);
    let y0 = bake_wrapped(low.y, bake.size.y, repeats.y) * bake.size.x;
    let y1 = bake_wrapped(low.y + 1.0, bake.size.y, repeats.y) * bake.size.x;
    let above = relief[y0 + x0] + (relief[y0 + x1] - relief[y0 + x0]) * fraction.x;
    let below = relief[y1 + x0] + (relief[y1 + x1] - relief[y1 + x0]) * fraction.x;
    return above + (below - above) * fraction.y;
}
