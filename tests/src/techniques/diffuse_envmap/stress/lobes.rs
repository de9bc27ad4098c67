//! The library's functions of numbers alone.

use super::{
    case,
    math::{ANY, vector},
    twin,
};
use crate::technique::{Input, StressCase, Tolerance};
use diffuse_envmap::{Base, model};
use shaders::DIFFUSE_ENVMAP_LIBRARY as LIBRARY;
use std::f64::consts::{FRAC_PI_2, PI};

/// The roughness of a lobe.
const LOBE: Input = Input::Real { least: 1e-4, greatest: 1.0 };

pub(super) fn cases() -> Vec<StressCase> {
    vec![
        mirror(),
        roughness(),
        base(),
        density(),
        around(),
        parallax(),
        to_environment(),
        pixel_random(),
        lift(),
        above(),
        convolved_density(),
        finest_level(),
        extended_share(),
        specular_reflectance(),
    ]
}

fn within(absolute: f64, relative: f64, reason: &'static str) -> Tolerance {
    Tolerance { absolute, relative, slack: None, reason }
}

fn mirror() -> StressCase {
    StressCase {
        inputs: vec![Input::UnitVector, Input::UnitVector],
        tolerance: within(6e-7, 0.0, "a dot product and two products of numbers up to 2"),
        ..case(
            "diffuse_envmap_mirror",
            &LIBRARY,
            "let r = diffuse_envmap_mirror(vec3f(x[0], x[1], x[2]), vec3f(x[3], x[4], x[5]));
             y[0] = r.x; y[1] = r.y; y[2] = r.z;",
            &["x", "y", "z"],
            |x| model::mirror(vector(x), vector(&x[3..])).to_vec(),
        )
    }
}

fn roughness() -> StressCase {
    StressCase {
        inputs: vec![ANY],
        tolerance: within(0.0, 0.0, "a clamp rounds nothing; what is not a number counts as 1"),
        ..case(
            "diffuse_envmap_roughness",
            &LIBRARY,
            "y[0] = diffuse_envmap_roughness(x[0]);",
            &["t"],
            |x| vec![if x[0].is_nan() { 1.0 } else { x[0].clamp(0.0, 1.0) }],
        )
    }
}

fn base() -> StressCase {
    let model = |x: &[f64]| {
        let mode = if x[7] == 0.0 { Base::Lerp } else { Base::Slerp };
        let axis = model::base(vector(x), vector(&x[3..]), x[6], mode);
        // A mirror direction is passed on as it is.
        if x[6] == 0.0 { x[..3].to_vec() } else { axis.to_vec() }
    };
    StressCase {
        inputs: vec![
            Input::UnitVector,
            Input::UnitVector,
            Input::Real { least: 0.0, greatest: 1.0 },
            Input::Integer { below: 2 },
        ],
        tolerance: Tolerance {
            absolute: 1e-6,
            relative: 0.0,
            // Where the two directions cancel, rounding of either decides what is left.
            slack: Some(|x| {
                let (mirror, normal, t) = (vector(x), vector(&x[3..]), x[6]);
                let linear = model::add_scaled(mirror.map(|c| c * (1.0 - t)), normal, t);
                let left = model::dot(linear, linear).sqrt();
                let across = model::dot(mirror, normal).clamp(-1.0, 1.0).acos();
                // Near opposite directions the slerp's sum of sines cancels, and from a
                // thousandth on it is the lerp.
                let opposite = PI - across;
                if x[7] == 0.0 {
                    4e-7 / left.max(1e-9)
                } else if (0.9e-3..1.1e-3).contains(&opposite) {
                    3.0
                } else if opposite < 1e-3 {
                    4e-7 / left.max(1e-9)
                } else {
                    4e-6 / across.sin().max(1e-9)
                }
            }),
            reason: "a weighted sum and a normalisation; two sines for the slerp",
        },
        ..case(
            "diffuse_envmap_base",
            &LIBRARY,
            "let b = diffuse_envmap_base(vec3f(x[0], x[1], x[2]), vec3f(x[3], x[4], x[5]), x[6], u[7]);
             y[0] = b.x; y[1] = b.y; y[2] = b.z;",
            &["x", "y", "z"],
            model,
        )
    }
}

