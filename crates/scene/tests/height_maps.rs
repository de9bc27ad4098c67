//! Built-in height maps.

use scene::HeightMap;
use scene::builtin::{HEIGHT_MAPS, height_map, height_map_sized, height_map_texels};

fn texel(map: &HeightMap, column: i64, row: i64) -> f64 {
    let column = column.rem_euclid(i64::from(map.width)) as usize;
    let row = row.rem_euclid(i64::from(map.height)) as usize;
    f64::from(map.heights[row * map.width as usize + column])
}

/// Root of the mean square of the steps along u and along v across one column or row of texels.
fn step(map: &HeightMap, across_row: bool, at: i64) -> f64 {
    let count = if across_row { map.width } else { map.height };
    let squares = (0..i64::from(count)).map(|i| {
        let (here, next) = if across_row {
            (texel(map, i, at), texel(map, i, at + 1))
        } else {
            (texel(map, at, i), texel(map, at + 1, i))
        };
        (next - here).powi(2)
    });
    (squares.sum::<f64>() / f64::from(count)).sqrt()
}

#[test]
fn heights_span_0_to_1_and_are_the_same_each_time() {
    for name in HEIGHT_MAPS {
        let map = height_map(name).unwrap();
        assert_eq!(map.name, name);
        assert_eq!(map.heights.len(), map.width as usize * map.height as usize);
        let least = map.heights.iter().copied().fold(f32::INFINITY, f32::min);
        let greatest = map.heights.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        assert_eq!((least, greatest), (0.0, 1.0), "{name}");
        assert_eq!(height_map(name).unwrap().heights, map.heights, "{name}");
    }
    assert!(height_map("no such map").is_none());
    assert!(height_map_texels("no such map").is_none());
}

#[test]
fn no_seam_shows_where_a_map_repeats() {
    for name in HEIGHT_MAPS {
        let map = height_map(name).unwrap();
        for across_row in [false, true] {
            let count = i64::from(if across_row { map.height } else { map.width });
            let largest_inside = (0..count - 1).map(|at| step(&map, across_row, at)).fold(0.0, f64::max);
            let seam = step(&map, across_row, count - 1);
            assert!(seam <= largest_inside, "{name}: {seam} at the seam, {largest_inside} inside");
        }
    }
}

#[test]
fn any_size_shows_the_same_picture() {
    for name in HEIGHT_MAPS {
        let map = height_map_sized(name, [96, 60]).unwrap();
        assert_eq!((map.width, map.height, map.heights.len()), (96, 60, 96 * 60));
        let larger = height_map_sized(name, [192, 120]).unwrap();
        // Correlation of the small map with every second texel of the large one.
        let pairs: Vec<(f64, f64)> = (0..60)
            .flat_map(|row| (0..96).map(move |column| (column, row)))
            .map(|(column, row)| (texel(&map, column, row), texel(&larger, 2 * column, 2 * row)))
            .collect();
        let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / pairs.len() as f64;
        let (a, b) = (mean(|pair| pair.0), mean(|pair| pair.1));
        let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
        for (x, y) in &pairs {
            ab += (x - a) * (y - b);
            aa += (x - a).powi(2);
            bb += (y - b).powi(2);
        }
        let correlation = ab / (aa * bb).sqrt();
        assert!(correlation > 0.8, "{name}: {correlation}");
    }
    let single = height_map_sized("fbm", [1, 1]).unwrap();
    assert_eq!(single.heights, [0.0]);
    let line = height_map_sized("craters", [0, 7]).unwrap();
    assert_eq!((line.width, line.height), (1, 7));
    assert!(line.heights.iter().all(|height| height.is_finite()));
}

/// Errors that are measured on these maps are comparable from version to version while this holds.
#[test]
fn slopes_stay_what_they_were() {
    for (name, expected) in [
        ("cylinders", 0.815),
        ("reptile_skin", 0.755),
        ("ripples", 0.23),
        ("dunes", 0.266),
        ("fbm", 0.709),
        ("fbm_smooth", 0.408),
        ("craters", 0.78),
    ] {
        let map = height_map(name).unwrap();
        let texels = f64::from(height_map_texels(name).unwrap());
        let squares =
            (0..i64::from(map.height)).flat_map(|row| (0..i64::from(map.width)).map(move |c| (c, row)));
        let sum: f64 = squares
            .map(|(column, row)| {
                let here = texel(&map, column, row);
                (texel(&map, column + 1, row) - here).powi(2) + (texel(&map, column, row + 1) - here).powi(2)
            })
            .sum();
        let slope = texels * (sum / map.heights.len() as f64).sqrt();
        assert!((slope / expected - 1.0).abs() < 0.01, "{name}: {slope}");
    }
}
