// Codes of the horizon candidates in the tables of horizon-shadow: the slope's in the low bits, the
// distance's above it. `codes.rs` does the same in the same order.

// Bits of the slope and of the distance of a compact and of a full candidate.
const HORIZON_SHADOW_COMPACT_BITS: vec2u = vec2u(10u, 6u);
const HORIZON_SHADOW_FULL_BITS: vec2u = vec2u(16u, 16u);

// Slopes, up / across, and distances of the candidates of a cell's four corners.
struct HorizonShadowPairs {
    up: vec4f,
    across: vec4f,
    distance: vec4f,
}

// Candidates from their codes: 16 bits each where the tables are compact, else 32. A slope is
// scale * x / (1 - |x|) with x in -1..1, so that steep edges have codes as well, and 0 has one
// exactly; a distance is 1 + (radius - 1) y^2 with y in 0..1.
fn horizon_shadow_decoded(codes: vec4u, parameters: HorizonShadowParameters) -> HorizonShadowPairs {
    let full = parameters.contents == HORIZON_SHADOW_CONTENTS_FULL;
    let bits = select(HORIZON_SHADOW_COMPACT_BITS, HORIZON_SHADOW_FULL_BITS, full);
    let levels = vec2f(vec2u(1u) << bits);
    let slope_code = codes & vec4u((1u << bits.x) - 1u);
    let distance_code = (codes >> vec4u(bits.x)) & vec4u((1u << bits.y) - 1u);
    let x = vec4f(slope_code) * (2.0 / levels.x) - 1.0;
    let y = vec4f(distance_code);
    let per_code = 1.0 / (levels.y - 1.0);
    return HorizonShadowPairs(
        parameters.slope_scale * x, max(1.0 - abs(x), vec4f(1e-5)),
        1.0 + ((parameters.radius_texels - 1.0) * per_code * per_code) * (y * y));
}

// The code of a slope.
fn horizon_shadow_slope_code(slope: f32, bits: vec2u, slope_scale: f32) -> u32 {
    let half_range = 0.5 * f32(1u << bits.x);
    let x = slope / (slope_scale + abs(slope));
    return u32(clamp(floor(half_range * x + half_range + 0.5), 1.0, 2.0 * half_range - 1.0));
}

// The code of a distance in texels.
fn horizon_shadow_distance_code(distance: f32, bits: vec2u, radius: f32) -> u32 {
    let fraction = clamp((distance - 1.0) / (radius - 1.0), 0.0, 1.0);
    return u32(floor(sqrt(fraction) * f32((1u << bits.y) - 1u) + 0.5));
}

// The code of candidate `index` in each of four corners' words.
fn horizon_shadow_codes(
    a: vec4u, b: vec4u, c: vec4u, d: vec4u, index: u32, parameters: HorizonShadowParameters,
) -> vec4u {
    if parameters.contents == HORIZON_SHADOW_CONTENTS_FULL {
        return vec4u(a[index], b[index], c[index], d[index]);
    }
    let word = index / 2u;
    let shift = vec4u(16u * (index & 1u));
    return (vec4u(a[word], b[word], c[word], d[word]) >> shift) & vec4u(0xffffu);
}

// Candidate `index` of a texel: its slope in the bake's texels, and its distance in texels.
fn horizon_shadow_candidate(
    words: vec4u, index: u32, parameters: HorizonShadowParameters,
) -> vec2f {
    let codes = horizon_shadow_codes(words, words, words, words, index, parameters);
    let pairs = horizon_shadow_decoded(codes, parameters);
    return vec2f(pairs.up.x / pairs.across.x, pairs.distance.x);
}

// Half the spacing of the slope codes around slopes.
fn horizon_shadow_slope_error(slope: vec4f, parameters: HorizonShadowParameters) -> vec4f {
    let levels = select(1024.0, 65536.0, parameters.contents == HORIZON_SHADOW_CONTENTS_FULL);
    let from_pole = parameters.slope_scale + abs(slope);
    return from_pole * from_pole / (max(parameters.slope_scale, 1e-20) * levels);
}
