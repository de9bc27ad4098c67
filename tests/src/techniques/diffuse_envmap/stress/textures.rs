//! The library's functions that read textures, on the [stage](super::stage).

use super::{
    case,
    math::{ANY, vector},
    stage::{self, STAGE, Stage},
    twin,
};
use crate::technique::{Input, StressCase, Tolerance};
use diffuse_envmap::{Base, Distribution, Horizon, model};
use shaders::DIFFUSE_ENVMAP_LIBRARY as LIBRARY;
use std::f64::consts::FRAC_PI_2;

const UNIT: Input = Input::UnitVector;
const PART: Input = Input::Real { least: 0.0, greatest: 1.0 };
/// The roughness of a lobe that the tables hold.
const LOBE: Input = Input::Real { least: 0.001, greatest: 1.0 };
/// Whether what is below the horizon is left out.
const DISCARD: Input = Input::Integer { below: 2 };
const RGB: &[&str] = &["red", "green", "blue"];

pub(super) fn cases() -> Vec<StressCase> {
    vec![
        lookup(),
        texel(),
        paper(),
        bands(),
        band_4(),
        harmonics(),
        harmonics_by_series(),
        sources(),
        chain(),
        ring(),
        narrow_tap(),
        narrow(),
        wide(),
        sheen(),
        radiance(),
        radiance_of_anything(),
    ]
}

/// A case on the stage.
fn staged(
    function: &'static str,
    inputs: Vec<Input>,
    body: &'static str,
    outputs: &'static [&'static str],
    tolerance: Tolerance,
    model: impl Fn(&[f64]) -> Vec<f64> + Sync + 'static,
) -> StressCase {
    StressCase {
        inputs,
        tolerance,
        bindings: Some(Box::new(stage::bind)),
        ..case(function, &LIBRARY, body, outputs, model)
    }
}

fn within(absolute: f64, reason: &'static str) -> Tolerance {
    Tolerance { absolute, relative: 0.0, slack: None, reason }
}

const BILINEAR: &str =
    "samplers weigh texels in steps of 1/256; neighbours of this map differ by 0.2 at most";
const CUBE: &str = "samplers weigh texels in steps of 1/256, texels are half floats near 4, and a face's \
                    texels hold a direction to the square of their width";

fn lookup() -> StressCase {
    staged(
        "diffuse_envmap_lookup",
        vec![UNIT],
        "let c = diffuse_envmap_lookup(map, linear, vec3f(x[0], x[1], x[2]));
         y[0] = c.r; y[1] = c.g; y[2] = c.b;",
        RGB,
        within(2e-3, BILINEAR),
        |x| STAGE.map.sample(vector(x)).to_vec(),
    )
}

fn texel() -> StressCase {
    let any_turn = Input::Real { least: -2.0, greatest: 3.0 };
    staged(
        "diffuse_envmap_texel",
        vec![any_turn, Input::Real { least: -1.0, greatest: 2.0 }],
        "let c = diffuse_envmap_texel(map, linear, vec2f(x[0], x[1]));
         y[0] = c.r; y[1] = c.g; y[2] = c.b;",
        RGB,
        within(2e-3, BILINEAR),
        |x| {
            // The direction of these coordinates: u wraps, v does not. The middle of a row of
            // texels is as far as v reaches.
            let rows = f64::from(stage::MAP[1]);
            let polar = std::f64::consts::PI * x[1].clamp(0.5 / rows, 1.0 - 0.5 / rows);
            let longitude = std::f64::consts::TAU * (x[0] - 0.5);
            let (sine, cosine) = polar.sin_cos();
            STAGE.map.sample([sine * longitude.cos(), cosine, sine * longitude.sin()]).to_vec()
        },
    )
}

