//! The table of lobes that every map is judged on: roughness by incidence by direction.

use super::{
    lab::Query,
    maps::TestMap,
    truth::Truth,
};
use crate::{
    Context,
    technique::{Failure, TruthImage},
};
use diffuse_envmap::{Base, Horizon, model};
use image_error::Image;

/// Every how many directions the truth is made again with half the step.
const CHECK_EVERY: usize = 12;

/// Rows of lobes: one row for each roughness and incidence, one column for each direction.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    /// Roughness of each row.
    pub(super) roughness: Vec<f32>,
    /// The lobes, row by row.
    pub(super) queries: Vec<Query>,
    /// Lobes in a row.
    pub(super) columns: usize,
}

impl Grid {
    /// All pairs of a roughness and an incidence (degrees), each with `columns` directions that
    /// are spread over the sphere.
    pub(super) fn new(roughness: &[f32], incidence_deg: &[f64], columns: usize) -> Self {
        let pairs = || roughness.iter().flat_map(|&t| incidence_deg.iter().map(move |&angle| (t, angle)));
        let row = |(row, (t, angle)): (usize, (f32, f64))| {
            (0..columns).map(move |column| query(t, angle, column, columns, row))
        };
        Self {
            roughness: pairs().map(|(t, _)| t).collect(),
            queries: pairs().enumerate().flat_map(row).collect(),
            columns,
        }
    }

    /// Values of all lobes as an image.
    pub(super) fn image(&self, values: Vec<[f32; 3]>) -> Result<Image, Failure> {
        Ok(Image::new(self.columns, self.roughness.len(), values)?)
    }

    /// The integral of every lobe, and how far a sum of half the step is from it.
    pub(super) fn truth(&self, context: &Context, map: &TestMap) -> Result<TruthImage, Failure> {
        let stop = context.stop_flag();
        let radiance = parallel(self.queries.len(), &stop, |i| integral(&Truth::new(&map.held), &self.queries[i]))?;
        let checks: Vec<usize> = (0..self.queries.len()).filter(|i| i % self.columns % CHECK_EVERY == 0).collect();
        let finer = parallel(checks.len(), &stop, |i| integral(&Truth::finer(&map.held), &self.queries[checks[i]]))?;
        let mut variance = Vec::with_capacity(self.queries.len());
        for row in 0..self.roughness.len() {
            let inside = |i: usize| i / self.columns == row;
            let pairs = checks.iter().zip(&finer).filter(|&(&i, _)| inside(i));
            let (mut sum, mut count) = ([0.0; 3], 0.0);
            for (&i, fine) in pairs {
                for c in 0..3 {
                    sum[c] += (radiance[i][c] - fine[c]).powi(2);
                }
                count += 1.0;
            }
            variance.extend(std::iter::repeat_n(sum.map(|x| (x / f64::max(count, 1.0)) as f32), self.columns));
        }
        let pixels = radiance.iter().map(|value| value.map(|x| x as f32)).collect();
        Ok(TruthImage {
            image: self.image(pixels)?,
            variance_of_mean: Some(variance),
            mask: None,
            how: "quadrature in f64 over the map's texels; its variance is the difference to half the step".into(),
        })
    }

    /// An error of each roughness, its incidences together.
    pub(super) fn by_roughness(
        &self,
        found: &Image,
        truth: &Image,
        error: impl Fn(&[[f32; 3]], &[[f32; 3]]) -> f64,
    ) -> Vec<(f32, f64)> {
        let mut distinct = self.roughness.clone();
        distinct.dedup();
        let of = |image: &Image, t: f32| -> Vec<[f32; 3]> {
            let rows = image.pixels().chunks(self.columns.max(1)).zip(&self.roughness);
            rows.filter(|&(_, &row_t)| row_t == t).flat_map(|(row, _)| row.to_vec()).collect()
        };
        distinct.into_iter().map(|t| (t, error(&of(found, t), &of(truth, t)))).collect()
    }
}

/// The lobe of a column: normals on a Fibonacci sphere, another one for each row, and the view
/// turned by the golden angle.
fn query(t: f32, incidence_deg: f64, column: usize, columns: usize, row: usize) -> Query {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let y = 1.0 - 2.0 * (column as f64 + 0.5) / columns as f64;
    let radius = (1.0 - y * y).sqrt();
    let longitude = std::f64::consts::TAU * (column as f64 * GOLDEN + row as f64 * 0.137).fract();
    let normal = [radius * longitude.cos(), y, radius * longitude.sin()];
    let azimuth = std::f64::consts::TAU * (column as f64 * 0.754_877_666).fract();
    let toward_eye = model::around(normal, incidence_deg.to_radians(), azimuth);
    Query { normal: normal.map(|x| x as f32), view: toward_eye.map(|x| -x as f32), roughness: t }
}

/// The integral that a query asks for, from the numbers that the GPU gets.
pub(super) fn integral(truth: &Truth<'_>, query: &Query) -> [f64; 3] {
    let unit = |v: [f32; 3]| model::normalize_or(v.map(f64::from), [0.0, 1.0, 0.0]);
    let (normal, t) = (unit(query.normal), f64::from(query.roughness));
    let axis = model::base(model::mirror(unit(query.view), normal), normal, t, Base::Lerp);
    truth.radiance(axis, normal, t, Horizon::Discard)
}

/// Evaluates `f` for 0..count on all cores; fails where the run was asked to stop.
pub(super) fn parallel<T: Send>(
    count: usize,
    stop: &std::sync::atomic::AtomicBool,
    f: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, Failure> {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        while !stop.load(Ordering::Relaxed) {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                break;
            }
            done.push((i, f(i)));
        }
        done
    };
    let mut all: Vec<(usize, T)> = std::thread::scope(|scope| {
        let handles: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        handles.into_iter().flat_map(|handle| handle.join().unwrap_or_default()).collect()
    });
    if all.len() != count {
        return Err("stopped before the end".into());
    }
    all.sort_by_key(|&(i, _)| i);
    Ok(all.into_iter().map(|(_, value)| value).collect())
}

/// The mean of (x - y)^2 / (y^2 + eps), eps = 0.01 of the mean of y^2; 0 for a black truth that was
/// met.
pub(super) fn relative_mse(found: &[[f32; 3]], truth: &[[f32; 3]]) -> f64 {
    let pairs = || found.iter().flatten().zip(truth.iter().flatten()).map(|(&x, &y)| (f64::from(x), f64::from(y)));
    let count = 3.0 * truth.len() as f64;
    let eps = 0.01 * pairs().map(|(_, y)| y * y).sum::<f64>() / count;
    pairs().map(|(x, y)| if x == y { 0.0 } else { (x - y).powi(2) / (y * y + eps) }).sum::<f64>() / count
}

/// The mean of |x - y| over the mean of y.
pub(super) fn mean_absolute(found: &[[f32; 3]], truth: &[[f32; 3]]) -> f64 {
    let pairs = found.iter().flatten().zip(truth.iter().flatten());
    let (mut apart, mut sum) = (0.0, 0.0);
    for (&x, &y) in pairs {
        apart += (f64::from(x) - f64::from(y)).abs();
        sum += f64::from(y);
    }
    if apart == 0.0 { 0.0 } else { apart / sum }
}
