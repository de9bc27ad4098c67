// The chain: a cube map whose level k is the environment convolved with a Gaussian of one texel
// (at the middle of a face) standard deviation, twice as wide per level. Alpha holds the root
// mean square luminance.
//
// Every texel gathers 37 taps on a hexagonal lattice around its direction: the finest level from
// the latitude-longitude map, every other from the level before it. A Gaussian after a Gaussian
// is a Gaussian, so the whole chain costs 37 * 4/3 taps per texel of its finest level.
//
// Extended bright sources leave the chain at the level whose Gaussian is about as wide as the
// parts they were divided into: from there on the library integrates them in closed form.

@group(0) @binding(0) var map: texture_2d<f32>;
@group(0) @binding(1) var finer: texture_cube<f32>;
@group(0) @binding(2) var linear: sampler;
@group(0) @binding(3) var target_level: texture_storage_2d_array<rgba16float, write>;
@group(0) @binding(4) var tables: texture_2d<f32>;
// The same level in a texture of its own, for the next dispatch to sample.
@group(0) @binding(5) var own_level: texture_storage_2d_array<rgba16float, write>;

// Same layout and level as the library's.
const ROW_HARMONICS: u32 = 2u;
const ROW_SOURCE_AXIS: u32 = 3u;
const ROW_SOURCE_POWER: u32 = 4u;
const ROW_SOURCE_KIND: u32 = 5u;
const SUMMARY: u32 = 9u;
const EXTENDED_FACE: u32 = 64u;

// Standard deviation of a level, in texels at the middle of a face.
const SIGMA_TEXELS: f32 = 1.0;
// Variance that one bilinear lookup adds on average, in squared texels.
const BILINEAR_VARIANCE: f32 = 1.0 / 6.0;
// The lattice in units of its spacing, and the Gaussian's width on it; the lattice's own variance
// per axis with these weights is LATTICE_VARIANCE.
const LATTICE_SIGMA: f32 = 1.15;
const LATTICE_VARIANCE: f32 = 1.2186;

struct Gather {
    axis: vec3f,
    around: SheenFrame,
    // Distance between neighbouring taps, radians.
    spacing: f32,
}

// Where a texel of the target gathers, if its lookups have to add `variance` texel^2 of the
// target, less what bilinear lookups add by themselves.
fn gather_of(texel: vec3u, face_size: f32, variance: f32) -> Gather {
    let at = (vec2f(texel.xy) + 0.5) / face_size * 2.0 - 1.0;
    let direction = sheen_cube_direction(texel.z, at);
    let squared = dot(direction, direction);
    let axis = direction * inverseSqrt(squared);
    let texel_angle = 2.0 / face_size;
    // Texels subtend less towards a face's edges, and blur less there when they are looked up.
    let local = inverseSqrt(squared) * inverseSqrt(sqrt(squared));
    let blur = BILINEAR_VARIANCE * local * local;
    let sigma = texel_angle * sqrt(variance - blur);
    return Gather(axis, sheen_frame(axis), sigma / sqrt(LATTICE_VARIANCE));
}

// A point of the lattice, in units of its spacing: 37 points in three rings about the centre.
fn lattice(index: u32) -> vec2f {
    if index == 0u {
        return vec2f(0.0);
    }
    let ring = select(select(3u, 2u, index < 19u), 1u, index < 7u);
    let step = index - (1u + 3u * ring * (ring - 1u));
    let side = step / ring;
    let along = f32(step % ring);
    let corner = f32(side) * SHEEN_PI / 3.0;
    let next = corner + 2.0 * SHEEN_PI / 3.0;
    return f32(ring) * vec2f(cos(corner), sin(corner)) + along * vec2f(cos(next), sin(next));
}

struct Tap {
    direction: vec3f,
    weight: f32,
}

fn tap_of(gather: Gather, index: u32) -> Tap {
    let point = lattice(index);
    let radius = length(point);
    let theta = radius * gather.spacing;
    let toward = select(vec2f(0.0), point / max(radius, 1e-6), radius > 0.0);
    let direction = cos(theta) * gather.axis
        + sin(theta) * (toward.x * gather.around.x + toward.y * gather.around.y);
    // sin(theta) / theta turns tangent-plane area into solid angle; its square root belongs to
    // the Gaussian on the sphere.
    let curved = sqrt(select(1.0, sin(theta) / theta, theta > 1e-3));
    return Tap(direction, curved * exp(-0.5 * radius * radius / (LATTICE_SIGMA * LATTICE_SIGMA)));
}

