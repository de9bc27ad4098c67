//! Files that are cut short, changed, or claim more than they hold: an error or a valid result,
//! never a panic, and never memory for what is only claimed.

use std::sync::LazyLock;

use exr::prelude::{Compression, Encoding};
use image::{DynamicImage, ImageFormat};
use proptest::prelude::*;
use scene::load::texture::texture_from_bytes;
use scene::load::{environment_from_bytes, height_map_from_bytes};
use scene::{ColorSpace, Limits};

use super::files::{Layout, encode, exr, numbered_rgb, radiance};

/// Small, so that a decoder that ignores the limit would show in the peak of memory.
fn limits() -> Limits {
    Limits { pixels: 4096, ..Limits::default() }
}

/// Every kind of file, small and valid, with its name.
fn valid_files() -> Vec<(&'static str, Vec<u8>)> {
    let picture = DynamicImage::from(image::RgbImage::from_fn(16, 8, |x, y| {
        image::Rgb([x as u8 * 16, y as u8 * 32, (x * y) as u8])
    }));
    let heights =
        image::ImageBuffer::<image::Luma<u16>, _>::from_fn(8, 8, |x, y| image::Luma([(x * y * 900) as u16]));
    let tiled = Encoding { compression: Compression::RLE, ..Encoding::SMALL_FAST_LOSSLESS };
    let encoding = |compression| Encoding { compression, ..Encoding::UNCOMPRESSED };
    let exr_of = |encoding| exr(Layout::plain(16, 8, encoding), numbered_rgb(128));
    let mut run_length = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 16\n".to_vec();
    for _ in 0..2 {
        run_length.extend([2, 2, 0, 16]);
        for component in 0..4 {
            run_length.extend([136, 100 + component, 8, 1, 2, 3, 4, 5, 6, 7, 128]);
        }
    }
    vec![
        ("png", encode(&picture, ImageFormat::Png)),
        ("png of 16 bits", encode(&heights.into(), ImageFormat::Png)),
        ("jpeg", encode(&picture, ImageFormat::Jpeg)),
        ("flat hdr", radiance("#?RADIANCE\nFORMAT=32-bit_rle_rgbe", "-Y 4 +X 8", &[[120, 3, 77, 130]; 32])),
        (
            "old run-length hdr",
            radiance("#?RADIANCE", "-Y 1 +X 9", &[[9, 8, 7, 128], [1, 1, 1, 4], [5, 5, 5, 5], [1, 1, 1, 3]]),
        ),
        ("run-length hdr", run_length),
        ("flat exr", exr_of(Encoding::UNCOMPRESSED)),
        ("zip exr", exr_of(encoding(Compression::ZIP16))),
        ("piz exr", exr_of(encoding(Compression::PIZ))),
        ("pxr24 exr", exr_of(encoding(Compression::PXR24))),
        ("b44 exr", exr_of(encoding(Compression::B44))),
        ("tiled exr", exr_of(tiled)),
    ]
}

/// Made once, since the property below runs thousands of times.
static FILES: LazyLock<Vec<(&str, Vec<u8>)>> = LazyLock::new(valid_files);

/// Tries every loader; true if one accepts. What is accepted must be well-formed.
fn accepted(bytes: &[u8]) -> bool {
    let limits = limits();
    let mut accepted = false;
    if let Ok((environment, _)) = environment_from_bytes("made", bytes, &limits) {
        assert_eq!(environment.pixels.len(), (environment.width * environment.height) as usize);
        assert!(environment.pixels.as_flattened().iter().all(|value| value.is_finite() && *value >= 0.0));
        accepted = true;
    }
    if let Ok((map, _)) = height_map_from_bytes("made", bytes, &limits) {
        assert_eq!(map.heights.len(), (map.width * map.height) as usize);
        assert!(map.heights.iter().all(|height| height.is_finite()));
        accepted = true;
    }
    if let Ok(texture) = texture_from_bytes("made", bytes, ColorSpace::Linear, &limits) {
        assert_eq!(texture.rgba.len(), (4 * texture.width * texture.height) as usize);
        accepted = true;
    }
    accepted
}

