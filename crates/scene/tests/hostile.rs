//! Files that lie. Whatever comes in, a loader answers with an error or with a scene that passes
//! `Scene::check`: no panic, no memory beyond the limits, no file from outside the folder.

mod common;

use std::path::Path;

use common::{GltfBuilder, empty_folder, png, test_data};
use proptest::prelude::*;
use scene::load::{gltf_from_bytes, load_scene, obj_from_bytes, scene_file_from_str};
use scene::{Error, Limits, Scene};
use serde_json::{Value, json};

/// Small limits, so that a lie that gets through shows as a failed allocation of moderate size.
const LIMITS: Limits = Limits {
    file_bytes: 1 << 24,
    pixels: 1 << 20,
    texture_bytes: 1 << 22,
    triangles: 1 << 20,
    vertices: 1 << 20,
    nodes: 1 << 12,
    textures: 64,
    materials: 64,
};

/// A scene that was loaded must be valid, and its summaries finite.
fn checked(result: Result<Scene, Error>) -> Result<Scene, Error> {
    if let Ok(scene) = &result {
        scene.check().unwrap();
        let camera = scene.framing_camera(1.5);
        assert!(camera.eye.is_finite() && camera.target.is_finite() && camera.eye != camera.target);
    }
    result
}

fn gltf(bytes: &[u8]) -> Result<Scene, Error> {
    checked(gltf_from_bytes("test.glb", bytes, None, &LIMITS))
}

fn obj(text: &[u8]) -> Result<Scene, Error> {
    let result = checked(obj_from_bytes("test.obj", text, None, &LIMITS));
    if let Err(error) = &result {
        assert!(!error.expected.contains("tobj"), "what it cannot take is to be found before: {error}");
    }
    result
}

fn toml(text: &str) -> Result<Scene, Error> {
    checked(scene_file_from_str("test.toml", text, None, &LIMITS))
}

/// A small file that has most of what the loader reads.
fn rich() -> GltfBuilder {
    let mut file = GltfBuilder::triangle();
    let image = file.view(&png(2, 2, [200, 100, 50, 255]));
    let normals = file.floats("VEC3", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let uvs = file.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let indices = file.view(&[1, 0]);
    let values = file.view(&[0, 0, 0, 64, 0, 0, 0, 0, 0, 0, 0, 0]);
    file.json["accessors"][0]["sparse"] = json!({"count": 1, "indices": {"bufferView": indices, "componentType": 5123}, "values": {"bufferView": values}});
    file.json["images"] = json!([{"bufferView": image, "mimeType": "image/png"}]);
    file.json["samplers"] = json!([{"wrapS": 33071, "magFilter": 9728}]);
    file.json["textures"] = json!([{"source": 0, "sampler": 0}]);
    let transform = json!({"KHR_texture_transform": {"offset": [0, 1], "rotation": 1, "scale": [2, 3]}});
    file.json["materials"] = json!([{
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": transform}, "metallicFactor": 0.5},
        "normalTexture": {"index": 0, "scale": 2}, "emissiveFactor": [1, 1, 1], "alphaMode": "MASK",
        "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatTexture": {"index": 0}},
                       "KHR_materials_emissive_strength": {"emissiveStrength": 3}},
    }]);
    file.json["extensions"] =
        json!({"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {"outerConeAngle": 0.5}}]}});
    file.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]);
    *file.primitive() = json!({"attributes": {"POSITION": 0, "NORMAL": normals, "TEXCOORD_0": uvs}, "indices": 1, "material": 0});
    file.json["nodes"] = json!([
        {"mesh": 0, "children": [1], "scale": [1, 2, 3]},
        {"camera": 0, "translation": [0, 0, 5], "extensions": {"KHR_lights_punctual": {"light": 0}}},
    ]);
    file
}

#[test]
fn the_rich_file_is_valid() {
    let scene = gltf(&rich().glb()).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!((scene.textures.len(), scene.lights.len(), scene.camera.is_some()), (2, 1, true));
}

/// Sets the value at a JSON pointer and expects an error at a place.
#[expect(clippy::needless_pass_by_value, reason = "calls read better")]
fn lie(pointer: &str, value: Value, place: &str) {
    let mut file = rich();
    set(&mut file.json, pointer, value.clone());
    match gltf(&file.glb()) {
        Ok(_) => panic!("{pointer} = {value} is accepted"),
        Err(error) => assert_eq!(error.place, place, "{pointer} = {value}: {error}"),
    }
}

