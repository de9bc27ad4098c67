//! Errors of shadows in their own units: pixels on the wrong side, texels between the shadows'
//! boundaries, degrees between horizons.

use crate::technique::{CustomMetric, TruthImage};
use image_error::Image;

pub(super) const MISCLASSIFIED: &str = "misclassified";
pub(super) const FALSELY_LIT: &str = "falsely lit";
pub(super) const FALSELY_DARK: &str = "falsely dark";
pub(super) const BOUNDARY_MEAN: &str = "boundary, mean";
pub(super) const BOUNDARY_95: &str = "boundary, 95 %";
pub(super) const HORIZON_MEAN: &str = "horizon, mean error";
pub(super) const HORIZON_99: &str = "horizon, 99 %";

/// Boundaries further apart than this count as this far, in texels: a shadow that is missing has
/// no other to be compared with.
pub(super) const FARTHEST_TEXELS: f64 = 16.0;

/// How many of the pixels that count are on the wrong side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Classes {
    pub(super) falsely_lit: f64,
    pub(super) falsely_dark: f64,
}

impl Classes {
    /// Fractions of all pixels that count; what is above half counts as lit.
    pub(super) fn of(found: &Image, truth: &TruthImage) -> Self {
        let (mut lit, mut dark, mut count) = (0, 0, 0);
        for (index, (found, expected)) in found.pixels().iter().zip(truth.image.pixels()).enumerate() {
            if truth.mask.as_ref().is_some_and(|mask| mask.get(index) != Some(&true)) {
                continue;
            }
            count += 1;
            match (found[0] > 0.5, expected[0] > 0.5) {
                (true, false) => lit += 1,
                (false, true) => dark += 1,
                _ => {}
            }
        }
        let all = f64::from(count.max(1));
        Self { falsely_lit: f64::from(lit) / all, falsely_dark: f64::from(dark) / all }
    }

    pub(super) fn misclassified(self) -> f64 {
        self.falsely_lit + self.falsely_dark
    }
}

/// Pixels on the wrong side.
pub(super) fn classes() -> Vec<CustomMetric> {
    let fraction = |name, of: fn(Classes) -> f64| CustomMetric {
        name,
        unit: "of the pixels",
        of: Box::new(move |found: &Image, truth: &TruthImage| of(Classes::of(found, truth))),
    };
    vec![
        fraction(MISCLASSIFIED, Classes::misclassified),
        fraction(FALSELY_LIT, |classes| classes.falsely_lit),
        fraction(FALSELY_DARK, |classes| classes.falsely_dark),
    ]
}

/// The same and how far boundaries are apart, of pictures of shadows that consist of square tiles
/// side by side, of so many pixels a texel.
pub(super) fn shadows(pixels_per_texel: f64) -> Vec<CustomMetric> {
    let boundary = |name, of: fn(&mut [f64]) -> f64| CustomMetric {
        name,
        unit: "texels",
        of: Box::new(move |found: &Image, truth: &TruthImage| {
            of(&mut boundary_distances(found, &truth.image, pixels_per_texel))
        }),
    };
    let mut all = classes();
    all.push(boundary(BOUNDARY_MEAN, |distances| mean(distances)));
    all.push(boundary(BOUNDARY_95, |distances| percentile(distances, 0.95)));
    all
}

/// Errors of tables of the sines of horizons.
pub(super) fn horizons() -> Vec<CustomMetric> {
    let metric = |name, of: fn(&mut [f64]) -> f64| CustomMetric {
        name,
        unit: "degrees",
        of: Box::new(move |found: &Image, truth: &TruthImage| {
            of(&mut horizon_errors_deg(found, &truth.image))
        }),
    };
    vec![metric(HORIZON_MEAN, |errors| mean(errors)), metric(HORIZON_99, |errors| percentile(errors, 0.99))]
}

/// Degrees between two horizons, each given by its sine.
pub(super) fn degrees_between(sin_a: f32, sin_b: f32) -> f64 {
    let angle = |sine: f32| f64::from(sine).clamp(-1.0, 1.0).asin().to_degrees();
    (angle(sin_a) - angle(sin_b)).abs()
}

fn horizon_errors_deg(found: &Image, truth: &Image) -> Vec<f64> {
    let pairs = found.pixels().iter().zip(truth.pixels());
    pairs.map(|(found, truth)| degrees_between(found[0], truth[0])).collect()
}

/// The mean, 0 of nothing.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The value below which a fraction of all lies, 0 of nothing.
pub(super) fn percentile(values: &mut [f64], fraction: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    values.get((fraction * last as f64).round() as usize).copied().unwrap_or(0.0)
}

/// For every place where either picture turns from lit to dark, how far the nearest such place of
/// the other is, in texels. Tiles are as wide as they are high.
fn boundary_distances(found: &Image, truth: &Image, pixels_per_texel: f64) -> Vec<f64> {
    let side = truth.height();
    let mut distances = Vec::new();
    for tile in 0..truth.width() / side.max(1) {
        let [found, truth] = [found, truth].map(|image| Boundary::of(image, tile * side, side));
        let scale = 0.5 / pixels_per_texel;
        for (from, to) in [(&found, &truth), (&truth, &found)] {
            let nearest = to.squared_distances();
            let here = from.is_edge.iter().zip(nearest).filter(|(is_edge, _)| **is_edge);
            distances.extend(here.map(|(_, squared)| (scale * squared.sqrt()).min(FARTHEST_TEXELS)));
        }
    }
    distances
}

/// Where a picture turns from lit to dark, on a grid of half pixels.
struct Boundary {
    side: usize,
    is_edge: Vec<bool>,
}

