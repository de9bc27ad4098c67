// What the compositor's passes share: the view, the surface buffer's ranges, and the direct
// light's reflectance.

// The largest finite half float; the surface buffer and the HDR image hold nothing above it.
const COMPOSITOR_HALF_MAX: f32 = 65504.0;

// Bound on one contribution to the HDR image, so that the few which blending adds up stay finite.
const COMPOSITOR_RADIANCE_MAX: f32 = 16376.0;

struct CompositorView {
    clip_from_world: mat4x4f,
    // At clip z = 0 (infinitely far) the first three components are the direction of a pixel.
    world_from_clip: mat4x4f,
    eye_world: vec3f,
    // Distance of the near plane in metres; depth is near_m / distance along the view axis.
    near_m: f32,
}

// Clip x and y, each -1 .. 1, of a position (0, 0) top left .. (1, 1) bottom right.
fn compositor_ndc(uv: vec2f) -> vec2f {
    return vec2f(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0);
}

// From the eye through a pixel; one unit along the view axis, so not of unit length.
fn compositor_ray_world(world_from_clip: mat4x4f, uv: vec2f) -> vec3f {
    return (world_from_clip * vec4f(compositor_ndc(uv), 0.0, 1.0)).xyz;
}

// Between min and max; min where x is not a number.
fn compositor_clamp(x: f32, low: f32, high: f32) -> f32 {
    return select(low, min(x, high), x > low);
}

// GGX lobe with height-correlated Smith shadowing, without Fresnel (Heitz 2014, eq. 99; Walter
// et al. 2007, eq. 33), per unit of projected solid angle.
fn compositor_ggx(alpha: f32, n_l: f32, n_v: f32, n_cross_h: vec3f, n_h: f32) -> f32 {
    // 1 - (n.h)^2 as |n x h|^2 keeps its digits at the peak of a narrow lobe.
    let a = n_h * alpha;
    let k = alpha / max(dot(n_cross_h, n_cross_h) + a * a, 1e-12);
    let distribution = k * k / SHEEN_PI;
    let a2 = alpha * alpha;
    let shadowing_l = n_v * sqrt(n_l * n_l * (1.0 - a2) + a2);
    let shadowing_v = n_l * sqrt(n_v * n_v * (1.0 - a2) + a2);
    return distribution * 0.5 / max(shadowing_l + shadowing_v, 1e-12);
}

// Schlick 1994, eq. 15.
fn compositor_fresnel(ks: vec3f, cos_angle: f32) -> vec3f {
    let x = clamp(1.0 - cos_angle, 0.0, 1.0);
    let x2 = x * x;
    return ks + (vec3f(1.0) - ks) * (x2 * x2 * x);
}
