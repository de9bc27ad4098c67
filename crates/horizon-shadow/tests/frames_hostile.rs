//! Meshes that break naive code: nothing panics, and everything is finite.

#![allow(clippy::float_cmp, reason = "exact values are what is tested")]

use horizon_shadow::{
    VertexFrame,
    frames::{needed_azimuths, surface, vertex_frames},
};
use proptest::prelude::*;

type Arrays = (Vec<[f32; 3]>, Vec<[f32; 3]>, Vec<[f32; 2]>, Vec<[u32; 3]>);

fn is_finite(frame: &VertexFrame) -> bool {
    [frame.along_u, frame.along_v, frame.second_form].as_flattened().iter().all(|value| value.is_finite())
}

/// Everything that is public on one mesh.
fn try_all((positions, normals, uvs, triangles): &Arrays, light: [f32; 3]) -> Vec<VertexFrame> {
    let frames = vertex_frames(positions, normals, uvs, triangles).unwrap();
    assert_eq!(frames.len(), positions.len());
    assert!(frames.iter().all(is_finite), "{frames:?}");
    for (size, scale) in [([1, 1], [1.0, 1.0]), ([8192, 3], [-2.0, 1e-20]), ([64, 64], [0.0, f32::NAN])] {
        let found = surface(positions, &frames, triangles, size, scale);
        assert!(found.texel_m >= 0.0 && !found.texel_m.is_nan(), "{found:?}");
        let [least, greatest] = found.curvature_per_m;
        assert!(least <= greatest, "{found:?}");
        for azimuths in [0, 4, 64, 1000] {
            let needed = needed_azimuths(&frames, normals, triangles, light, size, scale, azimuths);
            let known = azimuths.clamp(1, 64);
            assert!(known == 64 || needed >> known == 0, "{needed:b}");
        }
    }
    frames
}

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => -2.0_f32..2.0,
        2 => (-3_i8..=3).prop_map(f32::from),
        1 => any::<f32>(),
        1 => prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(1e-40), Just(f32::MAX), Just(-0.0)],
    ]
}

fn mesh() -> impl Strategy<Value = Arrays> {
    (1_usize..12).prop_flat_map(|count| {
        let vertices = count as u32;
        (
            prop::collection::vec(prop::array::uniform3(number()), count),
            prop::collection::vec(prop::array::uniform3(number()), count),
            prop::collection::vec(prop::array::uniform2(number()), count),
            prop::collection::vec(prop::array::uniform3(0..vertices), 0..20),
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn any_mesh_is_taken(arrays in mesh(), light in prop::array::uniform3(number())) {
        try_all(&arrays, light);
    }
}

/// A square of `cells` x `cells` on a sphere of radius 2 around (0, -2, 0), 1 m wide.
fn cap(cells: u32) -> Arrays {
    let mut arrays: Arrays = Default::default();
    for index in 0..(cells + 1) * (cells + 1) {
        let (u, v) =
            ((index % (cells + 1)) as f32 / cells as f32, (index / (cells + 1)) as f32 / cells as f32);
        let (x, z) = (u - 0.5, v - 0.5);
        let y = (4.0 - x * x - z * z).sqrt();
        arrays.0.push([x, y - 2.0, z]);
        arrays.1.push([x / 2.0, y / 2.0, z / 2.0]);
        arrays.2.push([u, v]);
    }
    for index in 0..cells * cells {
        let a = index / cells * (cells + 1) + index % cells;
        arrays.3.extend([[a, a + cells + 1, a + cells + 2], [a, a + cells + 2, a + 1]]);
    }
    arrays
}

/// Curvature along u.
fn curvature(frame: &VertexFrame) -> f32 {
    frame.second_form[0] / frame.along_u.iter().map(|x| x * x).sum::<f32>()
}

fn is_right(frame: &VertexFrame) -> bool {
    (curvature(frame) - 0.5).abs() < 0.02
}

#[test]
fn damage_stays_where_it_is() {
    let light = [0.3, 0.2, 0.5];
    let plain = cap(8);
    assert!(try_all(&plain, light).iter().all(is_right));
    let middle = 4 * 9 + 4;

    let mut broken = plain.clone();
    broken.0[middle] = [f32::NAN; 3];
    let frames = try_all(&broken, light);
    assert_eq!(frames[middle], VertexFrame::default());
    assert!((0..81).filter(|&index| index != middle).all(|index| is_right(&frames[index])), "{frames:?}");

    // A triangle that is a line, one that is a point, one that is there twice, and a fin on an edge.
    let mut crowded = plain.clone();
    crowded.3.extend([[0, 4, 8], [3, 3, 3], [3, 3, 4], plain.3[5]]);
    assert!(try_all(&crowded, light).iter().all(is_right));
    let fin = crowded.0.len() as u32;
    crowded.0.push([0.0, 1.0, 0.0]);
    crowded.1.push([1.0, 0.0, 0.0]);
    crowded.2.push([0.5, 0.7]);
    crowded.3.push([middle as u32, middle as u32 + 1, fin]);
    let frames = try_all(&crowded, light);
    assert!((0..36).all(|index| is_right(&frames[index])));

    // Texture coordinates without area at one triangle: its neighbours' directions stand in.
    let mut collapsed = plain.clone();
    collapsed.2[middle] = collapsed.2[middle + 1];
    assert!(is_right(&try_all(&collapsed, light)[middle - 2]));

    // Normals that are missing: those of the triangles stand in.
    let mut unlit = plain.clone();
    unlit.1.iter_mut().for_each(|normal| *normal = [0.0; 3]);
    let frames = try_all(&unlit, light);
    assert!((curvature(&frames[middle]) - 0.5).abs() < 0.05, "{}", curvature(&frames[middle]));

    // Every corner a vertex of its own, as exporters of triangle soup write them.
    let soup = |values: &[[f32; 3]]| plain.3.as_flattened().iter().map(|&i| values[i as usize]).collect();
    let uvs = plain.3.as_flattened().iter().map(|&i| plain.2[i as usize]).collect();
    let triangles = (0..plain.3.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let frames = try_all(&(soup(&plain.0), soup(&plain.1), uvs, triangles), light);
    assert!(frames.iter().all(is_right));
}

#[test]
fn a_mesh_without_texture_area_has_no_frames() {
    let mut arrays = cap(4);
    arrays.2.iter_mut().for_each(|uv| *uv = [0.25, 0.75]);
    let frames = try_all(&arrays, [1.0, 1.0, 0.0]);
    assert!(frames.iter().all(|frame| *frame == VertexFrame::default()));
    let found = surface(&arrays.0, &frames, &arrays.3, [64; 2], [1.0; 2]);
    assert_eq!((found.texel_m, found.curvature_per_m), (1.0, [0.0; 2]));
}
