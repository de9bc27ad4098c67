//! Loading TOML scene files.
#![allow(clippy::float_cmp, reason = "numbers are expected as they stand in the file")]

mod common;

use std::path::Path;

use common::{GltfBuilder, empty_folder, load_test_data, png, test_data};
use glam::{Vec3, Vec4};
use scene::load::{load_scene, scene_file_from_str};
use scene::{Error, Light, Limits, Scene};
use serde_json::json;

fn load(text: &str) -> Result<Scene, Error> {
    let scene = scene_file_from_str("test.toml", text, None, &Limits::default())?;
    scene.check().unwrap();
    Ok(scene)
}

fn close(found: Vec3, expected: Vec3) {
    assert!((found - expected).length() < 1e-5, "found {found}, expected {expected}");
}

#[test]
fn camera_lights_environment_and_settings() {
    let scene = load(
        "[camera]\neye = [0, 1, 4]\ntarget = [0, 0.5, 0]\nfov_y_deg = 60\n\
         [environment]\nbuiltin = \"studio\"\nintensity = 2\nrotation_deg = 180\n\
         [[light]]\ndirection = [0, 2, 0]\nirradiance = 3\nangular_diameter_deg = 0.5\n\
         [[light]]\ndirection = [1, 0, 0]\nirradiance = [1, 2, 3]\n\
         [glare]\nthreshold = 1.5\n[diffuse-envmap]\nmethod = \"paper\"\n",
    )
    .unwrap();
    let camera = scene.camera.unwrap();
    assert_eq!(
        (camera.eye, camera.target, camera.up),
        (Vec3::new(0.0, 1.0, 4.0), Vec3::new(0.0, 0.5, 0.0), Vec3::Y)
    );
    assert!((camera.fov_y_rad - std::f32::consts::FRAC_PI_3).abs() < 1e-6);
    let environment = scene.environment.unwrap();
    assert_eq!((environment.name.as_str(), environment.intensity), ("studio", 2.0));
    assert!((environment.rotation_rad - std::f32::consts::PI).abs() < 1e-6);
    let Light::Directional { direction_world, irradiance, angular_diameter_rad } = scene.lights[0] else {
        panic!()
    };
    assert_eq!((direction_world, irradiance), (Vec3::Y, Vec3::splat(3.0)));
    assert!((angular_diameter_rad - 0.5_f32.to_radians()).abs() < 1e-7);
    let Light::Directional { irradiance, .. } = scene.lights[1] else { panic!() };
    assert_eq!(irradiance, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(scene.technique_settings["glare"]["threshold"].as_float(), Some(1.5));
    assert_eq!(scene.technique_settings["diffuse-envmap"]["method"].as_str(), Some("paper"));
    assert_eq!(scene.technique_settings.len(), 2);
    assert!(load("").unwrap().instances.is_empty());
}

#[test]
fn every_shape_and_the_order_of_a_transform() {
    for shape in scene::shapes::NAMES {
        let scene = load(&format!("[[object]]\nshape = \"{shape}\"")).unwrap();
        assert!(scene.triangle_count() > 0, "{shape}");
    }
    let text = "[[object]]\nshape = \"sphere\"\nscale = [1, 2, 3]\nrotation = [90, 90, 0]\ntranslation = [10, 0, 0]\n";
    let matrix = load(text).unwrap().instances[0].world_from_local;
    // Scaled first; a quarter turn about x takes y to z; one about y then takes z to x.
    close(matrix.transform_point3(Vec3::Y), Vec3::new(12.0, 0.0, 0.0));
    close(matrix.transform_point3(Vec3::X), Vec3::new(10.0, 0.0, -1.0));
    close(matrix.transform_point3(Vec3::Z), Vec3::new(10.0, -3.0, 0.0));
    let matrix =
        load("[[object]]\nshape = \"box\"\nrotation = [0, 90, 90]").unwrap().instances[0].world_from_local;
    // About y first, which takes x to -z; the turn about z then leaves it there.
    close(matrix.transform_point3(Vec3::X), Vec3::NEG_Z);
    let scene = load("[[object]]\nshape = \"box\"\nscale = -2\n[[object]]\nshape = \"box\"").unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2), "objects share the shape");
    assert!(scene.instances[0].world_from_local.determinant() < 0.0);
}

