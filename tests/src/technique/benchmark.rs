//! What `bench` runs: subjects that take turns, and measurements that stand alone.

use super::{Failure, Make, Role, Truth};
use crate::Context;
use image_error::Image;

/// Subjects that do the same work, timed in turns (A B C A B C ...) so that whatever slows the
/// machine down slows all of them. Ratios are taken to the first subject of [`Role::Ours`].
pub struct Benchmark {
    /// The scene's name.
    pub scene: String,
    /// What varies within a scene; empty where nothing does.
    pub setting: String,
    /// Pixels per row, and rows.
    pub size: [u32; 2],
    /// The truth that errors are taken to, where subjects have pictures.
    pub truth: Option<Truth>,
    /// The subjects; at least one.
    pub subjects: Vec<Subject>,
    /// Work that is skipped where it is not needed: what that saves, and that nobody can see it.
    pub skips: Vec<SkipPair>,
}

/// One row of a benchmark.
pub struct Subject {
    /// The method's name, as in `compare`.
    pub method: String,
    /// Its part.
    pub role: Role,
    /// Subjects of one series (the same method with more and more rays) are joined by a line in
    /// the plot of error over time.
    pub series: Option<String>,
    /// Loads, uploads, compiles: all that happens once in a program's life. Not timed.
    pub start: Make<Running>,
}

/// A closure that runs again and again.
pub type Again<T> = Box<dyn FnMut(&mut Context) -> Result<T, Failure>>;

/// A subject that is ready to run.
pub struct Running {
    /// Everything that has to be made anew when the environment (or whatever is precomputed from)
    /// changes: submitted, waited for, and timed apart as `prepare_ms`. `None` where nothing is.
    pub prepare: Option<Again<()>>,
    /// One frame: records, submits and waits for it.
    pub frame: Again<Frame>,
    /// One frame's picture, linear, for the errors; `None` where it has none.
    pub picture: Option<Again<Image>>,
    /// Bytes of GPU memory that the method holds, if it is known, asked after the last frame.
    pub memory_bytes: Option<Again<u64>>,
    /// How much a frame gets done, where that is a figure of its own (rays).
    pub throughput: Option<Throughput>,
}

/// What a frame says of itself.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Time of the method's own spans by the adapter's clock, milliseconds; `None` where it cannot
    /// be measured. On a software adapter, and where any subject of a benchmark has none, the wall
    /// clock counts.
    pub gpu_ms: Option<f64>,
    /// What ran and what was left out.
    pub work: WorkDone,
}

/// What a frame did and what it left out.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct WorkDone {
    /// Passes recorded.
    pub passes: u32,
    /// Reasons for what was skipped, each with the pass that it belongs to.
    pub skipped: Vec<String>,
}

/// Units of work in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Throughput {
    /// What is counted, in the plural: `rays`.
    pub unit: &'static str,
    /// How many a frame.
    pub per_frame: f64,
}

/// One entry of the skip ledger: the same picture with the work left out and with it done.
pub struct SkipPair {
    /// What is left out, and when: `mirrors alone build no chain`.
    pub name: String,
    /// The frame that skips.
    pub skipping: Subject,
    /// The same frame without the skip.
    pub whole: Subject,
    /// Whether the work that is skipped belongs to preparing rather than to the frame.
    pub in_prepare: bool,
}

/// Something of `bench` that is measured by itself.
pub struct Measurement {
    /// What is measured, on what: a heading.
    pub name: String,
    /// How, for a reader.
    pub how: String,
    /// Measures it.
    pub run: Make<Vec<Fact>>,
}

/// One measured figure.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Fact {
    /// What it is.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its unit, `""` where it has none.
    pub unit: String,
    /// How it was found where that is not plain: `extrapolated from 256 samples`.
    pub note: String,
}
