//! What is measured about horizon-shadow.

mod accuracy;
mod bench;
mod drawing;
mod facts;
mod figures;
mod grounds;
mod hostile;
mod lab;
mod limits;
mod metrics;
mod rays;
mod stages;
mod stress;
mod tables;
mod triangles;
mod ways;

use crate::technique::Technique;

/// The registration.
pub(crate) const TECHNIQUE: Technique = Technique {
    name: "horizon-shadow",
    summary: "Shadows of bumps on curved surfaces.",
    libraries: &[
        &shaders::HORIZON_SHADOW_TABLES,
        &shaders::HORIZON_SHADOW_CODES,
        &shaders::HORIZON_SHADOW_SURFACE,
        &shaders::HORIZON_SHADOW_PUBLISHED,
        &shaders::HORIZON_SHADOW_HORIZON,
        &shaders::HORIZON_SHADOW_BUMPS,
        &shaders::HORIZON_SHADOW_LIBRARY,
    ],
    exemptions: stress::EXEMPTIONS,
    comparisons: accuracy::comparisons,
    benchmarks: bench::benchmarks,
    measurements: facts::measurements,
    stress: stress::cases,
    hostile_scenes: hostile::scenes,
    figures: figures::figures,
};
