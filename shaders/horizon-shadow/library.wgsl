// The functions of horizon-shadow, for a host's own shader.

// A point of the surface that the height map lies on.
struct HorizonShadowSurface {
    // Texture coordinates of the mesh, and how they change from pixel to pixel.
    uv: vec2f,
    uv_dx: vec2f,
    uv_dy: vec2f,
    // Unit normal of the base surface.
    normal_world: vec3f,
    // Change of the base position along u and v of the mesh, metres per unit.
    along_u_world: vec3f,
    along_v_world: vec3f,
    // Second fundamental form in those: II(u,u), II(u,v), II(v,v), metres, convex positive.
    second_form: vec3f,
}

// What the light's azimuth makes of a surface point: everything that is looked up depends on these.
struct HorizonShadowView {
    // The point in texels of the map, texel centres at whole numbers, reduced.
    at: vec2f,
    // Map uv, for samplers.
    uv: vec2f,
    // Unit direction towards the light in texels.
    direction: vec2f,
    // How that changes with a texel of height above the base, because normals ahead lean sideways.
    turn: vec2f,
    // Of the light above the base surface.
    sine: f32,
    cosine: f32,
    // Normal curvature along the azimuth, 1 / texel.
    kappa: f32,
    // Texels between the map's 0 and 1 along the azimuth, and the same against the bake's.
    texels_per_height: f32,
    steepening: f32,
    // Whether the surface has a metric there.
    known: bool,
}

fn horizon_shadow_is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// x where it is finite, and within +-bound.
fn horizon_shadow_bounded(x: f32, bound: f32) -> f32 {
    return clamp(select(0.0, x, horizon_shadow_is_finite(x)), -bound, bound);
}

// The map's own uv of a surface point: 0..1, turned where the map repeats.
fn horizon_shadow_map_uv(parameters: HorizonShadowParameters, uv: vec2f) -> vec2f {
    let scaled = uv * parameters.uv_scale;
    let finite = vec2f(horizon_shadow_bounded(scaled.x, 1e6), horizon_shadow_bounded(scaled.y, 1e6));
    let repeats = vec2<bool>((parameters.wrap & 1u) != 0u, (parameters.wrap & 2u) != 0u);
    return select(clamp(finite, vec2f(0.0), vec2f(1.0)), fract(finite), repeats);
}

// Light in the surface's frame. Its azimuth in texels comes from its contravariant components
// u = L.(Pv x N) / J, v = L.(N x Pu) / J, J = N.(Pu x Pv), whatever the parametrisation.
fn horizon_shadow_view(
    parameters: HorizonShadowParameters, surface: HorizonShadowSurface, light_world: vec3f,
) -> HorizonShadowView {
    var view: HorizonShadowView;
    view.uv = horizon_shadow_map_uv(parameters, surface.uv);
    view.at = view.uv * parameters.size - 0.5;
    let normal = sheen_normalize_or(surface.normal_world, vec3f(0.0));
    let sine = dot(light_world, normal);
    let tangential = light_world - sine * normal;
    let squared = dot(tangential, tangential);
    view.sine = horizon_shadow_bounded(sine, 1.0);
    view.cosine = abs(horizon_shadow_bounded(sqrt(squared), 1.0));

    let u = surface.along_u_world;
    let v = surface.along_v_world;
    let area = dot(normal, cross(u, v));
    // At the zenith every azimuth will do.
    let off_zenith = squared > 1e-12;
    let along_u = u - dot(u, normal) * normal;
    let towards = select(along_u, tangential, off_zenith);
    let along_squared = select(dot(along_u, along_u), squared, off_zenith);
    // Mesh uv, and texels, while going along `towards`.
    let rate = vec2f(dot(towards, cross(v, normal)), dot(towards, cross(normal, u))) / area;
    let texel_rate = rate * parameters.uv_scale * parameters.size;
    let rate_squared = dot(texel_rate, texel_rate);
    let per_rate = inverseSqrt(rate_squared);
    let per_along = inverseSqrt(along_squared);
    let form = surface.second_form;
    let bending = form.x * rate.x * rate.x + 2.0 * form.y * rate.x * rate.y + form.z * rate.y * rate.y;
    // Texels a metre are rate_squared * per_rate * per_along.
    view.direction = texel_rate * per_rate;
    // The same of the tangent vector to the left of `towards`, as long as that, and the geodesic torsion.
    let left = vec2f(-dot(towards, v), dot(towards, u)) / area;
    let torsion = (form.x * rate.x * left.x + form.y * (rate.x * left.y + rate.y * left.x)
        + form.z * rate.y * left.y) * per_along * per_rate;
    let turn = (-torsion * per_rate) * left * parameters.uv_scale * parameters.size;
    view.turn = vec2f(horizon_shadow_bounded(turn.x, 1e6), horizon_shadow_bounded(turn.y, 1e6));
    view.kappa = horizon_shadow_bounded(bending * per_along * per_rate, 1e3);
    view.texels_per_height = horizon_shadow_bounded(
        parameters.height_scale_m * (rate_squared * per_rate) * per_along, 1e6);
    view.steepening = horizon_shadow_bounded(view.texels_per_height / parameters.texels_per_height, 1e6);
    view.known = area * area > 1e-12 * dot(u, u) * dot(v, v)
        && horizon_shadow_is_finite(view.direction.x + view.direction.y) && rate_squared > 0.0;
    return view;
}

