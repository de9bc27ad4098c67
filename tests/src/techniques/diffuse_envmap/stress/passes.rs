//! Functions of the compute passes that read no binding.

use super::case;
use crate::technique::{Exemption, Input, StressCase, Tolerance};
use diffuse_envmap::model;
use shaders::{DIFFUSE_ENVMAP_CHAIN as CHAIN, DIFFUSE_ENVMAP_HARMONICS as HARMONICS, DIFFUSE_ENVMAP_SOURCES as SOURCES};
use std::f64::consts::PI;

const COVERED: &str = "reads its pass's bindings: the tables and pictures of `compare` see what it builds on \
                       every map, and the hostile scenes what it makes of texels that are no radiance";

/// Functions that only a whole pass can run.
pub(in super::super) const EXEMPTIONS: &[Exemption] = &[
    Exemption { function: "extended_sources", reason: COVERED },
    Exemption { function: "finish", reason: COVERED },
    Exemption { function: "radiance_at", reason: COVERED },
    Exemption { function: "excess_of", reason: COVERED },
    Exemption { function: "source_power", reason: COVERED },
];

pub(super) fn cases() -> Vec<StressCase> {
    vec![
        lattice(),
        gather_of(),
        tap_of(),
        nearest_half(),
        basis(),
        luminance_of(),
        solid_angle(),
        direction_of(),
        block_of(),
        cell_of(),
    ]
}

fn within(absolute: f64, relative: f64, reason: &'static str) -> Tolerance {
    Tolerance { absolute, relative, slack: None, reason }
}

/// Ring and step of a point of the hexagonal lattice, walked side by side.
fn lattice_point(index: usize) -> [f64; 2] {
    let corner = |side: usize| {
        let angle = PI / 3.0 * side as f64;
        [angle.cos(), angle.sin()]
    };
    let mut points = vec![[0.0, 0.0]];
    for ring in 1..=3_usize {
        for side in 0..6 {
            let (from, to) = (corner(side), corner(side + 1));
            for step in 0..ring {
                let along = |c: usize| ring as f64 * from[c] + step as f64 * (to[c] - from[c]);
                points.push([along(0), along(1)]);
            }
        }
    }
    points[index]
}

fn lattice() -> StressCase {
    StressCase {
        inputs: vec![Input::Integer { below: 37 }],
        tolerance: within(2e-6, 0.0, "cosines of up to 4 pi, times 3"),
        ..case(
            "lattice",
            &CHAIN,
            "let p = lattice(u[0]); y[0] = p.x; y[1] = p.y;",
            &["x", "y"],
            |x| lattice_point(x[0] as usize).to_vec(),
        )
    }
}

/// Axis and spacing of a gather, as the chain's own construction says.
fn gather(face: u32, at: [f64; 2], size: f64, variance: f64) -> (model::Vec3, f64) {
    let direction = super::stage::cube_direction(face, at);
    let squared = model::dot(direction, direction);
    // A texel at this place subtends |d|^-3 of one at the middle: its width is the square root.
    let local = squared.powf(-0.75);
    let sigma = 2.0 / size * (variance - local * local / 6.0).sqrt();
    (direction.map(|c| c / squared.sqrt()), sigma / 1.2186_f64.sqrt())
}

fn gather_arguments(x: &[f64]) -> (u32, [f64; 2], f64) {
    let size = (x[0] + 2.0).exp2();
    let at = |c: f64| ((c % size) + 0.5) / size * 2.0 - 1.0;
    (x[1] as u32, [at(x[2]), at(x[3])], size)
}

/// The face's edge as a power of two, the face, the texel.
fn gather_inputs() -> Vec<Input> {
    let texel = Input::Integer { below: 1024 };
    vec![Input::Integer { below: 9 }, Input::Integer { below: 6 }, texel, texel]
}

fn gather_of() -> StressCase {
    StressCase {
        inputs: gather_inputs(),
        tolerance: within(3e-7, 1e-5, "an axis of three roundings, and a spacing of eight"),
        ..case(
            "gather_of",
            &CHAIN,
            "let size = 1u << (u[0] + 2u);
             let g = gather_of(vec3u(u[2] % size, u[3] % size, u[1]), f32(size), 0.75);
             y[0] = g.axis.x; y[1] = g.axis.y; y[2] = g.axis.z; y[3] = g.spacing;",
            &["axis.x", "axis.y", "axis.z", "spacing"],
            |x| {
                let (face, at, size) = gather_arguments(x);
                let (axis, spacing) = gather(face, at, size, 0.75);
                vec![axis[0], axis[1], axis[2], spacing]
            },
        )
    }
}

