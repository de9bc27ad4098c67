//! What `compare` runs: methods against a truth, and how wrong each may be.

use super::{Make, Role};
use image_error::Image;

/// One scene under one setting: a truth, and methods that are measured against it.
pub struct Comparison {
    /// The scene's name, for `--scene` and the reports; letters, digits, `-` and `_`.
    pub scene: String,
    /// What varies within a scene, for instance `t=0.3`; empty where nothing does.
    pub setting: String,
    /// Which of the two errors this is.
    pub kind: Kind,
    /// What the methods should show.
    pub truth: Truth,
    /// The methods, in the order of the report.
    pub methods: Vec<Method>,
    /// Errors in the technique's own unit, besides the ones that every picture gets.
    pub metrics: Vec<CustomMetric>,
    /// How wrong each method may be, with the reason. A method without a threshold is only shown.
    pub thresholds: Vec<Threshold>,
    /// How the pictures are shown and whether the eye's metrics mean anything.
    pub picture: Picture,
    /// What is seen in the pictures: a sentence for each visible difference. Empty where they are
    /// not for looking at.
    pub seen: &'static str,
}

/// The two errors of a real-time method, which are always kept apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Against the converged value of the technique's own integral.
    Approximation,
    /// Against full light transport.
    Model,
}

/// How the images of a comparison are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Picture {
    /// Scene-referred radiance; display and FLIP take it through 2^`exposure_ev` and the tone
    /// curve. `None` chooses an exposure from the truth's median luminance.
    Radiance {
        /// Exposure in stops.
        exposure_ev: Option<f32>,
    },
    /// A table of values that happens to be stored as an image (roughness by incidence...): it is
    /// shown as pixels, without FLIP.
    Table,
}

/// How the truth of a comparison is made, and under which name it is kept between runs.
pub struct Truth {
    /// Everything that decides the truth, as text: it is hashed to the name of the file in which
    /// the truth is kept. `None` where making it takes less than a second, or where the closure
    /// keeps it by itself.
    pub key: Option<String>,
    /// Makes the truth.
    pub make: Make<TruthImage>,
}

/// A truth, and how far it can be trusted.
#[derive(Clone, Debug)]
pub struct TruthImage {
    /// Linear radiance (or whatever the methods show).
    pub image: Image,
    /// Variance of each value: of the mean for a path-traced truth; for a quadrature the squared
    /// difference to a coarser one. `None` where the truth is exact. As many as pixels.
    pub variance_of_mean: Option<Vec<[f32; 3]>>,
    /// Which pixels count, `None` where all do. As many as pixels.
    pub mask: Option<Vec<bool>>,
    /// How it was made, for a reader: `path tracer, 4096 samples a pixel`.
    pub how: String,
}

/// A method that is compared.
pub struct Method {
    /// What it is called in every report, for instance `paper, 64 rays`.
    pub name: String,
    /// Its part.
    pub role: Role,
    /// Makes its picture: of the truth's size, and linear.
    pub render: Make<Image>,
}

/// A limit on an error.
#[derive(Clone, Debug)]
pub struct Threshold {
    /// Name of the method in [`Comparison::methods`].
    pub method: String,
    /// Which error.
    pub metric: Metric,
    /// The largest value that passes.
    pub at_most: f64,
    /// Where the limit comes from.
    pub reason: &'static str,
}

/// The errors that a limit can be set on. Every picture gets all of them except
/// [`Custom`](Self::Custom), and FLIP only where it is [`Picture::Radiance`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Metric {
    /// Mean of (x - y)^2 / (y^2 + eps), eps = 0.01 of the mean of y^2.
    RelativeMse,
    /// Mean of |x - y|, over the mean of |y|.
    MeanAbsolute,
    /// |Mean of x - y|, over the mean of |y|: what is lost or gained in all.
    Bias,
    /// 99.9th percentile of |x - y|, over the mean of |y|.
    Percentile999,
    /// Mean FLIP of the tone-mapped pictures at 67 pixels per degree.
    Flip,
    /// Mean HDR-FLIP at 67 pixels per degree.
    HdrFlip,
    /// A [`CustomMetric`] by name.
    Custom(&'static str),
}

/// An error in the technique's own unit.
pub struct CustomMetric {
    /// Its name.
    pub name: &'static str,
    /// Its unit, `""` where it has none.
    pub unit: &'static str,
    /// The error of a picture against the truth, 0 where they are alike.
    pub of: MetricOf,
}

/// An error of a picture against a truth.
pub type MetricOf = Box<dyn Fn(&Image, &TruthImage) -> f64>;

impl Metric {
    /// The errors that need no registration, in the order of the reports.
    pub const ALL: [Self; 6] =
        [Self::RelativeMse, Self::MeanAbsolute, Self::Bias, Self::Percentile999, Self::Flip, Self::HdrFlip];

    /// The name in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::RelativeMse => "rel_mse",
            Self::MeanAbsolute => "mean_absolute",
            Self::Bias => "bias",
            Self::Percentile999 => "percentile_99_9",
            Self::Flip => "flip",
            Self::HdrFlip => "hdr_flip",
            Self::Custom(name) => name,
        }
    }

    /// The name in tables.
    pub const fn title(self) -> &'static str {
        match self {
            Self::RelativeMse => "relMSE",
            Self::MeanAbsolute => "mean |error|",
            Self::Bias => "bias",
            Self::Percentile999 => "99.9 %",
            Self::Flip => "FLIP",
            Self::HdrFlip => "HDR-FLIP",
            Self::Custom(name) => name,
        }
    }
}
