//! What a mesh says as a whole.

use std::f64::consts::{LN_2, PI};

use horizon_shadow::{Surface, frames::surface};
use scene::{Mesh, shapes as scene_shapes};

use crate::{Arrays, shapes};

fn surface_of(mesh: &Mesh, map_size: [u32; 2], uv_scale: [f32; 2]) -> Surface {
    let arrays = Arrays::of(mesh);
    surface(&arrays.positions, &arrays.frames(), &arrays.triangles, map_size, uv_scale)
}

fn assert_near(found: f32, expected: f64, share: f64) {
    assert!((f64::from(found) - expected).abs() <= share * expected.abs(), "{found} {expected}");
}

#[test]
fn a_texel_is_as_long_as_the_map_says() {
    let plane = scene_shapes::plane(3);
    assert_near(surface_of(&plane, [128, 128], [1.0; 2]).texel_m, 2.0 / 128.0, 1e-6);
    assert_near(surface_of(&plane, [128, 32], [1.0, 4.0]).texel_m, 2.0 / 128.0, 1e-6);
    assert_near(surface_of(&plane, [128, 128], [-3.0, 3.0]).texel_m, 2.0 / 384.0, 1e-6);
    // On a sphere it is sqrt(2 pi^2 sin) / 64, whose logarithm's mean over the area is known.
    let sphere = surface_of(&scene_shapes::sphere(64), [64, 64], [1.0; 2]);
    assert_near(sphere.texel_m, (2.0 * PI * PI).sqrt() * (0.5 * (LN_2 - 1.0)).exp() / 64.0, 5e-3);
}

#[test]
fn curvatures_are_those_of_the_shapes() {
    let range = |mesh: &Mesh| surface_of(mesh, [128, 128], [1.0; 2]).curvature_per_m;
    assert_eq!(range(&scene_shapes::plane(8)), [0.0; 2]);
    for value in range(&scene_shapes::sphere(64)) {
        assert_near(value, 1.0, 5e-3);
    }
    let [flat, round] = range(&scene_shapes::cylinder(96));
    assert!(flat.abs() < 1e-5, "{flat}");
    // With its flat caps, less than a tenth stands for what goes straight around it: the next azimuths
    // are an eighth of a half turn away.
    assert_near(round, (PI / 8.0).cos().powi(2), 2e-3);
    // The tube's own curvature is everywhere; that of the ring is left out where it is strongest.
    let [least, greatest] = range(&(shapes::ALL[3].mesh)(64));
    assert_near(greatest, 1.0 / shapes::TUBE, 0.02);
    let below = torus_share_below(f64::from(least));
    assert!((0.05..0.15).contains(&below), "{least}: {below}");
    // A saddle is bent most in its middle alone.
    let [hollow, convex] = range(&scene_shapes::saddle(64));
    assert!((hollow + convex).abs() < 1e-3, "{hollow} {convex}");
    assert!((0.5..0.75).contains(&convex), "{convex}");
}

/// Share of a torus's area and azimuths whose normal curvature is less than `curvature`.
fn torus_share_below(curvature: f64) -> f64 {
    let (tube, ring) = (shapes::TUBE, 1.0 - shapes::TUBE);
    let steps = 500;
    let (mut whole, mut below) = (0.0, 0.0);
    for i in 0..steps {
        // From the tube's outermost circle to its innermost.
        let (cosine, area) = {
            let cosine = (PI * (f64::from(i) + 0.5) / f64::from(steps)).cos();
            (cosine, ring + tube * cosine)
        };
        for j in 0..steps {
            let along_tube = (PI * (f64::from(j) + 0.5) / f64::from(steps)).cos().powi(2);
            whole += area;
            if along_tube / tube + (1.0 - along_tube) * cosine / area < curvature {
                below += area;
            }
        }
    }
    below / whole
}

#[test]
fn one_wild_vertex_does_not_stretch_the_range() {
    let mut mesh = scene_shapes::sphere(32);
    mesh.normals[1000] = -mesh.normals[1000];
    let [least, greatest] = surface_of(&mesh, [64, 64], [1.0; 2]).curvature_per_m;
    assert!(least > 0.9 && greatest < 1.1, "{least} {greatest}");
}

#[test]
fn nothing_is_said_about_nothing() {
    let nothing = Surface { texel_m: 1.0, curvature_per_m: [0.0; 2] };
    assert_eq!(surface(&[], &[], &[], [4, 4], [1.0; 2]), nothing);
    let plane = scene_shapes::plane(1);
    for uv_scale in [[0.0, 1.0], [f32::NAN, 1.0], [f32::INFINITY, 1.0]] {
        assert_eq!(surface_of(&plane, [4, 4], uv_scale), nothing);
    }
    assert_eq!(surface_of(&plane, [0, 4], [1.0; 2]), nothing);
}
