//! Frames in world space: transformed as the documentation says, and found from the transformed mesh.

use glam::{Mat3, Quat, Vec3};
use horizon_shadow::frames::VertexFrame;

use crate::{Arrays, apart, shapes};

/// Whether a mesh and the frames of its vertices agree after a transform, in world units of 1.
fn worst(shape: &shapes::Shape, segments: u32, m: Mat3) -> [f64; 2] {
    let local = Arrays::of(&(shape.mesh)(segments));
    let normal_from_local = m.inverse().transpose();
    let mut world = local.clone();
    for (position, normal) in world.positions.iter_mut().zip(&mut world.normals) {
        *position = (m * Vec3::from(*position)).to_array();
        *normal = (normal_from_local * Vec3::from(*normal)).normalize().to_array();
    }
    let frames = local.frames().into_iter().zip(&local.normals);
    let transformed = frames.map(|(frame, normal)| {
        let scale = (normal_from_local * Vec3::from(*normal)).length();
        VertexFrame {
            along_u: (m * Vec3::from(frame.along_u)).to_array(),
            along_v: (m * Vec3::from(frame.along_v)).to_array(),
            second_form: frame.second_form.map(|x| x / scale),
        }
    });
    let is_inside = |uv: &[f32; 2]| (0.1..0.9).contains(&uv[0]) && (0.1..0.9).contains(&uv[1]);
    let pairs = world.frames().into_iter().zip(transformed).zip(&world.uvs);
    pairs.filter(|(_, uv)| is_inside(uv)).fold([0.0, 0.0], |[first, second], ((found, expected), _)| {
        let apart = apart(&found, &expected);
        [f64::max(first, apart[0]), f64::max(second, apart[1])]
    })
}

#[test]
fn turns_and_mirrors_change_nothing_but_the_space() {
    let turn = Mat3::from_quat(Quat::from_rotation_y(0.7) * Quat::from_rotation_x(2.0));
    for shape in &shapes::ALL {
        for m in [turn, turn * Mat3::from_diagonal(Vec3::new(-1.0, 1.0, 1.0)), -turn] {
            let found = worst(shape, 16, m);
            assert!(found[0] < 1e-5 && found[1] < 3e-4, "{} {m} {found:?}", shape.name);
        }
    }
}

#[test]
fn scales_that_differ_between_axes_follow_the_documentation() {
    let turn = Mat3::from_quat(Quat::from_rotation_z(0.4) * Quat::from_rotation_x(1.1));
    for shape in &shapes::ALL {
        for scale in [Vec3::new(2.0, 0.7, 1.3), Vec3::new(1.5, -0.8, 1.0)] {
            let m = turn * Mat3::from_diagonal(scale) * turn.transpose();
            let (coarse, fine) = (worst(shape, 32, m), worst(shape, 64, m));
            println!("{} {scale} {coarse:?} {fine:?}", shape.name);
            for i in 0..2 {
                // Stretched tubes have curvatures of 10 and more.
                assert!(fine[i] < [1e-2, 0.1][i], "{} {fine:?}", shape.name);
                assert!(fine[i] < 1e-3 || coarse[i] / fine[i] > 3.0, "{} {coarse:?} {fine:?}", shape.name);
            }
        }
    }
}
