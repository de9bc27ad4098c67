//! FLIP of one tile of two displayed images, whatever tone mapper and exposure displayed them.
//!
//! A tile holds what the filters need around it, so tiles are independent: memory stays small for
//! any image, and threads take tiles.

use super::{
    color::{self, Rgb},
    filters::{Filters, Kernel},
};
use std::ops::Range;

/// Pixels a side of a tile. Wider than high, because rows are what a processor reads fast.
const TILE: [usize; 2] = [256, 64];

/// Of colour differences, before they are compared with the largest (2020, redistribution of errors).
const COLOR_EXPONENT: f32 = 0.7;
/// The share of the largest colour difference from which on errors are compressed.
const KNEE: f32 = 0.4;
/// The error at the knee.
const KNEE_ERROR: f32 = 0.95;

/// The part of an image that one thread works on.
#[derive(Clone)]
pub(super) struct Tile {
    pub(super) columns: Range<usize>,
    pub(super) rows: Range<usize>,
}

impl Tile {
    /// All tiles of an image, which cover it without overlap.
    pub(super) fn all(width: usize, height: usize) -> Vec<Self> {
        let ranges = |size: usize, step: usize| {
            (0..size).step_by(step).map(move |start| start..size.min(start + step))
        };
        let rows = ranges(height, TILE[1]);
        rows.flat_map(|rows| ranges(width, TILE[0]).map(move |columns| Self { columns, rows: rows.clone() }))
            .collect()
    }
}

/// What turns displayed pixels into an error.
pub(super) struct Evaluator {
    filters: Filters,
    /// The largest colour difference there is: that of green and blue (2020, colour difference).
    largest_color_difference: f32,
}

/// What the filters have made of one row of a tile.
struct Row {
    opponent: [Vec<f32>; 3],
    edge: [Vec<f32>; 2],
    point: [Vec<f32>; 2],
}

/// A tile and its surroundings, filtered along the rows.
struct Planes {
    width: usize,
    luminance: Vec<f32>,
    red_green: Vec<f32>,
    yellow_blue: [Vec<f32>; 2],
    smooth: Vec<f32>,
    edge: Vec<f32>,
    point: Vec<f32>,
}

