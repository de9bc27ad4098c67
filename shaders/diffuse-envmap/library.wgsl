// diffuse-envmap: environment lighting from mirror to diffuse by one roughness t.
//
// Hirokawa and Ikedo, "A Diffused Environment Mapping"; equation numbers are theirs. Directions
// are unit vectors. Functions named `..._environment` work in the environment's own space and
// know nothing of intensity or rotation; `diffuse_envmap_radiance` is the whole technique in
// world space.

const DIFFUSE_ENVMAP_METHOD_PAPER: u32 = 0u;
const DIFFUSE_ENVMAP_METHOD_SHEEN: u32 = 1u;
const DIFFUSE_ENVMAP_FLAG_SLERP: u32 = 1u;
const DIFFUSE_ENVMAP_FLAG_DISCARD: u32 = 2u;
const DIFFUSE_ENVMAP_FLAG_UNIFORM_ANGLE: u32 = 4u;
const DIFFUSE_ENVMAP_FLAG_ROTATE: u32 = 8u;
const DIFFUSE_ENVMAP_FLAG_PARALLAX: u32 = 16u;
// Nothing was built from the map: only lobes of a few texels can be shown.
const DIFFUSE_ENVMAP_FLAG_NO_CHAIN: u32 = 32u;

// Layout of the tables texture; the same numbers stand in taps.rs and tables.rs.
const DIFFUSE_ENVMAP_NODES_PER_OCTAVE: f32 = 8.0;
const DIFFUSE_ENVMAP_OCTAVES: f32 = 10.0;
const DIFFUSE_ENVMAP_RING_TAPS: u32 = 6u;
const DIFFUSE_ENVMAP_ROW_TAPS: u32 = 0u;
const DIFFUSE_ENVMAP_ROW_LACK: u32 = 1u;
const DIFFUSE_ENVMAP_ROW_HARMONICS: u32 = 2u;
const DIFFUSE_ENVMAP_ROW_SOURCE_AXIS: u32 = 3u;
const DIFFUSE_ENVMAP_ROW_SOURCE_POWER: u32 = 4u;
const DIFFUSE_ENVMAP_ROW_SOURCE_KIND: u32 = 5u;
const DIFFUSE_ENVMAP_SUMMARY: u32 = 9u;
const DIFFUSE_ENVMAP_MAX_SOURCES: u32 = 64u;
// From this chain level on (faces of 64 texels) extended sources are not in the chain.
const DIFFUSE_ENVMAP_EXTENDED_LEVEL: f32 = -5.0;

// Harmonics alone take over within 0.1 of t from here.
const DIFFUSE_ENVMAP_HARMONICS_FROM: f32 = 0.85;

// The lattice of taps for narrow lobes: spacing over t, and the weights of its nineteen points.
const DIFFUSE_ENVMAP_LATTICE_SPACING: f32 = 0.634958;
const DIFFUSE_ENVMAP_LATTICE_CENTRE: f32 = 0.11042;
const DIFFUSE_ENVMAP_LATTICE_NEAR: f32 = 0.08305;
const DIFFUSE_ENVMAP_LATTICE_MIDDLE: f32 = 0.04060;
const DIFFUSE_ENVMAP_LATTICE_FAR: f32 = 0.02461;

// Ratio of the lobe's root mean square angle to t, radians (49.08 degrees).
const DIFFUSE_ENVMAP_RMS_ANGLE: f32 = 0.85660;

struct DiffuseEnvmapParameters {
    // Rotation of the environment about +Y: cosine, sine; intensity; added roughness.
    rotation_cosine: f32,
    rotation_sine: f32,
    intensity: f32,
    roughness_offset: f32,
    // Texels of the map, and edge of a face of the chain's finest level.
    map_size: vec2u,
    face_size: u32,
    method: u32,
    flags: u32,
    paper_rays: u32,
    one_tap_contrast: f32,
    reserved: f32,
    // Box parallax: least and greatest corner and centre, world space, metres.
    box_min_world: vec4f,
    box_max_world: vec4f,
    box_centre_world: vec4f,
}

// Eq. 1.
fn diffuse_envmap_mirror(view: vec3f, normal: vec3f) -> vec3f {
    return view - 2.0 * dot(normal, view) * normal;
}

