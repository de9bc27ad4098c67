//! Loading glTF: real models, and one made by hand for each feature.
#![allow(clippy::float_cmp, reason = "numbers are expected as they stand in the file")]

mod common;

use common::{GltfBuilder, base64, empty_folder, load_test_data, png};
use glam::{Mat4, Vec2, Vec3, Vec4};
use scene::load::{gltf_from_bytes, load_scene};
use scene::{AlphaMode, ColorSpace, Light, Limits, Scene, Wrap};
use serde_json::json;

fn warnings(scene: &Scene) -> Vec<String> {
    scene.warnings.iter().map(ToString::to_string).collect()
}

fn close(found: Vec3, expected: Vec3) {
    assert!((found - expected).length() < 1e-5, "found {found}, expected {expected}");
}

/// World positions of an instance.
fn world_positions(scene: &Scene, instance: usize) -> Vec<Vec3> {
    let instance = &scene.instances[instance];
    let positions = scene.meshes[instance.mesh].positions.iter();
    positions.map(|position| instance.world_from_local.transform_point3(*position)).collect()
}

#[test]
fn real_models_have_the_triangles_and_materials_that_are_stated() {
    let models = [
        ("gltf/FlightHelmet/FlightHelmet.gltf", 94722, 6, 15),
        ("gltf/boom_box.glb", 6036, 1, 4),
        ("gltf/sports_car_2.glb", 3148, 6, 0),
        ("gltf/clearcoat_test.glb", 37116, 19, 6),
        ("gltf/shaderball.glb", 88264, 1, 0),
    ];
    for (file, triangles, materials, textures) in models {
        let Some(scene) = load_test_data(file) else { return };
        assert_eq!(scene.triangle_count(), triangles, "{file}");
        assert_eq!(scene.materials.len(), materials, "{file}");
        assert_eq!(scene.textures.len(), textures, "{file}");
        let with_tangents = scene.meshes.iter().all(|mesh| mesh.tangents.len() == mesh.uvs.len());
        assert!(with_tangents, "{file}");
        let expected = if file.contains("shaderball") {
            vec!["the extension FB_ngon_encoding is ignored"]
        } else {
            vec![]
        };
        assert_eq!(
            scene.warnings.iter().map(|warning| &warning.message).collect::<Vec<_>>(),
            expected,
            "{file}"
        );
    }
}

#[test]
fn real_models_have_their_features() {
    let Some(helmet) = load_test_data("gltf/FlightHelmet/FlightHelmet.gltf") else { return };
    let complete = |material: &&scene::Material| {
        material.base_color_texture.is_some()
            && material.normal_texture.is_some()
            && material.metallic_roughness_texture == material.occlusion_texture
            && material.metallic_roughness_texture.is_some()
    };
    assert_eq!(helmet.materials.iter().filter(complete).count(), 6);
    assert_eq!(helmet.materials.iter().filter(|material| material.alpha_mode == AlphaMode::Blend).count(), 1);
    assert_eq!(helmet.textures[0].width, 512);
    let srgb = helmet.textures.iter().filter(|texture| texture.color_space == ColorSpace::Srgb).count();
    assert_eq!(srgb, 5, "one base colour image each, shared by the hose and the rubber");

    let car = load_test_data("gltf/sports_car_2.glb").unwrap();
    let (low, high) = car.bounds().unwrap();
    assert!(((high - low).z - 3.93).abs() < 0.01, "{low} {high}");
    let paint = car.materials.iter().find(|material| material.name == "White").unwrap();
    assert_eq!(paint.clearcoat.factor, 1.0);
    let lamp = car.materials.iter().find(|material| material.name == "Headlights").unwrap();
    assert!(lamp.emissive.max_element() > 10.0, "KHR_materials_emissive_strength: {}", lamp.emissive);

    let coats = load_test_data("gltf/clearcoat_test.glb").unwrap();
    let normal_mapped = coats.materials.iter().filter(|material| material.normal_texture.is_some()).count();
    assert_eq!(normal_mapped, 6);
    let coat_normals =
        coats.materials.iter().filter(|material| material.clearcoat.normal_texture.is_some()).count();
    assert!(
        coat_normals > 0
            && coats.materials.iter().any(|material| material.clearcoat.roughness_texture.is_some())
    );
}

