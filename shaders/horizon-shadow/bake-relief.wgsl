// Brings the heights of some rows into texels above the least.

@group(1) @binding(0) var heights: texture_2d<f32>;

@compute @workgroup_size(64)
fn take_relief(@builtin(global_invocation_id) id: vec3u) {
    let texel = vec2u(id.x, bake.rows.x + id.y);
    if texel.x >= bake.size.x || texel.y >= bake.rows.y {
        return;
    }
    let raw = textureLoad(heights, texel, 0).x;
    // The bits are tested because compilers may assume that no number is NaN.
    let finite = (bitcast<u32>(raw) & 0x7f800000u) != 0x7f800000u;
    let height = clamp(select(bake.least_height, raw, finite), bake.least_height, bake.greatest_height);
    relief[texel.y * bake.size.x + texel.x] = (height - bake.least_height) * bake.texels_per_height;
}