// t in 0..1; a roughness that is not a number counts as 1, which never makes a false highlight.
fn diffuse_envmap_roughness(t: f32) -> f32 {
    return select(1.0, clamp(t, 0.0, 1.0), t == t);
}

// Eq. 3: the lobe's axis between the mirror direction (t = 0) and the normal (t = 1).
fn diffuse_envmap_base(mirror: vec3f, normal: vec3f, t: f32, flags: u32) -> vec3f {
    if t <= 0.0 {
        return mirror;
    }
    let linear = sheen_normalize_or((1.0 - t) * mirror + t * normal, normal);
    if (flags & DIFFUSE_ENVMAP_FLAG_SLERP) == 0u {
        return linear;
    }
    let angle = sheen_angle(mirror, normal);
    if angle < 1e-3 || angle > SHEEN_PI - 1e-3 {
        return linear;
    }
    return sheen_normalize_or(sin((1.0 - t) * angle) * mirror + sin(t * angle) * normal, normal);
}

// The lobe's density per steradian at an angle from its axis: sin(2 x) / (2 pi t sin(theta)) with
// x = theta / t, and 1 / (pi t^2) on the axis. t above 0.
fn diffuse_envmap_density(t: f32, theta: f32) -> f32 {
    let x = theta / t;
    if x >= 0.5 * SHEEN_PI {
        return 0.0;
    }
    if x < 1e-3 {
        return 1.0 / (SHEEN_PI * t * t);
    }
    return sin(2.0 * x) / (2.0 * SHEEN_PI * t * sin(theta));
}

// The direction at an angle from an axis.
fn diffuse_envmap_around(axis: vec3f, around: SheenFrame, theta: f32, phi: f32) -> vec3f {
    return sin(theta) * (cos(phi) * around.x + sin(phi) * around.y) + cos(theta) * axis;
}

// Where the box that stands for the environment is hit from a point inside it, seen from the
// place where the environment was captured. Outside the box the direction is left as it is.
fn diffuse_envmap_parallax(direction: vec3f, position_world: vec3f, p: DiffuseEnvmapParameters) -> vec3f {
    let inside = all(position_world > p.box_min_world.xyz) && all(position_world < p.box_max_world.xyz);
    if !inside {
        return direction;
    }
    // A component of zero never reaches its walls; 1e-12 keeps the division finite.
    let safe = select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
    let walls = select(p.box_min_world.xyz, p.box_max_world.xyz, safe > vec3f(0.0));
    let distances = (walls - position_world) / safe;
    let hit = position_world + min(distances.x, min(distances.y, distances.z)) * direction;
    return sheen_normalize_or(hit - p.box_centre_world.xyz, direction);
}

// World to the environment's own space: the inverse of the rotation about +Y.
fn diffuse_envmap_to_environment(v: vec3f, p: DiffuseEnvmapParameters) -> vec3f {
    let c = p.rotation_cosine;
    let s = p.rotation_sine;
    return vec3f(c * v.x - s * v.z, v.y, s * v.x + c * v.z);
}

// The unfiltered map: what a perfect mirror shows. Texels that are no radiance (not a number,
// negative, infinite) are brought into range; all others are untouched.
fn diffuse_envmap_lookup(map: texture_2d<f32>, linear: sampler, direction: vec3f) -> vec3f {
    return diffuse_envmap_texel(map, linear, sheen_lat_long_uv(direction));
}

fn diffuse_envmap_texel(map: texture_2d<f32>, linear: sampler, uv: vec2f) -> vec3f {
    let raw = textureSampleLevel(map, linear, uv, 0.0).rgb;
    return min(select(vec3f(0.0), raw, raw > vec3f(0.0)), vec3f(SHEEN_RADIANCE_MAX));
}

// A well mixed number in 0..1 from a pixel.
fn diffuse_envmap_pixel_random(pixel: vec2u) -> f32 {
    var state = pixel.x * 747796405u + pixel.y * 2891336453u + 277803737u;
    state = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return f32(((state >> 22u) ^ state) >> 8u) / 16777216.0;
}

