// Lights a whole surface buffer with the environment; added to the target.

@group(0) @binding(0) var<uniform> parameters: DiffuseEnvmapParameters;
@group(0) @binding(1) var environment_map: texture_2d<f32>;
@group(0) @binding(2) var environment_residual: texture_2d<f32>;
@group(0) @binding(3) var environment_chain: texture_cube<f32>;
@group(0) @binding(4) var environment_tables: texture_2d<f32>;
@group(0) @binding(5) var environment_sampler: sampler;

// The one method that a pipeline lights with: compilers leave the other out, which on software
// adapters costs as much as it does itself.
override method: u32 = DIFFUSE_ENVMAP_METHOD_SHEEN;

struct Camera {
    world_from_clip: mat4x4f,
    eye_world: vec4f,
}

@group(1) @binding(0) var<uniform> camera: Camera;
@group(1) @binding(1) var surface_depth: texture_2d<f32>;
@group(1) @binding(2) var surface_normal_roughness: texture_2d<f32>;
@group(1) @binding(3) var surface_specular: texture_2d<f32>;
@group(1) @binding(4) var surface_albedo: texture_2d<f32>;
// The normal of the diffuse light; the same as the other's where the host knows no better.
@group(1) @binding(5) var surface_diffuse_normal: texture_2d<f32>;

@fragment
fn lighting(in: SheenFullscreen) -> @location(0) vec4f {
    let pixel = vec2u(in.position.xy);
    let depth = textureLoad(surface_depth, pixel, 0).x;
    // Reverse-Z: nothing was drawn where the depth is still 0.
    if depth <= 0.0 {
        discard;
    }
    let clip = vec4f(in.uv.x * 2.0 - 1.0, 1.0 - in.uv.y * 2.0, depth, 1.0);
    let homogeneous = camera.world_from_clip * clip;
    let position_world = homogeneous.xyz / homogeneous.w;
    let view_world = sheen_normalize_or(position_world - camera.eye_world.xyz, vec3f(0.0, 0.0, -1.0));

    let normal_roughness = textureLoad(surface_normal_roughness, pixel, 0);
    let specular = textureLoad(surface_specular, pixel, 0);
    let albedo = textureLoad(surface_albedo, pixel, 0);
    let normal_world = sheen_normalize_or(normal_roughness.xyz, -view_world);
    let roughness = diffuse_envmap_roughness(normal_roughness.w + parameters.roughness_offset);

    let n_dot_v = clamp(-dot(normal_world, view_world), 0.0, 1.0);
    let diffuse_normal =
        sheen_normalize_or(textureLoad(surface_diffuse_normal, pixel, 0).xyz, normal_world);
    let reflectance = diffuse_envmap_specular_reflectance(specular.rgb, roughness, n_dot_v);
    // What the specular layer reflects does not reach the diffuse one.
    let transmitted = 1.0 - max(reflectance.r, max(reflectance.g, reflectance.b));
    let diffuse = albedo.rgb * albedo.a * transmitted;

    var settled = parameters;
    settled.method = method;
    // First the reflection, then the diffuse light: a roughness of 2 is t = 1 whatever is added.
    var radiance = vec3f(0.0);
    for (var lobe = 0u; lobe < 2u; lobe++) {
        let share = select(reflectance, diffuse, lobe == 1u);
        if all(share <= vec3f(0.0)) {
            continue;
        }
        let lobe_roughness = select(normal_roughness.w, 2.0, lobe == 1u);
        let lobe_normal = select(normal_world, diffuse_normal, lobe == 1u);
        radiance += share * diffuse_envmap_radiance(environment_map, environment_residual,
            environment_chain, environment_tables, environment_sampler, settled, lobe_normal,
            view_world, position_world, lobe_roughness, pixel);
    }
    // The target's half floats add up without reaching infinity.
    return vec4f(min(radiance, vec3f(0.25 * SHEEN_HALF_MAX)), 0.0);
}