#[test]
fn transforms_multiply_down_the_hierarchy_and_meshes_are_shared() {
    let mut file = GltfBuilder::triangle();
    file.json["nodes"] = json!([
        {"translation": [10, 0, 0], "rotation": [0, 0, 0.70710678, 0.70710678], "children": [1, 2]},
        {"mesh": 0, "scale": [2, 3, 4], "name": "scaled"},
        {"mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1], "name": "mirrored"},
    ]);
    let scene = file.load().unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len(), scene.triangle_count()), (1, 2, 2));
    assert_eq!(scene.instances[0].name, "scaled");
    // A quarter turn about z takes x to y, and y to -x.
    let positions = world_positions(&scene, 0);
    close(positions[1], Vec3::new(10.0, 2.0, 0.0));
    close(positions[2], Vec3::new(7.0, 0.0, 0.0));
    let positions = world_positions(&scene, 1);
    close(positions[1], Vec3::new(10.0, -1.0, 5.0));
    assert!(scene.instances[1].world_from_local.determinant() < 0.0);
    let (low, high) = scene.bounds().unwrap();
    close(low, Vec3::new(7.0, -1.0, 0.0));
    close(high, Vec3::new(10.0, 2.0, 5.0));
}

#[test]
fn lists_strips_and_fans_wind_alike() {
    let corners: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let flat: Vec<f32> = corners.as_flattened().to_vec();
    // mode, index type and indices of the same square, counter-clockwise seen from +z
    let square: [(u32, u32, &[u32]); 4] = [
        (4, 5121, &[0, 1, 2, 2, 1, 3]),
        (4, 5125, &[0, 1, 2, 2, 1, 3]),
        (5, 5123, &[0, 1, 2, 3]),
        (6, 5121, &[0, 1, 3, 2]),
    ];
    for (mode, component, indices) in square {
        let mut file = GltfBuilder::triangle();
        let positions = file.floats("VEC3", &flat);
        let size = [1, 0, 2, 0, 4][component as usize - 5121];
        let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()[..size].to_vec()).collect();
        let indices = file.accessor(component, "SCALAR", indices.len(), &bytes);
        *file.primitive() = json!({"attributes": {"POSITION": positions}, "indices": indices, "mode": mode});
        let scene = file.load().unwrap();
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.triangles.len(), 2, "mode {mode}");
        assert!(mesh.normals.iter().all(|normal| *normal == Vec3::Z), "mode {mode}: {:?}", mesh.normals);
        let corner = |index: u32| mesh.positions[index as usize];
        let area: f32 = mesh
            .triangles
            .iter()
            .map(|t| 0.5 * (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0])).z)
            .sum();
        assert!((area - 1.0).abs() < 1e-6, "mode {mode}: {area}");
    }
    let mut file = GltfBuilder::triangle();
    file.primitive().as_object_mut().unwrap().remove("indices");
    assert_eq!(file.load().unwrap().meshes[0].triangles, [[0, 1, 2]]);
}

#[test]
fn points_lines_and_extras_are_left_out_with_a_warning() {
    let mut file = GltfBuilder::triangle();
    let colors = file.floats("VEC4", &[1.0; 12]);
    let uvs = file.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let primitive = file.primitive().clone();
    file.primitive()["attributes"]["COLOR_0"] = json!(colors);
    file.primitive()["attributes"]["JOINTS_0"] = json!(colors);
    file.primitive()["attributes"]["_CUSTOM"] = json!(colors);
    file.primitive()["attributes"]["TEXCOORD_1"] = json!(uvs);
    file.primitive()["targets"] = json!([{"POSITION": 0}]);
    for mode in [0, 1, 3] {
        let mut lines = primitive.clone();
        lines["mode"] = json!(mode);
        file.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(lines);
    }
    file.json["skins"] = json!([{"joints": [0]}]);
    file.json["animations"] = json!([{"channels": [], "samplers": []}]);
    file.json["extensionsUsed"] = json!(["KHR_materials_clearcoat", "EXT_something"]);
    let scene = file.load().unwrap();
    assert_eq!(scene.triangle_count(), 1);
    let found = warnings(&scene);
    let expected = [
        "test.glb: extensionsUsed[1]: the extension EXT_something is ignored",
        "test.glb: meshes[0].primitives[1]: points and lines are left out (and at 2 more places)",
        "test.glb: meshes[0].primitives[0]: vertex colours are ignored",
        "test.glb: meshes[0].primitives[0]: skinning is ignored",
        "test.glb: meshes[0].primitives[0]: morph targets are ignored",
        "test.glb: animations: 1 animations are ignored",
        "test.glb: skins: 1 skins are ignored: meshes stand in their rest pose",
    ];
    assert_eq!(found, expected);
}

