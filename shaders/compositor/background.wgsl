// Background pass: the environment where no surface is. The triangle lies at depth 0, infinitely
// far, so that the depth test leaves only uncovered pixels.

struct Background {
    world_from_clip: mat4x4f,
    // Cosine and sine of the environment's turn about +Y.
    rotation: vec2f,
    intensity: f32,
    unused: f32,
}

@group(0) @binding(0) var<uniform> background: Background;
@group(0) @binding(1) var environment: texture_2d<f32>;
// Repeats along u and clamps along v.
@group(0) @binding(2) var environment_sampler: sampler;

@fragment
fn background_fragment(in: SheenFullscreen) -> @location(0) vec4f {
    let d_world = sheen_normalize_or(
        compositor_ray_world(background.world_from_clip, in.uv), vec3f(0.0, 0.0, -1.0));
    // world = rotate_y(angle) * own, so own = rotate_y(-angle) * world.
    let c = background.rotation.x;
    let s = background.rotation.y;
    let d_own = vec3f(c * d_world.x - s * d_world.z, d_world.y, s * d_world.x + c * d_world.z);
    let radiance = textureSampleLevel(environment, environment_sampler, sheen_lat_long_uv(d_own), 0.0).rgb;
    // Alpha is coverage, and nothing covers these pixels.
    return vec4f(min(radiance * background.intensity, vec3f(COMPOSITOR_HALF_MAX)), 0.0);
}
