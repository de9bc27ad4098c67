//! How much light each lobe reflects, against closed forms and among estimates.

use std::f64::consts::PI;

use super::{albedo, at_degrees, blinn, cone, matte, metal, over_hemisphere};
use crate::{
    Lobe,
    bsdf::{Bsdf, Parameters, reflectance::coat_share},
    chi_squared::Numbers,
};

const INCIDENCES: [f64; 6] = [0.0, 20.0, 45.0, 70.0, 85.0, 89.0];

/// The mean weight of samples and its standard error (red channel).
fn sampled_albedo(bsdf: &Bsdf, outgoing: glam::DVec3, count: u32) -> (f64, f64) {
    let mut numbers = Numbers(5);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..count {
        let weight = bsdf.sample(outgoing, numbers.three()).map_or(0.0, |drawn| drawn.weight[0]);
        sum += weight;
        squares += weight * weight;
    }
    let (mean, count) = (sum / f64::from(count), f64::from(count));
    (mean, ((squares / count - mean * mean).max(0.0) / count).sqrt())
}

#[test]
fn white_lambert_and_mirror_reflect_all() {
    for incidence in INCIDENCES {
        let outgoing = at_degrees(incidence);
        let white = Bsdf::new(&matte(), Lobe::Ggx);
        assert!((albedo(&white, outgoing, 1.0) - 1.0).abs() < 1e-4, "{incidence}");
        assert_eq!(sampled_albedo(&white, outgoing, 1000), (1.0, 0.0));
        for lobe in [Lobe::Ggx, Lobe::Blinn, Lobe::PhongCone, Lobe::DiffusedEnvironment] {
            let mirror = Bsdf::new(&metal(0.0), lobe);
            assert!(mirror.is_delta_only());
            let drawn = mirror.sample(outgoing, [0.3, 0.4, 0.5]).unwrap();
            assert!(drawn.is_delta && drawn.incoming == crate::bsdf::mirrored(outgoing));
            assert!((drawn.weight[1] - 1.0).abs() < 1e-12, "{lobe:?} at {incidence}: {drawn:?}");
        }
    }
}

#[test]
fn blinn_totals_one_at_the_normal_and_never_more() {
    for exponent in [0.0, 0.5, 1.0, 3.0, 13.0, 100.0, 1e3, 1e5, 1e7] {
        let (lobe, width) = (blinn(exponent), (2.0 / (exponent + 2.0)).sqrt());
        let total = albedo(&lobe, at_degrees(0.0), width);
        assert!((total - 1.0).abs() < 1e-4, "n {exponent}: {total}");
        for incidence in INCIDENCES {
            let total = albedo(&lobe, at_degrees(incidence), width);
            assert!(total < 1.0 + 1e-4, "n {exponent} at {incidence}: {total}");
            if exponent == 0.0 {
                assert!((total - 1.0).abs() < 1e-4, "{incidence}: {total}");
            }
            if exponent >= 1e5 && incidence <= 70.0 {
                assert!((total - incidence.to_radians().cos()).abs() < 1e-3, "{incidence}: {total}");
            }
        }
    }
}

#[test]
fn cones_reflect_all() {
    for half_angle_deg in [0.01, 0.3, 5.8, 11.6, 18.85, 45.0, 90.0] {
        for incidence in INCIDENCES {
            let total = albedo(&cone(half_angle_deg), at_degrees(incidence), half_angle_deg.to_radians());
            assert!((total - 1.0).abs() < 3e-4, "{half_angle_deg} at {incidence}: {total}");
        }
    }
}

#[test]
fn the_diffused_environment_reflects_its_reflectance() {
    for t in [1e-4, 0.05, 0.2, 0.45, 0.7, 1.0] {
        let bsdf = Bsdf::new(&metal(t), Lobe::DiffusedEnvironment);
        for incidence in INCIDENCES {
            let outgoing = at_degrees(incidence);
            let expected = bsdf.reflectance.split(outgoing.z, outgoing.z, outgoing.z).specular[0];
            let total = albedo(&bsdf, outgoing, 0.5 * PI * t);
            assert!((total - expected).abs() < 3e-4, "t {t} at {incidence}: {total} {expected}");
        }
    }
}

#[test]
fn ggx_loses_light_to_second_reflections_and_never_gains() {
    let total = |roughness: f64, incidence| {
        albedo(&Bsdf::new(&metal(roughness), Lobe::Ggx), at_degrees(incidence), roughness * roughness)
    };
    for roughness in [0.003, 0.05, 0.2, 0.5, 0.8] {
        for incidence in INCIDENCES {
            let total = total(roughness, incidence);
            println!("GGX {roughness} at {incidence}: {total:.4}");
            assert!(total < 1.0 + 1e-4, "{roughness} at {incidence}: {total}");
            if roughness < 0.1 && incidence < 80.0 {
                assert!(total > 0.9999, "{roughness} at {incidence}: {total}");
            }
        }
    }
    // At roughness 1 the integral of l / (v + l) over the cosine l has a closed form.
    for incidence in INCIDENCES {
        let (v, total) = (incidence.to_radians().cos(), total(1.0, incidence));
        let closed = 1.0 - v * ((1.0 + v) / v).ln();
        assert!((total - closed).abs() < 1e-4, "{incidence}: {total} {closed}");
    }
    // As documented.
    assert!((total(0.5, 45.0) - 0.89).abs() < 0.005 && (total(1.0, 45.0) - 0.38).abs() < 0.005);
}

