//! `sheen render`, and the picture that stands in for the window.

use crate::common::{Folder, test_data};
use scene::{Limits, load};
use std::path::Path;

/// Linear pixels of a written EXR.
fn exr_pixels(path: &Path) -> (u32, u32, Vec<[f32; 3]>) {
    let (image, warnings) = load::environment(path, &Limits::default()).unwrap();
    assert!(warnings.iter().all(|warning| warning.place == "image size"), "{warnings:?}");
    (image.width, image.height, image.pixels)
}

fn mean(pixels: &[[f32; 3]]) -> f64 {
    pixels.as_flattened().iter().map(|&value| f64::from(value)).sum::<f64>() / (3 * pixels.len()) as f64
}

#[test]
fn the_built_in_scene_goes_to_exr_and_png() {
    let folder = Folder::new();
    folder.run(&["render", "showroom", "--out", "a.exr", "--size", "96x54"]).expect(0, &["a.exr: 96 x 54"]);
    let (width, height, pixels) = exr_pixels(&folder.path().join("a.exr"));
    assert_eq!((width, height), (96, 54));
    assert!(mean(&pixels) > 0.05, "mean {}", mean(&pixels));
    let peak = pixels.as_flattened().iter().copied().fold(0.0, f32::max);
    assert!(peak > 1.5, "the lamps' reflections are brighter than white, found {peak}");

    folder.run(&["render", "showroom", "-o", "b.png", "--size", "96x54"]).expect(0, &[]);
    let shown = image::open(folder.path().join("b.png")).unwrap().into_rgb8();
    assert_eq!(shown.dimensions(), (96, 54));
    for (pixel, radiance) in shown.pixels().zip(&pixels) {
        let expected = compositor::tone_map::display_srgb8(*radiance, 0.0, compositor::ToneCurve::PbrNeutral);
        assert!(pixel.0.iter().zip(expected).all(|(&a, b)| a.abs_diff(b) <= 1), "{pixel:?} {expected:?}");
    }
    assert_eq!(folder.names(), ["a.exr", "b.png"]);
}

/// A perfect mirror ball in an environment of radiance 1: it shows 1 wherever it is looked at.
const MIRROR_BALL: &str = "[camera]\neye = [0, 0, 4]\ntarget = [0, 0, 0]\n\
    [environment]\nfile = \"white.exr\"\n\
    [[object]]\nshape = \"sphere\"\nbase_color = [1, 1, 1]\nmetallic = 1\nroughness = 0\n";

/// Writes an environment of one radiance by way of a picture of nothing else.
fn white_environment(folder: &Folder) {
    let pixel = |_| (1.0_f32, 1.0_f32, 1.0_f32);
    exr::prelude::write_rgb_file(folder.path().join("white.exr"), 16, 8, move |x, y| pixel((x, y))).unwrap();
}

#[test]
fn settings_of_the_scene_file_and_of_the_command_line_count() {
    let folder = Folder::new();
    white_environment(&folder);
    folder.file("plain.toml", MIRROR_BALL);
    folder.file("half.toml", format!("{MIRROR_BALL}[diffuse-envmap]\nintensity = 0.5\n"));
    let centre = |scene: &str, more: &[&str]| {
        let arguments = [&["render", scene, "-o", "c.exr", "--size", "33x33"], more].concat();
        folder.run(&arguments).expect(0, &[]);
        exr_pixels(&folder.path().join("c.exr")).2[33 * 16 + 16][1]
    };
    let close = |found: f32, expected: f32| assert!((found - expected).abs() < 0.02, "{found} {expected}");
    close(centre("plain.toml", &[]), 1.0);
    close(centre("half.toml", &[]), 0.5);
    close(centre("half.toml", &["--set", "diffuse-envmap.intensity=0.25"]), 0.25);
    close(
        centre("plain.toml", &["--set", "diffuse-envmap.method=paper", "--set", "diffuse-envmap.rays=8"]),
        1.0,
    );
    close(centre("plain.toml", &["--environment", "none"]), 0.0);
    close(centre("plain.toml", &["--eye", "0,0,40", "--target", "0,0,80"]), 1.0);
    close(centre("plain.toml", &["--environment", "none", "--eye", "-3,0.1,0", "--target", "0,0,0"]), 0.0);
}

