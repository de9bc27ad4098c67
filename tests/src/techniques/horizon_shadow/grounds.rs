//! Smooth surfaces with everything about them in closed form, over u and v of 0..1 and beyond.

use glam::{DVec2, DVec3};

/// A surface that a height map lies on.
#[derive(Clone, Debug)]
pub(super) enum Ground {
    /// Size along u and v in metres.
    Plane(DVec2),
    /// Radius, and size along u and v at the middle.
    Sphere(f64, DVec2),
    /// Radius (negative: seen from within), and size around and along.
    Cylinder(f64, DVec2),
    /// Radius of the ring and of the tube; angles around both.
    Torus(f64, f64, DVec2),
    /// Curvature in the middle, and size.
    Saddle(f64, f64),
    /// Rows of control points along v.
    Bezier(Box<[[DVec3; 4]; 4]>),
}

/// A point of a ground: position and its derivatives.
#[derive(Clone, Copy, Debug)]
struct Jet {
    p: DVec3,
    u: DVec3,
    v: DVec3,
    uu: DVec3,
    uv: DVec3,
    vv: DVec3,
}

/// A point of a ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) position: DVec3,
    /// Unit length.
    pub(super) normal: DVec3,
    /// Change of the position per unit of u and of v.
    pub(super) along_u: DVec3,
    pub(super) along_v: DVec3,
    /// Second fundamental form in those, convex positive.
    pub(super) second_form: DVec3,
}

impl Ground {
    /// The point at u, v.
    pub(super) fn point(&self, at: DVec2) -> Point {
        let Jet { p, u, v, uu, uv, vv } = self.jet(at.x, at.y);
        let normal = v.cross(u).normalize_or_zero();
        let second_form = -DVec3::new(normal.dot(uu), normal.dot(uv), normal.dot(vv));
        Point { position: p, normal, along_u: u, along_v: v, second_form }
    }

    /// Whether a ray that rises above it never comes back.
    pub(super) fn is_convex(&self) -> bool {
        match self {
            Self::Plane(_) | Self::Sphere(..) => true,
            Self::Cylinder(radius, _) => *radius > 0.0,
            Self::Torus(..) | Self::Saddle(..) | Self::Bezier(_) => false,
        }
    }

    fn jet(&self, u: f64, v: f64) -> Jet {
        let zero = DVec3::ZERO;
        match self {
            Self::Plane(size) => Jet {
                p: DVec3::new(size.x * (u - 0.5), 0.0, size.y * (v - 0.5)),
                u: DVec3::X * size.x,
                v: DVec3::Z * size.y,
                uu: zero,
                uv: zero,
                vv: zero,
            },
            Self::Sphere(radius, size) => {
                let turn = *size / *radius;
                let (sin_x, cos_x) = (turn.x * (u - 0.5)).sin_cos();
                let (sin_y, cos_y) = (turn.y * (0.5 - v)).sin_cos();
                let at = |x: f64, y: f64, z: f64| *radius * DVec3::new(x, y, z);
                Jet {
                    p: at(cos_y * sin_x, sin_y, cos_y * cos_x),
                    u: turn.x * at(cos_y * cos_x, 0.0, -cos_y * sin_x),
                    v: -turn.y * at(-sin_y * sin_x, cos_y, -sin_y * cos_x),
                    uu: turn.x * turn.x * at(-cos_y * sin_x, 0.0, -cos_y * cos_x),
                    uv: -turn.x * turn.y * at(-sin_y * cos_x, 0.0, sin_y * sin_x),
                    vv: turn.y * turn.y * at(-cos_y * sin_x, -sin_y, -cos_y * cos_x),
                }
            }
            Self::Cylinder(radius, size) => {
                let turn = size.x / radius;
                let (sin, cos) = (turn * (u - 0.5)).sin_cos();
                Jet {
                    p: DVec3::new(radius * sin, size.y * (0.5 - v), radius * cos),
                    u: size.x * DVec3::new(cos, 0.0, -sin),
                    v: -DVec3::Y * size.y,
                    uu: size.x * turn * DVec3::new(-sin, 0.0, -cos),
                    uv: zero,
                    vv: zero,
                }
            }
            Self::Torus(ring, tube, turn) => torus(*ring, *tube, *turn, u, v),
            Self::Saddle(curvature, size) => {
                let (x, z) = (size * (u - 0.5), size * (v - 0.5));
                Jet {
                    p: DVec3::new(x, 0.5 * curvature * (x * x - z * z), z),
                    u: *size * DVec3::new(1.0, curvature * x, 0.0),
                    v: *size * DVec3::new(0.0, -curvature * z, 1.0),
                    uu: DVec3::Y * (size * size * curvature),
                    uv: zero,
                    vv: -DVec3::Y * (size * size * curvature),
                }
            }
            Self::Bezier(control) => bezier(control, u, v),
        }
    }
}

