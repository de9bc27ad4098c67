// Coat surface pass: the clear coats of visible surfaces, drawn again where the depth is their own.

struct Coat {
    // Strength of the layer, 0 .. 1.
    strength: f32,
    roughness: f32,
    has_normal_texture: u32,
    unused: u32,
    // Two rows of an affine map for each texture, in the order of the bindings.
    texture_from_vertex_uv: array<vec4f, 6>,
}

@group(1) @binding(0) var<uniform> coat: Coat;
@group(1) @binding(1) var strength_texture: texture_2d<f32>;
@group(1) @binding(2) var strength_sampler: sampler;
@group(1) @binding(3) var roughness_texture: texture_2d<f32>;
@group(1) @binding(4) var roughness_sampler: sampler;
@group(1) @binding(5) var normal_texture: texture_2d<f32>;
@group(1) @binding(6) var normal_sampler: sampler;

struct CoatOut {
    @location(0) normal_roughness: vec4f,
    @location(1) strength: f32,
}

fn coat_uv(index: u32, uv: vec2f) -> vec2f {
    let rows = 2u * index;
    return affine_uv(coat.texture_from_vertex_uv[rows], coat.texture_from_vertex_uv[rows + 1u], uv);
}

@fragment
fn coat_surface_fragment(in: VertexOut, @builtin(front_facing) front_facing: bool) -> CoatOut {
    let strength = textureSample(strength_texture, strength_sampler, coat_uv(0u, in.uv)).r;
    let roughness = textureSample(roughness_texture, roughness_sampler, coat_uv(1u, in.uv)).g;
    let normal_texel = textureSample(normal_texture, normal_sampler, coat_uv(2u, in.uv)).xyz;
    // The coat has a relief of its own; the base's does not show in it.
    var normal = sheen_normalize_or(in.normal_world, vec3f(0.0, 1.0, 0.0));
    if coat.has_normal_texture != 0u {
        normal = relief_normal(in, normal_texel, 1.0);
    }
    let outward = normal * select(-1.0, 1.0, front_facing);
    let to_eye = sheen_normalize_or(view.eye_world - in.position_world, outward);
    return CoatOut(
        vec4f(keep_visible(outward, to_eye), saturate(coat.roughness * roughness)),
        saturate(coat.strength * strength));
}
