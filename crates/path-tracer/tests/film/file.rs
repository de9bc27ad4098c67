//! Films as files, also broken ones.

use crate::common::{empty, film};
use exr::prelude::*;
use path_tracer::Film;
use proptest::prelude::{ProptestConfig, any, prop_assert, proptest};

#[test]
fn a_file_keeps_every_bit() {
    let mut odd = film(5..9);
    odd.add(17, [f64::NAN, 1e300, 0.0]);
    odd.add(18, [0.0, 1e300, 0.0]);
    odd.finish_samples(100..102).unwrap();
    for film in [empty(), film(0..1), film(0..300), odd] {
        let bytes = film.to_exr().unwrap();
        assert_eq!(Film::from_exr(&bytes, "a.exr").unwrap(), film);
        assert_eq!(film.to_exr().unwrap(), bytes, "the same bytes each time");
    }
}

#[test]
fn other_programs_see_the_mean_and_the_variance() {
    let film = film(0..8);
    let bytes = film.to_exr().unwrap();
    let read = || exr::image::read::read().no_deep_data().largest_resolution_level().all_channels();
    let image =
        read().first_valid_layer().all_attributes().from_buffered(std::io::Cursor::new(&bytes)).unwrap();
    let layer = image.layer_data;
    let plane = |name: &str| -> Vec<f32> {
        let channel = layer.channel_data.list.iter().find(|channel| channel.name.eq(name)).unwrap();
        match &channel.sample_data {
            FlatSamples::F32(values) => values.clone(),
            other => panic!("{other:?}"),
        }
    };
    let channel =
        |pixels: &[[f32; 3]], index: usize| pixels.iter().map(|pixel| pixel[index]).collect::<Vec<_>>();
    for (index, name) in ["R", "G", "B"].into_iter().enumerate() {
        assert_eq!(plane(name), channel(&film.mean(), index));
        assert_eq!(plane(&format!("variance.{name}")), channel(&film.variance_of_mean(), index));
    }
    let Some(AttributeValue::Text(text)) = layer.attributes.other.get(&Text::from("sheenFilm")) else {
        panic!("{:?}", layer.attributes)
    };
    let text = std::str::from_utf8(text.as_slice()).unwrap();
    assert!(text.contains("fingerprint 0123456789abcdef00000000000000ff\n"), "{text}");
    assert!(text.contains("samples 0..8\n") && text.contains("scene Überlänge.toml\n"), "{text}");
    // The scene crate's own reader takes it as a picture.
    let (picture, _) =
        scene::load::environment_from_bytes("a.exr", &bytes, &scene::Limits::default()).unwrap();
    assert_eq!(picture.pixels, film.mean());
}

#[test]
fn a_million_pixels_pass() {
    let mut large = Film::new([1024, 1024], crate::common::identity()).unwrap();
    large.add(1024 * 1024 - 1, [0.5, 7.0, 1e6]);
    large.finish_samples(0..1).unwrap();
    let bytes = large.to_exr().unwrap();
    assert_eq!(Film::from_exr(&bytes, "a.exr").unwrap(), large);
}

/// The message for bytes that are no film.
#[track_caller]
fn refusal(bytes: &[u8]) -> String {
    let error = Film::from_exr(bytes, "bad.exr").unwrap_err();
    assert_eq!(error.file, "bad.exr", "{error}");
    assert!(!error.place.is_empty() && !error.found.is_empty() && !error.expected.is_empty(), "{error:?}");
    error.to_string()
}

/// Replaces a part of the file by one of the same length.
fn replaced(from: &[u8], to: &[u8]) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let mut bytes = film(0..8).to_exr().unwrap();
    let place = bytes.windows(from.len()).position(|window| window == from).unwrap();
    bytes[place..place + to.len()].copy_from_slice(to);
    bytes
}

#[test]
fn what_is_no_film_is_refused() {
    assert!(refusal(b"").contains("byte 0: found an empty file, expected an EXR file"));
    assert!(refusal(b"\x89PNG\r\n\x1a\n").contains("found bytes 89 50 4e 47"));
    assert!(refusal(&[0x76, 0x2f, 0x31, 0x01]).contains("EXR header"));
    let mut picture = std::io::Cursor::new(Vec::new());
    Image::from_channels((4, 4), SpecificChannels::rgb(|_| (1_f32, 1_f32, 1_f32)))
        .write()
        .to_buffered(&mut picture)
        .unwrap();
    assert!(refusal(picture.get_ref()).contains("attribute sheenFilm: found none"));
}