// The extended sources as this level holds them: radiance, and mean square luminance in w.
fn extended_sources(axis: vec3f, face_size: f32) -> vec4f {
    let count = u32(textureLoad(tables, vec2u(SUMMARY, ROW_HARMONICS), 0).x);
    let sigma = SIGMA_TEXELS * 2.0 / face_size;
    var sum = vec4f(0.0);
    for (var i = 0u; i < count; i++) {
        if textureLoad(tables, vec2u(i, ROW_SOURCE_KIND), 0).x == 0.0 {
            continue;
        }
        let source = textureLoad(tables, vec2u(i, ROW_SOURCE_AXIS), 0);
        let power = textureLoad(tables, vec2u(i, ROW_SOURCE_POWER), 0);
        let variance = sigma * sigma + 0.5 * source.w * source.w;
        let theta = sheen_angle(axis, source.xyz);
        sum += power * exp(-0.5 * theta * theta / variance) / (2.0 * SHEEN_PI * variance);
    }
    return sum;
}

// Rounds to the nearest half float. Some devices truncate when they store, and a chain of levels
// would grow darker by it.
fn nearest_half(v: vec4f) -> vec4f {
    let rounded = bitcast<vec4f>((bitcast<vec4u>(v) + vec4u(0x1000u)) & vec4u(0xffffe000u));
    return min(rounded, vec4f(SHEEN_HALF_MAX));
}

// Stores a gathered texel. Finer levels than EXTENDED_FACE hold the extended sources; the first
// level without them is the one that can still see them in what it gathered.
fn finish(texel: vec3u, axis: vec3f, sum: vec4f, weights: f32, with_extended: bool) {
    let face_size = textureDimensions(target_level).x;
    var mean = sum / weights;
    if with_extended && face_size <= EXTENDED_FACE {
        mean -= extended_sources(axis, f32(face_size));
    }
    // Squared means bound mean squares from below, whatever the subtraction left.
    let color = max(mean.rgb, vec3f(0.0));
    let luminance = dot(color, vec3f(0.2126, 0.7152, 0.0722));
    let stored = vec4f(color, max(sqrt(max(mean.w, 0.0)), luminance));
    textureStore(target_level, texel.xy, texel.z, nearest_half(stored));
    textureStore(own_level, texel.xy, texel.z, nearest_half(stored));
}

// The finest level, from the map.
@compute @workgroup_size(8, 8)
fn finest(@builtin(global_invocation_id) texel: vec3u) {
    let face_size = textureDimensions(target_level).x;
    if any(texel.xy >= vec2u(face_size)) {
        return;
    }
    let gather = gather_of(texel, f32(face_size), SIGMA_TEXELS * SIGMA_TEXELS);
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = 0u; i < 37u; i++) {
        let tap = tap_of(gather, i);
        let value = textureSampleLevel(map, linear, sheen_lat_long_uv(tap.direction), 0.0);
        sum += tap.weight * vec4f(value.rgb, value.w * value.w);
        weights += tap.weight;
    }
    finish(texel, gather.axis, sum, weights, true);
}

// Any other level, from the one before it.
@compute @workgroup_size(8, 8)
fn coarser(@builtin(global_invocation_id) texel: vec3u) {
    let face_size = textureDimensions(target_level).x;
    if any(texel.xy >= vec2u(face_size)) {
        return;
    }
    // From half the width to the whole one: three quarters of the variance are missing.
    let gather = gather_of(texel, f32(face_size), 0.75 * SIGMA_TEXELS * SIGMA_TEXELS);
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = 0u; i < 37u; i++) {
        let tap = tap_of(gather, i);
        let value = textureSampleLevel(finer, linear, tap.direction, 0.0);
        sum += tap.weight * vec4f(value.rgb, value.w * value.w);
        weights += tap.weight;
    }
    finish(texel, gather.axis, sum, weights, 2u * face_size > EXTENDED_FACE);
}
