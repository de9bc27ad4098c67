//! How far a run is, and how long it will take.

use indicatif::{ProgressBar, ProgressStyle};
use std::{
    io::{IsTerminal as _, stderr},
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

/// A bar on a terminal; elsewhere one line for each step.
#[derive(Clone, Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    is_terminal: bool,
    started: Instant,
    step: Arc<Mutex<String>>,
}

impl Progress {
    pub(crate) fn new() -> Self {
        let bar = ProgressBar::new(1);
        // The template is a constant: where it did not parse, the plain bar would do.
        if let Ok(style) =
            ProgressStyle::with_template("{bar:28} {pos}/{len}  {elapsed} done, {eta} left  {msg}")
        {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(250));
        Self { bar, is_terminal: stderr().is_terminal(), started: Instant::now(), step: Arc::default() }
    }

    /// How many steps there are in all.
    pub(crate) fn set_steps(&self, steps: usize) {
        self.bar.set_length(steps as u64);
    }

    /// A step begins.
    pub(crate) fn begin(&self, what: &str) {
        self.bar.set_message(what.to_owned());
        what.clone_into(&mut self.step.lock().unwrap_or_else(PoisonError::into_inner));
        if !self.is_terminal {
            let (done, all) = (self.bar.position(), self.bar.length().unwrap_or(0));
            let left = match done {
                0 => String::new(),
                _ => {
                    format!(", {} s left", self.started.elapsed().as_secs() * all.saturating_sub(done) / done)
                }
            };
            eprintln!("[{done}/{all}{left}] {what}");
        }
    }

    /// What the step is at.
    pub(crate) fn detail(&self, detail: &str) {
        let step = self.step.lock().unwrap_or_else(PoisonError::into_inner);
        self.bar.set_message(format!("{step}: {detail}"));
    }

    /// Steps are done.
    pub(crate) fn advance(&self, steps: usize) {
        self.bar.inc(steps as u64);
    }

    /// The run is over.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
