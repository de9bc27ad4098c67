//! What rays meet: against brute force, on edges and corners, at every scale.

use glam::{DVec3, Mat4, Vec3};
use scene::{HeightMap, HeightRef, Instance, Material, Mesh, Scene, shapes};

use super::*;
use crate::random::Random;

/// Every triangle is opaque.
struct Opaque;

impl RayFilter for Opaque {
    fn is_present(&self, _: &Ray, _: &Hit) -> bool {
        true
    }
}

fn scene_of(mesh: Mesh, world_from_local: Mat4, double_sided: bool) -> Scene {
    let instance = Instance { name: String::new(), mesh: 0, material: 0, world_from_local };
    let material = Material { double_sided, ..Material::default() };
    Scene { meshes: vec![mesh], materials: vec![material], instances: vec![instance], ..Scene::default() }
}

fn geometry_of(mesh: Mesh, world_from_local: Mat4, double_sided: bool) -> Geometry {
    Geometry::new(&scene_of(mesh, world_from_local, double_sided)).unwrap()
}

fn endless(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction: direction.normalize(), length: f64::INFINITY, key: 0 }
}

/// A point in the cube of the given half side.
fn point(random: &mut Random, half: f64) -> DVec3 {
    let [x, y, z] = random.triple();
    (DVec3::new(x, y, z) * 2.0 - 1.0) * half
}

/// Triangles of all sizes and shapes, needles and coplanar ones among them.
fn soup(count: u32) -> Mesh {
    let mut random = Random::new(1, 2, 3);
    let mut mesh = Mesh::default();
    for index in 0..count {
        let center = point(&mut random, 1.0);
        let size = 10.0_f64.powf(-3.0 * random.one());
        for corner in 0..3 {
            let mut offset = point(&mut random, size);
            if index % 7 == 0 {
                offset.y *= 1e-4;
            }
            if index % 11 == 0 && corner == 2 {
                offset = DVec3::ZERO;
            }
            mesh.positions.push((center + offset).as_vec3());
        }
        mesh.triangles.push([3 * index, 3 * index + 1, 3 * index + 2]);
    }
    mesh.fill_normals();
    mesh
}

#[test]
fn the_hierarchy_finds_what_trying_every_triangle_finds() {
    for double_sided in [true, false] {
        let geometry = geometry_of(soup(2000), Mat4::IDENTITY, double_sided);
        let extent = 2.0_f64.powi(30);
        let mut random = Random::new(0, 0, 0);
        let mut hits = 0;
        for _ in 0..3000 {
            let (origin, toward) = (point(&mut random, 1.5 * extent), point(&mut random, extent));
            let ray = endless(origin, toward - origin);
            let expected = (0..geometry.triangles.len() as u32)
                .filter_map(|index| {
                    let placed = &geometry.triangles[index as usize];
                    let shear = triangle::Shear::new(ray.origin, ray.direction);
                    let crossing = shear.intersect(&placed.corners, 0.0, f64::INFINITY)?;
                    (crossing.is_front || double_sided).then_some((crossing.distance, index))
                })
                .min_by(|one, other| one.0.total_cmp(&other.0));
            let found = geometry.closest_hit(&ray, &Opaque);
            assert_eq!(found.map(|hit| (hit.distance, hit.triangle)), expected, "{ray:?}");
            let is_occluded = |length| geometry.is_occluded(&Ray { length, ..ray }, &Opaque);
            assert_eq!(is_occluded(f64::INFINITY), expected.is_some());
            if let Some((distance, _)) = expected {
                hits += 1;
                assert!(is_occluded(distance * 1.000_001) && !is_occluded(distance * 0.999_999));
            }
        }
        assert!(hits > 500, "{hits}");
    }
}

