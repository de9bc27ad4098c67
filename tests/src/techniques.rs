//! The registered techniques: one line, and one file, for each.

mod diffuse_envmap;
mod horizon_shadow;
mod path_tracer;

use crate::technique::Technique;

/// Everything that is measured.
pub const TECHNIQUES: &[Technique] =
    &[diffuse_envmap::TECHNIQUE, horizon_shadow::TECHNIQUE, path_tracer::TECHNIQUE];