fn density() -> StressCase {
    StressCase {
        inputs: vec![LOBE, Input::Real { least: 0.0, greatest: 1.7 }],
        tolerance: Tolerance {
            absolute: 0.0,
            relative: 2e-5,
            slack: Some(|x| 2e-6 / (PI * x[0] * x[0])),
            reason: "relative to the peak 1 / (pi t^2): near the rim the sine loses what the angle lost; a \
                     part in 1e5 is what the flat top within a thousandth of the axis costs",
        },
        ..case(
            "diffuse_envmap_density",
            &LIBRARY,
            "y[0] = diffuse_envmap_density(x[0], x[0] * x[1]);",
            &["per steradian"],
            |x| vec![model::density(x[0], x[0] * x[1])],
        )
    }
}

fn around() -> StressCase {
    StressCase {
        inputs: vec![
            Input::UnitVector,
            Input::Real { least: 0.0, greatest: PI as f32 },
            Input::Real { least: 0.0, greatest: 6.283_185 },
        ],
        tolerance: within(2e-6, 0.0, "sines and cosines of numbers up to 2 pi, and a frame"),
        ..case(
            "diffuse_envmap_around",
            &LIBRARY,
            "let axis = vec3f(x[0], x[1], x[2]);
             let d = diffuse_envmap_around(axis, sheen_frame(axis), x[3], x[4]);
             y[0] = d.x; y[1] = d.y; y[2] = d.z;",
            &["x", "y", "z"],
            |x| model::around(vector(x), x[3], x[4]).to_vec(),
        )
    }
}

fn parallax() -> StressCase {
    let metres = Input::Real { least: -3.0, greatest: 3.0 };
    StressCase {
        inputs: vec![Input::UnitVector, metres, metres, metres],
        tolerance: within(4e-6, 0.0, "a division, and a hit that is at least half a metre from the centre"),
        ..case(
            "diffuse_envmap_parallax",
            &LIBRARY,
            "var p: DiffuseEnvmapParameters;
             p.box_min_world = vec4f(-2.0, -1.0, -1.5, 0.0);
             p.box_max_world = vec4f(1.0, 2.0, 2.5, 0.0);
             p.box_centre_world = vec4f(0.25, 0.5, -0.5, 0.0);
             let d = diffuse_envmap_parallax(vec3f(x[0], x[1], x[2]), vec3f(x[3], x[4], x[5]), p);
             y[0] = d.x; y[1] = d.y; y[2] = d.z;",
            &["x", "y", "z"],
            |x| {
                let (least, greatest) = ([-2.0, -1.0, -1.5], [1.0, 2.0, 2.5]);
                twin::parallax(vector(x), vector(&x[3..]), least, greatest, [0.25, 0.5, -0.5]).to_vec()
            },
        )
    }
}

fn to_environment() -> StressCase {
    let side = Input::Real { least: -1.0, greatest: 1.0 };
    StressCase {
        inputs: vec![Input::UnitVector, side, side],
        tolerance: within(2e-7, 0.0, "two products and a sum of numbers up to 1"),
        ..case(
            "diffuse_envmap_to_environment",
            &LIBRARY,
            "var p: DiffuseEnvmapParameters;
             p.rotation_cosine = x[3];
             p.rotation_sine = x[4];
             let d = diffuse_envmap_to_environment(vec3f(x[0], x[1], x[2]), p);
             y[0] = d.x; y[1] = d.y; y[2] = d.z;",
            &["x", "y", "z"],
            |x| {
                let (cosine, sine) = (x[3], x[4]);
                vec![cosine * x[0] - sine * x[2], x[1], sine * x[0] + cosine * x[2]]
            },
        )
    }
}

fn pixel_random() -> StressCase {
    let pixel = Input::Integer { below: 16384 };
    StressCase {
        inputs: vec![pixel, pixel],
        tolerance: within(0.0, 0.0, "whole numbers, and 24 bits that a float holds"),
        ..case(
            "diffuse_envmap_pixel_random",
            &LIBRARY,
            "y[0] = diffuse_envmap_pixel_random(vec2u(u[0], u[1]));",
            &["number"],
            |x| vec![twin::pixel_random(x[0] as u32, x[1] as u32)],
        )
    }
}

