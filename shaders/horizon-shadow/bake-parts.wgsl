// What is made from the candidates of an azimuth, or of all: extents of tiles, moments of the
// horizons' sines, ambient occlusion with bent normals; and the coarser levels of the last two.

@group(1) @binding(0) var candidates: texture_2d_array<u32>;
@group(1) @binding(1) var finer: texture_2d_array<f32>;

const TILE: i32 = 8;
const BLOCK: u32 = 4u;

fn decoding() -> HorizonShadowParameters {
    var parameters: HorizonShadowParameters;
    parameters.contents = bake.contents;
    parameters.radius_texels = bake.radius;
    parameters.slope_scale = bake.slope_scale;
    return parameters;
}

fn bake_repeats() -> vec2<bool> {
    return vec2<bool>((bake.wrap & 1u) != 0u, (bake.wrap & 2u) != 0u);
}

fn bake_texel(at: vec2i) -> vec2u {
    let repeats = bake_repeats();
    return vec2u(
        bake_wrapped(f32(at.x), bake.size.x, repeats.x), bake_wrapped(f32(at.y), bake.size.y, repeats.y));
}

fn relief_of(at: vec2i) -> f32 {
    let texel = bake_texel(at);
    return relief[texel.y * bake.size.x + texel.x];
}

fn sine_of(tangent: f32) -> f32 {
    return tangent * inverseSqrt(1.0 + tangent * tangent);
}

// Tangents of the horizon beyond one texel: the candidates' envelope at the least and at the greatest
// curvature.
fn envelope(texel: vec2u, azimuth: u32, height: f32) -> vec2f {
    let words = textureLoad(candidates, texel, azimuth, 0);
    let parameters = decoding();
    var best = vec2f(HORIZON_SHADOW_NO_HORIZON);
    for (var i = 0u; i < bake.nodes; i++) {
        let candidate = horizon_shadow_candidate(words, i, parameters);
        best = max(best, vec2f(
            exact_tangent(bake.curvatures.x, candidate, height),
            exact_tangent(bake.curvatures.y, candidate, height),
        ));
    }
    return best;
}

// Two numbers of -1..1 as half floats, rounded to the nearest (pack2x16float is not on all devices).
fn packed_halves(v: vec2f) -> u32 {
    let bits = bitcast<vec2u>(abs(v));
    let normal = (bits + 0x1000u - 0x38000000u) >> vec2u(13u);
    let tiny = vec2u(abs(v) * 16777216.0 + 0.5);
    let halves = select(normal, tiny, abs(v) < vec2f(6.1035156e-5))
        | ((bitcast<vec2u>(v) >> vec2u(16u)) & vec2u(0x8000u));
    return halves.x | halves.y << 16u;
}

// The exact horizon of a candidate (slope, distance).
fn exact_tangent(kappa: f32, candidate: vec2f, height: f32) -> f32 {
    let gamma = kappa * candidate.y;
    let x = gamma * gamma;
    if x >= HORIZON_SHADOW_QUARTER_TURN_SQUARED {
        return HORIZON_SHADOW_NO_HORIZON;
    }
    let sinc = 1.0 + x * (-0.16666661 + x * (0.008333088 + x * (-0.00019811113 + x * 2.6089326e-6)));
    let versine = 0.5 + x * (-0.041665938 + x * (0.0013870859 - x * 2.3529126e-5));
    let from_centre = 1.0 + kappa * height;
    let across = from_centre + gamma * candidate.x;
    let up = candidate.x * (1.0 - x * versine) - from_centre * gamma * versine;
    if across <= 0.0 {
        return HORIZON_SHADOW_NO_HORIZON;
    }
    return clamp(up / (across * sinc), HORIZON_SHADOW_NO_HORIZON, -HORIZON_SHADOW_NO_HORIZON);
}

// The horizon of a texel's centre at the least and at the greatest curvature, the nearest texel and
// the base's own horizon included.
fn horizons(texel: vec2u, azimuth: u32, direction: vec2f, step: f32) -> vec2f {
    let height = relief[texel.y * bake.size.x + texel.x];
    // Within a texel only the sample half a texel along the greater axis.
    let slope = (bake_height(vec2f(texel) + direction * step) - height) / step;
    let near = vec2f(
        exact_tangent(bake.curvatures.x, vec2f(slope, step), height),
        exact_tangent(bake.curvatures.y, vec2f(slope, step), height),
    );
    let floors = vec2f(
        horizon_shadow_floor(bake.curvatures.x, height), horizon_shadow_floor(bake.curvatures.y, height));
    return max(max(envelope(texel, azimuth, height), near), floors);
}

