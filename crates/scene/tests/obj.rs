//! Loading OBJ with MTL: real models, and small texts for each feature.
#![allow(clippy::float_cmp, reason = "numbers are expected as they stand in the file")]

mod common;

use std::path::Path;

use common::{empty_folder, load_test_data, png};
use glam::{Vec2, Vec3, Vec4};
use scene::load::{load_scene, obj_from_bytes};
use scene::{AlphaMode, ColorSpace, Error, Limits, Scene};

fn load(text: &str) -> Result<Scene, Error> {
    let scene = obj_from_bytes("test.obj", text.as_bytes(), None, &Limits::default())?;
    scene.check().unwrap();
    Ok(scene)
}

fn messages(scene: &Scene) -> Vec<String> {
    scene.warnings.iter().map(|warning| format!("{}: {}", warning.place, warning.message)).collect()
}

#[test]
fn real_models_have_the_triangles_that_are_stated() {
    for (file, triangles, has_uvs) in [
        ("obj/stanford_bunny.obj", 69451, false),
        ("obj/teapot.obj", 25200, true),
        ("obj/sports_car.obj", 3066, false),
    ] {
        let Some(scene) = load_test_data(file) else { return };
        assert_eq!(scene.triangle_count(), triangles, "{file}");
        let mesh = &scene.meshes[0];
        assert_eq!(!mesh.uvs.is_empty(), has_uvs, "{file}");
        assert_eq!(mesh.tangents.len(), mesh.uvs.len(), "{file}");
    }
    let bunny = load_test_data("obj/stanford_bunny.obj").unwrap();
    let (low, high) = bunny.bounds().unwrap();
    assert!(((high - low).x - 0.16).abs() < 0.01);
}

#[test]
fn the_car_has_its_materials() {
    let Some(car) = load_test_data("obj/sports_car.obj") else { return };
    assert_eq!((car.materials.len(), car.warnings.len()), (7, 0), "{:?}", car.warnings);
    let (low, high) = car.bounds().unwrap();
    assert!(((high - low).max_element() - 3.97).abs() < 0.01);
    let paint = car.materials.iter().find(|material| material.name == "DarkOrange").unwrap();
    assert_eq!(paint.base_color, Vec4::new(0.558547, 0.233238, 0.075635, 1.0));
    assert_eq!((paint.shininess, paint.ks), (Some(96.07843), None), "Ks of 0.5 is Blender's default");
    let alpha = paint.roughness * paint.roughness;
    assert!((2.0 / (alpha * alpha) - 2.0 - 96.07843).abs() < 1e-2);
    assert!(car.instances.iter().all(|instance| instance.material < 7));
}

#[test]
fn corners_may_leave_things_out_and_count_backwards() {
    let scene = load(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.75\nvt 1\nvn 0 0 2\n\
         f 1/1/1 2/2/1 3/1/1\nf -3/-2/-1 -2/-2/-1 -1/-2/-1\nf 1 2 3\nf 1//1 2//1 3//1",
    )
    .unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.triangles.len(), 4);
    assert!(mesh.normals.iter().all(|normal| *normal == Vec3::Z), "{:?}", mesh.normals);
    let uv = |triangle: usize, corner: usize| mesh.uvs[mesh.triangles[triangle][corner] as usize];
    assert_eq!(uv(0, 0), Vec2::new(0.25, 0.25), "v counts from the top row");
    assert_eq!(uv(0, 1), Vec2::new(1.0, 1.0));
    assert_eq!(uv(1, 1), Vec2::new(0.25, 0.25));
    assert_eq!(uv(2, 0), Vec2::ZERO);
    let expected = [
        "object \"test.obj\": 6 texture coordinates that are not finite are set to 0",
        "object \"test.obj\": 3 unusable normals are made from the triangles around them",
    ];
    assert_eq!(messages(&scene), expected);
}

#[test]
fn corners_without_things_leave_other_objects_alone() {
    let scene = load(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 0.5\nvn 1 0 0\no bare\nf 1 2 3\no full\nf 1/1/1 2/1/1 3/1/1\n\
         o mixed\nf 1//1 2 3/1\no bare\nf 3 2 1",
    )
    .unwrap();
    let [bare, full, mixed] = &scene.meshes[..] else { panic!("{}", scene.meshes.len()) };
    assert_eq!((bare.uvs.len(), bare.positions.len(), bare.triangles.len()), (0, 3, 2));
    assert_eq!((full.uvs[2], full.normals[2]), (Vec2::splat(0.5), Vec3::X));
    let corner = |corner: usize| mixed.triangles[0][corner] as usize;
    assert_eq!([0, 1, 2].map(|place| mixed.normals[corner(place)]), [Vec3::X, Vec3::Z, Vec3::Z]);
    assert_eq!([0, 1, 2].map(|place| mixed.uvs[corner(place)]), [Vec2::ZERO, Vec2::ZERO, Vec2::splat(0.5)]);
}

