// The horizon of the published tables: methods Flat, Paper and Exact.

// tan of an angle between -pi / 2 and pi / 2, bounded.
fn horizon_shadow_tangent(angle_rad: f32) -> f32 {
    let x = vec4f(min(angle_rad * angle_rad, HORIZON_SHADOW_QUARTER_TURN_SQUARED));
    let t = 0.5 * angle_rad * horizon_shadow_half_tangent(x).x;
    return 2.0 * t / max(1.0 - t * t, 1e-4);
}

// Tangent of the horizon of the published tables: methods Flat, Paper and Exact.
fn horizon_shadow_published(
    heights: texture_2d<f32>, published: texture_2d_array<f32>, linear: sampler,
    parameters: HorizonShadowParameters, view: HorizonShadowView,
) -> f32 {
    let slices = horizon_shadow_slices(parameters, view.direction);
    // Of an azimuth that is not baked nothing is known but the tangent plane.
    if !slices.baked {
        return 0.0;
    }
    let first = textureSampleLevel(published, linear, view.uv, slices.first, 0.0).xy;
    let second = textureSampleLevel(published, linear, view.uv, slices.second, 0.0).xy;
    let stored = mix(first, second, slices.weight);
    var distance = parameters.radius_texels * stored.y;
    let only_angle = parameters.method == HORIZON_SHADOW_METHOD_FLAT;
    let only_distance = parameters.contents == HORIZON_SHADOW_CONTENTS_DISTANCE_AND_HEIGHT;
    var height = 0.0;
    if !only_angle || only_distance {
        height = horizon_shadow_bilinear(heights, parameters, view.at) * view.texels_per_height;
    }
    var slope: f32;
    if only_distance {
        // Eq. 4, with the height of the point itself.
        distance = max(parameters.radius_texels * stored.x, 0.25);
        let there = horizon_shadow_bilinear(heights, parameters, view.at + distance * view.direction);
        slope = (there * view.texels_per_height - height) / distance;
    } else {
        slope = horizon_shadow_tangent((stored.x - 0.5) * SHEEN_PI) * view.steepening;
    }
    if only_angle {
        return slope;
    }
    if parameters.method == HORIZON_SHADOW_METHOD_EXACT {
        let exact = horizon_shadow_exact_slopes(view.kappa, vec4f(distance), vec4f(slope), vec4f(height)).x;
        return max(exact, horizon_shadow_floor(view.kappa, height));
    }
    // Eqs. 2 and 3, on convex surfaces only.
    if view.kappa < 0.0 {
        return slope;
    }
    let bent = slope * (1.0 - view.kappa * height) - 0.5 * view.kappa * distance;
    return max(bent, horizon_shadow_floor(view.kappa, height));
}
