// Geometry pass: triangles with glTF materials to the surface buffer and, as emitted radiance, to
// the HDR image.

struct Material {
    base_color: vec4f,
    emissive: vec3f,
    // Mask: the smallest opacity that is kept.
    alpha_cutoff: f32,
    // Specular reflectance at normal incidence; used where HAS_KS is set.
    ks: vec3f,
    // Blinn exponent; used where HAS_SHININESS is set.
    shininess: f32,
    metallic: f32,
    roughness: f32,
    normal_scale: f32,
    occlusion_strength: f32,
    flags: u32,
    // Two rows of an affine map for each texture, in the order of the bindings:
    // u' = dot(row.xyz, (u, v, 1)).
    texture_from_vertex_uv: array<vec4f, 10>,
}

const HAS_KS: u32 = 1u;
const HAS_SHININESS: u32 = 2u;
const HAS_NORMAL_TEXTURE: u32 = 4u;

const OPAQUE: u32 = 0u;
const MASK: u32 = 1u;
const BLEND: u32 = 2u;
override alpha_mode: u32 = 0u;

// The smallest cosine between the shading normal and the direction to the eye.
const MIN_N_V: f32 = 0.00390625;

@group(0) @binding(0) var<uniform> view: CompositorView;

@group(1) @binding(0) var<uniform> material: Material;
@group(1) @binding(1) var base_color_texture: texture_2d<f32>;
@group(1) @binding(2) var base_color_sampler: sampler;
@group(1) @binding(3) var metallic_roughness_texture: texture_2d<f32>;
@group(1) @binding(4) var metallic_roughness_sampler: sampler;
@group(1) @binding(5) var normal_texture: texture_2d<f32>;
@group(1) @binding(6) var normal_sampler: sampler;
@group(1) @binding(7) var occlusion_texture: texture_2d<f32>;
@group(1) @binding(8) var occlusion_sampler: sampler;
@group(1) @binding(9) var emissive_texture: texture_2d<f32>;
@group(1) @binding(10) var emissive_sampler: sampler;

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
    // Columns of the normals' matrix; w of the first is -1 where the instance is mirrored, else 1.
    @location(7) world_from_normal_0: vec4f,
    @location(8) world_from_normal_1: vec4f,
    @location(9) world_from_normal_2: vec4f,
}

struct VertexOut {
    @builtin(position) position: vec4f,
    @location(0) position_world: vec3f,
    @location(1) normal_world: vec3f,
    @location(2) tangent_world: vec4f,
    @location(3) uv: vec2f,
}

struct SurfaceOut {
    @location(0) normal_roughness: vec4f,
    @location(1) specular: vec4f,
    @location(2) albedo: vec4f,
    @location(3) emitted: vec4f,
}

@vertex
fn geometry_vertex(in: VertexIn) -> VertexOut {
    let p = vec4f(in.position_local, 1.0);
    let position_world = vec3f(
        dot(in.world_from_local_0, p), dot(in.world_from_local_1, p), dot(in.world_from_local_2, p));
    let t = in.tangent_local.xyz;
    let tangent_world = vec3f(
        dot(in.world_from_local_0.xyz, t), dot(in.world_from_local_1.xyz, t), dot(in.world_from_local_2.xyz, t));
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

fn texture_uv(index: u32, uv: vec2f) -> vec2f {
    let p = vec3f(uv, 1.0);
    return vec2f(
        dot(material.texture_from_vertex_uv[2u * index].xyz, p),
        dot(material.texture_from_vertex_uv[2u * index + 1u].xyz, p));
}

// Whether a fragment of this opacity is absent.
fn is_absent(opacity: f32, pixel: vec2u) -> bool {
    if alpha_mode == MASK {
        return opacity < material.alpha_cutoff;
    }
    if alpha_mode == BLEND {
        return opacity <= ordered_threshold(pixel);
    }
    return false;
}

// Bayer's 8 x 8 thresholds, (0 .. 63 + 0.5) / 64: of each 64 pixels a share equal to the opacity
// stays, without noise from frame to frame.
fn ordered_threshold(pixel: vec2u) -> f32 {
    let a = pixel.x ^ pixel.y;
    let b = pixel.y;
    let rank = ((a & 1u) << 5u) | ((b & 1u) << 4u) | ((a & 2u) << 2u) | ((b & 2u) << 1u)
        | ((a & 4u) >> 1u) | ((b & 4u) >> 2u);
    return (f32(rank) + 0.5) / 64.0;
}

// The unit shading normal before it is turned to the viewer. `sampled` is the normal texture's texel.
fn shading_normal(in: VertexOut, sampled: vec3f) -> vec3f {
    let normal = sheen_normalize_or(in.normal_world, vec3f(0.0, 1.0, 0.0));
    if (material.flags & HAS_NORMAL_TEXTURE) == 0u || in.tangent_world.w == 0.0 {
        return normal;
    }
    // mikktspace: the interpolated vectors are used as they are, neither normalised nor made
    // orthogonal, because the map was baked against them.
    let bitangent = sign(in.tangent_world.w) * cross(in.normal_world, in.tangent_world.xyz);
    let map = (sampled * 2.0 - 1.0) * vec3f(material.normal_scale, material.normal_scale, 1.0);
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

@fragment
fn geometry_fragment(in: VertexOut, @builtin(front_facing) front_facing: bool) -> SurfaceOut {
    let base_color = material.base_color
        * textureSample(base_color_texture, base_color_sampler, texture_uv(0u, in.uv));
    let metallic_roughness =
        textureSample(metallic_roughness_texture, metallic_roughness_sampler, texture_uv(1u, in.uv));
    let normal_texel = textureSample(normal_texture, normal_sampler, texture_uv(2u, in.uv)).xyz;
    let occlusion_texel = textureSample(occlusion_texture, occlusion_sampler, texture_uv(3u, in.uv)).r;
    let emissive = material.emissive
        * textureSample(emissive_texture, emissive_sampler, texture_uv(4u, in.uv)).rgb;
    if is_absent(base_color.a, vec2u(in.position.xy)) {
        discard;
    }

    let metallic = saturate(material.metallic * metallic_roughness.b);
    let roughness = saturate(material.roughness * metallic_roughness.g);
    var ks = mix(vec3f(0.04), base_color.rgb, metallic);
    if (material.flags & HAS_KS) != 0u {
        ks = material.ks;
    }
    // n = 2 / alpha^2 - 2 with alpha = roughness^2; a mirror has the largest n that fits.
    let alpha = roughness * roughness;
    var shininess = 2.0 / max(alpha * alpha, 1e-6) - 2.0;
    if (material.flags & HAS_SHININESS) != 0u {
        shininess = material.shininess;
    }

    // A back face, seen because the material is double-sided, is the same relief from behind.
    let outward = shading_normal(in, normal_texel) * select(-1.0, 1.0, front_facing);
    let to_eye = sheen_normalize_or(view.eye_world - in.position_world, outward);
    let occlusion = 1.0 + material.occlusion_strength * (occlusion_texel - 1.0);

    var out: SurfaceOut;
    out.normal_roughness = vec4f(keep_visible(outward, to_eye), roughness);
    out.specular = vec4f(ks, clamp(shininess, 0.0, COMPOSITOR_HALF_MAX));
    out.albedo = vec4f(base_color.rgb * (1.0 - metallic), occlusion);
    out.emitted = vec4f(min(emissive, vec3f(COMPOSITOR_RADIANCE_MAX)), 1.0);
    return out;
}
