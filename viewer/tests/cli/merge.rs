//! `sheen merge`.

use crate::common::{Folder, Ran};
use crate::reference::{film, folder, reference};

fn merge(folder: &Folder, files: &[&str], out: &str) -> Ran {
    folder.run(&[&["merge"], files, &["-o", out]].concat())
}

#[test]
fn ranges_merged_in_any_order_are_the_whole() {
    let folder = folder();
    for (out, samples) in [("a.exr", "0..4"), ("b.exr", "4..8"), ("c.exr", "8..9"), ("whole.exr", "0..9")] {
        reference(&folder, out, &["--samples", samples]).expect(0, &[&format!("samples {samples}")]);
    }
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    for files in [["a.exr", "b.exr", "c.exr"], ["c.exr", "a.exr", "b.exr"], ["b.exr", "c.exr", "a.exr"]] {
        merge(&folder, &files, "merged.exr").expect(0, &["merged.exr: 32 x 32, samples 0..9 of scene.toml"]);
        assert_eq!(film(&folder, "merged.exr"), film(&folder, "whole.exr"));
        assert!(bytes("merged.exr") == bytes("whole.exr"), "{files:?}: the same file, byte by byte");
    }
    merge(&folder, &["a.exr", "c.exr"], "gap.exr").expect(0, &["samples 0..4, 8..9"]);
    merge(&folder, &["gap.exr", "b.exr"], "gap.exr").expect(0, &["samples 0..9"]);
    assert!(bytes("gap.exr") == bytes("whole.exr"), "a source may be replaced");
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let folder = folder();
    let with = |out: &str, more: &[&str]| reference(&folder, out, more).expect(0, &[]);
    with("a.exr", &["--samples", "0..2"]);
    with("overlap.exr", &["--samples", "1..3"]);
    with("seed.exr", &["--samples", "2..4", "--seed", "1"]);
    with("bounces.exr", &["--samples", "2..4", "--max-bounces", "3"]);
    with("light.exr", &["--samples", "2..4", "--environment", "sky"]);
    with("camera.exr", &["--samples", "2..4", "--eye", "0,1,5"]);
    folder
        .run(&["reference", "scene.toml", "--size", "32x31", "--samples", "2..4", "-o", "size.exr"])
        .expect(0, &[]);
    for (file, part) in [
        ("overlap.exr", "overlap.exr: samples: found 1..2, which a.exr has too"),
        ("a.exr", "a.exr: samples: found 0..2, which a.exr has too"),
        ("seed.exr", "seed.exr: seed: found 1, expected 0 as in a.exr"),
        ("bounces.exr", "bounces.exr: settings: found max bounces 3"),
        ("light.exr", "light.exr: fingerprint: found "),
        ("camera.exr", "camera.exr: fingerprint: found "),
        ("size.exr", "size.exr: size: found 32 x 31 pixels, expected 32 x 32 pixels as in a.exr"),
        ("missing.exr", "missing.exr: file: found no such file"),
        ("scene.toml", "scene.toml: byte 0: found"),
    ] {
        merge(&folder, &["a.exr", file], "merged.exr").expect(1, &["error: ", part]);
        assert!(!folder.names().contains(&"merged.exr".into()), "{file}");
    }
}

#[test]
fn damaged_files_are_refused() {
    let folder = folder();
    reference(&folder, "a.exr", &["--samples", "0..2"]).expect(0, &[]);
    let bytes = std::fs::read(folder.path().join("a.exr")).unwrap();
    for place in (0..bytes.len()).step_by(bytes.len() / 23) {
        folder.file("cut.exr", &bytes[..place]);
        merge(&folder, &["cut.exr"], "merged.exr").expect(1, &["error: cut.exr"]);
    }
    // In the middle of the pixels.
    let mut damaged = bytes.clone();
    for byte in &mut damaged[bytes.len() / 2..][..40] {
        *byte ^= 0x55;
    }
    folder.file("damaged.exr", &damaged);
    merge(&folder, &["damaged.exr"], "merged.exr").expect(1, &["error: damaged.exr"]);
    exr::prelude::write_rgb_file(folder.path().join("picture.exr"), 8, 4, |_, _| (1_f32, 1_f32, 1_f32))
        .unwrap();
    merge(&folder, &["picture.exr"], "merged.exr")
        .expect(1, &["picture.exr: attribute sheenFilm: found none"]);
    assert!(!folder.names().contains(&"merged.exr".into()));
}

#[test]
fn bad_usage_is_told_apart() {
    let folder = Folder::new();
    for (arguments, part) in [
        (&["merge", "a.exr"][..], "--out"),
        (&["merge", "-o", "x.exr"], "F.exr"),
        (&["merge", "a.exr", "-o", "x.png"], "found .png, expected .exr"),
    ] {
        folder.run(arguments).expect(2, &[part]);
    }
    assert!(folder.names().is_empty());
}
