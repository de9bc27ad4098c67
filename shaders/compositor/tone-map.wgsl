// Tone mapping: exposure, then a curve from scene-referred to display-referred colour, then the
// sRGB transfer curve where the target does not apply it by itself.

struct ToneMap {
    // 2^EV.
    exposure: f32,
    unused_0: f32,
    unused_1: f32,
    unused_2: f32,
}

const LINEAR: u32 = 0u;
const PBR_NEUTRAL: u32 = 1u;
const ACES_FITTED: u32 = 2u;

override curve: u32 = 1u;
override encode_srgb: bool = false;

@group(0) @binding(0) var<uniform> tone_map: ToneMap;
@group(0) @binding(1) var hdr_texture: texture_2d<f32>;

// Khronos PBR Neutral Tone Mapper (KhronosGroup/ToneMapping, PBR_Neutral): base colours lit by a
// grey environment of radiance 1 come out as they are; only what is brighter is compressed.
fn pbr_neutral(color_in: vec3f) -> vec3f {
    let start = 0.8 - 0.04;
    let desaturation = 0.15;
    let low = min(color_in.r, min(color_in.g, color_in.b));
    let offset = select(0.04, low - 6.25 * low * low, low < 0.08);
    let color = color_in - offset;
    let peak = max(color.r, max(color.g, color.b));
    if peak < start {
        return color;
    }
    let d = 1.0 - start;
    let new_peak = 1.0 - d * d / (peak + d - start);
    let g = 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0);
    return mix(color * (new_peak / peak), vec3f(new_peak), g);
}

// Stephen Hill's fit of the ACES reference rendering and sRGB output transforms (BakingLab, ACES.hlsl).
fn aces_fitted(color: vec3f) -> vec3f {
    // Columns of the matrices.
    let input = mat3x3f(
        vec3f(0.59719, 0.07600, 0.02840), vec3f(0.35458, 0.90834, 0.13383), vec3f(0.04823, 0.01566, 0.83777));
    let output = mat3x3f(
        vec3f(1.60475, -0.10208, -0.00327), vec3f(-0.53108, 1.10813, -0.07276), vec3f(-0.07367, -0.00605, 1.07602));
    let v = input * color;
    let fitted = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    return output * fitted;
}

// IEC 61966-2-1.
fn srgb_encoded(c: vec3f) -> vec3f {
    return select(1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3f(0.0031308));
}

@fragment
fn tone_map_fragment(in: SheenFullscreen) -> @location(0) vec4f {
    // The bounds also take care of infinities and of NaN, which max() drops.
    let hdr = textureLoad(hdr_texture, vec2i(in.position.xy), 0).rgb;
    let exposed = clamp(hdr * tone_map.exposure, vec3f(0.0), vec3f(COMPOSITOR_HALF_MAX));
    var color = exposed;
    if curve == PBR_NEUTRAL {
        color = pbr_neutral(exposed);
    } else if curve == ACES_FITTED {
        color = aces_fitted(exposed);
    }
    color = saturate(color);
    if encode_srgb {
        color = srgb_encoded(color);
    }
    return vec4f(color, 1.0);
}
