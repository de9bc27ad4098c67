//! Meshes divided finely enough for a height map to displace their vertices.

use crate::vertices::DisplacedVertex;
use glam::{Vec2, Vec3};
use scene::{HeightMap, HeightRef, Mesh};

/// Texels of the height map between two vertices.
const TEXELS_PER_SEGMENT: f32 = 2.0;

/// The most triangles of one fine mesh.
const MAX_TRIANGLES: usize = 1 << 19;

/// A fine mesh: each triangle of the coarse one has vertices of its own.
pub(crate) struct FineMesh {
    pub(crate) vertices: Vec<DisplacedVertex>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// Divides every edge of a mesh alike, so that no segment spans more than two texels of the height
/// map or as many as the budget allows, and gives each vertex its height in metres. Heights that are
/// not finite count as `least`.
pub(crate) fn fine(mesh: &Mesh, height: &HeightRef, map: &HeightMap, least: f32) -> FineMesh {
    let segments = segments(mesh, height, map);
    let field = Field { map, height, least };
    let mut fine = FineMesh { vertices: Vec::new(), triangles: Vec::new() };
    for &indices in &mesh.triangles {
        fine.add(&Patch::new(mesh, indices), &field, segments);
    }
    fine
}

fn segments(mesh: &Mesh, height: &HeightRef, map: &HeightMap) -> u32 {
    let texels = Vec2::new(map.width as f32, map.height as f32) * Vec2::from(height.uv_scale);
    let uv = |index: u32| mesh.uvs.get(index as usize).copied().unwrap_or(Vec2::ZERO);
    let longest = mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(a, b)| ((uv(a) - uv(b)) * texels).abs().max_element())
        .fold(0.0, f32::max);
    let affordable = (MAX_TRIANGLES as f32 / mesh.triangles.len().max(1) as f32).sqrt();
    (longest / TEXELS_PER_SEGMENT).ceil().min(affordable).max(1.0) as u32
}

impl FineMesh {
    fn add(&mut self, patch: &Patch, field: &Field<'_>, segments: u32) {
        let first = self.vertices.len() as u32;
        for row in 0..=segments {
            for column in 0..=row {
                let weights = [segments - row, row - column, column];
                self.vertices
                    .push(patch.vertex(weights.map(|weight| weight as f32 / segments as f32), field));
            }
        }
        let index = |row: u32, column: u32| first + row * (row + 1) / 2 + column;
        for row in 0..segments {
            for column in 0..=row {
                let (upper, lower) = (index(row, column), index(row + 1, column));
                self.triangles.push([upper, lower, lower + 1]);
                if column < row {
                    self.triangles.push([upper, lower + 1, upper + 1]);
                }
            }
        }
    }
}

/// The corners of a triangle.
struct Patch {
    corners: [(Vec3, Vec3, Vec2); 3],
    /// The order in which sums run: by position, so that triangles with a common edge round alike
    /// there and leave no gap.
    order: [usize; 3],
}

impl Patch {
    fn new(mesh: &Mesh, indices: [u32; 3]) -> Self {
        let corners = indices.map(|index| {
            let index = index as usize;
            let normal = mesh.normals.get(index).copied().filter(|normal| normal.is_finite());
            let uv = mesh.uvs.get(index).copied().filter(|uv| uv.is_finite());
            let position = mesh.positions.get(index).copied().unwrap_or(Vec3::ZERO);
            (position, normal.unwrap_or(Vec3::ZERO), uv.unwrap_or(Vec2::ZERO))
        });
        let mut order = [0, 1, 2];
        order.sort_by(|&one, &other| {
            let key = |index: usize| corners[index].0.to_array();
            key(one).partial_cmp(&key(other)).unwrap_or(std::cmp::Ordering::Equal)
        });
        Self { corners, order }
    }

    fn vertex(&self, weights: [f32; 3], field: &Field<'_>) -> DisplacedVertex {
        let (mut position, mut normal, mut uv) = (Vec3::ZERO, Vec3::ZERO, Vec2::ZERO);
        for index in self.order {
            let (corner_position, corner_normal, corner_uv) = self.corners[index];
            position += corner_position * weights[index];
            normal += corner_normal * weights[index];
            uv += corner_uv * weights[index];
        }
        DisplacedVertex {
            position: position.to_array(),
            normal: normal.to_array(),
            uv: uv.to_array(),
            height_m: field.height_m(uv),
        }
    }
}

