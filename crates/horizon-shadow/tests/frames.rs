//! Frames of vertices against the smooth surfaces that the meshes approximate.

#![allow(clippy::float_cmp, reason = "exact values are what is tested")]

use glam::{DVec3, Vec3};
use horizon_shadow::{
    Error, VertexFrame,
    frames::{needed_azimuths, surface, vertex_frames},
};
use scene::{Mesh, shapes};
use std::f64::consts::{PI, TAU};

/// A mesh and the surface it approximates.
struct Shape {
    name: &'static str,
    mesh: fn(u32) -> Mesh,
    point: fn(f64, f64) -> DVec3,
    /// Where the surface is smooth.
    is_inside: fn(f64, f64) -> bool,
}

const CONTROL: [[Vec3; 4]; 4] = [
    [control(0, 0, 0.3), control(1, 0, -0.5), control(2, 0, 0.4), control(3, 0, 0.1)],
    [control(0, 1, -0.4), control(1, 1, 0.8), control(2, 1, -0.5), control(3, 1, 0.3)],
    [control(0, 2, 0.3), control(1, 2, -0.5), control(2, 2, 0.9), control(3, 2, -0.6)],
    [control(0, 3, -0.1), control(1, 3, 0.5), control(2, 3, -0.4), control(3, 3, 0.4)],
];

const fn control(column: u8, row: u8, height: f32) -> Vec3 {
    Vec3::new(column as f32 / 1.5 - 1.0, height, row as f32 / 1.5 - 1.0)
}

fn bezier(u: f64, v: f64) -> DVec3 {
    let weights = |t: f64| {
        let s = 1.0 - t;
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
    };
    let row = |row: &[Vec3; 4]| row.iter().zip(weights(u)).map(|(p, w)| p.as_dvec3() * w).sum::<DVec3>();
    CONTROL.iter().zip(weights(v)).map(|(points, w)| row(points) * w).sum()
}

fn around(turn: f64) -> DVec3 {
    let (sin, cos) = (TAU * turn).sin_cos();
    DVec3::new(sin, 0.0, cos)
}

const SHAPES: [Shape; 6] = [
    Shape {
        name: "plane",
        mesh: shapes::plane,
        point: |u, v| DVec3::new(2.0 * u - 1.0, 0.0, 2.0 * v - 1.0),
        is_inside: |_, _| true,
    },
    Shape {
        name: "sphere",
        mesh: shapes::sphere,
        point: |u, v| around(u) * (PI * v).sin() + DVec3::Y * (PI * v).cos(),
        // Near the poles u has hardly a length.
        is_inside: |_, v| (0.1..=0.9).contains(&v),
    },
    Shape {
        name: "cylinder",
        mesh: |segments| {
            let mut mesh = shapes::cylinder(4 * segments);
            // The wall alone: the discs come after it, and have other texture coordinates.
            mesh.triangles.truncate(8 * segments as usize);
            mesh
        },
        point: |u, v| around(u) + DVec3::Y * (1.0 - 2.0 * v),
        is_inside: |_, _| true,
    },
    Shape {
        name: "torus",
        mesh: |segments| shapes::torus(0.3, segments),
        point: |u, v| {
            let (sin, cos) = (TAU * v).sin_cos();
            around(u) * (0.7 + 0.3 * sin) + DVec3::Y * (0.3 * cos)
        },
        is_inside: |_, _| true,
    },
    Shape {
        name: "saddle",
        mesh: shapes::saddle,
        point: |u, v| {
            let (x, z) = (2.0 * u - 1.0, 2.0 * v - 1.0);
            DVec3::new(x, (x * x - z * z) / 2.0, z)
        },
        is_inside: |_, _| true,
    },
    Shape {
        name: "bezier_patch",
        mesh: |segments| shapes::bezier_patch("patch", &CONTROL, segments),
        point: bezier,
        is_inside: |_, _| true,
    },
];

/// Directions of u and v, and the second fundamental form, of the smooth surface.
fn exact(point: fn(f64, f64) -> DVec3, u: f64, v: f64) -> ([DVec3; 2], DVec3) {
    const STEP: f64 = 1e-4;
    let p = |i: f64, j: f64| point(u + i * STEP, v + j * STEP);
    let along_u = (p(1.0, 0.0) - p(-1.0, 0.0)) / (2.0 * STEP);
    let along_v = (p(0.0, 1.0) - p(0.0, -1.0)) / (2.0 * STEP);
    let square = STEP * STEP;
    let uu = (p(1.0, 0.0) + p(-1.0, 0.0) - 2.0 * p(0.0, 0.0)) / square;
    let vv = (p(0.0, 1.0) + p(0.0, -1.0) - 2.0 * p(0.0, 0.0)) / square;
    let uv = (p(1.0, 1.0) - p(1.0, -1.0) - p(-1.0, 1.0) + p(-1.0, -1.0)) / (4.0 * square);
    let normal = along_v.cross(along_u).normalize();
    ([along_u, along_v], -DVec3::new(normal.dot(uu), normal.dot(uv), normal.dot(vv)))
}

