// Halves a texture by area: each texel of the target is the mean of the source area it covers.

@group(0) @binding(0) var source: texture_2d<f32>;

// A triangle that covers the target.
@vertex
fn mipmap_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4f(corner.x * 2.0 - 1.0, 1.0 - corner.y * 2.0, 0.0, 1.0);
}

// Weights of the source texels 2i, 2i + 1 and 2i + 2 in target texel i, along one axis.
// An odd size of 2d + 1 texels becomes d, each of which covers 2 + 1/d source texels.
fn axis_weights(i: u32, source_size: u32) -> vec3f {
    if source_size == 1u {
        return vec3f(1.0, 0.0, 0.0);
    }
    if source_size % 2u == 0u {
        return vec3f(0.5, 0.5, 0.0);
    }
    let target_size = source_size / 2u;
    return vec3f(f32(target_size - i), f32(target_size), f32(i + 1u)) / f32(source_size);
}

@fragment
fn mipmap_halve(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let size = textureDimensions(source);
    let texel = vec2u(position.xy);
    let weights_x = axis_weights(texel.x, size.x);
    let weights_y = axis_weights(texel.y, size.y);
    var sum = vec4f(0.0);
    for (var y = 0u; y < 3u; y += 1u) {
        for (var x = 0u; x < 3u; x += 1u) {
            let weight = weights_x[x] * weights_y[y];
            // A texel of weight 0 may lie outside, and infinity times 0 is not a number.
            if weight > 0.0 {
                sum += weight * textureLoad(source, 2u * texel + vec2u(x, y), 0);
            }
        }
    }
    return sum;
}
