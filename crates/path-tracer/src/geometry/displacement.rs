//! Height fields on meshes, as dense triangles.
//!
//! Every triangle of the mesh is divided alike, so that no edge of a part spans more than a texel
//! of the map, and every new vertex moves along the interpolated normal by the map's height. The
//! base surface is the mesh as it is: its curvature is that of its own tessellation, which must be
//! fine enough. Heights are bilinear between texel centres, and the map repeats.

use glam::{DVec2, DVec3, Vec4};
use scene::{HeightMap, HeightRef, Mesh};

use super::Placement;

/// Into how many segments each edge of the mesh is divided: one per texel, or as many as `budget`
/// additional triangles allow, with a warning.
pub(super) fn segments(
    mesh: &Mesh,
    height: &HeightRef,
    map: &HeightMap,
    budget: u64,
    warnings: &mut Vec<String>,
) -> u32 {
    let texels = DVec2::new(f64::from(map.width), f64::from(map.height))
        * DVec2::from_array(height.uv_scale.map(f64::from));
    let uv = |index: u32| mesh.uvs.get(index as usize).map_or(DVec2::ZERO, |uv| uv.as_dvec2());
    let longest = mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .fold(0.0, |most: f64, (a, b)| most.max(((uv(a) - uv(b)) * texels).abs().max_element()));
    let wanted = longest.ceil().clamp(1.0, 65536.0);
    let affordable = (1.0 + budget as f64 / mesh.triangles.len().max(1) as f64).sqrt().floor();
    if wanted > affordable {
        warnings.push(format!(
            "mesh \"{}\": its height map \"{}\" wants {wanted} segments an edge, and {affordable} are made",
            mesh.name, map.name
        ));
    }
    wanted.min(affordable).max(1.0) as u32
}

/// A mesh with its height map on it, turned and scaled as in the world but not moved there; its
/// normals are those of the relief.
pub(super) fn displaced(
    mesh: &Mesh,
    placement: &Placement,
    height: &HeightRef,
    map: &HeightMap,
    segments: u32,
) -> Mesh {
    let mut fine = Mesh { name: mesh.name.clone(), ..Mesh::default() };
    let has_uvs = mesh.uvs.len() == mesh.positions.len();
    let field = Field { map, height };
    for &indices in &mesh.triangles {
        let corners = placement.wound(indices).map(|index| Corner::new(mesh, placement, index as usize));
        let patch = Patch::new(&corners);
        let first = fine.positions.len() as u32;
        for row in 0..=segments {
            for column in 0..=row {
                let weights = [segments - row, row - column, column];
                let vertex =
                    patch.vertex(&field, weights.map(|weight| f64::from(weight) / f64::from(segments)));
                fine.positions.push(vertex.position.as_vec3());
                fine.normals.push(vertex.normal.as_vec3());
                if has_uvs {
                    fine.uvs.push(vertex.uv.as_vec2());
                    fine.tangents.push(vertex.tangent);
                }
            }
        }
        let index = |row: u32, column: u32| first + row * (row + 1) / 2 + column;
        for row in 0..segments {
            for column in 0..=row {
                fine.triangles.push([index(row, column), index(row + 1, column), index(row + 1, column + 1)]);
                if column < row {
                    fine.triangles.push([
                        index(row, column),
                        index(row + 1, column + 1),
                        index(row, column + 1),
                    ]);
                }
            }
        }
    }
    fine
}

/// A vertex of the mesh, turned and scaled as in the world.
#[derive(Clone, Copy)]
struct Corner {
    position: DVec3,
    normal: DVec3,
    uv: DVec2,
    tangent: DVec3,
    bitangent_sign: f64,
}

impl Corner {
    fn new(mesh: &Mesh, placement: &Placement, index: usize) -> Self {
        let tangent = mesh.tangents.get(index).copied().unwrap_or(Vec4::X);
        Self {
            position: mesh.positions.get(index).map_or(DVec3::ZERO, |&local| placement.vector_world(local)),
            normal: mesh.normals.get(index).map_or(DVec3::Y, |&local| placement.normal_world(local)),
            uv: mesh.uvs.get(index).map_or(DVec2::ZERO, |uv| uv.as_dvec2()),
            tangent: placement.tangent_world(tangent.truncate()),
            bitangent_sign: f64::from(tangent.w) * placement.handedness(),
        }
    }
}

/// A vertex of the relief.
struct Vertex {
    position: DVec3,
    normal: DVec3,
    uv: DVec2,
    tangent: Vec4,
}

/// A triangle of the mesh.
struct Patch {
    corners: [Corner; 3],
    /// The order in which sums run: by position, so that triangles with a common edge round alike
    /// there and leave no gap.
    order: [usize; 3],
    /// How the base position and the normal change along u and v; `None` where the triangle's uv
    /// has no area.
    along_uv: Option<[[DVec3; 2]; 2]>,
}

