//! A clear sky after Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight"
//! (1999), with a sun disc and a diffuse ground. Own space: the sun stands over -X.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::Vec3;

use super::raster::mean_over_texels;
use crate::Environment;

/// Haziness: 2 is very clear, 6 hazy.
const TURBIDITY: f32 = 2.6;
const SUN_ELEVATION_RAD: f32 = 38.0 * PI / 180.0;
const SUN_AZIMUTH_RAD: f32 = 200.0 * PI / 180.0;
const SUN_ANGULAR_RADIUS_RAD: f32 = 0.53 / 2.0 * PI / 180.0;
/// Colour of the disc: sunlight that lost some blue on its way.
const SUN_RADIANCE: Vec3 = Vec3::new(1.05e5, 0.98e5, 0.85e5);
/// Radiance of one kcd/m^2 of the model. The sun above has about the ratio to it that
/// 1.5e6 kcd/m^2 have.
const RADIANCE_PER_KCD: f32 = 0.065;
const GROUND_ALBEDO: Vec3 = Vec3::new(0.24, 0.21, 0.17);

/// The whole map, rows from the top.
pub(super) fn pixels(width: u32) -> Vec<[f32; 3]> {
    let sky = Sky::new();
    let ground = ground_radiance(&sky);
    let mut pixels = mean_over_texels(width, 4, |direction| {
        if direction.y >= 0.0 { sky.radiance(direction) } else { ground_towards(direction, ground, &sky) }
    });
    add_sun(&mut pixels, width);
    pixels
}

/// Unit vector towards the middle of the sun.
fn sun_direction() -> Vec3 {
    let (sin_azimuth, cos_azimuth) = SUN_AZIMUTH_RAD.sin_cos();
    let (sin_elevation, cos_elevation) = SUN_ELEVATION_RAD.sin_cos();
    Vec3::new(cos_elevation * cos_azimuth, sin_elevation, cos_elevation * sin_azimuth)
}

/// The model's coefficients for the luminance Y and the chromaticities x and y.
struct Sky {
    perez: [[f32; 5]; 3],
    /// Zenith values over the distribution's value there.
    scale: [f32; 3],
}

impl Sky {
    fn new() -> Self {
        let t = TURBIDITY;
        let perez = [
            [
                0.1787 * t - 1.4630,
                -0.3554 * t + 0.4275,
                -0.0227 * t + 5.3251,
                0.1206 * t - 2.5771,
                -0.0670 * t + 0.3703,
            ],
            [
                -0.0193 * t - 0.2592,
                -0.0665 * t + 0.0008,
                -0.0004 * t + 0.2125,
                -0.0641 * t - 0.8989,
                -0.0033 * t + 0.0452,
            ],
            [
                -0.0167 * t - 0.2608,
                -0.0950 * t + 0.0092,
                -0.0079 * t + 0.2102,
                -0.0441 * t - 1.6537,
                -0.0109 * t + 0.0529,
            ],
        ];
        let sun_zenith = FRAC_PI_2 - SUN_ELEVATION_RAD;
        let zenith = [zenith_luminance(sun_zenith), zenith_x(sun_zenith), zenith_y(sun_zenith)];
        let scale = std::array::from_fn(|i| zenith[i] / distribution(perez[i], 1.0, sun_zenith));
        Self { perez, scale }
    }

    /// Linear Rec. 709 radiance from a direction at or above the horizon.
    fn radiance(&self, direction: Vec3) -> Vec3 {
        let from_sun = direction.dot(sun_direction()).clamp(-1.0, 1.0).acos();
        // The distribution has a pole at the horizon itself.
        let cos_zenith = direction.y.max(0.01);
        let [luminance, x, y] =
            std::array::from_fn(|i| self.scale[i] * distribution(self.perez[i], cos_zenith, from_sun));
        rgb_of_xyy(x, y, luminance * RADIANCE_PER_KCD)
    }
}

/// Perez's distribution of the zenith angle's cosine and the angle from the sun.
fn distribution([a, b, c, d, e]: [f32; 5], cos_zenith: f32, from_sun: f32) -> f32 {
    let cos_from_sun = from_sun.cos();
    (1.0 + a * (b / cos_zenith).exp()) * (1.0 + c * (d * from_sun).exp() + e * cos_from_sun * cos_from_sun)
}

/// Luminance of the zenith, kcd/m^2.
fn zenith_luminance(sun_zenith: f32) -> f32 {
    let chi = (4.0 / 9.0 - TURBIDITY / 120.0) * (PI - 2.0 * sun_zenith);
    (4.0453 * TURBIDITY - 4.9710) * chi.tan() - 0.2155 * TURBIDITY + 2.4192
}

