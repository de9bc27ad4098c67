//! FLIP against the numbers of the published evaluator.
//!
//! The expected numbers are those of `flip_evaluator.evaluate` of the package
//! `flip-evaluator` 1.7 from the Python package index, whose error maps were averaged in 64 bits; `tests/data/README.md` tells
//! how they were made. The images are made by the formulas below, by the same arithmetic in 64
//! bits.

mod support;

use image_error::{Image, flip};
use support::{image, noise, values};

type Formula = fn(u32, u32, u32) -> f64;

/// How far any error may lie from the published one. Most are within 2e-6; on plain surfaces the
/// rounding of the published evaluator shows up to 3e-5, which arithmetic in 64 bits does not confirm.
const TOLERANCE: f64 = 4e-5;

/// How far a derived exposure may lie from the published one, in stops: the luminance there has
/// coefficients of four digits.
const STOP_TOLERANCE: f32 = 1e-4;

struct Ldr {
    name: &'static str,
    size: [u32; 2],
    reference: Formula,
    found: Formula,
    pixels_per_degree: f32,
    is_encoded: bool,
    mean: f64,
    at: [f64; 4],
}

struct Hdr {
    name: &'static str,
    size: [u32; 2],
    reference: Formula,
    found: Formula,
    tone_mapper: flip::ToneMapper,
    /// Given instead of derived.
    given: bool,
    exposures: flip::Exposures,
    mean: f64,
    at: [f64; 4],
}

fn checkerboard(x: u32, y: u32, _: u32) -> f64 {
    f64::from((x / 5 + y / 5) % 2)
}

fn shifted_checkerboard(x: u32, y: u32, channel: u32) -> f64 {
    checkerboard(x + 1, y, channel)
}

fn sun(x: u32, y: u32, channel: u32) -> f64 {
    sky(f64::from(x) - 56.0, f64::from(y), channel)
}

fn shifted_sun(x: u32, y: u32, channel: u32) -> f64 {
    sky(f64::from(x) - 58.0, f64::from(y), channel)
}

fn sky(x: f64, y: f64, channel: u32) -> f64 {
    let is_sun = x * x + (y - 18.0).powi(2) <= 16.0;
    if is_sun { 1e4 } else { [0.3, 0.5, 0.9][channel as usize] * (1.0 - y / 80.0) }
}

fn speckle(x: u32, y: u32, channel: u32) -> f64 {
    1.0 / (0.02 + noise(x, y, channel, 9))
}

fn noisy_speckle(x: u32, y: u32, channel: u32) -> f64 {
    speckle(x, y, channel) * (0.8 + 0.4 * noise(x, y, channel, 10))
}

fn lamp(x: u32, y: u32, radiance: f64) -> f64 {
    if (10..20).contains(&x) && (5..15).contains(&y) { radiance } else { 0.0 }
}

fn stairs(x: u32, colour: [f64; 3], channel: u32) -> f64 {
    f64::from(1 << (x / 8)) * colour[channel as usize]
}

