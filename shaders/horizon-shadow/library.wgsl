// The functions of horizon-shadow, for a host's own shader: visibility of a light, from the horizon
// of the chosen method.

// Sine of the horizon towards the light's azimuth. Where it is not between `low` and `high`, sines
// too, any value on the same side of them may be returned instead.
fn horizon_shadow_sine(
    heights: texture_2d<f32>, published: texture_2d_array<f32>, candidates: texture_2d_array<u32>,
    extents: texture_2d_array<f32>, linear: sampler, parameters: HorizonShadowParameters,
    straight: HorizonShadowView, low: f32, high: f32,
) -> f32 {
    if parameters.method <= HORIZON_SHADOW_METHOD_EXACT {
        return horizon_shadow_sine_of(
            horizon_shadow_published(heights, published, linear, parameters, straight));
    }
    let marched = parameters.method == HORIZON_SHADOW_METHOD_MARCHED;
    let certified = parameters.method == HORIZON_SHADOW_METHOD_CERTIFIED;
    if !marched && (parameters.flags & HORIZON_SHADOW_FLAG_EXTENTS) != 0u && low > -1.0 {
        let middle = horizon_shadow_turned(straight, horizon_shadow_middle(parameters));
        let decided = horizon_shadow_tile(extents, parameters, middle, low, high);
        if decided != 0.0 {
            return decided;
        }
    }
    let cell = horizon_shadow_cell(heights, parameters, straight.at, straight.direction);
    let weights = horizon_shadow_weights(cell.fraction);
    let view = horizon_shadow_turned(straight, parameters.least_height + dot(weights, cell.heights));
    let slices = horizon_shadow_slices(parameters, view.direction);
    let corners = cell.heights * view.texels_per_height;
    let height = dot(weights, corners);
    var tangent = horizon_shadow_floor(view.kappa, height);
    var first = 0.0;
    var step = parameters.radius_texels / f32(max(parameters.march_steps, 1u));
    if !marched {
        tangent = max(tangent, horizon_shadow_near(heights, parameters, view, cell, corners, height));
        let near = horizon_shadow_sine_of(tangent);
        if near >= high {
            return near;
        }
        first = HORIZON_SHADOW_NEAR_TEXELS;
        step = 0.0;
        if slices.baked {
            let position = horizon_shadow_node_position(parameters, view.kappa, view.steepening);
            let a = horizon_shadow_far(
                candidates, parameters, view, cell, corners, slices.first, position, certified);
            let b = horizon_shadow_far(
                candidates, parameters, view, cell, corners, slices.second, position, certified);
            let far = dot(weights, mix(a.least, b.least, slices.weight));
            if !certified {
                return max(near, far);
            }
            let least = min(a.least, b.least);
            let greatest = max(a.greatest, b.greatest);
            let surely = min(min(least.x, least.y), min(least.z, least.w)) - HORIZON_SHADOW_MARGIN;
            let at_most = max(max(greatest.x, greatest.y), max(greatest.z, greatest.w)) + HORIZON_SHADOW_MARGIN;
            if surely >= high {
                return surely;
            }
            let covered = view.kappa >= parameters.least_curvature * view.steepening - 1e-6;
            if covered && max(near, at_most) <= low {
                return max(near, far);
            }
        } else if !certified {
            return near;
        }
    }
    let needed = horizon_shadow_tangent_of(low);
    let enough = horizon_shadow_tangent_of(high);
    return horizon_shadow_sine_of(horizon_shadow_march(
        heights, parameters, view, height, first, step, tangent, needed, enough));
}

// What bounds leave for rounding, the tables' codes and thin bumps between their azimuths: sines.
const HORIZON_SHADOW_MARGIN: f32 = 0.02;

fn horizon_shadow_tangent_of(sine: f32) -> f32 {
    return clamp(sine * inverseSqrt(max((1.0 - sine) * (1.0 + sine), 1e-12)), -1e4, 1e4);
}

// The height halfway between the map's least and greatest, in its own units.
fn horizon_shadow_middle(parameters: HorizonShadowParameters) -> f32 {
    return 0.5 * (parameters.least_height + parameters.greatest_height);
}

