// Finds the bright sources of an environment (the sun, lamps, windows) and takes them out of it,
// so that the rest can be filtered without aliasing and the sources integrated in closed form.
//
// The map is divided into cells of a few degrees. Dispatches: `measure` sums each cell,
// `summarise` adds the cells up, `excess` takes the moments of what exceeds a multiple of the
// mean in each cell, `classify` tells compact sources from parts of extended ones,
// `select_sources` keeps the most powerful; then `residual` writes the map without the compact
// ones. Extended sources stay in the chain's fine levels and leave it in `chain.wgsl`.

const WORKGROUP: u32 = 64u;
const CELL_COLUMNS: u32 = 128u;
const CELL_ROWS: u32 = 64u;
const CELLS: u32 = 8192u;
const MAX_SOURCES: u32 = 64u;
// Luminance above this multiple of the ambient mean is excess.
const THRESHOLD_OF_MEAN: f32 = 8.0;
// A source is compact within this root mean square radius, in texels of the map.
const COMPACT_TEXELS: f32 = 3.0;
// A cell matters from this share of the whole environment's power.
const LEAST_POWER_SHARE: f32 = 2e-4;

// Same layout as the library's.
const ROW_HARMONICS: u32 = 2u;
const ROW_SOURCE_AXIS: u32 = 3u;
const ROW_SOURCE_POWER: u32 = 4u;
const ROW_SOURCE_KIND: u32 = 5u;
const SUMMARY: u32 = 9u;

struct Cell {
    // Sum of radiance times solid angle; sum of solid angle in w.
    radiance: vec4f,
    // Least and greatest value of each channel.
    least: vec4f,
    greatest: vec4f,
    // 1 in x where the cell was chosen as a source; 1 in y where the bright region that it belongs
    // to is compact.
    flags: vec4f,
    // Sum of excess radiance times solid angle; its luminance in w.
    excess: vec4f,
    // In x, how much the integral of squared luminance falls when the excess is taken away.
    square: vec4f,
    // Mean direction of the excess; root mean square radius in w.
    axis: vec4f,
}

struct Summary {
    mean_luminance: f32,
    threshold: f32,
    power: f32,
    constant: f32,
}

@group(0) @binding(0) var map: texture_2d<f32>;
@group(0) @binding(1) var<storage, read_write> cells: array<Cell, CELLS>;
@group(0) @binding(2) var<storage, read_write> summary: Summary;
@group(0) @binding(3) var tables: texture_storage_2d<rgba32float, write>;
@group(0) @binding(4) var residual_map: texture_storage_2d<rgba16float, write>;

var<workgroup> sums: array<vec4f, WORKGROUP>;
var<workgroup> more: array<vec4f, WORKGROUP>;
var<workgroup> rest: array<vec4f, WORKGROUP>;
var<workgroup> best_power: f32;
var<workgroup> solid_angle_and_mean: vec2f;

fn luminance_of(color: vec3f) -> f32 {
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}

// Finite and not negative, whatever the host's texture holds.
fn radiance_at(texel: vec2u) -> vec3f {
    let raw = textureLoad(map, texel, 0).rgb;
    // A comparison with NaN is false, so NaN becomes 0.
    return min(select(vec3f(0.0), raw, raw > vec3f(0.0)), vec3f(SHEEN_RADIANCE_MAX));
}

fn solid_angle(row: u32, size: vec2u) -> f32 {
    // cos(a) - cos(b) as a product, counted from the nearer pole, which loses no digits there.
    let half_step = 0.5 * SHEEN_PI / f32(size.y);
    let middle = SHEEN_PI * (f32(min(row, size.y - 1u - row)) + 0.5) / f32(size.y);
    return 2.0 * SHEEN_PI / f32(size.x) * 2.0 * sin(middle) * sin(half_step);
}

fn direction_of(texel: vec2u, size: vec2u) -> vec3f {
    return sheen_lat_long_direction((vec2f(texel) + 0.5) / vec2f(size));
}

struct Block {
    first: vec2u,
    end: vec2u,
}

fn block_of(cell: vec2u, size: vec2u) -> Block {
    let grid = vec2u(CELL_COLUMNS, CELL_ROWS);
    return Block(cell * size / grid, (cell + 1u) * size / grid);
}

fn cell_of(texel: vec2u, size: vec2u) -> u32 {
    // The inverse of block_of: the last cell whose first texel is not beyond.
    let grid = vec2u(CELL_COLUMNS, CELL_ROWS);
    let cell = ((texel + 1u) * grid - 1u) / size;
    return cell.y * CELL_COLUMNS + cell.x;
}