#[test]
fn vertices_may_stand_below_their_faces_and_have_more_numbers() {
    let scene = load("f 1 2 3/1\nv 0 0 0 2\nv 2 0 0 2 2\nv 0 2 0 1 0.5 0\nvt 1 1 1\n").unwrap();
    let mut positions = scene.meshes[0].positions.clone();
    positions.sort_by(|a, b| (a.x, a.y).partial_cmp(&(b.x, b.y)).unwrap());
    assert_eq!(positions, [Vec3::ZERO, 2.0 * Vec3::Y, 2.0 * Vec3::X], "a weight does not divide");
    assert!(messages(&scene).contains(&"line 4: vertex colours are ignored".to_owned()));
}

#[test]
fn polygons_of_three_to_twelve_corners() {
    for corners in 3..=12 {
        let angle = |corner: i32| std::f32::consts::TAU * corner as f32 / corners as f32;
        let line = |corner: i32| format!("v {} {} 0\n", angle(corner).cos(), angle(corner).sin());
        let text: String = (0..corners).map(line).collect();
        let indices: Vec<String> = (1..=corners).map(|corner| corner.to_string()).collect();
        let scene = load(&format!("{text}f {}\n", indices.join(" "))).unwrap();
        assert_eq!(scene.triangle_count(), corners as u64 - 2);
        assert!(scene.meshes[0].normals.iter().all(|normal| normal.z > 0.999));
    }
}

#[test]
fn one_mesh_for_each_object_and_material() {
    let scene = load(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no wheel\nusemtl tyre\nf 1 2 3\nusemtl rim\nf 3 2 1\n\
         usemtl tyre\nf 1 2 3\ng group\ns off\nl 1 2\nf 1 2\nvp 1 1\nf \\\n 1 2 3 # comment\n",
    )
    .unwrap();
    let counts: Vec<(&str, &str, usize)> = scene
        .instances
        .iter()
        .map(|i| {
            (i.name.as_str(), scene.materials[i.material].name.as_str(), scene.meshes[i.mesh].triangles.len())
        })
        .collect();
    assert_eq!(counts, [("test.obj", "default", 1), ("wheel", "tyre", 3), ("wheel", "rim", 1)]);
    let expected = [
        "line 14: points and lines are left out",
        "line 15: faces of fewer than three corners are left out",
        "line 16: a statement that is not about polygons is ignored",
        "material \"tyre\": a material that no library has is replaced by a plain one (and at 1 more place)",
    ];
    assert_eq!(messages(&scene), expected);
}

#[test]
fn errors_name_the_line() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let cases = [
        ("v 0 0\n", "line 1", "\"the end of the line\""),
        ("v 0 0 nan\n", "line 1", "\"nan\""),
        ("v 0 0 1e99\n", "line 1", "\"1e99\""),
        ("v 0 x 0\n", "line 1", "\"x\""),
        ("vt \n", "line 1", "\"the end of the line\""),
        ("vn 1 2\n", "line 1", "\"the end of the line\""),
        ("f 1 2 4\n", "line 4", "position 4"),
        ("f 1/1 2/1 3/1\n", "line 4", "texture coordinate 1"),
        ("f 1//9 2//1 3//1\n", "line 4", "normal 9"),
        ("f 0 1 2\n", "line 4", "\"0\""),
        ("f 1 2 -4\n", "line 4", "\"-4\""),
        ("f 1 2 -9223372036854775808\n", "line 4", "\"-9223372036854775808\""),
        ("f 1 2 4294967296\n", "line 4", "\"4294967296\""),
        ("f 1/2/3/4 2 3\n", "line 4", "\"1/2/3/4\""),
        ("f /1 2 3\n", "line 4", "\"/1\""),
        ("f a b c\n", "line 4", "\"a\""),
        ("", "line 3", "no face with three corners in the whole file"),
    ];
    for (text, place, found) in cases {
        let text = if text.starts_with('v') { text.to_owned() } else { triangle.to_owned() + text };
        let error = load(&text).unwrap_err();
        assert_eq!((error.place.as_str(), error.found.as_str()), (place, found), "{text}");
    }
}