fn torus(ring: f64, tube: f64, turn: DVec2, u: f64, v: f64) -> Jet {
    let (sin_x, cos_x) = (turn.x * (u - 0.5)).sin_cos();
    let (sin_y, cos_y) = (turn.y * (0.5 - v)).sin_cos();
    let out = DVec3::new(sin_x, 0.0, cos_x);
    let along = DVec3::new(cos_x, 0.0, -sin_x);
    let reach = ring + tube * cos_y;
    Jet {
        p: reach * out + DVec3::Y * (tube * sin_y),
        u: turn.x * reach * along,
        v: -turn.y * tube * (DVec3::Y * cos_y - out * sin_y),
        uu: -turn.x * turn.x * reach * out,
        uv: turn.x * turn.y * tube * sin_y * along,
        vv: -turn.y * turn.y * tube * (out * cos_y + DVec3::Y * sin_y),
    }
}

fn bezier(control: &[[DVec3; 4]; 4], u: f64, v: f64) -> Jet {
    let (a, b) = (bernstein(u), bernstein(v));
    let sum = |along_u: [f64; 4], along_v: [f64; 4]| {
        let row =
            |row: &[DVec3; 4]| row.iter().zip(along_u).map(|(&point, weight)| point * weight).sum::<DVec3>();
        control.iter().zip(along_v).map(|(points, weight)| row(points) * weight).sum::<DVec3>()
    };
    Jet {
        p: sum(a[0], b[0]),
        u: sum(a[1], b[0]),
        v: sum(a[0], b[1]),
        uu: sum(a[2], b[0]),
        uv: sum(a[1], b[1]),
        vv: sum(a[0], b[2]),
    }
}

/// The cubic weights, and their first and second derivatives.
fn bernstein(t: f64) -> [[f64; 4]; 3] {
    let s = 1.0 - t;
    [
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
        [-3.0 * s * s, 3.0 * s * s - 6.0 * s * t, 6.0 * s * t - 3.0 * t * t, 3.0 * t * t],
        [6.0 * s, 6.0 * t - 12.0 * s, 6.0 * s - 12.0 * t, 6.0 * t],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> Vec<Ground> {
        let control = std::array::from_fn(|j| {
            std::array::from_fn(|i| DVec3::new(i as f64, ((3 * i + 5 * j) % 4) as f64, j as f64))
        });
        vec![
            Ground::Plane(DVec2::new(1.0, 2.0)),
            Ground::Sphere(0.6, DVec2::new(1.1, 0.9)),
            Ground::Cylinder(0.5, DVec2::new(0.8, 1.3)),
            Ground::Cylinder(-0.5, DVec2::new(0.8, 1.3)),
            Ground::Torus(1.0, 0.3, DVec2::new(4.0, 2.5)),
            Ground::Saddle(1.4, 0.9),
            Ground::Bezier(Box::new(control)),
        ]
    }

    #[test]
    fn derivatives_are_those_of_the_position_and_of_the_normal() {
        let step = 1e-5;
        for ground in all() {
            for at in [DVec2::new(0.2, 0.7), DVec2::new(0.6, 0.35)] {
                let here = ground.point(at);
                let change = |of: fn(&Point) -> DVec3, axis: DVec2| {
                    let [ahead, behind] = [1.0, -1.0].map(|sign| of(&ground.point(at + sign * step * axis)));
                    (ahead - behind) / (2.0 * step)
                };
                for (axis, expected) in [(DVec2::X, here.along_u), (DVec2::Y, here.along_v)] {
                    let found = change(|point| point.position, axis);
                    assert!((found - expected).length() < 1e-7, "{ground:?} {found} {expected}");
                }
                // Where the surface is convex the normal turns the way one goes.
                let [by_u, by_v] = [DVec2::X, DVec2::Y].map(|axis| change(|point| point.normal, axis));
                let form = DVec3::new(by_u.dot(here.along_u), by_u.dot(here.along_v), by_v.dot(here.along_v));
                assert!((form - here.second_form).length() < 1e-6, "{ground:?} {form} {}", here.second_form);
            }
        }
    }

    #[test]
    fn normals_point_outwards() {
        let sphere = Ground::Sphere(2.0, DVec2::splat(1.0)).point(DVec2::splat(0.3));
        assert!((sphere.normal - sphere.position / 2.0).length() < 1e-12);
        assert!(sphere.second_form.x > 0.0);
        let hollow = Ground::Cylinder(-2.0, DVec2::splat(1.0)).point(DVec2::splat(0.5));
        assert!(hollow.normal.z > 0.99 && hollow.second_form.x < 0.0);
        let plane = Ground::Plane(DVec2::ONE).point(DVec2::splat(0.3));
        assert!(plane.normal.y > 0.99);
    }
}
