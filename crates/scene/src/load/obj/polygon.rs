//! Cuts polygons into triangles.

use glam::{Vec2, Vec3};

/// Beyond this many corners a polygon is taken for convex, so that the time stays linear.
const MOST_CORNERS_OF_CONCAVE: usize = 32;

/// Triangles that cover a polygon, as indices of its corners, wound as the polygon is: always two
/// fewer than corners. Concave polygons are cut by clipping ears.
pub(super) fn triangulate(corners: &[Vec3]) -> Vec<[usize; 3]> {
    let fan = || (2..corners.len()).map(|index| [0, index - 1, index]).collect();
    if corners.len() == 3 || corners.len() > MOST_CORNERS_OF_CONCAVE {
        return fan();
    }
    let Some(normal) = newell_normal(corners) else { return fan() };
    let (x_axis, y_axis) = normal.any_orthonormal_pair();
    // The pair is right-handed with the normal, so that the projection stays counter-clockwise.
    let flat: Vec<Vec2> =
        corners.iter().map(|corner| Vec2::new(corner.dot(x_axis), corner.dot(y_axis))).collect();
    if is_convex(&flat) { fan() } else { clip_ears(&flat) }
}

/// The mean normal of a polygon that need not be flat.
fn newell_normal(corners: &[Vec3]) -> Option<Vec3> {
    let first = *corners.first()?;
    let next = corners.iter().cycle().skip(1);
    let sum: Vec3 = corners.iter().zip(next).map(|(a, b)| (*a - first).cross(*b - first)).sum();
    sum.try_normalize()
}

/// Twice the signed area of a triangle; positive where it is counter-clockwise.
fn signed_area(a: Vec2, b: Vec2, c: Vec2) -> f32 {
    (b - a).perp_dot(c - a)
}

fn is_convex(points: &[Vec2]) -> bool {
    let (next, after) = (points.iter().cycle().skip(1), points.iter().cycle().skip(2));
    points.iter().zip(next).zip(after).all(|((a, b), c)| signed_area(*a, *b, *c) >= 0.0)
}

fn clip_ears(points: &[Vec2]) -> Vec<[usize; 3]> {
    let mut rest: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::with_capacity(points.len());
    while rest.len() > 3 {
        let count = rest.len();
        let around = |ear: usize| [rest[(ear + count - 1) % count], rest[ear], rest[(ear + 1) % count]];
        // A polygon that crosses itself may have no ear left: then any corner is cut off.
        let ear = (0..count).find(|&ear| is_ear(points, &rest, around(ear))).unwrap_or(0);
        triangles.push(around(ear));
        rest.remove(ear);
    }
    triangles.extend(<[usize; 3]>::try_from(rest));
    triangles
}

/// Whether a corner sticks out and no other corner lies in the triangle that it spans.
fn is_ear(points: &[Vec2], rest: &[usize], triangle: [usize; 3]) -> bool {
    let [a, b, c] = triangle.map(|index| points[index]);
    let inside =
        |p: Vec2| signed_area(a, b, p) >= 0.0 && signed_area(b, c, p) >= 0.0 && signed_area(c, a, p) >= 0.0;
    let mut others = rest.iter().filter(|index| !triangle.contains(index)).map(|&index| points[index]);
    signed_area(a, b, c) > 0.0 && !others.any(inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[Vec3], triangles: &[[usize; 3]]) -> (f32, f32) {
        let vectors =
            triangles.iter().map(|t| (corners[t[1]] - corners[t[0]]).cross(corners[t[2]] - corners[t[0]]));
        vectors.fold((0.0, 0.0), |(signed, absolute), vector| {
            (signed + 0.5 * vector.z, absolute + 0.5 * vector.length())
        })
    }

    #[test]
    fn concave_polygons_are_covered_once() {
        // An arrow head, an L and a comb, counter-clockwise, of area 1, 3 and 8.
        let shapes: [(&[[f32; 2]], f32); 3] = [
            (&[[0.0, 0.0], [2.0, -1.0], [1.0, 0.0], [2.0, 1.0]], 1.0),
            (&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]], 3.0),
            (
                &[
                    [0.0, 0.0],
                    [5.0, 0.0],
                    [5.0, 2.0],
                    [4.0, 2.0],
                    [4.0, 1.0],
                    [3.0, 1.0],
                    [3.0, 2.0],
                    [2.0, 2.0],
                    [2.0, 1.0],
                    [1.0, 1.0],
                    [1.0, 2.0],
                    [0.0, 2.0],
                ],
                8.0,
            ),
        ];
        for (shape, expected) in shapes {
            for turn in 0..shape.len() {
                let corners: Vec<Vec3> = shape
                    .iter()
                    .cycle()
                    .skip(turn)
                    .take(shape.len())
                    .map(|p| Vec3::new(p[0], p[1], 0.0))
                    .collect();
                let triangles = triangulate(&corners);
                assert_eq!(triangles.len(), corners.len() - 2);
                let (signed, absolute) = area(&corners, &triangles);
                assert!(
                    (signed - expected).abs() < 1e-5 && (absolute - expected).abs() < 1e-5,
                    "{turn} {signed} {absolute}"
                );
            }
        }
    }

    #[test]
    fn odd_polygons_still_make_triangles() {
        let line = vec![Vec3::ZERO; 7];
        assert_eq!(triangulate(&line).len(), 5);
        let crossed = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X + Vec3::Y].to_vec();
        assert_eq!(triangulate(&crossed).len(), 2);
        assert_eq!(triangulate(&vec![Vec3::X; 1000]).len(), 998);
    }
}
