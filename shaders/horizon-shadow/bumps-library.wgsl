// Bump normals, heights and ambient visibility of a relief.

// Unit vectors across which heights change, per metre: the dual basis of the map's uv.
struct HorizonShadowDual {
    u: vec3f,
    v: vec3f,
    known: bool,
}

fn horizon_shadow_dual(
    parameters: HorizonShadowParameters, surface: HorizonShadowSurface, normal: vec3f,
) -> HorizonShadowDual {
    let speed = vec2f(length(surface.along_u_world), length(surface.along_v_world));
    let u = surface.along_u_world / speed.x;
    let v = surface.along_v_world / speed.y;
    let sheared = dot(normal, cross(u, v));
    var dual: HorizonShadowDual;
    dual.u = cross(v, normal) * (parameters.uv_scale.x / (speed.x * sheared));
    dual.v = cross(normal, u) * (parameters.uv_scale.y / (speed.y * sheared));
    dual.known = sheared * sheared > 1e-12 && horizon_shadow_is_finite(dot(dual.u, dual.u) + dot(dual.v, dual.v));
    return dual;
}

// Unit normal of the relief, without the base's curvature: N - h_u U - h_v V with the dual basis of
// the map's uv (Blinn), heights differenced over a texel or over a pixel, whichever is longer.
fn horizon_shadow_normal(
    heights: texture_2d<f32>, parameters: HorizonShadowParameters, surface: HorizonShadowSurface,
) -> vec3f {
    let normal = sheen_normalize_or(surface.normal_world, vec3f(0.0, 0.0, 1.0));
    let dual = horizon_shadow_dual(parameters, surface, normal);
    if !dual.known {
        return normal;
    }
    let at = horizon_shadow_map_uv(parameters, surface.uv) * parameters.size - 0.5;
    let reach = 0.5 * clamp(horizon_shadow_footprint(parameters, surface), 1.0, 64.0);
    let u = vec2f(reach, 0.0);
    let v = vec2f(0.0, reach);
    let rise = vec2f(
        horizon_shadow_bilinear(heights, parameters, at + u) - horizon_shadow_bilinear(heights, parameters, at - u),
        horizon_shadow_bilinear(heights, parameters, at + v) - horizon_shadow_bilinear(heights, parameters, at - v));
    let slope = rise * parameters.size * (parameters.height_scale_m / (2.0 * reach));
    return sheen_normalize_or(normal - slope.x * dual.u - slope.y * dual.v, normal);
}

// Height of the relief above the base surface, metres, of the mesh's uv.
fn horizon_shadow_height_m(
    heights: texture_2d<f32>, parameters: HorizonShadowParameters, uv: vec2f,
) -> f32 {
    let at = horizon_shadow_map_uv(parameters, uv) * parameters.size - 0.5;
    let above_least = horizon_shadow_bilinear(heights, parameters, at);
    return (above_least + parameters.least_height) * parameters.height_scale_m;
}

// Bent normal (unit, world) and cosine-weighted visible fraction of the hemisphere; the base's
// normal and 1 where none are baked.
fn horizon_shadow_ambient(
    ambient: texture_2d_array<f32>, linear: sampler, parameters: HorizonShadowParameters,
    surface: HorizonShadowSurface,
) -> vec4f {
    let normal = sheen_normalize_or(surface.normal_world, vec3f(0.0, 0.0, 1.0));
    let dual = horizon_shadow_dual(parameters, surface, normal);
    if !dual.known || (parameters.flags & HORIZON_SHADOW_FLAG_AMBIENT) == 0u {
        return vec4f(normal, 1.0);
    }
    let uv = horizon_shadow_map_uv(parameters, surface.uv);
    let level = log2(max(horizon_shadow_footprint(parameters, surface), 1.0));
    let least = textureSampleLevel(ambient, linear, uv, 0u, level).xyz;
    let greatest = textureSampleLevel(ambient, linear, uv, 1u, level).xyz;
    let stored = mix(least, greatest, horizon_shadow_mean_curvature_place(parameters, surface, normal));
    let bend = stored.xy * 2.0 - 1.0;
    // Unit vectors along u, and along v as far as it is across u: the dual basis's are across the
    // other axis each.
    let v = sheen_normalize_or(dual.v, vec3f(0.0));
    let u = sheen_normalize_or(surface.along_u_world * sign(parameters.uv_scale.x), vec3f(0.0));
    let across_u = sheen_normalize_or(u - dot(u, normal) * normal, vec3f(0.0));
    let up = sqrt(max(1.0 - dot(bend, bend), 0.0));
    let bent = bend.x * across_u + bend.y * v + up * normal;
    return vec4f(sheen_normalize_or(bent, normal), clamp(stored.z, 0.0, 1.0));
}

// Place of the surface's mean curvature in the range of the tables, 0..1.
fn horizon_shadow_mean_curvature_place(
    parameters: HorizonShadowParameters, surface: HorizonShadowSurface, normal: vec3f,
) -> f32 {
    let u = surface.along_u_world;
    let v = surface.along_v_world;
    let e = dot(u, u);
    let f = dot(u, v);
    let g = dot(v, v);
    let form = surface.second_form;
    let mean = 0.5 * (form.x * g - 2.0 * form.y * f + form.z * e) / (e * g - f * f);
    let kappa = horizon_shadow_bounded(mean * parameters.height_scale_m / parameters.texels_per_height, 1e3);
    let span = parameters.greatest_curvature - parameters.least_curvature;
    return select(0.0, clamp((kappa - parameters.least_curvature) / span, 0.0, 1.0), span > 1e-9);
}