#[test]
fn a_hit_lies_on_its_triangle_and_knows_its_side() {
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        normals: vec![Vec3::Z; 3],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let mirrored = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    for (world_from_local, x) in [(Mat4::IDENTITY, 0.25), (mirrored, -0.25)] {
        let geometry = geometry_of(mesh.clone(), world_from_local, true);
        for z in [3.0, -3.0] {
            let target = geometry.space.tracer_from_world(DVec3::new(x, 0.5, 0.0));
            let origin = geometry.space.tracer_from_world(DVec3::new(x, 0.5, z));
            let hit = geometry.closest_hit(&endless(origin, target - origin), &Opaque).unwrap();
            // As in glTF, an instance that mirrors keeps its front where its normals are.
            assert_eq!(hit.is_front, z > 0.0);
            assert_eq!(geometry.point(hit.triangle, hit.barycentric), target);
            assert_eq!(geometry.normal(hit.triangle), DVec3::Z);
            let metres = hit.distance / geometry.space.units_per_metre;
            assert!((metres - 3.0).abs() < 1e-12, "{metres}");
            let single_sided = geometry_of(mesh.clone(), world_from_local, false);
            assert_eq!(
                single_sided.closest_hit(&endless(origin, target - origin), &Opaque).is_some(),
                z > 0.0
            );
        }
    }
}

/// Zeros of both signs, and what becomes zero in f32.
#[test]
fn rays_along_an_axis_are_rays() {
    let geometry = geometry_of(shapes::sphere(16), Mat4::IDENTITY, true);
    let center = geometry.space.tracer_from_world(DVec3::new(0.01, 0.02, 0.03));
    for axis in 0..3 {
        for along in [1.0, -1.0] {
            for [one, other] in [[0.0, -0.0], [-0.0, -0.0], [1e-60, -1e-60], [1e-9, -1e-9]] {
                let mut direction = DVec3::splat(one);
                direction[(axis + 1) % 3] = other;
                direction[axis] = along;
                let ray = Ray { direction, ..endless(center, DVec3::X) };
                let hit = geometry.closest_hit(&ray, &Opaque);
                let metres = hit.map_or(0.0, |hit| hit.distance / geometry.space.units_per_metre);
                assert!((metres - 1.0).abs() < 0.05, "{direction}: {metres}");
            }
        }
    }
}

/// From inside a closed mesh no ray gets out, not even through an edge or a corner; at every
/// scale, far from the world's origin, and wherever inside it begins.
#[test]
fn closed_meshes_have_no_gaps() {
    for scale in [1e-3, 1.0, 1e3, 1e6] {
        for shift in [Vec3::ZERO, Vec3::new(1e6, -1e6, 1e6)] {
            let place =
                Mat4::from_translation(shift) * Mat4::from_scale(Vec3::new(scale, 0.7 * scale, scale));
            for mesh in [shapes::sphere(16), shapes::torus(0.4, 16), shapes::cuboid()] {
                let geometry = geometry_of(mesh.clone(), place, true);
                let inside = |point: Vec3| {
                    // Somewhere below the surface.
                    let ring = Vec3::new(point.x, 0.0, point.z).normalize_or(Vec3::X) * 0.6;
                    let core = if mesh.name == "torus" { ring } else { Vec3::ZERO };
                    let local = core.lerp(point, 0.3).as_dvec3();
                    geometry.space.tracer_from_world(place.as_dmat4().transform_point3(local))
                };
                let mut random = Random::new(9, 9, 9);
                for index in 0..geometry.triangles.len() as u32 {
                    let [a, b, c] = geometry.corners(index);
                    let on_edge = a.lerp(b, random.one());
                    let start = mesh.positions[index as usize % mesh.positions.len()];
                    for target in [a, b, c, (a + b) * 0.5, on_edge, (a + b + c) / 3.0] {
                        for origin in [inside(start), inside(Vec3::new(0.1, 0.2, 0.3))] {
                            let ray = endless(origin, target - origin);
                            let hit = geometry.closest_hit(&ray, &Opaque);
                            let Some(hit) = hit else { panic!("{} {scale} {shift}: {ray:?}", mesh.name) };
                            // A torus has outlines even as seen from inside; there a ray may pass.
                            let beyond = hit.distance / ray.origin.distance(target) - 1.0;
                            assert!(
                                beyond < 1e-9 || mesh.name == "torus",
                                "{} {scale} {shift} {index}: {beyond}",
                                mesh.name
                            );
                        }
                    }
                }
            }
        }
    }
}