impl Evaluator {
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(color::hunt_lab);
        Self {
            filters: Filters::new(pixels_per_degree),
            largest_color_difference: color::hyab(green, blue).powf(COLOR_EXPONENT),
        }
    }

    /// The errors of a tile, row by row. `found` and `reference` give the displayed colour of a
    /// pixel of images of `size`, in 0..=1.
    pub(super) fn errors(
        &self,
        tile: &Tile,
        size: [usize; 2],
        found: impl Fn(usize) -> Rgb,
        reference: impl Fn(usize) -> Rgb,
    ) -> Vec<f32> {
        let found = self.planes(tile, size, found);
        let reference = self.planes(tile, size, reference);
        let mut errors = Vec::with_capacity(tile.rows.len() * tile.columns.len());
        for row in 0..tile.rows.len() {
            let (found, reference) = (self.row(&found, row), self.row(&reference, row));
            errors.extend((0..tile.columns.len()).map(|x| self.error(&found, &reference, x)));
        }
        errors
    }

    /// Filters all rows that the tile's rows reach. Beyond the image its border goes on.
    fn planes(&self, tile: &Tile, [width, height]: [usize; 2], pixel: impl Fn(usize) -> Rgb) -> Planes {
        let radius = self.filters.radius;
        let rows = tile.rows.len() + 2 * radius;
        let mut planes = Planes::new(tile.columns.len(), rows);
        let mut padded = [(); 3].map(|()| vec![0.0; tile.columns.len() + 2 * radius]);
        for row in 0..rows {
            let y = (tile.rows.start + row).saturating_sub(radius).min(height - 1);
            for column in 0..tile.columns.len() + 2 * radius {
                let x = (tile.columns.start + column).saturating_sub(radius).min(width - 1);
                let opponent = color::opponent(pixel(y * width + x));
                padded.iter_mut().zip(opponent).for_each(|(padded, value)| padded[column] = value);
            }
            planes.filter(&self.filters, row, &padded);
        }
        planes
    }

    /// Filters one row of the tile along the columns.
    fn row(&self, planes: &Planes, row: usize) -> Row {
        let (filters, width) = (&self.filters, planes.width);
        let add = |out: &mut Vec<f32>, plane: &Vec<f32>, kernel: &Kernel| {
            kernel.add(out, |offset| {
                let start = (row + filters.radius).saturating_add_signed(offset) * width;
                &plane[start..start + width]
            });
        };
        let filtered = |plane: &Vec<f32>, kernel: &Kernel| {
            let mut out = vec![0.0; width];
            add(&mut out, plane, kernel);
            out
        };
        let mut yellow_blue = filtered(&planes.yellow_blue[0], &filters.yellow_blue[0]);
        add(&mut yellow_blue, &planes.yellow_blue[1], &filters.yellow_blue[1]);
        Row {
            opponent: [
                filtered(&planes.luminance, &filters.luminance),
                filtered(&planes.red_green, &filters.red_green),
                yellow_blue,
            ],
            edge: [filtered(&planes.edge, &filters.smooth), filtered(&planes.smooth, &filters.edge)],
            point: [filtered(&planes.point, &filters.smooth), filtered(&planes.smooth, &filters.point)],
        }
    }

    /// The difference of one pixel: that of its colours, amplified by that of its features
    /// (2020, final difference).
    fn error(&self, found: &Row, reference: &Row, x: usize) -> f32 {
        let lab =
            |row: &Row| color::hunt_lab(color::rgb_from_opponent([0, 1, 2].map(|i| row.opponent[i][x])));
        let color = self.color_error(color::hyab(lab(found), lab(reference)));
        color.powf(1.0 - feature_error(found, reference, x))
    }

    /// Compresses the largest differences into the last twentieth of the range (2020, redistribution of errors).
    fn color_error(&self, difference: f32) -> f32 {
        let share = difference.powf(COLOR_EXPONENT) / self.largest_color_difference;
        let error = if share < KNEE {
            share * KNEE_ERROR / KNEE
        } else {
            KNEE_ERROR + (share - KNEE) / (1.0 - KNEE) * (1.0 - KNEE_ERROR)
        };
        error.clamp(0.0, 1.0)
    }
}

/// The larger of the differences in edges and in points, in 0..=1 (2020, feature pipeline).
fn feature_error(found: &Row, reference: &Row, x: usize) -> f32 {
    let strength = |[along, across]: &[Vec<f32>; 2]| along[x].hypot(across[x]);
    let edge = (strength(&found.edge) - strength(&reference.edge)).abs();
    let point = (strength(&found.point) - strength(&reference.point)).abs();
    (edge.max(point) * std::f32::consts::FRAC_1_SQRT_2).sqrt().min(1.0)
}

impl Planes {
    fn new(width: usize, rows: usize) -> Self {
        let plane = || vec![0.0; width * rows];
        Self {
            width,
            luminance: plane(),
            red_green: plane(),
            yellow_blue: [plane(), plane()],
            smooth: plane(),
            edge: plane(),
            point: plane(),
        }
    }

    /// Fills one row of each plane from the opponent channels of that row, which are wider by the
    /// radius of the filters on both sides.
    fn filter(&mut self, filters: &Filters, row: usize, [luminance, red_green, yellow_blue]: &[Vec<f32>; 3]) {
        let (width, start) = (self.width, row * self.width);
        let add = |plane: &mut Vec<f32>, padded: &Vec<f32>, kernel: &Kernel| {
            kernel.add(&mut plane[start..start + width], |offset| {
                let first = filters.radius.saturating_add_signed(offset);
                &padded[first..first + width]
            });
        };
        add(&mut self.luminance, luminance, &filters.luminance);
        add(&mut self.red_green, red_green, &filters.red_green);
        add(&mut self.yellow_blue[0], yellow_blue, &filters.yellow_blue[0]);
        add(&mut self.yellow_blue[1], yellow_blue, &filters.yellow_blue[1]);
        add(&mut self.smooth, luminance, &filters.smooth);
        add(&mut self.edge, luminance, &filters.edge);
        add(&mut self.point, luminance, &filters.point);
    }
}
