//! The registered techniques: one line, and one file, for each.

mod diffuse_envmap;
mod path_tracer;

use crate::technique::Technique;

/// Everything that is measured.
pub const TECHNIQUES: &[Technique] = &[diffuse_envmap::TECHNIQUE, path_tracer::TECHNIQUE];
