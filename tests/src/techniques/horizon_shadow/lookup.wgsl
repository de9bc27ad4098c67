// Every method on the same list of surfaces: a pixel of a picture, or a direction of a table.

@group(0) @binding(0) var<uniform> parameters: HorizonShadowParameters;
@group(0) @binding(1) var heights: texture_2d<f32>;
@group(0) @binding(2) var published: texture_2d_array<f32>;
@group(0) @binding(3) var candidates: texture_2d_array<u32>;
@group(0) @binding(4) var extents: texture_2d_array<f32>;
@group(0) @binding(5) var moments: texture_2d_array<f32>;
@group(0) @binding(6) var ambient: texture_2d_array<f32>;
@group(0) @binding(7) var linear: sampler;

// In the order of the Rust struct.
struct Query {
    uv: vec2f,
    light_radius_rad: f32,
    pad: f32,
    uv_dx: vec2f,
    uv_dy: vec2f,
    normal_world: vec4f,
    along_u_world: vec4f,
    along_v_world: vec4f,
    second_form: vec4f,
    light_world: vec4f,
}

@group(1) @binding(0) var<storage, read> queries: array<Query>;
@group(1) @binding(1) var<storage, read_write> answers: array<f32>;

// The one method that a pipeline is compiled for, as a host does that never changes it.
override method: u32;

fn surface_of(q: Query) -> HorizonShadowSurface {
    var surface: HorizonShadowSurface;
    surface.uv = q.uv;
    surface.uv_dx = q.uv_dx;
    surface.uv_dy = q.uv_dy;
    surface.normal_world = q.normal_world.xyz;
    surface.along_u_world = q.along_u_world.xyz;
    surface.along_v_world = q.along_v_world.xyz;
    surface.second_form = q.second_form.xyz;
    return surface;
}

@compute @workgroup_size(64)
fn visibility(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    var p = parameters;
    p.method = method;
    answers[id.x] = horizon_shadow_visibility(heights, published, candidates, extents, moments, linear, p,
        surface_of(q), q.light_world.xyz, q.light_radius_rad);
}

@compute @workgroup_size(64)
fn horizon(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    var p = parameters;
    p.method = method;
    answers[id.x] = horizon_shadow_horizon(heights, published, candidates, extents, moments, linear, p,
        surface_of(q), q.light_world.xyz);
}