fn set(json: &mut Value, pointer: &str, value: Value) {
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    match json.pointer_mut(parent).unwrap() {
        Value::Array(array) => array[key.parse::<usize>().unwrap()] = value,
        parent => parent[key] = value,
    }
}

#[test]
fn lying_gltf_is_refused_where_it_lies() {
    let primitive = "/meshes/0/primitives/0";
    let huge = u64::MAX;
    lie("/accessors/0/count", json!(4), "accessors[0].count");
    lie("/accessors/0/count", json!(huge), "meshes[0].primitives[0]");
    lie("/accessors/0/count", json!(1_000_000), "accessors[0].count");
    lie("/accessors/0/byteOffset", json!(4), "accessors[0].count");
    lie("/accessors/0/byteOffset", json!(huge), "accessors[0].count");
    lie("/accessors/0/componentType", json!(5125), "accessors[0].componentType");
    lie("/accessors/0/componentType", json!(1), "accessors[0].componentType");
    lie("/accessors/0/type", json!("VEC2"), "accessors[0].type");
    lie("/accessors/0/type", json!("VEC9"), "accessors[0].type");
    lie("/accessors/0/bufferView", json!(99), "accessors[0].bufferView");
    lie("/accessors/0/bufferView", json!(4_294_967_295_u32), "accessors[0].bufferView");
    lie("/accessors/0/sparse/count", json!(huge), "accessors[0].count");
    lie("/accessors/0/sparse/count", json!(2), "accessors[0].count");
    lie(
        "/accessors/0/sparse/indices/componentType",
        json!(5126),
        "accessors[0].sparse.indices.componentType",
    );
    lie("/accessors/0/sparse/indices/bufferView", json!(99), "accessors[0].bufferView");
    lie("/accessors/0/sparse/values/byteOffset", json!(huge), "accessors[0].count");
    lie("/accessors/1/componentType", json!(5126), "accessors[1].componentType");
    lie("/accessors/1/type", json!("VEC2"), "accessors[1].type");
    lie("/accessors/2/count", json!(2), "meshes[0].primitives[0].attributes.NORMAL");
    lie("/bufferViews/0/byteLength", json!(huge), "bufferViews[0]");
    lie("/bufferViews/0/byteOffset", json!(huge), "bufferViews[0]");
    lie("/bufferViews/0/byteStride", json!(0), "accessors[0].bufferView");
    lie("/bufferViews/0/byteStride", json!(11), "accessors[0].bufferView");
    lie("/bufferViews/0/byteStride", json!(huge), "accessors[0].count");
    lie("/bufferViews/0/buffer", json!(1), "bufferViews[0].buffer");
    lie(&format!("{primitive}/attributes/POSITION"), json!(99), "meshes[0].primitives[0]");
    lie(&format!("{primitive}/indices"), json!(99), "meshes[0].primitives[0]");
    lie(&format!("{primitive}/material"), json!(9), "material of \"triangle\"");
    lie(&format!("{primitive}/mode"), json!(7), "meshes[0].primitives[0].mode");
    lie("/nodes/0/mesh", json!(1), "nodes[0].mesh");
    lie("/nodes/0/children", json!([7]), "nodes[0].children[0]");
    lie("/nodes/0/children", json!([0]), "nodes[0].children[0]");
    lie("/nodes/1/children", json!([0]), "nodes[1].children[0]");
    lie("/nodes/0/children", json!([1, 1]), "nodes[0].children[1]");
    lie("/nodes/0/scale", json!([1e39, 1, 1]), "nodes[0]");
    lie("/nodes/0/rotation", json!([0, 0, 0, 0]), "nodes[0].rotation");
    lie("/nodes/0/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]), "nodes[0].matrix");
    lie("/nodes/1/camera", json!(1), "nodes[1].camera");
    lie(
        "/nodes/1/extensions/KHR_lights_punctual/light",
        json!(1),
        "nodes[1].extensions.KHR_lights_punctual.light",
    );
    lie("/scenes/0/nodes", json!([2]), "scenes[0].nodes[0]");
    lie("/scenes/0/nodes", json!([0, 0]), "scenes[0].nodes[1]");
    lie("/scene", json!(1), "scene");
    lie("/cameras/0/perspective/yfov", json!(4), "cameras[0].perspective.yfov");
    let light = "extensions.KHR_lights_punctual.lights[0]";
    lie("/extensions/KHR_lights_punctual/lights/0/intensity", json!(-1), light);
    lie("/extensions/KHR_lights_punctual/lights/0/type", json!("area"), &format!("{light}.type"));
    lie("/extensions/KHR_lights_punctual/lights/0/spot/innerConeAngle", json!(1), &format!("{light}.spot"));
    lie("/materials/0/alphaMode", json!("GLOW"), "materials[0].alphaMode");
    lie("/materials/0/normalTexture/index", json!(1), "materials[0].normalTexture.index");
    lie(
        "/materials/0/extensions/KHR_materials_clearcoat/clearcoatFactor",
        json!("x"),
        "materials[0], KHR_materials_clearcoat",
    );
    lie("/textures/0/source", json!(1), "textures[0].source");
    lie("/textures/0/sampler", json!(1), "textures[0].sampler");
    lie("/images/0/bufferView", json!(0), "images[0] (\"image 0\"), image header");
    lie("/images/0", json!({}), "images[0]");
    lie(
        "/extensionsRequired",
        json!(["KHR_lights_punctual", "KHR_draco_mesh_compression"]),
        "extensionsRequired[1]",
    );
    lie("/asset/version", json!("1.0"), "asset.version");
}

#[test]
fn an_unknown_required_extension_is_named() {
    let mut file = rich();
    file.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    let error = gltf(&file.glb()).unwrap_err();
    assert_eq!(error.found, "\"KHR_draco_mesh_compression\"");
    assert!(error.expected.contains("KHR_materials_clearcoat"), "{error}");
}

#[test]
fn positions_that_are_not_numbers_name_the_vertex() {
    for number in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut file = GltfBuilder::triangle();
        file.buffer[16..20].copy_from_slice(&number.to_le_bytes());
        assert_eq!(gltf(&file.glb()).unwrap_err().place, "meshes[0].primitives[0], vertex 1");
    }
}