fn direction_of(azimuth: f32) -> vec2f {
    let angle_rad = 2.0 * SHEEN_PI * azimuth / f32(bake.azimuths);
    return vec2f(cos(angle_rad), sin(angle_rad));
}

// Least and greatest sine of the horizon over a tile, its neighbours at +1, the whole range of
// curvatures and the azimuths up to halfway to the next ones.
fn tile_extent(tile: vec2i) -> vec2f {
    let first = tile * TILE;
    let end = min(first + TILE, vec2i(bake.size)) + 1;
    let half_slice = 0.5;
    let left = direction_of(f32(bake.azimuth) - half_slice);
    let right = direction_of(f32(bake.azimuth) + half_slice);
    // The chord between both directions, by which slopes between them are bounded.
    let chord = 0.5 * length(left + right);
    var least = -HORIZON_SHADOW_NO_HORIZON;
    var greatest = HORIZON_SHADOW_NO_HORIZON;
    var steepest = HORIZON_SHADOW_NO_HORIZON;
    var highest = 0.0;
    // The base's own horizon is there only on convex ground, and highest where that is least curved.
    let floor_counts = bake.curvatures.x > 0.0;
    for (var y = first.y - 1; y <= end.y; y++) {
        for (var x = first.x - 1; x <= end.x; x++) {
            let a = relief_of(vec2i(x, y));
            let b = relief_of(vec2i(x + 1, y));
            let c = relief_of(vec2i(x, y + 1));
            let d = relief_of(vec2i(x + 1, y + 1));
            highest = max(highest, max(max(a, b), max(c, d)));
            // Gradients of a bilinear cell are between those along its edges.
            let slopes_x = vec2f(b - a, d - c);
            let slopes_y = vec2f(c - a, d - b);
            let along_left = max(slopes_x.x * left.x, slopes_x.y * left.x)
                + max(slopes_y.x * left.y, slopes_y.y * left.y);
            let along_right = max(slopes_x.x * right.x, slopes_x.y * right.x)
                + max(slopes_y.x * right.y, slopes_y.y * right.y);
            steepest = max(steepest, max(along_left, along_right));
            if x >= first.x && y >= first.y && x < end.x && y < end.y {
                let tangents = envelope(bake_texel(vec2i(x, y)), bake.azimuth, a);
                let lower = select(tangents.y, max(tangents.y, horizon_shadow_floor(bake.curvatures.y, a)),
                    floor_counts);
                let upper = select(tangents.x, max(tangents.x, horizon_shadow_floor(bake.curvatures.x, a)),
                    floor_counts);
                least = min(least, lower);
                greatest = max(greatest, upper);
            }
        }
    }
    if bake.curvatures.y > 0.0 && !floor_counts {
        greatest = max(greatest, 0.0);
    }
    let bound = steepest / select(1.0, chord, steepest > 0.0);
    let convex = 1.0 + max(bake.curvatures.y, 0.0) * highest;
    let concave = exact_tangent(bake.curvatures.x, vec2f(bound, 1.0), highest);
    let near = max(select(bound / convex, bound, bound > 0.0), concave);
    greatest = max(greatest, near);
    return vec2f(sine_of(least), sine_of(greatest));
}

@compute @workgroup_size(32)
fn extents(@builtin(global_invocation_id) id: vec3u) {
    let tiles = (bake.size + 7u) / 8u;
    let row = bake.rows.x + id.y;
    if 2u * id.x >= tiles.x || row >= bake.rows.y {
        return;
    }
    var word = 0u;
    for (var i = 0u; i < 2u; i++) {
        let extent = tile_extent(vec2i(vec2u(min(2u * id.x + i, tiles.x - 1u), row)));
        // Rounded outwards.
        let codes = clamp(vec2f(extent * 0.5 + 0.5) * 255.0, vec2f(0.0), vec2f(255.0));
        word |= (u32(floor(codes.x)) | u32(ceil(codes.y)) << 8u) << (16u * i);
    }
    encoded[id.y * bake.pitch + id.x] = word;
}

