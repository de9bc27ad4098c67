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

// Tangent that stands for "no horizon at all"; its negative bounds slopes from above.
const HORIZON_SHADOW_NO_HORIZON: f32 = -1e4;
// (pi / 2) squared: candidates beyond a quarter turn are never seen.
const HORIZON_SHADOW_QUARTER_TURN_SQUARED: f32 = 2.4674011;

// Heights above the least in the map's own units; what is not finite counts as the least. The bits
// are tested because compilers may assume that no number is NaN.
fn horizon_shadow_sanitised(raw: vec4f, parameters: HorizonShadowParameters) -> vec4f {
    let not_finite = (bitcast<vec4u>(raw) & vec4u(0x7f800000u)) == vec4u(0x7f800000u);
    let finite = select(raw, vec4f(parameters.least_height), not_finite);
    let least = vec4f(parameters.least_height);
    return clamp(finite, least, vec4f(parameters.greatest_height)) - least;
}

// The map's size along the directions in which it repeats, and 0 along others.
fn horizon_shadow_period(parameters: HorizonShadowParameters) -> vec2f {
    let repeats = vec2<bool>((parameters.wrap & 1u) != 0u, (parameters.wrap & 2u) != 0u);
    return select(vec2f(0.0), parameters.size, repeats);
}

// A point in texels (texel centres at whole numbers) brought to the map: into 0..size where it
// repeats, and to within a texel of the map where it does not.
fn horizon_shadow_reduced(at: vec2f, parameters: HorizonShadowParameters) -> vec2f {
    let period = horizon_shadow_period(parameters);
    let turned = at - period * floor(at / parameters.size);
    return clamp(turned, vec2f(-1.0), parameters.size);
}

// The texel of a whole point that lies at most one map size away.
fn horizon_shadow_wrapped(at: vec2f, parameters: HorizonShadowParameters) -> vec2i {
    let period = horizon_shadow_period(parameters);
    let zero = vec2f(0.0);
    let turned = at + select(zero, period, at < zero) - select(zero, period, at >= parameters.size);
    return vec2i(clamp(turned, zero, parameters.size - 1.0));
}

// Height of any texel, wrapped, above the map's least height, in the map's own units.
fn horizon_shadow_texel(
    heights: texture_2d<f32>, parameters: HorizonShadowParameters, at: vec2i,
) -> f32 {
    let texel = horizon_shadow_wrapped(horizon_shadow_reduced(vec2f(at), parameters), parameters);
    return horizon_shadow_sanitised(vec4f(textureLoad(heights, texel, 0).x), parameters).x;
}

// Four texels around a point.
struct HorizonShadowCell {
    // The corners at (0, 0) and (1, 1), wrapped.
    low: vec2i,
    high: vec2i,
    // The first corner before it was wrapped.
    origin: vec2f,
    // The point from there, 0..1.
    fraction: vec2f,
    // Of the corners at (0, 0), (1, 0), (0, 1), (1, 1), above the least, in the map's own units.
    heights: vec4f,
}

// The cell of a reduced point. On the border of two cells it is the one that lies towards
// `direction`.
fn horizon_shadow_cell(
    heights: texture_2d<f32>, parameters: HorizonShadowParameters, at: vec2f, direction: vec2f,
) -> HorizonShadowCell {
    var cell: HorizonShadowCell;
    cell.origin = select(floor(at), ceil(at) - 1.0, direction < vec2f(0.0));
    cell.fraction = at - cell.origin;
    cell.low = horizon_shadow_wrapped(cell.origin, parameters);
    cell.high = horizon_shadow_wrapped(cell.origin + 1.0, parameters);
    let raw = vec4f(
        textureLoad(heights, cell.low, 0).x,
        textureLoad(heights, vec2i(cell.high.x, cell.low.y), 0).x,
        textureLoad(heights, vec2i(cell.low.x, cell.high.y), 0).x,
        textureLoad(heights, cell.high, 0).x,
    );
    cell.heights = horizon_shadow_sanitised(raw, parameters);
    return cell;
}

// Bilinear weights of a cell's corners.
fn horizon_shadow_weights(fraction: vec2f) -> vec4f {
    let x = vec2f(1.0 - fraction.x, fraction.x);
    return vec4f(x * (1.0 - fraction.y), x * fraction.y);
}

