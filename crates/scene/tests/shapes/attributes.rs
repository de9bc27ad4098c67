//! Normals and tangents that meshes are given when their file has none.

use std::path::PathBuf;

use glam::{Vec2, Vec3, Vec4};
use proptest::prelude::*;
use scene::{Mesh, shapes};

/// What every mesh must have afterwards.
fn check_attributes(mesh: &Mesh) -> Result<(), TestCaseError> {
    prop_assert_eq!(mesh.normals.len(), mesh.positions.len());
    prop_assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-4));
    if mesh.uvs.is_empty() {
        prop_assert!(mesh.tangents.is_empty());
        return Ok(());
    }
    prop_assert_eq!(mesh.uvs.len(), mesh.positions.len());
    prop_assert_eq!(mesh.tangents.len(), mesh.positions.len());
    for (tangent, normal) in mesh.tangents.iter().zip(&mesh.normals) {
        prop_assert!((tangent.truncate().length() - 1.0).abs() < 1e-4, "{}", tangent);
        prop_assert!(tangent.truncate().dot(*normal).abs() < 1e-3, "{} {}", tangent, normal);
        prop_assert!(tangent.w.abs() == 1.0);
    }
    Ok(())
}

#[test]
fn smooth_normals_of_a_sphere_are_radial_across_its_seam() {
    let mut mesh = shapes::sphere(48);
    mesh.normals.clear();
    mesh.fill_normals();
    let worst = mesh
        .normals
        .iter()
        .zip(&mesh.positions)
        .map(|(normal, position)| normal.angle_between(*position).to_degrees())
        .fold(0.0, f32::max);
    assert!(worst < 0.5, "{worst} degrees");
}

/// The three faces of a cube weigh the same at a corner, whichever diagonals divide them.
#[test]
fn smooth_normals_are_weighted_by_angle() {
    let mut cube = shapes::cuboid();
    cube.normals.clear();
    cube.fill_normals();
    for (normal, position) in cube.normals.iter().zip(&cube.positions) {
        assert!((*normal - position.normalize()).length() < 1e-6, "{normal} {position}");
    }
}

#[test]
fn only_unusable_normals_are_replaced() {
    let mut mesh = shapes::plane(1);
    let given = Vec3::new(0.6, 0.8, 0.0);
    mesh.normals = vec![given, Vec3::ZERO, Vec3::new(f32::NAN, 1.0, 0.0), given * 10.0];
    mesh.fill_normals();
    assert!((mesh.normals[0] - given).length() < 1e-6 && (mesh.normals[3] - given).length() < 1e-6);
    assert_eq!(mesh.normals[1..3], [Vec3::Y; 2]);
}

#[test]
fn flat_normals_are_those_of_the_triangles() {
    let mut mesh = shapes::sphere(5);
    let count = mesh.triangles.len();
    mesh.set_flat_normals();
    assert_eq!((mesh.positions.len(), mesh.uvs.len(), mesh.triangles.len()), (3 * count, 3 * count, count));
    assert!(mesh.tangents.is_empty());
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|index| mesh.positions[index as usize]);
        let own = (b - a).cross(c - a).normalize();
        assert!(triangle.iter().all(|&index| mesh.normals[index as usize].distance(own) < 1e-5));
    }
}

/// Shapes have exact tangents of their own; the made ones must agree.
#[test]
fn made_tangents_of_shapes_are_their_exact_ones() {
    for (mesh, degrees) in [
        (shapes::plane(3), 0.1),
        (shapes::torus(0.3, 64), 2.0),
        (shapes::saddle(64), 2.0),
        (shapes::cuboid(), 0.1),
    ] {
        let mut made = mesh.clone();
        made.tangents.clear();
        made.fill_tangents();
        let mut worst = 0.0_f32;
        for (made_triangle, triangle) in made.triangles.iter().zip(&mesh.triangles) {
            for (&made_index, &index) in made_triangle.iter().zip(triangle) {
                let (tangent, exact) = (made.tangents[made_index as usize], mesh.tangents[index as usize]);
                assert_eq!(tangent.w, exact.w, "{}", mesh.name);
                worst = worst.max(tangent.truncate().angle_between(exact.truncate()).to_degrees());
            }
        }
        println!("{}: {worst} degrees", mesh.name);
        assert!(worst < degrees, "{}: {worst} degrees", mesh.name);
    }
}