#[test]
fn broken_descriptions_are_refused() {
    for (from, to, part) in [
        ("format 1\n", "format 2\n", "sheenFilm, format: found \"2\", expected 1"),
        ("samples 0..8", "samples 8..0", "samples: found \"8..0\", expected ranges"),
        ("samples 0..8", "samples 0.+8", "samples: found"),
        ("samples 0..8", "sample! 0..8", "expected a line \"samples ...\""),
        ("89abcdef", "89abcdeg", "expected 32 hexadecimal digits"),
        ("seed 1", "seed -", "seed: found"),
        ("seed 1", "seed\n1", "seed: found \"seed\""),
        ("max bounces 3\n", "max\nbounces 3\n", "samples: found \"bounces 3\""),
    ] {
        let error = refusal(&replaced(from.as_bytes(), to.as_bytes()));
        assert!(error.contains(part), "{error}");
    }
    assert!(refusal(&replaced("Überl".as_bytes(), b"\xff\xff\xff\xff\xff\xff")).contains("not UTF-8"));
    assert!(refusal(&replaced(b"sheenFilm\0string\0", b"sheenFilm\0strinx\0")).contains("no text"));
}

#[test]
fn broken_layouts_are_refused() {
    let channel = |name: &str, kind: u8| [name.as_bytes(), &[0, kind, 0, 0, 0]].concat();
    let error = refusal(&replaced(&channel("sum1.G", 0), &channel("sum1.H", 0)));
    assert!(error.contains("channel sum1.G: found none, expected UINT"), "{error}");
    let error = refusal(&replaced(&channel("sum1.G", 0), &channel("sum1.G", 2)));
    assert!(error.contains("channel sum1.G: found FLOAT, expected UINT"), "{error}");
    let error = refusal(&replaced(&channel("R", 2), &channel("R", 1)));
    assert!(error.contains("channel R: found HALF, expected FLOAT"), "{error}");
    // Both windows go from (0, 0) to (6, 18).
    let window = |right: i32, bottom: i32| {
        let corners: Vec<u8> = [0, 0, right, bottom].into_iter().flat_map(i32::to_le_bytes).collect();
        [b"Window\0box2i\0\x10\0\0\0".as_slice(), &corners].concat()
    };
    let error = refusal(&replaced(&window(6, 18), &window(6, 17)));
    assert!(error.contains("the same display and data window"), "{error}");
    for (right, bottom) in [(16384, 1), (9999, 9999), (8000, 8000), (i32::MAX - 1, i32::MAX - 1), (0, 0)] {
        let mut bytes = replaced(&window(6, 18), &window(right, bottom));
        let (old, new) = (window(6, 18), window(right, bottom));
        let place = bytes.windows(old.len()).rposition(|bytes| bytes == old).unwrap();
        bytes[place..place + new.len()].copy_from_slice(&new);
        refusal(&bytes);
    }
}

#[test]
fn sums_that_contradict_the_file_are_refused() {
    // Fewer samples than the sums are of.
    let error = refusal(&replaced(b"samples 0..8", b"samples 0..1"));
    assert!(error.contains("row 0: found"), "{error}");
    let error = refusal(&replaced(b"samples 0..8", b"samples 0..9"));
    assert!(error.contains("row 0: found a mean or variance that was changed"), "{error}");
}

#[test]
fn a_row_that_comes_twice_is_refused() {
    // Blocks begin with their first row and their length; the second is at row 16.
    let mut bytes = film(0..8).to_exr().unwrap();
    let offsets: Vec<usize> = {
        let end =
            bytes.windows(8).position(|window| window == (first_block(&bytes) as u64).to_le_bytes()).unwrap();
        (0..2)
            .map(|index| u64::from_le_bytes(bytes[end + 8 * index..][..8].try_into().unwrap()) as usize)
            .collect()
    };
    assert_eq!(bytes[offsets[1]..][..4], 16_i32.to_le_bytes());
    bytes[offsets[1]..][..4].copy_from_slice(&0_i32.to_le_bytes());
    refusal(&bytes);
}

/// Where the first block begins: behind the header, whose end is a zero, and two offsets.
fn first_block(bytes: &[u8]) -> usize {
    (0..bytes.len() - 8)
        .find(|&place| {
            let offset = u64::from_le_bytes(bytes[place..place + 8].try_into().unwrap());
            offset == place as u64 + 16
        })
        .unwrap()
        + 16
}

#[test]
fn every_truncation_is_refused() {
    let bytes = film(0..3).to_exr().unwrap();
    for length in 0..bytes.len() {
        refusal(&bytes[..length]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn no_bytes_panic(changes in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..6)) {
        let original = film(0..3);
        let mut bytes = original.to_exr().unwrap();
        for (place, value) in changes {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        // What is still taken must have the same numbers: a change is in the text, or in what does
        // not matter.
        if let Ok(film) = Film::from_exr(&bytes, "bad.exr") {
            prop_assert!(film.pixels() == original.pixels());
        }
    }
    #[test]
    fn no_header_panics(place in 0_usize..1800, value in any::<u8>()) {
        let mut bytes = film(0..3).to_exr().unwrap();
        bytes[place] = value;
        if let Err(error) = Film::from_exr(&bytes, "bad.exr") {
            prop_assert!(error.file == "bad.exr");
        }
    }
}
