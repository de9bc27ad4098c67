// The usual alternative: a cube map whose levels hold the environment convolved with the lobe at
// fixed roughnesses, read between two of them. After Karis (2013, "Real shading in Unreal Engine
// 4") and Krivanek and Colbert (2008, "Real-time shading with filtered importance sampling"), with
// this technique's own lobe in place of GGX. And the other usual one: nine harmonics.

struct Prefilter {
    // Roughness of the level, and texels of the map.
    roughness: f32,
    samples: u32,
    map_size: vec2u,
}

@group(0) @binding(0) var map: texture_2d<f32>;
@group(0) @binding(1) var linear: sampler;
@group(0) @binding(2) var target_level: texture_storage_2d_array<rgba16float, write>;
@group(0) @binding(3) var<uniform> prefilter: Prefilter;
@group(0) @binding(4) var<storage, read_write> coefficients: array<vec4f, 9>;

@compute @workgroup_size(8, 8)
fn prefilter_level(@builtin(global_invocation_id) texel: vec3u) {
    let face_size = textureDimensions(target_level).x;
    if any(texel.xy >= vec2u(face_size)) {
        return;
    }
    let at = (vec2f(texel.xy) + 0.5) / f32(face_size) * 2.0 - 1.0;
    let axis = normalize(sheen_cube_direction(texel.z, at));
    let t = prefilter.roughness;
    var sum = vec3f(0.0);
    if t <= 0.0 {
        sum = textureSampleLevel(map, linear, sheen_lat_long_uv(axis), 0.0).rgb;
    } else {
        let around = sheen_frame(axis);
        let count = f32(prefilter.samples);
        // A texel at the equator; the level whose texel covers a sample's solid angle, and one
        // more, as Krivanek and Colbert advise.
        let texel_angle = SHEEN_PI / f32(prefilter.map_size.y);
        for (var i = 0u; i < prefilter.samples; i++) {
            let xi = (f32(i) + 0.5) / count;
            let theta = t * acos(sqrt(1.0 - xi));
            let direction = diffuse_envmap_around(axis, around, theta, 2.0 * SHEEN_PI * fract(f32(i) * 0.6180339887));
            let solid_angle = 1.0 / (count * max(diffuse_envmap_density(t, theta), 1e-4));
            let level = 0.5 * log2(solid_angle / (texel_angle * texel_angle)) + 1.0;
            let uv = sheen_lat_long_uv(direction);
            sum += textureSampleLevel(map, linear, uv, max(level, 0.0)).rgb / count;
        }
    }
    textureStore(target_level, texel.xy, texel.z, vec4f(min(sum, vec3f(SHEEN_HALF_MAX)), 1.0));
}

var<workgroup> partial: array<array<vec3f, 9>, 64>;

fn harmonic_basis(d: vec3f) -> array<f32, 9> {
    return array<f32, 9>(0.282095, 0.488603 * d.y, 0.488603 * d.z, 0.488603 * d.x, 1.092548 * d.x * d.y,
        1.092548 * d.y * d.z, 0.315392 * (3.0 * d.z * d.z - 1.0), 1.092548 * d.x * d.z,
        0.546274 * (d.x * d.x - d.y * d.y));
}

// One group for each coefficient's share would be faster; the map is summed once.
@compute @workgroup_size(64)
fn project_map(@builtin(local_invocation_index) lane: u32) {
    let size = prefilter.map_size;
    let half_step = 0.5 * SHEEN_PI / f32(size.y);
    var sum: array<vec3f, 9>;
    for (var row = lane; row < size.y; row += 64u) {
        let polar = SHEEN_PI * (f32(row) + 0.5) / f32(size.y);
        let solid_angle = 4.0 * SHEEN_PI / f32(size.x) * sin(polar) * sin(half_step);
        for (var column = 0u; column < size.x; column++) {
            let uv = (vec2f(f32(column), f32(row)) + 0.5) / vec2f(size);
            let radiance = textureLoad(map, vec2u(column, row), 0).rgb * solid_angle;
            var basis = harmonic_basis(sheen_lat_long_direction(uv));
            for (var f = 0u; f < 9u; f++) {
                sum[f] += basis[f] * radiance;
            }
        }
    }
    partial[lane] = sum;
    workgroupBarrier();
    if lane < 9u {
        var total = vec3f(0.0);
        for (var i = 0u; i < 64u; i++) {
            total += partial[i][lane];
        }
        coefficients[lane] = vec4f(total, 0.0);
    }
}
