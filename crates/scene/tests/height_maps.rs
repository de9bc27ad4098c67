//! Built-in height maps.

#![allow(clippy::float_cmp, reason = "exact values are what is tested")]

use scene::{HeightMap, builtin};

/// Differences of neighbours along u: within the map, and over its seam.
fn steps(map: &HeightMap) -> (f32, f32) {
    let (mut within, mut seam) = (0.0_f32, 0.0_f32);
    for row in map.heights.chunks_exact(map.width as usize) {
        within = row.windows(2).fold(within, |most, pair| most.max((pair[0] - pair[1]).abs()));
        seam = seam.max((row[0] - row[row.len() - 1]).abs());
    }
    (within, seam)
}

fn transposed(map: &HeightMap) -> HeightMap {
    let (width, height) = (map.width as usize, map.height as usize);
    let heights = (0..width * height).map(|i| map.heights[i % height * width + i / height]).collect();
    HeightMap { name: map.name.clone(), width: map.height, height: map.width, heights }
}

#[test]
fn heights_span_the_range_and_are_the_same_each_time() {
    for name in builtin::HEIGHT_MAPS {
        let map = builtin::height_map(name).unwrap();
        assert_eq!(map.name, name);
        assert_eq!(map.heights.len(), (map.width * map.height) as usize);
        assert!(map.heights.iter().all(|height| (0.0..=1.0).contains(height)), "{name}");
        for end in [0.0, 1.0] {
            assert!(map.heights.contains(&end), "{name} {end}");
        }
        assert_eq!(map.heights, builtin::height_map(name).unwrap().heights, "{name}");
        assert!(builtin::height_map_texels(name).unwrap() > 1.0);
    }
    assert!(builtin::height_map("moon").is_none());
    assert!(builtin::height_map_sized("moon", [8, 8]).is_none());
    assert!(builtin::height_map_texels("moon").is_none());
}

#[test]
fn maps_repeat_without_a_seam() {
    for name in builtin::HEIGHT_MAPS {
        let map = builtin::height_map_sized(name, [192, 160]).unwrap();
        for map in [transposed(&map), map] {
            let (within, seam) = steps(&map);
            assert!(seam <= 1.05 * within, "{name}: {seam} over the seam, {within} elsewhere");
        }
    }
}

/// Every second texel of a map twice as fine lies a quarter of a coarse texel away; the mean of four
/// is the coarse one's place.
#[test]
fn another_size_is_the_same_picture() {
    for name in ["cylinders", "reptile_skin", "ripples", "dunes", "fbm_smooth", "craters"] {
        let coarse = builtin::height_map_sized(name, [128, 128]).unwrap();
        let fine = builtin::height_map_sized(name, [256, 256]).unwrap();
        let difference: f32 = (0..128 * 128)
            .map(|i| {
                let first = i / 128 * 2 * 256 + i % 128 * 2;
                let four = [first, first + 1, first + 256, first + 257].map(|index| fine.heights[index]);
                (coarse.heights[i] - four.iter().sum::<f32>() / 4.0).abs()
            })
            .sum();
        let mean = difference / (128.0 * 128.0);
        println!("{name}: {mean:.4}");
        assert!(mean < 0.03, "{name}: {mean}");
    }
}

#[test]
fn any_size_is_taken() {
    for name in builtin::HEIGHT_MAPS {
        for (asked, made) in [([0, 0], [1, 1]), ([1, 7], [1, 7]), ([9000, 2], [8192, 2]), ([33, 5], [33, 5])]
        {
            let map = builtin::height_map_sized(name, asked).unwrap();
            assert_eq!([map.width, map.height], made);
            assert!(map.heights.iter().all(|height| (0.0..=1.0).contains(height)), "{name} {asked:?}");
        }
    }
}