impl Patch {
    fn new(corners: &[Corner; 3]) -> Self {
        let mut order = [0, 1, 2];
        order.sort_by(|&one, &other| {
            let key = |index: usize| corners[index].position.to_array();
            key(one).partial_cmp(&key(other)).unwrap_or(std::cmp::Ordering::Equal)
        });
        let [a, b, c] = corners;
        let (one, other) = (b.uv - a.uv, c.uv - a.uv);
        let area = one.perp_dot(other);
        let derivative = |value: fn(&Corner) -> DVec3| {
            let (first, second) = (value(b) - value(a), value(c) - value(a));
            [(first * other.y - second * one.y) / area, (second * one.x - first * other.x) / area]
        };
        let along_uv =
            (area != 0.0).then(|| [derivative(|corner| corner.position), derivative(|corner| corner.normal)]);
        Self { corners: *corners, order, along_uv }
    }

    /// The relief at the barycentric weights of a point.
    fn vertex(&self, field: &Field<'_>, weights: [f64; 3]) -> Vertex {
        let sum = |value: fn(&Corner) -> DVec3| {
            self.order
                .iter()
                .fold(DVec3::ZERO, |sum, &index| sum + value(&self.corners[index]) * weights[index])
        };
        let uv =
            self.order.iter().fold(DVec2::ZERO, |sum, &index| sum + self.corners[index].uv * weights[index]);
        let up = sum(|corner| corner.normal).normalize_or(DVec3::Y);
        let height = field.height(uv);
        let position = sum(|corner| corner.position) + up * height;
        let normal =
            self.along_uv.and_then(|along_uv| relief_normal(up, height, field.gradient(uv), along_uv));
        let normal = normal.unwrap_or(up);
        let tangent = sum(|corner| corner.tangent);
        let tangent =
            tangent.reject_from(normal).try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector());
        let sign = if self.corners[0].bitangent_sign < 0.0 { -1.0 } else { 1.0 };
        Vertex { position, normal, uv, tangent: tangent.as_vec3().extend(sign) }
    }
}

/// The normal of base + height * up, whose derivatives along u and v are
/// base' + height' * up + height * up', on the side of `up`. The base's derivatives count as they
/// are across `up`, which makes the normal nearly the same on both sides of an edge of the mesh.
fn relief_normal(
    up: DVec3,
    height: f64,
    [height_u, height_v]: [f64; 2],
    [[base_u, base_v], [up_u, up_v]]: [[DVec3; 2]; 2],
) -> Option<DVec3> {
    let along_u = base_u.reject_from(up) + up_u.reject_from(up) * height + up * height_u;
    let along_v = base_v.reject_from(up) + up_v.reject_from(up) * height + up * height_v;
    let normal = along_u.cross(along_v).try_normalize()?;
    Some(if normal.dot(up) < 0.0 { -normal } else { normal })
}

/// The height map as a material uses it.
struct Field<'a> {
    map: &'a HeightMap,
    height: &'a HeightRef,
}

impl Field<'_> {
    /// Texels along u and v per unit of the mesh's uv.
    fn texels_per_uv(&self) -> [f64; 2] {
        let [u, v] = self.height.uv_scale.map(f64::from);
        [u * f64::from(self.map.width), v * f64::from(self.map.height)]
    }

    /// The height in metres at a uv of the mesh.
    fn height(&self, uv: DVec2) -> f64 {
        let [x, y] = self.texels_per_uv();
        self.texels(uv.x * x, uv.y * y)
    }

    /// The slope in metres per unit of u and of v, over one texel around a uv of the mesh.
    fn gradient(&self, uv: DVec2) -> [f64; 2] {
        let [x_scale, y_scale] = self.texels_per_uv();
        let (x, y) = (uv.x * x_scale, uv.y * y_scale);
        [
            (self.texels(x + 0.5, y) - self.texels(x - 0.5, y)) * x_scale,
            (self.texels(x, y + 0.5) - self.texels(x, y - 0.5)) * y_scale,
        ]
    }

    /// The height in metres at a place in texels.
    fn texels(&self, x: f64, y: f64) -> f64 {
        let (x, y) = (x - 0.5, y - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let (x_weight, y_weight) = (x - column, y - row);
        let along_row =
            |row: f64| self.texel(column, row) * (1.0 - x_weight) + self.texel(column + 1.0, row) * x_weight;
        let value = along_row(row) * (1.0 - y_weight) + along_row(row + 1.0) * y_weight;
        value * f64::from(self.height.height_scale)
    }

    fn texel(&self, column: f64, row: f64) -> f64 {
        let (width, height) = (f64::from(self.map.width), f64::from(self.map.height));
        let (column, row) = (column.rem_euclid(width) as usize, row.rem_euclid(height) as usize);
        let (column, row) = (column.min(self.map.width as usize - 1), row.min(self.map.height as usize - 1));
        self.map.heights.get(row * self.map.width as usize + column).map_or(0.0, |&height| f64::from(height))
    }
}
