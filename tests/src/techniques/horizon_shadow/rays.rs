//! Rays in f64 through a displaced ground: the truth of the tables and the pictures.
//!
//! Along a ray the point of the ground is followed whose normal goes through the place on the ray;
//! the ray is below the relief where that distance along the normal is less than the height.

use super::grounds::Ground;
use glam::{DMat3, DVec2, DVec3};
use horizon_shadow::Wrap;

/// Longest step of a ray in texels. The ridges of bilinear heights are the lines between cells, which
/// are met besides; within a cell heights are quadratic along a ray, so that what lies between
/// samples is hardly higher.
const STEP_TEXELS: f64 = 0.125;

/// A height map in f64.
#[derive(Clone, Debug)]
pub(super) struct Heights {
    pub(super) size: [usize; 2],
    /// Metres.
    pub(super) values_m: Vec<f64>,
    pub(super) wrap: [Wrap; 2],
    pub(super) uv_scale: DVec2,
    pub(super) greatest_m: f64,
}

impl Heights {
    /// Metres at u, v of the ground: bilinear between the texels' centres.
    pub(super) fn at(&self, uv: DVec2) -> f64 {
        let [width, height] = self.size.map(|texels| texels as f64);
        let at = uv * self.uv_scale * DVec2::new(width, height) - 0.5;
        let (base, f) = (at.floor(), at - at.floor());
        let (x, y) = (base.x as i64, base.y as i64);
        let (near, far) = (self.texel(x, y), self.texel(x, y + 1));
        let row = |left: f64, right: f64| left + (right - left) * f.x;
        let (near, far) = (row(near, self.texel(x + 1, y)), row(far, self.texel(x + 1, y + 1)));
        near + (far - near) * f.y
    }

    fn texel(&self, x: i64, y: i64) -> f64 {
        let place = |index: i64, axis: usize| {
            let size = self.size[axis] as i64;
            match self.wrap[axis] {
                Wrap::Repeat => index.rem_euclid(size),
                Wrap::Clamp => index.clamp(0, size - 1),
            }
        };
        self.values_m[(place(y, 1) * self.size[0] as i64 + place(x, 0)) as usize]
    }
}

/// What rays are sent through.
#[derive(Debug)]
pub(super) struct Displaced<'a> {
    pub(super) ground: &'a Ground,
    pub(super) heights: &'a Heights,
    /// Length of a texel on the ground.
    pub(super) texel_m: f64,
    /// Where rays end.
    pub(super) longest_m: f64,
    /// The greatest curvature of a hollow in the ground, 1 / metre, not negative: a ray that rises from
    /// one side of it may meet the other.
    pub(super) hollow_per_m: f64,
}

impl Displaced<'_> {
    /// The point of the relief above u, v.
    pub(super) fn position(&self, uv: DVec2) -> DVec3 {
        let point = self.ground.point(uv);
        point.position + point.normal * self.heights.at(uv)
    }

    /// How far a ray from the relief above u, v goes until it is below the relief, metres; `None`
    /// where it leaves. `direction` has unit length.
    pub(super) fn hit_m(&self, uv: DVec2, direction: DVec3) -> Option<f64> {
        self.hit_from_m(uv, self.heights.at(uv), direction)
    }

    /// The same from so many metres above the ground, not below the relief.
    pub(super) fn hit_from_m(&self, uv: DVec2, height_m: f64, direction: DVec3) -> Option<f64> {
        let start = self.ground.point(uv);
        let origin = start.position + start.normal * height_m;
        let texels = self.heights.uv_scale * DVec2::from(self.heights.size.map(|size| size as f64));
        // The first place is a hundredth of a texel away: the surface itself is no obstacle.
        let mut step = 0.01 * self.texel_m;
        let (mut distance, mut at, mut height) = (0.0, uv, height_m);
        while distance < self.longest_m {
            let before = at * texels - 0.5;
            (at, height) = self.above(origin + direction * (distance + step), at, height)?;
            let after = at * texels - 0.5;
            for part in crossings(before, after) {
                let place = origin + direction * (distance + part * step);
                let (at, height) = self.above(place, at, height)?;
                if height < self.heights.at(at) {
                    return Some(distance + part * step);
                }
            }
            distance += step;
            // Over a hollow the ray's rise against the ground lessens by its curvature, and by up to
            // twice that while the ray is not near the hollow's middle.
            let rise = direction.dot(self.ground.point(at).normal);
            let turn = 2.0 * self.hollow_per_m * (self.longest_m - distance);
            if height > self.heights.greatest_m && rise > turn {
                return None;
            }
            step = (1.5 * step).min(STEP_TEXELS * self.texel_m);
        }
        None
    }

    /// Where on the ground and how high above it a position is, by Newton's method from a place
    /// nearby; `None` where it does not converge, as at the centre of a sphere.
    fn above(&self, position: DVec3, mut uv: DVec2, mut height: f64) -> Option<(DVec2, f64)> {
        for _ in 0..20 {
            let point = self.ground.point(uv);
            let apart = position - point.position - point.normal * height;
            if apart.length() < 1e-7 * self.texel_m {
                return Some((uv, height));
            }
            let (u, v, form) = (point.along_u, point.along_v, point.second_form);
            let (e, f, g) = (u.dot(u), u.dot(v), v.dot(v));
            let determinant = e * g - f * f;
            // How the normal changes, in u and v.
            let turned = |a: f64, b: f64| (u * (g * a - f * b) + v * (e * b - f * a)) / determinant;
            let normal_u = turned(form.x, form.y);
            let normal_v = turned(form.y, form.z);
            let jacobian = DMat3::from_cols(u + normal_u * height, v + normal_v * height, point.normal);
            let change = jacobian.inverse() * apart;
            if !change.is_finite() {
                return None;
            }
            uv += change.truncate();
            height += change.z;
        }
        None
    }
}