// The published method: eqs. 2 to 4 with `paper_rays` rays into the unfiltered map.
fn diffuse_envmap_paper(
    map: texture_2d<f32>,
    linear: sampler,
    p: DiffuseEnvmapParameters,
    axis: vec3f,
    normal: vec3f,
    t: f32,
    pixel: vec2u,
) -> vec3f {
    let around = sheen_frame(axis);
    var turn = 0.0;
    if (p.flags & DIFFUSE_ENVMAP_FLAG_ROTATE) != 0u {
        turn = diffuse_envmap_pixel_random(pixel);
    }
    var sum = vec3f(0.0);
    var count = 0.0;
    for (var ray = 0u; ray < p.paper_rays; ray++) {
        let xi = (f32(ray) + 0.5) / f32(p.paper_rays);
        var theta = acos(sqrt(1.0 - xi));
        if (p.flags & DIFFUSE_ENVMAP_FLAG_UNIFORM_ANGLE) != 0u {
            theta = 0.5 * SHEEN_PI * xi;
        }
        // Successive rays turn by the golden angle, which fills the disc evenly for any count.
        let phi = 2.0 * SHEEN_PI * fract(f32(ray) * 0.6180339887 + turn);
        let direction = diffuse_envmap_around(axis, around, t * theta, phi);
        if (p.flags & DIFFUSE_ENVMAP_FLAG_DISCARD) != 0u && dot(direction, normal) < 0.0 {
            continue;
        }
        sum += diffuse_envmap_lookup(map, linear, direction);
        count += 1.0;
    }
    return select(diffuse_envmap_lookup(map, linear, axis), sum / count, count > 0.0);
}

// Bands 1 and 2 of the environment without its bright sources, each with a factor.
fn diffuse_envmap_bands(tables: texture_2d<f32>, d: vec3f, band_1: f32, band_2: f32) -> vec3f {
    let row = DIFFUSE_ENVMAP_ROW_HARMONICS;
    let first = d.y * textureLoad(tables, vec2u(1u, row), 0).rgb
        + d.z * textureLoad(tables, vec2u(2u, row), 0).rgb
        + d.x * textureLoad(tables, vec2u(3u, row), 0).rgb;
    let second = d.x * d.y * textureLoad(tables, vec2u(4u, row), 0).rgb
        + d.y * d.z * textureLoad(tables, vec2u(5u, row), 0).rgb
        + (3.0 * d.z * d.z - 1.0) * textureLoad(tables, vec2u(6u, row), 0).rgb
        + d.x * d.z * textureLoad(tables, vec2u(7u, row), 0).rgb
        + (d.x * d.x - d.y * d.y) * textureLoad(tables, vec2u(8u, row), 0).rgb;
    return band_1 * first + band_2 * second;
}

// Band 4 of the environment without its bright sources.
fn diffuse_envmap_band_4(tables: texture_2d<f32>, d: vec3f) -> vec3f {
    let s = d * d;
    var basis = array<f32, 9>(
        d.x * d.y * (s.x - s.y), d.y * d.z * (3.0 * s.x - s.y), d.x * d.y * (7.0 * s.z - 1.0),
        d.y * d.z * (7.0 * s.z - 3.0), (35.0 * s.z - 30.0) * s.z + 3.0, d.x * d.z * (7.0 * s.z - 3.0),
        (s.x - s.y) * (7.0 * s.z - 1.0), d.x * d.z * (s.x - 3.0 * s.y),
        s.x * (s.x - 3.0 * s.y) - s.y * (3.0 * s.x - s.y),
    );
    var sum = vec3f(0.0);
    for (var i = 0u; i < 9u; i++) {
        let factor = textureLoad(tables, vec2u(DIFFUSE_ENVMAP_SUMMARY + 1u + i, DIFFUSE_ENVMAP_ROW_HARMONICS), 0);
        sum += basis[i] * factor.rgb;
    }
    return sum;
}

// Lobes near t = 1 of the environment without its bright sources: harmonics. The lobe's
// coefficients in bands 1 and 2 are 2 (1 + cos(pi t / 2)) / (4 - t^2) and
// (1 + 3 sin^2(pi s / 2) / (s (2 - s))) / 4 with s = 1 - t; at t = 1 they are 2/3 and 1/4, that of band 3 is 0 and
// that of band 4 is -1/24.
fn diffuse_envmap_harmonics(tables: texture_2d<f32>, axis: vec3f, t: f32) -> vec3f {
    let mean = textureLoad(tables, vec2u(0u, DIFFUSE_ENVMAP_ROW_HARMONICS), 0).rgb;
    let band_1 = 2.0 * (1.0 + cos(0.5 * SHEEN_PI * t)) / (4.0 - t * t);
    let s = max(1.0 - t, 1e-6);
    let sine = sin(0.5 * SHEEN_PI * s);
    let band_2 = 0.25 * (1.0 + 3.0 * sine * sine / (s * (2.0 - s)));
    let low = mean + diffuse_envmap_bands(tables, axis, band_1, band_2);
    return max(low - diffuse_envmap_band_4(tables, axis) / 24.0, vec3f(0.0));
}