#[test]
fn an_environment_beside_the_scene_lights_it() {
    let folder = Folder::new();
    white_environment(&folder);
    folder.file("triangle.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.run(&["render", "white.exr", "triangle.obj", "-o", "d.exr", "--size", "40x20"]).expect(0, &[]);
    let (.., pixels) = exr_pixels(&folder.path().join("d.exr"));
    assert!((pixels[0][0] - 1.0).abs() < 1e-3, "the background is the environment: {:?}", pixels[0]);

    let ran = folder.run(&["render", "triangle.obj", "-o", "e.exr", "--size", "40x20"]);
    ran.expect(0, &["warning: triangle.obj: light", "studio"]);
}

#[test]
fn exposure_brightens_the_png() {
    let folder = Folder::new();
    let level = |exposure: &str| {
        folder
            .run(&["render", "showroom", "-o", "f.png", "--size", "32x18", "--exposure", exposure])
            .expect(0, &[]);
        let image = image::open(folder.path().join("f.png")).unwrap().into_rgb8();
        image.pixels().map(|pixel| u64::from(pixel.0[1])).sum::<u64>()
    };
    assert!(level("-3") < level("0"));
}

#[test]
fn bad_input_is_named_and_leaves_nothing_behind() {
    let folder = Folder::new();
    folder.file("broken.glb", b"glTF\x02\0\0\0\xff\0\0\0");
    folder.file("broken.obj", "v 1 2\n");
    folder.file("broken.toml", "[diffuse-envmap]\nmethd = \"paper\"\n");
    folder.file("broken.hdr", "#?RADIANCE\n\n-Y 4 +X 8\n");
    folder.file("notes.txt", "hello");
    let before = folder.names();
    for file in ["broken.glb", "broken.obj", "broken.toml", "broken.hdr", "notes.txt", "missing.glb"] {
        folder.run(&["render", file, "--out", "x.png", "--size", "16x16"]).expect(1, &["error: ", file]);
        folder.run(&["info", file]).expect(1, &["error: ", file]);
        assert_eq!(folder.names(), before, "{file}");
    }
    folder.run(&["render", "broken.toml", "-o", "x.png"]).expect(1, &["`method`"]);
}

#[test]
fn bad_usage_is_told_apart() {
    let folder = Folder::new();
    for (arguments, part) in [
        (&["render", "showroom"][..], "--out"),
        (&["render", "--out", "x.png"], "SCENE"),
        (&["render", "showroom", "-o", "x.jpg"], ".exr or .png"),
        (&["render", "showroom", "-o", "x"], ".exr or .png"),
        (&["render", "showroom", "-o", "x.png", "--size", "0x5"], "pixels"),
        (&["render", "showroom", "-o", "x.png", "--size", "99999999999x5"], "width and height"),
        (&["render", "showroom", "-o", "x.png", "--size", "4000000000x5"], "pixels"),
        (&["render", "showroom", "-o", "x.png", "--set", "diffuse-envmap.methd=paper"], "`method`"),
        (&["render", "showroom", "-o", "x.png", "--set", "diffuse-envmp.method=paper"], "`diffuse-envmap`"),
        (&["render", "showroom", "-o", "x.png", "--set", "diffuse-envmap.method=papr"], "paper or sheen"),
        (&["render", "showroom", "-o", "x.png", "--set", "diffuse-envmap.rays=9"], "method = paper"),
        (&["render", "showroom", "-o", "x.png", "--technique", "glair"], "diffuse-envmap"),
        (&["render", "showroom", "-o", "x.png", "--environment", "skye"], "`sky`"),
        (&["render", "showroom", "-o", "x.png", "--exposure", "nan"], "a number"),
        (&["render", "showroom", "-o", "x.png", "--eye", "1,2"], "three numbers"),
        (&["render", "a.glb", "b.glb", "-o", "x.png"], "b.glb"),
        (&["render", "a.glb", "b.hdr", "-o", "x.png", "--environment", "sky"], "two environments"),
        (&["info"], "FILE"),
        (&["--no-such-option"], "--no-such-option"),
    ] {
        folder.run(arguments).expect(2, &[part]);
        assert!(folder.names().is_empty(), "{arguments:?}");
    }
}

#[test]
fn a_place_that_cannot_be_written_is_refused() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path().join("folder.png")).unwrap();
    for (out, part) in
        [("none/x.png", "no such folder"), ("folder.png", "a folder"), ("/proc/x.png", "/proc/x.png")]
    {
        if out.starts_with("/proc") && !cfg!(target_os = "linux") {
            continue;
        }
        folder.run(&["render", "showroom", "-o", out, "--size", "8x8"]).expect(1, &[out, part]);
    }
    assert_eq!(folder.names(), ["folder.png"]);
}

#[test]
fn a_picture_replaces_an_older_one_only_when_it_is_whole() {
    let folder = Folder::new();
    folder.file("old.png", "old");
    folder.run(&["render", "missing.glb", "-o", "old.png"]).expect(1, &["missing.glb"]);
    assert_eq!(std::fs::read(folder.path().join("old.png")).unwrap(), b"old");
    folder.run(&["render", "showroom", "-o", "old.png", "--size", "8x8"]).expect(0, &[]);
    assert!(image::open(folder.path().join("old.png")).is_ok());
    assert_eq!(folder.names(), ["old.png"]);
}

