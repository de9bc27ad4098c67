//! What `figures` shows: pictures, tables and plots with captions.

use super::Make;
use image_error::Image;

/// One figure or table.
pub struct Figure {
    /// A short name for links: `figure-6`.
    pub name: &'static str,
    /// What it is: `Figure 6: t = 0 ... 0.8 on one object`.
    pub title: &'static str,
    /// What there is to see in it.
    pub caption: &'static str,
    /// Makes it.
    pub make: Make<Vec<Block>>,
}

/// A part of a figure, from the top.
#[derive(Clone, Debug)]
pub enum Block {
    /// Pictures side by side, wrapped to the page.
    Pictures(Vec<Labelled>),
    /// A table: the head, and rows of as many cells.
    Table {
        /// Column titles.
        head: Vec<String>,
        /// Cells.
        rows: Vec<Vec<String>>,
    },
    /// A plot.
    Plot(Plot),
    /// A paragraph.
    Text(String),
}

/// A picture with a label under it.
#[derive(Clone, Debug)]
pub struct Labelled {
    /// One line.
    pub label: String,
    /// What is shown.
    pub picture: Shown,
}

/// A picture in a report.
#[derive(Clone, Debug)]
pub enum Shown {
    /// Linear radiance, shown through 2^`exposure_ev` and the PBR Neutral curve.
    Radiance {
        /// The picture.
        image: Image,
        /// Stops.
        exposure_ev: f32,
    },
    /// Display-referred sRGB, three bytes a pixel from the top row.
    Display {
        /// Pixels per row.
        width: usize,
        /// Rows.
        height: usize,
        /// `3 * width * height` bytes.
        rgb: Vec<u8>,
    },
}

/// Points and lines on two axes.
#[derive(Clone, Debug, Default)]
pub struct Plot {
    /// A heading.
    pub title: String,
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// What is drawn.
    pub series: Vec<Series>,
}

/// An axis of a plot. Its range follows from the points.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Whether the axis is logarithmic; points at or below 0 are then left out.
    pub is_log: bool,
}

/// Points of one kind.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// The name in the legend.
    pub name: String,
    /// x and y.
    pub points: Vec<[f64; 2]>,
    /// Whether the points are joined, in their order.
    pub is_line: bool,
}
