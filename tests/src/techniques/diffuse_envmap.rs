//! What is measured about diffuse-envmap.

mod accuracy;
mod baselines;
mod bench;
mod facts;
mod figures;
mod grid;
mod hostile;
mod lab;
mod limits;
mod maps;
mod pictures;
mod stress;
mod truth;

use crate::technique::Technique;

/// The registration.
pub(crate) const TECHNIQUE: Technique = Technique {
    name: "diffuse-envmap",
    summary: "Environment lighting from mirror to diffuse by one roughness.",
    libraries: &[
        &shaders::COMMON_MATH,
        &shaders::DIFFUSE_ENVMAP_LIBRARY,
        &shaders::DIFFUSE_ENVMAP_CHAIN,
        &shaders::DIFFUSE_ENVMAP_HARMONICS,
        &shaders::DIFFUSE_ENVMAP_SOURCES,
    ],
    exemptions: stress::passes::EXEMPTIONS,
    comparisons: |scope| [accuracy::comparisons(scope), pictures::comparisons(scope)].into_iter().flatten().collect(),
    benchmarks: bench::benchmarks,
    measurements: facts::measurements,
    stress: stress::cases,
    hostile_scenes: hostile::scenes,
    figures: figures::figures,
};