#[test]
fn naming_techniques_keeps_those() {
    let folder = Folder::new();
    white_environment(&folder);
    folder.file("off.toml", MIRROR_BALL);
    let run = |more: &[&str]| {
        let arguments = [&["render", "off.toml", "-o", "g.exr", "--size", "9x9"], more].concat();
        folder.run(&arguments).expect(0, &[]);
        exr_pixels(&folder.path().join("g.exr")).2[9 * 4 + 4][0]
    };
    assert!(run(&["--technique", "diffuse-envmap"]) > 0.9);
    assert!(run(&[]) > 0.9);
}

/// A wall across a plane in the light of a sun that stands at 45 degrees.
const WALL: &str = "[camera]\neye = [0, 6, 0.01]\ntarget = [0, 0, 0]\nfov_y_deg = 18\n\
    [[light]]\ndirection = [1, 1, 0]\nirradiance = [3, 3, 3]\n\
    [[object]]\nshape = \"plane\"\nheight_map = \"wall.png\"\nheight_scale = 0.25\n";

#[test]
fn height_maps_cast_the_shadows_that_are_asked_for() {
    let folder = Folder::new();
    let wall = image::GrayImage::from_fn(64, 64, |x, _| image::Luma([if x / 2 == 15 { 255 } else { 0 }]));
    wall.save(folder.path().join("wall.png")).unwrap();
    folder.file("wall.toml", WALL);
    folder.file("off.toml", format!("{WALL}[horizon-shadow]\nmethod = \"none\"\n"));
    let dark = |arguments: &[&str]| {
        let arguments = [&["render", "-o", "w.exr", "--size", "64x64"], arguments].concat();
        folder.run(&arguments).expect(0, &[]);
        let (.., pixels) = exr_pixels(&folder.path().join("w.exr"));
        pixels.iter().filter(|pixel| pixel[0] < 0.01).count()
    };
    // On the wall's dark side normals turn away from the light, differenced over four columns.
    let unshadowed = dark(&["off.toml"]);
    assert!(unshadowed <= 64 * 4, "{unshadowed}");
    assert_eq!(dark(&["wall.toml", "--set", "horizon-shadow.method=none"]), unshadowed);
    assert_eq!(dark(&["wall.toml", "--technique", "diffuse-envmap"]), unshadowed);
    for method in ["flat", "paper", "exact", "sheen", "certified", "marched"] {
        let setting = format!("horizon-shadow.method={method}");
        // A bake in slices is finished all the same.
        let slices = "horizon-shadow.azimuths_per_prepare=3";
        let found = dark(&["wall.toml", "--technique", "horizon-shadow", "--set", &setting, "--set", slices]);
        assert!(
            (64 * 6..64 * 10).contains(&found),
            "{method}: {found} dark pixels, {unshadowed} without shadows"
        );
    }
    folder
        .run(&["render", "wall.toml", "-o", "w.exr", "--set", "horizon-shadow.azimuths=65"])
        .expect(2, &["4 to 64"]);
}

#[cfg(target_os = "linux")]
#[test]
fn without_a_display_the_picture_stands_in_for_the_window() {
    let folder = Folder::new();
    folder.run::<&str>(&[]).expect(0, &["no display", "sheen.png"]);
    let shown = image::open(folder.path().join("sheen.png")).unwrap().into_rgb8();
    assert_eq!(shown.dimensions(), (1280, 720));
    let bright = shown.pixels().filter(|pixel| pixel.0[1] > 60).count();
    assert!(bright > 1280 * 720 / 4, "{bright} pixels are bright");
    assert_eq!(folder.names(), ["sheen.png"]);
    folder.run(&["missing.glb"]).expect(1, &["missing.glb"]);
    folder.run(&["a.glb", "b.glb"]).expect(2, &["b.glb"]);
}

#[test]
fn real_models_are_rendered() {
    let Some(model) = test_data("gltf/boom_box.glb") else { return };
    let Some(light) = test_data("hdri/hotel_room_1k.exr") else { return };
    let folder = Folder::new();
    let [model, light] = [model, light].map(|path| path.to_string_lossy().into_owned());
    folder.run(&["render", &model, &light, "-o", "h.exr", "--size", "64x64"]).expect(0, &["h.exr"]);
    let (.., pixels) = exr_pixels(&folder.path().join("h.exr"));
    assert!(mean(&pixels) > 0.05);
}
