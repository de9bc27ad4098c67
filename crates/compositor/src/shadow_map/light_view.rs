//! How a light sees the scene.

use crate::{View, view::Bounds};
use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DVec3, Mat4, Vec3};
use scene::Light;

/// The widest spot light that one map can hold, half-angle in radians.
const WIDEST_SPOT_RAD: f32 = 1.4;

/// `ShadowLight` of compositor/shadow-map.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct ShadowLight {
    center_world: [f32; 3],
    kind: u32,
    right_world: [f32; 3],
    half_extent: f32,
    up_world: [f32; 3],
    depth_m: f32,
    towards_world: [f32; 3],
    tan_radius: f32,
    pub(super) corner: [u32; 2],
    unused: [u32; 2],
}

const DIRECTIONAL: u32 = 0;
const SPOT: u32 = 1;
const CASTS_NONE: u32 = 2;

impl ShadowLight {
    /// A light that casts no shadow.
    pub(super) fn none() -> Self {
        Self { kind: CASTS_NONE, half_extent: 1.0, depth_m: 1.0, ..Self::zeroed() }
    }

    /// How a light sees a scene within these bounds; `None` for a light that casts no shadow.
    pub(super) fn new(light: &Light, bounds: Bounds) -> Option<Self> {
        let radius_m = bounds.radius_m.max(1e-6) * 1.001;
        match *light {
            Light::Directional { direction_world, angular_diameter_rad, .. } => {
                let towards = direction_world.try_normalize()?;
                let angular_radius_rad = (0.5 * angular_diameter_rad).clamp(0.0, 1.5);
                let tan_radius = if angular_radius_rad.is_nan() { 0.0 } else { angular_radius_rad.tan() };
                let view =
                    Self { half_extent: radius_m, depth_m: 2.0 * radius_m, tan_radius, ..Self::none() };
                Some(Self { kind: DIRECTIONAL, ..view.placed(bounds.center_world, towards) })
            }
            Light::Spot { position_world, direction_world, outer_angle_rad, .. } => {
                let towards = -direction_world.try_normalize()?;
                if !(outer_angle_rad > 0.0 && outer_angle_rad <= WIDEST_SPOT_RAD) {
                    return None;
                }
                // A little wider, so that filters find texels at the cone's border.
                let half_extent = (outer_angle_rad * 1.02).tan();
                let farthest_m = position_world.distance(bounds.center_world) + radius_m;
                let view = Self { half_extent, depth_m: 1e-4 * farthest_m, ..Self::none() };
                Some(Self { kind: SPOT, ..view.placed(position_world, towards) })
            }
            Light::Point { .. } => None,
        }
    }

    fn placed(self, center_world: Vec3, towards: Vec3) -> Self {
        let (up, right) = towards.any_orthonormal_pair();
        // Right, up and towards are right-handed, as a camera's axes are.
        let right = if right.cross(up).dot(towards) < 0.0 { -right } else { right };
        Self {
            center_world: center_world.to_array(),
            right_world: right.to_array(),
            up_world: up.to_array(),
            towards_world: towards.to_array(),
            ..self
        }
    }

    /// What the casters are drawn with.
    pub(super) fn view(&self) -> View {
        let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        let [center, right, up, towards] =
            [self.center_world, self.right_world, self.up_world, self.towards_world].map(vector);
        let row = |axis: DVec3, scale: f64, add: f64| (axis * scale).extend(add - scale * axis.dot(center));
        let (extent, depth_m) = (f64::from(self.half_extent), f64::from(self.depth_m));
        let rows = if self.kind == SPOT {
            let depth = DVec3::ZERO.extend(depth_m);
            [row(right, 1.0 / extent, 0.0), row(up, 1.0 / extent, 0.0), depth, row(towards, -1.0, 0.0)]
        } else {
            let depth = row(towards, 1.0 / depth_m, 0.5);
            [row(right, 1.0 / extent, 0.0), row(up, 1.0 / extent, 0.0), depth, DVec3::ZERO.extend(1.0)]
        };
        let clip_from_world = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose().as_mat4();
        // Nothing but the positions of vertices depends on it.
        View { clip_from_world, world_from_clip: Mat4::IDENTITY, eye_world: Vec3::ZERO, near_m: 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = Bounds { center_world: Vec3::new(3.0, -2.0, 7.0), radius_m: 2.5 };

    #[test]
    fn a_directional_light_sees_the_whole_scene_and_depth_grows_towards_it() {
        let direction_world = Vec3::new(0.3, 0.8, -0.4).normalize();
        let light = Light::Directional { direction_world, irradiance: Vec3::ONE, angular_diameter_rad: 0.1 };
        let view = ShadowLight::new(&light, BOUNDS).unwrap().view().clip_from_world;
        for offset in [Vec3::X, Vec3::NEG_Y, Vec3::Z, direction_world, -direction_world] {
            let clip = view.project_point3(BOUNDS.center_world + offset * BOUNDS.radius_m);
            assert!(clip.abs().max_element() <= 1.0 && clip.z >= 0.0, "{clip}");
            let depth = 0.5 + offset.dot(direction_world) * BOUNDS.radius_m / (2.0 * 2.5 * 1.001);
            assert!((clip.z - depth).abs() < 1e-5, "{} is not {depth}", clip.z);
        }
        // A triangle that faces the light is seen from its front, counter-clockwise.
        let (a, b) = direction_world.any_orthonormal_pair();
        let (a, b) = if a.cross(b).dot(direction_world) > 0.0 { (a, b) } else { (b, a) };
        let [o, a, b] = [Vec3::ZERO, a, b].map(|corner| view.project_point3(BOUNDS.center_world + corner));
        assert!((a - o).truncate().perp_dot((b - o).truncate()) > 0.0);
    }

    #[test]
    fn a_spot_light_sees_its_cone() {
        let (position_world, direction_world) =
            (Vec3::new(1.0, 4.0, 2.0), Vec3::new(0.2, -1.0, 0.1).normalize());
        let light = |outer_angle_rad| Light::Spot {
            position_world,
            direction_world,
            intensity: Vec3::ONE,
            range: f32::INFINITY,
            inner_angle_rad: 0.0,
            outer_angle_rad,
        };
        let view = ShadowLight::new(&light(0.5), BOUNDS).unwrap().view().clip_from_world;
        let side = direction_world.any_orthonormal_vector();
        let depths = [0.5, 1.0, 8.0].map(|distance| {
            let clip =
                view.project_point3(position_world + distance * (direction_world + side * 0.5_f32.tan()));
            assert!((0.95..1.0).contains(&clip.truncate().length()), "{clip}");
            clip.z
        });
        assert!(depths[0] > depths[1] && depths[1] > depths[2] && depths[2] > 0.0 && depths[0] < 1.0);
        assert_eq!(ShadowLight::new(&light(1.5), BOUNDS), None);
    }
}
