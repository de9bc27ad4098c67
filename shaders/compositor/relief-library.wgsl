// Height maps on surfaces: heights, and the bump-mapped normal. Maps repeat; heights are bilinear
// between texel centres.

struct CompositorRelief {
    // Texels of the height map.
    size: vec2f,
    // How often the map repeats over 0..1 of the mesh's uv; not 0.
    uv_scale: vec2f,
    // Metres between the map's 0 and 1.
    height_scale_m: f32,
    unused_0: f32,
    unused_1: f32,
    unused_2: f32,
}

// Metres above the base surface at texture coordinates of the mesh.
fn compositor_height_m(heights: texture_2d<f32>, relief: CompositorRelief, uv: vec2f) -> f32 {
    let at = fract(uv * relief.uv_scale) * relief.size - 0.5;
    let corner = floor(at);
    let weight = at - corner;
    let size = vec2i(relief.size);
    // fract leaves at most one texel beyond each border.
    var low = vec2i(corner);
    low = select(low, low + size, low < vec2i(0));
    var high = low + 1;
    high = select(high, high - size, high >= size);
    let upper = mix(textureLoad(heights, low, 0).r, textureLoad(heights, vec2i(high.x, low.y), 0).r, weight.x);
    let lower = mix(textureLoad(heights, vec2i(low.x, high.y), 0).r, textureLoad(heights, high, 0).r, weight.x);
    return mix(upper, lower, weight.y) * relief.height_scale_m;
}

// The unit normal of the relief (Blinn 1978) on a surface with this unit normal and these changes of
// position along u and v of the mesh. Slopes are taken over `span_texels`, at least one: where a
// pixel covers more, the mean slope over it is what can be seen.
fn compositor_height_normal(
    heights: texture_2d<f32>,
    relief: CompositorRelief,
    uv: vec2f,
    span_texels: f32,
    normal: vec3f,
    along_u: vec3f,
    along_v: vec3f,
) -> vec3f {
    let span = clamp(span_texels, 1.0, 64.0) / (relief.size * relief.uv_scale);
    let to_u = vec2f(0.5 * span.x, 0.0);
    let to_v = vec2f(0.0, 0.5 * span.y);
    let slope = vec2f(
        compositor_height_m(heights, relief, uv + to_u) - compositor_height_m(heights, relief, uv - to_u),
        compositor_height_m(heights, relief, uv + to_v) - compositor_height_m(heights, relief, uv - to_v),
    ) / span;
    let p_u = along_u - normal * dot(along_u, normal);
    let p_v = along_v - normal * dot(along_v, normal);
    let e = dot(p_u, p_u);
    let f = dot(p_u, p_v);
    let g = dot(p_v, p_v);
    let det = e * g - f * f;
    // Where u and v run along one line no slope is known.
    if !(det > 1e-12 * e * g) {
        return normal;
    }
    let gradient = (p_u * (g * slope.x - f * slope.y) + p_v * (e * slope.y - f * slope.x)) / det;
    return sheen_normalize_or(normal - gradient, normal);
}
