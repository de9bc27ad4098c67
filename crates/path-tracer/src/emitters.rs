//! Drawing points of the triangles that emit.

use glam::DVec3;

use crate::{
    geometry::Hit,
    world::{World, on_triangle},
};

/// The triangles that emit, each drawn in proportion to its area times its mean radiance.
#[derive(Debug, Default)]
pub(crate) struct Emitters {
    /// In ascending order.
    triangles: Vec<u32>,
    /// For each triangle the sum of the powers up to and with it.
    sums: Vec<f64>,
    /// Area in the tracer's space.
    areas: Vec<f64>,
}

/// A point that emits, as it is seen from elsewhere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EmitterSample {
    /// Unit, towards the point.
    pub(crate) direction: DVec3,
    /// Where on which triangle a ray in this direction ends.
    pub(crate) hit: Hit,
    /// Density per steradian.
    pub(crate) pdf: f64,
}

impl Emitters {
    pub(crate) fn new(world: &World) -> Self {
        let mut emitters = Self::default();
        let mut sum = 0.0;
        for triangle in 0..world.geometry.triangles.len() as u32 {
            let mean = world.mean_emission(triangle);
            if mean > 0.0 {
                let [a, b, c] = world.geometry.corners(triangle);
                let area = 0.5 * (b - a).cross(c - a).length();
                sum += mean * area;
                emitters.triangles.push(triangle);
                emitters.sums.push(sum);
                emitters.areas.push(area);
            }
        }
        emitters
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Draws a point that may shine on `position`; `None` where there are no emitters, or where the
    /// point shows its edge or a back that does not emit.
    pub(crate) fn sample(&self, world: &World, position: DVec3, u: [f64; 3]) -> Option<EmitterSample> {
        let total = *self.sums.last()?;
        let index = self.sums.partition_point(|&sum| sum <= u[2] * total).min(self.sums.len() - 1);
        let triangle = *self.triangles.get(index)?;
        let barycentric = on_triangle([u[0], u[1]]);
        let to_point = world.geometry.point(triangle, barycentric) - position;
        let distance = to_point.length();
        let direction = to_point.try_normalize()?;
        let facing = -direction.dot(world.geometry.normal(triangle));
        let is_front = facing > 0.0;
        if facing == 0.0 || (!is_front && world.geometry.triangles.get(triangle as usize)?.is_single_sided) {
            return None;
        }
        let hit = Hit { triangle, distance, barycentric, is_front };
        let pdf = self.density(index, distance, facing.abs());
        (pdf.is_finite() && pdf > 0.0).then_some(EmitterSample { direction, hit, pdf })
    }

    /// The density per steradian with which a ray's direction is drawn at its origin, given what
    /// it meets; 0 where that does not emit.
    pub(crate) fn pdf(&self, world: &World, direction: DVec3, hit: &Hit) -> f64 {
        let Ok(index) = self.triangles.binary_search(&hit.triangle) else { return 0.0 };
        let facing = direction.dot(world.geometry.normal(hit.triangle)).abs();
        if facing > 0.0 { self.density(index, hit.distance, facing) } else { 0.0 }
    }

    fn density(&self, index: usize, distance: f64, facing: f64) -> f64 {
        let at = |index: usize| self.sums.get(index).copied().unwrap_or(0.0);
        let before = if index == 0 { 0.0 } else { at(index - 1) };
        let chance = (at(index) - before) / self.sums.last().copied().unwrap_or(1.0);
        let area = self.areas.get(index).copied().unwrap_or(f64::INFINITY);
        chance / area * distance * distance / facing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        chi_squared::{p_value, significance},
        geometry::{Ray, RayFilter},
        random::Random,
    };
    use glam::{Mat4, Vec3};
    use scene::{Instance, Material, Mesh, Scene};

    struct Opaque;

    impl RayFilter for Opaque {
        fn is_present(&self, _: &Ray, _: &Hit) -> bool {
            true
        }
    }

    /// Triangles of different sizes and radiances around the origin, none before another, and one
    /// that does not emit.
    fn world() -> World {
        let mut scene = Scene::default();
        let corners = [
            [Vec3::new(-1.0, 1.0, 0.0), Vec3::new(1.0, 1.2, 0.3), Vec3::new(0.0, 1.5, 2.0)],
            [Vec3::new(1.0, -1.0, 0.0), Vec3::new(2.0, -1.0, 0.0), Vec3::new(2.0, -1.0, 3.0)],
            [Vec3::new(-3.0, 0.0, 0.0), Vec3::new(-3.0, -1.0, 0.0), Vec3::new(-3.0, 0.0, 0.5)],
            [Vec3::new(0.0, 0.0, -5.0), Vec3::new(0.0, 1.0, -5.0), Vec3::new(1.0, 0.0, -5.0)],
        ];
        for (index, positions) in corners.into_iter().enumerate() {
            let mut mesh =
                Mesh { positions: positions.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
            mesh.fill_normals();
            scene.meshes.push(mesh);
            let emissive = Vec3::splat([1.0, 0.5, 7.0, 0.0][index]);
            scene.materials.push(Material { emissive, double_sided: true, ..Material::default() });
            let world_from_local = Mat4::IDENTITY;
            scene.instances.push(Instance {
                name: String::new(),
                mesh: index,
                material: index,
                world_from_local,
            });
        }
        World::new(&scene).unwrap()
    }

    /// Van Oosterom and Strackee 1983.
    fn solid_angle(corners: [DVec3; 3]) -> f64 {
        let [a, b, c] = corners.map(DVec3::normalize);
        2.0 * a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    }

    #[test]
    fn points_are_drawn_by_area_and_radiance_and_densities_are_theirs() {
        const COUNT: u32 = 1_000_000;
        const STRIPS: usize = 8;
        let world = world();
        let position = world.geometry.space.tracer_from_world(DVec3::ZERO);
        let mut random = Random::new(0, 0, 0);
        let triangles = world.geometry.triangles.len();
        let mut found = vec![0.0; triangles * STRIPS * STRIPS];
        let mut inverse = vec![0.0; triangles];
        for _ in 0..COUNT {
            let sample = world.emitters.sample(&world, position, random.triple()).unwrap();
            let [a, b, _] = sample.hit.barycentric;
            // Strips of equal area: the part beyond weight a has the area (1 - a)^2.
            let across = ((1.0 - a).powi(2) * STRIPS as f64) as usize;
            let along = (b / (1.0 - a) * STRIPS as f64) as usize;
            let triangle = sample.hit.triangle as usize;
            found[(triangle * STRIPS + across.min(STRIPS - 1)) * STRIPS + along.min(STRIPS - 1)] += 1.0;
            inverse[triangle] += 1.0 / sample.pdf / f64::from(COUNT);
            // A ray in that direction meets that point, and knows the same density.
            let ray = Ray { origin: position, direction: sample.direction, length: f64::INFINITY, key: 0 };
            let hit = world.geometry.closest_hit(&ray, &Opaque).unwrap();
            let pdf = world.emitters.pdf(&world, sample.direction, &hit);
            assert!(hit.triangle == sample.hit.triangle && (pdf / sample.pdf - 1.0).abs() < 1e-6);
        }
        let powers: Vec<f64> = (0..triangles as u32)
            .map(|triangle| {
                let [a, b, c] = world.geometry.corners(triangle);
                (b - a).cross(c - a).length() * world.mean_emission(triangle)
            })
            .collect();
        let total: f64 = powers.iter().sum();
        let cells = (STRIPS * STRIPS) as f64;
        let expected: Vec<f64> = (0..found.len())
            .map(|bin| f64::from(COUNT) * powers[bin / (STRIPS * STRIPS)] / total / cells)
            .collect();
        let p = p_value(&found, &expected);
        println!("p {p:.3}");
        assert!(p > significance(1), "{p}");
        // The mean of 1 / density over a region is its solid angle.
        for (triangle, inverse) in inverse.into_iter().enumerate() {
            let corners = world.geometry.corners(triangle as u32).map(|corner| corner - position);
            let solid_angle = if powers[triangle] > 0.0 { solid_angle(corners) } else { 0.0 };
            println!("solid angle {inverse:.5}, expected {solid_angle:.5}");
            assert!((inverse - solid_angle).abs() <= 0.01 * solid_angle, "{inverse} {solid_angle}");
        }
    }
}