/// A folder with a glTF whose material has every texture and a light, and a height map.
fn folder_with_model(name: &str) -> std::path::PathBuf {
    let folder = empty_folder(name);
    let mut file = GltfBuilder::triangle();
    let image = file.view(&png(1, 1, [10, 20, 30, 40]));
    file.json["images"] = json!([{"bufferView": image, "mimeType": "image/png"}]);
    file.json["textures"] = json!([{"source": 0}]);
    file.json["materials"] = json!([{"pbrMetallicRoughness": {
        "baseColorFactor": [0.5, 0.5, 0.5, 0.75], "baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0}}}]);
    file.primitive()["material"] = json!(0);
    file.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    file.json["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    file.json["nodes"][0]["translation"] = json!([1, 0, 0]);
    std::fs::write(folder.join("model.glb"), file.glb()).unwrap();
    std::fs::write(folder.join("height.png"), png(4, 4, [255; 4])).unwrap();
    folder
}

fn load_in(folder: &Path, text: &str) -> Result<Scene, Error> {
    let scene = scene_file_from_str("test.toml", text, Some(folder), &Limits::default())?;
    scene.check().unwrap();
    Ok(scene)
}

#[test]
fn objects_of_one_file_share_its_meshes() {
    let folder = folder_with_model("toml_shared");
    std::fs::create_dir(folder.join("scenes")).unwrap();
    let text = "[[object]]\nfile = \"../model.glb\"\n[[object]]\nfile = \"../scenes/../model.glb\"\ntranslation = [0, 5, 0]\nscale = 2\n";
    let scene = load_in(&folder.join("scenes"), text).unwrap();
    assert_eq!(
        (scene.meshes.len(), scene.instances.len(), scene.materials.len(), scene.textures.len()),
        (1, 2, 1, 2)
    );
    close(scene.instances[1].world_from_local.transform_point3(Vec3::ZERO), Vec3::new(2.0, 5.0, 0.0));
    let Light::Point { position_world, .. } = scene.lights[1] else { panic!() };
    close(position_world, Vec3::new(2.0, 5.0, 0.0));
}

#[test]
fn material_keys_replace_values_and_textures() {
    let folder = folder_with_model("toml_overrides");
    let one = |keys: &str| {
        let scene = load_in(
            &folder,
            &format!("[[object]]\nfile = \"model.glb\"\n{keys}\n[[object]]\nfile = \"model.glb\""),
        )
        .unwrap();
        let untouched = &scene.materials[scene.instances[1].material];
        assert!(
            untouched.base_color_texture.is_some()
                && untouched.metallic_roughness_texture.is_some()
                && untouched.height.is_none()
        );
        let material = scene.materials[scene.instances[0].material].clone();
        (scene, material)
    };
    let (_, material) = one("base_color = [1, 0, 0]");
    assert_eq!((material.base_color, material.base_color_texture), (Vec4::new(1.0, 0.0, 0.0, 0.75), None));
    assert!(material.metallic_roughness_texture.is_some());
    let (_, material) = one("base_color = [1, 0, 0, 1]");
    assert_eq!(material.base_color.w, 1.0);

    // Roughness stands in green and metallic in blue: only the replaced one becomes 1.
    let (scene, material) = one("metallic = 0.25");
    assert_eq!(material.metallic, 0.25);
    assert_eq!(scene.textures[material.metallic_roughness_texture.unwrap().texture].rgba, [10, 20, 255, 40]);
    let (scene, material) = one("roughness = 0.25");
    assert_eq!(material.roughness, 0.25);
    assert_eq!(scene.textures[material.metallic_roughness_texture.unwrap().texture].rgba, [10, 255, 30, 40]);
    let (scene, material) = one("roughness = 0.25\nmetallic = 1");
    assert_eq!((material.metallic_roughness_texture, scene.textures.len()), (None, 2));

    let (scene, material) = one(
        "ks = 0.5\nshininess = 100\nspread_deg = 3\nheight_map = \"height.png\"\nheight_scale = 0.1\nuv_scale = [2, 3]",
    );
    assert_eq!(
        (material.ks, material.shininess, material.spread_deg),
        (Some(Vec3::splat(0.5)), Some(100.0), Some(3.0))
    );
    let height = material.height.unwrap();
    assert_eq!((height.map, height.height_scale, height.uv_scale), (0, 0.1, [2.0, 3.0]));
    assert_eq!((scene.height_maps[0].width, scene.height_maps[0].heights[0]), (4, 1.0));
}

#[test]
fn unknown_keys_name_the_nearest_known_one() {
    let cases = [
        ("\n[camra]\n", "line 2", "camra", "camera"),
        ("[camera]\neye = [0, 0, 1]\ntraget = [0, 0, 0]\n", "line 3", "traget", "target"),
        ("[environment]\nbuiltin = \"studio\"\n\nintesity = 1\n", "line 4", "intesity", "intensity"),
        (
            "[[light]]\ndirection = [0, 1, 0]\nirradiance = 1\nangular_diameter = 1\n",
            "line 4",
            "angular_diameter",
            "angular_diameter_deg",
        ),
        (
            "[[object]]\nshape = \"box\"\n[[object]]\nshape = \"box\"\nroughnes = 1\n",
            "line 5",
            "roughnes",
            "roughness",
        ),
        ("[horizon-shadows]\n", "line 1", "horizon-shadows", "horizon-shadow"),
    ];
    for (text, place, unknown, nearest) in cases {
        let error = load(text).unwrap_err();
        assert_eq!((error.file.as_str(), error.place.as_str()), ("test.toml", place), "{error}");
        assert_eq!(error.found, format!("the unknown key `{unknown}`"));
        assert!(error.expected.starts_with(&format!("`{nearest}`, or another of: ")), "{error}");
    }
}

#[test]
fn errors_name_line_and_key() {
    let object = "[[object]]\nshape = \"box\"\n";
    let cases = [
        ("eye = ", "line 1"),
        ("[camera]\neye = [0, 0]\ntarget = [0, 0, 0]", "line 2"),
        ("[camera]\neye = [0, 0, 1]\n", "line 1"),
        ("[camera]\neye = [0, 0, 1]\ntarget = [0, 0, 1]", "line 1, [camera]: eye, target, up"),
        ("[camera]\neye = [0, 1, 0]\ntarget = [0, 0, 0]", "line 1, [camera]: eye, target, up"),
        ("[camera]\neye = [0, 0, 1]\ntarget = [0, 0, 0]\nfov_y_deg = 180", "line 1, [camera]: fov_y_deg"),
        ("[camera]\neye = [0, 0, nan]\ntarget = [0, 0, 0]", "line 1, [camera]: eye"),
        ("[environment]\n", "line 1, [environment]: file or builtin"),
        ("[environment]\nbuiltin = \"moon\"", "line 1, [environment]: builtin"),
        ("[environment]\nbuiltin = \"studio\"\nintensity = -1", "line 1, [environment]: intensity"),
        ("[environment]\nfile = \"sky.hdr\"", "line 1, [environment]: file"),
        ("[[light]]\ndirection = [0, 0, 0]\nirradiance = 1", "line 1, [[light]]: direction"),
        ("[[light]]\ndirection = [0, 0, 1]\nirradiance = [1, 2]", "line 3"),
        ("[[light]]\ndirection = [0, 0, 1]\nirradiance = -1", "line 1, [[light]]: irradiance"),
        ("[[object]]\n", "line 1, [[object]]: file or shape"),
        ("[[object]]\nshape = \"box\"\n\n[[object]]\nshape = \"bx\"", "line 4, [[object]]: shape"),
        ("[[object]]\nfile = \"a.glb\"", "line 1, [[object]]: file"),
        (&format!("{object}file = \"a.glb\""), "line 1, [[object]]: file or shape"),
        (&format!("{object}scale = 0"), "line 1, [[object]]: scale"),
        (&format!("{object}scale = 1e-30"), "line 1, [[object]]: scale"),
        (&format!("{object}scale = \"big\""), "line 3"),
        (&format!("{object}base_color = [1, 1]"), "line 1, [[object]]: base_color"),
        (&format!("{object}base_color = [1, 1, 2]"), "line 1, [[object]]: base_color"),
        (&format!("{object}roughness = 1.01"), "line 1, [[object]]: roughness"),
        (&format!("{object}metallic = nan"), "line 1, [[object]]: metallic"),
        (&format!("{object}spread_deg = 91"), "line 1, [[object]]: spread_deg"),
        (&format!("{object}height_scale = 1"), "line 1, [[object]]: height_scale"),
        (&format!("{object}height_map = \"a.png\""), "line 1, [[object]]: height_map"),
        (&format!("{object}builtin_height_map = \"moon\""), "line 1, [[object]]: builtin_height_map"),
        (
            &format!("{object}height_map = \"a.png\"\nbuiltin_height_map = \"fbm\""),
            "line 1, [[object]]: height_map or builtin_height_map",
        ),
    ];
    for (text, place) in cases {
        let error = load(text).unwrap_err();
        assert_eq!(error.place, place, "{text}\n{error}");
    }
}

#[test]
fn builtin_height_maps_need_no_file() {
    let object = "[[object]]\nshape = \"plane\"\nheight_scale = 0.1\nbuiltin_height_map = ";
    let scene = load(&format!("{object}\"craters\"\n{object}\"fbm\"\n{object}\"craters\"")).unwrap();
    let names: Vec<_> = scene.height_maps.iter().map(|map| map.name.as_str()).collect();
    assert_eq!(names, ["craters", "fbm"]);
    let heights = scene.instances.iter().map(|instance| scene.materials[instance.material].height.clone());
    let maps: Vec<_> = heights.map(|height| height.map(|height| (height.map, height.height_scale))).collect();
    assert_eq!(maps, [Some((0, 0.1)), Some((1, 0.1)), Some((0, 0.1))]);
    let limits = Limits { textures: 1, ..Limits::default() };
    let text = format!("{object}\"craters\"\n{object}\"fbm\"");
    let error = scene_file_from_str("test.toml", &text, None, &limits).unwrap_err();
    assert_eq!(error.place, "line 5, [[object]]: builtin_height_map");
}

#[test]
fn errors_of_a_named_file_name_that_file() {
    let folder = folder_with_model("toml_errors");
    let error = load_in(&folder, "[[object]]\nfile = \"absent.glb\"").unwrap_err();
    assert!(error.file.ends_with("absent.glb") && error.found == "no such file", "{error}");
    let error = load_in(&folder, "[[object]]\nfile = \"other.toml\"").unwrap_err();
    assert_eq!(error.expected, "a model: .gltf, .glb or .obj");
    std::fs::write(folder.join("bad.toml"), b"\xff").unwrap();
    let error = load_scene(&folder.join("bad.toml"), &Limits::default()).unwrap_err();
    assert_eq!(error.place, "byte 0");
    for (file, expected) in [("a.png", "a scene: .toml, .gltf, .glb or .obj"), ("folder.obj", "a file")] {
        let _ = std::fs::create_dir(folder.join("folder.obj"));
        assert_eq!(load_scene(&folder.join(file), &Limits::default()).unwrap_err().expected, expected);
    }
}

#[test]
fn limits_hold_for_all_files_together() {
    let folder = folder_with_model("toml_limits");
    std::fs::copy(folder.join("model.glb"), folder.join("other.glb")).unwrap();
    let text = "[[object]]\nfile = \"model.glb\"\n[[object]]\nfile = \"other.glb\"";
    let limits = Limits { triangles: 1, ..Limits::default() };
    let error = scene_file_from_str("test.toml", text, Some(&folder), &limits).unwrap_err();
    assert!(error.file.ends_with("other.glb"), "{error}");
    let limits = Limits { nodes: 1, ..Limits::default() };
    let error = scene_file_from_str("test.toml", text, Some(&folder), &limits).unwrap_err();
    assert_eq!(error.place, "[[object]]");
}

#[test]
fn a_scene_file_may_point_at_real_files() {
    let Some(car) = test_data("gltf/sports_car_2.glb") else { return };
    let Some(sky) = test_data("hdri/potsdamer_platz_1k.hdr") else { return };
    let text = format!("[environment]\nfile = {sky:?}\n[[object]]\nfile = {car:?}\nrotation = [0, 45, 0]\n");
    let scene = load_in(Path::new("."), &text).unwrap();
    assert_eq!(scene.triangle_count(), load_test_data("gltf/sports_car_2.glb").unwrap().triangle_count());
    assert_eq!(scene.environment.unwrap().width, 1024);
}
