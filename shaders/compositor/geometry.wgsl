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

struct SurfaceOut {
    @location(0) normal_roughness: vec4f,
    @location(1) specular: vec4f,
    @location(2) albedo: vec4f,
    @location(3) emitted: vec4f,
}

fn texture_uv(index: u32, uv: vec2f) -> vec2f {
    let rows = 2u * index;
    return affine_uv(material.texture_from_vertex_uv[rows], material.texture_from_vertex_uv[rows + 1u], uv);
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

// What of a surface does not depend on its normal, and the normal texture.
struct Shaded {
    surface: SurfaceOut,
    opacity: f32,
    normal_texel: vec3f,
}

fn shaded(in: VertexOut) -> Shaded {
    let base_color = material.base_color
        * textureSample(base_color_texture, base_color_sampler, texture_uv(0u, in.uv));
    let metallic_roughness =
        textureSample(metallic_roughness_texture, metallic_roughness_sampler, texture_uv(1u, in.uv));
    let normal_texel = textureSample(normal_texture, normal_sampler, texture_uv(2u, in.uv)).xyz;
    let occlusion_texel = textureSample(occlusion_texture, occlusion_sampler, texture_uv(3u, in.uv)).r;
    let emissive = material.emissive
        * textureSample(emissive_texture, emissive_sampler, texture_uv(4u, in.uv)).rgb;

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
    let occlusion = 1.0 + material.occlusion_strength * (occlusion_texel - 1.0);

    var out: Shaded;
    out.surface.normal_roughness = vec4f(0.0, 0.0, 0.0, roughness);
    out.surface.specular = vec4f(ks, clamp(shininess, 0.0, COMPOSITOR_HALF_MAX));
    out.surface.albedo = vec4f(base_color.rgb * (1.0 - metallic), occlusion);
    out.surface.emitted = vec4f(min(emissive, vec3f(COMPOSITOR_RADIANCE_MAX)), 1.0);
    out.opacity = base_color.a;
    out.normal_texel = normal_texel;
    return out;
}

// The surface with its normal. `normal` is that of the surface without its normal texture.
fn finished(in: VertexOut, front_facing: bool, shaded: Shaded, normal: vec3f) -> SurfaceOut {
    if is_absent(shaded.opacity, vec2u(in.position.xy)) {
        discard;
    }
    var relief = normal;
    if (material.flags & HAS_NORMAL_TEXTURE) != 0u {
        relief = relief_normal(in, shaded.normal_texel, material.normal_scale);
    }
    // A back face, seen because the material is double-sided, is the same relief from behind.
    let outward = relief * select(-1.0, 1.0, front_facing);
    let to_eye = sheen_normalize_or(view.eye_world - in.position_world, outward);
    var out = shaded.surface;
    out.normal_roughness = vec4f(keep_visible(outward, to_eye), out.normal_roughness.w);
    return out;
}

@fragment
fn geometry_fragment(in: VertexOut, @builtin(front_facing) front_facing: bool) -> SurfaceOut {
    let normal = sheen_normalize_or(in.normal_world, vec3f(0.0, 1.0, 0.0));
    return finished(in, front_facing, shaded(in), normal);
}
