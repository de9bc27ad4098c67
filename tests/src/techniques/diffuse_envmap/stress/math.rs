//! The functions of `common/math.wgsl`.

use super::case;
use crate::technique::{Input, StressCase, Tolerance};
use diffuse_envmap::model;
use std::f64::consts::{PI, TAU};

/// Any float, special values included.
pub(super) const ANY: Input = Input::Any { least: -1e16, greatest: 1e16 };

pub(super) fn cases() -> Vec<StressCase> {
    vec![normalize(), acos(), angle(), small_angle(), frame(), uv(), round_trip(), direction(), cube()]
}

pub(super) fn vector(x: &[f64]) -> model::Vec3 {
    [x[0], x[1], x[2]]
}

fn normalize() -> StressCase {
    let model = |x: &[f64]| {
        let v = vector(x);
        let squared = model::dot(v, v);
        // Where the square itself is at the edge, either answer is right.
        let edge = [1e-20, 1e30].iter().any(|edge| (squared / edge - 1.0).abs() < 1e-5);
        if edge {
            return vec![f64::NAN; 3];
        }
        let inside = squared > 1e-20 && squared < 1e30;
        (if inside { v.map(|c| c / squared.sqrt()) } else { [0.0, 0.0, 1.0] }).to_vec()
    };
    StressCase {
        inputs: vec![ANY, ANY, ANY],
        tolerance: Tolerance {
            absolute: 3e-7,
            relative: 0.0,
            slack: None,
            reason: "a square, a sum, and an inverse square root of two units in the last place",
        },
        ..case(
            "sheen_normalize_or",
            &shaders::COMMON_MATH,
            "let v = sheen_normalize_or(vec3f(x[0], x[1], x[2]), vec3f(0.0, 0.0, 1.0));
             y[0] = v.x; y[1] = v.y; y[2] = v.z;",
            &["x", "y", "z"],
            model,
        )
    }
}

fn acos() -> StressCase {
    StressCase {
        inputs: vec![Input::Real { least: -1.001, greatest: 1.001 }],
        tolerance: Tolerance {
            absolute: 5e-6,
            relative: 0.0,
            slack: None,
            reason: "atan2 of the adapter, which is good to 4e-6",
        },
        ..case(
            "sheen_acos",
            &shaders::COMMON_MATH,
            "y[0] = sheen_acos(x[0]);",
            &["angle"],
            |x| vec![x[0].clamp(-1.0, 1.0).acos()],
        )
    }
}

fn exact_angle(a: model::Vec3, b: model::Vec3) -> f64 {
    let apart = model::add_scaled(a, b, -1.0);
    let along = model::add_scaled(a, b, 1.0);
    2.0 * model::dot(apart, apart).sqrt().atan2(model::dot(along, along).sqrt())
}

const ANGLE: &str = "y[0] = sheen_angle(vec3f(x[0], x[1], x[2]), vec3f(x[3], x[4], x[5]));";

fn angle() -> StressCase {
    StressCase {
        inputs: vec![Input::UnitVector, Input::UnitVector],
        tolerance: Tolerance {
            absolute: 8e-6,
            relative: 1e-6,
            slack: None,
            reason: "twice the adapter's atan2, which is good to 4e-6",
        },
        ..case("sheen_angle", &shaders::COMMON_MATH, ANGLE, &["angle"], |x| {
            vec![exact_angle(vector(x), vector(&x[3..]))]
        })
    }
}

/// A second direction that is as close as 1e-7.
fn small_angle() -> StressCase {
    StressCase {
        inputs: vec![Input::Real { least: 1e-6, greatest: 0.1 }],
        tolerance: Tolerance {
            absolute: 1e-9,
            relative: 1e-4,
            slack: None,
            reason: "small angles keep their digits: a chord of exact components, and atan2 near 0",
        },
        ..case(
            "sheen_angle [small]",
            &shaders::COMMON_MATH,
            "y[0] = sheen_angle(vec3f(0.0, 1.0, 0.0), vec3f(x[0], 1.0, 0.0));",
            &["angle"],
            |x| vec![exact_angle([0.0, 1.0, 0.0], [x[0], 1.0, 0.0])],
        )
    }
}