// The same towards points that lie so many units of the map above its base. With t the unit vector
// towards the light, w = n x t and the geodesic torsion tau = II(t, w), the normal at x t + y w leans
// by tau x towards w, so that what stands `height` high there is in the light's plane where
// y = -tau height x. Distances still are those along t.
fn horizon_shadow_turned(view: HorizonShadowView, height: f32) -> HorizonShadowView {
    let lean = view.turn * horizon_shadow_bounded(view.texels_per_height * height, 1e6);
    // Shorter than the direction, so that some direction is left, however thick the relief.
    let way = view.direction + lean * min(1.0, 0.75 * inverseSqrt(max(dot(lean, lean), 1e-12)));
    let squared = dot(way, way);
    let per_way = inverseSqrt(squared);
    var turned = view;
    turned.direction = way * per_way;
    turned.kappa = view.kappa * per_way;
    turned.texels_per_height = view.texels_per_height * (squared * per_way);
    turned.steepening = view.steepening * (squared * per_way);
    return turned;
}

fn horizon_shadow_sine_of(tangent: f32) -> f32 {
    return tangent * inverseSqrt(1.0 + tangent * tangent);
}

fn horizon_shadow_sines_of(tangent: vec4f) -> vec4f {
    return tangent * inverseSqrt(1.0 + tangent * tangent);
}

// The two stored azimuths around a direction, and the weight of the second.
struct HorizonShadowSlices {
    first: u32,
    second: u32,
    weight: f32,
    // Whether either is baked; one that is not has no weight.
    baked: bool,
}

fn horizon_shadow_is_baked(parameters: HorizonShadowParameters, azimuth: u32) -> bool {
    let word = select(parameters.baked_azimuths.x, parameters.baked_azimuths.y, azimuth >= 32u);
    return ((word >> (azimuth & 31u)) & 1u) != 0u;
}

fn horizon_shadow_slices(parameters: HorizonShadowParameters, direction: vec2f) -> HorizonShadowSlices {
    let count = f32(parameters.azimuths);
    let turns = atan2(direction.y, direction.x) / (2.0 * SHEEN_PI);
    let position = (turns - floor(turns)) * count;
    let whole = floor(position);
    var slices: HorizonShadowSlices;
    slices.first = u32(select(whole, 0.0, whole >= count));
    slices.second = select(slices.first + 1u, 0u, slices.first + 1u >= parameters.azimuths);
    let first = horizon_shadow_is_baked(parameters, slices.first);
    let second = horizon_shadow_is_baked(parameters, slices.second);
    slices.weight = select(select(0.0, 1.0, second), select(0.0, position - whole, second), first);
    slices.baked = first || second;
    return slices;
}

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

