//! Meshes as they stand in the world, and the space in which they are traced.

use glam::{DMat3, DVec3, Vec3};
use scene::{Instance, Mesh, Scene};

use super::{MAX_TRIANGLES, displacement};
use crate::Error;

/// A mesh placed in the world.
#[derive(Clone, Debug)]
pub(crate) struct Placement {
    /// Index into the geometry's meshes.
    pub(crate) mesh: usize,
    /// Index into the scene's materials.
    pub(crate) material: usize,
    world_from_local: DMat3,
    translation: DVec3,
    /// Takes normals to the world, up to a positive factor.
    world_from_normal: DMat3,
    is_mirrored: bool,
}

impl Placement {
    fn new(instance: &Instance) -> Self {
        let columns = instance.world_from_local.as_dmat4();
        let world_from_local = DMat3::from_mat4(columns);
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = world_from_local;
        let is_mirrored = x.dot(y.cross(z)) < 0.0;
        let sign = if is_mirrored { -1.0 } else { 1.0 };
        // Cofactors: the inverse transpose times the determinant.
        let world_from_normal = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign;
        let translation = columns.w_axis.truncate();
        let Instance { mesh, material, .. } = *instance;
        Self { mesh, material, world_from_local, translation, world_from_normal, is_mirrored }
    }

    /// A mesh that is already turned and scaled, and only has to be moved as this one is.
    fn moved(&self, mesh: usize) -> Self {
        Self {
            mesh,
            material: self.material,
            world_from_local: DMat3::IDENTITY,
            translation: self.translation,
            world_from_normal: DMat3::IDENTITY,
            is_mirrored: false,
        }
    }

    /// A position in metres.
    pub(crate) fn position_world(&self, position_local: Vec3) -> DVec3 {
        self.vector_world(position_local) + self.translation
    }

    /// A position turned and scaled, but not moved.
    pub(super) fn vector_world(&self, position_local: Vec3) -> DVec3 {
        self.world_from_local * position_local.as_dvec3()
    }

    /// A unit normal.
    pub(crate) fn normal_world(&self, normal_local: Vec3) -> DVec3 {
        (self.world_from_normal * normal_local.as_dvec3()).normalize_or(DVec3::Y)
    }

    /// A unit tangent, or zero where the transform leaves none.
    pub(crate) fn tangent_world(&self, tangent_local: Vec3) -> DVec3 {
        (self.world_from_local * tangent_local.as_dvec3()).normalize_or_zero()
    }

    /// -1 where the transform mirrors, which turns the handedness of tangent frames over.
    pub(crate) fn handedness(&self) -> f64 {
        if self.is_mirrored { -1.0 } else { 1.0 }
    }

    /// What belongs to a triangle's corners, in the order in which they run counter-clockwise in
    /// the world. It is its own inverse.
    pub(crate) fn wound<T>(&self, [a, b, c]: [T; 3]) -> [T; 3] {
        if self.is_mirrored { [a, c, b] } else { [a, b, c] }
    }
}

/// Every mesh that is placed, and where. Meshes with a height map come out displaced.
pub(super) fn place(scene: &Scene, warnings: &mut Vec<String>) -> Result<(Vec<Mesh>, Vec<Placement>), Error> {
    let placed = scene.triangle_count();
    if placed > MAX_TRIANGLES {
        let found = format!("{placed} triangles as placed");
        return Err(Error::new(&scene.name, "instances", found, format!("at most {MAX_TRIANGLES}")));
    }
    let mut added = 0;
    let mut meshes = scene.meshes.clone();
    let mut placements = Vec::with_capacity(scene.instances.len());
    for instance in &scene.instances {
        let placement = Placement::new(instance);
        let height = scene.materials.get(instance.material).and_then(|material| material.height.as_ref());
        let map = height.and_then(|height| scene.height_maps.get(height.map));
        let (Some(height), Some(map)) = (height, map) else {
            placements.push(placement);
            continue;
        };
        let mesh = &scene.meshes[instance.mesh];
        let budget = (MAX_TRIANGLES / 2).saturating_sub(added).min(MAX_TRIANGLES - placed - added);
        let segments = displacement::segments(mesh, height, map, budget, warnings);
        added += mesh.triangles.len() as u64 * (u64::from(segments).pow(2) - 1);
        meshes.push(displacement::displaced(mesh, &placement, height, map, segments));
        placements.push(placement.moved(meshes.len() - 1));
    }
    Ok((meshes, placements))
}

/// The tracer's space: (world - `center`) * `units_per_metre`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Space {
    center: DVec3,
    /// A power of two.
    pub(crate) units_per_metre: f64,
}

impl Space {
    /// The space that suits the meshes as placed.
    pub(super) fn around(meshes: &[Mesh], placements: &[Placement]) -> Self {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for placement in placements {
            for &position in &meshes[placement.mesh].positions {
                let position = placement.position_world(position);
                low = low.min(position);
                high = high.max(position);
            }
        }
        if !(low.is_finite() && high.is_finite()) {
            return Self { center: DVec3::ZERO, units_per_metre: 1.0 };
        }
        let half = (high - low) * 0.5;
        // A single point has no extent; any scale will do.
        let extent = if half.max_element() > 0.0 { half.max_element() } else { 1.0 };
        let units_per_metre = 2.0_f64.powi(30 - extent.log2().ceil() as i32);
        Self { center: low + half, units_per_metre }
    }

    /// From metres in the world.
    pub(crate) fn tracer_from_world(&self, position_world: DVec3) -> DVec3 {
        (position_world - self.center) * self.units_per_metre
    }
}
