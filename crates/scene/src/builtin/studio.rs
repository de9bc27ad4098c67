//! A dark photographic studio: a room of 10 x 10 metres with soft boxes and strip lights, seen
//! from its middle, 1.2 metres above a floor that brightens towards a backdrop.

use glam::Vec3;

use super::raster::mean_over_texels;

/// Where the map is taken from: the floor is this far below, in metres.
const EYE_HEIGHT: f32 = 1.2;
/// Half the room's width and length, metres.
const HALF_ROOM: f32 = 5.0;
/// Height of the ceiling above the eye, metres.
const CEILING: f32 = 3.0;

/// A rectangular light. Positions in metres from the eye.
struct Panel {
    centre: Vec3,
    /// Unit, towards the eye.
    normal: Vec3,
    /// Unit directions of width and height, over half the width and height.
    across: [Vec3; 2],
    /// Half the longer side.
    half_size: f32,
    radiance: Vec3,
    /// Width of the soft border, as a share of the half-axes.
    softness: f32,
}

/// The whole map, rows from the top.
pub(super) fn pixels(width: u32) -> Vec<[f32; 3]> {
    let panels = panels();
    mean_over_texels(width, 4, |direction| {
        panels.iter().fold(room(direction), |behind, panel| panel.over(behind, direction))
    })
}

/// Key and fill soft boxes, an overhead bank, a rim strip on each side, and a small warm lamp.
fn panels() -> [Panel; 7] {
    let warm = Vec3::new(1.0, 0.93, 0.83);
    let cool = Vec3::new(0.86, 0.94, 1.0);
    [
        Panel::facing_eye(Vec3::new(-2.6, 1.3, 2.4), 0.9, 1.1, warm * 24.0, 0.12),
        Panel::facing_eye(Vec3::new(3.1, 0.7, 1.6), 0.7, 1.3, cool * 9.0, 0.2),
        Panel::facing_eye(Vec3::new(0.0, 2.6, -0.4), 1.5, 0.55, Vec3::splat(15.0), 0.08),
        Panel::facing_eye(Vec3::new(-2.9, 0.6, -2.6), 0.07, 1.5, cool * 70.0, 0.15),
        Panel::facing_eye(Vec3::new(2.7, 0.6, -2.9), 0.07, 1.5, cool * 70.0, 0.15),
        Panel::facing_eye(Vec3::new(0.6, 1.2, 3.6), 0.05, 0.9, Vec3::splat(45.0), 0.15),
        Panel::facing_eye(Vec3::new(-0.9, -0.35, 3.6), 0.16, 0.16, Vec3::new(1.0, 0.72, 0.42) * 120.0, 0.3),
    ]
}

impl Panel {
    /// An upright panel turned to the eye.
    fn facing_eye(centre: Vec3, half_width: f32, half_height: f32, radiance: Vec3, softness: f32) -> Self {
        let normal = -centre.normalize();
        // Overhead the horizontal direction along X serves as the width.
        let right = if normal.y.abs() > 0.9 { Vec3::X } else { Vec3::Y.cross(normal).normalize() };
        let up = normal.cross(right).normalize();
        let across = [right / half_width, up / half_height];
        Self { centre, normal, across, half_size: half_width.max(half_height), radiance, softness }
    }

    /// The radiance in a direction with this panel before what is behind it.
    fn over(&self, behind: Vec3, direction: Vec3) -> Vec3 {
        let towards_panel = -direction.dot(self.normal);
        if towards_panel <= 1e-3 {
            return behind;
        }
        let offset = direction * (-self.centre.dot(self.normal) / towards_panel) - self.centre;
        let [x, y] = self.across.map(|axis| (1.0 - offset.dot(axis).abs()) / self.softness);
        if x <= 0.0 || y <= 0.0 {
            return behind;
        }
        // A diffuser is brightest in front of its lamp.
        let from_middle = (offset.length_squared() / (self.half_size * self.half_size)).min(1.0);
        behind.lerp(self.radiance * (1.0 - 0.35 * from_middle), smooth(x) * smooth(y))
    }
}

/// 0 below 0, 1 above 1, with a smooth step between.
fn smooth(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// The room without its lights.
fn room(direction: Vec3) -> Vec3 {
    let to_wall = HALF_ROOM / direction.x.abs().max(direction.z.abs()).max(1e-6);
    let height = direction.y * to_wall;
    if height < -EYE_HEIGHT {
        return floor(direction * (EYE_HEIGHT / -direction.y));
    }
    if height > CEILING {
        return Vec3::splat(0.02);
    }
    // Walls are lit from below, and the backdrop at -Z more than the others.
    let backdrop = smooth(-direction.z * to_wall / HALF_ROOM);
    let share = (height + EYE_HEIGHT) / (CEILING + EYE_HEIGHT);
    Vec3::new(0.05, 0.052, 0.058).lerp(Vec3::new(0.34, 0.35, 0.37), backdrop * (1.0 - share)) * (1.0 - 0.6 * share)
}

/// Grey paper, brightest in the pool of light around the middle.
fn floor(point: Vec3) -> Vec3 {
    let from_middle = point.x.hypot(point.z);
    let pool = (-(from_middle / 2.4).powi(2)).exp();
    Vec3::new(0.10, 0.10, 0.105).lerp(Vec3::new(0.62, 0.60, 0.57), pool)
}