#[test]
fn material_libraries() {
    let folder = empty_folder("obj_materials");
    std::fs::create_dir(folder.join("maps")).unwrap();
    std::fs::write(folder.join("maps/red one.png"), png(1, 1, [255, 0, 0, 255])).unwrap();
    std::fs::write(folder.join("maps/normal.png"), png(1, 1, [128, 128, 255, 255])).unwrap();
    let mtl = "# comment\nnewmtl glass\nKd 0.1 0.2 0.3\nKs 0.9 0.8 0.7\nNs 48\nd 0.25\nKe 1 2 3\n\
               map_Kd maps\\red one.png\nnorm -bm 0.5 maps/normal.png\nmap_Bump maps/red.png\n\
               newmtl matte\nKd 2 0.5 0.5\nKs 1 1 1\nillum 1\nTr 0\nmap_Kd ../outside.png\nNs none\n\
               newmtl physical\nPr 0.3\nPm 0.9\nNs 10\nKs 0 0 0\nKd 0.5\nmap_Ke maps/red one.png\nmap_Kd absent.png\n";
    std::fs::write(folder.join("library.mtl"), mtl).unwrap();
    let obj = "mtllib library.mtl\nmtllib absent.mtl\nmtllib ../library.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n\
               usemtl glass\nf 1 2 3\nusemtl matte\nf 1 2 3\nusemtl physical\nf 1 2 3\n";
    std::fs::write(folder.join("test.obj"), obj).unwrap();
    let scene = load_scene(&folder.join("test.obj"), &Limits::default()).unwrap();
    scene.check().unwrap();

    let [glass, matte, physical] = &scene.materials[..] else { panic!("{}", scene.materials.len()) };
    assert_eq!(glass.base_color, Vec4::new(0.1, 0.2, 0.3, 0.25));
    assert_eq!((glass.alpha_mode, glass.emissive), (AlphaMode::Blend, Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!((glass.ks, glass.shininess), (Some(Vec3::new(0.9, 0.8, 0.7)), Some(48.0)));
    assert!((glass.roughness - 0.2_f32.sqrt()).abs() < 1e-6, "n = 48: alpha^2 = 0.04, r^2 = 0.2");
    let texture =
        |reference: &Option<scene::TextureRef>| &scene.textures[reference.as_ref().unwrap().texture];
    assert_eq!(texture(&glass.base_color_texture).color_space, ColorSpace::Srgb);
    assert_eq!(texture(&glass.base_color_texture).rgba, [255, 0, 0, 255]);
    assert_eq!(texture(&glass.normal_texture).color_space, ColorSpace::Linear);
    assert_eq!((matte.base_color, matte.ks), (Vec4::new(1.0, 0.5, 0.5, 1.0), Some(Vec3::ZERO)));
    assert_eq!(matte.alpha_mode, AlphaMode::Opaque);
    assert_eq!((physical.roughness, physical.metallic, physical.shininess), (0.3, 0.9, None));
    assert_eq!((physical.ks, physical.base_color), (Some(Vec3::ZERO), Vec4::new(0.5, 0.5, 0.5, 1.0)));
    assert_eq!(physical.emissive, Vec3::ONE);
    assert_eq!(texture(&physical.emissive_texture).rgba, [255, 0, 0, 255]);
    assert_eq!(scene.textures.len(), 2, "the red image is used twice");

    let found = messages(&scene).join("\n");
    for expected in [
        "library.mtl line 10: map_Bump is ignored",
        "library.mtl line 16: a texture is ignored: found \"../outside.png\", expected a relative path inside",
        "library.mtl line 17: Ns without a number",
        "library.mtl line 25: a texture is ignored: found \"absent.png\": ",
        "line 2: mtllib is ignored: found \"absent.mtl\": ",
        "line 3: mtllib is ignored: found \"../library.mtl\", expected a relative path inside",
    ] {
        assert!(found.contains(expected), "{expected}\nnot in\n{found}");
    }
}

#[test]
fn vertices_beyond_the_limit_are_refused() {
    let limits = Limits { vertices: 3, triangles: 1, ..Limits::default() };
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let load = |more: &str| obj_from_bytes("test.obj", format!("{text}{more}").as_bytes(), None, &limits);
    assert!(load("f 1 2 3").is_ok());
    assert_eq!(load("v 1 1 1\nf 1 2 3").unwrap_err().expected, "at most 3 (Limits::vertices)");
    assert_eq!(load("f 1 2 3\nf 1 2 3").unwrap_err().expected, "at most 1 (Limits::triangles)");
    // Three positions, of which one corner more makes four vertices.
    let limits = Limits { triangles: 2, ..limits };
    let text = format!("{text}vt 0 0\nf 1 2 3\nf 1/1 2 3\n");
    let error = obj_from_bytes("test.obj", text.as_bytes(), None, &limits).unwrap_err();
    assert_eq!(
        (error.found.as_str(), error.expected.as_str()),
        ("4 vertices", "at most 3 (Limits::vertices)")
    );
    assert!(!scene::load::is_scene(Path::new("x.mtl")) && scene::load::is_scene(Path::new("x.OBJ")));
}

#[test]
fn objects_and_materials_beyond_the_limit_are_refused() {
    let load = |nodes: u64, faces: &str| {
        let limits = Limits { nodes, materials: 2, ..Limits::default() };
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
        obj_from_bytes("test.obj", text.as_bytes(), None, &limits)
            .map_err(|error| (error.place, error.expected))
    };
    let refused = |line: &str, limit: &str| Some((line.to_owned(), format!("at most 2 (Limits::{limit})")));
    assert_eq!(load(2, "f 1 2 3\no a\nf 1 2 3\no test.obj\nf 1 2 3").unwrap().meshes.len(), 2);
    assert_eq!(load(2, "f 1 2 3\no a\nf 1 2 3\no b\nf 1 2 3").err(), refused("line 8", "nodes"));
    assert_eq!(
        load(9, "f 1 2 3\nusemtl a\nf 1 2 3\nusemtl b\nusemtl a\nf 1 2 3").unwrap().materials.len(),
        2
    );
    assert_eq!(
        load(9, "f 1 2 3\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3").err(),
        refused("line 8", "materials")
    );
}
