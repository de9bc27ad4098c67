// Projects one level of the chain on the spherical harmonics of bands 0, 1, 2 and 4. (The cosine
// lobe has no band 3.)
//
// The tables receive coefficients with the basis functions' constants multiplied in, so that a
// lookup is a polynomial of the direction: the mean, then the factors of y, z, x, xy, yz,
// 3z^2 - 1, xz, x^2 - y^2; after the summary, those of band 4 in the order of `basis`.

@group(0) @binding(0) var level: texture_cube<f32>;
@group(0) @binding(1) var tables: texture_storage_2d<rgba32float, write>;
@group(0) @binding(2) var linear: sampler;

const WORKGROUP: u32 = 32u;
const FUNCTIONS: u32 = 18u;
// Texel of the first function of band 4.
const BAND_4: u32 = 10u;
const ROW_HARMONICS: u32 = 2u;
const SIGMA_TEXELS: f32 = 1.0;

var<workgroup> sums: array<array<vec3f, FUNCTIONS>, WORKGROUP>;
var<workgroup> weights: array<f32, WORKGROUP>;

// The basis polynomials, and one over their mean squares on the sphere.
fn basis(d: vec3f) -> array<f32, FUNCTIONS> {
    let s = d * d;
    return array<f32, FUNCTIONS>(
        1.0, d.y, d.z, d.x, d.x * d.y, d.y * d.z, 3.0 * s.z - 1.0, d.x * d.z, s.x - s.y,
        d.x * d.y * (s.x - s.y), d.y * d.z * (3.0 * s.x - s.y), d.x * d.y * (7.0 * s.z - 1.0),
        d.y * d.z * (7.0 * s.z - 3.0), (35.0 * s.z - 30.0) * s.z + 3.0, d.x * d.z * (7.0 * s.z - 3.0),
        (s.x - s.y) * (7.0 * s.z - 1.0), d.x * d.z * (s.x - 3.0 * s.y),
        s.x * (s.x - 3.0 * s.y) - s.y * (3.0 * s.x - s.y),
    );
}

const NORMS = array<f32, FUNCTIONS>(
    1.0, 3.0, 3.0, 3.0, 15.0, 15.0, 1.25, 15.0, 3.75,
    78.75, 39.375, 11.25, 5.625, 0.140625, 5.625, 2.8125, 39.375, 4.921875,
);

@compute @workgroup_size(32)
fn project(@builtin(local_invocation_index) lane: u32) {
    let face_size = textureDimensions(level).x;
    var sum: array<vec3f, FUNCTIONS>;
    var total = 0.0;
    for (var i = lane; i < 6u * face_size * face_size; i += WORKGROUP) {
        let face = i / (face_size * face_size);
        let texel = vec2u(i % face_size, (i / face_size) % face_size);
        let at = (vec2f(texel) + 0.5) / f32(face_size) * 2.0 - 1.0;
        let direction = sheen_cube_direction(face, at);
        let squared = dot(direction, direction);
        let weight = inverseSqrt(squared) / squared;
        let d = direction * inverseSqrt(squared);
        // At a texel's middle, where the filter returns the texel itself.
        let radiance = weight * textureSampleLevel(level, linear, d, 0.0).rgb;
        total += weight;
        var values = basis(d);
        for (var f = 0u; f < FUNCTIONS; f++) {
            sum[f] += radiance * values[f];
        }
    }
    sums[lane] = sum;
    weights[lane] = total;
    workgroupBarrier();
    if lane < FUNCTIONS {
        var coefficient = vec3f(0.0);
        var all_weights = 0.0;
        for (var i = 0u; i < WORKGROUP; i++) {
            coefficient += sums[i][lane];
            all_weights += weights[i];
        }
        // The level is blurred already: undo its Gaussian in band l.
        var norms = NORMS;
        let band = select(select(select(4.0, 2.0, lane < 9u), 1.0, lane < 4u), 0.0, lane == 0u);
        let sigma = SIGMA_TEXELS * 2.0 / f32(face_size);
        let sharpen = exp(0.5 * band * (band + 1.0) * sigma * sigma);
        let texel = select(lane + BAND_4 - 9u, lane, lane < 9u);
        textureStore(tables, vec2u(texel, ROW_HARMONICS),
            vec4f(coefficient / all_weights * norms[lane] * sharpen, 0.0));
    }
}
