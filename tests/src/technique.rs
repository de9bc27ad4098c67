//! What a technique registers about itself: one value of [`Technique`], filled in one file of
//! [`techniques`](crate::techniques). The harness does the rest.
//!
//! A registration is data and closures. The functions of [`Technique`] are cheap: they list what
//! there is to do and load nothing. Whatever takes time (loading a model, rendering, integrating)
//! stands in a closure, which gets a [`Context`] and may fail with a text.

mod benchmark;
mod comparison;
mod figure;
mod stress;

pub use benchmark::{
    Again, Benchmark, Fact, Frame, Measurement, Running, SkipPair, Subject, Throughput, WorkDone,
};
pub use comparison::{
    Comparison, CustomMetric, Kind, Method, Metric, MetricOf, Picture, Threshold, Truth, TruthImage,
};
pub use figure::{Axis, Block, Figure, Labelled, Plot, Series, Shown};
pub use stress::{Bound, Exemption, Expectation, HostileScene, Input, Model, StressCase, Tolerance};

use crate::{Context, Scope};

/// Why a closure of a registration could not do its work: shown in the report, never a panic.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Everything that is measured about one technique.
#[derive(Clone, Copy, Debug)]
pub struct Technique {
    /// The name on the command line, as the crate is called.
    pub name: &'static str,
    /// One sentence for the top of the reports.
    pub summary: &'static str,
    /// The WGSL modules whose functions have to have a [`StressCase`] or an [`Exemption`] each.
    /// Functions of a module's dependencies count only where the dependency is listed too.
    pub libraries: &'static [&'static shaders::Module],
    /// Library functions without a stress case of their own.
    pub exemptions: &'static [Exemption],
    /// How wrong each method is, for `compare`.
    pub comparisons: fn(&Scope) -> Vec<Comparison>,
    /// What each method costs, for `bench`.
    pub benchmarks: fn(&Scope) -> Vec<Benchmark>,
    /// Figures of `bench` that are not times of frames.
    pub measurements: fn(&Scope) -> Vec<Measurement>,
    /// Functions of the library against their models, for `stress`.
    pub stress: fn(&Scope) -> Vec<StressCase>,
    /// Scenes that try to break whole frames, for `stress`.
    pub hostile_scenes: fn(&Scope) -> Vec<HostileScene>,
    /// The figures and tables of the technique's paper and what was added to them, for `figures`.
    pub figures: fn(&Scope) -> Vec<Figure>,
}

/// What part a method plays in a comparison or a benchmark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// The project's own method: the one that ratios are taken to.
    Ours,
    /// The method as published.
    Paper,
    /// Anything else that a reader would compare with.
    Baseline,
}

/// A closure of a registration that makes something.
pub type Make<T> = Box<dyn Fn(&mut Context) -> Result<T, Failure>>;