/// The height map as a material uses it; it repeats.
struct Field<'a> {
    map: &'a HeightMap,
    height: &'a HeightRef,
    least: f32,
}

impl Field<'_> {
    /// Bilinear between texel centres.
    fn height_m(&self, uv: Vec2) -> f32 {
        let size = Vec2::new(self.map.width as f32, self.map.height as f32);
        let scaled = uv * Vec2::from(self.height.uv_scale);
        let at = (scaled - scaled.floor()) * size - 0.5;
        let corner = at.floor();
        let weight = at - corner;
        let texel = |x: f32, y: f32| self.texel(corner.x + x, corner.y + y);
        let along_row = |y: f32| texel(0.0, y) * (1.0 - weight.x) + texel(1.0, y) * weight.x;
        (along_row(0.0) * (1.0 - weight.y) + along_row(1.0) * weight.y) * self.height.height_scale
    }

    fn texel(&self, column: f32, row: f32) -> f32 {
        let (width, height) = (i64::from(self.map.width), i64::from(self.map.height));
        let (column, row) = ((column as i64).rem_euclid(width), (row as i64).rem_euclid(height));
        let found = self.map.heights.get((row * width + column) as usize).copied();
        found.filter(|height| height.is_finite()).unwrap_or(self.least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> HeightMap {
        HeightMap {
            name: "map".into(),
            width: 4,
            height: 2,
            heights: (0..8).map(|index| index as f32).collect(),
        }
    }

    fn on_map(uv_scale: [f32; 2]) -> HeightRef {
        HeightRef { map: 0, height_scale: 0.5, uv_scale }
    }

    #[test]
    fn heights_are_bilinear_between_texel_centres_and_repeat() {
        let (map, height) = (map(), on_map([1.0, 1.0]));
        let field = Field { map: &map, height: &height, least: 0.0 };
        let near = |u: f32, v: f32, expected: f32| {
            let found = field.height_m(Vec2::new(u, v));
            assert!((found - 0.5 * expected).abs() < 1e-5, "{found} at ({u}, {v}), expected {expected}");
        };
        near(0.125, 0.25, 0.0);
        near(0.375, 0.25, 1.0);
        near(0.25, 0.25, 0.5);
        near(0.125, 0.5, 2.0);
        near(0.0, 0.25, 1.5);
        near(3.125, -0.75, 0.0);
    }

    #[test]
    fn a_fine_mesh_covers_the_coarse_one_with_its_winding() {
        let mesh = scene::shapes::sphere(8);
        let height = on_map([64.0, 64.0]);
        let fine = fine(&mesh, &height, &map(), 0.0);
        // The longest edges span 16 texels.
        assert_eq!(fine.triangles.len(), mesh.triangles.len() * 8 * 8);
        let area = |corner: &dyn Fn(u32) -> Vec3, triangles: &[[u32; 3]]| -> Vec3 {
            triangles
                .iter()
                .map(|triangle| {
                    let [a, b, c] = triangle.map(corner);
                    // Weighted by height, since the areas of a closed surface add up to 0.
                    (b - a).cross(c - a) * (2.0 + (a + b + c).y)
                })
                .sum()
        };
        let coarse = area(&|index| mesh.positions[index as usize], &mesh.triangles);
        let found = area(&|index| Vec3::from(fine.vertices[index as usize].position), &fine.triangles);
        assert!(coarse.y > 1.0 && found.distance(coarse) < 1e-2 * coarse.length(), "{found}, not {coarse}");
    }

    #[test]
    fn no_mesh_becomes_larger_than_the_budget() {
        let mesh = scene::shapes::plane(1);
        let fine = fine(&mesh, &on_map([1e6, 1e6]), &map(), 0.0);
        assert!((MAX_TRIANGLES / 2..=MAX_TRIANGLES).contains(&fine.triangles.len()));
    }
}
