// The parts of the better methods' horizon: the nearest texels traced, the envelope of the
// candidates beyond, and the march.

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