// The angle of a direction above the horizon.
fn diffuse_envmap_lift(normal: vec3f, direction: vec3f) -> f32 {
    return 0.5 * SHEEN_PI - sheen_acos(dot(normal, direction));
}

// Part of a lobe above the horizon: the integral of a Gaussian of the lobe's variance, stretched a
// little so that it is 0 and 1 where the lobe's rim touches the horizon. `lift` is the angle of the
// axis above the horizon.
fn diffuse_envmap_above(t: f32, lift: f32) -> f32 {
    let x = lift / (DIFFUSE_ENVMAP_RMS_ANGLE * max(t, 1e-6));
    // At the rim x is 1.8337, and the logistic curve 0.015606 from its end.
    let logistic = 1.0 / (1.0 + exp(clamp(-2.26 * x, -60.0, 60.0)));
    return clamp((logistic - 0.015606) / (1.0 - 2.0 * 0.015606), 0.0, 1.0);
}

// The lobe's density convolved with a round source of root mean square radius `spread`, at an
// angle between their axes.
//
// Across the lobe's rim, where its slope jumps, a three-point Gauss-Hermite rule along the angle
// stands for the source; sideways the source only adds to the angle. Of a source that is wide
// beside the lobe, the rest of its variance widens the lobe itself.
fn diffuse_envmap_convolved_density(t: f32, spread: f32, angle: f32) -> f32 {
    let sigma = min(0.70710678 * spread, 0.2 * t);
    let rest = max(spread * spread - 2.0 * sigma * sigma, 0.0);
    let wide = min(sqrt(t * t + rest / (DIFFUSE_ENVMAP_RMS_ANGLE * DIFFUSE_ENVMAP_RMS_ANGLE)), 1.0);
    let middle = sqrt(angle * angle + sigma * sigma);
    let step = 1.7320508 * sigma;
    return (4.0 * diffuse_envmap_density(wide, middle)
        + diffuse_envmap_density(wide, abs(middle - step))
        + diffuse_envmap_density(wide, middle + step)) / 6.0;
}

// The bright sources, each convolved with the lobe. Extended ones count by `extended_share`, the
// part of them that the chain does not hold.
fn diffuse_envmap_sources(
    tables: texture_2d<f32>,
    p: DiffuseEnvmapParameters,
    axis: vec3f,
    normal: vec3f,
    t: f32,
    extended_share: f32,
) -> vec3f {
    let count = u32(textureLoad(tables, vec2u(DIFFUSE_ENVMAP_SUMMARY, DIFFUSE_ENVMAP_ROW_HARMONICS), 0).x);
    let discard_below = (p.flags & DIFFUSE_ENVMAP_FLAG_DISCARD) != 0u;
    // Beyond the lobe's rim, with room for the source's own radius, nothing arrives.
    let rim = cos(min(0.5 * SHEEN_PI * t + 0.15, SHEEN_PI));
    var sum = vec3f(0.0);
    for (var i = 0u; i < min(count, DIFFUSE_ENVMAP_MAX_SOURCES); i++) {
        let source = textureLoad(tables, vec2u(i, DIFFUSE_ENVMAP_ROW_SOURCE_AXIS), 0);
        if dot(source.xyz, axis) < rim {
            continue;
        }
        let kind = textureLoad(tables, vec2u(i, DIFFUSE_ENVMAP_ROW_SOURCE_KIND), 0).x;
        let power = textureLoad(tables, vec2u(i, DIFFUSE_ENVMAP_ROW_SOURCE_POWER), 0).rgb;
        var part = diffuse_envmap_convolved_density(t, source.w, sheen_angle(axis, source.xyz));
        if discard_below {
            part *= diffuse_envmap_above(source.w / DIFFUSE_ENVMAP_RMS_ANGLE, diffuse_envmap_lift(normal, source.xyz));
        }
        sum += part * mix(1.0, extended_share, kind) * power;
    }
    if discard_below {
        let lift = diffuse_envmap_lift(normal, axis);
        // By t = 0.5 no lobe dips. Of one that is all but below the horizon a fiftieth is kept, as
        // what is left of it must not outshine the source itself.
        sum /= select(1.0, max(diffuse_envmap_above(t, lift), 0.02), t < 0.5);
    }
    return sum;
}