#[test]
fn integer_strided_and_sparse_accessors() {
    let mut file = GltfBuilder::triangle();
    // Positions as signed bytes and normals as normalised ones, interleaved, 8 bytes apart.
    let bytes: [i8; 24] = [0, 0, 0, 9, 0, 0, 127, 9, 1, 0, 0, 9, 0, 0, 127, 9, 0, -2, 0, 9, 0, 0, -128, 9];
    let view = file.view(&bytes.map(|byte| byte as u8));
    file.json["bufferViews"][view]["byteStride"] = json!(8);
    let accessors = file.json["accessors"].as_array_mut().unwrap();
    accessors.push(json!({"bufferView": view, "componentType": 5120, "type": "VEC3", "count": 3}));
    accessors.push(json!({"bufferView": view, "byteOffset": 4, "componentType": 5120, "type": "VEC3", "count": 3, "normalized": true}));
    let uvs = file.accessor(5123, "VEC2", 3, &[0, 0, 255, 255, 255, 255, 0, 0, 0, 128, 0, 64]);
    file.json["accessors"][uvs]["normalized"] = json!(true);
    file.primitive()["attributes"] = json!({"POSITION": 2, "NORMAL": 3, "TEXCOORD_0": uvs});
    let mesh = file.load().unwrap().meshes.remove(0);
    assert_eq!(mesh.positions[..3], [Vec3::ZERO, Vec3::X, Vec3::NEG_Y * 2.0]);
    assert_eq!(mesh.normals[..3], [Vec3::Z, Vec3::Z, Vec3::NEG_Z]);
    assert_eq!(mesh.uvs[..2], [Vec2::new(0.0, 1.0), Vec2::new(1.0, 0.0)]);
    assert!((mesh.uvs[2] - Vec2::new(0.5, 0.25)).length() < 1e-4);
    assert_eq!(mesh.tangents.len(), mesh.positions.len());

    // The third vertex moves by a sparse replacement; without a view the others are zero.
    let mut file = GltfBuilder::triangle();
    let indices = file.view(&[2, 0]);
    let values: Vec<u8> = [7.0_f32, 8.0, 9.0].iter().flat_map(|number| number.to_le_bytes()).collect();
    let values = file.view(&values);
    let sparse = json!({"count": 1, "indices": {"bufferView": indices, "componentType": 5123}, "values": {"bufferView": values}});
    file.json["accessors"][0]["sparse"] = sparse;
    assert_eq!(file.load().unwrap().meshes[0].positions, [Vec3::ZERO, Vec3::X, Vec3::new(7.0, 8.0, 9.0)]);
    file.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let scene = file.load().unwrap();
    assert_eq!(scene.meshes[0].positions, [Vec3::ZERO, Vec3::ZERO, Vec3::new(7.0, 8.0, 9.0)]);
    assert_eq!(scene.warnings[0].message, "1 triangles without area are kept");
}

