//! What every loader does to a mesh before it joins a scene.

use glam::{Vec2, Vec3};

use crate::Mesh;

/// Makes normals and tangents where they are missing, and mends unusable ones. Positions are
/// finite and triangles valid already. Returns what was mended, for warnings.
pub(super) fn repair(mesh: &mut Mesh) -> Vec<String> {
    let mut messages = Vec::new();
    let mut note = |count: usize, what: &str| {
        if count > 0 {
            messages.push(format!("{count} {what}"));
        }
    };
    note(degenerate_triangles(mesh), "triangles without area are kept");
    note(repair_uvs(&mut mesh.uvs), "texture coordinates that are not finite are set to 0");
    note(broken_normals(&mesh.normals), "unusable normals are made from the triangles around them");
    mesh.fill_normals();
    if mesh
        .tangents
        .iter()
        .any(|tangent| tangent.truncate().try_normalize().is_none() || !tangent.w.is_finite())
    {
        note(mesh.tangents.len(), "tangents are made anew, since some of them are unusable");
        mesh.tangents.clear();
    }
    mesh.fill_tangents();
    messages
}

/// The corners' positions, for a mesh whose triangles are valid.
fn corners(mesh: &Mesh, triangle: [u32; 3]) -> Option<[Vec3; 3]> {
    let [a, b, c] = triangle.map(|index| mesh.positions.get(index as usize).copied());
    Some([a?, b?, c?])
}

/// Twice the area, along the normal of the triangle.
fn area_vector([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a)
}

fn degenerate_triangles(mesh: &Mesh) -> usize {
    let has_no_area = |corners: &[Vec3; 3]| {
        // Scaled to its own size first, so that a small triangle is not taken for none.
        let size = (corners[1] - corners[0]).abs().max((corners[2] - corners[0]).abs()).max_element();
        size == 0.0 || area_vector(corners.map(|corner| (corner - corners[0]) / size)) == Vec3::ZERO
    };
    mesh.triangles.iter().filter_map(|&triangle| corners(mesh, triangle)).filter(has_no_area).count()
}

fn repair_uvs(uvs: &mut [Vec2]) -> usize {
    let broken = uvs.iter_mut().filter(|uv| !uv.is_finite());
    broken.map(|uv| *uv = Vec2::ZERO).count()
}

/// Normals that have no direction.
fn broken_normals(normals: &[Vec3]) -> usize {
    normals.iter().filter(|normal| normal.try_normalize().is_none()).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Mesh {
        Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]], ..Mesh::default() }
    }

    #[test]
    fn a_broken_normal_takes_that_of_its_triangle() {
        for broken in [Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::X * f32::INFINITY] {
            let mut mesh = triangle();
            mesh.normals = vec![Vec3::Z * 2.0, broken, Vec3::Z];
            assert_eq!(repair(&mut mesh), ["1 unusable normals are made from the triangles around them"]);
            assert_eq!(mesh.normals, [Vec3::Z; 3]);
        }
    }

    #[test]
    fn small_triangles_have_area_and_lines_have_none() {
        let mut mesh = triangle();
        mesh.positions.iter_mut().for_each(|position| *position *= 1e-30);
        assert_eq!(degenerate_triangles(&mesh), 0);
        mesh.triangles.push([0, 1, 1]);
        mesh.triangles.push([2, 2, 2]);
        assert_eq!(degenerate_triangles(&mesh), 2);
    }
}