fn paper() -> StressCase {
    const RAYS: u32 = 37;
    fn arguments(x: &[f64]) -> (model::Vec3, model::Vec3, f64, Horizon, Distribution) {
        let horizon = if x[7] == 0.0 { Horizon::Keep } else { Horizon::Discard };
        let distribution = if x[8] == 0.0 { Distribution::Cosine } else { Distribution::UniformAngle };
        (vector(x), vector(&x[3..]), x[6], horizon, distribution)
    }
    staged(
        "diffuse_envmap_paper",
        vec![UNIT, UNIT, PART, DISCARD, Input::Integer { below: 2 }],
        "let p = stage(2u * u[7] + 4u * u[8]);
         let c = diffuse_envmap_paper(map, linear, p, vec3f(x[0], x[1], x[2]), vec3f(x[3], x[4], x[5]), x[6], vec2u(0u));
         y[0] = c.r; y[1] = c.g; y[2] = c.b;",
        RGB,
        Tolerance {
            absolute: 2.5e-3,
            relative: 0.0,
            // Rays near the horizon may fall on either side: the adapter's acos is off by 2e-4.
            slack: Some(|x| {
                let (axis, normal, t, horizon, distribution) = arguments(x);
                if horizon == Horizon::Keep {
                    return 0.0;
                }
                let (mut near, mut above) = (0.0, 0.0);
                for ray in 0..RAYS {
                    let xi = (f64::from(ray) + 0.5) / f64::from(RAYS);
                    let theta = match distribution {
                        Distribution::Cosine => model::sample_angle(t, xi),
                        Distribution::UniformAngle => t * FRAC_PI_2 * xi,
                    };
                    let turn = (f64::from(ray) * 0.618_033_988_749_895).fract();
                    let direction = model::around(axis, theta, std::f64::consts::TAU * turn);
                    let height = model::dot(direction, normal);
                    near += f64::from(u8::from(height.abs() < 3e-4));
                    above += f64::from(u8::from(height > 0.0));
                }
                if near > 0.0 { near / f64::max(above - near, 0.3) } else { 0.0 }
            }),
            reason: BILINEAR,
        },
        |x| {
            let (axis, normal, t, horizon, distribution) = arguments(x);
            model::paper(&STAGE.map, axis, normal, t, horizon, RAYS, distribution).to_vec()
        },
    )
}

fn bands() -> StressCase {
    let factor = Input::Real { least: -1.0, greatest: 1.0 };
    staged(
        "diffuse_envmap_bands",
        vec![UNIT, factor, factor],
        "let c = diffuse_envmap_bands(tables, vec3f(x[0], x[1], x[2]), x[3], x[4]);
         y[0] = c.r; y[1] = c.g; y[2] = c.b;",
        RGB,
        within(1e-6, "eight products of numbers below 1"),
        |x| STAGE.bands(vector(x), x[3], x[4]).to_vec(),
    )
}

fn band_4() -> StressCase {
    staged(
        "diffuse_envmap_band_4",
        vec![UNIT],
        "let c = diffuse_envmap_band_4(tables, vec3f(x[0], x[1], x[2]));
         y[0] = c.r; y[1] = c.g; y[2] = c.b;",
        RGB,
        within(3e-6, "polynomials of degree four with factors up to 35"),
        |x| STAGE.band_4(vector(x)).to_vec(),
    )
}

const HARMONICS: &str = "let c = diffuse_envmap_harmonics(tables, vec3f(x[0], x[1], x[2]), x[3]);
                         y[0] = c.r; y[1] = c.g; y[2] = c.b;";

fn harmonics() -> StressCase {
    staged(
        "diffuse_envmap_harmonics",
        vec![UNIT, PART],
        HARMONICS,
        RGB,
        within(2e-6, "the bands, and a sine squared over its argument that stays near 2.5"),
        |x| STAGE.harmonics(vector(x), x[3]).to_vec(),
    )
}

/// The same with the lobe's coefficients integrated instead of in closed form.
fn harmonics_by_series() -> StressCase {
    let model = |x: &[f64]| {
        let (axis, lobe) = (vector(x), model::legendre_coefficients(x[3], 2));
        let mean = [0, 1, 2].map(|c| STAGE.tables[2][0][c]);
        let low = model::add_scaled(mean, STAGE.bands(axis, lobe[1], lobe[2]), 1.0);
        model::add_scaled(low, STAGE.band_4(axis), -1.0 / 24.0).map(|x| x.max(0.0)).to_vec()
    };
    StressCase {
        samples: Some(4096),
        ..staged(
            "diffuse_envmap_harmonics [series]",
            vec![UNIT, PART],
            HARMONICS,
            RGB,
            within(2e-6, "as before: the closed forms are exact"),
            model,
        )
    }
}