#[test]
fn missing_and_broken_normals_tangents_and_uvs() {
    let mut file = GltfBuilder::triangle();
    let normals = file.floats("VEC3", &[0.0, 0.0, 2.0, f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let uvs = file.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, f32::INFINITY]);
    let tangents = file.floats("VEC4", &[1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0]);
    file.primitive()["attributes"] =
        json!({"POSITION": 0, "NORMAL": normals, "TEXCOORD_0": uvs, "TANGENT": tangents});
    let scene = file.load().unwrap();
    let mesh = &scene.meshes[0];
    assert!(mesh.normals.iter().all(|normal| *normal == Vec3::Z));
    assert_eq!(mesh.uvs[2], Vec2::ZERO);
    let messages: Vec<&str> = scene.warnings.iter().map(|warning| warning.message.as_str()).collect();
    let expected = [
        "1 texture coordinates that are not finite are set to 0",
        "2 unusable normals are made from the triangles around them",
        "3 tangents are made anew, since some of them are unusable",
    ];
    assert_eq!(messages, expected);

    // Tangents that are there are kept, with the sign of their bitangent.
    let tangents = file.floats("VEC4", &[0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0]);
    file.primitive()["attributes"]["TANGENT"] = json!(tangents);
    let mesh = file.load().unwrap().meshes.remove(0);
    assert!(
        mesh.tangents.iter().all(|tangent| *tangent == Vec4::new(0.0, 1.0, 0.0, -1.0)),
        "{:?}",
        mesh.tangents
    );
}

#[test]
fn materials() {
    let mut file = GltfBuilder::triangle();
    let image = file.view(&png(2, 1, [10, 20, 30, 255]));
    file.json["images"] = json!([{"bufferView": image, "mimeType": "image/png", "name": "grey"}]);
    file.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    file.json["textures"] = json!([{"source": 0, "sampler": 0}, {"source": 0}]);
    let turned = json!({"KHR_texture_transform": {"offset": [0.5, 0.25], "rotation": std::f32::consts::FRAC_PI_2, "scale": [2, 3]}});
    file.json["materials"] = json!([{
        "name": "all of it",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "baseColorTexture": {"index": 0, "extensions": turned},
            "metallicFactor": 0.5, "roughnessFactor": 0.25, "metallicRoughnessTexture": {"index": 1},
        },
        "normalTexture": {"index": 1, "scale": 0.75, "extensions": turned},
        "occlusionTexture": {"index": 1, "strength": 0.5, "texCoord": 1},
        "emissiveTexture": {"index": 1}, "emissiveFactor": [1, 0.5, 0],
        "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": true,
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 8},
            "KHR_materials_clearcoat": {
                "clearcoatFactor": 0.9, "clearcoatTexture": {"index": 1}, "clearcoatRoughnessFactor": 0.2,
                "clearcoatRoughnessTexture": {"index": 1}, "clearcoatNormalTexture": {"index": 0},
            },
        },
    }, {"alphaMode": "BLEND", "pbrMetallicRoughness": {"roughnessFactor": 1.5}}, {}]);
    file.primitive()["material"] = json!(0);
    let scene = file.load().unwrap();
    let spaces: Vec<ColorSpace> = scene.textures.iter().map(|texture| texture.color_space).collect();
    assert_eq!(spaces, [ColorSpace::Srgb, ColorSpace::Linear], "the image is used both ways");
    assert_eq!(
        (scene.textures[0].name.as_str(), scene.textures[0].width, scene.textures[0].height),
        ("grey", 2, 1)
    );
    assert_eq!(scene.textures[0].rgba[..4], [10, 20, 30, 255]);

    let material = &scene.materials[0];
    assert_eq!(material.name, "all of it");
    assert_eq!(material.base_color, Vec4::new(0.1, 0.2, 0.3, 0.4));
    assert_eq!((material.metallic, material.roughness, material.normal_scale), (0.5, 0.25, 0.75));
    assert_eq!(material.emissive, Vec3::new(8.0, 4.0, 0.0));
    assert_eq!(material.alpha_mode, AlphaMode::Mask { cutoff: 0.3 });
    assert!(
        material.double_sided && material.occlusion_texture.is_none() && material.occlusion_strength == 0.5
    );
    let base = material.base_color_texture.as_ref().unwrap();
    assert_eq!((base.texture, base.wrap, base.nearest), (0, [Wrap::Clamp, Wrap::Mirror], true));
    let normal = material.normal_texture.as_ref().unwrap();
    assert_eq!((normal.texture, normal.wrap, normal.nearest), (1, [Wrap::Repeat; 2], false));
    // Counter-clockwise in an image whose v points down: u goes to -v, and v to u.
    for reference in [base, normal] {
        let at = |u: f32, v: f32| reference.texture_from_vertex_uv.transform_point2(Vec2::new(u, v));
        assert!((at(0.0, 0.0) - Vec2::new(0.5, 0.25)).length() < 1e-6);
        assert!((at(1.0, 0.0) - Vec2::new(0.5, 0.25 - 2.0)).length() < 1e-6, "{}", at(1.0, 0.0));
        assert!((at(0.0, 1.0) - Vec2::new(0.5 + 3.0, 0.25)).length() < 1e-6, "{}", at(0.0, 1.0));
    }
    let coat = &material.clearcoat;
    assert_eq!((coat.factor, coat.roughness), (0.9, 0.2));
    assert!(
        [&coat.texture, &coat.roughness_texture, &coat.normal_texture].iter().all(|t| t
            .as_ref()
            .unwrap()
            .texture
            == 1)
    );

    assert_eq!((scene.materials[1].alpha_mode, scene.materials[1].roughness), (AlphaMode::Blend, 1.0));
    assert_eq!((scene.materials[2].metallic, scene.materials[2].roughness), (1.0, 1.0), "glTF's defaults");
    let messages: Vec<&str> = scene.warnings.iter().map(|warning| warning.message.as_str()).collect();
    let expected = [
        "occlusionTexture uses TEXCOORD_1; only set 0 is read, and the texture is left out",
        "roughnessFactor 1.5 is outside 0..1 and is clamped",
    ];
    assert_eq!(messages, expected);
}