const USUAL_LDR: Ldr = Ldr {
    name: "",
    size: [1, 1],
    reference: |_, _, _| 0.0,
    found: |_, _, _| 0.0,
    pixels_per_degree: 67.0,
    is_encoded: false,
    mean: 0.0,
    at: [0.0; 4],
};
const BOARD: Ldr = Ldr { size: [40, 56], reference: checkerboard, found: shifted_checkerboard, ..USUAL_LDR };
const LDR_PAIRS: [Ldr; 13] = [
    Ldr {
        name: "noisy ramp",
        size: [64, 48],
        reference: |x, _, _| f64::from(x) / 63.0,
        found: |x, y, c| (f64::from(x) / 63.0 + 0.2 * (noise(x, y, c, 1) - 0.5)).clamp(0.0, 1.0),
        mean: 0.1219865,
        at: [0.673360, 0.067213, 0.102211, 0.096995],
        ..USUAL_LDR
    },
    Ldr { name: "checkerboard", mean: 0.3626939, at: [0.057998, 0.426229, 0.733559, 0.259518], ..BOARD },
    Ldr {
        name: "checkerboard, 30 pixels per degree",
        pixels_per_degree: 30.0,
        mean: 0.3997777,
        at: [0.0, 0.321695, 0.981413, 0.341265],
        ..BOARD
    },
    Ldr {
        name: "checkerboard, 200 pixels per degree",
        pixels_per_degree: 200.0,
        mean: 0.0519037,
        at: [0.254771, 0.034752, 0.318576, 0.027043],
        ..BOARD
    },
    Ldr {
        name: "offset",
        size: [33, 17],
        reference: |_, _, _| 0.5,
        found: |_, _, _| 0.53125,
        mean: 0.0895203,
        at: [0.089520; 4],
        ..USUAL_LDR
    },
    Ldr {
        name: "hue",
        size: [48, 32],
        reference: |x, y, c| [0.6 * f64::from(x) / 47.0, 0.3, 0.5 * f64::from(y) / 31.0][c as usize],
        found: |x, y, c| [0.3, 0.6 * f64::from(x) / 47.0, 0.5 * f64::from(y) / 31.0][c as usize],
        mean: 0.6101478,
        at: [0.961871, 0.102325, 0.846011, 0.554296],
        ..USUAL_LDR
    },
    Ldr {
        name: "thin lines",
        size: [50, 50],
        reference: |_, _, _| 0.8,
        found: |x, y, _| if (x + 2 * y) % 11 == 0 { 0.0 } else { 0.8 },
        mean: 0.1599369,
        at: [0.780238, 0.178202, 0.167112, 0.085630],
        ..USUAL_LDR
    },
    Ldr {
        name: "column of noise",
        size: [1, 61],
        reference: |x, y, c| noise(x, y, c, 2),
        found: |x, y, c| noise(x, y, c, 3),
        mean: 0.6475365,
        at: [0.606039, 0.884648, 0.861464, 0.833915],
        ..USUAL_LDR
    },
    Ldr {
        name: "row of noise",
        size: [73, 1],
        reference: |x, y, c| noise(x, y, c, 4),
        found: |x, y, c| 0.9 * noise(x, y, c, 4),
        mean: 0.1786739,
        at: [0.230659, 0.155308, 0.210894, 0.184759],
        ..USUAL_LDR
    },
    Ldr {
        name: "one pixel",
        reference: |_, _, c| [0.2, 0.4, 0.6][c as usize],
        found: |_, _, c| [0.3, 0.3, 0.9][c as usize],
        mean: 0.5821072,
        at: [0.582107; 4],
        ..USUAL_LDR
    },
    Ldr {
        name: "dark noise",
        size: [64, 64],
        reference: |x, y, c| 0.02 * noise(x, y, c, 5),
        found: |x, y, c| 0.02 * noise(x, y, c, 6),
        mean: 0.0757020,
        at: [0.120014, 0.037261, 0.211171, 0.109552],
        ..USUAL_LDR
    },
    Ldr {
        name: "more than a tile",
        size: [300, 140],
        reference: |x, y, _| f64::from(x * y % 97) / 96.0,
        found: |x, y, c| (f64::from(x * y % 97) / 96.0 + 0.5 * (noise(x, y, c, 11) - 0.5)).clamp(0.0, 1.0),
        mean: 0.1889546,
        at: [0.738106, 0.109312, 0.307558, 0.289873],
        ..USUAL_LDR
    },
    Ldr {
        name: "noise encoded as sRGB",
        size: [45, 30],
        reference: |x, y, c| noise(x, y, c, 7),
        found: |x, y, c| noise(x, y, c, 8),
        is_encoded: true,
        mean: 0.4680938,
        at: [0.851427, 0.587949, 0.599766, 0.405178],
        ..USUAL_LDR
    },
];

const fn exposures(start: f32, stop: f32, count: u32) -> flip::Exposures {
    flip::Exposures { start, stop, count }
}

const USUAL_HDR: Hdr = Hdr {
    name: "",
    size: [80, 60],
    reference: sun,
    found: shifted_sun,
    tone_mapper: flip::ToneMapper::Aces,
    given: false,
    exposures: exposures(0.0, 0.0, 2),
    mean: 0.0,
    at: [0.0; 4],
};
const SPECKLED: Hdr = Hdr { size: [33, 17], reference: speckle, found: noisy_speckle, ..USUAL_HDR };
const HDR_PAIRS: [Hdr; 9] = [
    Hdr {
        name: "sun",
        exposures: exposures(-12.204415, 2.772703, 15),
        mean: 0.0241926,
        at: [0.0, 0.0, 0.0, 0.483806],
        ..USUAL_HDR
    },
    Hdr {
        name: "sun, Reinhard",
        tone_mapper: flip::ToneMapper::Reinhard,
        exposures: exposures(-10.785212, 4.191907, 15),
        mean: 0.0241614,
        at: [0.0, 0.0, 0.0, 0.481021],
        ..USUAL_HDR
    },
    Hdr {
        name: "sun, Hable",
        tone_mapper: flip::ToneMapper::Hable,
        exposures: exposures(-11.642588, 3.334531, 15),
        mean: 0.0238746,
        at: [0.0, 0.0, 0.0, 0.483780],
        ..USUAL_HDR
    },
    Hdr {
        name: "speckle",
        exposures: exposures(-3.988663, -0.293596, 4),
        mean: 0.0868423,
        at: [0.194145, 0.069288, 0.135496, 0.121145],
        ..SPECKLED
    },
    Hdr {
        name: "speckle, exposures given",
        given: true,
        exposures: exposures(-4.0, 3.0, 5),
        mean: 0.0856849,
        at: [0.188882, 0.069406, 0.136225, 0.113864],
        ..SPECKLED
    },
    Hdr {
        name: "lamp in the dark",
        size: [30, 40],
        reference: |x, y, _| lamp(x, y, 5.0),
        found: |x, y, _| lamp(x, y, 4.0),
        exposures: exposures(-1.238631, 24.083298, 26),
        mean: 0.0183507,
        at: [0.0, 0.0, 0.0, 0.076088],
        ..USUAL_HDR
    },
    Hdr {
        name: "stairs",
        size: [64, 20],
        reference: |x, _, c| stairs(x, [1.0, 0.5, 0.25], c),
        found: |x, _, c| stairs(x, [1.0, 0.625, 0.25], c),
        exposures: exposures(-5.151204, -2.151204, 3),
        mean: 0.3015152,
        at: [0.240248, 0.323249, 0.166776, 0.335273],
        ..USUAL_HDR
    },
    Hdr {
        name: "more than a tile",
        size: [270, 70],
        reference: |x, y, c| 0.1 + 8.0 * noise(x, y, c, 12),
        found: |x, y, c| (0.1 + 8.0 * noise(x, y, c, 12)) * (0.5 + noise(x, y, c, 13)),
        exposures: exposures(-1.924081, -0.956293, 2),
        mean: 0.1376762,
        at: [0.255019, 0.203910, 0.378386, 0.074111],
        ..USUAL_HDR
    },
    Hdr {
        name: "constant",
        size: [9, 7],
        reference: |_, _, _| 100.0,
        found: |_, _, _| 110.0,
        exposures: exposures(-5.560559, -5.560559, 2),
        mean: 0.0440071,
        at: [0.044007; 4],
        ..USUAL_HDR
    },
];

