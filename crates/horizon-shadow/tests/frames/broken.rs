//! Meshes that are broken in every way.

use horizon_shadow::{
    Error,
    frames::{VertexFrame, needed_azimuths, surface, vertex_frames},
};
use proptest::prelude::*;
use scene::shapes as scene_shapes;

use crate::{Arrays, apart, numbers, shapes};

/// A counter-based generator (splitmix64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn between(&mut self, least: f64, greatest: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        least + (greatest - least) * (((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

/// A curved mesh without symmetries.
fn patch() -> Arrays {
    Arrays::of(&(shapes::ALL[5].mesh)(8))
}

fn assert_same(found: &[VertexFrame], expected: &[VertexFrame], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        let apart = apart(found, expected);
        assert!(apart.iter().all(|&x| x <= tolerance), "vertex {i}: {found:?} {expected:?}");
    }
}

#[test]
fn what_cannot_be_repaired_is_said() {
    let Arrays { positions, normals, uvs, triangles } = patch();
    let count = positions.len();
    let no_uvs = vertex_frames(&positions, &normals, &[], &triangles).unwrap_err();
    assert_eq!(no_uvs, Error::NoUvs { positions: count, uvs: 0 });
    assert!(no_uvs.to_string().contains("0 texture coordinates"), "{no_uvs}");
    let one_less = vertex_frames(&positions, &normals, &uvs[1..], &triangles).unwrap_err();
    assert_eq!(one_less, Error::NoUvs { positions: count, uvs: count - 1 });
    let normals_less = vertex_frames(&positions, &normals[1..], &uvs, &triangles).unwrap_err();
    assert!(normals_less.to_string().contains("the number of normals is 80"), "{normals_less}");
    let mut wild = triangles;
    wild[5][1] = count as u32;
    let out_of_range = vertex_frames(&positions, &normals, &uvs, &wild).unwrap_err();
    assert!(out_of_range.to_string().contains("is 81; expected less than"), "{out_of_range}");
    assert_eq!(vertex_frames(&[], &[], &[], &[]), Ok(Vec::new()));
}

#[test]
fn triangles_that_come_twice_or_have_no_area_change_nothing() {
    let whole = patch();
    let mut twice = whole.clone();
    twice.triangles.extend(whole.triangles.clone());
    assert_same(&twice.frames(), &whole.frames(), 1e-6);
    // The other way round a triangle says the same.
    let mut turned = whole.clone();
    turned.triangles.extend(whole.triangles.iter().map(|&[a, b, c]| [c, b, a]));
    assert_same(&turned.frames(), &whole.frames(), 1e-5);
    let mut thin = whole.clone();
    thin.triangles.extend([[0, 0, 0], [3, 3, 20], [0, 1, 0]]);
    assert_eq!(thin.frames(), whole.frames());
}

#[test]
fn edges_of_three_triangles_are_nothing_special() {
    // Three flat wings at one edge, each with its own normals: no wing knows of the others.
    let (mut positions, mut normals, mut uvs) = (Vec::new(), Vec::new(), Vec::new());
    let mut triangles = Vec::new();
    for wing in 0..3 {
        let (sin, cos) = (2.0 * wing as f32).sin_cos();
        let first = positions.len() as u32;
        positions.extend([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [cos, 0.0, sin], [cos, 1.0, sin]]);
        normals.extend([[-sin, 0.0, cos]; 4]);
        uvs.extend([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]);
        triangles.extend([[first, first + 1, first + 2], [first + 2, first + 1, first + 3]]);
    }
    for (frame, normal) in vertex_frames(&positions, &normals, &uvs, &triangles).unwrap().iter().zip(&normals)
    {
        assert!(frame.second_form.iter().all(|x| x.abs() < 1e-6), "{frame:?}");
        assert_eq!(frame.along_v, [0.0, 1.0, 0.0]);
        assert!((frame.along_u[0] - normal[2]).abs() < 1e-6, "{frame:?}");
    }
    // And with vertices that all three share, whose normals can be of none: finite.
    let shared = [[0, 1, 2], [0, 1, 3], [0, 1, 4]];
    let positions = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.5], [0.0, 0.0, -1.0]];
    let uvs = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [-1.0, 0.0], [0.5, 0.5]];
    for normals in [[[0.0, 0.0, 1.0]; 5], [[0.0; 3]; 5], [[0.0, 1.0, 0.0]; 5]] {
        let frames = vertex_frames(&positions, &normals, &uvs, &shared).unwrap();
        assert!(frames.iter().flat_map(numbers).all(f32::is_finite), "{frames:?}");
    }
}

