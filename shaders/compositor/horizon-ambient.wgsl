// Ambient occlusion of height maps: the open share of the sky to the surface buffer's occlusion, and
// its direction to the normals of diffuse light.

@group(1) @binding(0) var<uniform> parameters: HorizonShadowParameters;
@group(1) @binding(6) var ambient: texture_2d_array<f32>;
@group(1) @binding(7) var linear_sampler: sampler;

struct AmbientOut {
    @builtin(position) @invariant position: vec4f,
    @location(0) position_world: vec3f,
    @location(1) normal_world: vec3f,
    @location(2) uv: vec2f,
    @location(3) along_u_world: vec3f,
    @location(4) along_v_world: vec3f,
    @location(5) second_form: vec3f,
}

struct OpenOut {
    // Multiplied into the last channel of the albedo.
    @location(0) occlusion: vec4f,
    @location(1) normal_roughness: vec4f,
}

@vertex
fn horizon_ambient_vertex(in: VertexIn, frame: FrameIn, @location(12) second_form: vec3f) -> AmbientOut {
    let base = placed(in);
    // |M^-T n|, by which the form becomes the world's: the change of areas over that of lengths along
    // the normal.
    let n = sheen_normalize_or(in.normal_local, vec3f(0.0, 1.0, 0.0));
    let stretch = dot(vector_world(in, n), base.normal_world);
    return AmbientOut(base.position, base.position_world, base.normal_world, base.uv,
        vector_world(in, frame.along_u_local), vector_world(in, frame.along_v_local), second_form * stretch);
}

@fragment
fn horizon_ambient_fragment(in: AmbientOut, @builtin(front_facing) front_facing: bool) -> OpenOut {
    var surface: HorizonShadowSurface;
    surface.uv = in.uv;
    surface.uv_dx = dpdx(in.uv);
    surface.uv_dy = dpdy(in.uv);
    surface.normal_world = sheen_normalize_or(in.normal_world, vec3f(0.0, 1.0, 0.0));
    surface.along_u_world = in.along_u_world;
    surface.along_v_world = in.along_v_world;
    surface.second_form = in.second_form;
    let open = horizon_shadow_ambient(ambient, linear_sampler, parameters, surface);
    // The back shows the relief from behind, of which the tables know nothing.
    if !front_facing {
        return OpenOut(vec4f(1.0), vec4f(-surface.normal_world, 1.0));
    }
    return OpenOut(vec4f(open.w), vec4f(open.xyz, 1.0));
}
