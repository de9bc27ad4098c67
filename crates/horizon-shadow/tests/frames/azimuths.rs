//! Which azimuths a light needs: all that any point of a mesh looks up, and few besides.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3, Vec3};
use horizon_shadow::frames::needed_azimuths;
use scene::{Mesh, shapes as scene_shapes};

use crate::{Arrays, shapes};

fn needed(mesh: &Mesh, light: [f32; 3], map_size: [u32; 2], uv_scale: [f32; 2], azimuths: u32) -> u64 {
    let arrays = Arrays::of(mesh);
    let frames = arrays.frames();
    needed_azimuths(&frames, &arrays.normals, &arrays.triangles, light, map_size, uv_scale, azimuths)
}

/// The azimuth of a light in texels, as a shader has it from interpolated frames.
fn azimuth(normal: DVec3, along: [DVec3; 2], light: DVec3, texels: DVec2) -> f64 {
    let normal = normal.normalize();
    let [u, v] = along.map(|along| along - normal * normal.dot(along));
    let across = light - normal * normal.dot(light);
    let (e, f, g) = (u.dot(u), u.dot(v), v.dot(v));
    let (x, y) = (g * across.dot(u) - f * across.dot(v), e * across.dot(v) - f * across.dot(u));
    (y * texels.y).atan2(x * texels.x)
}

#[test]
fn a_plane_needs_the_azimuth_of_its_light() {
    let plane = scene_shapes::plane(4);
    // Azimuth 0 of 32 and its neighbours; a light along +v with a map of 2:1 texels stays there.
    assert_eq!(needed(&plane, [1.0, 0.5, 0.0], [64, 64], [1.0; 2], 32), 1 << 31 | 0b11);
    assert_eq!(needed(&plane, [0.0, 3.0, 2.0], [128, 64], [1.0; 2], 32), 0b111 << 7);
    // 45 degrees on the plane are atan 2 in texels of half the width: between azimuths 5 and 6.
    assert_eq!(needed(&plane, [1.0, 1.0, 1.0], [64, 128], [1.0; 2], 32), 0b1111 << 4);
    assert_eq!(needed(&plane, [1.0, 1.0, 1.0], [64, 64], [1.0, 2.0], 32), 0b1111 << 4);
    // A map that runs against u.
    assert_eq!(needed(&plane, [1.0, 0.5, 0.0], [64, 64], [-1.0, 1.0], 32), 0b111 << 15);
}

#[test]
fn the_zenith_and_broken_frames_need_all() {
    let plane = scene_shapes::plane(2);
    assert_eq!(needed(&plane, [0.0, 2.0, 0.0], [64, 64], [1.0; 2], 16), 0xffff);
    assert_eq!(needed(&plane, [0.0; 3], [64, 64], [1.0; 2], 16), 0xffff);
    assert_eq!(needed(&plane, [f32::NAN; 3], [64, 64], [1.0; 2], 16), 0xffff);
    assert_eq!(needed(&plane, [1.0, 0.0, 0.0], [64, 64], [0.0; 2], 16), 0xffff);
    assert_eq!(needed(&scene_shapes::sphere(16), [1.0, 0.0, 0.0], [64, 64], [1.0; 2], 64), u64::MAX);
}

#[test]
fn whatever_is_looked_up_was_asked_for() {
    let mut saved = 0;
    let mut random = crate::broken::Random(7);
    for shape in &shapes::ALL {
        let arrays = Arrays::of(&(shape.mesh)(12));
        let frames = arrays.frames();
        let vector = |v: [f32; 3]| Vec3::from(v).as_dvec3();
        for _ in 0..20 {
            let light = DVec3::from_array(std::array::from_fn(|_| random.between(-1.0, 1.0)));
            let of = |triangles: &[[u32; 3]]| {
                let light = light.as_vec3().to_array();
                needed_azimuths(&frames, &arrays.normals, triangles, light, [96, 64], [1.0, 3.0], 32)
            };
            // Each triangle for itself, since whole shapes need most azimuths.
            for triangle in &arrays.triangles {
                let mask = of(&[*triangle]);
                saved += mask.count_zeros() - 32;
                for _ in 0..8 {
                    let (a, b) = (random.between(0.0, 1.0).sqrt(), random.between(0.0, 1.0));
                    let weights = [1.0 - a, a * (1.0 - b), a * b];
                    let mean = |of: &dyn Fn(usize) -> DVec3| -> DVec3 {
                        triangle.iter().zip(weights).map(|(&i, weight)| of(i as usize) * weight).sum()
                    };
                    let along = [mean(&|i| vector(frames[i].along_u)), mean(&|i| vector(frames[i].along_v))];
                    let normal = mean(&|i| vector(arrays.normals[i]));
                    let turn = azimuth(normal, along, light, DVec2::new(96.0, 192.0)) / TAU * 32.0;
                    for azimuth in [turn.floor(), turn.floor() + 1.0] {
                        let bit = 1 << (azimuth as i64).rem_euclid(32);
                        assert!(mask & bit != 0, "{} {triangle:?} {turn} {mask:b}", shape.name);
                    }
                }
            }
        }
    }
    assert!(saved > 0);
}
