//! Files with known content: formats, windows, channels, values that are no radiance.

use exr::prelude::{Compression, Encoding, FlatSamples, LineOrder};
use half::f16;
use image::{DynamicImage, ImageFormat};
use scene::load::texture::texture_from_bytes;
use scene::load::{environment_from_bytes, height_map_from_bytes};
use scene::{ColorSpace, Environment, Limits, Repairs};

use super::files::{Layout, channel, encode, exr, numbered_rgb, radiance};

const LIMITS: Limits = Limits {
    file_bytes: 1 << 20,
    pixels: 1 << 16,
    texture_bytes: 1 << 20,
    triangles: 1 << 10,
    vertices: 1 << 10,
    nodes: 1 << 10,
    textures: 16,
    materials: 16,
};

const ENCODINGS: [Encoding; 4] = [
    Encoding::UNCOMPRESSED,
    Encoding { compression: Compression::ZIP16, ..Encoding::UNCOMPRESSED },
    Encoding { compression: Compression::PIZ, ..Encoding::UNCOMPRESSED },
    Encoding { line_order: LineOrder::Unspecified, ..Encoding::SMALL_FAST_LOSSLESS },
];

fn load(bytes: &[u8]) -> (Environment, Vec<scene::Warning>) {
    environment_from_bytes("made", bytes, &LIMITS).unwrap()
}

#[test]
fn exr_of_every_encoding_comes_back_exactly() {
    for encoding in ENCODINGS {
        let (environment, warnings) = load(&exr(Layout::plain(40, 20, encoding), numbered_rgb(800)));
        assert_eq!((environment.width, environment.height), (40, 20));
        for (index, pixel) in environment.pixels.iter().enumerate() {
            assert_eq!(*pixel, [0.0, 0.01, 0.02].map(|channel| index as f32 + channel), "{encoding:?}");
        }
        assert_eq!(warnings, []);
    }
}

#[test]
fn exr_data_window_is_placed_into_the_display_window() {
    // The data window starts one left of and two below the display window and ends beyond it.
    let layout = Layout {
        size: (6, 3),
        position: (9, 22),
        display_size: (4, 4),
        display_position: (10, 20),
        encoding: Encoding::UNCOMPRESSED,
    };
    let (environment, warnings) = load(&exr(layout, numbered_rgb(18)));
    assert_eq!((environment.width, environment.height), (4, 4));
    let red: Vec<f32> = environment.pixels.iter().map(|pixel| pixel[0]).collect();
    assert_eq!(red[..8], [0.0; 8]);
    assert_eq!(red[8..], [1.0, 2.0, 3.0, 4.0, 7.0, 8.0, 9.0, 10.0]);
    assert_eq!(warnings[0].place, "data window");
}

#[test]
fn exr_channels_are_found_by_name() {
    let layout = Layout::plain(2, 1, Encoding::UNCOMPRESSED);
    let halves = |values: [f32; 2]| FlatSamples::F16(values.map(f16::from_f32).to_vec());
    let floats = |values: [f32; 2]| FlatSamples::F32(values.to_vec());

    let grey = exr(layout, vec![channel("Y", halves([0.25, 4.0]))]);
    assert_eq!(load(&grey).0.pixels, [[0.25; 3], [4.0; 3]]);

    // Alpha is neither multiplied in nor divided out; other channels are not looked at.
    let mixed = exr(
        layout,
        vec![
            channel("A", halves([0.5, 0.0])),
            channel("B", halves([3.0, 30.0])),
            channel("G", floats([2.0, 20.0])),
            channel("R", FlatSamples::U32(vec![1, 10])),
            channel("Z", floats([9.0, 9.0])),
        ],
    );
    assert_eq!(load(&mixed).0.pixels, [[1.0, 2.0, 3.0], [10.0, 20.0, 30.0]]);

    let without = exr(layout, vec![channel("U", floats([0.0, 0.0])), channel("R", floats([0.0, 0.0]))]);
    let error = environment_from_bytes("made", &without, &LIMITS).unwrap_err();
    assert_eq!(error.to_string(), "made: channels: found R, U, expected R, G, B; or Y");

    let heights = |name: &str| {
        let bytes = exr(layout, vec![channel(name, floats([-2.5, 7.0]))]);
        height_map_from_bytes("made", &bytes, &LIMITS).unwrap().0.heights
    };
    assert_eq!(heights("Y"), [-2.5, 7.0]);
    assert_eq!(heights("R"), [-2.5, 7.0]);
}

#[test]
fn values_that_are_no_radiance_are_replaced_counted_and_reported() {
    let layout = Layout::plain(4, 1, Encoding::UNCOMPRESSED);
    let bad = FlatSamples::F32(vec![f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 5.0]);
    let half_bad = [f16::INFINITY, f16::from_f32(-0.5), f16::ONE, f16::NAN];
    let bytes = exr(
        layout,
        vec![
            channel("R", bad.clone()),
            channel("G", FlatSamples::F16(half_bad.to_vec())),
            channel("B", FlatSamples::F32(vec![-0.0, 0.0, 1.0, 2.0])),
        ],
    );
    let (environment, warnings) = load(&bytes);
    assert_eq!(environment.pixels, [[0.0, 5.0, 0.0], [5.0, 0.0, 0.0], [0.0, 1.0, 1.0], [5.0, 0.0, 2.0]]);
    assert_eq!(environment.repairs, Repairs { nan: 2, infinite: 2, negative: 2 });
    assert_eq!(warnings[0].message, "replaced 2 NaN, 2 infinite and 2 negative channel values");

    let (heights, warnings) =
        height_map_from_bytes("made", &exr(layout, vec![channel("Y", bad)]), &LIMITS).unwrap();
    assert_eq!(heights.heights, [0.0, 0.0, 0.0, 5.0]);
    assert!(warnings[0].message.starts_with("3 heights"));
}