/// A ray that leaves a convex body meets nothing, however flat it leaves; one that goes inwards
/// meets the other side and not its own triangle.
#[test]
fn rays_that_leave_a_surface_do_not_meet_it() {
    for scale in [1e-3, 1.0, 1e3, 1e6] {
        for shift in [Vec3::ZERO, Vec3::new(1e6, -1e6, 1e6)] {
            for mesh in [shapes::sphere(16), shapes::cuboid()] {
                let place = Mat4::from_translation(shift) * Mat4::from_scale(Vec3::splat(scale));
                let geometry = geometry_of(mesh, place, true);
                let mut random = Random::new(4, 4, 4);
                for round in 0..4000_u32 {
                    let triangle = round % geometry.triangles.len() as u32;
                    let [u, v, w] = random.triple();
                    let sum = u + v + w;
                    let start = geometry.point(triangle, [u / sum, v / sum, w / sum]);
                    let normal = geometry.normal(triangle);
                    let along = normal.any_orthonormal_vector();
                    // From straight up to a ten-thousandth above the surface.
                    let height = 10.0_f64.powf(-4.0 * random.one());
                    let direction =
                        along.rotate_axis(normal, std::f64::consts::TAU * random.one()) + normal * height;
                    let outward = endless(geometry.origin_above(triangle, start, normal), direction);
                    // The rounding of the corners leaves neighbours a hair out of convex.
                    if height > 1e-3 {
                        assert_eq!(geometry.closest_hit(&outward, &Opaque), None, "{scale} {shift} {height}");
                    }
                    let inward = endless(geometry.origin_above(triangle, start, -normal), -direction);
                    let hit = geometry.closest_hit(&inward, &Opaque).unwrap();
                    assert!(hit.triangle != triangle && hit.distance > 0.0);
                }
            }
        }
    }
}

#[test]
fn small_things_in_a_wide_scene_are_found_from_nearby() {
    let mut scene = scene_of(shapes::sphere(64), Mat4::from_translation(Vec3::Y), true);
    scene.meshes.push(shapes::plane(1));
    let world_from_local = Mat4::from_scale(Vec3::splat(1e6));
    scene.instances.push(Instance { name: String::new(), mesh: 1, material: 0, world_from_local });
    let geometry = Geometry::new(&scene).unwrap();
    let mut random = Random::new(5, 5, 5);
    for _ in 0..2000 {
        let (from, to) = (point(&mut random, 3.0), point(&mut random, 0.5));
        let (from, to) = (DVec3::new(from.x, 3.0, from.z), to + DVec3::Y);
        let [origin, target] = [from, to].map(|position| geometry.space.tracer_from_world(position));
        let hit = geometry.closest_hit(&endless(origin, target - origin), &Opaque).unwrap();
        let metres = hit.distance / geometry.space.units_per_metre;
        assert!(metres < from.distance(to), "{metres}");
    }
}

fn displaced_scene(mesh: Mesh, map: HeightMap, height_scale: f32, uv_scale: [f32; 2]) -> Scene {
    let mut scene = scene_of(mesh, Mat4::IDENTITY, true);
    scene.height_maps.push(map);
    scene.materials[0].height = Some(HeightRef { map: 0, height_scale, uv_scale });
    scene
}

/// A smooth map that wraps.
fn waves(side: u32) -> HeightMap {
    let turn = |index: u32| std::f32::consts::TAU * (index as f32 + 0.5) / side as f32;
    let height = |x, y| 0.5 + 0.3 * turn(x).sin() * (2.0 * turn(y)).cos();
    let heights = (0..side * side).map(|index| height(index % side, index / side)).collect();
    HeightMap { name: "waves".into(), width: side, height: side, heights }
}

/// Straight down on a plane, the distance shows the height that was asked for.
#[test]
fn a_height_field_on_a_plane_has_the_heights_of_its_map() {
    let scene = displaced_scene(shapes::plane(1), waves(32), 0.4, [2.0, 1.0]);
    let geometry = Geometry::new(&scene).unwrap();
    assert_eq!(geometry.triangles.len(), 2 * 64 * 64);
    let mut random = Random::new(6, 6, 6);
    for _ in 0..500 {
        let [u, v] = random.pair();
        let from = DVec3::new(2.0 * u - 1.0, 2.0, 2.0 * v - 1.0);
        let ray = endless(geometry.space.tracer_from_world(from), DVec3::NEG_Y);
        let hit = geometry.closest_hit(&ray, &Opaque).unwrap();
        let height = 2.0 - hit.distance / geometry.space.units_per_metre;
        let turn = std::f64::consts::TAU;
        let expected = 0.4 * (0.5 + 0.3 * (2.0 * turn * u).sin() * (2.0 * turn * v).cos());
        // Bilinear and piecewise linear interpolation of 32 texels a wave.
        assert!((height - expected).abs() < 4e-3, "{u} {v}: {height} {expected}");
    }
}

