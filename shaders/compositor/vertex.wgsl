// What the passes that draw triangles share: the vertex stage and the shading normal.

@group(0) @binding(0) var<uniform> view: CompositorView;

// The smallest cosine between the shading normal and the direction to the eye.
const MIN_N_V: f32 = 0.00390625;

struct VertexIn {
    @location(0) position_local: vec3f,
    @location(1) normal_local: vec3f,
    // w is the bitangent's sign, or 0 where the mesh has no tangents.
    @location(2) tangent_local: vec4f,
    @location(3) uv: vec2f,
    // Rows of world_from_local.
    @location(4) world_from_local_0: vec4f,
    @location(5) world_from_local_1: vec4f,
    @location(6) world_from_local_2: vec4f,
    // Columns of the normals' matrix; w of the first is -1 where the instance is mirrored, else 1;
    // w of the second is the instance's number, which shadows are told apart by.
    @location(7) world_from_normal_0: vec4f,
    @location(8) world_from_normal_1: vec4f,
    @location(9) world_from_normal_2: vec4f,
}

struct VertexOut {
    // Invariant, because the coat pass finds its surfaces again by their depth.
    @builtin(position) @invariant position: vec4f,
    @location(0) position_world: vec3f,
    @location(1) normal_world: vec3f,
    @location(2) tangent_world: vec4f,
    @location(3) uv: vec2f,
}

// A direction of the mesh in the world, turned and scaled.
fn vector_world(in: VertexIn, v: vec3f) -> vec3f {
    return vec3f(
        dot(in.world_from_local_0.xyz, v), dot(in.world_from_local_1.xyz, v), dot(in.world_from_local_2.xyz, v));
}

fn placed(in: VertexIn) -> VertexOut {
    let p = vec4f(in.position_local, 1.0);
    let position_world = vec3f(
        dot(in.world_from_local_0, p), dot(in.world_from_local_1, p), dot(in.world_from_local_2, p));
    let tangent_world = vector_world(in, in.tangent_local.xyz);
    let n = in.normal_local;
    let normal_world = in.world_from_normal_0.xyz * n.x + in.world_from_normal_1.xyz * n.y
        + in.world_from_normal_2.xyz * n.z;

    var out: VertexOut;
    out.position = view.clip_from_world * vec4f(position_world, 1.0);
    out.position_world = position_world;
    out.normal_world = sheen_normalize_or(normal_world, vec3f(0.0, 1.0, 0.0));
    // A mirrored instance turns the handedness of the tangent frame over.
    out.tangent_world = vec4f(
        sheen_normalize_or(tangent_world, vec3f(0.0)), in.tangent_local.w * in.world_from_normal_0.w);
    out.uv = in.uv;
    return out;
}

@vertex
fn geometry_vertex(in: VertexIn) -> VertexOut {
    return placed(in);
}

// Texture coordinates by two rows of an affine map.
fn affine_uv(row_u: vec4f, row_v: vec4f, uv: vec2f) -> vec2f {
    let p = vec3f(uv, 1.0);
    return vec2f(dot(row_u.xyz, p), dot(row_v.xyz, p));
}

// The unit shading normal before it is turned to the viewer. `texel` is the normal texture's.
fn relief_normal(in: VertexOut, texel: vec3f, scale: f32) -> vec3f {
    let normal = sheen_normalize_or(in.normal_world, vec3f(0.0, 1.0, 0.0));
    if in.tangent_world.w == 0.0 {
        return normal;
    }
    // mikktspace: the interpolated vectors are used as they are, neither normalised nor made
    // orthogonal, because the map was baked against them.
    let bitangent = sign(in.tangent_world.w) * cross(in.normal_world, in.tangent_world.xyz);
    let map = (texel * 2.0 - 1.0) * vec3f(scale, scale, 1.0);
    return sheen_normalize_or(
        in.tangent_world.xyz * map.x + bitangent * map.y + in.normal_world * map.z, normal);
}

// Bends a normal that faces away from the viewer (as interpolation and normal maps produce at
// silhouettes) just so far that the surface can be seen.
fn keep_visible(normal: vec3f, to_eye: vec3f) -> vec3f {
    let n_v = dot(normal, to_eye);
    if n_v >= MIN_N_V {
        return normal;
    }
    return sheen_normalize_or(normal + to_eye * (MIN_N_V - n_v), to_eye);
}