/// The parts of the way from one place of the map to another, in texels, at which it crosses lines
/// between cells, and its end.
fn crossings(from: DVec2, to: DVec2) -> impl Iterator<Item = f64> {
    let line = |from: f64, to: f64| {
        let line = from.max(to).floor();
        let part = (line - from) / (to - from);
        (part > 0.0 && part < 1.0).then_some(part)
    };
    let (mut x, mut y) = (line(from.x, to.x), line(from.y, to.y));
    if x > y {
        std::mem::swap(&mut x, &mut y);
    }
    x.into_iter().chain(y).chain([1.0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heights(size: usize, height_m: impl Fn(usize, usize) -> f64) -> Heights {
        let values_m: Vec<f64> = (0..size * size).map(|i| height_m(i % size, i / size)).collect();
        let greatest_m = values_m.iter().copied().fold(0.0, f64::max);
        Heights { size: [size; 2], values_m, wrap: [Wrap::Clamp; 2], uv_scale: DVec2::ONE, greatest_m }
    }

    /// Whether a ray at an elevation along +u is blocked.
    fn is_blocked(displaced: &Displaced<'_>, uv: DVec2, elevation_deg: f64) -> bool {
        let point = displaced.ground.point(uv);
        let (sin, cos) = elevation_deg.to_radians().sin_cos();
        displaced.hit_m(uv, point.along_u.normalize() * cos + point.normal * sin).is_some()
    }

    #[test]
    fn one_height_everywhere_has_its_horizon_at_0() {
        let flat = heights(8, |_, _| 4.0 / 128.0);
        let sphere = Ground::Sphere(1.0 / 128.0 / 0.015, DVec2::ONE);
        for ground in [&sphere, &Ground::Plane(DVec2::ONE), &Ground::Cylinder(0.4, DVec2::ONE)] {
            let displaced =
                Displaced { ground, heights: &flat, texel_m: 1.0 / 128.0, longest_m: 0.5, hollow_per_m: 0.0 };
            for uv in [DVec2::splat(0.5), DVec2::new(0.4, 0.6)] {
                assert!(is_blocked(&displaced, uv, -0.2), "{ground:?}");
                assert!(!is_blocked(&displaced, uv, 0.2), "{ground:?}");
            }
        }
    }

    #[test]
    fn the_horizon_of_a_wall_follows_from_its_place() {
        // Columns are 1/128 m wide; the wall rises to its full height at the centre of column 84.
        let wall = heights(128, |x, _| if x >= 84 { 10.0 / 128.0 } else { 0.0 });
        let distance = 20.0 / 128.0;
        let uv = DVec2::new(64.5 / 128.0, 0.5);
        let plane = Ground::Plane(DVec2::ONE);
        // On a cylinder the wall's top is at radius R + H and turned by d / R.
        let radius: f64 = 0.7;
        let (sin, cos) = (distance / radius).sin_cos();
        let top = radius + 10.0 / 128.0;
        let bent = ((top * cos - radius) / (top * sin)).atan().to_degrees();
        let flat = 0.5_f64.atan().to_degrees();
        for (ground, expected) in [(plane, flat), (Ground::Cylinder(radius, DVec2::ONE), bent)] {
            let displaced = Displaced {
                ground: &ground,
                heights: &wall,
                texel_m: 1.0 / 128.0,
                longest_m: 0.5,
                hollow_per_m: 0.0,
            };
            assert!(is_blocked(&displaced, uv, expected - 0.1), "{ground:?}");
            assert!(!is_blocked(&displaced, uv, expected + 0.1), "{ground:?}");
        }
    }
}