fn tap_of() -> StressCase {
    let mut inputs = gather_inputs();
    inputs.push(Input::Integer { below: 37 });
    StressCase {
        inputs,
        tolerance: within(3e-6, 0.0, "a sine and a cosine, and an exponential of an argument up to 3.4"),
        ..case(
            "tap_of",
            &CHAIN,
            "let size = 1u << (u[0] + 2u);
             let t = tap_of(gather_of(vec3u(u[2] % size, u[3] % size, u[1]), f32(size), 0.75), u[4]);
             y[0] = t.direction.x; y[1] = t.direction.y; y[2] = t.direction.z; y[3] = t.weight;",
            &["x", "y", "z", "weight"],
            |x| {
                let (face, at, size) = gather_arguments(x);
                let (axis, spacing) = gather(face, at, size, 0.75);
                let point = lattice_point(x[4] as usize);
                let radius = point[0].hypot(point[1]);
                let theta = radius * spacing;
                let direction = model::around(axis, theta, point[1].atan2(point[0]));
                let curved = if theta > 1e-3 { (theta.sin() / theta).sqrt() } else { 1.0 };
                let weight = curved * (-0.5 * (radius / 1.15).powi(2)).exp();
                vec![direction[0], direction[1], direction[2], weight]
            },
        )
    }
}

fn nearest_half() -> StressCase {
    StressCase {
        inputs: vec![Input::Real { least: 0.0, greatest: 1e6 }],
        // A half has eleven digits; the nearest is within half of the last, ties away from zero.
        tolerance: Tolerance {
            absolute: 0.0,
            relative: 0.0,
            slack: Some(|x| {
                // Below the normal halves the store itself rounds.
                if x[0] < 6.2e-5 { 0.5 * x[0] * f64::from(f32::EPSILON) * 8192.0 } else { 0.0 }
            }),
            reason: "rounding is exact for normal halves; smaller ones are rounded again by the store",
        },
        ..case(
            "nearest_half",
            &CHAIN,
            "y[0] = nearest_half(vec4f(x[0])).x;",
            &["half"],
            |x| {
                let value = x[0] as f32;
                let kept = f32::from_bits((value.to_bits() + 0x1000) & 0xffff_e000);
                let nearest = f64::from(kept).min(65504.0);
                // The same by arithmetic, where both are defined.
                let half = half::f16::from_f32(value.min(65504.0)).to_f64();
                let tie = (half - x[0]).abs() == (nearest - x[0]).abs();
                vec![if tie || !(6.2e-5..65504.0).contains(&x[0]) { nearest } else { half }]
            },
        )
    }
}

fn basis() -> StressCase {
    StressCase {
        inputs: vec![Input::UnitVector],
        tolerance: within(8e-6, 0.0, "polynomials of degree four with factors up to 35"),
        ..case(
            "basis",
            &HARMONICS,
            "let b = basis(vec3f(x[0], x[1], x[2]));
             y[0] = b[0]; y[1] = b[1]; y[2] = b[2]; y[3] = b[3]; y[4] = b[4]; y[5] = b[5];
             y[6] = b[6]; y[7] = b[7]; y[8] = b[8]; y[9] = b[9]; y[10] = b[10]; y[11] = b[11];
             y[12] = b[12]; y[13] = b[13]; y[14] = b[14]; y[15] = b[15]; y[16] = b[16]; y[17] = b[17];",
            &[
                "1", "y", "z", "x", "xy", "yz", "3zz-1", "xz", "xx-yy", "4,-4", "4,-3", "4,-2", "4,-1", "4,0",
                "4,1", "4,2", "4,3", "4,4",
            ],
            |v| {
                let [x, y, z] = [v[0], v[1], v[2]];
                let low = [1.0, y, z, x, x * y, y * z, 3.0 * z * z - 1.0, x * z, x * x - y * y];
                low.into_iter().chain(super::twin::band_4_basis([x, y, z])).collect()
            },
        )
    }
}