impl Boundary {
    fn of(image: &Image, first_column: usize, pixels: usize) -> Self {
        let lit = |x: usize, y: usize| image.pixels()[y * image.width() + first_column + x][0] > 0.5;
        let side = 2 * pixels;
        let mut is_edge = vec![false; side * side];
        for y in 0..pixels {
            for x in 0..pixels {
                if x + 1 < pixels && lit(x, y) != lit(x + 1, y) {
                    is_edge[2 * y * side + 2 * x + 1] = true;
                }
                if y + 1 < pixels && lit(x, y) != lit(x, y + 1) {
                    is_edge[(2 * y + 1) * side + 2 * x] = true;
                }
            }
        }
        Self { side, is_edge }
    }

    /// The squared distance from every place to the nearest edge, in half pixels; infinite where
    /// there is none (Felzenszwalb and Huttenlocher, a parabola for each place, row by row and
    /// then column by column).
    fn squared_distances(&self) -> Vec<f64> {
        let side = self.side;
        let mut field: Vec<f64> =
            self.is_edge.iter().map(|&is_edge| if is_edge { 0.0 } else { f64::INFINITY }).collect();
        for row in field.chunks_mut(side) {
            let lowest = lower_envelope(row);
            row.copy_from_slice(&lowest);
        }
        for column in 0..side {
            let values: Vec<f64> = (0..side).map(|row| field[row * side + column]).collect();
            for (row, value) in lower_envelope(&values).into_iter().enumerate() {
                field[row * side + column] = value;
            }
        }
        field
    }
}

/// The least of (x - i)^2 + values[i] over i, for every x.
fn lower_envelope(values: &[f64]) -> Vec<f64> {
    // Parabolas of the envelope, each with the place from which on it is the lowest.
    let mut kept: Vec<(usize, f64)> = Vec::new();
    for (i, &value) in values.iter().enumerate() {
        if value == f64::INFINITY {
            continue;
        }
        let mut from = f64::NEG_INFINITY;
        while let Some(&(j, start)) = kept.last() {
            let (a, b) = (i as f64, j as f64);
            let meet = ((value + a * a) - (values[j] + b * b)) / (2.0 * (a - b));
            if meet > start {
                from = meet;
                break;
            }
            kept.pop();
        }
        kept.push((i, from));
    }
    let mut current = 0;
    (0..values.len())
        .map(|x| {
            let place = x as f64;
            while kept.get(current + 1).is_some_and(|&(_, start)| start < place) {
                current += 1;
            }
            kept.get(current).map_or(f64::INFINITY, |&(i, _)| (place - i as f64).powi(2) + values[i])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(side: usize, lit: impl Fn(usize, usize) -> bool) -> Image {
        let pixel = |i: usize| [f32::from(lit(i % side, i / side)); 3];
        Image::new(side, side, (0..side * side).map(pixel).collect()).unwrap()
    }

    fn truth(image: Image) -> TruthImage {
        TruthImage { image, variance_of_mean: None, mask: None, how: String::new() }
    }

    #[test]
    fn pixels_on_the_wrong_side_are_counted() {
        let exact = truth(picture(10, |x, _| x < 5));
        let classes = Classes::of(&picture(10, |x, _| x < 7), &exact);
        assert!((classes.falsely_lit - 0.2).abs() < 1e-12 && classes.falsely_dark == 0.0);
        let classes = Classes::of(&picture(10, |x, _| x < 2), &exact);
        assert!((classes.falsely_dark - 0.3).abs() < 1e-12 && classes.falsely_lit == 0.0);
        let masked = TruthImage { mask: Some((0..100).map(|i| i % 10 < 5).collect()), ..exact };
        assert!(Classes::of(&picture(10, |x, _| x < 7), &masked).misclassified() == 0.0);
    }

    #[test]
    fn boundaries_are_as_far_apart_as_they_were_moved() {
        let exact = picture(32, |x, y| x + 2 * y < 40);
        let moved = picture(32, |x, _| x < 20);
        let further = picture(32, |x, _| x < 23);
        let distances = |found: &Image, truth: &Image| boundary_distances(found, truth, 2.0);
        assert!(distances(&exact, &exact).iter().all(|&distance| distance == 0.0));
        let found = distances(&further, &moved);
        // Three pixels at two pixels a texel.
        assert!(found.len() == 64 && found.iter().all(|&distance| (distance - 1.5).abs() < 1e-12));
        let nothing = picture(32, |_, _| true);
        assert!(distances(&nothing, &moved).iter().all(|&distance| distance == FARTHEST_TEXELS));
        assert!(distances(&nothing, &nothing).is_empty());
    }

    #[test]
    fn the_distance_transform_is_that_of_all_pairs() {
        let image = picture(16, |x, y| (x * 7 + y * 5) % 11 < 3);
        let boundary = Boundary::of(&image, 0, 16);
        let edges: Vec<usize> = (0..32 * 32).filter(|&i| boundary.is_edge[i]).collect();
        for (i, found) in boundary.squared_distances().into_iter().enumerate() {
            let squared = |&j: &usize| {
                ((i % 32) as f64 - (j % 32) as f64).powi(2) + ((i / 32) as f64 - (j / 32) as f64).powi(2)
            };
            let expected = edges.iter().map(squared).fold(f64::INFINITY, f64::min);
            assert!((found - expected).abs() < 1e-9, "{i}: {found} for {expected}");
        }
    }

    #[test]
    fn horizons_are_compared_as_angles() {
        assert!((degrees_between(1.0, 0.0) - 90.0).abs() < 1e-9);
        assert!((degrees_between(-0.5, 0.5) - 60.0).abs() < 1e-5);
        let mut values: Vec<f64> = (0..=100).map(f64::from).collect();
        assert!((percentile(&mut values, 0.95) - 95.0).abs() < 1e-12 && (mean(&values) - 50.0).abs() < 1e-12);
    }
}