@compute @workgroup_size(64)
fn measure(@builtin(workgroup_id) cell: vec3u, @builtin(local_invocation_index) lane: u32) {
    let size = textureDimensions(map);
    let block = block_of(cell.xy, size);
    let width = block.end.x - block.first.x;
    let count = width * (block.end.y - block.first.y);
    var sum = vec4f(0.0);
    var least = vec4f(3.4e38);
    var greatest = vec4f(0.0);
    for (var i = lane; i < count; i += WORKGROUP) {
        let texel = block.first + vec2u(i % width, i / width);
        let radiance = radiance_at(texel);
        let weight = solid_angle(texel.y, size);
        sum += vec4f(radiance, 1.0) * weight;
        least = min(least, vec4f(radiance, 0.0));
        greatest = max(greatest, vec4f(radiance, 0.0));
    }
    sums[lane] = sum;
    more[lane] = least;
    rest[lane] = greatest;
    workgroupBarrier();
    if lane == 0u {
        for (var i = 1u; i < WORKGROUP; i++) {
            sum += sums[i];
            least = min(least, more[i]);
            greatest = max(greatest, rest[i]);
        }
        let index = cell.y * CELL_COLUMNS + cell.x;
        cells[index].radiance = sum;
        cells[index].least = least;
        cells[index].greatest = greatest;
        cells[index].flags = vec4f(0.0);
    }
}

@compute @workgroup_size(64)
fn summarise(@builtin(local_invocation_index) lane: u32) {
    var sum = vec4f(0.0);
    var least = vec4f(3.4e38);
    var greatest = vec4f(0.0);
    for (var i = lane; i < CELLS; i += WORKGROUP) {
        sum += cells[i].radiance;
        least = min(least, cells[i].least);
        greatest = max(greatest, cells[i].greatest);
    }
    sums[lane] = sum;
    more[lane] = least;
    rest[lane] = greatest;
    workgroupBarrier();
    if lane == 0u {
        for (var i = 1u; i < WORKGROUP; i++) {
            sum += sums[i];
            least = min(least, more[i]);
            greatest = max(greatest, rest[i]);
        }
        let power = luminance_of(sum.rgb);
        summary.mean_luminance = power / max(sum.w, 1e-20);
        summary.power = power;
        summary.constant = select(0.0, 1.0, all(greatest.rgb <= least.rgb));
        solid_angle_and_mean = vec2f(max(sum.w, 1e-20), summary.mean_luminance);
    }
    let whole = workgroupUniformLoad(&solid_angle_and_mean);
    // The mean without the lights themselves: every cell counts for the mean at most.
    var ambient = 0.0;
    for (var i = lane; i < CELLS; i += WORKGROUP) {
        ambient += min(luminance_of(cells[i].radiance.rgb), whole.y * cells[i].radiance.w);
    }
    rest[lane] = vec4f(ambient);
    workgroupBarrier();
    if lane == 0u {
        for (var i = 1u; i < WORKGROUP; i++) {
            ambient += rest[i].x;
        }
        summary.threshold = THRESHOLD_OF_MEAN * ambient / whole.x;
    }
}

// What exceeds the threshold, with the colour of the texel.
fn excess_of(radiance: vec3f) -> vec3f {
    let luminance = luminance_of(radiance);
    return radiance * max(1.0 - summary.threshold / max(luminance, 1e-20), 0.0);
}

@compute @workgroup_size(64)
fn excess(@builtin(workgroup_id) cell: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = cell.y * CELL_COLUMNS + cell.x;
    let size = textureDimensions(map);
    let block = block_of(cell.xy, size);
    let width = block.end.x - block.first.x;
    let count = width * (block.end.y - block.first.y);
    var power = vec4f(0.0);
    var offset = vec4f(0.0);
    var square = 0.0;
    // Offsets from the cell's own middle keep the moments accurate for tiny sources.
    let middle = direction_of((block.first + block.end) / 2u, size);
    for (var i = lane; i < count; i += WORKGROUP) {
        let texel = block.first + vec2u(i % width, i / width);
        let radiance = radiance_at(texel);
        let weight = solid_angle(texel.y, size);
        let part = excess_of(radiance) * weight;
        let luminance = luminance_of(part);
        let whole = luminance_of(radiance);
        let kept = min(whole, summary.threshold);
        square += (whole - kept) * (whole + kept) * weight;
        let away = direction_of(texel, size) - middle;
        power += vec4f(part, luminance);
        offset += luminance * vec4f(away, dot(away, away));
    }
    sums[lane] = power;
    more[lane] = offset;
    rest[lane] = vec4f(square);
    workgroupBarrier();
    if lane == 0u {
        for (var i = 1u; i < WORKGROUP; i++) {
            power += sums[i];
            offset += more[i];
            square += rest[i].x;
        }
        offset /= max(power.w, 1e-30);
        // The bilinear tent of a texel adds a third of its squared size.
        let texel_angle = SHEEN_PI / f32(size.y);
        let variance = max(offset.w - dot(offset.xyz, offset.xyz), 0.0) + texel_angle * texel_angle / 3.0;
        cells[index].excess = power;
        cells[index].square = vec4f(square, 0.0, 0.0, 0.0);
        cells[index].axis = vec4f(sheen_normalize_or(middle + offset.xyz, middle), sqrt(variance));
    }
}

