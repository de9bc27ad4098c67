//! Where a ray meets a triangle: the watertight test of Woop, Benthin and Wald (2013), in f64.
//!
//! Two triangles with a common edge compute the same numbers for it up to the sign, so that no ray
//! slips between them. The corners are f32 and the ray is f64, and the sign of a difference of
//! two rounded products is right or 0, which counts as a hit.

use glam::DVec3;

/// Corners of a triangle in the tracer's space, counter-clockwise seen from its front.
pub(crate) type Corners = [[f32; 3]; 3];

/// A ray prepared for many triangles: its axes in an order in which the last is the longest, and
/// the shear that turns it along that axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    origin: [f64; 3],
    axes: [usize; 3],
    by: [f64; 3],
}

/// Where a line meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// Along the direction, in its lengths.
    pub(crate) distance: f64,
    /// Weights of the three corners, each at least 0, of sum 1.
    pub(crate) barycentric: [f64; 3],
    /// Whether the ray comes from the side on which the corners run counter-clockwise.
    pub(crate) is_front: bool,
}

impl Shear {
    /// Of a ray whose direction is finite and not zero.
    pub(crate) fn new(origin: DVec3, direction: DVec3) -> Self {
        let size = direction.abs();
        let z = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let direction = direction.to_array();
        // Exchanging the axes of a ray that runs backwards keeps the order of the corners.
        let axes = if direction[z] < 0.0 { [y, x, z] } else { [x, y, z] };
        let along = 1.0 / direction[z];
        let by = [direction[axes[0]] * along, direction[axes[1]] * along, along];
        Self { origin: origin.to_array(), axes, by }
    }

    /// Where the ray meets the triangle between the two distances, neither included.
    #[inline]
    pub(crate) fn intersect(&self, corners: &Corners, nearest: f64, farthest: f64) -> Option<Crossing> {
        let [x, y, z] = self.axes;
        let sheared = |corner: &[f32; 3]| {
            let along = f64::from(corner[z]) - self.origin[z];
            [
                f64::from(corner[x]) - self.origin[x] - self.by[0] * along,
                f64::from(corner[y]) - self.origin[y] - self.by[1] * along,
                along,
            ]
        };
        let [a, b, c] = [sheared(&corners[0]), sheared(&corners[1]), sheared(&corners[2])];
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let determinant = u + v + w;
        if determinant == 0.0 {
            return None;
        }
        let inverse = 1.0 / determinant;
        let distance = (u * a[2] + v * b[2] + w * c[2]) * self.by[2] * inverse;
        if !(distance > nearest && distance < farthest) {
            return None;
        }
        let barycentric = [u * inverse, v * inverse, w * inverse];
        Some(Crossing { distance, barycentric, is_front: determinant > 0.0 })
    }
}