/// What the specular lobe does not reflect comes back from the diffuse one.
#[test]
fn a_white_dielectric_reflects_all() {
    for roughness in [0.03, 0.2, 0.33, 0.5, 0.8, 1.0] {
        let bsdf = Bsdf::new(&Parameters { roughness, ..Parameters::default() }, Lobe::Ggx);
        for incidence in INCIDENCES {
            let total = albedo(&bsdf, at_degrees(incidence), roughness * roughness);
            println!("dielectric {roughness} at {incidence}: {total:.4}");
            assert!((total - 1.0).abs() < 4e-3, "{roughness} at {incidence}: {total}");
        }
    }
}

#[test]
fn samples_estimate_the_integral() {
    let layered = Parameters {
        base_color: [0.8, 0.3, 0.1],
        metallic: 0.3,
        roughness: 0.5,
        clearcoat: 0.9,
        clearcoat_roughness: 0.3,
        ..Parameters::default()
    };
    for lobe in [Lobe::Ggx, Lobe::Blinn, Lobe::PhongCone, Lobe::DiffusedEnvironment] {
        let surfaces = [("metal", metal(0.4)), ("dielectric", Parameters::default()), ("layers", layered)];
        for (name, parameters) in surfaces {
            let bsdf = Bsdf::new(&parameters, lobe);
            for incidence in INCIDENCES {
                let outgoing = at_degrees(incidence);
                let (mean, deviation) = sampled_albedo(&bsdf, outgoing, 40_000);
                let exact = albedo(&bsdf, outgoing, 0.1);
                let close = (mean - exact).abs() < 4.5 * deviation + 3e-4;
                assert!(close, "{lobe:?} {name} at {incidence}: {mean} +- {deviation}, {exact}");
                // See above for what a glTF dielectric gains.
                assert!(exact < 1.02, "{lobe:?} {name} at {incidence}: {exact}");
            }
        }
    }
}

#[test]
fn a_mirror_coat_shares_light_with_what_is_below() {
    let coated = Parameters { clearcoat: 1.0, ..matte() };
    for lobe in [Lobe::Ggx, Lobe::DiffusedEnvironment] {
        let bsdf = Bsdf::new(&coated, lobe);
        for incidence in INCIDENCES {
            let outgoing = at_degrees(incidence);
            let share = coat_share(lobe, 0.0, outgoing.z);
            assert!((bsdf.transmitted_by_coat(outgoing) - (1.0 - share)).abs() < 1e-12);
            let below = albedo(&bsdf, outgoing, 1.0);
            assert!((below - (1.0 - share)).abs() < 1e-4, "{lobe:?} at {incidence}: {below}");
            let (mean, deviation) = sampled_albedo(&bsdf, outgoing, 40_000);
            assert!((mean - 1.0).abs() < 4.5 * deviation + 1e-9, "{lobe:?} at {incidence}: {mean}");
        }
    }
}

#[test]
fn a_mirror_below_a_mirror_coat_gives_the_rest() {
    for lobe in [Lobe::Ggx, Lobe::PhongCone] {
        let bsdf = Bsdf::new(&Parameters { clearcoat: 1.0, ..metal(0.0) }, lobe);
        assert!(bsdf.is_delta_only());
        for incidence in INCIDENCES {
            let (mean, deviation) = sampled_albedo(&bsdf, at_degrees(incidence), 40_000);
            assert!((mean - 1.0).abs() < 4.5 * deviation + 1e-9, "{lobe:?} at {incidence}: {mean}");
        }
    }
}

#[test]
fn the_first_moment_of_the_diffused_lobe_has_its_closed_form() {
    // The mean cosine from the axis, 2 (1 + cos(pi t / 2)) / (4 - t^2); and at t = 1 the lobe is
    // Lambert's.
    let outgoing = at_degrees(0.0);
    for t in [0.05, 0.3, 0.7, 1.0] {
        let bsdf = Bsdf::new(&metal(t), Lobe::DiffusedEnvironment);
        let moment = over_hemisphere(outgoing, 0.5 * PI * t, &|incoming| {
            incoming.z * bsdf.evaluate(outgoing, incoming).pdf
        });
        let closed = 2.0 * (1.0 + (0.5 * PI * t).cos()) / (4.0 - t * t);
        assert!((moment - closed).abs() < 1e-4, "t {t}: {moment} {closed}");
    }
    let full = Bsdf::new(&metal(1.0), Lobe::DiffusedEnvironment);
    for incidence in INCIDENCES {
        let pdf = full.evaluate(at_degrees(70.0), at_degrees(incidence)).pdf;
        assert!((pdf - incidence.to_radians().cos() / PI).abs() < 1e-12, "{incidence}: {pdf}");
    }
}
