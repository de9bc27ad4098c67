//! Single channels of EXR files, placed into the display window.

use std::io::Cursor;

use exr::block::reader::ChunksReader;
use exr::meta::MetaData;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;

use super::decode::{check_size, contain};
use crate::{Error, Limits, Warning};

/// The wanted channels of one part of an EXR file.
pub(super) struct ExrImage {
    /// Pixels per row of the display window.
    pub(super) width: u32,
    /// Rows of the display window.
    pub(super) height: u32,
    /// `width * height` values for each channel, in the order asked for.
    pub(super) channels: Vec<Vec<f32>>,
    /// What was noticed.
    pub(super) warnings: Vec<Warning>,
}

/// Whether the bytes begin as every EXR file does.
pub(super) fn is_exr(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01])
}

/// Reads the first of the channel sets in `wanted` that some part of the file has, at its first
/// resolution level. Pixels of the display window outside the data window are 0, pixels of the
/// data window outside the display window are dropped.
pub(super) fn read(name: &str, bytes: &[u8], wanted: &[&[&str]], limits: &Limits) -> Result<ExrImage, Error> {
    contain(name, || {
        let meta_data = MetaData::read_from_buffered(Cursor::new(bytes), false)
            .map_err(|error| Error::new(name, "EXR header", error.to_string(), "a valid EXR header"))?;
        for header in &meta_data.headers {
            check_header(name, bytes, header, limits)?;
        }
        let (part, channels) = choose(name, &meta_data.headers, wanted)?;
        let header = meta_data
            .headers
            .get(part)
            .ok_or_else(|| Error::new(name, "EXR header", "no part", "at least one part"))?;
        decode(name, bytes, part, header, channels)
    })
}

/// Checks both windows and the bytes of all channels against the limits, because the decoder
/// allocates what the header says.
fn check_header(name: &str, bytes: &[u8], header: &Header, limits: &Limits) -> Result<(), Error> {
    let data = header.layer_size;
    check_size(name, data.0 as u64, data.1 as u64, limits)?;
    let display = header.shared_attributes.display_window.size;
    check_size(name, display.0 as u64, display.1 as u64, limits)?;

    let pixels = data.0 as u64 * data.1 as u64;
    let pixel_bytes: u64 =
        header.channels.list.iter().map(|channel| channel.sample_type.bytes_per_sample() as u64).sum();
    let allowed = limits.pixels.saturating_mul(16);
    if pixels.saturating_mul(pixel_bytes) > allowed {
        let found = format!("{} x {} pixels of {pixel_bytes} bytes", data.0, data.1);
        return Err(Error::new(name, "channels", found, format!("at most {allowed} bytes")));
    }
    // Each chunk has an eight-byte entry in the offset table.
    if header.chunk_count > bytes.len() / 8 {
        let found = format!("{} chunks in {} bytes", header.chunk_count, bytes.len());
        return Err(Error::new(name, "offset table", found, "at least 8 bytes a chunk"));
    }
    Ok(())
}

/// The first set of `wanted` that a flat part has, with the part's index.
fn choose<'a>(
    name: &str,
    headers: &[Header],
    wanted: &[&'a [&'a str]],
) -> Result<(usize, &'a [&'a str]), Error> {
    for (part, header) in headers.iter().enumerate().filter(|(_, header)| !header.deep) {
        for &channels in wanted {
            if channels.iter().all(|&channel| has_channel(header, channel)) {
                return Ok((part, channels));
            }
        }
    }
    let found: Vec<String> = headers
        .iter()
        .flat_map(|header| header.channels.list.iter().map(|channel| channel.name.to_string()))
        .take(16)
        .collect();
    let expected: Vec<String> = wanted.iter().map(|channels| channels.join(", ")).collect();
    Err(Error::new(name, "channels", found.join(", "), expected.join("; or ")))
}

fn has_channel(header: &Header, name: &str) -> bool {
    header.channels.list.iter().any(|channel| channel.name.eq(name))
}

