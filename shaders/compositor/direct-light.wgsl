// Direct light pass: every light's Lambert and GGX reflection, summed per pixel of the surface
// buffer and added to the HDR image. Lights cast no shadows.

struct Light {
    // Position; for a directional light the unit vector towards it.
    position_world: vec3f,
    kind: u32,
    // Irradiance of a directional light, else radiant intensity.
    power: vec3f,
    // Metres beyond which the light is not evaluated.
    range: f32,
    // Spot: the unit axis, away from the light.
    axis_world: vec3f,
    // Spot: falloff is saturate(cos_angle * spot_scale + spot_offset)^2.
    spot_scale: f32,
    spot_offset: f32,
    unused_0: f32,
    unused_1: f32,
    unused_2: f32,
}

const DIRECTIONAL: u32 = 0u;
const SPOT: u32 = 2u;

// The narrowest lobe: below it the peak of a point light's highlight exceeds a half float.
const MIN_ALPHA: f32 = 0.002;

@group(0) @binding(0) var<uniform> view: CompositorView;
@group(0) @binding(1) var<storage, read> lights: array<Light>;
@group(1) @binding(0) var depth_texture: texture_depth_2d;
@group(1) @binding(1) var normal_roughness_texture: texture_2d<f32>;
@group(1) @binding(2) var specular_texture: texture_2d<f32>;
@group(1) @binding(3) var albedo_texture: texture_2d<f32>;

struct Incident {
    direction_world: vec3f,
    // On a surface that faces the light.
    irradiance: vec3f,
}

fn incident(light: Light, position_world: vec3f) -> Incident {
    if light.kind == DIRECTIONAL {
        return Incident(light.position_world, light.power);
    }
    let to_light = light.position_world - position_world;
    let squared = max(dot(to_light, to_light), 1e-8);
    let direction = sheen_normalize_or(to_light, vec3f(0.0, 1.0, 0.0));
    var falloff = select(0.0, 1.0 / squared, squared <= light.range * light.range);
    if light.kind == SPOT {
        // KHR_lights_punctual, "Inner and Outer Cone Angles".
        let x = saturate(dot(-direction, light.axis_world) * light.spot_scale + light.spot_offset);
        falloff *= x * x;
    }
    return Incident(direction, light.power * falloff);
}

@fragment
fn direct_light_fragment(in: SheenFullscreen) -> @location(0) vec4f {
    let pixel = vec2i(in.position.xy);
    let depth = textureLoad(depth_texture, pixel, 0);
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

    var radiance = vec3f(0.0);
    for (var i = 0u; i < arrayLength(&lights); i++) {
        let light = incident(lights[i], position_world);
        let l = light.direction_world;
        let n_l = dot(n, l);
        if n_l > 0.0 {
            let h = sheen_normalize_or(l + v, n);
            let specular = compositor_fresnel(ks, dot(v, h))
                * compositor_ggx(alpha, n_l, n_v, cross(n, h), max(dot(n, h), 0.0));
            radiance += (diffuse + specular) * light.irradiance * n_l;
        }
    }
    return vec4f(min(radiance, vec3f(COMPOSITOR_RADIANCE_MAX)), 0.0);
}
