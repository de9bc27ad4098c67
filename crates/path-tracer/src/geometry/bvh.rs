//! The hierarchy of boxes over the triangles: obvhs's compressed wide BVH (Ylitie, Karras and
//! Laine, 2017), made from a binary tree of our own.

use glam::{DVec3, UVec2, Vec3A};
use obvhs::{
    aabb::Aabb,
    cwbvh::{CwBvh, bvh2_to_cwbvh::bvh2_to_cwbvh},
    traverse,
};

use super::{
    Placed, tree,
    triangle::{Corners, Crossing, Shear},
};
use crate::Error;

/// Levels that obvhs's traversal stack holds.
const MAX_DEPTH: usize = 32;

/// A ray in the tracer's space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) origin: DVec3,
    /// Of unit length.
    pub(crate) direction: DVec3,
    /// Where it ends, in units of the tracer's space; may be infinite.
    pub(crate) length: f64,
    /// Decides at random, but always alike, which partly opaque triangles it meets.
    pub(crate) key: u64,
}

/// Where a ray met a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    pub(crate) triangle: u32,
    pub(crate) distance: f64,
    /// Weights of the corners as the triangle lies in the tracer's space.
    pub(crate) barycentric: [f64; 3],
    pub(crate) is_front: bool,
}

/// Whether a triangle whose material has opacity is there for a ray.
pub(crate) trait RayFilter {
    /// Asked only of triangles with [`Placed::has_opacity`].
    fn is_present(&self, ray: &Ray, hit: &Hit) -> bool;
}

/// The hierarchy.
#[derive(Debug)]
pub(super) struct Bvh {
    tree: CwBvh,
    low: DVec3,
    high: DVec3,
}

impl Bvh {
    /// The hierarchy over triangles with area, and the order into which they must be brought.
    pub(super) fn new(triangles: &[Placed], scene: &str) -> Result<(Self, Vec<u32>), Error> {
        if triangles.is_empty() {
            return Ok((Self { tree: CwBvh::default(), low: DVec3::ZERO, high: DVec3::ZERO }, Vec::new()));
        }
        let tight = triangles.iter().map(|triangle| bounds(&triangle.corners));
        let whole = tight.reduce(|one, other| one.union(&other)).unwrap_or_default();
        let extent = whole.max.abs().max(whole.min.abs()).max_element();
        let boxes: Vec<Aabb> = triangles.iter().map(|triangle| widened(&triangle.corners, extent)).collect();
        // Up to three triangles in a leaf, children ordered for traversal, no boxes kept beside.
        let mut tree = bvh2_to_cwbvh(&tree::build(&boxes), 3, true, false);
        let depth = depth(&tree);
        if depth > MAX_DEPTH {
            let found = format!("triangles that overlap so much that their hierarchy has {depth} levels");
            return Err(Error::new(scene, "instances", found, format!("at most {MAX_DEPTH} levels")));
        }
        let order = std::mem::take(&mut tree.primitive_indices);
        let (low, high) = (DVec3::from(whole.min.to_vec3()), DVec3::from(whole.max.to_vec3()));
        Ok((Self { tree, low, high }, order))
    }

    pub(super) fn closest_hit(
        &self,
        triangles: &[Placed],
        ray: &Ray,
        filter: &impl RayFilter,
    ) -> Option<Hit> {
        let (start, mut boxed) = self.clipped(ray)?;
        let shear = Shear::new(ray.origin, ray.direction);
        let mut length = ray.length;
        let mut closest = None;
        let mut state = self.tree.new_traversal(boxed.direction);
        let mut node;
        traverse!(self.tree, node, state, node.intersect_ray(&boxed, state.oct_inv4), {
            let index = state.primitive_id;
            if let Some(hit) = meets(triangles, index, ray, &shear, length, filter) {
                length = hit.distance;
                closest = Some(hit);
                boxed.tmax = ((length - start) as f32).next_up();
            }
        });
        closest
    }

