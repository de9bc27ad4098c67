//! Which azimuths of the tables a light needs on a mesh.

use std::f64::consts::{PI, TAU};

use super::{VertexFrame, extent::Metric, unit, vector};

/// The azimuths that are looked up where a light from `light_local` (any length) meets a mesh, bit i
/// for azimuth i of `azimuths` (1..=64): for [`Frame::needed_azimuths`](crate::Frame).
///
/// `frames`, `normals` and `triangles` are as in [`vertex_frames`](super::vertex_frames). For each
/// triangle the arc of its corners' azimuths counts, and one azimuth more at each end, since what is
/// interpolated within a triangle does not keep to the arc exactly, and the base's torsion turns
/// azimuths by some degrees where the relief is high. All azimuths where the light
/// stands at the zenith of some point, or where a corner's frame has no area. Instances that are
/// turned have a light of their own in local space; under a scale that differs between the axes,
/// transform frames and normals to world space and give the light there.
pub fn needed_azimuths(
    frames: &[VertexFrame],
    normals: &[[f32; 3]],
    triangles: &[[u32; 3]],
    light_local: [f32; 3],
    map_size: [u32; 2],
    uv_scale: [f32; 2],
    azimuths: u32,
) -> u64 {
    let azimuths = azimuths.clamp(1, 64);
    let all = u64::MAX >> (64 - azimuths);
    let light = unit(vector(light_local));
    let texels: [f64; 2] = std::array::from_fn(|axis| f64::from(map_size[axis]) * f64::from(uv_scale[axis]));
    let angles: Vec<Option<f64>> = frames
        .iter()
        .zip(normals)
        .map(|(frame, &normal)| {
            let normal = unit(vector(normal));
            let along_surface = light - normal * light.dot(normal);
            let [u, v] = Metric::new(frame)?.contravariant(along_surface);
            let (x, y) = (u * texels[0], v * texels[1]);
            (along_surface.length_squared() > 1e-12 && x.hypot(y) > 0.0).then(|| y.atan2(x))
        })
        .collect();
    let mut needed = 0;
    for triangle in triangles {
        let corners = triangle.map(|index| angles.get(index as usize).copied().flatten());
        let arc = if let [Some(a), Some(b), Some(c)] = corners { arc(a, b, c) } else { None };
        let Some([first, last]) = arc else { return all };
        let step = TAU / f64::from(azimuths);
        let (first, last) = ((first / step).floor() as i64 - 1, (last / step).ceil() as i64 + 1);
        if last - first >= i64::from(azimuths) {
            return all;
        }
        for azimuth in first..=last {
            needed |= 1 << azimuth.rem_euclid(i64::from(azimuths));
        }
        if needed == all {
            break;
        }
    }
    needed
}

/// The arc of less than a half turn that holds three angles; `None` where there is none.
fn arc(a: f64, b: f64, c: f64) -> Option<[f64; 2]> {
    let from_a = |angle: f64| (angle - a + PI).rem_euclid(TAU) - PI;
    let (b, c) = (from_a(b), from_a(c));
    let (least, greatest) = (b.min(c).min(0.0), b.max(c).max(0.0));
    (greatest - least < PI).then_some([a + least, a + greatest])
}