fn sources() -> StressCase {
    staged(
        "diffuse_envmap_sources",
        vec![UNIT, UNIT, LOBE, PART, DISCARD],
        "let c = diffuse_envmap_sources(tables, stage(2u * u[8]), vec3f(x[0], x[1], x[2]),
             vec3f(x[3], x[4], x[5]), x[6], x[7]);
         y[0] = c.r; y[1] = c.g; y[2] = c.b;",
        RGB,
        Tolerance {
            absolute: 1e-6,
            relative: 2e-3,
            // Relative to the peak of the narrowest source, and of a lobe that is cut by the
            // horizon over the part that is left.
            slack: Some(|x| {
                let t = x[6].max(0.005);
                let lift = model::dot(vector(x), vector(&x[3..])).clamp(-1.0, 1.0).asin();
                let discards = x[8] != 0.0 && t < 0.5;
                let part = if discards { twin::above(x[6], lift).max(0.02) } else { 1.0 };
                1e-4 * 0.5 / (std::f64::consts::PI * t * t) / part
            }),
            reason: "densities relative to their peak; angles good to 4e-6 that decide how much of a small \
                     source is above the horizon",
        },
        |x| {
            let discard = x[8] != 0.0;
            twin::sources(&STAGE.sources, vector(x), vector(&x[3..]), x[6], x[7], discard).to_vec()
        },
    )
}

fn chain() -> StressCase {
    staged(
        "diffuse_envmap_chain",
        vec![UNIT, Input::Real { least: -12.0, greatest: 2.0 }],
        "let c = diffuse_envmap_chain(chain, linear, stage(0u), vec3f(x[0], x[1], x[2]), x[3]);
         y[0] = c.r; y[1] = c.g; y[2] = c.b; y[3] = c.a;",
        &["red", "green", "blue", "root mean square"],
        within(2e-2, CUBE),
        |x| Stage::chain(vector(x), x[3]).to_vec(),
    )
}

fn ring() -> StressCase {
    staged(
        "diffuse_envmap_ring",
        vec![
            UNIT,
            UNIT,
            Input::Real { least: 0.001, greatest: 1.0 },
            Input::Real { least: -12.0, greatest: 2.0 },
            DISCARD,
        ],
        "let c = diffuse_envmap_ring(chain, linear, stage(2u * u[8]), vec3f(x[0], x[1], x[2]),
             vec3f(x[3], x[4], x[5]), x[6], x[7]);
         y[0] = c.r; y[1] = c.g; y[2] = c.b;",
        RGB,
        Tolerance {
            // As much as one tap, where all others are below the horizon.
            absolute: 2e-2,
            relative: 0.0,
            slack: Some(|x| {
                if x[8] == 0.0 {
                    return 0.0;
                }
                let (axis, normal) = (vector(x), vector(&x[3..]));
                let weights: f64 = (0..6)
                    .map(|tap| {
                        let phi = std::f64::consts::TAU * (f64::from(tap) + 0.5) / 6.0;
                        let d = model::around(axis, x[6], phi);
                        (model::dot(d, normal) / x[6] * 2.0 + 0.5).clamp(0.0, 1.0)
                    })
                    .sum();
                // A ring all of which is below the horizon has no radiance to speak of.
                let rounding = 2e-6 / x[6] + 1e-6;
                5.0 * rounding / (weights + 1e-6)
            }),
            reason: CUBE,
        },
        |x| Stage::ring(vector(x), vector(&x[3..]), x[6], x[7], x[8] != 0.0).to_vec(),
    )
}

fn narrow_tap() -> StressCase {
    staged(
        "diffuse_envmap_narrow_tap",
        vec![UNIT, PART],
        "let c = diffuse_envmap_narrow_tap(map, residual, linear, vec3f(x[0], x[1], x[2]), x[3]);
         y[0] = c.r; y[1] = c.g; y[2] = c.b;",
        RGB,
        within(2e-3, BILINEAR),
        |x| STAGE.narrow_tap(vector(x), x[3]).to_vec(),
    )
}

fn narrow() -> StressCase {
    staged(
        "diffuse_envmap_narrow",
        vec![UNIT, PART, PART],
        "let c = diffuse_envmap_narrow(map, residual, linear, vec3f(x[0], x[1], x[2]), x[3], x[4]);
         y[0] = c.r; y[1] = c.g; y[2] = c.b;",
        RGB,
        within(2e-3, BILINEAR),
        |x| STAGE.narrow(vector(x), x[3], x[4]).to_vec(),
    )
}

