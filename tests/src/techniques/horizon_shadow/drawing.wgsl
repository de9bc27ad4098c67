// What the pictures need besides the technique's own pass: which point of the surface a pixel
// shows, and a shadow map of the displaced mesh, for comparison.

struct View {
    clip_from_world: mat4x4f,
    light_clip_from_world: mat4x4f,
    uv_scale: vec2f,
    size: vec2f,
    height_scale_m: f32,
    bias: f32,
    // Bit 0: repeats along u; bit 1: along v.
    wrap: u32,
    pad: u32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var heights: texture_2d<f32>;
@group(0) @binding(2) var depth_from_light: texture_2d<f32>;

struct VertexIn {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
}

struct VertexOut {
    @builtin(position) position: vec4f,
    @location(0) position_world: vec3f,
    @location(1) normal_world: vec3f,
    @location(2) uv: vec2f,
}

@vertex
fn base_vertex(in: VertexIn) -> VertexOut {
    return VertexOut(view.clip_from_world * vec4f(in.position, 1.0), in.position, in.normal, in.uv);
}

@fragment
fn coordinates(in: VertexOut) -> @location(0) vec4f {
    return vec4f(in.uv, in.position.z, 1.0);
}

@vertex
fn depth_vertex(@location(0) position: vec3f) -> @builtin(position) vec4f {
    return view.light_clip_from_world * vec4f(position, 1.0);
}

fn wrapped(index: i32, size: i32, repeats: bool) -> i32 {
    if repeats {
        return ((index % size) + size) % size;
    }
    return clamp(index, 0, size - 1);
}

fn texel(x: i32, y: i32) -> f32 {
    let size = vec2i(view.size);
    let at = vec2i(wrapped(x, size.x, (view.wrap & 1u) != 0u), wrapped(y, size.y, (view.wrap & 2u) != 0u));
    return textureLoad(heights, at, 0).r;
}

fn height_m(uv: vec2f) -> f32 {
    let at = uv * view.uv_scale * view.size - 0.5;
    let base = vec2i(floor(at));
    let f = at - floor(at);
    let near = mix(texel(base.x, base.y), texel(base.x + 1, base.y), f.x);
    let far = mix(texel(base.x, base.y + 1), texel(base.x + 1, base.y + 1), f.x);
    return mix(near, far, f.y) * view.height_scale_m;
}

// Lit where nothing of the displaced mesh is nearer to the light.
@fragment
fn shadow_mapped(in: VertexOut) -> @location(0) vec4f {
    let position = in.position_world + normalize(in.normal_world) * height_m(in.uv);
    let clip = view.light_clip_from_world * vec4f(position, 1.0);
    let side = vec2f(textureDimensions(depth_from_light));
    let at = vec2i((clip.xy * vec2f(0.5, -0.5) + 0.5) * side);
    let nearest = textureLoad(depth_from_light, clamp(at, vec2i(0), vec2i(side) - 1), 0).r;
    // Depth grows towards the light.
    return vec4f(select(0.0, 1.0, clip.z + view.bias >= nearest));
}
