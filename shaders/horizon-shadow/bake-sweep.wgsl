// Finds where the horizons of one azimuth and one curvature lie, in time proportional to the texels
// (after Timonen and Westerholm's line sweep).
//
// Parallel lines along the azimuth lie one texel apart across it, so that each texel belongs to
// one line. On a line, heights are points of the bent profile (x, y) = (s (1 + kappa h),
// h cos(gamma) - c), and the horizon of a point is where the tangent from it touches the upper
// hull of what lies ahead. What lies ahead is a window of `reach` texels, which slides: one
// invocation fills a block of a line from its far end to its near end, and splits the window at
// the block's end. The hull of the part within the block grows towards the viewer. The part
// beyond shrinks from its far end: its hull was built outwards, and each point that was added is
// taken back, with the one stack slot that adding it had overwritten (Overmars' and van Leeuwen's
// undo).
// Stacks of both hulls are searched by bisection.

// Scratch memory is interleaved among so many invocations.
const LANES: u32 = 32u;
// What taking back means where no point was added.
const NOTHING: u32 = 0xffffffffu;


// Above 0 where b lies to the left of a.
fn turn_of(a: vec2f, b: vec2f) -> f32 {
    return a.x * b.y - a.y * b.x;
}

// The texel that a line owns at a place along its axis, before it is brought to the map.
fn owned(line: i32, along: i32) -> i32 {
    return line + i32(floor(f32(along) * bake.drift + 0.5));
}

// Height of a line: linear between the two texels across it.
fn line_height(along: i32, across: f32) -> f32 {
    let extent = select(bake.size, bake.size.yx, bake.along_y != 0u);
    let repeats = vec2<bool>((bake.wrap & 1u) != 0u, (bake.wrap & 2u) != 0u);
    let along_repeats = select(repeats.x, repeats.y, bake.along_y != 0u);
    let across_repeats = select(repeats.y, repeats.x, bake.along_y != 0u);
    // Lines run against the axis where the azimuth does.
    let major = select(f32(along), f32(extent.x) - 1.0 - f32(along), bake.backward != 0u);
    let place = bake_wrapped(major, extent.x, along_repeats);
    let low = floor(across);
    let first = bake_wrapped(low, extent.y, across_repeats);
    let second = bake_wrapped(low + 1.0, extent.y, across_repeats);
    let stride = select(vec2u(1u, bake.size.x), vec2u(bake.size.x, 1u), bake.along_y != 0u);
    let here = relief[place * stride.x + first * stride.y];
    return here + (relief[place * stride.x + second * stride.y] - here) * (across - low);
}

// The map's point at `along` and `across`: lines run against the axis where the azimuth does.
fn map_point(along: f32, across: f32) -> vec2f {
    let extent = f32(select(bake.size.x, bake.size.y, bake.along_y != 0u));
    let major = select(along, extent - 1.0 - along, bake.backward != 0u);
    return select(vec2f(major, across), vec2f(across, major), bake.along_y != 0u);
}

// Whether a block of a line owns a texel of the rows that are worked on.
fn works_on_rows(line: i32, first: i32, last: i32, extent: vec2i, across_repeats: bool) -> bool {
    if bake.along_y != 0u {
        let backward = bake.backward != 0u;
        let low = select(first, extent.x - 1 - last, backward);
        let high = select(last, extent.x - 1 - first, backward);
        let on_map = across_repeats || (max(owned(line, first), owned(line, last)) >= 0
            && min(owned(line, first), owned(line, last)) < extent.y);
        return on_map && high >= i32(bake.rows.x) && low < i32(bake.rows.y);
    }
    let low = min(owned(line, first), owned(line, last));
    let high = max(owned(line, first), owned(line, last));
    if !across_repeats {
        return high >= i32(bake.rows.x) && low < i32(bake.rows.y);
    }
    // The rows repeat: the next ones at or after the lowest.
    let turns = i32(ceil(f32(low - i32(bake.rows.y) + 1) / f32(extent.y)));
    return i32(bake.rows.x) + turns * extent.y <= high;
}

// The bent point of a height so many texels of the axis ahead of (behind, where negative) the
// block's end.
fn bent(steps: i32, height: f32) -> vec2f {
    let point = profile[bake.node * bake.profile_row + 2u * u32(abs(steps))];
    let from_centre = 1.0 + bake.kappas[bake.node] * height;
    return vec2f(sign(f32(steps)) * point.x * from_centre, height * point.z - point.y);
}

// The same, moved along the profile by less than a texel.
fn bent_beside(steps: i32, height: f32, offset: f32) -> vec2f {
    let kappa = bake.kappas[bake.node];
    let point = profile[bake.node * bake.profile_row + 2u * u32(abs(steps))];
    let s = sign(f32(steps)) * point.x;
    let turn = kappa * offset;
    let cosine = point.z - kappa * s * turn - 0.5 * point.z * turn * turn;
    let versine = point.y + turn * s + 0.5 * kappa * offset * offset * point.z;
    return vec2f((s + point.z * offset) * (1.0 + kappa * height), height * cosine - versine);
}