fn frames_of(mesh: &Mesh) -> Vec<VertexFrame> {
    let (positions, normals, uvs) = arrays(mesh);
    vertex_frames(&positions, &normals, &uvs, &mesh.triangles).unwrap()
}

/// Positions, normals and texture coordinates.
type Arrays = (Vec<[f32; 3]>, Vec<[f32; 3]>, Vec<[f32; 2]>);

fn arrays(mesh: &Mesh) -> Arrays {
    let array = |values: &[Vec3]| values.iter().map(Vec3::to_array).collect();
    (array(&mesh.positions), array(&mesh.normals), mesh.uvs.iter().map(glam::Vec2::to_array).collect())
}

fn vector(values: [f32; 3]) -> DVec3 {
    DVec3::from_array(values.map(f64::from))
}

/// Largest errors of a mesh, inside and where its texture coordinates end.
#[derive(Debug, Default)]
struct Errors {
    /// Normal curvatures, 1 / metre.
    curvature: [f64; 2],
    /// Directions of u and v over their lengths.
    direction: [f64; 2],
}

fn errors(shape: &Shape, segments: u32) -> Errors {
    let mesh = (shape.mesh)(segments);
    let frames = frames_of(&mesh);
    let mut used = vec![false; frames.len()];
    mesh.triangles.as_flattened().iter().for_each(|&index| used[index as usize] = true);
    let mut errors = Errors::default();
    for (index, (uv, frame)) in mesh.uvs.iter().zip(&frames).enumerate() {
        let (u, v) = (f64::from(uv.x), f64::from(uv.y));
        if !used[index] || !(shape.is_inside)(u, v) {
            continue;
        }
        let ([along_u, along_v], form) = exact(shape.point, u, v);
        let (e, g) = (along_u.length_squared(), along_v.length_squared());
        let apart = (vector(frame.second_form) - form) / DVec3::new(e, (e * g).sqrt(), g);
        let turned = ((vector(frame.along_u) - along_u).length() / e.sqrt())
            .max((vector(frame.along_v) - along_v).length() / g.sqrt());
        let is_border = [u, v].iter().any(|t| *t <= 0.0 || *t >= 1.0);
        let side = usize::from(is_border);
        errors.curvature[side] = errors.curvature[side].max(apart.abs().max_element());
        errors.direction[side] = errors.direction[side].max(turned);
    }
    errors
}

/// The error falls with the square of the edges' length inside, and in proportion to it at borders and
/// seams, where triangles of one chart lie on one side alone.
#[test]
fn frames_approach_those_of_the_smooth_surface() {
    // Largest errors at 32 segments, inside and at the border, of curvatures (which reach 3.3 on the
    // torus, 1 on sphere, cylinder and saddle, 7 on the patch) and of the directions.
    let bounds = [
        ("plane", [1e-6, 1e-6], [1e-6, 1e-6]),
        ("sphere", [0.033, 0.2], [0.017, 0.12]),
        ("cylinder", [1e-5, 3e-4], [1e-5, 2e-4]),
        ("torus", [0.035, 0.23], [0.005, 0.09]),
        ("saddle", [0.0023, 0.0085], [0.001, 0.024]),
        ("bezier_patch", [0.033, 0.14], [0.01, 0.17]),
    ];
    for (shape, (name, curvature, direction)) in SHAPES.iter().zip(bounds) {
        assert_eq!(shape.name, name);
        let [coarse, fine] = [16, 32].map(|segments| errors(shape, segments));
        println!("{name}: {coarse:.5?} {fine:.5?}");
        for (side, fall) in [0.35, 0.65].into_iter().enumerate() {
            for (coarse, fine, bound) in [
                (coarse.curvature[side], fine.curvature[side], curvature[side]),
                (coarse.direction[side], fine.direction[side], direction[side]),
            ] {
                assert!(fine <= bound, "{name} {side}: {fine} is more than {bound}");
                // What is left where the mesh is exact is the rounding of f32.
                assert!(fine < fall * coarse + 1e-5, "{name} {side}: {coarse} falls to {fine}");
            }
        }
    }
}

