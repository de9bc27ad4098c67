//! What is measured about diffuse-envmap.

use crate::technique::Technique;

/// The registration.
pub(crate) const TECHNIQUE: Technique = Technique {
    name: "diffuse-envmap",
    summary: "Environment lighting from mirror to diffuse by one roughness.",
    libraries: &[&shaders::COMMON_MATH, &shaders::DIFFUSE_ENVMAP_LIBRARY],
    exemptions: &[],
    comparisons: |_| Vec::new(),
    benchmarks: |_| Vec::new(),
    measurements: |_| Vec::new(),
    stress: |_| Vec::new(),
    hostile_scenes: |_| Vec::new(),
    figures: |_| Vec::new(),
};
