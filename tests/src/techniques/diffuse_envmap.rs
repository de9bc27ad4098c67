//! What is measured about diffuse-envmap.

mod accuracy;
mod baselines;
mod bench;
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
    measurements: |_| Vec::new(),
    stress: stress::cases,
    hostile_scenes: hostile::scenes,
    figures: |_| Vec::new(),
};

#[cfg(test)]
mod tests {
    use super::{accuracy, grid};
    use crate::{Context, Scope};

    #[test]
    #[ignore = "x"]
    fn clock() {
        use super::{
            bench,
            lab::{Lab, Way},
            maps,
        };
        let context = Context::new(Scope::default(), std::env::temp_dir()).unwrap();
        let mut lab = Lab::new(context.gpu()).unwrap();
        lab.set_map(&maps::built_in("sky", 1024)).unwrap();
        for n in [128, 512] {
            let surfaces = lab.surfaces(&bench::spheres(n));
            for way in [Way::Sheen, Way::Mirror, Way::Paper, Way::Sheen, Way::Prefiltered(32), Way::Brute(1)]
            {
                lab.build(way).unwrap();
                for _ in 0..3 {
                    let start = std::time::Instant::now();
                    let (w, t) = lab.frame(way, &surfaces).unwrap();
                    println!("{way:?} {w:?} gpu {t:?} wall {:?}", start.elapsed());
                    let start = std::time::Instant::now();
                    let a = lab.answers(&surfaces).unwrap();
                    println!("   read {:?} {:?}", start.elapsed(), a[5000]);
                }
            }
        }
    }

    #[test]
    #[ignore = "prints a table"]
    fn print() {
        let quick = std::env::var_os("FULL").is_none();
        let scope = Scope { quick, ..Scope::default() };
        let mut context = Context::new(scope.clone(), std::env::temp_dir()).unwrap();
        let table = accuracy::grid(&scope);
        for c in accuracy::comparisons(&scope) {
            let start = std::time::Instant::now();
            let truth = (c.truth.make)(&mut context).unwrap();
            let noise = truth
                .variance_of_mean
                .as_ref()
                .map(|v| image_error::noise_relative_mse(&truth.image, v).unwrap());
            println!(
                "== {} {} truth {:.1} s noise {noise:?}",
                c.scene,
                c.setting,
                start.elapsed().as_secs_f64()
            );
            for m in &c.methods {
                let start = std::time::Instant::now();
                let image = (m.render)(&mut context).unwrap();
                let e = image_error::compare(&image, &truth.image).unwrap();
                let custom: Vec<String> =
                    c.metrics.iter().map(|x| format!("{:.2e}", (x.of)(&image, &truth))).collect();
                println!(
                    "{:28} {:.2e} {:.2e} bias {:.1e} p {:.2e} | {} {:.1} s",
                    m.name,
                    e.relative_mse,
                    e.mean_absolute,
                    e.relative_bias,
                    e.percentile_99_9,
                    custom.join(" "),
                    start.elapsed().as_secs_f64()
                );
                if !c.metrics.is_empty() {
                    let rows: Vec<String> = table
                        .by_row(&image, &truth.image, grid::relative_mse)
                        .iter()
                        .zip(&table.roughness)
                        .map(|(e, t)| format!("{t}:{e:.1e}"))
                        .collect();
                    println!("      {}", rows.join(" "));
                }
            }
        }
    }
}
