//! The binary tree of boxes that obvhs compresses: binned surface-area splits (Wald 2007), from the
//! top down.
//!
//! obvhs's own builder joins nearest neighbours, which takes quadratic time and makes trees without
//! bound on their depth where many boxes are equally near: a row of equal triangles, or one triangle
//! many times. This one needs O(n log n) for any boxes, and its depth is bounded.

use glam::Vec3A;
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node},
};

/// Levels below which boxes are halved by number instead of area; 2^24 leaves take 24 more.
const AREA_DEPTH: usize = 36;

/// Places at which a split is tried along each axis, and one more.
const BINS: usize = 16;

/// Boxes above which both halves are built at once.
const PARALLEL: usize = 4096;

/// A box of a triangle.
#[derive(Clone, Copy)]
struct Leaf {
    aabb: Aabb,
    center: Vec3A,
    index: u32,
}

/// The tree over at least one box, with one box in each leaf.
pub(super) fn build(boxes: &[Aabb]) -> Bvh2 {
    let leaf = |(index, aabb): (usize, &Aabb)| {
        let center = (aabb.min + aabb.max) * 0.5;
        Leaf { aabb: *aabb, center, index: index as u32 }
    };
    let mut leaves: Vec<Leaf> = boxes.iter().enumerate().map(leaf).collect();
    let mut nodes = vec![Bvh2Node::default(); 2 * boxes.len() - 1];
    if let Some((root, below)) = nodes.split_first_mut() {
        fill(root, below, &mut leaves, [1, 0], 0);
    }
    let primitive_indices = leaves.iter().map(|leaf| leaf.index).collect();
    Bvh2 { nodes, primitive_indices, children_are_ordered_after_parents: true, ..Bvh2::default() }
}

/// Fills the node over some leaves and the nodes below it: 2n - 2 for n leaves, of which the first
/// has index `first_node` in the tree, and the first leaf `first_leaf`.
fn fill(
    node: &mut Bvh2Node,
    below: &mut [Bvh2Node],
    leaves: &mut [Leaf],
    [first_node, first_leaf]: [usize; 2],
    depth: usize,
) {
    let aabb = leaves.iter().fold(Aabb::empty(), |sum, leaf| sum.union(&leaf.aabb));
    if leaves.len() < 2 {
        *node = Bvh2Node::new(aabb, 1, first_leaf as u32);
        return;
    }
    *node = Bvh2Node::new(aabb, 0, first_node as u32);
    let count = divide(leaves, depth);
    let (left_leaves, right_leaves) = leaves.split_at_mut(count);
    let (children, below) = below.split_at_mut(2);
    let (left_below, right_below) = below.split_at_mut(2 * count - 2);
    let [left, right] = children else { return };
    let left_first = [first_node + 2, first_leaf];
    let right_first = [first_node + 2 * count, first_leaf + count];
    let is_parallel = left_leaves.len() + right_leaves.len() > PARALLEL;
    let mut fill_left = || fill(left, left_below, left_leaves, left_first, depth + 1);
    let mut fill_right = || fill(right, right_below, right_leaves, right_first, depth + 1);
    if is_parallel {
        rayon::join(fill_left, fill_right);
    } else {
        fill_left();
        fill_right();
    }
}

/// Brings two or more leaves into an order in which the first and the rest are to be divided, and
/// says how many are the first: at least one, and not all.
fn divide(leaves: &mut [Leaf], depth: usize) -> usize {
    let (low, high) = leaves.iter().fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(low, high), leaf| {
        (low.min(leaf.center), high.max(leaf.center))
    });
    let extent = high - low;
    if depth < AREA_DEPTH && leaves.len() > 2 {
        let scale = (BINS as f32 * (1.0 - 1e-6)) / extent;
        let bin = |leaf: &Leaf, axis: usize| (((leaf.center - low) * scale)[axis] as usize).min(BINS - 1);
        let best = best_split(leaves, extent, &bin);
        if let Some((axis, split)) = best {
            let count = partition(leaves, |leaf| bin(leaf, axis) < split);
            if count > 0 && count < leaves.len() {
                return count;
            }
        }
    }
    let middle = leaves.len() / 2;
    let axis = extent.max_position();
    // The index decides between equal centres, so that the order is always the same.
    leaves.select_nth_unstable_by(middle, |one, other| {
        one.center[axis].total_cmp(&other.center[axis]).then(one.index.cmp(&other.index))
    });
    middle
}

/// The axis and the bin at which the sum of area times number is least.
fn best_split(
    leaves: &[Leaf],
    extent: Vec3A,
    bin: &impl Fn(&Leaf, usize) -> usize,
) -> Option<(usize, usize)> {
    let mut bins = [[(Aabb::empty(), 0_u32); BINS]; 3];
    for leaf in leaves {
        for (axis, bins) in bins.iter_mut().enumerate() {
            let (aabb, count) = &mut bins[bin(leaf, axis)];
            *aabb = aabb.union(&leaf.aabb);
            *count += 1;
        }
    }
    let mut best = None;
    let mut least = f32::INFINITY;
    for (axis, bins) in bins.iter().enumerate() {
        if extent[axis] <= 0.0 {
            continue;
        }
        // What lies from each bin upwards.
        let mut above = [0.0; BINS];
        let (mut aabb, mut count) = (Aabb::empty(), 0);
        for index in (1..BINS).rev() {
            aabb = aabb.union(&bins[index].0);
            count += bins[index].1;
            above[index] = cost(&aabb, count);
        }
        let (mut aabb, mut count) = (Aabb::empty(), 0);
        for index in 1..BINS {
            aabb = aabb.union(&bins[index - 1].0);
            count += bins[index - 1].1;
            let both = cost(&aabb, count) + above[index];
            if count > 0 && (count as usize) < leaves.len() && both < least {
                least = both;
                best = Some((axis, index));
            }
        }
    }
    best
}

fn cost(aabb: &Aabb, count: u32) -> f32 {
    if count == 0 { 0.0 } else { aabb.half_area() * count as f32 }
}

/// Brings those that are first to the front, and says how many they are.
fn partition(leaves: &mut [Leaf], is_first: impl Fn(&Leaf) -> bool) -> usize {
    let mut count = 0;
    for index in 0..leaves.len() {
        if is_first(&leaves[index]) {
            leaves.swap(index, count);
            count += 1;
        }
    }
    count
}
