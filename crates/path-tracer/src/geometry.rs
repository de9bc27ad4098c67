//! The scene's triangles, placed in the world, and what rays meet of them.
//!
//! The tracer's own space has its origin in the middle of the scene and is scaled by a power of two
//! so that every scene spans about 2^31 units: whether a scene measures 1e-3 m or 1e6 m, or lies
//! far from the world's origin, the numbers are the same. (obvhs skips boxes that end within 1e-4 of
//! a ray's origin; at this scale that is less than f64 resolves.) Corners are rounded to f32 there,
//! 2^-24 of the scene's extent, and everything computed from them is f64: the hierarchy of boxes,
//! widened by its rounding errors, only finds the candidates.

mod bvh;
mod displacement;
mod placement;
mod tree;
mod triangle;

pub(crate) use bvh::{Hit, Ray, RayFilter};
pub(crate) use placement::{Placement, Space};

use bvh::Bvh;
use glam::DVec3;
use scene::{AlphaMode, Mesh, Scene};

use crate::Error;
use triangle::Corners;

/// The most triangles of a scene, counted as placed and displaced. Each takes about 150 bytes, and
/// about 400 while the hierarchy is built. Height maps divide meshes into half as many at most.
pub const MAX_TRIANGLES: u64 = 1 << 24;

/// Which triangle of which placed mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TriangleId {
    pub(crate) placement: u32,
    pub(crate) triangle: u32,
}

/// Where a triangle lies, and what a ray needs to know about it before it counts as met.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) corners: Corners,
    /// Only its front can be met.
    pub(crate) is_single_sided: bool,
    /// Its material decides where it can be met.
    pub(crate) has_opacity: bool,
}

/// All triangles, ready for rays.
#[derive(Debug)]
pub(crate) struct Geometry {
    pub(crate) space: Space,
    pub(crate) placements: Vec<Placement>,
    pub(crate) meshes: Vec<Mesh>,
    /// In the order of the hierarchy's leaves, as are the ids.
    pub(crate) triangles: Vec<Placed>,
    pub(crate) ids: Vec<TriangleId>,
    bvh: Bvh,
    pub(crate) warnings: Vec<String>,
}

impl Geometry {
    /// Places every triangle of a scene that passes [`Scene::check`].
    pub(crate) fn new(scene: &Scene) -> Result<Self, Error> {
        let mut warnings = Vec::new();
        let (meshes, placements) = placement::place(scene, &mut warnings)?;
        let space = Space::around(&meshes, &placements);
        let count: usize = placements.iter().map(|placement| meshes[placement.mesh].triangles.len()).sum();
        let mut triangles = Vec::with_capacity(count);
        let mut ids = Vec::with_capacity(count);
        for (placement_index, placement) in placements.iter().enumerate() {
            let Some(material) = scene.materials.get(placement.material) else { continue };
            let mesh = &meshes[placement.mesh];
            let is_single_sided = !material.double_sided;
            let has_opacity = material.alpha_mode != AlphaMode::Opaque;
            let internal: Vec<[f32; 3]> = mesh
                .positions
                .iter()
                .map(|&position| {
                    space.tracer_from_world(placement.position_world(position)).as_vec3().to_array()
                })
                .collect();
            for (triangle, indices) in mesh.triangles.iter().enumerate() {
                let corners = placement.wound(indices.map(|index| internal[index as usize]));
                if has_area(&corners) {
                    triangles.push(Placed { corners, is_single_sided, has_opacity });
                    ids.push(TriangleId { placement: placement_index as u32, triangle: triangle as u32 });
                }
            }
        }
        if triangles.len() < count {
            warnings.push(format!("{} triangles without area were left out", count - triangles.len()));
        }
        let (bvh, order) = Bvh::new(&triangles, &scene.name)?;
        let triangles = order.iter().map(|&index| triangles[index as usize]).collect();
        let ids = order.iter().map(|&index| ids[index as usize]).collect();
        Ok(Self { space, placements, meshes, triangles, ids, bvh, warnings })
    }

    /// The nearest triangle that a ray meets.
    pub(crate) fn closest_hit(&self, ray: &Ray, filter: &impl RayFilter) -> Option<Hit> {
        self.bvh.closest_hit(&self.triangles, ray, filter)
    }

    /// Whether a ray meets any triangle.
    pub(crate) fn is_occluded(&self, ray: &Ray, filter: &impl RayFilter) -> bool {
        self.bvh.is_occluded(&self.triangles, ray, filter)
    }

    /// A point of a triangle, in the tracer's space.
    pub(crate) fn point(&self, triangle: u32, barycentric: [f64; 3]) -> DVec3 {
        let corners = self.corners(triangle);
        corners[0] * barycentric[0] + corners[1] * barycentric[1] + corners[2] * barycentric[2]
    }

    /// The corners of a triangle, in the tracer's space.
    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].corners.map(|corner| DVec3::from_array(corner.map(f64::from)))
    }

    /// The unit normal of a triangle's front.
    pub(crate) fn normal(&self, triangle: u32) -> DVec3 {
        cross(&self.triangles[triangle as usize].corners).normalize()
    }

    /// The origin of a ray that leaves a point of a triangle towards the side of `normal`.
    ///
    /// The point is known to a few units in the last place of f64, and so is the distance at which
    /// the ray would meet the triangle again; a shift of 2^-40 of the coordinates is well above both,
    /// and a millionth of a micrometre in a scene of a metre.
    pub(crate) fn origin_above(&self, triangle: u32, point: DVec3, normal: DVec3) -> DVec3 {
        let largest =
            self.corners(triangle).iter().fold(0.0, |most: f64, corner| most.max(corner.abs().max_element()));
        point + normal * (largest * (0.5_f64).powi(40))
    }
}

/// Twice the area times the normal of the front.
fn cross(corners: &Corners) -> DVec3 {
    let [a, b, c] = corners.map(|corner| DVec3::from_array(corner.map(f64::from)));
    (b - a).cross(c - a)
}

fn has_area(corners: &Corners) -> bool {
    let area = cross(corners).length_squared();
    area > 0.0 && area.is_finite()
}

#[cfg(test)]
mod tests;