fn lift() -> StressCase {
    StressCase {
        inputs: vec![Input::UnitVector, Input::UnitVector],
        tolerance: Tolerance {
            absolute: 5e-6,
            relative: 0.0,
            // Beside the zenith a dot product of rounding e hides an angle of sqrt(2 e).
            slack: Some(|x| {
                let across = model::dot(vector(x), vector(&x[3..])).clamp(-1.0, 1.0);
                3e-7 / (1.0 - across * across).max(3e-7).sqrt()
            }),
            reason: "a dot product's rounding over the cosine of the angle",
        },
        ..case(
            "diffuse_envmap_lift",
            &LIBRARY,
            "y[0] = diffuse_envmap_lift(vec3f(x[0], x[1], x[2]), vec3f(x[3], x[4], x[5]));",
            &["angle"],
            |x| vec![model::dot(vector(x), vector(&x[3..])).clamp(-1.0, 1.0).asin()],
        )
    }
}

fn above() -> StressCase {
    StressCase {
        inputs: vec![
            Input::Real { least: 0.0, greatest: 1.0 },
            Input::Real { least: -FRAC_PI_2 as f32, greatest: FRAC_PI_2 as f32 },
        ],
        tolerance: within(1.5e-6, 0.0, "a logistic curve that is stretched by a thirtieth, and its end given to five digits"),
        ..case(
            "diffuse_envmap_above",
            &LIBRARY,
            "y[0] = diffuse_envmap_above(x[0], x[1]);",
            &["part"],
            |x| vec![twin::above(x[0], x[1])],
        )
    }
}

fn convolved_density() -> StressCase {
    StressCase {
        inputs: vec![
            LOBE,
            Input::Real { least: 1e-5, greatest: 0.2 },
            Input::Real { least: 0.0, greatest: PI as f32 },
        ],
        tolerance: Tolerance {
            absolute: 0.0,
            relative: 4e-5,
            slack: Some(|x| 8e-6 / (PI * x[0] * x[0])),
            reason: "three densities, relative to the peak 1 / (pi t^2)",
        },
        ..case(
            "diffuse_envmap_convolved_density",
            &LIBRARY,
            "y[0] = diffuse_envmap_convolved_density(x[0], x[1], x[2]);",
            &["per steradian"],
            |x| vec![twin::convolved_density(x[0], x[1], x[2])],
        )
    }
}

fn finest_level() -> StressCase {
    StressCase {
        inputs: vec![Input::Integer { below: 16384 }],
        tolerance: within(2e-6, 0.0, "a logarithm of a whole number up to 16,384"),
        ..case(
            "diffuse_envmap_finest_level",
            &LIBRARY,
            "var p: DiffuseEnvmapParameters;
             p.face_size = u[0] + 1u;
             y[0] = diffuse_envmap_finest_level(p);",
            &["level"],
            |x| vec![1.0 - (x[0] + 1.0).log2()],
        )
    }
}

fn extended_share() -> StressCase {
    StressCase {
        inputs: vec![Input::Integer { below: 2048 }, Input::Real { least: -20.0, greatest: 10.0 }],
        tolerance: within(2e-6, 0.0, "a logarithm of a whole number up to 2,048"),
        ..case(
            "diffuse_envmap_extended_share",
            &LIBRARY,
            "var p: DiffuseEnvmapParameters;
             p.face_size = u[0] + 1u;
             y[0] = diffuse_envmap_extended_share(p, x[1]);",
            &["share"],
            |x| vec![twin::extended_share(x[0] + 1.0, x[1])],
        )
    }
}

fn specular_reflectance() -> StressCase {
    let part = Input::Real { least: 0.0, greatest: 1.0 };
    StressCase {
        inputs: vec![part, part, part, part, part],
        tolerance: within(1e-6, 0.0, "an exponential of an argument up to 9.28 and ten roundings below 2"),
        ..case(
            "diffuse_envmap_specular_reflectance",
            &LIBRARY,
            "let f = diffuse_envmap_specular_reflectance(vec3f(x[0], x[1], x[2]), x[3], x[4]);
             y[0] = f.x; y[1] = f.y; y[2] = f.z;",
            &["red", "green", "blue"],
            |x| {
                let greatest = x[0].max(x[1]).max(x[2]);
                (0..3).map(|c| twin::specular_reflectance(x[c], greatest, x[3], x[4])).collect()
            },
        )
    }
}
