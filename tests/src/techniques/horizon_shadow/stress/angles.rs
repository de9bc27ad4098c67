//! Tangents, sines, discs and codes.

use super::{case, real, within};
use crate::technique::{Input, StressCase, Tolerance};
use horizon_shadow::{
    Precision,
    codes::{Codes, SLOPE_SCALE},
    model,
};
use std::f64::consts::{FRAC_PI_2, PI};

// The bodies below spell it out.
const _: () = assert!(SLOPE_SCALE == 0.5);

pub(super) fn cases() -> Vec<StressCase> {
    let mut all = vec![half_tangent(), exact(), exact_slopes(), exact_rises(), higher(), floor(), floors()];
    all.extend([floor_rises(), sine_of(), sines_of(), tangent_of(), tangent(), fraction(), disc(), small()]);
    all.extend([
        normal_share(),
        candidate(),
        slope_code(),
        distance_code(),
        slope_error(),
        is_finite(),
        bounded(),
    ]);
    all
}

const HALF: &str = "a polynomial within 4.2e-6";

fn half_tangent() -> StressCase {
    case(
        "horizon_shadow_half_tangent",
        vec![real(0.0, 2.467_401)],
        "y[0] = horizon_shadow_half_tangent(vec4f(x[0])).y;",
        &["ratio"],
        within(4.3e-6, 0.0, HALF),
        |x| {
            let half = 0.5 * x[0].sqrt();
            vec![if half < 1e-9 { 1.0 } else { half.tan() / half }]
        },
    )
}

/// Curvature, distance, slope and height.
fn line() -> Vec<Input> {
    vec![real(-0.5, 0.5), real(0.0, 64.0), real(-20.0, 20.0), real(0.0, 100.0)]
}

/// Where rounding decides whether a point is seen at all, and where it is seen at the end of a
/// vanishing lever: nothing is promised.
fn is_edge(kappa: f64, distance: f64, slope: f64, height: f64) -> bool {
    let gamma = kappa * distance;
    let across = 1.0 + kappa * height + gamma * slope;
    (gamma.abs() - FRAC_PI_2).abs() < 1e-5 || across.abs() < 1e-3 * (1.0 + (gamma * slope).abs())
}

fn exact_model(x: &[f64]) -> f64 {
    if is_edge(x[0], x[1], x[2], x[3]) { f64::NAN } else { model::exact_slope(x[0], x[1], x[2], x[3]) }
}

const EXACT: &str = "a polynomial within 4.2e-6, used three times, and what is left when 1 + kappa h and gamma H \
                     cancel to a thousandth";

/// Terms that cancel, in units of the result.
fn exact_slack(x: &[f64]) -> f64 {
    let (gamma, slope, from_centre) = (x[0] * x[1], x[2], 1.0 + x[0] * x[3]);
    let across = (from_centre + gamma * slope).abs();
    let tangent = model::exact_slope(x[0], x[1], slope, x[3]);
    let terms = slope.abs() + from_centre.abs() * gamma.abs();
    let lever = 1.0 + (x[0] * x[3]).abs() + (gamma * slope).abs();
    (3e-5 * terms + 1e-6 * lever * tangent.abs()) / across.max(1e-9)
}

fn exact_tolerance() -> Tolerance {
    Tolerance { absolute: 1e-6, relative: 2e-5, slack: Some(exact_slack), reason: EXACT }
}

fn exact_slopes() -> StressCase {
    case(
        "horizon_shadow_exact_slopes",
        line(),
        "y[0] = horizon_shadow_exact_slopes(x[0], vec4f(x[1]), vec4f(x[2]), vec4f(x[3])).z;",
        &["tangent"],
        exact_tolerance(),
        |x| vec![exact_model(x)],
    )
}

fn exact() -> StressCase {
    let mut inputs = line();
    inputs[1] = real(0.1, 64.0);
    case(
        "horizon_shadow_exact",
        inputs,
        "y[0] = horizon_shadow_exact(x[0], x[1], x[2] * x[1], x[3]);",
        &["tangent"],
        exact_tolerance(),
        |x| vec![exact_model(x)],
    )
}

/// As sines, with slopes as fractions.
fn exact_rises() -> StressCase {
    let mut inputs = line();
    inputs.push(real(1e-3, 1.0));
    case(
        "horizon_shadow_exact_rises",
        inputs,
        "let r = horizon_shadow_exact_rises(x[0], vec4f(x[1]), vec4f(x[2] * x[4]), vec4f(x[4]), vec4f(x[3]));
         y[0] = r.up.x * inverseSqrt(r.up.x * r.up.x + r.across.x * r.across.x);",
        &["sine"],
        Tolerance { absolute: 1e-5, relative: 0.0, slack: Some(exact_slack), reason: EXACT },
        |x| vec![if exact_model(x).is_nan() { f64::NAN } else { model::sine_of(exact_model(x)) }],
    )
}