/// Nothing but the unit changes with the size, from a micrometre to 10^6 km.
#[test]
fn scale_is_no_matter() {
    let mesh = shapes::torus(0.3, 16);
    let (positions, normals, uvs) = arrays(&mesh);
    let plain = frames_of(&mesh);
    for scale in [1e-6_f32, 1e9] {
        let scaled: Vec<_> = positions.iter().map(|p| p.map(|x| x * scale)).collect();
        let frames = vertex_frames(&scaled, &normals, &uvs, &mesh.triangles).unwrap();
        for (frame, plain) in frames.iter().zip(&plain) {
            for (found, expected) in
                bytemuck::cast_ref::<_, [f32; 9]>(frame).iter().zip(bytemuck::cast_ref::<_, [f32; 9]>(plain))
            {
                assert!((found / scale - expected).abs() < 1e-3, "{scale}: {frame:?} {plain:?}");
            }
        }
        let [small, large] = [(&positions, &plain), (&scaled, &frames)]
            .map(|(positions, frames)| surface(positions, frames, &mesh.triangles, [64, 32], [2.0, 1.0]));
        assert!((large.texel_m / scale / small.texel_m - 1.0).abs() < 1e-4, "{small:?} {large:?}");
        for (found, expected) in large.curvature_per_m.iter().zip(small.curvature_per_m) {
            assert!((found * scale - expected).abs() < 1e-3, "{small:?} {large:?}");
        }
    }
}

/// Mirrored, turned and scaled texture coordinates change the directions, and the form with them.
#[test]
fn texture_coordinates_only_change_the_directions() {
    let mesh = shapes::saddle(16);
    let (positions, normals, uvs) = arrays(&mesh);
    let plain = frames_of(&mesh);
    let other: Vec<_> = uvs.iter().map(|[u, v]| [4.0 * v, 1.0 - u]).collect();
    let frames = vertex_frames(&positions, &normals, &other, &mesh.triangles).unwrap();
    for (frame, plain) in frames.iter().zip(&plain) {
        let [uu, uv, vv] = plain.second_form;
        let expected = VertexFrame {
            along_u: plain.along_v.map(|x| x / 4.0),
            along_v: plain.along_u.map(|x| -x),
            second_form: [vv / 16.0, -uv / 4.0, uu],
        };
        for (found, expected) in
            bytemuck::cast_ref::<_, [f32; 9]>(frame).iter().zip(bytemuck::cast_ref::<_, [f32; 9]>(&expected))
        {
            assert!((found - expected).abs() < 1e-4, "{frame:?} {expected:?}");
        }
    }
}

/// The seam of the sphere's u, and the mirror line of a mesh that shares its vertices.
#[test]
fn seams_do_not_show() {
    let sphere = shapes::sphere(32);
    for (uv, frame) in sphere.uvs.iter().zip(frames_of(&sphere)) {
        if (0.2..=0.8).contains(&uv.y) {
            let metric = vector(frame.along_u).length_squared();
            let curvature = f64::from(frame.second_form[0]) / metric;
            assert!((curvature - 1.0).abs() < 0.01, "{uv}: {curvature}");
        }
    }
    // A strip of four cells whose u runs to the middle and back.
    let positions: Vec<[f32; 3]> = (0..10).map(|i| [(i / 2) as f32, 0.0, (i % 2) as f32]).collect();
    let uvs: Vec<[f32; 2]> = positions.iter().map(|[x, _, z]| [2.0 - (x - 2.0).abs(), *z]).collect();
    let cell = |i: u32| [[2 * i, 2 * i + 1, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 2]];
    let triangles: Vec<[u32; 3]> = (0..4).flat_map(cell).collect();
    let frames = vertex_frames(&positions, &[[0.0, 1.0, 0.0]; 10], &uvs, &triangles).unwrap();
    for (position, frame) in positions.iter().zip(frames) {
        assert!((frame.along_u[0].abs() - 1.0).abs() < 1e-6, "{position:?} {frame:?}");
        assert!((frame.along_v[2] - 1.0).abs() < 1e-6, "{position:?} {frame:?}");
    }
}

/// A sharp edge keeps the curvatures of both sides: the cylinder's discs are flat, its wall is not.
#[test]
fn sharp_edges_keep_both_sides() {
    let mesh = shapes::cylinder(64);
    for (normal, frame) in mesh.normals.iter().zip(frames_of(&mesh)) {
        let curvature = f64::from(frame.second_form[0]) / vector(frame.along_u).length_squared();
        let expected = if normal.y.abs() > 0.5 { 0.0 } else { 1.0 };
        assert!((curvature - expected).abs() < 0.01, "{normal}: {frame:?}");
    }
}