@compute @workgroup_size(32)
fn sweep(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let local = id.y * groups.x * LANES + id.x;
    let invocation = bake.first_invocation + local;
    if local >= bake.invocations {
        return;
    }
    let line = bake.line_first + i32(invocation % bake.lines);
    let extent = select(bake.size, bake.size.yx, bake.along_y != 0u);
    let repeats = vec2<bool>((bake.wrap & 1u) != 0u, (bake.wrap & 2u) != 0u);
    let across_repeats = select(repeats.y, repeats.x, bake.along_y != 0u);
    let block_first = (invocation / bake.lines) * bake.block;
    let block_last = i32(min(block_first + bake.block, extent.x)) - 1;
    if !works_on_rows(line, i32(block_first), block_last, vec2i(extent), across_repeats) {
        return;
    }

    // Memory of this invocation. Points: those of both hulls' stacks (the part beyond from 0, the
    // part within from `reach`), then all that were added beyond. Links: the places of the stacks'
    // points, counted from the split, then what takes back.
    let group = local / LANES;
    let lane = local % LANES;
    let stacks = bake.reach + bake.block;
    let points_base = group * LANES * (stacks + bake.reach) + lane;
    let links_base = group * LANES * (stacks + bake.reach) + lane;
    let added_base = points_base + LANES * stacks;
    let undo_base = links_base + LANES * stacks;
    let split = block_last + 1;
    let kappa = bake.kappas[bake.node];
    // Points on the hulls of the part within and of the part beyond.
    var within = 0u;
    var beyond = 0u;
    var added = 0u;
    var highest_beyond = 0.0;
    // The last two points of the stack that grows.
    var under = vec2f(0.0);
    var upper = vec2f(0.0);
    let beyond_count = bake.reach - 1u;
    let total = beyond_count + u32(block_last + 1) - block_first;
    for (var turn = 0u; turn < total; turn++) {
        let outward = turn < beyond_count;
        let at = block_last - i32(turn - select(beyond_count, turn, outward));

        // Add the next point to its hull. Within the block the nearest is two texels ahead: those
        // before it are the search's to look at.
        let ahead = select(at + 2, split + 1 + i32(turn), outward);
        if ahead <= split || outward {
            let height = line_height(ahead, f32(line) + f32(ahead) * bake.drift);
            let slots = select(bake.reach, 0u, outward);
            if 1.0 + kappa * height > 0.0 {
                let point = bent(ahead - split, height);
                let count = select(within, beyond, outward);
                var top = count;
                while top >= 2u {
                    let left = select(point, under, outward);
                    let right = select(under, point, outward);
                    if turn_of(right - left, upper - left) >= 0.0 {
                        break;
                    }
                    top--;
                    upper = under;
                    if top >= 2u {
                        under = points[points_base + LANES * (slots + top - 2u)];
                    }
                }
                let slot = slots + top;
                if outward {
                    links[undo_base + LANES * added] = count | links[links_base + LANES * slot] << 16u;
                    points[added_base + LANES * added] = point;
                    highest_beyond = max(highest_beyond, height);
                    beyond = top + 1u;
                } else {
                    within = top + 1u;
                }
                points[points_base + LANES * slot] = point;
                links[links_base + LANES * slot] = u32(abs(ahead - split));
                under = upper;
                upper = point;
            } else if outward {
                links[undo_base + LANES * added] = NOTHING;
            }
            added += select(0u, 1u, outward);
        }
        if outward {
            continue;
        }

        // Look from the texel that the line owns here.
        let across = owned(line, at);
        let extent_across = i32(extent.y);
        let texel_across = across - extent_across * i32(floor(f32(across) / f32(extent_across)));
        let on_map = across_repeats || (across >= 0 && across < extent_across);
        let texel = vec2u(map_point(f32(at), f32(texel_across)));
        if on_map && texel.y >= bake.rows.x && texel.y < bake.rows.y {
            let height = relief[texel.y * bake.size.x + texel.x];
            let sideways = select(bake.advance.y, bake.advance.x, bake.along_y != 0u) / bake.spacing;
            let offset = (f32(across) - (f32(line) + f32(at) * bake.drift)) * sideways;
            let eye = bent_beside(at - split, height, offset);
            var found = 0u;
            var best = vec2f(0.0);
            for (var part = 0u; part < 2u; part++) {
                let far_part = part == 1u;
                let count = select(within, beyond, far_part);
                // Over ground that is not concave nothing of the part beyond is seen above its
                // highest point, brought to where it is nearest.
                let ridge = bent(1, max(highest_beyond, height)) - eye;
                if count == 0u || (far_part && found > 0u && kappa >= 0.0 && turn_of(best, ridge) <= 0.0) {
                    continue;
                }
                // From the nearest on, each point appears higher than the one before up to the
                // tangent's, and lower from there on.
                var low = 0u;
                var high = count - 1u;
                while low < high {
                    let middle = (low + high) / 2u;
                    let near_slot = select(bake.reach + count - 1u - middle, middle, far_part);
                    let next_slot = select(near_slot - 1u, near_slot + 1u, far_part);
                    let near = points[points_base + LANES * near_slot];
                    let next = points[points_base + LANES * next_slot];
                    if turn_of(near - eye, next - eye) > 0.0 {
                        low = middle + 1u;
                    } else {
                        high = middle;
                    }
                }
                let slot = select(bake.reach + count - 1u - low, low, far_part);
                let seen = points[points_base + LANES * slot] - eye;
                if found == 0u || turn_of(best, seen) > 0.0 {
                    best = seen;
                    let place = select(-1, 1, far_part) * i32(links[links_base + LANES * slot]);
                    let distance = f32(place - (at - split)) * 2.0 - offset / bake.spacing;
                    found = u32(clamp(distance + 0.5, 1.0, f32(bake.last_sample)));
                }
            }
            let target_texel = (texel.y - bake.rows.x) * bake.size.x + texel.x;
            winners[target_texel * bake.nodes + bake.node] = found;
        }

        // The window's far end comes one texel nearer.
        if added > 0u {
            added--;
            let undo = links[undo_base + LANES * added];
            if undo != NOTHING {
                let slot = beyond - 1u;
                let place = undo >> 16u;
                links[links_base + LANES * slot] = place;
                // What stood there was added as the place'th.
                points[points_base + LANES * slot] = points[added_base + LANES * (max(place, 1u) - 1u)];
                beyond = undo & 0xffffu;
            }
        }
    }
}
