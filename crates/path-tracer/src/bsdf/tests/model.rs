//! The lobes against the formulas of their sources, written out as those give them.

use std::f64::consts::PI;

use glam::DVec3;

use super::{at_degrees, blinn, cone, matte, metal};
use crate::{
    Lobe,
    bsdf::{Bsdf, Parameters, albedo, round::Round, shape::Shape},
};

/// Pairs of directions from normal to grazing.
fn pairs() -> Vec<(DVec3, DVec3)> {
    let ring: Vec<DVec3> = (0..40)
        .map(|i| {
            let (angle, turn) = (0.039 * f64::from(i), 2.4 * f64::from(i));
            DVec3::new(angle.sin() * turn.cos(), angle.sin() * turn.sin(), angle.cos())
        })
        .collect();
    ring.iter().flat_map(|&a| ring.iter().map(move |&b| (a, b))).collect()
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-9 * expected.abs() + 1e-14, "{found} {expected}");
}

/// glTF 2.0, appendix B.3: `specular_brdf`.
fn gltf_specular(alpha: f64, v: DVec3, l: DVec3) -> f64 {
    let h = (v + l).normalize();
    let squared = alpha * alpha;
    let distribution = squared / (PI * (h.z * h.z * (squared - 1.0) + 1.0).powi(2));
    let root = |a: f64| (squared + (1.0 - squared) * a * a).sqrt();
    distribution * 0.5 / (l.z * root(v.z) + v.z * root(l.z))
}

fn gltf_fresnel(f0: f64, v: DVec3, l: DVec3) -> f64 {
    f0 + (1.0 - f0) * (1.0 - v.dot((v + l).normalize())).powi(5)
}

fn gltf_material(base: f64, metallic: f64, roughness: f64, v: DVec3, l: DVec3) -> f64 {
    let specular = gltf_specular(roughness * roughness, v, l);
    // Instead of the sample implementation's 1 - F(v.h).
    let passed = |cosine| 1.0 - albedo::directional(roughness, cosine, 0.04, 1.0);
    let coupling = passed(v.z) * passed(l.z) / (1.0 - albedo::mean(roughness, 0.04, 1.0));
    let dielectric = base / PI * coupling + specular * gltf_fresnel(0.04, v, l);
    let metal = specular * gltf_fresnel(base, v, l);
    dielectric * (1.0 - metallic) + metal * metallic
}

#[test]
fn ggx_materials_are_those_of_gltf() {
    let base_color = [0.9, 0.5, 0.0];
    for (metallic, roughness) in [(0.0, 0.3), (0.0, 1.0), (1.0, 0.4), (0.35, 0.7)] {
        let parameters = Parameters { base_color, metallic, roughness, ..Parameters::default() };
        let bsdf = Bsdf::new(&parameters, Lobe::Ggx);
        for (v, l) in pairs() {
            let found = bsdf.evaluate(v, l).value;
            for (found, base) in found.into_iter().zip(base_color) {
                assert_near(found, gltf_material(base, metallic, roughness, v, l) * l.z);
            }
        }
    }
}

#[test]
fn coats_are_those_of_the_gltf_extension() {
    let coat_normal = DVec3::new(0.2, -0.1, 1.0).normalize();
    let parameters = Parameters {
        base_color: [0.5; 3],
        roughness: 0.6,
        clearcoat: 0.7,
        clearcoat_roughness: 0.4,
        clearcoat_normal: coat_normal,
        ..Parameters::default()
    };
    let bsdf = Bsdf::new(&parameters, Lobe::Ggx);
    let turn = glam::DQuat::from_rotation_arc(coat_normal, DVec3::Z);
    for (v, l) in pairs() {
        let (v_coat, l_coat) = (turn * v, turn * l);
        let share = 0.7 * (0.04 + 0.96 * (1.0 - v_coat.z.abs()).powi(5));
        let facing = v_coat.z > 0.0 && l_coat.z > 0.0;
        let layer = if facing { gltf_specular(0.16, v_coat, l_coat) * l_coat.z } else { 0.0 };
        let base = gltf_material(0.5, 0.0, 0.6, v, l) * l.z;
        assert_near(bsdf.evaluate(v, l).value[0], base * (1.0 - share) + layer * share);
    }
}

