// Lights besides the environment, and what of them arrives at a point.

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

// Whether there is a visibility buffer, whose channel i is the visible share of light i.
override is_shadowed: bool = false;

fn visible_share(visibility: texture_2d<f32>, pixel: vec2i) -> vec4f {
    if is_shadowed {
        return textureLoad(visibility, pixel, 0);
    }
    return vec4f(1.0);
}

// Of a light: those beyond the fourth shine through everything.
fn share_of(visible: vec4f, light: u32) -> f32 {
    return select(1.0, visible[min(light, 3u)], light < 4u);
}
