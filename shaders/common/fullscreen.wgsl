// A triangle that covers the target; draw three vertices without buffers.

struct SheenFullscreen {
    @builtin(position) position: vec4f,
    // (0, 0) at the top left of the target, (1, 1) at the bottom right.
    @location(0) uv: vec2f,
}

@vertex
fn fullscreen(@builtin(vertex_index) index: u32) -> SheenFullscreen {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return SheenFullscreen(vec4f(corner.x * 2.0 - 1.0, 1.0 - corner.y * 2.0, 0.0, 1.0), corner);
}