// One fetched level of the chain: radiance, and root mean square luminance in w.
fn diffuse_envmap_chain(
    chain: texture_cube<f32>,
    linear: sampler,
    p: DiffuseEnvmapParameters,
    direction: vec3f,
    level: f32,
) -> vec4f {
    return textureSampleLevel(chain, linear, direction, level - diffuse_envmap_finest_level(p));
}

// Level e of the chain has faces of 2^(1 - e) texels; this is the finest there is.
fn diffuse_envmap_finest_level(p: DiffuseEnvmapParameters) -> f32 {
    return 1.0 - log2(f32(p.face_size));
}

// The part of the extended sources that a level of the chain does not hold.
fn diffuse_envmap_extended_share(p: DiffuseEnvmapParameters, level: f32) -> f32 {
    let held = max(level, diffuse_envmap_finest_level(p));
    return clamp(held - DIFFUSE_ENVMAP_EXTENDED_LEVEL + 1.0, 0.0, 1.0);
}

// The ring of six taps; taps below the horizon lose their weight.
fn diffuse_envmap_ring(
    chain: texture_cube<f32>,
    linear: sampler,
    p: DiffuseEnvmapParameters,
    axis: vec3f,
    normal: vec3f,
    ring_angle: f32,
    level: f32,
) -> vec3f {
    let around = sheen_frame(axis);
    let discard_below = (p.flags & DIFFUSE_ENVMAP_FLAG_DISCARD) != 0u;
    var sum = vec3f(0.0);
    var weights = 1e-6;
    for (var tap = 0u; tap < DIFFUSE_ENVMAP_RING_TAPS; tap++) {
        let phi = 2.0 * SHEEN_PI * (f32(tap) + 0.5) / f32(DIFFUSE_ENVMAP_RING_TAPS);
        let direction = diffuse_envmap_around(axis, around, ring_angle, phi);
        var weight = 1.0;
        if discard_below {
            weight = clamp(dot(direction, normal) / ring_angle * 2.0 + 0.5, 0.0, 1.0);
        }
        sum += weight * diffuse_envmap_chain(chain, linear, p, direction, level).rgb;
        weights += weight;
    }
    return sum / weights;
}

// A tap of a narrow lobe: the map gives way to the map without its compact sources.
fn diffuse_envmap_narrow_tap(
    map: texture_2d<f32>,
    residual: texture_2d<f32>,
    linear: sampler,
    direction: vec3f,
    source_share: f32,
) -> vec3f {
    let uv = sheen_lat_long_uv(direction);
    // Lobes of a texel and more need the residual alone.
    if source_share >= 1.0 {
        return diffuse_envmap_texel(residual, linear, uv);
    }
    let whole = diffuse_envmap_texel(map, linear, uv);
    return mix(whole, diffuse_envmap_texel(residual, linear, uv), source_share);
}

// Lobes of half a texel to two: nineteen taps into the map itself, on a hexagonal lattice whose
// spacing gives the lobe's variance when the taps are weighted by its density.
fn diffuse_envmap_narrow(
    map: texture_2d<f32>,
    residual: texture_2d<f32>,
    linear: sampler,
    axis: vec3f,
    t: f32,
    source_share: f32,
) -> vec3f {
    let around = sheen_frame(axis);
    var sum = vec3f(0.0);
    for (var tap = 0u; tap < 19u; tap++) {
        // The centre, six near ones, six between and six far ones.
        let ring = (tap + 5u) / 6u;
        let turn = f32(tap % 6u) + select(0.0, 0.5, ring == 2u);
        let radius = array<f32, 4>(0.0, 1.0, 1.7320508, 2.0)[ring];
        let weight = array<f32, 4>(DIFFUSE_ENVMAP_LATTICE_CENTRE, DIFFUSE_ENVMAP_LATTICE_NEAR,
            DIFFUSE_ENVMAP_LATTICE_MIDDLE, DIFFUSE_ENVMAP_LATTICE_FAR)[ring];
        let direction = diffuse_envmap_around(axis, around,
            radius * DIFFUSE_ENVMAP_LATTICE_SPACING * t, turn * SHEEN_PI / 3.0);
        sum += weight * diffuse_envmap_narrow_tap(map, residual, linear, direction, source_share);
    }
    return sum;
}