#[test]
fn a_primitive_without_material_gets_gltfs_default() {
    let scene = GltfBuilder::triangle().load().unwrap();
    assert_eq!(scene.materials.len(), 1);
    let material = &scene.materials[scene.instances[0].material];
    assert_eq!((material.metallic, material.roughness, material.base_color), (1.0, 1.0, Vec4::ONE));
}

#[test]
fn lights_and_cameras() {
    let mut file = GltfBuilder::triangle();
    let quarter_about_y = [0.0, 0.70710678, 0.0, 0.70710678];
    file.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "directional", "color": [1, 0.5, 0.25], "intensity": 4},
        {"type": "point", "intensity": 100, "range": 20},
        {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.2}},
    ]}});
    file.json["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    file.json["cameras"] = json!([
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 9}},
        {"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}},
    ]);
    let light = |index: u32| json!({"KHR_lights_punctual": {"light": index}});
    file.json["nodes"] = json!([
        {"mesh": 0},
        {"rotation": quarter_about_y, "extensions": light(0)},
        {"translation": [1, 2, 3], "extensions": light(1)},
        {"translation": [1, 2, 3], "rotation": quarter_about_y, "extensions": light(2)},
        {"camera": 0},
        {"camera": 1, "translation": [0.3, 0.3, 6]},
    ]);
    file.json["scenes"] = json!([{"nodes": [0, 1, 2, 3, 4, 5]}]);
    let scene = file.load().unwrap();
    // A quarter turn about y takes -z to -x.
    let Light::Directional { direction_world, irradiance, angular_diameter_rad } = scene.lights[0] else {
        panic!()
    };
    close(direction_world, Vec3::X);
    assert_eq!((irradiance, angular_diameter_rad), (Vec3::new(4.0, 2.0, 1.0), 0.0));
    let expected =
        Light::Point { position_world: Vec3::new(1.0, 2.0, 3.0), intensity: Vec3::splat(100.0), range: 20.0 };
    assert_eq!(scene.lights[1], expected);
    let Light::Spot { direction_world, range, inner_angle_rad, outer_angle_rad, .. } = scene.lights[2] else {
        panic!()
    };
    close(direction_world, Vec3::NEG_X);
    assert_eq!((range, inner_angle_rad, outer_angle_rad), (f32::INFINITY, 0.1, 0.2));
    let camera = scene.camera.unwrap();
    assert_eq!((camera.eye, camera.fov_y_rad), (Vec3::new(0.3, 0.3, 6.0), 0.7));
    close(camera.target, Vec3::new(0.3, 0.3, 0.0));
    assert_eq!(scene.warnings[0].message, "a camera that is not perspective is ignored");
}