#[test]
fn whole_files_are_accepted_and_truncated_ones_refused() {
    for (kind, bytes) in valid_files() {
        assert!(accepted(&bytes), "{kind}");
        for part in 0..64 {
            let cut = &bytes[..bytes.len() * part / 64];
            // A JPEG decoder fills in what is missing, and of a PNG the last chunk and checksums
            // hold no pixels; all others must notice.
            let is_harmless = kind == "jpeg" || kind.starts_with("png") && bytes.len() - cut.len() <= 20;
            assert!(!accepted(cut) || is_harmless, "{kind} cut at {part}/64");
        }
    }
}

#[test]
fn claimed_sizes_are_refused_before_memory_is_taken() {
    let huge_png = {
        let mut bytes = valid_files().swap_remove(0).1;
        bytes[16..24].copy_from_slice(&[0x3f, 0xff, 0xff, 0xff, 0x3f, 0xff, 0xff, 0xff]);
        // The header's checksum has to fit, or the decoder stops there.
        let checksum = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
        bytes
    };
    assert!(texture_from_bytes("made", &huge_png, ColorSpace::Linear, &limits()).is_err());

    for dimensions in ["-Y 2000000000 +X 2000000000", "-Y 64 +X 65", "-Y 4000000000 +X 1", "-Y 0 +X 5"] {
        let bytes = radiance("#?RADIANCE", dimensions, &[[1, 2, 3, 4]; 8]);
        let error = environment_from_bytes("made", &bytes, &limits()).unwrap_err();
        assert_eq!(error.place, "image size", "{error}");
    }
    // Within the limits, but the file is far too short for so many rows.
    let bytes = radiance("#?RADIANCE", "-Y 16384 +X 8192", &[[1, 2, 3, 4]; 8]);
    let error = environment_from_bytes("made", &bytes, &Limits::default()).unwrap_err();
    assert!(error.found.starts_with("16384 rows in"), "{error}");

    // Both windows of an EXR file, each as large as its four numbers allow.
    let bytes = exr(Layout::plain(16, 8, Encoding::UNCOMPRESSED), numbered_rgb(128));
    for attribute in ["dataWindow\0box2i\0", "displayWindow\0box2i\0"] {
        let start = find(&bytes, attribute.as_bytes()) + attribute.len() + 4;
        for [least, most] in [[0, i32::MAX - 1], [i32::MIN + 1, i32::MAX - 1], [-60000, 60000]] {
            let mut bytes = bytes.clone();
            for (place, value) in [least, least, most, most].into_iter().enumerate() {
                bytes[start + 4 * place..][..4].copy_from_slice(&value.to_le_bytes());
            }
            let result = environment_from_bytes("made", &bytes, &Limits::default());
            assert!(result.is_err(), "{attribute} {least} {most}");
            assert!(height_map_from_bytes("made", &bytes, &Limits::default()).is_err());
        }
    }
    println!("peak of memory: {} KiB", peak_memory_kib().unwrap_or(0));
    // All of the above at once would take gigabytes.
    assert!(peak_memory_kib().is_none_or(|peak| peak < 512 * 1024));
}

/// Each run marker after another multiplies the run length by 256, until it overflows.
#[test]
fn endless_run_markers_are_an_error() {
    let mut pixels = vec![[1, 1, 1, 0]; 64];
    pixels[0] = [9, 9, 9, 128];
    let bytes = radiance("#?RADIANCE", "-Y 1 +X 8", &pixels);
    assert!(environment_from_bytes("made", &bytes, &limits()).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn changed_bytes_never_break_a_loader(
        file in 0_usize..12,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..12),
        near_the_start in any::<bool>(),
    ) {
        let (_, mut bytes) = FILES[file].clone();
        let range = if near_the_start { bytes.len().min(96) } else { bytes.len() };
        for (place, value) in changes {
            bytes[place.index(range)] = value;
        }
        accepted(&bytes);
    }
}

/// The checksum of PNG chunks.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ byte as u32, |crc, _| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg()))
    })
}

fn find(bytes: &[u8], pattern: &[u8]) -> usize {
    bytes.windows(pattern.len()).position(|window| window == pattern).unwrap()
}

/// The largest resident size of this process so far, where the system tells.
fn peak_memory_kib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().strip_suffix(" kB")?.parse().ok()
}