#[test]
fn the_surface_is_summed_up() {
    let of =
        |mesh: &Mesh, size, scale| surface(&arrays(mesh).0, &frames_of(mesh), &mesh.triangles, size, scale);
    let plane = of(&shapes::plane(4), [128, 32], [0.5, 4.0]);
    // 2 m by 2 m hold 64 x 128 texels.
    assert!((plane.texel_m - (4.0_f32 / (64.0 * 128.0)).sqrt()).abs() < 1e-6, "{plane:?}");
    assert_eq!(plane.curvature_per_m, [0.0; 2]);
    let sphere = of(&shapes::sphere(64), [100; 2], [1.0; 2]);
    assert!(sphere.curvature_per_m.iter().all(|kappa| (kappa - 1.0).abs() < 0.01), "{sphere:?}");
    let saddle = of(&shapes::saddle(64), [100; 2], [1.0; 2]);
    assert!((saddle.curvature_per_m[0] + 1.0).abs() < 0.05, "{saddle:?}");
    assert!((saddle.curvature_per_m[1] - 1.0).abs() < 0.05, "{saddle:?}");
    // From 1 / 0.3 around the tube to -1 / 0.4 around the hole.
    let torus = of(&shapes::torus(0.3, 64), [100; 2], [1.0; 2]);
    assert!((torus.curvature_per_m[1] - 1.0 / 0.3).abs() < 0.05, "{torus:?}");
    assert!((torus.curvature_per_m[0] + 1.0 / 0.4).abs() < 0.1, "{torus:?}");
}

/// Every azimuth towards the light within a triangle is among those that are needed.
#[test]
fn needed_azimuths_are_those_that_are_looked_up() {
    let plane = shapes::plane(2);
    let (_, normals, _) = arrays(&plane);
    let frames = frames_of(&plane);
    let needed = |light| needed_azimuths(&frames, &normals, &plane.triangles, light, [64; 2], [1.0; 2], 32);
    // u runs along X: azimuth 0, and one more at both sides.
    assert_eq!(needed([1.0, 0.5, 0.0]), 0b11 | 1 << 31);
    assert_eq!(needed([0.0, 0.5, 1.0]), 0b111 << 7);
    assert_eq!(needed([0.0, 1.0, 0.0]), (1 << 32) - 1);
    // Texels are four times as long along v: a diagonal light is nearly along u.
    let wide = needed_azimuths(&frames, &normals, &plane.triangles, [1.0, 0.0, 1.0], [64, 16], [1.0; 2], 64);
    assert_eq!(wide, 0b1111 << 1, "{wide:b}");

    let torus = shapes::torus(0.3, 24);
    let (_, normals, _) = arrays(&torus);
    let frames = frames_of(&torus);
    let light = Vec3::new(0.3, 0.2, 0.9).normalize();
    for &triangle in &torus.triangles {
        let needed =
            needed_azimuths(&frames, &normals, &[triangle], light.to_array(), [96, 64], [3.0, 2.0], 64);
        let [weights, middle] = [[0.6, 0.3, 0.1], [1.0 / 3.0; 3]];
        for weights in [weights, middle] {
            let mean = |of: &dyn Fn(usize) -> DVec3| {
                triangle
                    .iter()
                    .zip(weights)
                    .map(|(&index, weight)| of(index as usize) * weight)
                    .sum::<DVec3>()
            };
            let normal = mean(&|index| vector(normals[index])).normalize();
            let flat = |direction: DVec3| direction - normal * direction.dot(normal);
            let along_u = flat(mean(&|index| vector(frames[index].along_u)));
            let along_v = flat(mean(&|index| vector(frames[index].along_v)));
            let light = flat(light.as_dvec3());
            let (e, f, g) = (along_u.dot(along_u), along_u.dot(along_v), along_v.dot(along_v));
            let (x, y) = (light.dot(along_u), light.dot(along_v));
            let angle = ((e * y - f * x) * 64.0 * 2.0).atan2((g * x - f * y) * 96.0 * 3.0);
            let slice = angle.rem_euclid(TAU) / TAU * 64.0;
            for azimuth in [slice.floor() as u64 % 64, (slice.floor() as u64 + 1) % 64] {
                assert!(needed >> azimuth & 1 == 1, "{azimuth} {needed:b}");
            }
        }
    }
}

#[test]
fn what_cannot_be_repaired_is_an_error() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let up = [[0.0, 1.0, 0.0]; 3];
    let uvs = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let none = vertex_frames(&corners, &up, &[], &[[0, 2, 1]]).unwrap_err();
    assert_eq!(none, Error::NoUvs { positions: 3, uvs: 0 });
    assert!(none.to_string().contains("3 positions and 0 texture coordinates"), "{none}");
    let normals = vertex_frames(&corners, &up[..2], &uvs, &[[0, 2, 1]]).unwrap_err();
    assert!(normals.to_string().contains("number of normals is 2"), "{normals}");
    let index = vertex_frames(&corners, &up, &uvs, &[[0, 2, 3]]).unwrap_err();
    assert!(index.to_string().contains("index of a triangle is 3"), "{index}");
    assert_eq!(vertex_frames(&[], &[], &[], &[]).unwrap(), []);
}
