// Shadow map pass: which share of each of four lights reaches a surface past the others. Drawn over
// every visible surface; multiplied into the visibility that is there.

struct ShadowLight {
    // Middle of the scene; the place of a spot light.
    center_world: vec3f,
    // 1 for a spot light, 2 for a light that casts no shadow.
    kind: u32,
    // Axes of its view; the last points towards the light, or against a spot's axis.
    right_world: vec3f,
    // Metres from the middle of the map to its sides; for a spot light its angle's tangent.
    half_extent: f32,
    up_world: vec3f,
    // Metres between depth 0 and 1; the near plane of a spot light, whose depth is that over the
    // distance. Depth is larger nearer to the light.
    depth_m: f32,
    towards_world: vec3f,
    // Of the light's angular radius.
    tan_radius: f32,
    // Its first texel in the atlas.
    corner: vec2u,
    unused_0: u32,
    unused_1: u32,
}

struct Shadows {
    lights: array<ShadowLight, 4>,
    // Texels a side of each light's map.
    size: f32,
    // Texels of a height map within which its own bumps are not casters here.
    own_radius_texels: f32,
    unused_0: f32,
    unused_1: f32,
}

@group(1) @binding(0) var<uniform> shadows: Shadows;
@group(1) @binding(1) var caster_depth: texture_2d<f32>;
@group(1) @binding(2) var caster_id: texture_2d<u32>;
@group(2) @binding(0) var<uniform> relief: CompositorRelief;
@group(2) @binding(1) var heights: texture_2d<f32>;

const SHADOW_SPOT: u32 = 1u;
const CASTS_NONE: u32 = 2u;

// How far a receiver is lifted off its plane, in texels of the shadow map: more where the lit side
// itself is a caster.
override lift_texels: f32 = 0.1;

// The widest half-width of a filter in texels, and its most taps from the middle to one side.
const WIDEST_TEXELS: f32 = 8.0;
const TAPS: f32 = 3.0;

struct Receiver {
    position_world: vec3f,
    // Normal of the plane in which it lies, on either side.
    plane_normal: vec3f,
    // Number of its instance where that has a height map, else 0.
    own_id: u32,
}

// Metres between two depths.
fn depth_difference_m(light: ShadowLight, nearer: f32, farther: f32) -> f32 {
    if light.kind == SHADOW_SPOT {
        return light.depth_m / max(farther, 1e-30) - light.depth_m / max(nearer, 1e-30);
    }
    return (nearer - farther) * light.depth_m;
}

// The lit share. Casters of the receiver's own instance within `own_m` do not count.
fn light_visibility(index: u32, receiver: Receiver, own_m: f32) -> f32 {
    let light = shadows.lights[index];
    if light.kind == CASTS_NONE {
        return 1.0;
    }
    let n = receiver.plane_normal;
    var q = receiver.position_world - light.center_world;
    let is_spot = light.kind == SHADOW_SPOT;
    var to_light = select(light.towards_world, -q, is_spot);
    var texel_m = 2.0 * light.half_extent / shadows.size;
    if is_spot {
        texel_m *= max(dot(-q, light.towards_world), 0.0);
    }
    q += n * (select(-1.0, 1.0, dot(n, to_light) >= 0.0) * lift_texels * texel_m);

    let across = vec2f(dot(q, light.right_world), dot(q, light.up_world)) / light.half_extent;
    let n_across = vec2f(dot(n, light.right_world), dot(n, light.up_world));
    let distance_m = -dot(q, light.towards_world);
    var ndc = vec3f(across, 0.5 - distance_m / light.depth_m);
    // How the depth of the receiver's plane changes across the map.
    let n_towards = dot(n, light.towards_world);
    var slope = -0.5 * n_across / select(min(n_towards, -1e-4), max(n_towards, 1e-4), n_towards >= 0.0);
    var steepest = 10.0;
    if is_spot {
        if distance_m <= light.depth_m {
            return 1.0;
        }
        ndc = vec3f(across / distance_m, light.depth_m / distance_m);
        let plane = dot(n, q);
        slope = light.depth_m * light.half_extent * n_across
            / select(min(plane, -1e-6 * distance_m), max(plane, 1e-6 * distance_m), plane >= 0.0);
        steepest = 20.0 * ndc.z * light.half_extent;
    }
    if any(abs(ndc.xy) >= vec2f(1.0)) {
        return 1.0;
    }
    slope *= min(1.0, steepest / max(length(slope), 1e-20));
    let slope_per_texel = slope * vec2f(2.0, -2.0) / shadows.size;
    let at = compositor_texels(ndc.xy);

    // First a few taps tell how far the casters are, then a filter as wide as their penumbra.
    var widest = WIDEST_TEXELS;
    if !is_spot {
        widest = light.tan_radius * (1.0 - ndc.z) * light.depth_m / texel_m;
    }
    var radius = clamp(select(widest, 1.0, is_spot), 1.0, WIDEST_TEXELS);
    var stride = 0.5 * radius;
    var taps = 5u;
    var lit = 1.0;
    for (var search = true; ; search = false) {
        var weights = 0.0;
        var blocked = 0.0;
        var distances_m = 0.0;
        for (var tap = 0u; tap < taps * taps; tap++) {
            let offset = (vec2f(f32(tap % taps), f32(tap / taps)) - 0.5 * f32(taps - 1u)) * stride;
            let texel = clamp(floor(at + offset), vec2f(0.0), vec2f(shadows.size - 1.0));
            let from_middle = texel + 0.5 - at;
            let across_filter = saturate((vec2f(radius) - abs(from_middle)) / stride + 0.5);
            let weight = select(across_filter.x * across_filter.y, 1.0, search);
            let in_atlas = vec2u(texel) + light.corner;
            let depth = textureLoad(caster_depth, in_atlas, 0).x;
            if depth > ndc.z + dot(from_middle, slope_per_texel) {
                let nearer_m = depth_difference_m(light, depth, ndc.z);
                var counts = true;
                if receiver.own_id != 0u && nearer_m < own_m {
                    counts = textureLoad(caster_id, in_atlas, 0).x != receiver.own_id;
                }
                blocked += select(0.0, weight, counts);
                distances_m += select(0.0, weight * nearer_m, counts);
            }
            weights += weight;
        }
        lit = 1.0 - blocked / max(weights, 1e-6);
        if !search || blocked == 0.0 || blocked == weights {
            break;
        }
        let penumbra = light.tan_radius * (distances_m / blocked) / texel_m;
        radius = clamp(penumbra, 0.5, WIDEST_TEXELS);
        stride = max(1.0, radius / TAPS);
        taps = 2u * u32(ceil(radius / stride + 0.5)) + 1u;
    }
    return lit;
}

