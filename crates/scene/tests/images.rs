//! Environments, height maps and textures: real files against their README, round trips, and
//! files that lie or are damaged.

#![allow(clippy::float_cmp, reason = "exact values are what is tested")]

#[path = "images/files.rs"]
mod files;
#[path = "images/hostile.rs"]
mod hostile;
#[path = "images/made.rs"]
mod made;

use glam::Vec3;
use scene::load::{environment, height_map};
use scene::{Environment, HeightMap, Limits, Repairs};

use files::test_data;

/// The largest channel value of a texel.
fn brightest(pixel: &[f32; 3]) -> f32 {
    pixel.iter().copied().fold(0.0, f32::max)
}

fn mean_luminance(environment: &Environment) -> f32 {
    environment.mean_radiance().dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Size, peak and mean luminance as the data's README states them, to its digits.
#[test]
fn real_environments_are_as_their_readme_says() {
    for (file, size, peak_value, peak_place, mean) in [
        ("rooitou_park_1k.hdr", (1024, 512), 69120.0, Some((226, 614)), 0.756),
        ("potsdamer_platz_1k.hdr", (1024, 512), 11.8, Some((197, 366)), 0.558),
        ("studio_small_03_1k.hdr", (1024, 512), 3568.0, Some((133, 235)), 2.22),
        ("hotel_room_1k.exr", (1024, 512), 33952.0, Some((108, 465)), 1.05),
        ("stage_env_latlong.exr", (1000, 500), 4096.0, Some((108, 565)), 3.51),
        ("orientation_latlong.exr", (1024, 512), 0.996, None, 0.928),
    ] {
        let Some(path) = test_data(&format!("hdri/{file}")) else { return };
        let (environment, warnings) = environment(&path, &Limits::default()).unwrap();
        let peak = environment.pixels.iter().map(brightest).fold(0.0, f32::max);
        let found_mean = mean_luminance(&environment);
        println!("{file}: peak {peak}; mean {found_mean}; {warnings:?}");
        assert_eq!(environment.name, file);
        assert_eq!((environment.width, environment.height), size);
        assert!((peak / peak_value - 1.0).abs() < 5e-3, "{file}: peak {peak}");
        if let Some((row, column)) = peak_place {
            assert_eq!(
                brightest(&environment.pixels[row * environment.width as usize + column]),
                peak,
                "{file}"
            );
        }
        assert!((found_mean / mean - 1.0).abs() < 5e-3, "{file}: mean {found_mean}");
        assert_eq!(warnings.len(), usize::from(file == "hotel_room_1k.exr"), "{warnings:?}");
    }
}

/// The README counts 5053 pixels of this file with a negative channel.
#[test]
fn negative_values_of_a_real_environment_are_counted_and_replaced() {
    let Some(path) = test_data("hdri/hotel_room_1k.exr") else { return };
    let raw = exr::prelude::read_first_rgba_layer_from_file(
        &path,
        |size, _| (size.0, Vec::<[f32; 3]>::new()),
        |(_, pixels): &mut (usize, Vec<[f32; 3]>), _, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels.push([r, g, b]);
        },
    )
    .unwrap()
    .layer_data
    .channel_data
    .pixels
    .1;
    let is_negative = |value: &f32| *value < 0.0;
    assert_eq!(raw.iter().filter(|pixel| pixel.iter().any(is_negative)).count(), 5053);

    let (environment, warnings) = environment(&path, &Limits::default()).unwrap();
    let negative = raw.as_flattened().iter().filter(|value| is_negative(value)).count();
    println!("{negative} negative channel values");
    assert_eq!(environment.repairs, Repairs { nan: 0, infinite: 0, negative });
    assert!(warnings[0].message.contains(&negative.to_string()), "{warnings:?}");
    assert!(environment.pixels.as_flattened().iter().all(|value| *value >= 0.0));
    for (kept, raw) in environment.pixels.as_flattened().iter().zip(raw.as_flattened()) {
        assert_eq!(*kept, raw.max(0.0));
    }
}

/// The test card puts +Z in the middle, +X a quarter to the left, -X a quarter to the right and
/// -Z at the edge. Our middle is +X and a quarter to its right is +Z: the same hand, so a turn of
/// -90 degrees about Y makes every axis of the world meet its name on the card.
#[test]
fn directions_land_on_the_texels_of_the_test_card() {
    let Some(path) = test_data("hdri/orientation_latlong.exr") else { return };
    let (mut card, _) = environment(&path, &Limits::default()).unwrap();
    card.rotation_rad = -std::f32::consts::FRAC_PI_2;
    let halfway = std::f32::consts::FRAC_1_SQRT_2;
    for (direction_world, column, row) in [
        (Vec3::Z, 512, 256),
        (Vec3::X, 256, 256),
        (Vec3::NEG_X, 768, 256),
        (Vec3::NEG_Z, 1024, 256),
        (Vec3::new(0.0, halfway, halfway), 512, 128),
        (Vec3::new(0.0, -halfway, halfway), 512, 384),
    ] {
        // The direction falls on the corner that four texels share.
        let around = [[column - 1, row - 1], [column, row - 1], [column - 1, row], [column, row]];
        let texel = |[x, y]: [usize; 2]| Vec3::from(card.pixels[y * 1024 + x % 1024]);
        let mean = around.into_iter().map(texel).sum::<Vec3>() / 4.0;
        let found = card.radiance_world(direction_world);
        assert!((found - mean).length() < 1e-4, "{direction_world}: {found} {mean}");
    }
}

fn range(map: &HeightMap) -> (f32, f32) {
    map.heights.iter().fold((f32::MAX, f32::MIN), |(least, most), &h| (least.min(h), most.max(h)))
}

#[test]
fn real_height_maps_are_as_their_readme_says() {
    for (file, size, (least, most), largest_code, distinct) in [
        ("brick_height_16.png", (1024, 1024), (0.0, 65535.0), 65535.0, Some(40567)),
        ("jacksboro_dem_16.png", (403, 344), (236.0, 1076.0), 65535.0, Some(817)),
        ("plain_heightmap_8.png", (512, 512), (0.0, 252.0), 255.0, None),
    ] {
        let Some(path) = test_data(&format!("height/{file}")) else { return };
        let (map, warnings) = height_map(&path, &Limits::default()).unwrap();
        let mut codes: Vec<u32> =
            map.heights.iter().map(|height| (height * largest_code).round() as u32).collect();
        codes.sort_unstable();
        codes.dedup();
        println!("{file}: {:?}, {} distinct", range(&map), codes.len());
        assert_eq!((map.width, map.height), size);
        assert_eq!(range(&map), (least / largest_code, most / largest_code), "{file}");
        assert!(distinct.is_none_or(|distinct| distinct == codes.len()), "{file}: {}", codes.len());
        assert!(warnings.is_empty());
    }
}
