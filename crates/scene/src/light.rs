//! Lights besides the environment.

use glam::Vec3;

/// A light. Colours are linear RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// A light at infinity: a point (`angular_diameter_rad` 0) or a uniform disc such as the sun.
    Directional {
        /// Unit vector from the scene towards the light.
        direction_world: Vec3,
        /// Irradiance on a surface that faces the light, W/m^2 (or lux).
        irradiance: Vec3,
        /// Apparent diameter in radians, 0 .. pi.
        angular_diameter_rad: f32,
    },
    /// A point that radiates equally in all directions.
    Point {
        /// Position in metres.
        position_world: Vec3,
        /// Radiant intensity, W/sr (or candela).
        intensity: Vec3,
        /// Distance in metres beyond which the light is not evaluated; infinite for none.
        range: f32,
    },
    /// A point that radiates into a cone.
    Spot {
        /// Position in metres.
        position_world: Vec3,
        /// Unit vector along the cone's axis, away from the light.
        direction_world: Vec3,
        /// Radiant intensity on the axis, W/sr (or candela).
        intensity: Vec3,
        /// Distance in metres beyond which the light is not evaluated; infinite for none.
        range: f32,
        /// Half-angle of full intensity, radians.
        inner_angle_rad: f32,
        /// Half-angle of no intensity, radians; larger than the inner one.
        outer_angle_rad: f32,
    },
}