// Tangent of the horizon that the nearest texels make: the point's own cell and the two after it,
// where the relief is a parabola piece by piece; exact on a flat base. Slopes are continued from piece to piece, never
// taken as small differences of heights over small distances.
// `corners` are the cell's heights in texels, `height` the point's own.
fn horizon_shadow_near(
    heights: texture_2d<f32>, parameters: HorizonShadowParameters, view: HorizonShadowView,
    cell: HorizonShadowCell, corners: vec4f, height: f32,
) -> f32 {
    // Mirrored and exchanged axes, so that the ray leaves the own cell at x = 1.
    let forward = view.direction >= vec2f(0.0);
    var at = select(1.0 - cell.fraction, cell.fraction, forward);
    var speed = max(abs(view.direction), vec2f(1e-6));
    var own = select(corners.yxwz, corners, vec4<bool>(forward.x));
    own = select(own.zwxy, own, vec4<bool>(forward.y));
    let leaves_u = (1.0 - at.x) * speed.y < (1.0 - at.y) * speed.x;
    at = select(at.yx, at, leaves_u);
    speed = select(speed.yx, speed, leaves_u);
    own = select(own.xzyw, own, leaves_u);
    let rate = 1.0 / speed;

    let twist = own.x - own.y - own.z + own.w;
    let tangent = speed.x * (own.y - own.x + twist * at.y) + speed.y * (own.z - own.x + twist * at.x);
    let first = (1.0 - at.x) * rate.x;
    let first_slope = tangent + speed.x * speed.y * twist * first;
    let first_slopes = vec4f(tangent, first_slope, first_slope, first_slope);
    var best = horizon_shadow_exact_slopes(
        view.kappa, vec4f(0.0, first, first, first), first_slopes, vec4f(height));
    if first < HORIZON_SHADOW_NEAR_TEXELS {
        // The texels two steps away: columns or rows beyond the own cell.
        let step = select(vec2f(-1.0), vec2f(1.0), forward);
        let base = cell.origin + select(vec2f(1.0), vec2f(0.0), forward);
        let along = select(vec2f(0.0, step.y), vec2f(step.x, 0.0), leaves_u);
        let across = select(vec2f(step.x, 0.0), vec2f(0.0, step.y), leaves_u);
        let next = base + 2.0 * along;
        let scale = view.texels_per_height;
        let ahead = horizon_shadow_pair(heights, parameters, next, next + across) * scale;

        let y = at.y + speed.y * first;
        let next_twist = own.y - ahead.x - own.w + ahead.y;
        let next_tangent = speed.x * (ahead.x - own.y + next_twist * y) + speed.y * (own.w - own.y);
        let next_bend = speed.x * speed.y * next_twist;
        let second = min((1.0 - at.y) * rate.y, first + rate.x);
        let peak = horizon_shadow_steepest(first, second, first_slope, next_tangent, next_bend);
        let ends = vec2f(peak, second);
        let run = ends - first;
        let slopes = mix(vec2f(first_slope), next_tangent + next_bend * run, run / max(ends, vec2f(1e-12)));
        var distances = ends.xyxy;
        var all_slopes = slopes.xyxy;
        if second < HORIZON_SHADOW_NEAR_TEXELS {
            let side = base + 2.0 * across + along;
            let beyond = horizon_shadow_pair(heights, parameters, side, side + along) * scale;
            let x = at.x + speed.x * second - 1.0;
            let last_twist = own.w - ahead.y - beyond.x + beyond.y;
            let last_tangent = speed.x * (ahead.y - own.w) + speed.y * (beyond.x - own.w + last_twist * x);
            let last_bend = speed.x * speed.y * last_twist;
            let third = min((2.0 - at.x) * rate.x, (2.0 - at.y) * rate.y);
            let last_peak = horizon_shadow_steepest(second, third, slopes.y, last_tangent, last_bend);
            let last_ends = vec2f(last_peak, third);
            let last_run = last_ends - second;
            let last_slopes = mix(
                vec2f(slopes.y), last_tangent + last_bend * last_run, last_run / max(last_ends, vec2f(1e-12)));
            distances = vec4f(ends, last_ends);
            all_slopes = vec4f(slopes, last_slopes);
        }
        best = max(best, horizon_shadow_exact_slopes(view.kappa, distances, all_slopes, vec4f(height)));
    }
    return max(max(best.x, best.y), max(best.z, best.w));
}

