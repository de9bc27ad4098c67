//! Figures of `bench` that are no times of frames.

use crate::{Scope, technique::Measurement};

/// All of them.
pub(super) fn measurements(_scope: &Scope) -> Vec<Measurement> {
    Vec::new()
}
