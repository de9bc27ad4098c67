//! Files that the tests make in memory, and where the real ones lie.

use std::io::Cursor;
use std::path::PathBuf;

use exr::prelude::*;

/// A file of the test data, if it is there.
pub(crate) fn test_data(file: &str) -> Option<PathBuf> {
    let root = std::env::var_os("SHEEN_TEST_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")),
        PathBuf::from,
    );
    let path = root.join(file);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: test data absent");
    None
}

/// A PNG or JPEG file of an image.
pub(crate) fn encode(image: &image::DynamicImage, format: image::ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// A flat, uncompressed Radiance file with any header lines and any dimension line.
pub(crate) fn radiance(header: &str, dimensions: &str, rgbe: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes = format!("{header}\n\n{dimensions}\n").into_bytes();
    bytes.extend(rgbe.as_flattened());
    bytes
}

/// One channel of an EXR file.
pub(crate) fn channel(name: &str, samples: FlatSamples) -> AnyChannel<FlatSamples> {
    AnyChannel::new(name, samples)
}

/// How an EXR file is laid out.
#[derive(Clone, Copy)]
pub(crate) struct Layout {
    pub(crate) size: (usize, usize),
    pub(crate) position: (i32, i32),
    pub(crate) display_size: (usize, usize),
    pub(crate) display_position: (i32, i32),
    pub(crate) encoding: Encoding,
}

impl Layout {
    /// Data window and display window alike.
    pub(crate) fn plain(width: usize, height: usize, encoding: Encoding) -> Self {
        Self {
            size: (width, height),
            position: (0, 0),
            display_size: (width, height),
            display_position: (0, 0),
            encoding,
        }
    }
}

/// An EXR file of one part.
pub(crate) fn exr(layout: Layout, channels: Vec<AnyChannel<FlatSamples>>) -> Vec<u8> {
    let layer = Layer::new(
        layout.size,
        LayerAttributes { layer_position: Vec2(layout.position.0, layout.position.1), ..Default::default() },
        layout.encoding,
        AnyChannels::sort(SmallVec::from_vec(channels)),
    );
    let display = IntegerBounds::new(layout.display_position, layout.display_size);
    let image = Image::new(ImageAttributes::new(display), layer);
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// R, G and B of 32-bit floats where every sample is its index plus a hundredth of its channel.
pub(crate) fn numbered_rgb(count: usize) -> Vec<AnyChannel<FlatSamples>> {
    ["R", "G", "B"]
        .iter()
        .enumerate()
        .map(|(index, name)| {
            let samples = (0..count).map(|sample| sample as f32 + index as f32 / 100.0).collect();
            channel(name, FlatSamples::F32(samples))
        })
        .collect()
}
