// Direct light pass: every light's Lambert and GGX reflection, summed per pixel of the surface
// buffer and added to the HDR image.

@group(0) @binding(0) var<uniform> view: CompositorView;
@group(0) @binding(1) var<storage, read> lights: array<Light>;
@group(1) @binding(0) var depth_texture: texture_2d<f32>;
@group(1) @binding(1) var normal_roughness_texture: texture_2d<f32>;
@group(1) @binding(2) var specular_texture: texture_2d<f32>;
@group(1) @binding(3) var albedo_texture: texture_2d<f32>;
@group(1) @binding(4) var visibility_texture: texture_2d<f32>;

@fragment
fn direct_light_fragment(in: SheenFullscreen) -> @location(0) vec4f {
    let pixel = vec2i(in.position.xy);
    let depth = textureLoad(depth_texture, pixel, 0).x;
    if depth <= 0.0 {
        discard;
    }
    let normal_roughness = textureLoad(normal_roughness_texture, pixel, 0);
    let ks = textureLoad(specular_texture, pixel, 0).rgb;
    let diffuse = textureLoad(albedo_texture, pixel, 0).rgb / SHEEN_PI;
    let ray = compositor_ray_world(view.world_from_clip, in.uv);
    let position_world = view.eye_world + ray * (view.near_m / depth);
    let v = sheen_normalize_or(-ray, vec3f(0.0, 0.0, 1.0));
    let n = sheen_normalize_or(normal_roughness.xyz, v);
    let alpha = max(normal_roughness.w * normal_roughness.w, MIN_ALPHA);
    let n_v = max(dot(n, v), 1e-4);

    let visible = visible_share(visibility_texture, pixel);
    var radiance = vec3f(0.0);
    for (var i = 0u; i < arrayLength(&lights); i++) {
        let light = incident(lights[i], position_world);
        let l = light.direction_world;
        let n_l = dot(n, l);
        if n_l > 0.0 {
            let h = sheen_normalize_or(l + v, n);
            let fresnel = compositor_fresnel(ks, dot(v, h));
            let specular = fresnel * compositor_ggx(alpha, n_l, n_v, cross(n, h), max(dot(n, h), 0.0));
            // What the specular lobe reflects does not reach the diffuse one.
            let transmitted = 1.0 - max(fresnel.r, max(fresnel.g, fresnel.b));
            radiance += (diffuse * transmitted + specular) * light.irradiance * (n_l * share_of(visible, i));
        }
    }
    return vec4f(min(radiance, vec3f(COMPOSITOR_RADIANCE_MAX)), 0.0);
}