fn wide() -> StressCase {
    staged(
        "diffuse_envmap_wide",
        vec![UNIT, LOBE],
        "let axis = vec3f(x[0], x[1], x[2]);
         let c = diffuse_envmap_wide(chain, tables, linear, stage(2u), axis, axis, x[3]);
         y[0] = c.r; y[1] = c.g; y[2] = c.b; y[3] = c.a;",
        &["red", "green", "blue", "extended share lacking"],
        Tolerance {
            absolute: 2e-2,
            relative: 0.0,
            // The share of the ring follows from the contrast that the sampler's rounding leaves.
            slack: Some(contrast_slack),
            reason: CUBE,
        },
        |x| STAGE.wide(vector(x), vector(x), x[3], 0.15, true).to_vec(),
    )
}

/// How far the mix of axis tap and ring may be off, because the contrast, a difference of squares,
/// is.
fn contrast_slack(x: &[f64]) -> f64 {
    let d = vector(x);
    let [r, g, b, w] = Stage::chain(d, -5.0);
    let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let contrast = (w * w - luminance * luminance).max(0.0).sqrt() / luminance;
    // d(contrast) = contrast's slope times the rounding of 4e-3 in w and luminance.
    let rounding = 4e-3 / contrast.max(0.05);
    if (0.1..0.4).contains(&contrast) { 3.0 * rounding } else { 0.0 }
}

fn sheen() -> StressCase {
    staged(
        "diffuse_envmap_sheen",
        vec![UNIT, PART],
        "let axis = vec3f(x[0], x[1], x[2]);
         let c = diffuse_envmap_sheen(map, residual, chain, tables, linear, stage(2u), axis, axis, x[3]);
         y[0] = c.r; y[1] = c.g; y[2] = c.b;",
        RGB,
        Tolerance {
            absolute: 2e-2,
            relative: 2e-3,
            slack: Some(|x| contrast_slack(x) + 1e-3 / x[3].max(0.01).powi(2) * 0.05),
            reason: CUBE,
        },
        |x| STAGE.sheen(vector(x), vector(x), x[3], 0.15, true).to_vec(),
    )
}

fn radiance() -> StressCase {
    let model = |x: &[f64]| {
        let (normal, view, t) = (vector(x), vector(&x[3..]), x[6]);
        let axis = model::base(model::mirror(view, normal), normal, t, Base::Slerp);
        let axis = if t == 0.0 { model::mirror(view, normal) } else { axis };
        STAGE.sheen(axis, normal, t, 0.15, false).to_vec()
    };
    staged(
        "diffuse_envmap_radiance",
        vec![UNIT, UNIT, PART],
        "let c = diffuse_envmap_radiance(map, residual, chain, tables, linear, stage(1u),
             vec3f(x[0], x[1], x[2]), vec3f(x[3], x[4], x[5]), vec3f(0.0), x[6], vec2u(0u));
         y[0] = c.r; y[1] = c.g; y[2] = c.b;",
        RGB,
        Tolerance {
            absolute: 2e-2,
            relative: 2e-3,
            slack: Some(|x| {
                let (normal, view, t) = (vector(x), vector(&x[3..]), x[6]);
                let mirror = model::mirror(view, normal);
                let axis = model::base(mirror, normal, t, Base::Slerp);
                // A slerp between nearly opposite directions turns with the last digit.
                let across = std::f64::consts::PI - model::dot(mirror, normal).clamp(-1.0, 1.0).acos();
                let unstable = if across < 0.02 { 10.0 } else { 0.0 };
                contrast_slack(&axis) + 1e-3 / t.max(0.01).powi(2) * 0.05 + unstable
            }),
            reason: CUBE,
        },
        model,
    )
}

/// Whatever is asked: finite radiance that is not negative.
fn radiance_of_anything() -> StressCase {
    staged(
        "diffuse_envmap_radiance [anything]",
        vec![ANY, ANY, ANY, ANY, ANY, ANY, ANY, Input::Integer { below: 64 }],
        "var p = stage(u[7] & 31u);
         p.method = u[7] >> 5u;
         p.box_min_world = vec4f(-1.0);
         p.box_max_world = vec4f(2.0);
         let c = diffuse_envmap_radiance(map, residual, chain, tables, linear, p, vec3f(x[0], x[1], x[2]),
             vec3f(x[3], x[4], x[5]), vec3f(0.25), x[6], vec2u(7u));
         let least = min(c.r, min(c.g, c.b));
         let greatest = max(c.r, max(c.g, c.b));
         y[0] = select(0.0, 1.0, least >= 0.0 && greatest <= 1e6 && c.r == c.r && c.g == c.g && c.b == c.b);",
        &["is a radiance"],
        within(0.0, "yes or no"),
        |_| vec![1.0],
    )
}