#[test]
fn buffers_and_images_come_from_the_folder_or_from_inside() {
    let folder = empty_folder("gltf_folder");
    std::fs::create_dir(folder.join("sub")).unwrap();
    let mut file = GltfBuilder::triangle();
    std::fs::write(folder.join("sub/my data.bin"), &file.buffer).unwrap();
    std::fs::write(folder.join("red.png"), png(1, 1, [255, 0, 0, 255])).unwrap();
    file.json["images"] = json!([
        {"uri": "red.png"},
        {"uri": format!("data:image/png;base64,{}", base64(&png(1, 1, [0, 255, 0, 255])))},
    ]);
    file.json["textures"] = json!([{"source": 0}, {"source": 1}]);
    file.json["materials"] = json!([{"emissiveTexture": {"index": 0}, "normalTexture": {"index": 1}}]);
    file.json["buffers"] = json!([{"uri": "sub/my%20data.bin", "byteLength": file.buffer.len()}]);
    let path = folder.join("model.gltf");
    std::fs::write(&path, serde_json::to_vec(&file.json).unwrap()).unwrap();
    let scene = load_scene(&path, &Limits::default()).unwrap();
    scene.check().unwrap();
    assert_eq!((scene.name.as_str(), scene.triangle_count()), ("model.gltf", 1));
    let texture =
        |reference: &Option<scene::TextureRef>| &scene.textures[reference.as_ref().unwrap().texture];
    assert_eq!(texture(&scene.materials[0].emissive_texture).rgba, [255, 0, 0, 255]);
    assert_eq!(texture(&scene.materials[0].normal_texture).rgba, [0, 255, 0, 255]);

    let inside =
        gltf_from_bytes("inside.gltf", &GltfBuilder::triangle().gltf(), None, &Limits::default()).unwrap();
    assert_eq!(inside.meshes[0].positions, scene.meshes[0].positions);
    let error =
        gltf_from_bytes("x.gltf", &std::fs::read(&path).unwrap(), None, &Limits::default()).unwrap_err();
    assert_eq!(error.place, "buffers[0].uri");
}

#[test]
fn a_file_without_scenes_shows_its_topmost_nodes() {
    let mut file = GltfBuilder::triangle();
    file.json.as_object_mut().unwrap().remove("scenes");
    file.json["nodes"] = json!([{"mesh": 0, "name": "child"}, {"children": [0], "translation": [1, 0, 0]}]);
    let scene = file.load().unwrap();
    assert_eq!(scene.instances.len(), 1);
    assert_eq!(scene.instances[0].world_from_local, Mat4::from_translation(Vec3::X));
}

#[test]
fn the_framing_camera_sees_every_corner() {
    for aspect in [0.5, 1.0, 2.0] {
        let mut file = GltfBuilder::triangle();
        file.json["nodes"][0]["translation"] = json!([100, -20, 3]);
        let scene = file.load().unwrap();
        let camera = scene.framing_camera(aspect);
        let backward = (camera.eye - camera.target).normalize();
        let right = camera.up.cross(backward).normalize();
        let up = backward.cross(right);
        let mut widest = 0.0_f32;
        for position in world_positions(&scene, 0) {
            let offset = position - camera.eye;
            let depth = -offset.dot(backward);
            let tan_y = (0.5 * camera.fov_y_rad).tan();
            let reach = (offset.dot(up) / (depth * tan_y))
                .abs()
                .max((offset.dot(right) / (depth * tan_y * aspect)).abs());
            assert!(depth > 0.0 && reach <= 1.0, "{aspect} {reach}");
            widest = widest.max(reach);
        }
        assert!(widest > 0.5, "the scene fills the picture: {widest} at {aspect}");
    }
    let nothing = Scene::default().framing_camera(f32::NAN);
    assert!(nothing.eye.is_finite() && nothing.eye != nothing.target);
}
