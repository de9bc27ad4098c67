// Coat layer pass: what a clear coat keeps from the base below it (as alpha, by which the HDR image
// is multiplied), and the lights' highlights in the coat.

@group(0) @binding(0) var<uniform> view: CompositorView;
@group(0) @binding(1) var<storage, read> lights: array<Light>;
@group(0) @binding(2) var visibility_texture: texture_2d<f32>;
@group(1) @binding(0) var depth_texture: texture_2d<f32>;
@group(1) @binding(1) var normal_roughness_texture: texture_2d<f32>;
@group(1) @binding(2) var strength_texture: texture_2d<f32>;

@fragment
fn coat_layer_fragment(in: SheenFullscreen) -> @location(0) vec4f {
    let pixel = vec2i(in.position.xy);
    let depth = textureLoad(depth_texture, pixel, 0).x;
    let strength = textureLoad(strength_texture, pixel, 0).r;
    if strength <= 0.0 || depth <= 0.0 {
        discard;
    }
    let normal_roughness = textureLoad(normal_roughness_texture, pixel, 0);
    let ray = compositor_ray_world(view.world_from_clip, in.uv);
    let position_world = view.eye_world + ray * (view.near_m / depth);
    let v = sheen_normalize_or(-ray, vec3f(0.0, 0.0, 1.0));
    let n = sheen_normalize_or(normal_roughness.xyz, v);
    let n_v = max(dot(n, v), 1e-4);
    let alpha = max(normal_roughness.w * normal_roughness.w, MIN_ALPHA);

    let visible = visible_share(visibility_texture, pixel);
    var radiance = vec3f(0.0);
    for (var i = 0u; i < arrayLength(&lights); i++) {
        let light = incident(lights[i], position_world);
        let n_l = dot(n, light.direction_world);
        if n_l > 0.0 {
            let h = sheen_normalize_or(light.direction_world + v, n);
            let specular = compositor_fresnel(vec3f(COMPOSITOR_COAT_KS), dot(v, h))
                * compositor_ggx(alpha, n_l, n_v, cross(n, h), max(dot(n, h), 0.0));
            radiance += strength * specular * light.irradiance * (n_l * share_of(visible, i));
        }
    }
    let reflectance =
        diffuse_envmap_specular_reflectance(vec3f(COMPOSITOR_COAT_KS), normal_roughness.w, n_v).r;
    return vec4f(min(radiance, vec3f(COMPOSITOR_RADIANCE_MAX)), 1.0 - strength * reflectance);
}
