// The vertex stage of the passes that draw surfaces with a height map.

struct FrameIn {
    // Change of the position along u and v of the mesh, metres per unit.
    @location(10) along_u_local: vec3f,
    @location(11) along_v_local: vec3f,
}

struct ReliefOut {
    @builtin(position) @invariant position: vec4f,
    @location(0) position_world: vec3f,
    @location(1) normal_world: vec3f,
    @location(2) tangent_world: vec4f,
    @location(3) uv: vec2f,
    @location(4) along_u_world: vec3f,
    @location(5) along_v_world: vec3f,
    @location(6) @interpolate(flat) id: u32,
}

@vertex
fn relief_vertex(in: VertexIn, frame: FrameIn) -> ReliefOut {
    let base = placed(in);
    return ReliefOut(base.position, base.position_world, base.normal_world, base.tangent_world, base.uv,
        vector_world(in, frame.along_u_local), vector_world(in, frame.along_v_local),
        u32(in.world_from_normal_1.w));
}

fn vertex_out(in: ReliefOut) -> VertexOut {
    return VertexOut(in.position, in.position_world, in.normal_world, in.tangent_world, in.uv);
}