fn higher() -> StressCase {
    case(
        "horizon_shadow_higher",
        vec![real(-50.0, 50.0), real(0.01, 10.0), real(-50.0, 50.0), real(0.01, 10.0)],
        "let r = horizon_shadow_higher(HorizonShadowRises(vec4f(x[0]), vec4f(x[1])),
            HorizonShadowRises(vec4f(x[2]), vec4f(x[3])));
         y[0] = r.up.x / r.across.x;",
        &["tangent"],
        within(1e-6, 1e-6, "two products and a quotient"),
        |x| vec![(x[0] / x[1]).max(x[2] / x[3])],
    )
}

const DIP: &str = "a square root of two units in the last place, without cancellation";

fn floor() -> StressCase {
    case(
        "horizon_shadow_floor",
        vec![real(-1.0, 1.0), real(0.0, 1000.0)],
        "y[0] = horizon_shadow_floor(x[0], x[1]);",
        &["tangent"],
        within(1e-15, 2e-6, DIP),
        |x| vec![model::floor(x[0], x[1])],
    )
}

fn floors() -> StressCase {
    case(
        "horizon_shadow_floors",
        vec![real(1e-12, 1.0), real(0.0, 1000.0)],
        "y[0] = horizon_shadow_floors(x[0], vec4f(x[1])).w;",
        &["tangent"],
        within(1e-15, 2e-6, DIP),
        |x| vec![model::floor(x[0], x[1])],
    )
}

fn floor_rises() -> StressCase {
    case(
        "horizon_shadow_floor_rises",
        vec![real(-1.0, 1.0), real(0.0, 1000.0)],
        "let r = horizon_shadow_floor_rises(x[0], vec4f(x[1]));
         y[0] = select(r.up.x, -1e4, r.across.x == 0.0);",
        &["tangent"],
        within(1e-15, 2e-6, DIP),
        |x| vec![model::floor(x[0], x[1])],
    )
}

fn sine_of() -> StressCase {
    case(
        "horizon_shadow_sine_of",
        vec![real(-1e4, 1e4)],
        "y[0] = horizon_shadow_sine_of(x[0]);",
        &["sine"],
        within(0.0, 1e-6, "an inverse square root of two units in the last place"),
        |x| vec![model::sine_of(x[0])],
    )
}

fn sines_of() -> StressCase {
    case(
        "horizon_shadow_sines_of",
        vec![real(-1e4, 1e4)],
        "y[0] = horizon_shadow_sines_of(vec4f(0.0, 0.0, 0.0, x[0])).w;",
        &["sine"],
        within(0.0, 1e-6, "an inverse square root of two units in the last place"),
        |x| vec![model::sine_of(x[0])],
    )
}

fn tangent_of() -> StressCase {
    case(
        "horizon_shadow_tangent_of",
        vec![real(-1.0, 1.0)],
        "y[0] = horizon_shadow_tangent_of(x[0]);",
        &["tangent"],
        Tolerance {
            absolute: 0.0,
            relative: 2e-6,
            // The square of the cosine is bounded by 1e-12, of which an f32 next to 1 knows 6e-8.
            slack: Some(|x| if x[0].abs() > 1.0 - 1e-6 { 1e4 } else { 0.0 }),
            reason: "an inverse square root of two units in the last place",
        },
        |x| vec![model::tangent_of(x[0])],
    )
}

fn tangent() -> StressCase {
    case(
        "horizon_shadow_tangent",
        vec![real(-1.57, 1.57)],
        "y[0] = horizon_shadow_tangent(x[0]);",
        &["tangent"],
        Tolerance {
            absolute: 0.0,
            relative: 2e-5,
            // 1 - t^2 is known to 1e-5.
            slack: Some(|x| {
                let tangent = x[0].tan().abs();
                1e-5 * tangent * tangent + if tangent > 1e3 { 2.0 * tangent } else { 0.0 }
            }),
            reason: HALF,
        },
        |x| vec![x[0].tan()],
    )
}

fn small() -> StressCase {
    case(
        "horizon_shadow_sine_small",
        vec![real(0.0, 1.5)],
        "y[0] = horizon_shadow_sine_small(x[0]);",
        &["sine"],
        within(0.0, 5e-6, HALF),
        |x| vec![x[0].sin()],
    )
}

fn disc() -> StressCase {
    case(
        "horizon_shadow_disc",
        vec![real(-1.0, 1.0)],
        "y[0] = horizon_shadow_disc(x[0]);",
        &["part"],
        within(4e-6, 0.0, "a polynomial within 3e-6"),
        |x| vec![0.5 + (x[0].asin() + x[0] * (1.0 - x[0] * x[0]).sqrt()) / PI],
    )
}

