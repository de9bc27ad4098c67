//! Closed shapes with sharp edges.

use glam::{Vec2, Vec3};

use super::grid::{Point, cells, push_vertex, surface, turn_rad};
use crate::Mesh;

/// A cylinder of radius 1 around the Y axis from y = -1 to y = 1, closed by two discs, of
/// `segments` (3..=1024) columns. The discs show the image's inscribed circle.
pub fn cylinder(segments: u32) -> Mesh {
    let columns = cells(segments, 3);
    let rim = |u: f32| {
        let (sin, cos) = turn_rad(u).sin_cos();
        Vec3::new(sin, 0.0, cos)
    };
    let mut mesh = surface("cylinder", columns, 1, |u, v| Point {
        position: rim(u) + Vec3::Y * (1.0 - 2.0 * v),
        normal: rim(u),
        tangent: Vec3::Y.cross(rim(u)),
    });
    for side in [1.0, -1.0] {
        let point = |position: Vec3| Point { position, normal: Vec3::Y * side, tangent: Vec3::X };
        let centre = mesh.positions.len() as u32;
        push_vertex(&mut mesh, point(Vec3::Y * side), Vec2::splat(0.5));
        for column in 0..columns {
            // Below, the rim runs the other way, which turns the triangles over.
            let wall_column = if side > 0.0 { column } else { columns - column };
            let position = rim(wall_column as f32 / columns as f32);
            let uv = Vec2::new(0.5 + position.x / 2.0, 0.5 + side * position.z / 2.0);
            push_vertex(&mut mesh, point(position + Vec3::Y * side), uv);
        }
        let rim_vertex = |column: usize| centre + 1 + (column % columns) as u32;
        mesh.triangles
            .extend((0..columns).map(|column| [centre, rim_vertex(column), rim_vertex(column + 1)]));
    }
    mesh
}

/// The box of half-extent 1 around the origin; each face shows the whole image.
pub fn cuboid() -> Mesh {
    let mut mesh = Mesh { name: "box".into(), ..Mesh::default() };
    // Each face's right and up as one looks at it.
    let faces = [
        (Vec3::X, Vec3::Y),
        (Vec3::NEG_Z, Vec3::Y),
        (Vec3::NEG_X, Vec3::Y),
        (Vec3::Z, Vec3::Y),
        (Vec3::X, Vec3::NEG_Z),
        (Vec3::X, Vec3::Z),
    ];
    for (right, up) in faces {
        let normal = right.cross(up);
        mesh.append(&surface("box", 1, 1, |u, v| Point {
            position: normal + right * (2.0 * u - 1.0) + up * (1.0 - 2.0 * v),
            normal,
            tangent: right,
        }));
    }
    mesh
}