fn zenith_x(sun_zenith: f32) -> f32 {
    zenith_chromaticity(
        sun_zenith,
        [
            [0.00166, -0.00375, 0.00209, 0.0],
            [-0.02903, 0.06377, -0.03202, 0.00394],
            [0.11693, -0.21196, 0.06052, 0.25886],
        ],
    )
}

fn zenith_y(sun_zenith: f32) -> f32 {
    zenith_chromaticity(
        sun_zenith,
        [
            [0.00275, -0.00610, 0.00317, 0.0],
            [-0.04214, 0.08970, -0.04153, 0.00516],
            [0.15346, -0.26756, 0.06670, 0.26688],
        ],
    )
}

/// A polynomial of the turbidity (rows: square, linear, constant) and the sun's zenith angle
/// (columns: cube to constant).
fn zenith_chromaticity(sun_zenith: f32, rows: [[f32; 4]; 3]) -> f32 {
    let at_sun = rows.map(|row| row.iter().fold(0.0, |sum, term| sum * sun_zenith + term));
    at_sun.iter().fold(0.0, |sum, term| sum * TURBIDITY + term)
}

/// Linear Rec. 709 of a chromaticity and a luminance.
fn rgb_of_xyy(x: f32, y: f32, luminance: f32) -> Vec3 {
    let (cie_x, cie_z) = (x / y * luminance, (1.0 - x - y) / y * luminance);
    Vec3::new(
        3.2404542 * cie_x - 1.5371385 * luminance - 0.4985314 * cie_z,
        -0.969266 * cie_x + 1.8760108 * luminance + 0.041556 * cie_z,
        0.0556434 * cie_x - 0.2040259 * luminance + 1.0572252 * cie_z,
    )
    .max(Vec3::ZERO)
}

/// What a diffuse ground under this sky and sun sends up.
fn ground_radiance(sky: &Sky) -> Vec3 {
    const STEPS: usize = 64;
    let mut from_sky = Vec3::ZERO;
    for row in 0..STEPS {
        for column in 0..STEPS {
            // Equal steps of the squared sine make all directions weigh the same.
            let sin_zenith = ((row as f32 + 0.5) / STEPS as f32).sqrt();
            let azimuth = TAU * (column as f32 + 0.5) / STEPS as f32;
            let cos_zenith = (1.0 - sin_zenith * sin_zenith).sqrt();
            from_sky +=
                sky.radiance(Vec3::new(sin_zenith * azimuth.cos(), cos_zenith, sin_zenith * azimuth.sin()));
        }
    }
    let sky_irradiance = from_sky * (PI / (STEPS * STEPS) as f32);
    let sun_irradiance = SUN_RADIANCE * (sun_solid_angle() * SUN_ELEVATION_RAD.sin());
    GROUND_ALBEDO * (sky_irradiance + sun_irradiance) / PI
}

/// The ground in a direction below the horizon, which fades into the sky's haze far away.
fn ground_towards(direction: Vec3, ground: Vec3, sky: &Sky) -> Vec3 {
    let horizon = sky.radiance(Vec3::new(direction.x, 0.0, direction.z).normalize_or(Vec3::X));
    // Distance in eye heights is 1 / -y; haze takes over at about 60 of them.
    let haze = (direction.y * 60.0).exp();
    ground.lerp(horizon, haze)
}

fn sun_solid_angle() -> f32 {
    TAU * (1.0 - SUN_ANGULAR_RADIUS_RAD.cos())
}

/// Adds the sun's disc: each texel gets the share of the disc that lies in it, over the texel's
/// solid angle, so that the sum over the map is the disc's light exactly.
fn add_sun(pixels: &mut [[f32; 3]], width: u32) {
    const RINGS: usize = 128;
    let height = width / 2;
    let towards = sun_direction();
    let (right, up) = towards.any_orthonormal_pair();
    let points = RINGS * RINGS;
    for index in 0..points {
        // A spiral of points of equal solid angle over the disc.
        let share = (index as f32 + 0.5) / points as f32;
        let cos_from_middle = 1.0 - share * (1.0 - SUN_ANGULAR_RADIUS_RAD.cos());
        let sin_from_middle = SUN_ANGULAR_RADIUS_RAD.sin() * share.sqrt();
        let turn = TAU * (index as f32 * 0.618_034).fract();
        let direction = (towards * cos_from_middle
            + (right * turn.cos() + up * turn.sin()) * sin_from_middle)
            .normalize();
        let [u, v] = Environment::uv_of(direction);
        let column = ((u * width as f32) as u32).min(width - 1);
        let row = ((v * height as f32) as u32).min(height - 1);
        let texel_solid_angle = Environment::solid_angle_of_texel(width, height, row);
        let gain = SUN_RADIANCE * (sun_solid_angle() / points as f32 / texel_solid_angle);
        if let Some(pixel) = pixels.get_mut((row * width + column) as usize) {
            *pixel = (Vec3::from(*pixel) + gain).to_array();
        }
    }
}