#[test]
fn radiance_headers_of_all_kinds_are_read() {
    let pixels = [[128, 64, 32, 129], [0, 0, 0, 0]];
    let expected = [[1.0, 0.5, 0.25], [0.0; 3]];
    for header in [
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe",
        "#?RGBE\nFORMAT=32-bit_rle_rgbe",
        "#?RADIANCE\n# a comment\nGAMMA=1\nPRIMARIES=0 0 0 0 0 0 0 0\nFORMAT=32-bit_rle_rgbe",
        "#?RADIANCE\nSOFTWARE\n",
    ] {
        // A blank line ends the header, so the last one brings its own.
        let bytes = if header.ends_with('\n') {
            radiance(header.trim_end(), "-Y 1 +X 2", &pixels)
        } else {
            radiance(header, "-Y 1 +X 2", &pixels)
        };
        assert_eq!(load(&bytes).0.pixels, expected, "{header}");
    }
    let (environment, warnings) =
        load(&radiance("#?RADIANCE\nEXPOSURE=4\nEXPOSURE=0.5", "-Y 1 +X 2", &pixels));
    assert_eq!(environment.pixels[0], [0.5, 0.25, 0.125]);
    assert!(warnings[0].message.contains("divided out"), "{warnings:?}");
    let (environment, warnings) = load(&radiance("#?RADIANCE\nEXPOSURE=0", "-Y 1 +X 2", &pixels));
    assert_eq!(environment.pixels[0], expected[0]);
    assert!(warnings[0].message.contains("ignored"), "{warnings:?}");
    for (header, dimensions) in
        [("#?RADIANCE\nFORMAT=32-bit_rle_xyze", "-Y 1 +X 2"), ("#?RADIANCE", "+Y 1 +X 2")]
    {
        assert!(environment_from_bytes("made", &radiance(header, dimensions, &pixels), &LIMITS).is_err());
    }
}

#[test]
fn a_shape_that_is_not_two_to_one_is_noticed() {
    let square = radiance("#?RADIANCE", "-Y 2 +X 2", &[[1, 1, 2, 128]; 4]);
    assert_eq!(load(&square).1[0].place, "image size");
}

#[test]
fn textures_of_every_depth_become_rgba_of_8_bits() {
    let load = |image: DynamicImage| {
        let bytes = encode(&image, ImageFormat::Png);
        texture_from_bytes("made", &bytes, ColorSpace::Srgb, &LIMITS).unwrap()
    };
    let rgba = image::RgbaImage::from_fn(3, 2, |x, y| image::Rgba([x as u8 * 100, y as u8 * 200, 7, 99]));
    let texture = load(rgba.clone().into());
    assert_eq!((texture.width, texture.height, texture.color_space), (3, 2, ColorSpace::Srgb));
    assert_eq!(texture.rgba, rgba.into_raw());

    let grey = image::GrayImage::from_raw(2, 1, vec![10, 250]).unwrap();
    assert_eq!(load(grey.into()).rgba, [10, 10, 10, 255, 250, 250, 250, 255]);

    let deep: Vec<u16> = vec![0, 128, 129, 65535];
    let grey = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(4, 1, deep).unwrap();
    let codes: Vec<u8> = load(grey.into()).rgba.chunks_exact(4).map(|pixel| pixel[0]).collect();
    assert_eq!(codes, [0, 0, 1, 255]);

    // JPEG is lossy; a plain area survives within a code.
    let plain = image::RgbImage::from_pixel(16, 16, image::Rgb([40, 120, 200]));
    let bytes = encode(&plain.into(), ImageFormat::Jpeg);
    let texture = texture_from_bytes("made", &bytes, ColorSpace::Linear, &LIMITS).unwrap();
    assert!(texture.rgba.chunks_exact(4).all(|pixel| {
        pixel.iter().zip([40_u8, 120, 200, 255]).all(|(&found, made)| found.abs_diff(made) <= 2)
    }));
}

#[test]
fn heights_of_png_are_codes_over_the_largest_code() {
    let heights = |image: DynamicImage| {
        height_map_from_bytes("made", &encode(&image, ImageFormat::Png), &LIMITS).unwrap().0.heights
    };
    let deep = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(3, 1, vec![0, 1, 65535]).unwrap();
    assert_eq!(heights(deep.into()), [0.0, 1.0 / 65535.0, 1.0]);
    let shallow = image::GrayImage::from_raw(3, 1, vec![0, 1, 255]).unwrap();
    assert_eq!(heights(shallow.into()), [0.0, 1.0 / 255.0, 1.0]);
    let color = image::RgbImage::from_raw(1, 1, vec![51, 255, 0]).unwrap();
    assert_eq!(heights(color.into()), [0.2]);
}
