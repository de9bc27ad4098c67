//! `sheen info`.

use crate::common::{Folder, test_data};

#[test]
fn counts_and_warnings_of_a_scene_file() {
    let folder = Folder::new();
    folder.file("quad.obj", "mtllib none.mtl\nv 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nf 1 2 3 4\n");
    let text = "[camera]\neye = [0, 1, 5]\ntarget = [0, 0, 0]\n[environment]\nbuiltin = \"sky\"\n\
        [[light]]\ndirection = [0, 1, 0]\nirradiance = 2\n\
        [[object]]\nfile = \"quad.obj\"\n[[object]]\nfile = \"quad.obj\"\ntranslation = [4, 0, 0]\n\
        [glare]\nrays = 3\n";
    folder.file("scene.toml", text);
    let ran = folder.run(&["info", "scene.toml"]);
    ran.expect(0, &["scene.toml: a scene", "triangles    4 as placed", "instances    2", "lights       1"]);
    ran.expect(0, &["6.0000 x 3.0000 x 0.0000 m", "sky, 1024 x 512", "camera", "none.mtl", "[glare]"]);
    assert!(ran.err().is_empty(), "{}", ran.err());
}

#[test]
fn environments_and_height_maps() {
    let folder = Folder::new();
    let level = |x: usize, _| if x == 3 { (9.0_f32, 1.0_f32, 1.0_f32) } else { (1.0, 1.0, 1.0) };
    exr::prelude::write_rgb_file(folder.path().join("sky.exr"), 8, 4, level).unwrap();
    folder.run(&["info", "sky.exr"]).expect(0, &["an environment", "8 x 4", "peak 9", "no warnings"]);

    image::GrayImage::from_fn(5, 2, |x, _| image::Luma([(x * 51) as u8]))
        .save(folder.path().join("hills.png"))
        .unwrap();
    folder.run(&["info", "hills.png"]).expect(0, &["height map", "5 x 2", "0 to 0.8", "no warnings"]);
    folder.file("torn.png", b"\x89PNG\r\n\x1a\n");
    folder.run(&["info", "torn.png"]).expect(1, &["torn.png"]);
    folder.run(&["info", "."]).expect(1, &["error: "]);
}

#[test]
fn real_files() {
    let folder = Folder::new();
    for (name, parts) in [
        ("gltf/FlightHelmet/FlightHelmet.gltf", &["94722 as placed", "6, 1 blended", "15 ("][..]),
        ("obj/stanford_bunny.obj", &["69451 as placed"]),
        ("hdri/hotel_room_1k.exr", &["1024 x 512", "peak 33952", "negative"]),
        ("hdri/rooitou_park_1k.hdr", &["peak 69120"]),
    ] {
        let Some(path) = test_data(name) else { continue };
        folder.run(&["info".as_ref(), path.as_os_str()]).expect(0, parts);
    }
}