fn fraction() -> StressCase {
    case(
        "horizon_shadow_fraction",
        vec![real(-1.0, 1.0), real(-1.5, 1.5), real(0.0, 1.5)],
        "let s = sin(x[1]); let c = cos(x[1]);
         y[0] = horizon_shadow_fraction(x[0], s, c, x[2]);",
        &["part"],
        Tolerance {
            absolute: 1e-5,
            relative: 0.0,
            // The adapter's sine and cosine, over the radius; a point light's edge is a step.
            slack: Some(|x| {
                let apart = (x[1] - x[0].asin()).sin();
                let off = 2e-6;
                if x[2] < 1e-4 && apart.abs() < x[2] + off || (x[1] - x[0].asin()).abs() > FRAC_PI_2 - 1e-3 {
                    return 1.0;
                }
                2.0 * off / x[2].max(1e-4)
            }),
            reason: "a polynomial within 3e-6, and sines of f32",
        },
        |x| vec![model::fraction(x[0].asin(), x[1], x[2])],
    )
}

fn normal_share() -> StressCase {
    let mut case = case(
        "horizon_shadow_normal_share",
        vec![real(-100.0, 100.0)],
        "y[0] = horizon_shadow_normal_share(x[0]);",
        &["share"],
        within(2e-4, 0.0, "a logistic curve within 1.5e-4"),
        |x| vec![model::normal_share(x[0])],
    );
    case.samples = Some(20_000);
    case
}

fn candidate() -> StressCase {
    case(
        "horizon_shadow_candidate",
        vec![Input::Integer { below: 65536 }, Input::Integer { below: 65536 }, Input::Integer { below: 2 }],
        "var p: HorizonShadowParameters;
         p.radius_texels = 64.0; p.slope_scale = 0.5; p.contents = HORIZON_SHADOW_CONTENTS_COMPACT;
         let c = horizon_shadow_candidate(vec4u(u[0] | (u[1] << 16u)), u[2], p);
         y[0] = c.x; y[1] = c.y;",
        &["slope", "distance"],
        // A slope's code 0 stands for nothing.
        within(1e-6, 1e-4, "1 - |x| is a difference of numbers near 1"),
        |x| {
            let code = if x[2] == 0.0 { x[0] } else { x[1] } as u32;
            if code.trailing_zeros() >= 10 {
                return vec![f64::NAN; 2];
            }
            Codes::new(Precision::Compact, 64.0).decode(code).map(f64::from).to_vec()
        },
    )
}

fn slope_code() -> StressCase {
    case(
        "horizon_shadow_slope_code",
        vec![real(-1e6, 1e6)],
        "y[0] = f32(horizon_shadow_slope_code(x[0], vec2u(10u, 6u), 0.5));",
        &["code"],
        within(1.0, 0.0, "the code of a slope between two codes may be either"),
        |x| vec![f64::from(Codes::new(Precision::Compact, 64.0).slope_code(x[0] as f32))],
    )
}

fn distance_code() -> StressCase {
    case(
        "horizon_shadow_distance_code",
        vec![real(0.0, 100.0)],
        "y[0] = f32(horizon_shadow_distance_code(x[0], vec2u(10u, 6u), 64.0));",
        &["code"],
        within(1.0, 0.0, "the code of a distance between two codes may be either"),
        |x| vec![f64::from(Codes::new(Precision::Compact, 64.0).distance_code(x[0] as f32))],
    )
}

fn slope_error() -> StressCase {
    case(
        "horizon_shadow_slope_error",
        vec![real(-100.0, 100.0)],
        "var p: HorizonShadowParameters;
         p.slope_scale = 1.0; p.contents = HORIZON_SHADOW_CONTENTS_COMPACT;
         y[0] = horizon_shadow_slope_error(vec4f(x[0]), p).x;",
        &["error"],
        within(0.0, 1e-5, "two sums, two products and a quotient"),
        |x| vec![(1.0 + x[0].abs()).powi(2) / 1024.0],
    )
}

fn is_finite() -> StressCase {
    case(
        "horizon_shadow_is_finite",
        vec![Input::Any { least: -1e30, greatest: 1e30 }],
        "y[0] = select(0.0, 1.0, horizon_shadow_is_finite(x[0]));",
        &["finite"],
        within(0.0, 0.0, "bits"),
        |x| vec![f64::from(u8::from(x[0].is_finite()))],
    )
}

fn bounded() -> StressCase {
    case(
        "horizon_shadow_bounded",
        vec![Input::Any { least: -1e30, greatest: 1e30 }],
        "y[0] = horizon_shadow_bounded(x[0], 5.0);",
        &["value"],
        within(0.0, 0.0, "comparisons"),
        |x| vec![if x[0].is_finite() { x[0].clamp(-5.0, 5.0) } else { 0.0 }],
    )
}
