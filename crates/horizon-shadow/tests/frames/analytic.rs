//! Frames against those in closed form, and how their errors fall as the tessellation becomes finer.

use horizon_shadow::frames::VertexFrame;
use scene::shapes as scene_shapes;

use crate::{Arrays, apart, shapes};

/// The greatest errors of the directions and of the second form over the vertices of one kind.
fn errors(shape: &shapes::Shape, segments: u32, counts: impl Fn(bool) -> bool) -> [f64; 2] {
    let arrays = Arrays::of(&(shape.mesh)(segments));
    let mut worst = [0.0_f64; 2];
    for (frame, uv) in arrays.frames().iter().zip(&arrays.uvs) {
        let at_border = (0..2).any(|axis| !shape.is_closed[axis] && [0.0, 1.0].contains(&uv[axis]));
        // Near a pole u is stretched without end.
        let at_pole = shape.name == "sphere" && !(0.125..=0.875).contains(&uv[1]);
        if at_pole || !counts(at_border) {
            continue;
        }
        let found = apart(frame, &(shape.frame)(uv[0].into(), uv[1].into()));
        worst = [worst[0].max(found[0]), worst[1].max(found[1])];
    }
    worst
}

/// Binary logarithms of how errors fall from 32 to 64 segments, and the errors at 64.
fn order(shape: &shapes::Shape, counts: impl Fn(bool) -> bool + Copy) -> ([f64; 2], [f64; 2]) {
    let (coarse, fine) = (errors(shape, 32, counts), errors(shape, 64, counts));
    println!("{}: {coarse:?} {fine:?}", shape.name);
    (std::array::from_fn(|i| (coarse[i] / fine[i]).log2()), fine)
}

#[test]
fn inside_a_mesh_errors_fall_with_the_square_of_the_edges() {
    for shape in &shapes::ALL {
        let (order, fine) = order(shape, |at_border| !at_border);
        for i in 0..2 {
            assert!(fine[i] < 2e-5 || order[i] > 1.8, "{} {order:?} {fine:?}", shape.name);
            assert!(fine[i] < [4e-3, 2e-2][i], "{} {fine:?}", shape.name);
        }
    }
}

#[test]
fn at_open_borders_errors_fall_with_the_edges() {
    for shape in &shapes::ALL {
        let (order, fine) = order(shape, |at_border| at_border);
        for i in 0..2 {
            assert!(fine[i] < 2e-5 || order[i] > 0.8, "{} {order:?} {fine:?}", shape.name);
            assert!(fine[i] < [0.1, 0.2][i], "{} {fine:?}", shape.name);
        }
    }
}

#[test]
fn both_sides_of_a_seam_agree() {
    for shape in shapes::ALL.iter().filter(|shape| shape.is_closed[0]) {
        let arrays = Arrays::of(&(shape.mesh)(64));
        let frames = arrays.frames();
        let at = |u: f32| {
            let inside = |uv: &[f32; 2]| uv[0] == u && (0.1..0.9).contains(&uv[1]);
            arrays.uvs.iter().zip(&frames).filter(move |(uv, _)| inside(uv)).collect::<Vec<_>>()
        };
        let (left, right) = (at(0.0), at(1.0));
        assert!(left.len() > 40 && left.len() == right.len(), "{}", shape.name);
        for ((uv, left), (other_uv, right)) in left.iter().zip(&right) {
            assert_eq!(uv[1], other_uv[1]);
            let [first, second] = apart(left, right);
            assert!(first < 2e-3 && second < 1e-2, "{} {uv:?} {left:?} {right:?}", shape.name);
        }
    }
}

#[test]
fn a_sphere_is_round_at_its_poles() {
    let arrays = Arrays::of(&scene_shapes::sphere(64));
    let poles: Vec<(VertexFrame, [f32; 2])> = arrays
        .frames()
        .into_iter()
        .zip(arrays.uvs.clone())
        .filter(|(_, uv)| [0.0, 1.0].contains(&uv[1]))
        .collect();
    assert_eq!(poles.len(), 2 * 128);
    for (frame, uv) in poles {
        // v runs along a meridian, of which one unit is half a turn.
        let [_, _, vv] = frame.second_form;
        let length = glam::Vec3::from(frame.along_v).length();
        assert!((length - std::f32::consts::PI).abs() < 0.01, "{uv:?} {frame:?}");
        assert!((vv / (length * length) - 1.0).abs() < 0.01, "{uv:?} {frame:?}");
    }
}

#[test]
fn a_rim_keeps_both_its_sides() {
    // The wall of the cylinder is curved and its discs are flat up to the edge that they share.
    let arrays = Arrays::of(&scene_shapes::cylinder(96));
    for ((frame, normal), uv) in arrays.frames().iter().zip(&arrays.normals).zip(&arrays.uvs) {
        if normal[1] == 0.0 {
            let [first, second] = apart(frame, &(shapes::ALL[2].frame)(uv[0].into(), uv[1].into()));
            assert!(first < 2e-3 && second < 2e-3, "{uv:?} {frame:?}");
        } else {
            assert!(frame.second_form.iter().all(|x| x.abs() < 1e-5), "{uv:?} {frame:?}");
        }
    }
}