// The better method's lobe out of the chain and the harmonics: radiance, and in w the part of
// the extended sources that it lacks.
fn diffuse_envmap_wide(
    chain: texture_cube<f32>,
    tables: texture_2d<f32>,
    linear: sampler,
    p: DiffuseEnvmapParameters,
    axis: vec3f,
    normal: vec3f,
    t: f32,
) -> vec4f {
    let node = clamp((log2(t) + DIFFUSE_ENVMAP_OCTAVES) * DIFFUSE_ENVMAP_NODES_PER_OCTAVE, 0.0,
        DIFFUSE_ENVMAP_OCTAVES * DIFFUSE_ENVMAP_NODES_PER_OCTAVE);
    let below = u32(min(node, DIFFUSE_ENVMAP_OCTAVES * DIFFUSE_ENVMAP_NODES_PER_OCTAVE - 1.0));
    let fraction = node - f32(below);
    let taps = mix(textureLoad(tables, vec2u(below, DIFFUSE_ENVMAP_ROW_TAPS), 0),
        textureLoad(tables, vec2u(below + 1u, DIFFUSE_ENVMAP_ROW_TAPS), 0), fraction);
    let lack = mix(textureLoad(tables, vec2u(below, DIFFUSE_ENVMAP_ROW_LACK), 0),
        textureLoad(tables, vec2u(below + 1u, DIFFUSE_ENVMAP_ROW_LACK), 0), fraction);

    let one = diffuse_envmap_chain(chain, linear, p, axis, taps.x);
    var radiance = one.rgb;
    var bands = lack.xy;
    var extended_share = diffuse_envmap_extended_share(p, taps.x);
    // Relative contrast inside the lobe, from its mean and mean square luminance.
    let luminance = dot(one.rgb, vec3f(0.2126, 0.7152, 0.0722));
    let variance = max(one.w * one.w - luminance * luminance, 0.0);
    let contrast = sqrt(variance) / max(luminance, 1e-6);
    // Fading in over a factor of two keeps the change of method invisible.
    let ring_share = clamp(contrast / max(p.one_tap_contrast, 1e-6) - 1.0, 0.0, 1.0);
    if ring_share > 0.0 {
        let ring = diffuse_envmap_ring(chain, linear, p, axis, normal, taps.y, taps.z);
        radiance = mix(radiance, ring, ring_share);
        bands = mix(bands, lack.zw, ring_share);
        extended_share = mix(extended_share, diffuse_envmap_extended_share(p, taps.z), ring_share);
    }
    if t > 0.15 {
        radiance += diffuse_envmap_bands(tables, axis, bands.x, bands.y);
    }
    return vec4f(max(radiance, vec3f(0.0)), extended_share);
}

