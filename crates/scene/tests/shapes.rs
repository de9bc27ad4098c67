//! Procedural shapes: their topology, orientation, normals, tangents and texture coordinates.

#[path = "shapes/attributes.rs"]
mod attributes;

use std::collections::{HashMap, HashSet};
use std::f32::consts::PI;

use glam::{Vec2, Vec3};
use scene::{Mesh, shapes};

/// Every shape by name, and some of other tessellations and proportions.
fn all_shapes() -> Vec<Mesh> {
    let named = shapes::NAMES.iter().map(|name| shapes::by_name(name).unwrap());
    let others = [
        shapes::sphere(3),
        shapes::torus(0.05, 7),
        shapes::torus(0.49, 40),
        shapes::cylinder(3),
        shapes::superellipsoid(1.0, 1.0, 32),
        shapes::superellipsoid(0.15, 1.0, 32),
        shapes::superellipsoid(1.7, 0.5, 32),
        shapes::teapot(6),
        shapes::plane(5),
        shapes::saddle(3),
    ];
    named.chain(others).collect()
}

fn is_open(mesh: &Mesh) -> bool {
    ["plane", "saddle", "bezier_patch"].contains(&mesh.name.as_str())
}

fn corners(mesh: &Mesh, triangle: [u32; 3]) -> [Vec3; 3] {
    triangle.map(|index| mesh.positions[index as usize])
}

/// The cross product of two sides: the normal with twice the area as its length.
fn area_vector([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a)
}

/// A number for each distinct position, exactly compared.
fn welded(mesh: &Mesh) -> Vec<[usize; 3]> {
    let mut numbers = HashMap::new();
    let number_of: Vec<usize> = mesh
        .positions
        .iter()
        .map(|position| {
            let key = position.to_array().map(|x| (x + 0.0).to_bits());
            let next = numbers.len();
            *numbers.entry(key).or_insert(next)
        })
        .collect();
    mesh.triangles.iter().map(|triangle| triangle.map(|index| number_of[index as usize])).collect()
}

/// Signed volume that the triangles enclose.
fn volume(mesh: &Mesh) -> f32 {
    mesh.triangles
        .iter()
        .map(|&triangle| corners(mesh, triangle).map(Vec3::as_dvec3_pair))
        .map(|[a, b, c]| triple(a, b, c) / 6.0)
        .sum::<f64>() as f32
}

/// Single to double precision, which volumes of many small triangles need.
trait Double {
    fn as_dvec3_pair(self) -> [f64; 3];
}

impl Double for Vec3 {
    fn as_dvec3_pair(self) -> [f64; 3] {
        self.to_array().map(f64::from)
    }
}

