//! What is measured about horizon-shadow.

use crate::technique::Technique;

/// The registration.
pub(crate) const TECHNIQUE: Technique = Technique {
    name: "horizon-shadow",
    summary: "Shadows of bumps on curved surfaces.",
    libraries: &[],
    exemptions: &[],
    comparisons: |_| Vec::new(),
    benchmarks: |_| Vec::new(),
    measurements: |_| Vec::new(),
    stress: |_| Vec::new(),
    hostile_scenes: |_| Vec::new(),
    figures: |_| Vec::new(),
};