// The better method, in the environment's own space. `axis` is the lobe's, after eq. 3;
// `residual` is the map without its compact bright sources.
fn diffuse_envmap_sheen(
    map: texture_2d<f32>,
    residual: texture_2d<f32>,
    chain: texture_cube<f32>,
    tables: texture_2d<f32>,
    linear: sampler,
    p: DiffuseEnvmapParameters,
    axis: vec3f,
    normal: vec3f,
    t: f32,
) -> vec3f {
    // Less than half a texel: the mirror, to the last bit.
    let texels = DIFFUSE_ENVMAP_RMS_ANGLE * t / SHEEN_PI * f32(p.map_size.y);
    if texels < 0.5 {
        return diffuse_envmap_lookup(map, linear, axis);
    }
    let has_chain = (p.flags & DIFFUSE_ENVMAP_FLAG_NO_CHAIN) == 0u;
    let summary = textureLoad(tables, vec2u(DIFFUSE_ENVMAP_SUMMARY, DIFFUSE_ENVMAP_ROW_HARMONICS), 0);
    if has_chain && summary.y > 0.0 {
        // Every texel is alike: no taps.
        return textureLoad(tables, vec2u(0u, DIFFUSE_ENVMAP_ROW_HARMONICS), 0).rgb;
    }
    // The chain's finest level is as wide as a lobe of this t.
    let finest = 2.0 / (f32(p.face_size) * 0.6057);
    let wide_share = select(0.0, clamp(2.5 * (t / finest - 0.8), 0.0, 1.0), has_chain);
    // From half a texel to a whole one the map's own bright texels give way to the sources.
    let source_share = select(0.0, clamp(2.0 * texels - 1.0, 0.0, 1.0), has_chain);
    let harmonics_share = clamp((t - DIFFUSE_ENVMAP_HARMONICS_FROM) / 0.1, 0.0, 1.0);

    // Radiance without the sources, and in w the part of the extended ones that it lacks.
    var radiance = vec4f(0.0);
    if wide_share > 0.0 && harmonics_share < 1.0 {
        radiance = diffuse_envmap_wide(chain, tables, linear, p, axis, normal, t);
    }
    if wide_share < 1.0 {
        let narrow = diffuse_envmap_narrow(map, residual, linear, axis, t, source_share);
        radiance = mix(vec4f(narrow, 0.0), radiance, wide_share);
    }
    if harmonics_share > 0.0 {
        radiance = mix(radiance, vec4f(diffuse_envmap_harmonics(tables, axis, t), 1.0), harmonics_share);
    }
    if source_share > 0.0 {
        let sources = diffuse_envmap_sources(tables, p, axis, normal, t, radiance.w);
        radiance += vec4f(max(source_share, wide_share) * sources, 0.0);
    }
    return radiance.rgb;
}

// The radiance that a surface of roughness t reflects towards the eye, for a reflectance of one.
//
// `view_world` points from the eye to the surface; `position_world` matters for box parallax
// only; `pixel` for the paper's rotated pattern only.
fn diffuse_envmap_radiance(
    map: texture_2d<f32>,
    residual: texture_2d<f32>,
    chain: texture_cube<f32>,
    tables: texture_2d<f32>,
    linear: sampler,
    p: DiffuseEnvmapParameters,
    normal_world: vec3f,
    view_world: vec3f,
    position_world: vec3f,
    roughness: f32,
    pixel: vec2u,
) -> vec3f {
    let t = diffuse_envmap_roughness(roughness + p.roughness_offset);
    let normal_up = sheen_normalize_or(normal_world, vec3f(0.0, 1.0, 0.0));
    let view = sheen_normalize_or(view_world, -normal_up);
    let reflected = diffuse_envmap_mirror(view, normal_up);
    var axis_world = diffuse_envmap_base(reflected, normal_up, t, p.flags);
    if (p.flags & DIFFUSE_ENVMAP_FLAG_PARALLAX) != 0u {
        axis_world = diffuse_envmap_parallax(axis_world, position_world, p);
    }
    let axis = diffuse_envmap_to_environment(axis_world, p);
    let normal = diffuse_envmap_to_environment(normal_up, p);
    if p.method == DIFFUSE_ENVMAP_METHOD_PAPER {
        return p.intensity * diffuse_envmap_paper(map, linear, p, axis, normal, t, pixel);
    }
    return p.intensity * diffuse_envmap_sheen(map, residual, chain, tables, linear, p, axis, normal, t);
}

// The share of light that a rough specular surface of reflectance ks at normal incidence
// reflects in all: the fit of Karis (2014, "Physically based shading on mobile") to the
// GGX split sum.
fn diffuse_envmap_specular_reflectance(ks: vec3f, roughness: f32, n_dot_v: f32) -> vec3f {
    let r = roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a = min(r.x * r.x, exp2(-9.28 * n_dot_v)) * r.x + r.y;
    let scale_bias = vec2f(-1.04, 1.04) * a + r.zw;
    // A surface that reflects nothing at normal incidence has no coat to reflect at grazing.
    let bias = scale_bias.y * clamp(50.0 * max(ks.x, max(ks.y, ks.z)), 0.0, 1.0);
    return clamp(ks * scale_bias.x + bias, vec3f(0.0), vec3f(1.0));
}
