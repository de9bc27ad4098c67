//! That samples follow their density, for every lobe and for mixtures of them.

use glam::DVec3;

use super::{at_degrees, blinn, cone, matte, metal};
use crate::{
    Lobe,
    bsdf::{Bsdf, Parameters, mirrored},
    chi_squared::{Bins, Numbers, significance, test},
};

const INCIDENCES: [f64; 5] = [0.0, 35.0, 65.0, 85.0, 89.5];
const SAMPLES: usize = 60_000;

/// Tests one reflection at all incidences; `width` is about the lobe's, in radians.
fn check(name: &str, bsdf: &Bsdf, width: f64, tests: usize) {
    check_about(name, bsdf, mirrored, width, tests);
}

/// The same for a lobe about another axis than the mirror direction.
fn check_about(name: &str, bsdf: &Bsdf, axis: impl Fn(DVec3) -> DVec3, width: f64, tests: usize) {
    for (i, incidence) in INCIDENCES.into_iter().enumerate() {
        let outgoing = at_degrees(incidence);
        let bins = if width < 0.2 {
            Bins::growing(axis(outgoing), 0.3 * width, 14, 8)
        } else {
            Bins::even(DVec3::Z, 12, 16)
        };
        let mut numbers = Numbers(17 + i as u64);
        let mut draw = || {
            bsdf.sample(outgoing, numbers.three()).filter(|drawn| !drawn.is_delta).map(|drawn| drawn.incoming)
        };
        let density = |incoming| bsdf.evaluate(outgoing, incoming).pdf;
        let outcome = test(&bins, &density, &mut draw, SAMPLES);
        println!("{name} at {incidence} deg: p {:.3}, total {:.6}", outcome.p_value, outcome.total);
        assert!(outcome.total < 1.0 + 5e-4, "{name} at {incidence} deg: {outcome:?}");
        assert!(
            outcome.p_value > significance(tests * INCIDENCES.len()),
            "{name} at {incidence}: {outcome:?}"
        );
    }
}

#[test]
fn lambert() {
    check("Lambert", &Bsdf::new(&matte(), Lobe::Ggx), 1.0, 1);
}

#[test]
fn ggx() {
    let all = [0.003, 0.03, 0.1, 0.3, 0.6, 1.0];
    for roughness in all {
        let bsdf = Bsdf::new(&metal(roughness), Lobe::Ggx);
        check(&format!("GGX {roughness}"), &bsdf, roughness * roughness, all.len());
    }
}

#[test]
fn blinn_lobes() {
    let all = [0.0, 1.0, 13.0, 1e3, 1e5, 1e9];
    for exponent in all {
        check(&format!("Blinn {exponent}"), &blinn(exponent), (2.0 / (exponent + 2.0)).sqrt(), all.len());
    }
}

#[test]
fn phong_cones() {
    let all = [0.001, 0.3, 5.8, 18.85, 60.0, 90.0];
    for half_angle_deg in all {
        let name = format!("cone {half_angle_deg} deg");
        check(&name, &cone(half_angle_deg), 0.3 * half_angle_deg.to_radians(), all.len() + 1);
    }
    let parameters = Parameters { spread_rad: Some(0.5), shininess: Some(10.0), ..metal(0.2) };
    check("cone with a weight of its own", &Bsdf::new(&parameters, Lobe::PhongCone), 0.3, all.len() + 1);
}

#[test]
fn diffused_environments() {
    let all = [1e-4, 0.01, 0.1, 0.3, 0.5, 0.8, 1.0];
    for t in all {
        let bsdf = Bsdf::new(&metal(t), Lobe::DiffusedEnvironment);
        let axis = |outgoing| mirrored(outgoing).lerp(DVec3::Z, t).normalize();
        check_about(&format!("diffused environment {t}"), &bsdf, axis, 0.5 * t, all.len());
    }
}

#[test]
fn mixtures() {
    let layered = Parameters {
        base_color: [0.8, 0.3, 0.1],
        metallic: 0.3,
        roughness: 0.5,
        clearcoat: 0.9,
        clearcoat_roughness: 0.6,
        clearcoat_normal: DVec3::new(0.3, -0.2, 1.0).normalize(),
        ..Parameters::default()
    };
    let lobes = [Lobe::Ggx, Lobe::Blinn, Lobe::PhongCone, Lobe::DiffusedEnvironment];
    for lobe in lobes {
        check(&format!("layers of {lobe:?}"), &Bsdf::new(&layered, lobe), 1.0, lobes.len() + 1);
    }
    // The coat is a mirror: what it takes is no density.
    let mirror_coat = Parameters { clearcoat_roughness: 0.0, ..layered };
    check("a mirror over GGX", &Bsdf::new(&mirror_coat, Lobe::Ggx), 1.0, lobes.len() + 1);
}
