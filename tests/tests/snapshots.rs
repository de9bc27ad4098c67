//! Small pictures of the built-in scene and of scene files against ones that were looked at and
//! kept in `references/`.
//!
//! These catch what no reference integral covers: loading, placing, materials, lights and tone
//! mapping together. They say that a picture changed, not that it is right. Where a change is
//! meant, render the references again, look at them, and commit them:
//!
//! ```text
//! SHEEN_BLESS=1 cargo test --release -p validation --test snapshots
//! ```

use compositor::{Settings, headless, tone_map};
use image::RgbImage;
use scene::{Limits, Scene, builtin, load};
use std::path::PathBuf;
use validation::gpu;

const SIZE: [u32; 2] = [64, 48];

/// The most that two adapters may differ: the mean absolute difference of 8-bit values, and the
/// share of pixels with a channel that is off by more than 8 (edges fall on other pixels).
const MEAN_LIMIT: f64 = 1.0;
const OFF_SHARE_LIMIT: f64 = 0.005;

fn at_root(file: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..").join(file)
}

fn rendered(scene: &Scene) -> RgbImage {
    let settings = Settings::default();
    let camera = scene.camera.expect("the scene has a camera");
    let picture = headless::render(&gpu(), scene, &camera, SIZE, &settings).expect("the scene renders");
    let (pixels, _) = picture.rgba.as_chunks::<4>();
    let bytes = pixels.iter().flat_map(|&[r, g, b, _]| {
        tone_map::display_srgb8([r, g, b], settings.exposure_ev, settings.tone_curve)
    });
    RgbImage::from_raw(SIZE[0], SIZE[1], bytes.collect()).expect("three bytes a pixel")
}

/// Mean absolute difference, and the share of pixels that are off by more than 8.
fn difference(a: &RgbImage, b: &RgbImage) -> (f64, f64) {
    let apart = |(a, b): (&image::Rgb<u8>, &image::Rgb<u8>)| [0, 1, 2].map(|c| a.0[c].abs_diff(b.0[c]));
    let differences: Vec<[u8; 3]> = a.pixels().zip(b.pixels()).map(apart).collect();
    let sum: f64 = differences.iter().flatten().map(|&value| f64::from(value)).sum();
    let off = differences.iter().filter(|channels| channels.iter().any(|&value| value > 8)).count();
    (sum / (3.0 * differences.len() as f64), off as f64 / differences.len() as f64)
}

fn check(name: &str, scene: &Scene) {
    let path = at_root("tests/references").join(name).with_extension("png");
    let found = rendered(scene);
    if std::env::var_os("SHEEN_BLESS").is_some_and(|value| value == "1") {
        found.save(&path).expect("the reference can be written");
        return;
    }
    let reference =
        image::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).to_rgb8();
    assert_eq!(reference.dimensions(), found.dimensions(), "{name}");
    let (mean, off) = difference(&found, &reference);
    println!("{name}: off by {mean:.3} in the mean, {:.2} % of the pixels by more than 8", 100.0 * off);
    if mean >= MEAN_LIMIT || off >= OFF_SHARE_LIMIT {
        let kept = std::env::temp_dir().join(format!("sheen-{name}.png"));
        found.save(&kept).expect("the picture can be kept");
        panic!(
            "{name} differs from {}: mean {mean:.2}, off {off:.4}; see {}",
            path.display(),
            kept.display()
        );
    }
}

fn check_file(name: &str) {
    let path = at_root("assets/scenes").join(name).with_extension("toml");
    let scene = load::load_scene(&path, &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
    check(name, &scene);
}

#[test]
fn the_built_in_scene() {
    check("showroom", &builtin::scene());
}

#[test]
fn teapots_in_the_sun() {
    check_file("teapot_in_the_sun");
}

#[test]
fn a_mirror_floor() {
    check_file("mirror_floor");
}