#[test]
fn indices_beyond_the_vertices_are_refused() {
    let mut file = GltfBuilder::triangle();
    file.buffer[38] = 3;
    let error = gltf(&file.glb()).unwrap_err();
    assert_eq!(
        (error.place.as_str(), error.found.as_str()),
        ("meshes[0].primitives[0].indices, element 2", "vertex 3")
    );
}

#[test]
fn hostile_numbers_in_the_millions_stay_cheap() {
    // Zeros without a view cost nothing in the file: the limits must stop them.
    let mut file = GltfBuilder::triangle();
    file.json["accessors"][0] = json!({"componentType": 5126, "type": "VEC3", "count": LIMITS.vertices + 1});
    assert_eq!(
        gltf(&file.glb()).unwrap_err().expected,
        format!("at most {} (Limits::vertices)", LIMITS.vertices)
    );
    file.json["accessors"][0] = json!({"componentType": 5126, "type": "VEC3", "count": 300_000});
    file.primitive().as_object_mut().unwrap().remove("indices");
    assert_eq!(gltf(&file.glb()).unwrap().triangle_count(), 100_000);
    // Each use of a mesh's data counts.
    let primitive = file.primitive().clone();
    file.json["meshes"][0]["primitives"] = Value::Array(vec![primitive; 4]);
    assert!(gltf(&file.glb()).unwrap_err().expected.contains("Limits::vertices"));
    // Placements multiply: 100 primitives at 100 nodes.
    let mut file = GltfBuilder::triangle();
    let primitive = file.primitive().clone();
    file.json["meshes"][0]["primitives"] = Value::Array(vec![primitive; 100]);
    file.json["nodes"] = Value::Array(vec![json!({"mesh": 0}); 100]);
    file.json["scenes"][0]["nodes"] = (0..100).collect();
    assert_eq!(gltf(&file.glb()).unwrap_err().place, "nodes");
    // A deep hierarchy is walked without recursion; deep JSON is refused.
    let mut file = GltfBuilder::triangle();
    let mut nodes: Vec<Value> = (1..4000).map(|child| json!({"children": [child]})).collect();
    nodes.push(json!({"mesh": 0}));
    file.json["nodes"] = Value::Array(nodes);
    assert_eq!(gltf(&file.glb()).unwrap().instances.len(), 1);
    let deep = format!("{{\"asset\":{{\"version\":\"2.0\"}},\"extras\":{}", "[".repeat(100_000));
    assert!(gltf(deep.as_bytes()).is_err());
    let many = format!("{{\"asset\":{{\"version\":\"2.0\"}},\"nodes\":[{{}}{}]}}", ",{}".repeat(100_000));
    assert_eq!(gltf(many.as_bytes()).unwrap_err().place, "JSON");
}

