//! How much light a GGX lobe under Schlick's law reflects in all, as a table over roughness and
//! direction, integrated once when it is first asked for.
//!
//! Schlick's reflectance is linear in the reflectances at normal and at grazing incidence, so two
//! numbers an entry serve all materials: the total is `normal * a + grazing * b`.

use std::sync::LazyLock;

use glam::DVec3;

use super::{half_vector, is_above, shape::Shape};

/// Entries along roughness, from 0 to 1, and along the square root of the cosine, which keeps
/// them close where the totals change fast.
const SIDE: usize = 33;

/// Samples an entry is integrated with, along each of two dimensions.
const STRATA: usize = 24;

/// `a` and `b` of the opening comment.
type Total = [f64; 2];

struct Table {
    /// Rows of roughness.
    directional: Vec<Total>,
    /// The means over the hemisphere, weighted by the cosine.
    mean: Vec<Total>,
}

static TABLE: LazyLock<Table> = LazyLock::new(Table::new);

/// The share of light that the lobe of this roughness, 0..=1, reflects towards a direction with this
/// cosine to the normal, 0..=1. Within 1e-3 of the integral.
pub(super) fn directional(roughness: f64, cosine: f64, normal: f64, grazing: f64) -> f64 {
    let (row, along_row) = place(roughness);
    let (column, along_column) = place(cosine.max(0.0).sqrt());
    let entry = |row: usize, column: usize| TABLE.directional[row * SIDE + column];
    let in_row = |row| blend(entry(row, column), entry(row, column + 1), along_column);
    let [a, b] = blend(in_row(row), in_row(row + 1), along_row);
    normal * a + grazing * b
}

/// The mean of [`directional`] over the hemisphere, weighted by the cosine.
pub(super) fn mean(roughness: f64, normal: f64, grazing: f64) -> f64 {
    let (row, along) = place(roughness);
    let [a, b] = blend(TABLE.mean[row], TABLE.mean[row + 1], along);
    normal * a + grazing * b
}

/// The entry before a place in 0..=1, and the way from it to the next one.
fn place(unit: f64) -> (usize, f64) {
    let position = unit.clamp(0.0, 1.0) * (SIDE - 1) as f64;
    let entry = (position as usize).min(SIDE - 2);
    (entry, position - entry as f64)
}

fn blend(a: Total, b: Total, share: f64) -> Total {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
}

impl Table {
    fn new() -> Self {
        let unit = |index: usize| index as f64 / (SIDE - 1) as f64;
        let rows = (0..SIDE).map(unit);
        let directional: Vec<Total> = rows
            .flat_map(|roughness| (0..SIDE).map(move |column| integrate(roughness, unit(column).powi(2))))
            .collect();
        let mean = directional.chunks_exact(SIDE).map(mean_of_row).collect();
        Self { directional, mean }
    }
}

/// The total for one direction.
fn integrate(roughness: f64, cosine: f64) -> Total {
    // Below this cosine the totals have reached their limit.
    let cosine = cosine.max(1e-6);
    let outgoing = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let shape = Shape::ggx(roughness);
    if shape.is_delta() {
        return divided(cosine);
    }
    let mut sum = [0.0; 2];
    for index in 0..STRATA * STRATA {
        let stratum = |index: usize| (index as f64 + 0.5) / STRATA as f64;
        let incoming = shape.sample(outgoing, [stratum(index / STRATA), stratum(index % STRATA)]);
        let [value, pdf] = shape.evaluate(outgoing, incoming);
        if is_above(incoming) && pdf > 0.0 {
            let [a, b] = divided(outgoing.dot(half_vector(outgoing, incoming)));
            sum = [sum[0] + a * value / pdf, sum[1] + b * value / pdf];
        }
    }
    sum.map(|sum| sum / (STRATA * STRATA) as f64)
}

/// Schlick's law at a cosine, as the factors of its two reflectances.
fn divided(cosine: f64) -> Total {
    let away = (1.0 - cosine).clamp(0.0, 1.0).powi(5);
    [1.0 - away, away]
}

/// The integral of 2 cos d(cos) over entries that are linear in the root of the cosine, by
/// Simpson's rule between them.
fn mean_of_row(row: &[Total]) -> Total {
    let mut sum = [0.0; 2];
    for (column, pair) in row.windows(2).enumerate() {
        for (at, weight) in [(0.0, 1.0), (0.5, 4.0), (1.0, 1.0)] {
            let root = (column as f64 + at) / (SIDE - 1) as f64;
            // cos = root^2, so 2 cos d(cos) = 4 root^3 d(root).
            let weight = weight / 6.0 / (SIDE - 1) as f64 * 4.0 * root.powi(3);
            let [a, b] = blend(pair[0], pair[1], at);
            sum = [sum[0] + weight * a, sum[1] + weight * b];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_surface_has_schlick_s_law_and_its_mean() {
        for cosine in [0.0_f64, 0.01, 0.3, 0.7, 1.0] {
            let expected = 0.04 + 0.96 * (1.0 - cosine).powi(5);
            let found = directional(0.0, cosine, 0.04, 1.0);
            assert!((found - expected).abs() < 1e-3, "{cosine}: {found} {expected}");
        }
        assert!((mean(0.0, 0.04, 1.0) - (0.04 + 0.96 / 21.0)).abs() < 1e-3);
    }

    #[test]
    fn a_full_reflector_of_roughness_1_has_its_closed_form() {
        // The integral of l / (v + l) over the cosine l.
        for cosine in [0.05_f64, 0.2, 0.5, 0.9, 1.0] {
            let expected = 1.0 - cosine * ((1.0 + cosine) / cosine).ln();
            let found = directional(1.0, cosine, 1.0, 1.0);
            assert!((found - expected).abs() < 2e-3, "{cosine}: {found} {expected}");
        }
    }
}
