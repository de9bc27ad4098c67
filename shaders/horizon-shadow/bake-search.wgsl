// Finds the horizon of each texel of some rows in one azimuth, for one or more curvatures, and
// encodes it: among all samples, or among the nearest ones and those around the sweep's find.

// Samples up to this one are looked at even where the sweep has found a farther horizon.
const NEAR_SAMPLES: u32 = 8u;
// Samples on either side of the sweep's find that are looked at: its line passes beside the texel.
const WINDOW: u32 = 3u;
// The tangent of "no horizon".
const NONE: f32 = -1e4;

struct Horizon {
    // The tangent is up / across.
    up: f32,
    across: f32,
    rise: f32,
    // 0 where there is none.
    sample_index: u32,
}

// The code of angle (high) and distance in steps of 1/255, or of either alone.
fn published_code(tangent: f32, distance: f32) -> u32 {
    let angle_code = u32(floor((atan(tangent) / SHEEN_PI + 0.5) * 255.0 + 0.5));
    let distance_code = u32(floor(clamp(distance / bake.radius, 0.0, 1.0) * 255.0 + 0.5));
    if bake.contents == HORIZON_SHADOW_CONTENTS_FLAT {
        return angle_code;
    }
    if bake.contents == HORIZON_SHADOW_CONTENTS_DISTANCE_AND_HEIGHT {
        return distance_code;
    }
    return angle_code | distance_code << 8u;
}

fn candidate_code(horizon: Horizon, kappa: f32, node: u32, height: f32, distance: f32) -> u32 {
    let full = bake.contents == HORIZON_SHADOW_CONTENTS_FULL;
    let bits = select(HORIZON_SHADOW_COMPACT_BITS, HORIZON_SHADOW_FULL_BITS, full);
    let distance_code = horizon_shadow_distance_code(distance, bits, bake.radius);
    var slope = horizon.rise / distance;
    if !full {
        // The slope that keeps the tangent at this curvature where the distance was rounded.
        let codes = 1u << bits.y;
        let point = profile[bake.nodes * bake.profile_row + node * codes + distance_code];
        let tangent = horizon.up / horizon.across;
        let divisor = (point.z - tangent * kappa * point.x) * point.w;
        if divisor > 1e-3 {
            slope = (1.0 + kappa * height) * (tangent * point.x + point.y) / divisor;
        }
    }
    let slope_code = horizon_shadow_slope_code(slope, bits, bake.slope_scale);
    return slope_code | distance_code << bits.x;
}

// The horizon's code.
fn encode(horizon: Horizon, kappa: f32, node: u32, height: f32) -> u32 {
    let published = bake.contents < HORIZON_SHADOW_CONTENTS_COMPACT;
    if horizon.sample_index == 0u {
        // The least slope, one texel away.
        return select(1u, 0u, published);
    }
    let distance = f32(horizon.sample_index) * bake.spacing;
    if published {
        return published_code(horizon.up / horizon.across, distance);
    }
    return candidate_code(horizon, kappa, node, height, distance);
}

@compute @workgroup_size(64)
fn search(@builtin(global_invocation_id) id: vec3u) {
    let row = bake.rows.x + id.y;
    let texels = bake.unit_codes / bake.nodes;
    if id.x * texels >= bake.size.x || row >= bake.rows.y {
        return;
    }
    let target_word = id.y * bake.pitch + id.x * bake.unit_words;
    var word = 0u;
    for (var item = 0u; item < bake.unit_codes; item++) {
        let node = item % bake.nodes;
        // The last word of a row may be longer than the row.
        let column = min(id.x * texels + item / bake.nodes, bake.size.x - 1u);
        let kappa = bake.kappas[node];
        let height = relief[row * bake.size.x + column];
        let from_centre = 1.0 + kappa * height;
        var found = 0u;
        if bake.brute_force == 0u {
            found = winners[(id.y * bake.size.x + column) * bake.nodes + node];
        }
        let near = select(min(NEAR_SAMPLES, bake.last_sample), bake.last_sample, bake.brute_force != 0u);
        let last = max(near, select(0u, min(found + WINDOW, bake.last_sample), found > 0u));
        let resume = max(near + 1u, max(found, WINDOW) - WINDOW);
        var best = Horizon(NONE, 1.0, 0.0, 0u);
        var i = bake.first_sample;
        while i <= last {
            let point = profile[node * bake.profile_row + i];
            let rise = bake_height(vec2f(vec2u(column, row)) + f32(i) * bake.advance) - height;
            let across = (from_centre + kappa * rise) * point.x;
            let up = rise * point.z - from_centre * point.y;
            // Strictly: of equal horizons the nearest counts.
            if across > 0.0 && up * best.across > best.up * across {
                best = Horizon(up, across, rise, i);
            }
            i = select(i + 1u, resume, i == near);
        }
        let shift = (item * bake.code_bits) % 32u;
        word |= encode(best, kappa, node, height) << shift;
        if shift + bake.code_bits == 32u || item + 1u == bake.unit_codes {
            encoded[target_word + item * bake.code_bits / 32u] = word;
            word = 0u;
        }
    }
}
