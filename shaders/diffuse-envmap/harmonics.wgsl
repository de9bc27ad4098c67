// Projects one level of the chain on the nine spherical harmonics of bands 0 to 2.
//
// The tables receive coefficients with the basis functions' constants multiplied in, so that a
// lookup is a polynomial of the direction: the mean, then the factors of y, z, x, xy, yz,
// 3z^2 - 1, xz, x^2 - y^2.

@group(0) @binding(0) var level: texture_cube<f32>;
@group(0) @binding(1) var tables: texture_storage_2d<rgba32float, write>;
@group(0) @binding(2) var linear: sampler;

const WORKGROUP: u32 = 64u;
const ROW_HARMONICS: u32 = 2u;
const SIGMA_TEXELS: f32 = 1.0;

var<workgroup> sums: array<array<vec3f, 9>, WORKGROUP>;
var<workgroup> weights: array<f32, WORKGROUP>;

fn face_direction(face: u32, at: vec2f) -> vec3f {
    switch face {
        case 0u: { return vec3f(1.0, -at.y, -at.x); }
        case 1u: { return vec3f(-1.0, -at.y, at.x); }
        case 2u: { return vec3f(at.x, 1.0, at.y); }
        case 3u: { return vec3f(at.x, -1.0, -at.y); }
        case 4u: { return vec3f(at.x, -at.y, 1.0); }
        default: { return vec3f(-at.x, -at.y, -1.0); }
    }
}

@compute @workgroup_size(64)
fn project(@builtin(local_invocation_index) lane: u32) {
    let face_size = textureDimensions(level).x;
    var sum: array<vec3f, 9>;
    var total = 0.0;
    for (var i = lane; i < 6u * face_size * face_size; i += WORKGROUP) {
        let face = i / (face_size * face_size);
        let texel = vec2u(i % face_size, (i / face_size) % face_size);
        let at = (vec2f(texel) + 0.5) / f32(face_size) * 2.0 - 1.0;
        let direction = face_direction(face, at);
        let squared = dot(direction, direction);
        let weight = inverseSqrt(squared) / squared;
        let d = direction * inverseSqrt(squared);
        // At a texel's middle, where the filter returns the texel itself.
        let radiance = weight * textureSampleLevel(level, linear, d, 0.0).rgb;
        total += weight;
        sum[0] += radiance;
        sum[1] += radiance * d.y;
        sum[2] += radiance * d.z;
        sum[3] += radiance * d.x;
        sum[4] += radiance * d.x * d.y;
        sum[5] += radiance * d.y * d.z;
        sum[6] += radiance * (3.0 * d.z * d.z - 1.0);
        sum[7] += radiance * d.x * d.z;
        sum[8] += radiance * (d.x * d.x - d.y * d.y);
    }
    sums[lane] = sum;
    weights[lane] = total;
    workgroupBarrier();
    if lane < 9u {
        var coefficient = vec3f(0.0);
        var all_weights = 0.0;
        for (var i = 0u; i < WORKGROUP; i++) {
            coefficient += sums[i][lane];
            all_weights += weights[i];
        }
        // Squared norms of the basis polynomials over the mean on the sphere: 1; 1/3; 1/15,
        // 1/15, 4/5, 1/15, 4/15.
        var norm = array<f32, 9>(1.0, 3.0, 3.0, 3.0, 15.0, 15.0, 1.25, 15.0, 3.75);
        // The level is blurred already: undo its Gaussian in band l.
        let band = select(select(2.0, 1.0, lane < 4u), 0.0, lane == 0u);
        let sigma = SIGMA_TEXELS * 2.0 / f32(face_size);
        let sharpen = exp(0.5 * band * (band + 1.0) * sigma * sigma);
        textureStore(tables, vec2u(lane, ROW_HARMONICS),
            vec4f(coefficient / all_weights * norm[lane] * sharpen, 0.0));
    }
}