#[test]
fn lambert_ggx_and_the_coat_s_lobe_are_reciprocal() {
    let mixed = Parameters { base_color: [0.9, 0.5, 0.1], metallic: 0.4, roughness: 0.5, ..metal(0.5) };
    for parameters in [matte(), mixed, metal(1.0), metal(0.05)] {
        let bsdf = Bsdf::new(&parameters, Lobe::Ggx);
        for (v, l) in pairs() {
            let (there, back) = (bsdf.evaluate(v, l).value[1], bsdf.evaluate(l, v).value[1]);
            assert_near(there / l.z, back / v.z);
        }
    }
    let coat = Shape::coat(0.3, Lobe::Ggx);
    for (v, l) in pairs() {
        assert_near(coat.evaluate(v, l)[0] / l.z, coat.evaluate(l, v)[0] / v.z);
    }
}

#[test]
fn blinn_has_the_peak_of_the_paper() {
    // Eq. 4 over eq. 5's remainders 0.500, 0.646, 0.823 and 0.9945.
    for (exponent, remainder) in [(0.0, 0.5), (1.0, 0.646), (3.0, 0.823), (13.0, 0.9945)] {
        let peak = blinn(exponent).evaluate(DVec3::Z, DVec3::Z).value[0];
        let expected = (exponent + 2.0) / (8.0 * PI) / remainder;
        assert!((peak / expected - 1.0).abs() < 1e-3, "n {exponent}: {peak} {expected}");
    }
    let lobe = blinn(50.0);
    for (v, l) in pairs() {
        let relative = (v + l).normalize().z.powi(50);
        assert_near(lobe.evaluate(v, l).value[0], relative * lobe.evaluate(DVec3::Z, DVec3::Z).value[0]);
    }
}

#[test]
fn cones_have_the_weights_of_the_paper() {
    for (half_angle_deg, shine) in [(5.8, 897.0), (11.6, 223.0), (18.85, 84.0)] {
        let Shape::Round(Round::Cone { shine: found, .. }) = cone(half_angle_deg).specular else {
            panic!("no cone");
        };
        assert!((found - shine).abs() < 1.0, "{half_angle_deg}: {found}");
        let lobe = cone(half_angle_deg);
        let v = at_degrees(30.0);
        let along = |degrees: f64| {
            let turned = (30.0 - degrees).to_radians();
            DVec3::new(-0.8 * turned.sin(), -0.6 * turned.sin(), turned.cos())
        };
        let value = |degrees| lobe.evaluate(v, along(degrees)).value[0];
        assert!((value(0.999999 * half_angle_deg) / value(0.0) - 0.01).abs() < 1e-6);
        assert_near(value(2.0) / value(0.0), 2.0_f64.to_radians().cos().powf(found));
        assert_eq!(value(1.0001 * half_angle_deg), 0.0);
    }
    // Without a spread the weights reach 1 % at the rim too, and the exponent is a quarter of Blinn's.
    let by_exponent = Bsdf::new(&Parameters { shininess: Some(400.0), ..metal(0.5) }, Lobe::PhongCone);
    let Shape::Round(Round::Cone { half_angle_rad, shine, .. }) = by_exponent.specular else {
        panic!("no cone")
    };
    assert_near(shine, 100.0);
    assert_near(half_angle_rad.cos().powf(shine), 0.01);
}