#[test]
fn a_height_field_follows_a_curved_surface_without_gaps() {
    // A constant height makes the sphere larger, whatever its texture coordinates.
    let flat = HeightMap { name: "flat".into(), width: 4, height: 2, heights: vec![0.5; 8] };
    let larger = Geometry::new(&displaced_scene(shapes::sphere(64), flat, 1.0, [1.0; 2])).unwrap();
    // Waves on a torus, whose seams the map continues.
    let wavy = Geometry::new(&displaced_scene(shapes::torus(0.4, 12), waves(24), 0.05, [3.0, 1.0])).unwrap();
    let mut random = Random::new(7, 7, 7);
    for _ in 0..3000 {
        let toward = point(&mut random, 1.0).normalize();
        let center = larger.space.tracer_from_world(DVec3::ZERO);
        let hit = larger.closest_hit(&endless(center, toward), &Opaque).unwrap();
        let radius = hit.distance / larger.space.units_per_metre;
        assert!((1.498..1.500_001).contains(&radius), "{radius}");
        let core = DVec3::new(toward.x, 0.0, toward.z).normalize_or(DVec3::X) * 0.6;
        let inside = wavy.space.tracer_from_world(core);
        assert!(wavy.closest_hit(&endless(inside, point(&mut random, 1.0)), &Opaque).is_some());
    }
    for index in 0..wavy.triangles.len() as u32 {
        for corner in wavy.corners(index) {
            let core = DVec3::new(corner.x, 0.0, corner.z).normalize() * 0.6 * wavy.space.units_per_metre;
            assert!(wavy.closest_hit(&endless(core, corner - core), &Opaque).is_some());
        }
    }
}

/// Where a map wants more triangles than there may be, it gets fewer, and a warning says so.
#[test]
fn a_height_field_too_fine_is_made_coarser() {
    let map = HeightMap { name: "ramp".into(), width: 1, height: 2, heights: vec![0.0, 1.0] };
    let height = HeightRef { map: 0, height_scale: 1.0, uv_scale: [3e9, 1.0] };
    let mut warnings = Vec::new();
    let segments = displacement::segments(&shapes::plane(1), &height, &map, 1000, &mut warnings);
    // 2 n^2 - 2 triangles more than the two of the plane.
    assert_eq!(segments, 22);
    assert!(warnings.len() == 1 && warnings[0].contains("\"ramp\" wants 65536"), "{warnings:?}");
}

/// The shading normals of a relief are those of its triangles, but for their size.
#[test]
fn the_normals_of_a_height_field_are_those_of_its_surface() {
    for mesh in [shapes::plane(4), shapes::sphere(48), shapes::saddle(32)] {
        let name = mesh.name.clone();
        let geometry = Geometry::new(&displaced_scene(mesh, waves(256), 0.05, [2.0, 2.0])).unwrap();
        let mut worst: f64 = 1.0;
        for (index, id) in geometry.ids.iter().enumerate().step_by(37) {
            let placement = &geometry.placements[id.placement as usize];
            let mesh = &geometry.meshes[placement.mesh];
            let corners = mesh.triangles[id.triangle as usize];
            let smooth: DVec3 =
                corners.iter().map(|&index| placement.normal_world(mesh.normals[index as usize])).sum();
            // Needles at the poles have no normal worth the name.
            let [a, b, c] = geometry.corners(index as u32);
            let is_needle =
                (b - a).cross(c - a).length() < 0.05 * (b - a).length_squared().max((c - a).length_squared());
            if !is_needle {
                worst = worst.min(smooth.normalize().dot(geometry.normal(index as u32)));
            }
        }
        println!("{name}: {:.2} degrees", worst.acos().to_degrees());
        assert!(worst > 4.0_f64.to_radians().cos(), "{name}: {:.2} degrees", worst.acos().to_degrees());
    }
}
