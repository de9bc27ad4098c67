//! What one triangle says about the directions of u and v and about curvature.

use glam::{DMat3, DVec2, DVec3};

/// Twice the area over the square of the longest edge below which a triangle counts as a line:
/// beyond it, differences across are of f32's rounding.
const THINNEST: f64 = 1e-7;
/// The same in texture coordinates.
const THINNEST_UV: f64 = 1e-6;

/// A triangle with area.
pub(super) struct Triangle {
    /// Edge i is opposite corner i.
    edges: [DVec3; 3],
    /// Unit.
    pub(super) normal: DVec3,
    pub(super) area: f64,
    /// The part of the area that is nearest to each corner (Voronoi), as Meyer et al. (2003) have it;
    /// where an angle is obtuse, what lies within the triangle.
    pub(super) nearest_areas: [f64; 3],
}

impl Triangle {
    /// `None` where the corners are not finite or lie on a line.
    pub(super) fn new([a, b, c]: [DVec3; 3]) -> Option<Self> {
        let edges = [c - b, a - c, b - a];
        let cross = edges[0].cross(edges[1]);
        let longest = edges.iter().fold(0.0, |most: f64, edge| most.max(edge.length_squared()));
        let twice_area = cross.length();
        if !(twice_area > THINNEST * longest && twice_area.is_finite()) {
            return None;
        }
        let area = twice_area / 2.0;
        Some(Self { edges, normal: cross / twice_area, area, nearest_areas: nearest_areas(&edges, area) })
    }

    /// The symmetric tensor in the triangle's plane that takes its edges, as well as can be, to the
    /// differences of its corners' normals: x II y for any x and y in the plane. 0 normals make none.
    pub(super) fn second_form(&self, normals: [DVec3; 3]) -> Option<DMat3> {
        if normals.contains(&DVec3::ZERO) {
            return None;
        }
        let scale = self.area.sqrt();
        let [x_axis, y_axis] = self.axes();
        let [a, b, c] = normals;
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for (edge, turn) in self.edges.iter().zip([c - b, a - c, b - a]) {
            let (x, y) = (edge.dot(x_axis) / scale, edge.dot(y_axis) / scale);
            let (turn_x, turn_y) = (turn.dot(x_axis), turn.dot(y_axis));
            matrix += DMat3::from_cols(
                DVec3::new(x * x, x * y, 0.0),
                DVec3::new(x * y, x * x + y * y, x * y),
                DVec3::new(0.0, x * y, y * y),
            );
            right += DVec3::new(x * turn_x, y * turn_x + x * turn_y, y * turn_y);
        }
        let [xx, xy, yy] = (matrix.inverse() * right / scale).to_array();
        let form = outer(x_axis, x_axis * xx + y_axis * xy) + outer(y_axis, x_axis * xy + y_axis * yy);
        form.is_finite().then_some(form)
    }

    /// Change of the position along u and along v, as two columns, and the orientation of the texture
    /// coordinates on the triangle: 0 or 1.
    pub(super) fn along_uv(&self, uvs: [[f64; 2]; 3]) -> Option<(DMat3, usize)> {
        let [a, b, c] = uvs.map(DVec2::from_array);
        let (one, other) = (b - a, c - a);
        let area = one.perp_dot(other);
        let longest = one.length_squared().max(other.length_squared()).max((c - b).length_squared());
        if !(area.abs() > THINNEST_UV * longest && longest.is_finite()) {
            return None;
        }
        let (to_b, to_c) = (self.edges[2], -self.edges[1]);
        let along_u = (to_b * other.y - to_c * one.y) / area;
        let along_v = (to_c * one.x - to_b * other.x) / area;
        Some((DMat3::from_cols(along_u, along_v, DVec3::ZERO), usize::from(area < 0.0)))
    }

    /// The smallest rotation from the triangle's plane to that of a unit normal, for vectors of the
    /// plane. The normal may point to either side; for 0 nothing is turned.
    pub(super) fn bent_to(&self, normal: DVec3) -> DMat3 {
        let from = if self.normal.dot(normal) < 0.0 { -self.normal } else { self.normal };
        if normal == DVec3::ZERO {
            return DMat3::IDENTITY;
        }
        let halfway = from + normal;
        DMat3::IDENTITY - outer(halfway, normal) / (1.0 + from.dot(normal))
    }

    /// Two orthogonal unit vectors of the plane.
    fn axes(&self) -> [DVec3; 2] {
        let along = self.edges[0].normalize_or(DVec3::X);
        [along, self.normal.cross(along)]
    }
}

/// a b^T.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

fn nearest_areas(edges: &[DVec3; 3], area: f64) -> [f64; 3] {
    let squares = edges.map(DVec3::length_squared);
    let weights: [f64; 3] =
        std::array::from_fn(|i| squares[i] * (squares[(i + 1) % 3] + squares[(i + 2) % 3] - squares[i]));
    let Some(obtuse) = (0..3).find(|&i| weights[i] <= 0.0) else {
        let scale = 0.5 * area / weights.iter().sum::<f64>();
        return std::array::from_fn(|i| scale * (weights[(i + 1) % 3] + weights[(i + 2) % 3]));
    };
    let (next, last) = ((obtuse + 1) % 3, (obtuse + 2) % 3);
    let mut areas = [0.0; 3];
    areas[next] = -0.25 * squares[last] * area / edges[obtuse].dot(edges[last]);
    areas[last] = -0.25 * squares[next] * area / edges[obtuse].dot(edges[next]);
    areas[obtuse] = area - areas[next] - areas[last];
    areas
}
