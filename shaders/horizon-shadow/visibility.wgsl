// Visibility of up to four lights, for meshes with a height map.

struct VisibilityLight {
    // KIND_DIRECTIONAL: unit, towards the light. KIND_POINT: its position.
    vector_world: vec3f,
    // KIND_DIRECTIONAL: half the angle under which it is seen, radians. KIND_POINT: metres.
    radius: f32,
    kind: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

struct VisibilityPass {
    clip_from_world: mat4x4f,
    lights: array<VisibilityLight, 4>,
    light_count: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

const KIND_DARK: u32 = 1u;
const KIND_DIRECTIONAL: u32 = 2u;
const KIND_POINT: u32 = 3u;

@group(0) @binding(0) var<uniform> pass_uniform: VisibilityPass;

@group(1) @binding(0) var<uniform> parameters: HorizonShadowParameters;
@group(1) @binding(1) var heights: texture_2d<f32>;
@group(1) @binding(2) var published: texture_2d_array<f32>;
@group(1) @binding(3) var candidates: texture_2d_array<u32>;
@group(1) @binding(4) var extents: texture_2d_array<f32>;
@group(1) @binding(5) var moments: texture_2d_array<f32>;
@group(1) @binding(7) var linear_sampler: sampler;

// What a pipeline fixes of the parameters, so that compilers leave the rest out.
override method: u32 = HORIZON_SHADOW_METHOD_SHEEN;
override contents: u32 = HORIZON_SHADOW_CONTENTS_COMPACT;
override candidate_count: u32 = 2u;
override flags: u32 = 0u;

struct VertexIn {
    @location(0) position_local: vec3f,
    @location(1) normal_local: vec3f,
    @location(2) uv: vec2f,
    @location(3) along_u_local: vec3f,
    @location(4) along_v_local: vec3f,
    @location(5) second_form: vec3f,
    // Rows of world_from_local.
    @location(6) world_from_local_0: vec4f,
    @location(7) world_from_local_1: vec4f,
    @location(8) world_from_local_2: vec4f,
    // Columns of the normals' matrix.
    @location(9) world_from_normal_0: vec4f,
    @location(10) world_from_normal_1: vec4f,
    @location(11) world_from_normal_2: vec4f,
}

struct VertexOut {
    // Invariant, because the pass finds the surfaces of the host's own by their depth.
    @builtin(position) @invariant position: vec4f,
    @location(0) position_world: vec3f,
    @location(1) normal_world: vec3f,
    @location(2) uv: vec2f,
    @location(3) along_u_world: vec3f,
    @location(4) along_v_world: vec3f,
    @location(5) second_form: vec3f,
}

@vertex
fn visibility_vertex(in: VertexIn) -> VertexOut {
    let p = vec4f(in.position_local, 1.0);
    let position_world = vec3f(
        dot(in.world_from_local_0, p), dot(in.world_from_local_1, p), dot(in.world_from_local_2, p));
    let n = in.normal_local;
    let normal_world = in.world_from_normal_0.xyz * n.x + in.world_from_normal_1.xyz * n.y
        + in.world_from_normal_2.xyz * n.z;
    let u = in.along_u_local;
    let v = in.along_v_local;

    var out: VertexOut;
    out.position = pass_uniform.clip_from_world * vec4f(position_world, 1.0);
    out.position_world = position_world;
    out.normal_world = sheen_normalize_or(normal_world, vec3f(0.0, 1.0, 0.0));
    out.uv = in.uv;
    out.along_u_world = vec3f(
        dot(in.world_from_local_0.xyz, u), dot(in.world_from_local_1.xyz, u), dot(in.world_from_local_2.xyz, u));
    out.along_v_world = vec3f(
        dot(in.world_from_local_0.xyz, v), dot(in.world_from_local_1.xyz, v), dot(in.world_from_local_2.xyz, v));
    out.second_form = in.second_form * second_form_scale(
        in.world_from_local_0.xyz, in.world_from_local_1.xyz, in.world_from_local_2.xyz, n);
    return out;
}

// 1 / |M^-T n|: what the second fundamental form is multiplied by when M, given by its rows, takes
// the surface of unit normal n to the world. 0 where M has no inverse.
fn second_form_scale(row_0: vec3f, row_1: vec3f, row_2: vec3f, normal_local: vec3f) -> f32 {
    // Brought to size 1 first, so that no product of three leaves the range of floats.
    let largest = max(abs(row_0), max(abs(row_1), abs(row_2)));
    let size = max(largest.x, max(largest.y, largest.z));
    if !(size > 0.0) {
        return 0.0;
    }
    let a = row_0 / size;
    let b = row_1 / size;
    let c = row_2 / size;
    let n = sheen_normalize_or(normal_local, vec3f(0.0, 1.0, 0.0));
    // M^-T is the matrix of cofactors over the determinant.
    let cofactors_n = length(vec3f(dot(cross(b, c), n), dot(cross(c, a), n), dot(cross(a, b), n)));
    return size * abs(dot(a, cross(b, c))) / max(cofactors_n, 1e-20);
}

@fragment
fn visibility(in: VertexOut, @builtin(front_facing) front_facing: bool) -> @location(0) vec4f {
    var surface: HorizonShadowSurface;
    surface.uv = in.uv;
    surface.uv_dx = dpdx(in.uv);
    surface.uv_dy = dpdy(in.uv);
    surface.normal_world = sheen_normalize_or(in.normal_world, vec3f(0.0, 1.0, 0.0));
    surface.along_u_world = in.along_u_world;
    surface.along_v_world = in.along_v_world;
    surface.second_form = in.second_form;

    var settled = parameters;
    settled.method = method;
    settled.contents = contents;
    settled.candidates = candidate_count;
    settled.flags = flags;
    var visible = vec4f(1.0);
    for (var i = 0u; i < min(pass_uniform.light_count, 4u); i++) {
        let light = pass_uniform.lights[i];
        visible[i] = 0.0;
        let towards = direction_and_radius(light, in.position_world);
        // Written so that what is not a number is dark.
        if !(dot(towards.xyz, towards.xyz) > 0.25) {
            continue;
        }
        if !front_facing {
            // The back shows the relief from behind, of which the tables know nothing.
            visible[i] = select(0.0, 1.0, dot(towards.xyz, surface.normal_world) < 0.0);
            continue;
        }
        visible[i] = horizon_shadow_visibility(heights, published, candidates, extents, moments,
            linear_sampler, settled, surface, towards.xyz, towards.w);
    }
    return visible;
}

// Unit direction to the light (0 where it has none) and half the angle under which it is seen.
fn direction_and_radius(light: VisibilityLight, position_world: vec3f) -> vec4f {
    if light.kind == KIND_DIRECTIONAL {
        return vec4f(light.vector_world, light.radius);
    }
    if light.kind != KIND_POINT {
        return vec4f(0.0);
    }
    let to_light = light.vector_world - position_world;
    // Scaled first: squares of kilometres are fine, those of 1e20 metres are not.
    let size = max(abs(to_light.x), max(abs(to_light.y), abs(to_light.z)));
    if !(size > 0.0) {
        return vec4f(0.0);
    }
    let scaled = to_light / size;
    let direction = sheen_normalize_or(scaled, vec3f(0.0));
    let sine = min(light.radius / size / length(scaled), 1.0);
    return vec4f(direction, atan2(sine, sqrt(max(1.0 - sine * sine, 0.0))));
}
