//! What a mesh says about its height map as a whole.

use glam::DVec3;

use super::{VertexFrame, triangle::Triangle, vector};
use crate::Surface;

/// Shares of the area and of all azimuths there that may be more concave, and more convex, than the
/// range says: a crease, a pole or a few steep flanks must not stretch the range that the tables have
/// to serve, because candidates for the ends of a wide one suit nothing between them. What lies
/// outside is looked up with the candidates of the nearest end.
const PERCENTILES: [f64; 2] = [0.1, 0.9];

/// Normal curvatures of a point as parts of half the difference of its principal ones, cos(2 angle),
/// and the share of all azimuths that each stands for. The principal ones stand for more than
/// [`PERCENTILES`] leave out, so that a surface that is bent the same everywhere keeps its range.
const AZIMUTHS: [(f64, f64); 5] = [
    (-1.0, 0.125),
    (-std::f64::consts::FRAC_1_SQRT_2, 0.25),
    (0.0, 0.25),
    (std::f64::consts::FRAC_1_SQRT_2, 0.25),
    (1.0, 0.125),
];

/// What the tables must suit: the typical length of a texel (the geometric mean over the area of the
/// square root of a texel's area) and the range of normal curvatures over the area and all azimuths,
/// without the outermost tenth of them at either end.
///
/// `frames` are those of [`vertex_frames`](super::vertex_frames) for the same mesh; `map_size` is the
/// height map's in texels, and `uv_scale` how often it repeats over 0..1 of u and v. A host that draws
/// the mesh scaled by s multiplies the length by s and divides the curvatures by it. Where no vertex
/// has a usable frame, a texel of 1 metre and no curvature.
pub fn surface(
    positions: &[[f32; 3]],
    frames: &[VertexFrame],
    triangles: &[[u32; 3]],
    map_size: [u32; 2],
    uv_scale: [f32; 2],
) -> Surface {
    let texels = f64::from(map_size[0]) * f64::from(map_size[1]);
    let texels_per_uv_area = texels * f64::from(uv_scale[0]) * f64::from(uv_scale[1]);
    let areas = vertex_areas(positions, triangles);
    let (mut log_sum, mut weight_sum) = (0.0, 0.0);
    let mut curvatures = Vec::with_capacity(AZIMUTHS.len() * frames.len());
    for (frame, &weight) in frames.iter().zip(&areas) {
        let Some(metric) = Metric::new(frame) else { continue };
        let texel_m = (metric.area() / texels_per_uv_area.abs()).sqrt();
        let [low, high] = metric.principal_curvatures(frame.second_form);
        if !(weight > 0.0 && texel_m > 0.0 && texel_m.is_finite() && low.is_finite() && high.is_finite()) {
            continue;
        }
        log_sum += weight * texel_m.ln();
        weight_sum += weight;
        let (mean, half) = (0.5 * (low + high), 0.5 * (high - low));
        curvatures.extend(AZIMUTHS.map(|(part, share)| (mean + part * half, share * weight)));
    }
    if weight_sum <= 0.0 {
        return Surface { texel_m: 1.0, curvature_per_m: [0.0; 2] };
    }
    curvatures.sort_unstable_by(|one, other| one.0.total_cmp(&other.0));
    let range = PERCENTILES.map(|share| percentile(&curvatures, share));
    let within_f32 = |value: f64| value.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32;
    Surface {
        texel_m: within_f32((log_sum / weight_sum).exp()).max(f32::MIN_POSITIVE),
        curvature_per_m: range.map(within_f32),
    }
}

/// The first fundamental form of a frame that spans a plane.
pub(super) struct Metric {
    u: DVec3,
    v: DVec3,
    pub(super) e: f64,
    pub(super) f: f64,
    pub(super) g: f64,
    pub(super) determinant: f64,
}

impl Metric {
    /// `None` where the directions of u and v are one, or 0.
    pub(super) fn new(frame: &VertexFrame) -> Option<Self> {
        let (u, v) = (vector(frame.along_u), vector(frame.along_v));
        let (e, f, g) = (u.dot(u), u.dot(v), v.dot(v));
        let determinant = e * g - f * f;
        (determinant > 1e-12 * e * g && determinant.is_finite()).then_some(Self {
            u,
            v,
            e,
            f,
            g,
            determinant,
        })
    }

    /// Square metres per unit of u and v.
    fn area(&self) -> f64 {
        self.determinant.sqrt()
    }

    /// Components of a vector along u and v, without what is orthogonal to both.
    pub(super) fn contravariant(&self, vector: DVec3) -> [f64; 2] {
        let (u, v) = (vector.dot(self.u), vector.dot(self.v));
        [(self.g * u - self.f * v) / self.determinant, (self.e * v - self.f * u) / self.determinant]
    }

    /// Least and greatest normal curvature.
    fn principal_curvatures(&self, second_form: [f32; 3]) -> [f64; 2] {
        let [uu, uv, vv] = second_form.map(f64::from);
        // In orthonormal directions the mean and the half difference have no cancellation.
        let across = (self.determinant / self.e).sqrt();
        let skew = self.f / self.e;
        let xx = uu / self.e;
        let xy = (uv - skew * uu) / (self.e.sqrt() * across);
        let yy = (vv - 2.0 * skew * uv + skew * skew * uu) / (across * across);
        let (mean, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
        [mean - half, mean + half]
    }
}

/// A third of the area of each triangle at a vertex.
fn vertex_areas(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; positions.len()];
    for &[a, b, c] in triangles {
        let at = |index: u32| positions.get(index as usize).copied().map(vector);
        let (Some(first), Some(second), Some(third)) = (at(a), at(b), at(c)) else { continue };
        let Some(triangle) = Triangle::new([first, second, third]) else { continue };
        for index in [a, b, c] {
            areas[index as usize] += triangle.area / 3.0;
        }
    }
    areas
}

/// The value below which a share of the weights lies, of values in ascending order.
fn percentile(values: &[(f64, f64)], share: f64) -> f64 {
    let wanted = share * values.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut below = 0.0;
    for &(value, weight) in values {
        below += weight;
        if below >= wanted {
            return value;
        }
    }
    values.last().map_or(0.0, |&(value, _)| value)
}