// Where between two crossings the line of sight over a flat base is steepest; `end` where that is not
// between them. It has the slope `slope` at `begin`, and from there the relief rises by
// tangent * t + bend * t^2. In d it is c0 / d + c1 + c2 d, greatest at sqrt(c0 / c2).
fn horizon_shadow_steepest(begin: f32, end: f32, slope: f32, tangent: f32, bend: f32) -> f32 {
    let c0 = begin * (slope - tangent + bend * begin);
    let peak = clamp(sqrt(max(c0 / min(bend, -1e-20), 0.0)), begin, end);
    return select(end, peak, c0 < 0.0 && bend < 0.0);
}

// Heights of two texels near the map, above its least height, in its own units.
fn horizon_shadow_pair(
    heights: texture_2d<f32>, parameters: HorizonShadowParameters, a: vec2f, b: vec2f,
) -> vec2f {
    let raw = vec2f(
        textureLoad(heights, horizon_shadow_wrapped(a, parameters), 0).x,
        textureLoad(heights, horizon_shadow_wrapped(b, parameters), 0).x,
    );
    return horizon_shadow_sanitised(raw.xyxy, parameters).xy;
}

// What one azimuth's candidates say about a cell's corners: sines.
struct HorizonShadowFar {
    // The upper envelope: no horizon is lower.
    least: vec4f,
    // The chord between the curvatures that the candidates won: no horizon is higher.
    greatest: vec4f,
}

// `position` is the curvature's place among the candidates', and `bounds` whether the chord is
// wanted.
fn horizon_shadow_far(
    candidates: texture_2d_array<u32>, parameters: HorizonShadowParameters, view: HorizonShadowView,
    cell: HorizonShadowCell, corners: vec4f, azimuth: u32, position: f32, bounds: bool,
) -> HorizonShadowFar {
    let a = textureLoad(candidates, cell.low, azimuth, 0);
    let b = textureLoad(candidates, vec2i(cell.high.x, cell.low.y), azimuth, 0);
    let c = textureLoad(candidates, vec2i(cell.low.x, cell.high.y), azimuth, 0);
    let d = textureLoad(candidates, cell.high, azimuth, 0);
    var best = horizon_shadow_floor_rises(view.kappa, corners);
    var chord = vec4f(0.0);
    let last = max(parameters.candidates, 1u) - 1u;
    for (var i = 0u; i <= last; i++) {
        let pairs = horizon_shadow_decoded(horizon_shadow_codes(a, b, c, d, i, parameters), parameters);
        let up = pairs.up * view.steepening;
        best = horizon_shadow_higher(best, horizon_shadow_exact_rises(
            view.kappa, pairs.distance, up, pairs.across, corners));
        if bounds {
            let share = max(1.0 - abs(position - f32(i)), 0.0);
            let node = view.steepening * horizon_shadow_node(parameters, i);
            let slope = pairs.up / pairs.across;
            let at_most = (slope + horizon_shadow_slope_error(slope, parameters)) * view.steepening;
            chord += share * horizon_shadow_exact_slopes(node, pairs.distance, at_most, corners);
        }
    }
    var far: HorizonShadowFar;
    far.least = best.up * inverseSqrt(max(best.up * best.up + best.across * best.across, vec4f(1e-30)));
    far.greatest = max(horizon_shadow_sines_of(chord), far.least);
    return far;
}