#[test]
fn images_are_measured_before_they_are_decoded() {
    // A header of 30000 x 30000 pixels with nothing behind it.
    let mut image = png(1, 1, [0; 4]);
    image[16..24].copy_from_slice(&[0, 0, 0x75, 0x30, 0, 0, 0x75, 0x30]);
    let mut file = rich();
    let view = file.view(&image);
    file.json["images"][0]["bufferView"] = json!(view);
    assert!(gltf(&file.glb()).is_err());
    // Two textures of 2^20 pixels each are 2^23 bytes.
    let mut file = rich();
    let view = file.view(&png(1024, 1024, [0; 4]));
    file.json["images"][0]["bufferView"] = json!(view);
    let error = gltf(&file.glb()).unwrap_err();
    assert!(error.expected.contains("Limits::texture_bytes"), "{error}");
    let mut file = rich();
    file.json["images"] = Value::Array(vec![file.json["images"][0].clone(); 65]);
    assert_eq!(gltf(&file.glb()).unwrap_err().place, "images");
}

#[test]
fn broken_containers_are_refused() {
    let glb = rich().glb();
    for (range, bytes, place) in [
        (4..8, 3_u32, "byte 4"),
        (8..12, u32::MAX, "byte 8"),
        (12..16, u32::MAX, "byte 12"),
        (16..20, 0, "byte 12"),
        (8..12, 0, "byte 12"),
    ] {
        let mut broken = glb.clone();
        broken[range].copy_from_slice(&bytes.to_le_bytes());
        assert_eq!(gltf(&broken).unwrap_err().place, place);
    }
    for bytes in
        [&b"glTF"[..], b"glTF\x02\0\0\0\x04\0\0\0", b"", b"{", b"[]", b"{}", b"\xef\xbb\xbf{}", b"null"]
    {
        assert!(gltf(bytes).is_err());
    }
}

#[test]
fn truncated_files_are_refused_or_valid() {
    let mut files = vec![("rich.glb".to_owned(), rich().glb()), ("rich.gltf".to_owned(), rich().gltf())];
    for file in ["gltf/sports_car_2.glb", "gltf/clearcoat_test.glb"] {
        files.extend(test_data(file).map(|path| (file.to_owned(), std::fs::read(path).unwrap())));
    }
    let limits = Limits::default();
    for (name, bytes) in files {
        for part in 0..64 {
            let cut = bytes.len() * part / 64;
            let result = checked(gltf_from_bytes(&name, &bytes[..cut], None, &limits));
            assert!(result.is_err(), "{name} cut at {part}/64 is accepted");
        }
    }
    // A text that ends early may still be a scene: it must be a valid one.
    for file in ["obj/sports_car.obj", "obj/teapot.obj"] {
        let Some(path) = test_data(file) else { return };
        let bytes = std::fs::read(path).unwrap();
        let loaded = (0..64).filter(|part| {
            let cut = bytes.len() * part / 64;
            checked(obj_from_bytes(file, &bytes[..cut], None, &limits)).is_ok()
        });
        assert!(loaded.count() > 0, "{file}");
    }
}

