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