@compute @workgroup_size(64)
fn moments(@builtin(global_invocation_id) id: vec3u) {
    let blocks = (bake.size + BLOCK - 1u) / BLOCK;
    let block = vec2u(id.x, bake.rows.x + id.y);
    if block.x >= blocks.x || block.y >= bake.rows.y {
        return;
    }
    let first = block * BLOCK;
    let end = min(first + BLOCK, bake.size);
    let width = end.x - first.x;
    let count = width * (end.y - first.y);
    let step = length(bake.advance);
    var sum = vec4f(0.0);
    for (var i = 0u; i < count; i++) {
        let texel = first + vec2u(i % width, i / width);
        let tangents = horizons(texel, bake.azimuth, bake.advance / step, step);
        let sines = tangents * inverseSqrt(1.0 + tangents * tangents);
        sum += vec4f(sines.x, sines.x * sines.x, sines.y, sines.y * sines.y);
    }
    let mean = sum / f32(count);
    let word = id.y * bake.pitch + 2u * id.x;
    encoded[word] = packed_halves(mean.xy);
    encoded[word + 1u] = packed_halves(mean.zw);
}

// Bent normal and visible fraction of a texel from the sums over all azimuths.
fn ambient_code(bent: vec3f, cosine_sum: f32, normal: vec3f) -> u32 {
    let unit = sheen_normalize_or(bent, normal);
    return pack4x8unorm(vec4f(unit.xy * 0.5 + 0.5, clamp(cosine_sum, 0.0, 1.0), 1.0));
}

@compute @workgroup_size(64)
fn ambient(@builtin(global_invocation_id) id: vec3u) {
    let texel = vec2u(id.x, bake.rows.x + id.y);
    if texel.x >= bake.size.x || texel.y >= bake.rows.y {
        return;
    }
    let at = vec2i(texel);
    let along_x = 0.5 * (relief_of(at + vec2i(1, 0)) - relief_of(at - vec2i(1, 0)));
    let along_y = 0.5 * (relief_of(at + vec2i(0, 1)) - relief_of(at - vec2i(0, 1)));
    let normal = normalize(vec3f(-along_x, -along_y, 1.0));
    var bent_least = vec3f(0.0);
    var bent_greatest = vec3f(0.0);
    var visible = vec2f(0.0);
    for (var azimuth = 0u; azimuth < bake.azimuths; azimuth++) {
        let direction = direction_of(f32(azimuth));
        let step = 0.5 / max(abs(direction.x), abs(direction.y));
        let tangents = horizons(texel, azimuth, direction, step);
        let angles = vec2f(atan(tangents.x), atan(tangents.y));
        let cosines_squared = 1.0 / (1.0 + tangents * tangents);
        // Integrals of cos^2 and of sin cos over the elevations above the horizon.
        let across = 0.5 * (0.5 * SHEEN_PI - angles) - 0.5 * tangents * cosines_squared;
        let up = 0.5 * cosines_squared;
        bent_least += vec3f(direction * across.x, up.x);
        bent_greatest += vec3f(direction * across.y, up.y);
        visible += max(dot(normal.xy, direction) * across + normal.z * up, vec2f(0.0));
    }
    // The whole hemisphere's cosines sum to pi.
    visible *= 2.0 / f32(bake.azimuths);
    let word = id.y * bake.pitch + id.x;
    encoded[word] = ambient_code(bent_least, visible.x, normal);
    // The layer of the greatest curvature stands after that of the least.
    encoded[word + bake.pitch * (bake.rows.y - bake.rows.x)] = ambient_code(bent_greatest, visible.y, normal);
}

// A coarser level: the mean of four texels, at the border of those that there are.
@compute @workgroup_size(64)
fn halve(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= bake.level_size.x || id.y >= bake.level_size.y {
        return;
    }
    let last = vec2u(textureDimensions(finer, bake.finer_level)) - 1u;
    let low = min(2u * id.xy, last);
    let high = min(2u * id.xy + 1u, last);
    // OpenGL takes levels as signed numbers alone.
    let level = i32(bake.finer_level);
    let mean = 0.25 * (textureLoad(finer, low, bake.azimuth, level)
        + textureLoad(finer, vec2u(high.x, low.y), bake.azimuth, level)
        + textureLoad(finer, vec2u(low.x, high.y), bake.azimuth, level)
        + textureLoad(finer, high, bake.azimuth, level));
    if bake.half_floats != 0u {
        let word = id.y * bake.pitch + 2u * id.x;
        encoded[word] = packed_halves(mean.xy);
        encoded[word + 1u] = packed_halves(mean.zw);
    } else {
        encoded[id.y * bake.pitch + id.x] = pack4x8unorm(mean);
    }
}
