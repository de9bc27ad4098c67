//! What the program can be asked to do, one file each.

pub(crate) mod diff;
pub(crate) mod info;
pub(crate) mod merge;
pub(crate) mod reference;
pub(crate) mod render;
pub(crate) mod window;

use std::io::Write;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// The command line contradicts itself: exit status 2.
    #[error("{0}\n\nFor more information, try '--help'.")]
    Usage(String),
    /// A file was refused, or could not be written: exit status 1.
    #[error(transparent)]
    Input(#[from] scene::Error),
    /// The frame could not be rendered: exit status 1.
    #[error(transparent)]
    Render(#[from] compositor::Error),
    /// There is no usable graphics adapter: exit status 1.
    #[error(transparent)]
    Gpu(#[from] gpu_context::Error),
    /// There is nothing that could be compared: exit status 1.
    #[error(transparent)]
    Compare(#[from] image_error::Error),
    /// The user stopped it, and was told what is left: exit status 130, that of the interrupt signal.
    #[error("interrupted: {0}")]
    Interrupted(String),
    /// Anything else: exit status 1.
    #[error("{0}")]
    Other(String),
}

impl Failure {
    pub(crate) fn exit_status(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Interrupted(_) => INTERRUPTED,
            _ => 1,
        }
    }
}

/// Exit status of what was interrupted: 128 and the number of the signal.
const INTERRUPTED: u8 = 130;

/// Prints to the standard output. A reader that has read enough is no failure.
fn print(text: &str) {
    std::io::stdout().lock().write_all(text.as_bytes()).ok();
}

/// Prints warnings where they do not mix with results.
pub(crate) fn print_warnings(warnings: &[scene::Warning]) {
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
}
