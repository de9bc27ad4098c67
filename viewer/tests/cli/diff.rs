//! `sheen diff`.

use crate::common::{Folder, Ran};
use crate::reference::{folder, reference};

fn diff(folder: &Folder, more: &[&str]) -> Ran {
    folder.run(&[&["diff"], more].concat())
}

/// Writes an EXR of 24 x 16 pixels.
fn picture(folder: &Folder, name: &str, pixel: impl Fn(usize, usize) -> f32 + Sync) {
    let rgb = |x: usize, y: usize| (pixel(x, y), pixel(x, y), pixel(x, y));
    exr::prelude::write_rgb_file(folder.path().join(name), 24, 16, rgb).unwrap();
}

fn ramp(x: usize, y: usize) -> f32 {
    0.1 + x as f32 / 24.0 + y as f32 / 160.0
}

/// The first number behind a metric's name.
#[track_caller]
fn number(ran: &Ran, metric: &str) -> f64 {
    let out = ran.out();
    let line =
        out.lines().find(|line| line.trim_start().starts_with(metric)).unwrap_or_else(|| panic!("{out}"));
    let word = line.split_whitespace().nth(1).unwrap();
    word.trim_end_matches(',').parse().unwrap_or_else(|_| panic!("{line}"))
}

#[test]
fn all_metrics_of_linear_pictures() {
    let folder = Folder::new();
    picture(&folder, "a.exr", |x, y| 1.25 * ramp(x, y));
    picture(&folder, "b.exr", ramp);
    let ran = diff(&folder, &["a.exr", "b.exr"]);
    ran.expect(0, &["a.exr against b.exr: 24 x 16 pixels", "+25.0000 % of the reference"]);
    let pixels: Vec<f64> = (0..16).flat_map(|y| (0..24).map(move |x| f64::from(ramp(x, y)))).collect();
    let mean = pixels.iter().sum::<f64>() / 384.0;
    let eps = 0.01 * pixels.iter().map(|y| y * y).sum::<f64>() / 384.0;
    let relmse = pixels.iter().map(|y| (0.25 * y).powi(2) / (y * y + eps)).sum::<f64>() / 384.0;
    let close =
        |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    close(number(&ran, "relmse"), relmse);
    close(number(&ran, "mae"), 0.25 * mean);
    close(number(&ran, "bias"), 0.25 * mean);
    let (flip, hdr_flip) = (number(&ran, "flip"), number(&ran, "hdr-flip"));
    assert!((0.01..0.5).contains(&flip) && (0.01..0.5).contains(&hdr_flip), "{flip} {hdr_flip}");
    assert!(!ran.out().contains("non-finite") && ran.err().is_empty(), "{}", ran.err());

    let same = diff(&folder, &["b.exr", "b.exr"]);
    for metric in ["relmse", "mae", "bias", "flip", "hdr-flip"] {
        assert_eq!(number(&same, metric), 0.0);
    }
    let dark = diff(&folder, &["b.exr", "a.exr", "--metric", "bias"]);
    assert_eq!(dark.out().lines().count(), 2);
    close(number(&dark, "bias"), -0.25 * mean);
    picture(&folder, "black.exr", |_, _| 0.0);
    diff(&folder, &["a.exr", "black.exr"])
        .expect(0, &["relmse     inf", "hdr-flip   none: the reference is black"]);
}

#[test]
fn pngs_are_decoded_and_know_no_exposures() {
    let folder = Folder::new();
    let grey = |name: &str, value: u8| {
        image::RgbaImage::from_pixel(9, 5, image::Rgba([value, value, value, 7]))
            .save(folder.path().join(name))
            .unwrap();
    };
    grey("a.png", 188);
    grey("b.png", 128);
    let ran = diff(&folder, &["a.png", "b.png"]);
    // IEC 61966-2-1 by hand: 188 is 0.50289 and 128 is 0.21586.
    ran.expect(0, &["bias       +2.8703e-1", "flip"]);
    assert!(!ran.out().contains("hdr-flip"));
    diff(&folder, &["a.png", "b.png", "--metric", "hdr-flip"]).expect(2, &["needs linear pictures"]);
    picture(&folder, "c.exr", ramp);
    diff(&folder, &["a.png", "c.exr"])
        .expect(1, &["a.png: values: found 8-bit sRGB, expected linear as in c.exr"]);
}