#[test]
fn the_diffused_lobe_s_axis_is_eq_3() {
    let v = at_degrees(60.0);
    for t in [0.1, 0.5, 0.9] {
        let lobe = Bsdf::new(&metal(t), Lobe::DiffusedEnvironment);
        let mirror = DVec3::new(-v.x, -v.y, v.z);
        let axis = ((1.0 - t) * mirror + t * DVec3::Z).normalize();
        assert_near(lobe.evaluate(v, axis).pdf, 1.0 / (PI * t * t));
        // The lobe ends at t pi / 2 from there.
        let sideways = mirror.cross(DVec3::Z).normalize();
        let at = |angle: f64| (angle.cos() * axis + angle.sin() * sideways).normalize();
        assert!(lobe.evaluate(v, at(0.499 * PI * t)).pdf > 0.0);
        assert_eq!(lobe.evaluate(v, at(0.501 * PI * t)).pdf, 0.0);
        let angle = 0.2 * t;
        let expected = (2.0 * angle / t).sin() / (2.0 * PI * t * angle.sin());
        assert!((lobe.evaluate(v, at(angle)).pdf / expected - 1.0).abs() < 1e-12);
    }
}

/// The rule of 32 points against a sum over a million equal shares of the lobe.
#[test]
fn shares_above_the_horizon_are_as_exact_as_documented() {
    let mut worst = 0.0_f64;
    let mut compare = |lobe: Round, lift_deg: f64| {
        let (sine, cosine) = lift_deg.to_radians().sin_cos();
        let count = 1_000_000;
        let above: f64 = (0..count)
            .map(|i| {
                let angle = lobe.angle_of((f64::from(i) + 0.5) / f64::from(count));
                let dip = (sine * angle.cos() / (cosine * angle.sin())).clamp(-1.0, 1.0);
                0.5 + dip.asin() / PI
            })
            .sum();
        let error = lobe.share_above(DVec3::new(cosine, 0.0, sine)) - above / f64::from(count);
        worst = worst.max(error.abs());
        assert!(error.abs() < 3e-6, "{lobe:?} {lift_deg}: {error:e}");
    };
    for lift_deg in [1e-3, 0.01, 0.1, 1.0, 5.0, 20.0, 45.0, 80.0] {
        for t in [0.01, 0.1, 0.5, 0.9, 1.0] {
            compare(Round::Diffused { t }, lift_deg);
        }
        for (half_angle_rad, shine) in
            [(0.1, 897.0), (0.3, 100.0), (1.0, 2.0), (0.5 * PI, 0.0), (0.5 * PI, 5000.0)]
        {
            compare(Round::cone(half_angle_rad, shine), lift_deg);
        }
    }
    println!("worst: {worst:e}");
}

#[test]
fn the_split_sum_has_the_values_of_its_source() {
    // Karis 2014, EnvBRDFApprox, by hand.
    let cases = [
        (0.04, 0.0, 1.0, 0.0456380),
        (0.04, 0.0, 0.1, 0.5687775),
        (1.0, 0.5, 1.0, 0.725),
        (1.0, 0.5, 0.2, 0.725),
    ];
    for (ks, roughness, cosine, expected) in cases {
        let parameters = Parameters { ks: Some([ks; 3]), roughness, ..metal(0.0) };
        let found =
            Bsdf::new(&parameters, Lobe::DiffusedEnvironment).reflectance.split(cosine, cosine, cosine);
        assert!((found.specular[0] - expected).abs() < 1e-6, "{found:?} {expected}");
    }
}

#[test]
fn the_diffused_environment_divides_light_as_its_technique_does() {
    let parameters = Parameters {
        base_color: [0.8, 0.4, 0.2],
        metallic: 0.5,
        roughness: 1.0,
        ambient_occlusion: 0.5,
        ..Parameters::default()
    };
    let bsdf = Bsdf::new(&parameters, Lobe::DiffusedEnvironment);
    let (v, l) = (at_degrees(50.0), at_degrees(20.0));
    // Karis's fit at roughness 1 is ks (1.04 - 0.572 - 1.04 * 0.015) + 1.04 * 0.015 - 0.018.
    let a = 1.04 * 0.015;
    let specular = [0.42, 0.22, 0.12].map(|ks: f64| ks * (0.468 - a) + a - 0.018);
    let found = bsdf.evaluate(v, l).value;
    for (i, base) in [0.8, 0.4, 0.2].into_iter().enumerate() {
        let diffuse = base * 0.5 * 0.5 * (1.0 - specular[0]);
        // At t = 1 both lobes are Lambert's.
        assert_near(found[i], (specular[i] + diffuse) * l.z / PI);
    }
}