#[test]
fn no_path_leaves_the_folder() {
    let outside = empty_folder("escape");
    let folder = outside.join("folder");
    std::fs::create_dir(&folder).unwrap();
    let file = GltfBuilder::triangle();
    std::fs::write(outside.join("secret.bin"), &file.buffer).unwrap();
    std::fs::write(folder.join("inside.bin"), &file.buffer).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(outside.join("secret.bin"), folder.join("link.bin")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(&outside, folder.join("up")).unwrap();
    let load = |uri: &str| {
        let mut json = file.json.clone();
        json["buffers"] = json!([{"uri": uri, "byteLength": file.buffer.len()}]);
        gltf_from_bytes("test.gltf", &serde_json::to_vec(&json).unwrap(), Some(&folder), &LIMITS)
    };
    assert!(load("inside.bin").is_ok() && load("./inside.bin").is_ok() && load("%69nside.bin").is_ok());
    let absolute = outside.join("secret.bin").display().to_string();
    for uri in [
        "../secret.bin",
        "x/../../secret.bin",
        "%2e%2e/secret.bin",
        "..%2fsecret.bin",
        "..\\secret.bin",
        &absolute,
        "/etc/passwd",
        "//etc/passwd",
        "file:///etc/passwd",
        "https://example.org/a.bin",
        "C:\\a.bin",
        "C:a.bin",
        "",
        "inside.bin%00",
        "link.bin",
        "up/secret.bin",
        ".",
        "data:text/plain,abc",
        "data:;base64,%%%",
        "%zz",
        "absent.bin",
    ] {
        let error = load(uri).map(|_| ()).unwrap_err();
        assert_eq!(error.place, "buffers[0].uri", "{uri}: {error}");
    }
    // The same through an OBJ: a warning, and nothing of the file outside.
    std::fs::write(outside.join("secret.mtl"), "newmtl secret\nKd 1 0 0\n").unwrap();
    for library in ["../secret.mtl", "..\\secret.mtl", "up/secret.mtl", "/etc/passwd"] {
        let text = format!("mtllib {library}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl secret\nf 1 2 3\n");
        let scene = obj_from_bytes("test.obj", text.as_bytes(), Some(&folder), &LIMITS).unwrap();
        assert_eq!(scene.materials[0].base_color, glam::Vec4::ONE);
        assert!(scene.warnings[0].message.starts_with("mtllib is ignored"), "{}", scene.warnings[0]);
    }
}

#[test]
fn files_beyond_the_limit_are_not_read() {
    let folder = empty_folder("too_large");
    let path = folder.join("large.obj");
    std::fs::File::create(&path).unwrap().set_len(1 << 40).unwrap();
    let error = load_scene(&path, &Limits::default()).unwrap_err();
    assert!(error.expected.contains("Limits::file_bytes"), "{error}");
    if Path::new("/dev/zero").exists() {
        #[cfg(unix)]
        std::os::unix::fs::symlink("/dev/zero", folder.join("zero.obj")).unwrap();
        assert_eq!(
            load_scene(&folder.join("zero.obj"), &Limits::default()).unwrap_err().expected,
            "a regular file"
        );
    }
}

const OBJ: &str = "mtllib a.mtl\no one\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nv 0.5 0.5 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n\
                   usemtl a\nf 1/1/1 2/2/1 3/3/1\nf 1 2 3 4\nf -1 -2 -3 -4 -5\nusemtl b\nf 1//1 2//1 4//1\n";
const MTL: &str = "newmtl a\nKd 0.1 0.2 0.3\nKs 0.4 0.5 0.6\nKe 1 2 3\nNs 100\nd 0.5\nmap_Kd -s 1 1 1 a.png\nnorm a.png\n\
                   newmtl b\nillum 1\nTr 0.5\nPr 0.5\nPm 1\nmap_Ke a.png\n";
const TOML: &str = "[camera]\neye = [0, 1, 4]\ntarget = [0, 0, 0]\nfov_y_deg = 50\n[[light]]\ndirection = [1, 2, 3]\n\
                    irradiance = [1, 2, 3]\nangular_diameter_deg = 0.5\n[[object]]\nshape = \"box\"\nscale = [1, 2, 3]\n\
                    rotation = [10, 20, 30]\nbase_color = [1, 0.5, 0]\nmetallic = 1\nroughness = 0.5\nks = 0.5\n\
                    shininess = 50\nspread_deg = 3\n[glare]\nthreshold = 1\n";

/// A few bytes of a file replaced, removed, repeated or made extreme.
fn mutated(bytes: &[u8], changes: &[(usize, u8, u8)]) -> Vec<u8> {
    const WORDS: [&[u8]; 8] =
        [b"-1", b"1e39", b"nan", b"4294967295", b"18446744073709551615", b"[", b"\"", b"\xff\xff\xff\xff"];
    let mut bytes = bytes.to_vec();
    for &(place, kind, value) in changes {
        let place = place % bytes.len().max(1);
        let end = (place + 1 + value as usize % 8).min(bytes.len());
        match kind % 5 {
            0 if place < bytes.len() => bytes[place] = value,
            1 => drop(bytes.drain(place..end)),
            2 => {
                let piece = bytes[place..end].to_vec();
                bytes.splice(place..place, piece);
            }
            3 => drop(bytes.splice(place..end, WORDS[value as usize % 8].iter().copied())),
            _ => bytes.truncate(bytes.len() - value as usize % 4),
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

fn changes() -> impl Strategy<Value = Vec<(usize, u8, u8)>> {
    prop::collection::vec((any::<usize>(), any::<u8>(), any::<u8>()), 1..6)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

    #[test]
    fn mutated_glb(changes in changes()) {
        let _ = gltf(&mutated(&rich().glb(), &changes));
    }

    #[test]
    fn mutated_gltf(changes in changes()) {
        let _ = gltf(&mutated(&rich().gltf(), &changes));
    }

    /// Numbers of the JSON replaced by others, so that the file stays readable and lies.
    #[test]
    fn lying_numbers(changes in prop::collection::vec((any::<usize>(), 0_usize..12), 1..4)) {
        const NUMBERS: [f64; 12] = [-1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 11.0, 255.0, 65536.0, 5123.0, 4294967295.0, 1e39];
        let mut file = rich();
        for (place, number) in changes {
            let mut numbers = Vec::new();
            collect_numbers(&mut file.json, &mut numbers);
            let count = numbers.len();
            let number = NUMBERS[number];
            *numbers[place % count] = if number.fract() == 0.0 && number.abs() < 1e18 { json!(number as i64) } else { json!(number) };
        }
        let _ = gltf(&file.glb());
    }

    #[test]
    fn mutated_obj(changes in changes()) {
        let _ = obj(&mutated(OBJ.as_bytes(), &changes));
    }

    /// Statements of any words, most of them right, so that many texts get as far as tobj.
    #[test]
    fn random_obj(lines in prop::collection::vec((0_usize..16, prop::collection::vec(0_usize..24, 0..7)), 0..24)) {
        const KEYWORDS: [&str; 16] =
            ["f", "f", "f", "f", "f", "v", "vt", "vn", "l", "p", "o", "g", "usemtl", "newmtl", "#", "vp"];
        const WORDS: [&str; 24] =
            ["1", "1", "2", "2", "3", "-1", "-2", "-3", "1/1", "1/1/1", "2/1", "2//1", "3//1", "-1/-1/-1", "3/", "+3",
             "0", "9", "1/9", "0.5", "1e-40", "-0", "\u{a0}", "\\\n"];
        let mut text = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1 2 3\n");
        for (keyword, words) in lines {
            text += KEYWORDS[keyword];
            for word in words {
                text += " ";
                text += WORDS[word];
            }
            text += "\n";
        }
        let _ = obj(text.as_bytes());
    }

    #[test]
    fn mutated_toml(changes in changes()) {
        let _ = toml(&String::from_utf8_lossy(&mutated(TOML.as_bytes(), &changes)));
    }
}

#[test]
fn the_texts_that_are_mutated_are_valid() {
    assert_eq!(obj(OBJ.as_bytes()).unwrap().triangle_count(), 7);
    assert_eq!(toml(TOML).unwrap().instances.len(), 1);
}

#[test]
fn mutated_mtl() {
    let folder = empty_folder("mutated_mtl");
    std::fs::write(folder.join("a.png"), png(1, 1, [1, 2, 3, 4])).unwrap();
    let load = |mtl: &[u8]| {
        std::fs::write(folder.join("a.mtl"), mtl).unwrap();
        checked(obj_from_bytes("test.obj", OBJ.as_bytes(), Some(&folder), &LIMITS)).unwrap()
    };
    let valid = load(MTL.as_bytes());
    assert_eq!(
        (valid.warnings.len(), valid.textures.len(), valid.materials.len()),
        (2, 2, 2),
        "{:?}",
        valid.warnings
    );
    proptest!(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) }, |(changes in changes())| {
        load(&mutated(MTL.as_bytes(), &changes));
    });
}

fn collect_numbers<'a>(json: &'a mut Value, numbers: &mut Vec<&'a mut Value>) {
    match json {
        Value::Array(array) => array.iter_mut().for_each(|value| collect_numbers(value, numbers)),
        Value::Object(object) => object.values_mut().for_each(|value| collect_numbers(value, numbers)),
        Value::Number(_) => numbers.push(json),
        _ => {}
    }
}
