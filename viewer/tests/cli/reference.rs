//! `sheen reference`.

use crate::common::{Folder, Ran};
use path_tracer::Film;
use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// A sphere on a plane, in a small environment and under a lamp.
pub(crate) const SCENE: &str = "[camera]\neye = [0, 1, 4]\ntarget = [0, 0, 0]\n\
    [environment]\nfile = \"room.exr\"\n\
    [[light]]\ndirection = [1, 1, 0]\nirradiance = 2\nangular_diameter_deg = 5\n\
    [[object]]\nshape = \"sphere\"\nbase_color = [0.8, 0.5, 0.3]\nroughness = 0.4\n\
    [[object]]\nshape = \"plane\"\ntranslation = [0, -1, 0]\nscale = 3\n";

/// A folder with the scene, which takes no time to load.
pub(crate) fn folder() -> Folder {
    let folder = Folder::new();
    let radiance = |x: usize, y: usize| (0.5 + x as f32 / 8.0, 1.0, 2.5 - y as f32 / 4.0);
    exr::prelude::write_rgb_file(folder.path().join("room.exr"), 16, 8, radiance).unwrap();
    folder.file("scene.toml", SCENE);
    folder
}

/// Renders the scene to a file.
pub(crate) fn reference(folder: &Folder, out: &str, more: &[&str]) -> Ran {
    folder.run(&[&["reference", "scene.toml", "--size", "32x32", "-o", out], more].concat())
}

pub(crate) fn film(folder: &Folder, name: &str) -> Film {
    Film::from_exr(&std::fs::read(folder.path().join(name)).unwrap(), name).unwrap()
}

#[test]
fn a_reference_is_a_film_and_a_picture() {
    let folder = folder();
    let ran = reference(&folder, "a.exr", &["--spp", "3", "--seed", "9", "--max-bounces", "2"]);
    ran.expect(0, &["a.exr: 32 x 32, samples 0..3 of scene.toml, noise (relmse)", "fingerprint"]);
    let film = film(&folder, "a.exr");
    assert_eq!((film.size(), film.samples().to_string()), ([32, 32], "0..3".into()));
    let identity = film.identity();
    assert!(ran.out().contains(&identity.fingerprint_text()));
    assert_eq!((identity.scene.as_str(), identity.seed), ("scene.toml", 9));
    assert!(identity.settings.contains("max bounces 2") && identity.settings.contains("lobe Ggx"));
    assert_eq!((film.invalid(), film.clamped()), (0, 0));
    let mean = film.mean();
    assert!(mean.iter().all(|pixel| pixel.iter().all(|value| *value > 0.0)));
    assert_eq!(folder.names(), ["a.exr", "room.exr", "scene.toml"]);
    let told = ["a.exr: a path-traced reference", "samples      0..3", "seed         9", "32 x 32"];
    folder.run(&["info", "a.exr"]).expect(0, &told);
}

#[test]
fn threads_do_not_count_and_options_do() {
    let folder = folder();
    let with_threads = |threads: &str, out: &str| {
        let arguments = ["reference", "scene.toml", "--size", "32x32", "--spp", "4", "-o", out];
        let output = folder.command(&arguments).env("RAYON_NUM_THREADS", threads).output().unwrap();
        Ran(output).expect(0, &[]);
        std::fs::read(folder.path().join(out)).unwrap()
    };
    let one = with_threads("1", "one.exr");
    assert!(one == with_threads("2", "two.exr"), "the same file, byte by byte");
    assert!(one == with_threads("7", "seven.exr"));

    let base = film(&folder, "one.exr");
    for more in [
        &["--seed", "1"][..],
        &["--max-bounces", "1"],
        &["--lobe", "blinn"],
        &["--lobe", "phong-cone"],
        &["--lobe", "diffused-environment"],
        &["--far-field"],
        &["--pixel-filter", "point"],
        &["--pixel-filter", "gaussian"],
        &["--environment", "sky"],
        &["--environment", "none"],
        &["--rotation", "90"],
        &["--eye", "0,1,5"],
        &["--target", "0,0.1,0"],
    ] {
        reference(&folder, "other.exr", &[&["--spp", "4"], more].concat()).expect(0, &[]);
        let other = film(&folder, "other.exr");
        assert_ne!(other.identity().fingerprint, base.identity().fingerprint, "{more:?}");
        assert_ne!(other.mean(), base.mean(), "{more:?}");
    }
}

#[test]
fn no_bounce_shows_what_emits() {
    let folder = folder();
    reference(&folder, "a.exr", &["--spp", "1", "--max-bounces", "0", "--pixel-filter", "point"])
        .expect(0, &[]);
    let mean = film(&folder, "a.exr").mean();
    assert_eq!(mean[32 * 16 + 16], [0.0; 3], "the sphere in the middle only reflects");
    assert!(mean[16].iter().all(|value| *value > 0.0), "the environment behind it emits");
}