    pub(super) fn is_occluded(&self, triangles: &[Placed], ray: &Ray, filter: &impl RayFilter) -> bool {
        let Some((_, boxed)) = self.clipped(ray) else { return false };
        let shear = Shear::new(ray.origin, ray.direction);
        let mut state = self.tree.new_traversal(boxed.direction);
        let mut node;
        let mut is_occluded = false;
        traverse!(self.tree, node, state, node.intersect_ray(&boxed, state.oct_inv4), {
            if meets(triangles, state.primitive_id, ray, &shear, ray.length, filter).is_some() {
                is_occluded = true;
                break;
            }
        });
        is_occluded
    }

    /// The ray in f32, from where it enters the box around everything (in f64, so that a far eye
    /// costs no digits), and the distance of that place from its origin. `None` where it misses.
    fn clipped(&self, ray: &Ray) -> Option<(f64, obvhs::ray::Ray)> {
        let inverse = ray.direction.recip();
        let (one, other) = ((self.low - ray.origin) * inverse, (self.high - ray.origin) * inverse);
        // A direction across an axis gives 0 * infinity in its plane; such an axis does not count.
        let or = |vector: DVec3, value: f64| vector.map(|x| if x.is_nan() { value } else { x });
        let enter = or(one.min(other), f64::NEG_INFINITY).max_element();
        let leave = or(one.max(other), f64::INFINITY).min_element();
        // Rounding must not lose a flat scene.
        let slack = 1e-9 * (enter.abs() + leave.abs()).min(1e30);
        if self.tree.nodes.is_empty() || enter > leave + slack || leave + slack < 0.0 || enter > ray.length {
            return None;
        }
        let start = (enter - slack).max(0.0);
        let origin = (ray.origin + ray.direction * start).as_vec3a();
        let length = (ray.length - start) as f32;
        // obvhs takes -0 for a direction upwards whose inverse points downwards; -0 + 0 is 0.
        let direction = ray.direction.as_vec3a() + Vec3A::ZERO;
        let boxed = obvhs::ray::Ray::new(origin, direction, 0.0, length.next_up());
        Some((start, boxed))
    }
}

/// Where a ray meets a triangle, if it does.
#[inline]
fn meets(
    triangles: &[Placed],
    index: u32,
    ray: &Ray,
    shear: &Shear,
    length: f64,
    filter: &impl RayFilter,
) -> Option<Hit> {
    let triangle = triangles.get(index as usize)?;
    let Crossing { distance, barycentric, is_front } = shear.intersect(&triangle.corners, 0.0, length)?;
    if triangle.is_single_sided && !is_front {
        return None;
    }
    let hit = Hit { triangle: index, distance, barycentric, is_front };
    (!triangle.has_opacity || filter.is_present(ray, &hit)).then_some(hit)
}

fn bounds(corners: &Corners) -> Aabb {
    let [a, b, c] = corners.map(Vec3A::from_array);
    Aabb::new(a.min(b).min(c), a.max(b).max(c))
}

/// A triangle's box, widened by what a ray in f32 may be off: 2^-20 of the whole scene, except
/// that small triangles grow by a quarter of their size at most, unless they lie so far out that
/// their own coordinates are no better known.
fn widened(corners: &Corners, extent: f32) -> Aabb {
    const RELATIVE: f32 = 1.0 / (1 << 20) as f32;
    let tight = bounds(corners);
    let size = (tight.max - tight.min).max_element();
    let farthest = tight.max.abs().max(tight.min.abs()).max_element();
    let margin = (RELATIVE * extent).min(0.25 * size).max(RELATIVE * farthest);
    Aabb::new(tight.min - Vec3A::splat(margin), tight.max + Vec3A::splat(margin))
}

/// Levels of nodes.
fn depth(tree: &CwBvh) -> usize {
    let mut deepest = 0;
    let mut open = vec![(0_usize, 1_usize)];
    while let Some((index, level)) = open.pop() {
        let Some(node) = tree.nodes.get(index) else { continue };
        deepest = deepest.max(level);
        let first = node.child_base_idx as usize;
        open.extend((0..node.imask.count_ones() as usize).map(|child| (first + child, level + 1)));
    }
    deepest
}
