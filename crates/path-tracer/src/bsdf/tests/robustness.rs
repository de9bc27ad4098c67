//! Any parameters and any directions: never NaN, never negative, never a sample without density.

use glam::DVec3;
use proptest::prelude::*;

use super::{at_degrees, metal};
use crate::{
    Lobe,
    bsdf::{Bsdf, Parameters},
};

const LOBES: [Lobe; 4] = [Lobe::Ggx, Lobe::Blinn, Lobe::PhongCone, Lobe::DiffusedEnvironment];

/// Numbers that a material should hold, and numbers that it should not.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => 0.0..1.0_f64,
        1 => (-20.0..0.0_f64).prop_map(f64::exp),
        1 => prop::sample::select(vec![0.0, 1.0, -1.0, 2.0, 1e-4, 1e-300, 1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN]),
    ]
}

fn direction() -> impl Strategy<Value = DVec3> {
    let height = prop_oneof![4 => 0.0..1.0_f64, 1 => (-40.0..0.0_f64).prop_map(f64::exp)];
    (height, 0.0..std::f64::consts::TAU).prop_map(|(z, turn)| {
        let radius = ((1.0 - z) * (1.0 + z)).sqrt();
        DVec3::new(radius * turn.cos(), radius * turn.sin(), z)
    })
}

fn parameters() -> impl Strategy<Value = Parameters> {
    let color = || [number(), number(), number()];
    let exponent = prop_oneof![number(), (0.0..40.0_f64).prop_map(f64::exp)];
    (
        (color(), number(), number(), prop::option::of(color())),
        (prop::option::of(exponent), prop::option::of(number()), number(), number(), number()),
        (number(), number(), number()),
    )
        .prop_map(|((base_color, metallic, roughness, ks), (shininess, spread_rad, a, b, c), normal)| {
            Parameters {
                base_color,
                metallic,
                roughness,
                ks,
                shininess,
                spread_rad,
                clearcoat: a,
                clearcoat_roughness: b,
                clearcoat_normal: DVec3::new(normal.0, normal.1, normal.2),
                ambient_occlusion: c,
            }
        })
}

fn is_radiance(value: [f64; 3]) -> bool {
    value.iter().all(|&channel| channel.is_finite() && channel >= 0.0)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn anything_gives_light(
        parameters in parameters(),
        lobe in prop::sample::select(LOBES.to_vec()),
        outgoing in direction(),
        incoming in direction(),
        u in [0.0..1.0_f64, 0.0..1.0, 0.0..1.0],
    ) {
        let bsdf = Bsdf::new(&parameters, lobe);
        let evaluated = bsdf.evaluate(outgoing, incoming);
        prop_assert!(is_radiance(evaluated.value), "{evaluated:?}");
        prop_assert!(evaluated.pdf.is_finite() && evaluated.pdf >= 0.0, "{evaluated:?}");
        // What shines can be drawn.
        prop_assert!(evaluated.pdf > 0.0 || evaluated.value.iter().all(|&v| v <= 1e-200), "{evaluated:?}");
        let share = bsdf.transmitted_by_coat(outgoing);
        prop_assert!((0.0..=1.0).contains(&share));
        if let Some(drawn) = bsdf.sample(outgoing, u) {
            prop_assert!(is_radiance(drawn.weight), "{drawn:?}");
            prop_assert!(drawn.pdf > 0.0 && drawn.pdf.is_finite(), "{drawn:?}");
            prop_assert!((drawn.incoming.length() - 1.0).abs() < 1e-9 && drawn.incoming.z > 0.0);
            // No lobe reflects more than all, nor is one drawn ten times too seldom; Blinn's
            // weight alone reaches 4 at n = 0.
            prop_assert!(drawn.weight.iter().all(|&weight| weight < 50.0), "{drawn:?}");
            if drawn.is_delta {
                return Ok(());
            }
            let again = bsdf.evaluate(outgoing, drawn.incoming);
            prop_assert_eq!(again.pdf, drawn.pdf);
            prop_assert!(!bsdf.is_delta_only());
        }
    }
}

#[test]
fn extremes_of_roughness_and_direction() {
    for lobe in LOBES {
        for roughness in [0.0, 1e-300, 1e-4, 1e-3, 1.0] {
            let bsdf = Bsdf::new(&metal(roughness), lobe);
            for height in [1.0, 1e-3, 1e-8, 1e-100, f64::MIN_POSITIVE] {
                let outgoing = DVec3::new((1.0_f64 - height).max(0.0).sqrt(), 0.0, height).normalize();
                for u in [[0.0; 3], [0.5; 3], [1.0; 3], [f64::NAN; 3], [-1.0; 3], [0.25, 1.0 - 1e-16, 0.9]] {
                    if let Some(drawn) = bsdf.sample(outgoing, u) {
                        assert!(is_radiance(drawn.weight), "{lobe:?} {roughness} {height}: {drawn:?}");
                        assert!(drawn.incoming.is_finite() && drawn.pdf > 0.0);
                    }
                }
            }
        }
    }
}

#[test]
fn nothing_is_reflected_from_or_to_below() {
    for lobe in LOBES {
        let bsdf = Bsdf::new(&Parameters::default(), lobe);
        let (above, below) = (at_degrees(40.0), at_degrees(140.0));
        for (outgoing, incoming) in [(below, above), (above, below), (below, below), (above, DVec3::X)] {
            let evaluated = bsdf.evaluate(outgoing, incoming);
            assert_eq!((evaluated.value, evaluated.pdf), ([0.0; 3], 0.0));
        }
        assert_eq!(bsdf.sample(below, [0.1, 0.2, 0.3]), None);
        assert_eq!(bsdf.sample(DVec3::NAN, [0.1, 0.2, 0.3]), None);
    }
    let black = Parameters { base_color: [0.0; 3], ks: Some([0.0; 3]), ..Parameters::default() };
    for lobe in LOBES {
        let bsdf = Bsdf::new(&black, lobe);
        assert_eq!(bsdf.sample(at_degrees(40.0), [0.1, 0.2, 0.3]), None);
    }
}

#[test]
fn what_is_not_a_number_counts_as_absent() {
    let nan = f64::NAN;
    let broken = Parameters {
        base_color: [nan; 3],
        metallic: nan,
        roughness: nan,
        ks: Some([nan; 3]),
        shininess: Some(nan),
        spread_rad: Some(nan),
        clearcoat: nan,
        clearcoat_roughness: nan,
        clearcoat_normal: DVec3::NAN,
        ambient_occlusion: nan,
    };
    let plain = Parameters { base_color: [0.0; 3], ks: Some([0.0; 3]), ..Parameters::default() };
    for lobe in LOBES {
        assert_eq!(Bsdf::new(&broken, lobe), Bsdf::new(&plain, lobe));
    }
}
