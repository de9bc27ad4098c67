// Coat environment pass: the environment's reflection in clear coats, by diffuse-envmap's library.

@group(0) @binding(0) var<uniform> parameters: DiffuseEnvmapParameters;
@group(0) @binding(1) var environment_map: texture_2d<f32>;
@group(0) @binding(2) var environment_residual: texture_2d<f32>;
@group(0) @binding(3) var environment_chain: texture_cube<f32>;
@group(0) @binding(4) var environment_tables: texture_2d<f32>;
@group(0) @binding(5) var environment_sampler: sampler;
@group(1) @binding(0) var<uniform> view: CompositorView;
@group(2) @binding(0) var depth_texture: texture_2d<f32>;
@group(2) @binding(1) var normal_roughness_texture: texture_2d<f32>;
@group(2) @binding(2) var strength_texture: texture_2d<f32>;

@fragment
fn coat_environment_fragment(in: SheenFullscreen) -> @location(0) vec4f {
    let pixel = vec2u(in.position.xy);
    let depth = textureLoad(depth_texture, pixel, 0).x;
    let strength = textureLoad(strength_texture, pixel, 0).r;
    if strength <= 0.0 || depth <= 0.0 {
        discard;
    }
    let normal_roughness = textureLoad(normal_roughness_texture, pixel, 0);
    let ray = compositor_ray_world(view.world_from_clip, in.uv);
    let position_world = view.eye_world + ray * (view.near_m / depth);
    let view_world = sheen_normalize_or(ray, vec3f(0.0, 0.0, -1.0));
    let normal_world = sheen_normalize_or(normal_roughness.xyz, -view_world);
    let n_v = clamp(-dot(normal_world, view_world), 0.0, 1.0);
    let reflectance =
        diffuse_envmap_specular_reflectance(vec3f(COMPOSITOR_COAT_KS), normal_roughness.w, n_v);
    let radiance = diffuse_envmap_radiance(environment_map, environment_residual, environment_chain,
        environment_tables, environment_sampler, parameters, normal_world, view_world, position_world, normal_roughness.w, pixel);
    return vec4f(min(strength * reflectance * radiance, vec3f(COMPOSITOR_RADIANCE_MAX)), 0.0);
}
