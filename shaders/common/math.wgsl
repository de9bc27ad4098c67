// Constants and numerically careful helpers shared by all techniques.

const SHEEN_PI: f32 = 3.14159265358979;
// The largest finite half float, and the largest radiance that a texture of full floats may hold.
const SHEEN_HALF_MAX: f32 = 65504.0;
const SHEEN_RADIANCE_MAX: f32 = 1e9;

// The unit vector along v, or `fallback` where v is too short (or not a number) to have one.
fn sheen_normalize_or(v: vec3f, fallback: vec3f) -> vec3f {
    let squared = dot(v, v);
    // NaN compares false, so it takes the fallback too.
    if squared > 1e-20 && squared < 1e30 {
        return v * inverseSqrt(squared);
    }
    return fallback;
}

// acos for arguments that rounding may have pushed past 1. Adapters' own acos and asin may be off
// by 2e-4; atan2 is not.
fn sheen_acos(x: f32) -> f32 {
    let bounded = clamp(x, -1.0, 1.0);
    return atan2(sqrt((1.0 - bounded) * (1.0 + bounded)), bounded);
}

// Angle between two unit vectors, accurate for all angles (Kahan 2006); acos(dot) loses half its
// digits for small ones.
fn sheen_angle(a: vec3f, b: vec3f) -> f32 {
    return 2.0 * atan2(length(a - b), length(a + b));
}

// Two unit vectors that complete the unit vector z to a right-handed frame (Duff et al. 2017).
struct SheenFrame {
    x: vec3f,
    y: vec3f,
}

fn sheen_frame(z: vec3f) -> SheenFrame {
    let s = select(-1.0, 1.0, z.z >= 0.0);
    let a = -1.0 / (s + z.z);
    let b = z.x * z.y * a;
    return SheenFrame(
        vec3f(1.0 + s * z.x * z.x * a, s * b, -s * z.x),
        vec3f(b, s + z.y * z.y * a, -z.y),
    );
}

// Texture coordinates of a unit direction in a latitude-longitude map:
// u = 0.5 + atan2(z, x) / 2 pi, v = acos(y) / pi. At the poles u is 0.5.
fn sheen_lat_long_uv(direction: vec3f) -> vec2f {
    // atan2(0, 0) is undefined in WGSL.
    let at_pole = abs(direction.x) + abs(direction.z) < 1e-18;
    let longitude = atan2(direction.z, select(direction.x, 1.0, at_pole));
    // acos(y), with all digits near the poles too.
    let polar = atan2(length(direction.xz), direction.y);
    return vec2f(0.5 + longitude / (2.0 * SHEEN_PI), polar / SHEEN_PI);
}

// The unit direction of lat-long texture coordinates.
fn sheen_lat_long_direction(uv: vec2f) -> vec3f {
    let longitude = (uv.x - 0.5) * 2.0 * SHEEN_PI;
    let polar = uv.y * SHEEN_PI;
    return vec3f(sin(polar) * cos(longitude), cos(polar), sin(polar) * sin(longitude));
}

// The direction of a point of a cube face, with both coordinates in -1..1 (not normalised).
fn sheen_cube_direction(face: u32, at: vec2f) -> vec3f {
    switch face {
        case 0u: { return vec3f(1.0, -at.y, -at.x); }
        case 1u: { return vec3f(-1.0, -at.y, at.x); }
        case 2u: { return vec3f(at.x, 1.0, at.y); }
        case 3u: { return vec3f(at.x, -1.0, -at.y); }
        case 4u: { return vec3f(at.x, -at.y, 1.0); }
        default: { return vec3f(-at.x, -at.y, -1.0); }
    }
}
