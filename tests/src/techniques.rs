//! The registered techniques: one line, and one file, for each.

mod diffuse_envmap;

use crate::technique::Technique;

/// Everything that is measured.
pub const TECHNIQUES: &[Technique] = &[diffuse_envmap::TECHNIQUE];