/// Decodes the first level of one part, line by line, into the wanted channels.
fn decode(
    name: &str,
    bytes: &[u8],
    part: usize,
    header: &Header,
    wanted: &[&str],
) -> Result<ExrImage, Error> {
    let refused =
        |error: exr::error::Error| Error::new(name, "EXR pixels", error.to_string(), "a complete EXR image");
    let placement = Placement::of(header);
    let mut channels = vec![vec![0.0; placement.width * placement.height]; wanted.len()];
    // For each channel of the file: its sample type and its place in `wanted`, if it has one.
    let uses: Vec<_> = header
        .channels
        .list
        .iter()
        .map(|channel| (channel.sample_type, wanted.iter().position(|&wanted| channel.name.eq(wanted))))
        .collect();

    let mut samples_read = 0;
    exr::block::read(Cursor::new(bytes), false)
        .and_then(|reader| {
            reader.filter_chunks(false, |_, tile, block| {
                block.layer == part && tile.is_largest_resolution_level()
            })
        })
        .and_then(|chunks| {
            chunks.decompress_sequential(false, |meta_data, block| {
                let Some(header) = meta_data.headers.get(part) else { return Ok(()) };
                for line in block.lines(&header.channels) {
                    let Some(&(sample_type, Some(index))) = uses.get(line.location.channel) else { continue };
                    let position = line.location.position;
                    placement.place_line(
                        &mut channels[index],
                        (position.0, position.1),
                        samples(line.value, sample_type),
                    );
                    samples_read += line.location.sample_count;
                }
                Ok(())
            })
        })
        .map_err(refused)?;

    let expected = header.layer_size.0 * header.layer_size.1 * wanted.len();
    if samples_read != expected {
        return Err(Error::new(name, "EXR pixels", format!("{samples_read} samples"), expected.to_string()));
    }
    Ok(ExrImage {
        width: placement.width as u32,
        height: placement.height as u32,
        channels,
        warnings: notices(name, header),
    })
}

/// The samples of a line, of native byte order, as floats.
fn samples(bytes: &[u8], sample_type: SampleType) -> Vec<f32> {
    match sample_type {
        SampleType::F16 => {
            bytes.as_chunks().0.iter().map(|&sample| half::f16::from_ne_bytes(sample).to_f32()).collect()
        }
        SampleType::F32 => bytes.as_chunks().0.iter().map(|&sample| f32::from_ne_bytes(sample)).collect(),
        SampleType::U32 => {
            bytes.as_chunks().0.iter().map(|&sample| u32::from_ne_bytes(sample) as f32).collect()
        }
    }
}

/// Where the data window lies in the display window.
struct Placement {
    width: usize,
    height: usize,
    /// Position of the data window's first pixel in the display window; may be negative.
    offset: [i64; 2],
}

impl Placement {
    fn of(header: &Header) -> Self {
        let display = header.shared_attributes.display_window;
        let data = header.own_attributes.layer_position;
        Self {
            width: display.size.0,
            height: display.size.1,
            offset: [data.0 as i64 - display.position.0 as i64, data.1 as i64 - display.position.1 as i64],
        }
    }

    /// Copies what of a line, which starts at `position` of the data window, is displayed.
    fn place_line(&self, plane: &mut [f32], position: (usize, usize), samples: Vec<f32>) {
        let y = self.offset[1] + position.1 as i64;
        if y < 0 || y >= self.height as i64 {
            return;
        }
        let row = &mut plane[y as usize * self.width..][..self.width];
        let x_start = self.offset[0] + position.0 as i64;
        for (x, sample) in (x_start..).zip(samples) {
            if let Some(place) = usize::try_from(x).ok().and_then(|x| row.get_mut(x)) {
                *place = sample;
            }
        }
    }
}

/// Warns where the data window is not the display window.
fn notices(name: &str, header: &Header) -> Vec<Warning> {
    let warning = |place: &str, message: String| Warning { file: name.into(), place: place.into(), message };
    let mut warnings = Vec::new();
    let (data, display) = (header.data_window(), header.shared_attributes.display_window);
    if data != display {
        let message = format!(
            "{} x {} at ({}, {}) was placed into the display window, {} x {} at ({}, {})",
            data.size.0,
            data.size.1,
            data.position.0,
            data.position.1,
            display.size.0,
            display.size.1,
            display.position.0,
            display.position.1
        );
        warnings.push(warning("data window", message));
    }
    warnings
}