fn frame() -> StressCase {
    StressCase {
        inputs: vec![Input::UnitVector],
        tolerance: Tolerance {
            absolute: 1e-6,
            relative: 0.0,
            slack: None,
            reason: "1 + |z| is never below 1, so that nothing cancels: a few roundings",
        },
        ..case(
            "sheen_frame",
            &shaders::COMMON_MATH,
            "let f = sheen_frame(vec3f(x[0], x[1], x[2]));
             y[0] = f.x.x; y[1] = f.x.y; y[2] = f.x.z; y[3] = f.y.x; y[4] = f.y.y; y[5] = f.y.z;",
            &["x.x", "x.y", "x.z", "y.x", "y.y", "y.z"],
            |x| {
                let (a, b) = model::frame(vector(x));
                a.into_iter().chain(b).collect()
            },
        )
    }
}

/// The distance from the middle instead of u itself: at the seam u may be 0 or 1.
fn uv() -> StressCase {
    StressCase {
        inputs: vec![Input::UnitVector],
        tolerance: Tolerance {
            absolute: 2e-6,
            relative: 0.0,
            slack: None,
            reason: "two atan2 of the adapter over pi; a hundredth of a texel of a map of 4,096 rows",
        },
        ..case(
            "sheen_lat_long_uv",
            &shaders::COMMON_MATH,
            "let uv = sheen_lat_long_uv(vec3f(x[0], x[1], x[2])); y[0] = abs(uv.x - 0.5); y[1] = uv.y;",
            &["|u - 0.5|", "v"],
            |x| {
                let at_pole = x[0].abs() + x[2].abs() < 1e-18;
                // At the threshold itself either is right.
                let longitude = if at_pole { 0.0 } else { x[2].atan2(x[0]).abs() };
                vec![longitude / TAU, x[0].hypot(x[2]).atan2(x[1]) / PI]
            },
        )
    }
}

fn round_trip() -> StressCase {
    StressCase {
        inputs: vec![Input::UnitVector],
        tolerance: Tolerance {
            absolute: 1e-5,
            relative: 0.0,
            slack: None,
            reason: "two atan2 and two sines of the adapter, each good to 4e-6",
        },
        ..case(
            "sheen_lat_long_uv [and back]",
            &shaders::COMMON_MATH,
            "let d = sheen_lat_long_direction(sheen_lat_long_uv(vec3f(x[0], x[1], x[2])));
             y[0] = d.x; y[1] = d.y; y[2] = d.z;",
            &["x", "y", "z"],
            |x| x.to_vec(),
        )
    }
}

fn direction() -> StressCase {
    StressCase {
        inputs: vec![Input::Real { least: 0.0, greatest: 1.0 }, Input::Real { least: 0.0, greatest: 1.0 }],
        tolerance: Tolerance {
            absolute: 1.5e-6,
            relative: 0.0,
            slack: None,
            reason: "two sines of arguments up to pi, each rounded",
        },
        ..case(
            "sheen_lat_long_direction",
            &shaders::COMMON_MATH,
            "let d = sheen_lat_long_direction(vec2f(x[0], x[1])); y[0] = d.x; y[1] = d.y; y[2] = d.z;",
            &["x", "y", "z"],
            |x| {
                let (longitude, polar) = ((x[0] - 0.5) * TAU, x[1] * PI);
                vec![polar.sin() * longitude.cos(), polar.cos(), polar.sin() * longitude.sin()]
            },
        )
    }
}

fn cube() -> StressCase {
    let side = Input::Real { least: -1.0, greatest: 1.0 };
    StressCase {
        inputs: vec![Input::Integer { below: 6 }, side, side],
        tolerance: Tolerance {
            absolute: 0.0,
            relative: 0.0,
            slack: None,
            reason: "components are copied and negated",
        },
        ..case(
            "sheen_cube_direction",
            &shaders::COMMON_MATH,
            "let d = sheen_cube_direction(u[0], vec2f(x[1], x[2])); y[0] = d.x; y[1] = d.y; y[2] = d.z;",
            &["x", "y", "z"],
            |x| {
                let (a, b) = (x[1], x[2]);
                match x[0] as u32 {
                    0 => [1.0, -b, -a],
                    1 => [-1.0, -b, a],
                    2 => [a, 1.0, b],
                    3 => [a, -1.0, -b],
                    4 => [a, -b, 1.0],
                    _ => [-a, -b, -1.0],
                }
                .to_vec()
            },
        )
    }
}