#[test]
fn bad_usage_is_told_apart() {
    let folder = folder();
    for (arguments, part) in [
        (&["reference", "scene.toml"][..], "--out"),
        (&["reference", "-o", "x.exr"], "SCENE"),
        (&["reference", "scene.toml", "-o", "x.png"], "found .png, expected .exr"),
        (&["reference", "scene.toml", "-o", "x"], "found no extension, expected .exr"),
        (&["reference", "scene.toml", "-o", "x.exr", "--spp", "0"], "expected 1 to 16777216"),
        (&["reference", "scene.toml", "-o", "x.exr", "--spp", "99999999"], "expected 1 to 16777216"),
        (&["reference", "scene.toml", "-o", "x.exr", "--samples", "4"], "such as 0..64"),
        (&["reference", "scene.toml", "-o", "x.exr", "--samples", "4..4"], "such as 0..64"),
        (&["reference", "scene.toml", "-o", "x.exr", "--samples", "5..4"], "such as 0..64"),
        (&["reference", "scene.toml", "-o", "x.exr", "--samples", "0..4294967295"], "1 to 16777216"),
        (&["reference", "scene.toml", "-o", "x.exr", "--samples", "0..4", "--spp", "4"], "--spp"),
        (&["reference", "scene.toml", "-o", "x.exr", "--lobe", "gx"], "ggx, blinn, phong-cone"),
        (&["reference", "scene.toml", "-o", "x.exr", "--pixel-filter", "tent"], "box, gaussian, point"),
        (&["reference", "scene.toml", "-o", "x.exr", "--size", "0x4"], "pixels"),
        (&["reference", "scene.toml", "-o", "x.exr", "--environment", "skye"], "`sky`"),
        (&["reference", "a.glb", "b.hdr", "-o", "x.exr", "--environment", "sky"], "two environments"),
    ] {
        folder.run(arguments).expect(2, &[part]);
        assert_eq!(folder.names(), ["room.exr", "scene.toml"], "{arguments:?}");
    }
}

#[test]
fn bad_input_is_named_and_leaves_nothing_behind() {
    let folder = folder();
    folder.file("broken.toml", "[[object]]\nshape = \"cone\"\nsize = 3\n");
    for (arguments, part) in [
        (&["reference", "missing.glb", "-o", "x.exr"][..], "missing.glb"),
        (&["reference", "broken.toml", "-o", "x.exr"], "broken.toml"),
        (&["reference", "scene.toml", "-o", "none/x.exr"], "no such folder"),
        (&["reference", "scene.toml", "-o", "scene.toml/x.exr"], "no folder to be in"),
        (&["reference", "scene.toml", "-o", "x.exr", "--size", "20000x2"], "16384"),
    ] {
        folder.run(arguments).expect(1, &["error: ", part]);
        assert_eq!(folder.names(), ["broken.toml", "room.exr", "scene.toml"], "{arguments:?}");
    }
}

/// Renders two million samples, which takes hours, and interrupts it after some seconds.
#[cfg(unix)]
fn interrupted(folder: &Folder, seconds: u64) -> Ran {
    let arguments = ["reference", "scene.toml", "--size", "32x32", "--samples", "8..2000008", "-o", "a.exr"];
    let mut command = folder.command(&arguments);
    let mut child = command.stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut errors = BufReader::new(child.stderr.take().unwrap());
    let mut text = String::new();
    errors.read_line(&mut text).unwrap();
    assert!(text.contains("32 x 32 pixels, samples 8..2000008"), "{text}");
    std::thread::sleep(Duration::from_secs(seconds));
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.unwrap().success());
    errors.read_to_string(&mut text).unwrap();
    let output = child.wait_with_output().unwrap();
    Ran(Output { stderr: text.into(), ..output })
}

#[cfg(unix)]
#[test]
fn an_interruption_keeps_the_samples_so_far_and_the_rest_can_be_added() {
    let folder = folder();
    // However slow the machine is, some samples will be there after one of these.
    let mut runs = [1, 5, 25, 125].into_iter().map(|seconds| interrupted(&folder, seconds));
    let ran = runs.find(|_| folder.path().join("a.exr").exists()).unwrap();
    let found = film(&folder, "a.exr");
    let [samples] = found.samples().ranges() else { panic!("{}", found.samples()) };
    assert!(samples.start == 8 && samples.end < 2000008);
    let end = samples.end;
    ran.expect(
        130,
        &[&format!("a.exr holds samples 8..{end} alone; --samples {end}..2000008 renders the rest")],
    );
    assert_eq!(folder.names(), ["a.exr", "room.exr", "scene.toml"]);

    reference(&folder, "b.exr", &["--samples", &format!("8..{end}")]).expect(0, &[]);
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert!(bytes("a.exr") == bytes("b.exr"), "the same bytes as without the interruption");
    reference(&folder, "b.exr", &["--samples", "0..8"]).expect(0, &[]);
    folder.run(&["merge", "a.exr", "b.exr", "-o", "c.exr"]).expect(0, &[&format!("samples 0..{end}")]);
}

#[cfg(unix)]
#[test]
fn an_interruption_before_the_first_sample_writes_nothing() {
    // A sample of so many pixels takes seconds.
    let folder = folder();
    let arguments = ["reference", "scene.toml", "--size", "1500x1500", "--spp", "1", "-o", "a.exr"];
    let mut child = folder.command(&arguments).stderr(Stdio::piped()).spawn().unwrap();
    let mut errors = BufReader::new(child.stderr.take().unwrap());
    let mut text = String::new();
    errors.read_line(&mut text).unwrap();
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.unwrap().success());
    errors.read_to_string(&mut text).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{text}");
    assert!(
        text.contains("interrupted: no sample of every pixel was finished; a.exr was not written"),
        "{text}"
    );
    assert_eq!(folder.names(), ["room.exr", "scene.toml"]);
}