// Bilinear height at any point in texels, above the map's least height, in the map's own units.
fn horizon_shadow_bilinear(
    heights: texture_2d<f32>, parameters: HorizonShadowParameters, at_texels: vec2f,
) -> f32 {
    let at = horizon_shadow_reduced(at_texels, parameters);
    let cell = horizon_shadow_cell(heights, parameters, at, vec2f(0.0));
    return dot(horizon_shadow_weights(cell.fraction), cell.heights);
}

// tan(angle / 2) / (angle / 2) of x = angle squared, at most (pi / 2) squared: within 4.2e-6.
fn horizon_shadow_half_tangent(x: vec4f) -> vec4f {
    return 1.0 + x * (0.083284773 + x * (0.008513487 + x * (0.00064023852 + x * 0.00016971532)));
}

// Tangents of horizons as fractions, so that the larger of two and their sines take no division.
struct HorizonShadowRises {
    up: vec4f,
    // Not negative; 0 where there is no horizon, and `up` then is -1.
    across: vec4f,
}

// Tangents of the horizon that points make which lie `distance` ahead and slope * distance higher,
// slope = slope_up / slope_across, seen from `height` over a base of the curvature `kappa` (the exact
// form): gamma = kappa d, tan(beta') = [H cos(gamma) - (1 + kappa h) c] / [(1 + kappa (h + H)) s] with
// s = sin(gamma) / kappa, c = (1 - cos(gamma)) / kappa. Here with t = tan(gamma / 2), of which sine and
// cosine are fractions, and divided by d / (1 + t^2), so that d and kappa may be 0.
fn horizon_shadow_exact_rises(
    kappa: f32, distance: vec4f, slope_up: vec4f, slope_across: vec4f, height: vec4f,
) -> HorizonShadowRises {
    let limit = vec4f(HORIZON_SHADOW_QUARTER_TURN_SQUARED);
    let gamma = kappa * distance;
    let squared = gamma * gamma;
    let w = horizon_shadow_half_tangent(min(squared, limit));
    let t = 0.5 * gamma * w;
    let from_centre = (1.0 + kappa * height) * slope_across;
    let across = from_centre + gamma * slope_up;
    let up = slope_up - t * (slope_up * t + from_centre * w);
    let seen = (squared < limit) & (across > vec4f(0.0));
    return HorizonShadowRises(select(vec4f(-1.0), up, seen), select(vec4f(0.0), across * w, seen));
}

// The higher horizon of each pair.
fn horizon_shadow_higher(a: HorizonShadowRises, b: HorizonShadowRises) -> HorizonShadowRises {
    let second = b.up * a.across > a.up * b.across;
    return HorizonShadowRises(select(a.up, b.up, second), select(a.across, b.across, second));
}

// Tangents of slopes themselves, bounded.
fn horizon_shadow_exact_slopes(kappa: f32, distance: vec4f, slope: vec4f, height: vec4f) -> vec4f {
    let rises = horizon_shadow_exact_rises(kappa, distance, slope, vec4f(1.0), height);
    let bound = vec4f(-HORIZON_SHADOW_NO_HORIZON);
    return clamp(rises.up / max(rises.across, vec4f(1e-20)), -bound, bound);
}

// The same of one point, with its rise H instead of the slope.
fn horizon_shadow_exact(kappa: f32, distance: f32, rise: f32, height: f32) -> f32 {
    let slope = clamp(rise / max(distance, 1e-20), -1e8, 1e8);
    return horizon_shadow_exact_slopes(kappa, vec4f(distance), vec4f(slope), vec4f(height)).x;
}

// Tangents of the smooth base's own horizon, seen from heights above it (eq. 3, downwards):
// -sqrt(kappa h (2 + kappa h)), without cancellation; none where the base is not convex.
fn horizon_shadow_floors(kappa: f32, height: vec4f) -> vec4f {
    let x = max(kappa * height, vec4f(0.0));
    let none = vec4f(HORIZON_SHADOW_NO_HORIZON);
    return select(none, max(-sqrt(x * (2.0 + x)), none), vec4<bool>(kappa > 0.0));
}

fn horizon_shadow_floor(kappa: f32, height: f32) -> f32 {
    return horizon_shadow_floors(kappa, vec4f(height)).x;
}