#[test]
fn heat_maps_show_where() {
    let folder = Folder::new();
    picture(&folder, "a.exr", |x, y| if x < 8 { 2.0 } else { ramp(x, y) });
    picture(&folder, "b.exr", ramp);
    let map = |more: &[&str]| {
        diff(&folder, &[&["a.exr", "b.exr", "--heatmap", "map.png"], more].concat()).expect(0, &[]);
        image::open(folder.path().join("map.png")).unwrap().into_rgb8()
    };
    let flip = map(&[]);
    assert_eq!(flip.dimensions(), (24, 16));
    let brightness = |x: u32| flip.get_pixel(x, 8).0.iter().map(|&byte| u32::from(byte)).sum::<u32>();
    assert!(brightness(2) > 200 && brightness(23) < 20, "{} {}", brightness(2), brightness(23));
    assert_eq!(map(&["--metric", "flip"]), flip);
    assert_ne!(map(&["--metric", "hdr-flip"]), flip);
    let arguments = ["a.exr", "b.exr", "--metric", "mae", "--heatmap", "map.png"];
    diff(&folder, &arguments).expect(2, &["flip or hdr-flip"]);
    diff(&folder, &["a.exr", "b.exr", "--heatmap", "map.exr"]).expect(2, &["found .exr, expected .png"]);
}

#[test]
fn pixels_that_are_not_finite_are_counted() {
    let folder = Folder::new();
    picture(&folder, "a.exr", |x, y| if (x, y) == (3, 3) { f32::NAN } else { ramp(x, y) });
    picture(&folder, "b.exr", |x, y| if y == 5 && x < 2 { f32::INFINITY } else { ramp(x, y) });
    let ran = diff(&folder, &["a.exr", "b.exr"]);
    ran.expect(0, &["non-finite 3 pixels, left out"]);
    assert_eq!(number(&ran, "relmse"), 0.0);
    picture(&folder, "nan.exr", |_, _| f32::NAN);
    diff(&folder, &["nan.exr", "b.exr"]).expect(1, &["error: none of the 384 pixels is finite"]);
}

#[test]
fn the_noise_of_a_reference_is_told_and_warned_of() {
    let folder = folder();
    reference(&folder, "noisy.exr", &["--samples", "0..4"]).expect(0, &[]);
    reference(&folder, "clean.exr", &["--samples", "100..300"]).expect(0, &[]);
    reference(&folder, "again.exr", &["--samples", "300..500"]).expect(0, &[]);
    reference(&folder, "dark.exr", &["--samples", "500..700", "--max-bounces", "1"]).expect(0, &[]);

    // Two estimates of one picture: what differs is their noise, to within its own scatter.
    let ran = diff(&folder, &["noisy.exr", "clean.exr", "--metric", "relmse"]);
    ran.expect(0, &["warning: clean.exr: its own noise is", "expected more samples"]);
    let ratio = number(&ran, "relmse") / number(&ran, "noise");
    assert!((0.7..1.4).contains(&ratio), "{ratio}");
    let ran = diff(&folder, &["clean.exr", "again.exr", "--metric", "relmse"]);
    let ratio = number(&ran, "relmse") / number(&ran, "noise");
    assert!((0.7..1.4).contains(&ratio), "{ratio}");

    // A real difference: the missing light of the second bounce.
    let ran = diff(&folder, &["dark.exr", "clean.exr", "--metric", "relmse"]);
    assert!(number(&ran, "relmse") > 4.0 * number(&ran, "noise"), "{}", ran.out());
    assert!(ran.err().is_empty(), "{}", ran.err());

    reference(&folder, "single.exr", &["--spp", "1"]).expect(0, &["noise (relmse) inf"]);
    diff(&folder, &["clean.exr", "single.exr"]).expect(0, &["noise      inf", "warning: single.exr"]);
}

#[test]
fn bad_input_is_named() {
    let folder = Folder::new();
    picture(&folder, "a.exr", ramp);
    exr::prelude::write_rgb_file(folder.path().join("small.exr"), 8, 4, |_, _| (1_f32, 1_f32, 1_f32))
        .unwrap();
    folder.file("broken.exr", [0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]);
    folder.file("broken.png", b"\x89PNG\r\n\x1a\n");
    folder.file("notes.txt", "hello");
    for (file, part) in [
        ("small.exr", "a.exr: size: found 24 x 16 pixels, expected 8 x 4 pixels as in small.exr"),
        ("broken.exr", "broken.exr"),
        ("broken.png", "broken.png"),
        ("notes.txt", "notes.txt: byte 0"),
        ("missing.exr", "missing.exr: file: found no such file"),
    ] {
        diff(&folder, &["a.exr", file]).expect(1, &["error: ", part]);
    }
    for (arguments, part) in [
        (&["a.exr"][..], "<B>"),
        (&["a.exr", "a.exr", "--metric", "psnr"], "relmse, mae, bias, flip, hdr-flip"),
    ] {
        diff(&folder, arguments).expect(2, &[part]);
    }
}
