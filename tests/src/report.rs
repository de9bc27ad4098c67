//! What the four programs write: JSON, and one page that needs nothing beside itself.

mod date;
mod html;
mod picture;
mod plot;

pub(crate) use date::now;
pub(crate) use html::{Cell, Page, number};
pub(crate) use picture::{automatic_exposure, png, radiance_png, shown_png};
pub(crate) use plot::svg;

use serde::Serialize;

/// The system's load average over the last minute, where it tells.
pub(crate) fn load() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split(' ').next()?.parse().ok()
}

/// What every report says of the run.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Header {
    /// `compare`, `bench`...
    pub(crate) program: &'static str,
    /// The project's version.
    pub(crate) version: &'static str,
    /// When the run began, in UTC.
    pub(crate) date: String,
    /// The adapter, its backend and driver.
    pub(crate) adapter: String,
    /// CPU threads that the run could use.
    pub(crate) threads: usize,
    /// Processes that were waiting for a CPU thread when the run began, over the last minute, where the
    /// system tells: well above 0, times are too long and ratios less sure.
    pub(crate) load: Option<f64>,
    /// Whether it is the small run for every change.
    pub(crate) quick: bool,
    /// Whether it was stopped before everything was done.
    pub(crate) interrupted: bool,
}