/// Two halves of a strip whose images mirror each other share an edge but no tangent.
#[test]
fn a_vertex_whose_triangles_disagree_is_split() {
    let position = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let mut mesh = Mesh {
        positions: vec![
            position(-1.0, 0.0),
            position(0.0, 0.0),
            position(1.0, 0.0),
            position(-1.0, 1.0),
            position(0.0, 1.0),
            position(1.0, 1.0),
        ],
        normals: vec![Vec3::Y; 6],
        uvs: [(0.0, 0.0), (1.0, 0.0), (0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.0, 1.0)].map(Vec2::from).to_vec(),
        triangles: vec![[0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2]],
        ..Mesh::default()
    };
    mesh.fill_tangents();
    assert_eq!(mesh.positions.len(), 8);
    for (triangles, expected) in [(0..2, Vec4::new(1.0, 0.0, 0.0, 1.0)), (2..4, Vec4::new(-1.0, 0.0, 0.0, -1.0))] {
        for triangle in &mesh.triangles[triangles] {
            for &index in triangle {
                assert!((mesh.tangents[index as usize] - expected).length() < 1e-5);
            }
        }
    }
}

#[test]
fn appended_meshes_keep_what_both_have() {
    let mut mesh = shapes::plane(1);
    mesh.append(&shapes::cuboid());
    assert_eq!((mesh.positions.len(), mesh.uvs.len(), mesh.tangents.len()), (28, 28, 28));
    assert_eq!(mesh.triangles[2].iter().min(), Some(&4));
    let bare = Mesh { positions: vec![Vec3::ZERO], normals: vec![Vec3::Y], ..Mesh::default() };
    mesh.append(&bare);
    assert_eq!((mesh.positions.len(), mesh.uvs.len(), mesh.tangents.len()), (29, 0, 0));
}

/// A file that brings tangents brings those of the same algorithm, but for a few vertices that
/// its exporter joined or split otherwise. (With the hand the wrong way round none would agree.)
#[test]
fn made_tangents_of_a_real_file_are_those_it_brings() {
    let root = std::env::var_os("SHEEN_TEST_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")),
        PathBuf::from,
    );
    let folder = root.join("gltf/FlightHelmet");
    let Ok(bytes) = std::fs::read(folder.join("FlightHelmet.gltf")) else {
        println!("skipped: test data absent");
        return;
    };
    let gltf = gltf::Gltf::from_slice(&bytes).unwrap();
    let buffer = std::fs::read(folder.join("FlightHelmet.bin")).unwrap();
    let mut agreeing = 0;
    let mut corners = 0;
    for primitive in gltf.meshes().flat_map(|mesh| mesh.primitives().collect::<Vec<_>>()) {
        let reader = primitive.reader(|_| Some(&buffer));
        let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
        let given = Mesh {
            positions: reader.read_positions().unwrap().map(Vec3::from).collect(),
            normals: reader.read_normals().unwrap().map(Vec3::from).collect(),
            tangents: reader.read_tangents().unwrap().map(Vec4::from).collect(),
            uvs: reader.read_tex_coords(0).unwrap().into_f32().map(Vec2::from).collect(),
            triangles: indices.as_chunks().0.to_vec(),
            ..Mesh::default()
        };
        let mut made = Mesh { tangents: Vec::new(), ..given.clone() };
        made.fill_tangents();
        check_attributes(&made).unwrap();
        for (&made_index, &index) in
            made.triangles.as_flattened().iter().zip(given.triangles.as_flattened())
        {
            let (tangent, given) = (made.tangents[made_index as usize], given.tangents[index as usize]);
            let degrees = tangent.truncate().angle_between(given.truncate()).to_degrees();
            corners += 1;
            agreeing += usize::from(tangent.w == given.w && degrees < 5.0);
        }
    }
    println!("{agreeing} of {corners} corners agree");
    assert!(agreeing as f32 > 0.95 * corners as f32, "{agreeing} of {corners} corners agree");
}

/// A number as hostile files have them.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        8 => -2.0_f32..2.0,
        2 => Just(0.0),
        1 => Just(1.0),
        1 => Just(f32::NAN),
        1 => Just(f32::INFINITY),
        1 => Just(f32::MAX),
        1 => Just(1e-38),
        1 => any::<f32>(),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_mesh_ends_with_usable_normals_and_tangents(
        vertices in prop::collection::vec((number(), number(), number(), number(), number()), 1..12),
        triangles in prop::collection::vec([0_u32..13, 0_u32..13, 0_u32..13], 0..24),
        has_uvs in any::<bool>(),
        normals in prop::collection::vec((number(), number(), number()), 0..14),
        flat in any::<bool>(),
    ) {
        let mut mesh = Mesh {
            positions: vertices.iter().map(|v| Vec3::new(v.0, v.1, v.2)).collect(),
            normals: normals.into_iter().map(Vec3::from).collect(),
            uvs: vertices.iter().filter(|_| has_uvs).map(|v| Vec2::new(v.3, v.4)).collect(),
            triangles,
            ..Mesh::default()
        };
        if flat {
            mesh.set_flat_normals();
        }
        mesh.fill_normals();
        mesh.fill_tangents();
        check_attributes(&mesh)?;
        // A second time nothing is left to do.
        let before = mesh.clone();
        mesh.fill_normals();
        mesh.fill_tangents();
        prop_assert_eq!(mesh.positions.len(), before.positions.len());
        check_attributes(&mesh)?;
    }
}