// A cell is compact if the bright texels of its neighbourhood together are.
@compute @workgroup_size(64)
fn classify(@builtin(global_invocation_id) id: vec3u) {
    let index = id.x;
    let own = cells[index];
    if own.excess.w <= 0.0 {
        return;
    }
    let column = index % CELL_COLUMNS;
    let row = index / CELL_COLUMNS;
    var power = 0.0;
    var offset = vec4f(0.0);
    for (var dy = 0u; dy < 3u; dy++) {
        let y = clamp(row + dy, 1u, CELL_ROWS) - 1u;
        // The clamped neighbours of the first and last row are that row again: leave them out.
        if y + 1u != row + dy {
            continue;
        }
        for (var dx = 0u; dx < 3u; dx++) {
            let x = (column + dx + CELL_COLUMNS - 1u) % CELL_COLUMNS;
            let cell = cells[y * CELL_COLUMNS + x];
            let away = cell.axis.xyz - own.axis.xyz;
            power += cell.excess.w;
            offset += cell.excess.w * vec4f(away, dot(away, away) + cell.axis.w * cell.axis.w);
        }
    }
    offset /= power;
    let radius = sqrt(max(offset.w - dot(offset.xyz, offset.xyz), 0.0));
    let texel_angle = SHEEN_PI / f32(textureDimensions(map).y);
    cells[index].flags.y = select(0.0, 1.0, radius < COMPACT_TEXELS * texel_angle);
}

// The cell's power where it may be a source and is not one yet, else 0.
fn source_power(index: u32) -> f32 {
    let power = cells[index].excess.w;
    let open = power > LEAST_POWER_SHARE * summary.power && cells[index].flags.x == 0.0;
    return select(0.0, power, open);
}

@compute @workgroup_size(64)
fn select_sources(@builtin(local_invocation_index) lane: u32) {
    var chosen = 0u;
    for (var round = 0u; round < MAX_SOURCES; round++) {
        var best = vec4f(0.0, -1.0, 0.0, 0.0);
        for (var i = lane; i < CELLS; i += WORKGROUP) {
            let power = source_power(i);
            if power > best.x {
                best = vec4f(power, f32(i), 0.0, 0.0);
            }
        }
        sums[lane] = best;
        workgroupBarrier();
        if lane == 0u {
            for (var i = 1u; i < WORKGROUP; i++) {
                if sums[i].x > best.x {
                    best = sums[i];
                }
            }
            best_power = best.x;
            if best.x > 0.0 {
                let index = u32(best.y);
                cells[index].flags.x = 1.0;
                let cell = cells[index];
                textureStore(tables, vec2u(chosen, ROW_SOURCE_AXIS), cell.axis);
                textureStore(tables, vec2u(chosen, ROW_SOURCE_POWER), vec4f(cell.excess.rgb, cell.square.x));
                textureStore(tables, vec2u(chosen, ROW_SOURCE_KIND), vec4f(1.0 - cell.flags.y, 0.0, 0.0, 0.0));
                chosen += 1u;
            }
        }
        storageBarrier();
        if workgroupUniformLoad(&best_power) <= 0.0 {
            break;
        }
    }
    if lane == 0u {
        textureStore(tables, vec2u(SUMMARY, ROW_HARMONICS),
            vec4f(f32(chosen), summary.constant, summary.mean_luminance, summary.threshold));
    }
}

@compute @workgroup_size(8, 8)
fn residual(@builtin(global_invocation_id) texel: vec3u) {
    let size = textureDimensions(map);
    if any(texel.xy >= size) {
        return;
    }
    var radiance = radiance_at(texel.xy);
    let flags = cells[cell_of(texel.xy, size)].flags;
    if flags.x > 0.0 && flags.y > 0.0 {
        radiance -= excess_of(radiance);
    }
    radiance = min(radiance, vec3f(SHEEN_HALF_MAX));
    textureStore(residual_map, texel.xy, vec4f(radiance, luminance_of(radiance)));
}