// A sine that decides whole tiles, by their least and greatest horizon: 2 where the horizon is
// above `high`, -1 where it is below `low`, 0 where the tile does not decide.
fn horizon_shadow_tile(
    extents: texture_2d_array<f32>, parameters: HorizonShadowParameters, view: HorizonShadowView,
    low: f32, high: f32,
) -> f32 {
    let slices = horizon_shadow_slices(parameters, view.direction);
    let steepening = view.steepening;
    let slack = 1e-6 + 1e-3 * abs(view.kappa);
    if !slices.baked || steepening < 1e-3 || view.kappa < parameters.least_curvature * steepening - slack
        || view.kappa > parameters.greatest_curvature * steepening + slack {
        return 0.0;
    }
    let tile = horizon_shadow_wrapped(floor(view.at), parameters) >> vec2u(3u);
    let a = textureLoad(extents, tile, slices.first, 0).xy;
    let b = textureLoad(extents, tile, slices.second, 0).xy;
    let least = min(a.x, b.x) * 2.0 - 1.0 - HORIZON_SHADOW_MARGIN;
    let greatest = max(a.y, b.y) * 2.0 - 1.0 + HORIZON_SHADOW_MARGIN;
    // Tangents grow in proportion to the heights, so the light's are brought to the bake's.
    let rims = vec2f(low, high);
    let across = max((1.0 - rims) * (1.0 + rims), vec2f(0.0)) * (steepening * steepening);
    let sines = rims * inverseSqrt(max(rims * rims + across, vec2f(1e-30)));
    if least > sines.y {
        return 2.0;
    }
    return select(0.0, -1.0, greatest < sines.x);
}

// Fraction of a disc of the angular radius `radius_rad` around the light that stands above a
// straight horizon.
fn horizon_shadow_fraction(horizon_sine: f32, sine: f32, cosine: f32, radius_rad: f32) -> f32 {
    let horizon = clamp(horizon_sine, -1.0, 1.0);
    let horizon_cosine = sqrt((1.0 - horizon) * (1.0 + horizon));
    // More than a quarter turn away, where the sine of the difference falls again.
    if cosine * horizon_cosine + sine * horizon <= 0.0 {
        return select(0.0, 1.0, sine > horizon);
    }
    let above = sine * horizon_cosine - cosine * horizon;
    let radius = horizon_shadow_sine_small(radius_rad);
    if above <= -radius {
        return 0.0;
    }
    if above >= radius {
        return 1.0;
    }
    return horizon_shadow_disc(above / radius);
}

// Part of a disc that lies above a straight line, x radii below its centre, x in -1..1:
// 1/2 + (asin x + x sqrt(1 - x^2)) / pi, by a polynomial within 4e-6.
fn horizon_shadow_disc(x: f32) -> f32 {
    let away = abs(x);
    let rest = max(1.0 - away, 0.0);
    let series = 0.5 + away * (0.11329005 + away * (-0.0165505 + away * 0.003604104));
    let below = rest * sqrt(rest) * series;
    return select(below, 1.0 - below, x > 0.0);
}

// sin of an angle between 0 and pi / 2.
fn horizon_shadow_sine_small(angle_rad: f32) -> f32 {
    let t = 0.5 * angle_rad * horizon_shadow_half_tangent(vec4f(angle_rad * angle_rad)).x;
    return 2.0 * t / (1.0 + t * t);
}

// Share of a normal distribution below x standard deviations, within 2e-4.
fn horizon_shadow_normal_share(x: f32) -> f32 {
    let t = clamp(x, -6.0, 6.0);
    return 1.0 / (1.0 + exp(-t * (1.5976 + 0.07056 * t * t)));
}

// Visibility where bumps are smaller than pixels: the share of horizons, normally distributed with
// the stored mean and mean square of their sines, that lie below the light.
fn horizon_shadow_prefiltered(
    moments: texture_2d_array<f32>, linear: sampler, parameters: HorizonShadowParameters,
    view: HorizonShadowView, footprint: f32, radius_rad: f32,
) -> f32 {
    let turned = horizon_shadow_turned(view, horizon_shadow_middle(parameters));
    let slices = horizon_shadow_slices(parameters, turned.direction);
    if !slices.baked {
        return select(0.0, 1.0, view.sine > 0.0);
    }
    let level = log2(max(footprint * 0.25, 1.0));
    let a = textureSampleLevel(moments, linear, view.uv, slices.first, level);
    let b = textureSampleLevel(moments, linear, view.uv, slices.second, level);
    let stored = mix(a, b, slices.weight);
    let span = (parameters.greatest_curvature - parameters.least_curvature) * view.steepening;
    let from_least = view.kappa - parameters.least_curvature * view.steepening;
    let place = select(0.0, clamp(from_least / span, 0.0, 1.0), span > 1e-12);
    let moment = mix(stored.xy, stored.zw, place);
    // A disc's standard deviation along a line is half its radius.
    let variance = max(moment.y - moment.x * moment.x, 0.0) + 0.25 * radius_rad * radius_rad;
    return horizon_shadow_normal_share((view.sine - moment.x) * inverseSqrt(variance + 1e-6));
}