fn triple(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

#[test]
fn names_and_shapes_agree() {
    for name in shapes::NAMES {
        assert_eq!(shapes::by_name(name).unwrap().name, name);
    }
    assert!(shapes::by_name("dodecahedron").is_none());
}

#[test]
fn tessellation_is_clamped_to_its_range() {
    assert_eq!(shapes::sphere(0).triangles.len(), shapes::sphere(3).triangles.len());
    assert_eq!(shapes::plane(u32::MAX).triangles.len(), 2 * 1024 * 1024);
    assert_eq!(shapes::torus(f32::INFINITY, 3).positions, shapes::torus(0.49, 3).positions);
}

#[test]
fn vertex_arrays_fit_and_every_vertex_is_used() {
    for mesh in all_shapes() {
        let count = mesh.positions.len();
        assert_eq!([mesh.normals.len(), mesh.uvs.len(), mesh.tangents.len()], [count; 3], "{}", mesh.name);
        let used: HashSet<u32> = mesh.triangles.as_flattened().iter().copied().collect();
        assert_eq!(used.len(), count, "{}", mesh.name);
        assert!(used.iter().all(|&index| (index as usize) < count), "{}", mesh.name);
        for (normal, tangent) in mesh.normals.iter().zip(&mesh.tangents) {
            assert!((normal.length() - 1.0).abs() < 1e-5, "{}: {normal}", mesh.name);
            assert!((tangent.truncate().length() - 1.0).abs() < 1e-5, "{}: {tangent}", mesh.name);
            assert!(tangent.truncate().dot(*normal).abs() < 1e-5, "{}: {tangent}", mesh.name);
            assert!(tangent.w == 1.0, "{}", mesh.name);
        }
        assert!(mesh.uvs.iter().all(|uv| uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all()));
    }
}

#[test]
fn no_triangle_is_degenerate() {
    for mesh in all_shapes() {
        for &triangle in &mesh.triangles {
            let corners = corners(&mesh, triangle);
            let longest = (0..3).map(|i| corners[i].distance(corners[(i + 1) % 3])).fold(0.0, f32::max);
            // The height over the longest side, relative to it.
            let height = area_vector(corners).length() / (longest * longest);
            assert!(height > 1e-4, "{}: {corners:?}", mesh.name);
        }
    }
}

/// In a closed surface each edge is used once in each direction.
#[test]
fn closed_shapes_are_closed_and_of_the_right_genus() {
    for mesh in all_shapes().iter().filter(|mesh| !is_open(mesh)) {
        let triangles = welded(mesh);
        let mut edges = HashSet::new();
        for [a, b, c] in &triangles {
            for edge in [(*a, *b), (*b, *c), (*c, *a)] {
                assert!(edges.insert(edge), "{}: an edge twice in one direction", mesh.name);
            }
        }
        assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))), "{}: an open edge", mesh.name);
        let vertices = triangles.as_flattened().iter().collect::<HashSet<_>>().len();
        let euler = vertices as i64 - edges.len() as i64 / 2 + triangles.len() as i64;
        // Two for each closed part without a hole; the teapot has three parts.
        let expected = match mesh.name.as_str() {
            "torus" => 0,
            "teapot" => 6,
            _ => 2,
        };
        assert_eq!(euler, expected, "{}", mesh.name);
    }
}

#[test]
fn volumes_are_those_of_the_solids() {
    let tube = 0.3;
    for (mesh, expected) in [
        (shapes::sphere(200), 4.0 / 3.0 * PI),
        (shapes::torus(tube, 200), 2.0 * PI * PI * (1.0 - tube) * tube * tube),
        (shapes::cylinder(400), 2.0 * PI),
        (shapes::cuboid(), 8.0),
        (shapes::superellipsoid(1.0, 1.0, 200), 4.0 / 3.0 * PI),
        (shapes::superellipsoid(2.0, 2.0, 200), 4.0 / 3.0),
        // Across y a superellipsoid (1, e) is the turned curve r^(2/e) + y^(2/e) = 1.
        (shapes::superellipsoid(1.0, 0.5, 200), PI * 1.748_038_4),
    ] {
        let found = volume(&mesh);
        println!("{}: {found}, {expected}", mesh.name);
        assert!((found / expected - 1.0).abs() < 5e-4, "{}: {found} {expected}", mesh.name);
    }
    for mesh in all_shapes().iter().filter(|mesh| !is_open(mesh)) {
        assert!(volume(mesh) > 0.0, "{}", mesh.name);
    }
}

#[test]
fn shapes_are_unit_sized() {
    for name in shapes::NAMES {
        let (least, most) = shapes::by_name(name).unwrap().bounds().unwrap();
        let expected = match name {
            "plane" => Some((Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 0.0, 1.0))),
            "torus" => Some((Vec3::new(-1.0, -0.3, -1.0), Vec3::new(1.0, 0.3, 1.0))),
            "saddle" => Some((Vec3::new(-1.0, -0.5, -1.0), Vec3::new(1.0, 0.5, 1.0))),
            "bezier_patch" | "teapot" => None,
            _ => Some((Vec3::NEG_ONE, Vec3::ONE)),
        };
        match expected {
            Some((low, high)) => {
                assert!((least - low).abs().max_element() < 1e-5, "{name}: {least}");
                assert!((most - high).abs().max_element() < 1e-5, "{name}: {most}");
            }
            None => assert!(least.min_element() > -1.1 && most.max_element() < 1.1, "{name}: {least} {most}"),
        }
    }
    let (least, most) = shapes::teapot(16).bounds().unwrap();
    println!("teapot: {least} {most}");
    assert_eq!((least.y, most.y), (0.0, 1.02));
}