#[test]
fn triangles_without_uv_area_keep_their_curvature() {
    // A row of cells shows one line of the map; its vertices have directions from their other side.
    let mut sphere = scene_shapes::sphere(32);
    let whole = Arrays::of(&sphere).frames();
    let row = |index: usize| index / 65;
    for (index, uv) in sphere.uvs.iter_mut().enumerate() {
        // The first row is that of the pole, of 64 vertices.
        if row(index + 1) == 16 {
            uv.y = 15.0 / 32.0;
        }
    }
    let frames = Arrays::of(&sphere).frames();
    for (index, (found, expected)) in frames.iter().zip(&whole).enumerate() {
        if row(index + 1) == 15 {
            let [first, second] = apart(found, expected);
            assert!(first < 0.02 && second < 0.02, "{index} {found:?} {expected:?}");
        }
    }
    // Where no triangle of a mesh has any, nothing can be said.
    sphere.uvs.iter_mut().for_each(|uv| uv.y = 0.5);
    assert!(Arrays::of(&sphere).frames().iter().all(|frame| *frame == VertexFrame::default()));
}

#[test]
fn mirrored_uvs_have_the_same_tensor() {
    let whole = patch();
    let mut mirrored = whole.clone();
    mirrored.uvs.iter_mut().for_each(|uv| uv[0] = 1.0 - uv[0]);
    let expected: Vec<VertexFrame> = whole
        .frames()
        .iter()
        .map(|frame| VertexFrame {
            along_u: frame.along_u.map(|x| -x),
            along_v: frame.along_v,
            second_form: [frame.second_form[0], -frame.second_form[1], frame.second_form[2]],
        })
        .collect();
    assert_same(&mirrored.frames(), &expected, 1e-5);
}

#[test]
fn a_mesh_mirrored_about_its_middle_has_directions_everywhere() {
    // u runs to the middle and back: the mean of both sides would be 0.
    let mut plane = scene_shapes::plane(8);
    plane.uvs.iter_mut().for_each(|uv| uv.x = 1.0 - (2.0 * uv.x - 1.0).abs());
    let arrays = Arrays::of(&plane);
    for (frame, position) in arrays.frames().iter().zip(&arrays.positions) {
        assert!((frame.along_u[0].abs() - 1.0).abs() < 1e-6, "{position:?} {frame:?}");
        assert!(position[0] == 0.0 || frame.along_u[0] * position[0] < 0.0, "{position:?} {frame:?}");
    }
}

#[test]
fn frames_scale_with_the_mesh() {
    let whole = patch();
    for scale in [1e-3_f32, 1e3] {
        let mut scaled = whole.clone();
        scaled.positions.as_flattened_mut().iter_mut().for_each(|x| *x *= scale);
        let expected: Vec<VertexFrame> =
            whole.frames().iter().map(|frame| bytemuck::cast(numbers(frame).map(|x| x * scale))).collect();
        // Curvatures, and with them their errors, are in 1 / metre.
        for (found, expected) in scaled.frames().iter().zip(&expected) {
            let [first, second] = apart(found, expected);
            assert!(first < 1e-5 && second * f64::from(scale) < 1e-4, "{scale} {found:?} {expected:?}");
        }
    }
}