// Whether nothing of a convex surface can be lit there, however high its bumps: eq. 3 at the map's
// greatest height.
fn horizon_shadow_is_night(
    parameters: HorizonShadowParameters, view: HorizonShadowView, high: f32,
) -> bool {
    let greatest = (parameters.greatest_height - parameters.least_height) * view.texels_per_height;
    let x = max(view.kappa * greatest, 0.0);
    return view.kappa >= 0.0 && horizon_shadow_tangent_of(high) < -sqrt(x * (2.0 + x));
}

// Visibility of a light in the direction `light_world` (unit, towards it), seen under the angular
// radius `light_radius_rad`, 0 for a point: 0 in shadow, 1 lit.
fn horizon_shadow_visibility(
    heights: texture_2d<f32>, published: texture_2d_array<f32>, candidates: texture_2d_array<u32>,
    extents: texture_2d_array<f32>, moments: texture_2d_array<f32>, linear: sampler,
    parameters: HorizonShadowParameters, surface: HorizonShadowSurface, light_world: vec3f,
    light_radius_rad: f32,
) -> f32 {
    if parameters.method == HORIZON_SHADOW_METHOD_NONE {
        return 1.0;
    }
    let radius = clamp(horizon_shadow_bounded(light_radius_rad, 1.5), 0.0, 1.5);
    let view = horizon_shadow_view(parameters, surface, light_world);
    if !view.known {
        return horizon_shadow_fraction(0.0, view.sine, view.cosine, radius);
    }
    let radius_sine = horizon_shadow_sine_small(radius);
    let radius_cosine = sqrt((1.0 - radius_sine) * (1.0 + radius_sine));
    // Sines of the light's lower and upper rim; beyond the nadir and the zenith they stay there.
    let passes_nadir = view.cosine * radius_cosine + view.sine * radius_sine < 0.0;
    let passes_zenith = view.cosine * radius_cosine - view.sine * radius_sine < 0.0;
    let low = select(view.sine * radius_cosine - view.cosine * radius_sine, -1.0, passes_nadir);
    let high = select(view.sine * radius_cosine + view.cosine * radius_sine, 1.0, passes_zenith);
    let curved = parameters.method != HORIZON_SHADOW_METHOD_FLAT;
    if curved && horizon_shadow_is_night(parameters, view, high) {
        return 0.0;
    }
    var blur = 0.0;
    var blurred = 0.0;
    if (parameters.flags & HORIZON_SHADOW_FLAG_PREFILTER) != 0u && (
        parameters.method == HORIZON_SHADOW_METHOD_SHEEN
        || parameters.method == HORIZON_SHADOW_METHOD_CERTIFIED) {
        let footprint = horizon_shadow_footprint(parameters, surface);
        blur = smoothstep(2.0, 4.0, footprint);
        if blur > 0.0 {
            blurred = horizon_shadow_prefiltered(moments, linear, parameters, view, footprint, radius);
        }
        if blur >= 1.0 {
            return blurred;
        }
    }
    let horizon = horizon_shadow_sine(
        heights, published, candidates, extents, linear, parameters, view, low, high);
    return mix(horizon_shadow_fraction(horizon, view.sine, view.cosine, radius), blurred, blur);
}

// Sine of the horizon towards the azimuth of `light_world`, by the same functions as the
// visibility's.
fn horizon_shadow_horizon(
    heights: texture_2d<f32>, published: texture_2d_array<f32>, candidates: texture_2d_array<u32>,
    extents: texture_2d_array<f32>, moments: texture_2d_array<f32>, linear: sampler,
    parameters: HorizonShadowParameters, surface: HorizonShadowSurface, light_world: vec3f,
) -> f32 {
    let view = horizon_shadow_view(parameters, surface, light_world);
    if !view.known {
        return 0.0;
    }
    if parameters.method == HORIZON_SHADOW_METHOD_NONE {
        return -1.0;
    }
    return horizon_shadow_sine(
        heights, published, candidates, extents, linear, parameters, view, -1.0, 1.0);
}