/// A patch whose control points alternate in height.
fn rolling_patch() -> [[Vec3; 4]; 4] {
    let point = |row: usize, column: usize| {
        let height = if (row + column) % 2 == 0 { 0.5 } else { -0.5 };
        Vec3::new(column as f32 * 0.5 - 0.75, height, row as f32 * 0.5 - 0.75)
    };
    std::array::from_fn(|row| std::array::from_fn(|column| point(row, column)))
}

/// On a fine mesh, a triangle's own normal is nearly its vertices' normal: everywhere, except at
/// the edges of a pinched superellipsoid, whose curvature has no bound.
#[test]
fn normals_are_those_of_the_surface() {
    for (mesh, mean_degrees, worst_degrees) in [
        (shapes::sphere(256), 0.5, 0.6),
        (shapes::torus(0.3, 256), 0.8, 1.0),
        (shapes::cylinder(512), 0.5, 0.6),
        (shapes::saddle(256), 0.5, 0.6),
        (shapes::plane(4), 0.01, 0.01),
        (shapes::cuboid(), 0.01, 0.01),
        (shapes::superellipsoid(0.4, 0.4, 512), 0.3, 1.0),
        (shapes::superellipsoid(1.6, 1.3, 512), 0.3, 20.0),
        (shapes::bezier_patch("patch", &rolling_patch(), 256), 0.5, 2.0),
        (shapes::teapot(64), 1.0, 8.0),
    ] {
        let (mut sum, mut worst) = (0.0, 0.0_f32);
        for &triangle in &mesh.triangles {
            let own = area_vector(corners(&mesh, triangle)).normalize();
            for index in triangle {
                let angle = own.angle_between(mesh.normals[index as usize]).to_degrees();
                sum += angle;
                worst = worst.max(angle);
            }
        }
        let mean = sum / (3 * mesh.triangles.len()) as f32;
        println!("{}: mean {mean}, at most {worst} degrees", mesh.name);
        assert!(mean < mean_degrees && worst < worst_degrees, "{}: {mean}, {worst} degrees", mesh.name);
    }
}

/// The change of position with u and v over a triangle runs along tangent and bitangent.
#[test]
fn tangents_follow_u_and_bitangents_run_against_v() {
    for mesh in all_shapes() {
        for &triangle in &mesh.triangles {
            let [a, b, c] = corners(&mesh, triangle);
            let [ua, ub, uc] = triangle.map(|index| mesh.uvs[index as usize]);
            let determinant = (ub - ua).perp_dot(uc - ua);
            // u runs right and v down, so counter-clockwise corners turn the other way in uv.
            assert!(determinant < 0.0, "{}: mirrored texture coordinates", mesh.name);
            let along_u = ((b - a) * (uc.y - ua.y) - (c - a) * (ub.y - ua.y)) / determinant;
            let along_v = ((c - a) * (ub.x - ua.x) - (b - a) * (uc.x - ua.x)) / determinant;
            for index in triangle {
                let (normal, tangent) = (mesh.normals[index as usize], mesh.tangents[index as usize]);
                let bitangent = tangent.w * normal.cross(tangent.truncate());
                assert!(along_u.dot(tangent.truncate()) > 0.0, "{}: {:?}", mesh.name, corners(&mesh, triangle));
                assert!(along_v.dot(bitangent) < 0.0, "{}: {:?}", mesh.name, corners(&mesh, triangle));
            }
        }
    }
}
