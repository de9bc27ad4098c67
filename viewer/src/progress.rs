//! How far a long piece of work is: a bar for people, a line now and then for log files.

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use path_tracer::Progress;
use std::sync::Mutex;
use std::time::Duration;

/// Reports the progress of a picture on the standard error.
pub(crate) struct Reporter {
    bar: ProgressBar,
    lines: Mutex<Lines>,
}

/// When the last line was written.
#[derive(Default)]
struct Lines {
    elapsed: Duration,
    percent: u64,
}

impl Reporter {
    /// Begins with what the work is, for log files.
    pub(crate) fn new(work: &str) -> Self {
        // Hidden by itself where the standard error is no terminal.
        let bar = ProgressBar::new(0);
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %, {msg}") {
            bar.set_style(style);
        }
        if bar.is_hidden() {
            eprintln!("{work}");
        }
        Self { bar, lines: Mutex::default() }
    }

    /// May be called from any thread, as often as one likes.
    pub(crate) fn report(&self, progress: Progress) {
        // Who finds somebody else reporting needs not report as well.
        let Ok(mut lines) = self.lines.try_lock() else { return };
        let left =
            progress.remaining().map_or_else(String::new, |left| format!("{} left", HumanDuration(left)));
        if !self.bar.is_hidden() {
            self.bar.set_length(progress.total_samples);
            self.bar.set_position(progress.done_samples);
            self.bar.set_message(left);
        } else if lines.is_due(progress) {
            eprintln!("{} %, {left}", lines.percent);
        }
    }

    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Lines {
    /// Each minute, and at each tenth of the work that took more than some seconds.
    fn is_due(&mut self, progress: Progress) -> bool {
        let percent = 100 * progress.done_samples / progress.total_samples.max(1);
        let since = progress.elapsed.saturating_sub(self.elapsed);
        let tenth = percent / 10 > self.percent / 10 && since >= Duration::from_secs(5);
        let is_due = tenth || since >= Duration::from_secs(60);
        if is_due {
            *self = Self { elapsed: progress.elapsed, percent };
        }
        is_due
    }
}
