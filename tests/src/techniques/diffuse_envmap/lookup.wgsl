// Every method on the same list of surfaces, in the same shader: a pixel of a picture, or a
// direction of a table.

@group(0) @binding(0) var<uniform> parameters: DiffuseEnvmapParameters;
@group(0) @binding(1) var map: texture_2d<f32>;
@group(0) @binding(2) var residual: texture_2d<f32>;
@group(0) @binding(3) var chain: texture_cube<f32>;
@group(0) @binding(4) var tables: texture_2d<f32>;
@group(0) @binding(5) var linear: sampler;

struct Query {
    // Unit normal, roughness; unit direction from the eye.
    normal_t: vec4f,
    view: vec4f,
}

@group(1) @binding(0) var<storage, read> queries: array<Query>;
@group(1) @binding(1) var<storage, read_write> answers: array<vec4f>;

struct Baselines {
    // The last level of the prefiltered map.
    last_level: f32,
    pad_0: f32,
    pad_1: f32,
    pad_2: f32,
}

@group(2) @binding(0) var prefiltered: texture_cube<f32>;
@group(2) @binding(1) var<storage, read> coefficients: array<vec4f, 9>;
@group(2) @binding(2) var<uniform> baselines: Baselines;

// The library's radiance with one method alone, as a host compiles that never changes it.
@compute @workgroup_size(64)
fn ours(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    var p = parameters;
    p.method = DIFFUSE_ENVMAP_METHOD_SHEEN;
    answers[id.x] = vec4f(diffuse_envmap_radiance(map, residual, chain, tables, linear, p,
        q.normal_t.xyz, q.view.xyz, vec3f(0.0), q.normal_t.w, vec2u(0u)), 1.0);
}

@compute @workgroup_size(64)
fn published(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    var p = parameters;
    p.method = DIFFUSE_ENVMAP_METHOD_PAPER;
    let pixel = vec2u(id.x % 512u, id.x / 512u);
    answers[id.x] = vec4f(diffuse_envmap_radiance(map, residual, chain, tables, linear, p,
        q.normal_t.xyz, q.view.xyz, vec3f(0.0), q.normal_t.w, pixel), 1.0);
}

// The axis of a query's lobe, found as the technique does.
fn axis_of(q: Query, t: f32) -> vec3f {
    let normal = sheen_normalize_or(q.normal_t.xyz, vec3f(0.0, 1.0, 0.0));
    let view = sheen_normalize_or(q.view.xyz, -normal);
    return diffuse_envmap_base(diffuse_envmap_mirror(view, normal), normal, t, parameters.flags);
}

@compute @workgroup_size(64)
fn mirror_only(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    answers[id.x] = vec4f(diffuse_envmap_lookup(map, linear, axis_of(queries[id.x], 0.0)), 1.0);
}

// A well mixed number in 0..1 from two.
fn random(a: u32, b: u32) -> f32 {
    return diffuse_envmap_pixel_random(vec2u(a * 3266489917u + b, b * 668265263u ^ a));
}

// As many rays as `paper_rays` says, each drawn by itself: what brute force means without a pattern.
@compute @workgroup_size(64)
fn independent_rays(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    let axis = axis_of(q, q.normal_t.w);
    let around = sheen_frame(axis);
    var sum = vec3f(0.0);
    var count = 0.0;
    for (var ray = 0u; ray < parameters.paper_rays; ray++) {
        let theta = q.normal_t.w * acos(sqrt(1.0 - random(id.x, 2u * ray)));
        let direction = diffuse_envmap_around(axis, around, theta, 2.0 * SHEEN_PI * random(id.x, 2u * ray + 1u));
        if dot(direction, q.normal_t.xyz) >= 0.0 {
            sum += diffuse_envmap_lookup(map, linear, direction);
            count += 1.0;
        }
    }
    answers[id.x] = vec4f(sum / max(count, 1.0), 1.0);
}

@compute @workgroup_size(64)
fn prefiltered_lookup(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    let t = q.normal_t.w;
    // Level k holds t = 2^(k - last), level 0 the mirror.
    let narrow = t * exp2(baselines.last_level - 1.0);
    let level = select(baselines.last_level + log2(max(t, 1e-6)), narrow, narrow < 1.0);
    answers[id.x] = vec4f(textureSampleLevel(prefiltered, linear, axis_of(q, t), level).rgb, 1.0);
}

@compute @workgroup_size(64)
fn harmonics_alone(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    let t = q.normal_t.w;
    let d = axis_of(q, t);
    // The lobe's first two Legendre coefficients in closed form.
    let first = 2.0 * (1.0 + cos(0.5 * SHEEN_PI * t)) / (4.0 - t * t);
    let s = max(1.0 - t, 1e-6);
    let sine = sin(0.5 * SHEEN_PI * s);
    let second = 0.25 * (1.0 + 3.0 * sine * sine / (s * (2.0 - s)));
    let sum = 0.282095 * coefficients[0].rgb
        + first * 0.488603 * (d.y * coefficients[1].rgb + d.z * coefficients[2].rgb + d.x * coefficients[3].rgb)
        + second * (1.092548 * (d.x * d.y * coefficients[4].rgb + d.y * d.z * coefficients[5].rgb
        + d.x * d.z * coefficients[7].rgb) + 0.315392 * (3.0 * d.z * d.z - 1.0) * coefficients[6].rgb
        + 0.546274 * (d.x * d.x - d.y * d.y) * coefficients[8].rgb);
    answers[id.x] = vec4f(max(sum, vec3f(0.0)), 1.0);
}
