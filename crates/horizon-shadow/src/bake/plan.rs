//! What baking one azimuth takes: strips of rows, and the sweeps of each.

use std::{iter, ops::Range};

use super::{profile::Samples, uniforms::Step};
use crate::{Search, TableDesc, Wrap};

/// Bytes of scratch memory that a strip's or a sweep's buffer may take.
pub(crate) const SCRATCH_BYTES: u64 = 64 << 20;
/// Invocations whose scratch memory is interleaved, as in `bake-sweep.wgsl`.
const LANES: u32 = 32;
/// Up to so many samples the search looks at all of them, as `bake-search.wgsl` does near the texel.
const NEAR_SAMPLES: u32 = 8;

/// A strip of rows: its sweeps, then its search.
#[derive(Clone, Debug)]
pub(crate) struct Strip {
    pub(crate) sweeps: Vec<Step>,
    pub(crate) search: Step,
}

/// Sizes of the scratch buffers, bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Scratch {
    pub(crate) winners: u64,
    pub(crate) encoded: u64,
    pub(crate) points: u64,
    pub(crate) links: u64,
}

impl Scratch {
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            winners: self.winners.max(other.winners),
            encoded: self.encoded.max(other.encoded),
            points: self.points.max(other.points),
            links: self.links.max(other.links),
        }
    }
}

/// The strips that fill some rows of one azimuth, and the scratch memory that they need.
pub(crate) fn strips(
    desc: &TableDesc,
    all_rows: &Step,
    samples: &Samples,
    search: Search,
    rows: &Range<u32>,
) -> (Vec<Strip>, Scratch) {
    let row_bytes = u64::from(4 * all_rows.pitch.max(desc.size[0] * all_rows.nodes));
    let strip_rows = (SCRATCH_BYTES / row_bytes).clamp(1, u64::from(desc.size[1])) as u32;
    let mut scratch = Scratch::default();
    let mut strips = Vec::new();
    let mut first = rows.start;
    while first < rows.end {
        let end = rows.end.min(first + strip_rows);
        let mut step = Step { rows: [first, end], ..*all_rows };
        step.brute_force = u32::from(search == Search::BruteForce);
        let mut sweeps = Vec::new();
        if search == Search::Sweep {
            for node in 0..step.nodes {
                sweeps.extend(node_sweeps(desc, &step, samples, node, &mut scratch));
            }
        }
        // Where nothing can be swept all samples are near.
        if sweeps.is_empty() {
            step.brute_force = 1;
        }
        scratch.winners = scratch.winners.max(u64::from((end - first) * step.size[0] * step.nodes) * 4);
        scratch.encoded = scratch.encoded.max(u64::from((end - first) * step.pitch) * 4);
        strips.push(Strip { sweeps, search: step });
        first = end;
    }
    (strips, scratch)
}

/// The dispatches that sweep one node's lines, each within the scratch memory.
fn node_sweeps(
    desc: &TableDesc,
    step: &Step,
    samples: &Samples,
    node: u32,
    scratch: &mut Scratch,
) -> Vec<Step> {
    let seen = samples.last_seen[node as usize];
    if seen <= NEAR_SAMPLES {
        return Vec::new();
    }
    let along_y = samples.advance[1].abs() > samples.advance[0].abs();
    let [major, minor] = if along_y { [1, 0] } else { [0, 1] };
    // Odd counts are rounded up, so that the line reaches as far as the texel's own samples.
    let reach = seen.min(samples.last + 1) / 2;
    let block = reach.min(desc.size[major]);
    let drift = samples.advance[minor] / samples.advance[major].abs();
    let extent = desc.size[minor];
    let (line_first, lines) = match desc.wrap[minor] {
        Wrap::Repeat => (0, extent),
        Wrap::Clamp => {
            let sideways = (drift * (desc.size[major] - 1) as f32 + 0.5).floor() as i32;
            (-sideways.max(0), extent + sideways.unsigned_abs())
        }
    };
    let total = lines * desc.size[major].div_ceil(block);
    let point_bytes = u64::from(8 * (2 * reach + block));
    let link_bytes = u64::from(4 * (2 * reach + block));
    let at_once = (SCRATCH_BYTES / (point_bytes + link_bytes)).clamp(u64::from(LANES), 1 << 20) as u32;
    let at_once = (at_once / LANES * LANES).min(total.next_multiple_of(LANES));
    scratch.points = scratch.points.max(u64::from(at_once) * point_bytes);
    scratch.links = scratch.links.max(u64::from(at_once) * link_bytes);
    let slice = |first_invocation: u32| Step {
        node,
        along_y: u32::from(along_y),
        backward: u32::from(samples.advance[major] < 0.0),
        drift,
        line_first,
        lines,
        block,
        reach,
        first_invocation,
        invocations: at_once.min(total - first_invocation),
        ..*step
    };
    (0..total).step_by(at_once as usize).map(slice).collect()
}

impl TableDesc {
    /// All rows of the tables, as a list of ranges.
    pub(crate) fn all_rows(&self) -> Vec<Range<u32>> {
        iter::once(0..self.size[1]).collect()
    }
}

/// The rows of one azimuth's table that depend on the heights of `changed` rows, in order.
pub(crate) fn dependent_rows(desc: &TableDesc, samples: &Samples, changed: &Range<u32>) -> Vec<Range<u32>> {
    // One texel more on either side for bilinear heights, and one for the sweep's lines.
    let reach = i64::from((samples.advance[1] / samples.step * desc.radius_texels).abs().ceil() as u32);
    let (before, after) = if samples.advance[1] >= 0.0 { (reach, 0) } else { (0, reach) };
    let rows = i64::from(desc.size[1]);
    let (first, end) = (i64::from(changed.start) - before - 2, i64::from(changed.end) + after + 2);
    let range = |first: i64, end: i64| first.max(0) as u32..end.clamp(0, rows) as u32;
    match desc.wrap[1] {
        Wrap::Clamp => iter::once(range(first, end)).collect(),
        Wrap::Repeat if end - first >= rows => desc.all_rows(),
        Wrap::Repeat => {
            let turned = [range(first + rows, rows), range(first, end), range(0, end - rows)];
            turned.into_iter().filter(|rows| rows.start < rows.end).collect()
        }
    }
}

/// The union of ranges, in order and apart.
pub(crate) fn union(ranges: &mut Vec<Range<u32>>) {
    ranges.sort_by_key(|range| range.start);
    let mut merged: Vec<Range<u32>> = Vec::new();
    for range in ranges.drain(..).filter(|range| range.start < range.end) {
        match merged.last_mut() {
            Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
            _ => merged.push(range),
        }
    }
    *ranges = merged;
}
