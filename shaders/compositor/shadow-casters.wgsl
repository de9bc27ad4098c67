// Shadow casters: depth of the scene from a light, and which instance is nearest to it. `view` is
// the light's.

struct CasterOut {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
    @location(1) @interpolate(flat) id: u32,
}

// A vertex of a mesh that is fine enough to be displaced by its height map.
struct DisplacedIn {
    @location(0) position_local: vec3f,
    @location(1) normal_local: vec3f,
    @location(2) uv: vec2f,
    // Above the base surface.
    @location(3) height_m: f32,
    @location(4) world_from_local_0: vec4f,
    @location(5) world_from_local_1: vec4f,
    @location(6) world_from_local_2: vec4f,
    @location(7) world_from_normal_0: vec4f,
    @location(8) world_from_normal_1: vec4f,
    @location(9) world_from_normal_2: vec4f,
}

@vertex
fn caster_vertex(in: VertexIn) -> CasterOut {
    return CasterOut(placed(in).position, in.uv, u32(in.world_from_normal_1.w));
}

@vertex
fn displaced_caster_vertex(in: DisplacedIn) -> CasterOut {
    let base = placed(VertexIn(in.position_local, in.normal_local, vec4f(0.0), in.uv,
        in.world_from_local_0, in.world_from_local_1, in.world_from_local_2,
        in.world_from_normal_0, in.world_from_normal_1, in.world_from_normal_2));
    let position_world = base.position_world + base.normal_world * in.height_m;
    return CasterOut(
        view.clip_from_world * vec4f(position_world, 1.0), in.uv, u32(in.world_from_normal_1.w));
}

@fragment
fn caster_fragment(in: CasterOut) -> @location(0) u32 {
    let texel = textureSample(base_color_texture, base_color_sampler, texture_uv(0u, in.uv));
    if is_absent(material.base_color.a * texel.a, vec2u(in.position.xy)) {
        discard;
    }
    return in.id;
}