#[test]
fn numbers_that_are_none_stay_where_they_are() {
    let whole = patch();
    let expected = whole.frames();
    let middle = 40;
    let neighbours: Vec<u32> =
        whole.triangles.iter().filter(|corners| corners.contains(&middle)).copied().flatten().collect();
    let breaks: [fn(&mut Arrays, f32); 3] = [
        |arrays, value| arrays.positions[40][1] = value,
        |arrays, value| arrays.normals[40][1] = value,
        |arrays, value| arrays.uvs[40][1] = value,
    ];
    for break_one in breaks {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut broken = whole.clone();
            break_one(&mut broken, value);
            for (i, (found, expected)) in broken.frames().iter().zip(&expected).enumerate() {
                let [first, second] = apart(found, expected);
                let is_near = neighbours.contains(&(i as u32));
                let limits = if is_near { [0.5, 2.0] } else { [0.0, 0.0] };
                assert!(
                    i == middle as usize || (first <= limits[0] && second <= limits[1]),
                    "{i} {found:?} {expected:?}"
                );
            }
        }
    }
}

#[test]
fn missing_normals_are_those_of_the_triangles() {
    let sphere = scene_shapes::sphere(32);
    let mut arrays = Arrays::of(&sphere);
    let expected = arrays.frames();
    arrays.normals.iter_mut().for_each(|normal| *normal = [0.0; 3]);
    for ((found, expected), uv) in arrays.frames().iter().zip(&expected).zip(&arrays.uvs) {
        // At the seam and the poles each vertex has its own side's triangles alone.
        if (0.05..0.95).contains(&uv[0]) && (0.1..0.9).contains(&uv[1]) {
            let [first, second] = apart(found, expected);
            assert!(first < 0.02 && second < 0.05, "{uv:?} {found:?} {expected:?}");
        }
    }
}

/// Numbers that meshes may have, and such that break sums, squares and quotients.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -2.0_f32..2.0,
        2 => prop::sample::select(vec![0.0, -0.0, 1.0, -1.0, 0.5]),
        1 => prop::sample::select(vec![
            f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, f32::MIN_POSITIVE, 1e-45, 1e-30, 1e30,
        ]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn any_mesh_has_finite_frames(
        vertices in prop::collection::vec((prop::array::uniform3(number()), prop::array::uniform3(number()), prop::array::uniform2(number())), 1..9),
        corners in prop::collection::vec(prop::array::uniform3(0_u32..1000), 0..12),
        light in prop::array::uniform3(number()),
        uv_scale in prop::array::uniform2(number()),
        azimuths in 0_u32..70,
    ) {
        let positions: Vec<_> = vertices.iter().map(|vertex| vertex.0).collect();
        let normals: Vec<_> = vertices.iter().map(|vertex| vertex.1).collect();
        let uvs: Vec<_> = vertices.iter().map(|vertex| vertex.2).collect();
        let triangles: Vec<_> =
            corners.iter().map(|corners| corners.map(|index| index % vertices.len() as u32)).collect();
        let frames = vertex_frames(&positions, &normals, &uvs, &triangles).unwrap();
        prop_assert_eq!(frames.len(), vertices.len());
        prop_assert!(frames.iter().flat_map(numbers).all(f32::is_finite), "{:?}", frames);
        let surface = surface(&positions, &frames, &triangles, [64, 32], uv_scale);
        let [least, greatest] = surface.curvature_per_m;
        prop_assert!(surface.texel_m > 0.0 && surface.texel_m.is_finite(), "{:?}", surface);
        prop_assert!(least.is_finite() && greatest.is_finite() && least <= greatest, "{:?}", surface);
        let needed = needed_azimuths(&frames, &normals, &triangles, light, [64, 32], uv_scale, azimuths);
        prop_assert_eq!(needed & !(u64::MAX >> (64 - azimuths.clamp(1, 64))), 0);
    }
}