#[test]
fn ldr_flip_is_that_of_the_published_evaluator() {
    let worst = LDR_PAIRS.iter().map(|pair| {
        let [width, height] = pair.size.map(|size| size as usize);
        let make = |formula: Formula| {
            let values = values(pair.size, formula);
            if pair.is_encoded {
                Image::from_srgb(width, height, &values)
            } else {
                Image::new(width, height, values)
            }
        };
        let (found, reference) = (make(pair.found).unwrap(), make(pair.reference).unwrap());
        let map = flip::ldr(&found, &reference, pair.pixels_per_degree).unwrap();
        distance(pair.name, &map, pair.mean, pair.at)
    });
    assert_close(worst.collect());
}

#[test]
fn hdr_flip_is_that_of_the_published_evaluator() {
    let worst = HDR_PAIRS.iter().map(|pair| {
        let (found, reference) = (image(pair.size, pair.found), image(pair.size, pair.reference));
        let given = pair.given.then_some(pair.exposures);
        let hdr = flip::hdr_with(&found, &reference, 67.0, pair.tone_mapper, given).unwrap();
        for (found, expected) in
            [(hdr.exposures.start, pair.exposures.start), (hdr.exposures.stop, pair.exposures.stop)]
        {
            assert!(
                (found - expected).abs() < STOP_TOLERANCE,
                "{}: {found} stops instead of {expected}",
                pair.name
            );
        }
        distance(pair.name, &hdr.map, pair.mean, pair.at)
    });
    assert_close(worst.collect());
}

/// The command line of the same package, on PNG files: bytes are the values times 255, cut off.
#[test]
fn statistics_are_those_that_the_published_tool_prints() {
    let bytes = |seed| {
        let values = values([45, 30], |x, y, c| (noise(x, y, c, seed) * 255.0).floor());
        let encoded: Vec<_> = values.iter().map(|pixel| pixel.map(|byte| byte / 255.0)).collect();
        Image::from_srgb(45, 30, &encoded).unwrap()
    };
    let found = flip::ldr(&bytes(8), &bytes(7), 67.0).unwrap().statistics();
    let printed = [
        (found.mean as f32, 0.467335),
        (found.weighted_median, 0.501213),
        (found.weighted_quartile_1, 0.404042),
        (found.weighted_quartile_3, 0.615859),
        (found.min, 0.105569),
        (found.max, 0.947671),
    ];
    for (found, printed) in printed {
        assert!((found - printed).abs() < 5e-6, "{found} instead of {printed}");
    }
}

/// The largest distance of the mean, and of four pixels, from the published numbers; printed too.
fn distance(name: &str, map: &flip::ErrorMap, mean: f64, at: [f64; 4]) -> f64 {
    let (width, height) = (map.width(), map.height());
    let places = [(0, 0), (width / 2, height / 2), (width - 1, height - 1), (width * 7 / 10, height / 4)];
    let found = places.map(|(x, y)| f64::from(map.values()[y * width + x]));
    let pixels = found.iter().zip(at).map(|(found, at)| (found - at).abs()).fold(0.0, f64::max);
    println!("| {name} | {mean:.7} | {:.7} | {pixels:.6} |", map.mean());
    pixels.max((map.mean() - mean).abs())
}

fn assert_close(distances: Vec<f64>) {
    let worst = distances.into_iter().fold(0.0, f64::max);
    assert!(worst < TOLERANCE, "{worst} from the published numbers");
}