fn luminance_of() -> StressCase {
    let channel = Input::Real { least: 0.0, greatest: 1e9 };
    StressCase {
        inputs: vec![channel, channel, channel],
        tolerance: within(0.0, 3e-7, "three products and two sums of positive numbers"),
        ..case(
            "luminance_of",
            &SOURCES,
            "y[0] = luminance_of(vec3f(x[0], x[1], x[2]));",
            &["luminance"],
            |x| vec![0.2126 * x[0] + 0.7152 * x[1] + 0.0722 * x[2]],
        )
    }
}

/// Rows and columns of a map, and a texel of it.
fn texel_inputs() -> Vec<Input> {
    let side = Input::Integer { below: 8192 };
    vec![side, side, side, side]
}

/// Columns, rows, and a texel within.
fn texel_arguments(x: &[f64]) -> (f64, f64, f64, f64) {
    let (columns, rows) = (x[0] + 1.0, x[1] + 1.0);
    (columns, rows, x[2] % columns, x[3] % rows)
}

fn solid_angle() -> StressCase {
    StressCase {
        inputs: texel_inputs(),
        tolerance: within(0.0, 1e-5, "two sines of arguments up to half of pi"),
        ..case(
            "solid_angle",
            &SOURCES,
            "let size = vec2u(u[0] + 1u, u[1] + 1u); y[0] = solid_angle(u[3] % size.y, size);",
            &["steradians"],
            |x| {
                let (columns, rows, _, row) = texel_arguments(x);
                // cos a - cos b as a product, which loses no digits.
                let (middle, half) = (PI * (row + 0.5) / rows, 0.5 * PI / rows);
                vec![4.0 * PI / columns * middle.sin() * half.sin()]
            },
        )
    }
}

fn direction_of() -> StressCase {
    StressCase {
        inputs: texel_inputs(),
        tolerance: within(2e-6, 0.0, "two sines of arguments up to pi"),
        ..case(
            "direction_of",
            &SOURCES,
            "let size = vec2u(u[0] + 1u, u[1] + 1u);
             let d = direction_of(vec2u(u[2], u[3]) % size, size);
             y[0] = d.x; y[1] = d.y; y[2] = d.z;",
            &["x", "y", "z"],
            |x| {
                let (columns, rows, column, row) = texel_arguments(x);
                let map = model::Map { width: columns as usize, height: rows as usize, texels: Vec::new() };
                map.direction(column as usize, row as usize).to_vec()
            },
        )
    }
}

fn block_of() -> StressCase {
    StressCase {
        inputs: vec![
            Input::Integer { below: 8192 },
            Input::Integer { below: 8192 },
            Input::Integer { below: 128 },
            Input::Integer { below: 64 },
        ],
        tolerance: within(0.0, 0.0, "whole numbers"),
        ..case(
            "block_of",
            &SOURCES,
            "let b = block_of(vec2u(u[2], u[3]), vec2u(u[0] + 1u, u[1] + 1u));
             y[0] = f32(b.first.x); y[1] = f32(b.first.y); y[2] = f32(b.end.x); y[3] = f32(b.end.y);",
            &["first column", "first row", "end column", "end row"],
            |x| {
                let at = |cell: f64, side: f64, cells: f64| (cell * (side + 1.0) / cells).floor();
                vec![
                    at(x[2], x[0], 128.0),
                    at(x[3], x[1], 64.0),
                    at(x[2] + 1.0, x[0], 128.0),
                    at(x[3] + 1.0, x[1], 64.0),
                ]
            },
        )
    }
}

fn cell_of() -> StressCase {
    StressCase {
        inputs: texel_inputs(),
        tolerance: within(0.0, 0.0, "whole numbers: the cell whose block holds the texel"),
        ..case(
            "cell_of",
            &SOURCES,
            "let size = vec2u(u[0] + 1u, u[1] + 1u); y[0] = f32(cell_of(vec2u(u[2], u[3]) % size, size));",
            &["cell"],
            |x| {
                let (columns, rows, column, row) = texel_arguments(x);
                // By search: the last cell whose first texel is not beyond.
                let holds = |texel: f64, side: f64, cells: u32| {
                    let first = |cell: u32| (f64::from(cell) * side / f64::from(cells)).floor();
                    let guess = (texel * f64::from(cells) / side) as u32;
                    (guess.saturating_sub(2)..(guess + 3 + cells / side as u32).min(cells))
                        .rfind(|&cell| first(cell) <= texel)
                        .unwrap_or(0)
                };
                vec![f64::from(holds(row, rows, 64) * 128 + holds(column, columns, 128))]
            },
        )
    }
}