// Texels from the corner of a light's map.
fn compositor_texels(ndc: vec2f) -> vec2f {
    return vec2f(ndc.x * 0.5 + 0.5, 0.5 - ndc.y * 0.5) * shadows.size;
}

// The normal of the triangle, without regard to its side.
fn plane_normal(position_world: vec3f, normal_world: vec3f) -> vec3f {
    let across = cross(dpdx(position_world), dpdy(position_world));
    let scale = max(max(abs(across.x), abs(across.y)), abs(across.z));
    let normal = sheen_normalize_or(normal_world, vec3f(0.0, 1.0, 0.0));
    return sheen_normalize_or(across / max(scale, 1e-38), normal);
}

@fragment
fn shadow_fragment(in: VertexOut) -> @location(0) vec4f {
    let receiver = Receiver(in.position_world, plane_normal(in.position_world, in.normal_world), 0u);
    var visibility = vec4f(1.0);
    for (var index = 0u; index < 4u; index++) {
        visibility[index] = light_visibility(index, receiver, 0.0);
    }
    return visibility;
}

// Length of a ray towards the light along which the horizon map knows the bumps.
fn own_m(in: ReliefOut, normal: vec3f, index: u32) -> f32 {
    let light = shadows.lights[index];
    let to_light = select(
        light.towards_world, light.center_world - in.position_world, light.kind == SHADOW_SPOT);
    let l = sheen_normalize_or(to_light, normal);
    let p_u = in.along_u_world / relief.uv_scale.x;
    let p_v = in.along_v_world / relief.uv_scale.y;
    let u = p_u - normal * dot(p_u, normal);
    let v = p_v - normal * dot(p_v, normal);
    let e = dot(u, u);
    let f = dot(u, v);
    let g = dot(v, v);
    let det = max(e * g - f * f, 1e-12 * e * g);
    let texels = relief.size * vec2f(g * dot(l, u) - f * dot(l, v), e * dot(l, v) - f * dot(l, u)) / max(det, 1e-37);
    // The map's own resolution bounds what its casters can say about the nearest bumps.
    let coarsest_m = 4.0 * light.half_extent / shadows.size;
    return max(shadows.own_radius_texels / max(length(texels), 1e-9), coarsest_m);
}

@fragment
fn shadow_relief_fragment(in: ReliefOut) -> @location(0) vec4f {
    let normal = sheen_normalize_or(in.normal_world, vec3f(0.0, 1.0, 0.0));
    let position_world = in.position_world + normal * compositor_height_m(heights, relief, in.uv);
    let receiver = Receiver(position_world, plane_normal(in.position_world, normal), in.id);
    var visibility = vec4f(1.0);
    for (var index = 0u; index < 4u; index++) {
        visibility[index] = light_visibility(index, receiver, own_m(in, normal, index));
    }
    return visibility;
}