// The smooth base's own horizon as fractions.
fn horizon_shadow_floor_rises(kappa: f32, height: vec4f) -> HorizonShadowRises {
    let x = max(kappa * height, vec4f(0.0));
    let convex = vec4<bool>(kappa > 0.0);
    return HorizonShadowRises(
        select(vec4f(-1.0), -sqrt(x * (2.0 + x)), convex), select(vec4f(0.0), vec4f(1.0), convex));
}

// The curvature that candidate `index` won, 1 / texel of the bake.
fn horizon_shadow_node(parameters: HorizonShadowParameters, index: u32) -> f32 {
    let place = select(f32(index) / f32(parameters.candidates - 1u), 0.5, parameters.candidates < 2u);
    return mix(parameters.least_curvature, parameters.greatest_curvature, place);
}

// Place of the curvature along the azimuth among the candidates', 0..candidates - 1.
fn horizon_shadow_node_position(parameters: HorizonShadowParameters, kappa: f32, steepening: f32) -> f32 {
    let span = (parameters.greatest_curvature - parameters.least_curvature) * steepening;
    let from_least = kappa - parameters.least_curvature * steepening;
    let place = select(0.0, clamp(from_least / span, 0.0, 1.0), abs(span) > 1e-12);
    return place * f32(max(parameters.candidates, 1u) - 1u);
}

// Tangent of the horizon that marching the relief on its curved profile finds between two
// distances, or some tangent above `enough` as soon as one is found. `step` is the length of a
// step; where it is 0 the crossings with the map's lines and the middles between them are visited.
// What lies too low to rise above both `best` and `needed` is left out.
fn horizon_shadow_march(
    heights: texture_2d<f32>, parameters: HorizonShadowParameters, view: HorizonShadowView,
    height: f32, first: f32, step: f32, so_far: f32, needed: f32, enough: f32,
) -> f32 {
    let speed = max(abs(view.direction), vec2f(1e-6));
    let forward = view.direction >= vec2f(0.0);
    let last = parameters.radius_texels;
    let greatest = (parameters.greatest_height - parameters.least_height) * view.texels_per_height;
    // Lines crossed are at most this many; the last count of steps keeps what is odd from hanging.
    let most = 16u + u32(select(2.0 * last, last / max(step, 1e-3), step > 0.0));
    var best = so_far;
    var reached = first;
    for (var i = 0u; i < most; i++) {
        if reached >= last || best > enough {
            break;
        }
        if view.kappa >= 0.0 && greatest - height < max(best, needed) * reached {
            break;
        }
        var next = reached + step;
        var middle = next;
        if step <= 0.0 {
            let at = view.at + reached * view.direction;
            // The line ahead; one that lies closer than rounding can tell has been crossed.
            let line = select(ceil(at - 1e-4) - 1.0, floor(at + 1e-4) + 1.0, forward);
            let exits = abs(line - at) / speed;
            next = min(reached + min(exits.x, exits.y), last);
            middle = 0.5 * (reached + next);
        }
        let reduced = horizon_shadow_reduced(view.at + middle * view.direction, parameters);
        let cell = horizon_shadow_cell(heights, parameters, reduced, view.direction);
        let end = cell.fraction + (next - middle) * view.direction;
        let there = vec2f(
            dot(horizon_shadow_weights(cell.fraction), cell.heights),
            dot(horizon_shadow_weights(end), cell.heights)) * view.texels_per_height;
        let ends = vec2f(middle, next);
        let slopes = (there - height) / ends;
        let found = horizon_shadow_exact_slopes(view.kappa, ends.xyxy, slopes.xyxy, vec4f(height));
        best = max(best, max(found.x, found.y));
        reached = next;
    }
    return best;
}

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

// Texels of the map that a pixel covers along its longer side.
fn horizon_shadow_footprint(parameters: HorizonShadowParameters, surface: HorizonShadowSurface) -> f32 {
    let scale = parameters.uv_scale * parameters.size;
    let longest = max(length(surface.uv_dx * scale), length(surface.uv_dy * scale));
    return max(horizon_shadow_bounded(longest, 1e6), 0.0);
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
