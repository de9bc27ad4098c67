//! Films as EXR files, and what such a file consists of.
//!
//! One part of scan lines, compressed without loss. `R`, `G`, `B` are the mean and `variance.R`, ...
//! the variance of the mean, both f32 and made from the sums. The sums are UINT channels:
//! `sum0.R` .. `sum2.R` are the limbs of the sum of a channel from the least significant 32 bits on,
//! `square0.R` .. `square3.R` those of the sum of its squares; `count.invalid` and `count.clamped`
//! are the counts of odd samples. The text attribute `sheenFilm` says what was rendered, one value a
//! line. All in one attribute, because the order of several would change from file to file.

use super::{Film, Identity, PixelSums, SampleRanges};
use ::exr::block::writer::ChunksWriter;
use ::exr::block::{self, BlockIndex, UncompressedBlock};
use ::exr::compression::Compression;
use ::exr::meta::attribute::{AttributeValue, ChannelDescription, LineOrder, SampleType, Text};
use ::exr::meta::header::{Header, LayerAttributes};
use ::exr::meta::{BlockDescription, Headers};
use rayon::prelude::*;
use scene::Error;
use std::io::Cursor;

/// Version of the file's layout.
const FORMAT: &str = "1";

/// The attribute that makes a picture a film.
pub(super) const ATTRIBUTE: &str = "sheenFilm";

const CHANNEL_NAMES: [&str; 3] = ["R", "G", "B"];
const SUM_LIMBS: u32 = 3;
const SQUARE_LIMBS: u32 = 4;

/// What a channel of the file holds of a pixel; all take 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    Mean(usize),
    Variance(usize),
    Sum { channel: usize, limb: u32 },
    Square { channel: usize, limb: u32 },
    Invalid,
    Clamped,
}

impl Content {
    pub(super) fn sample_type(self) -> SampleType {
        match self {
            Self::Mean(_) | Self::Variance(_) => SampleType::F32,
            _ => SampleType::U32,
        }
    }

    /// The bits of the pixel's sample. Mean and variance have to be given, since they take longer
    /// than once for each channel.
    pub(super) fn of(self, sums: &PixelSums, derived: &Derived) -> u32 {
        match self {
            Self::Mean(channel) => derived.mean[channel].to_bits(),
            Self::Variance(channel) => derived.variance[channel].to_bits(),
            Self::Sum { channel, limb } => (sums.sum[channel] >> (32 * limb)) as u32,
            Self::Square { channel, limb } => (sums.square[channel] >> (32 * limb)) as u32,
            Self::Invalid => sums.invalid,
            Self::Clamped => sums.clamped,
        }
    }

    /// Puts bits where [`Content::of`] took them; into sums of 0. Mean and variance follow from the
    /// sums.
    pub(super) fn place(self, sums: &mut PixelSums, bits: u32) {
        match self {
            Self::Mean(_) | Self::Variance(_) => {}
            Self::Sum { channel, limb } => sums.sum[channel] |= u128::from(bits) << (32 * limb),
            Self::Square { channel, limb } => sums.square[channel] |= u128::from(bits) << (32 * limb),
            Self::Invalid => sums.invalid = bits,
            Self::Clamped => sums.clamped = bits,
        }
    }
}

/// What follows from the sums of a pixel.
pub(super) struct Derived {
    mean: [f32; 3],
    variance: [f32; 3],
}

impl Derived {
    pub(super) fn of(sums: &PixelSums, count: u32) -> Self {
        Self { mean: sums.mean(count), variance: sums.variance_of_mean(count) }
    }
}

/// All channels of the file, by name as the format demands.
pub(super) fn channels() -> Vec<(String, Content)> {
    let mut channels =
        vec![("count.invalid".to_owned(), Content::Invalid), ("count.clamped".to_owned(), Content::Clamped)];
    for (channel, name) in CHANNEL_NAMES.into_iter().enumerate() {
        channels.push((name.to_owned(), Content::Mean(channel)));
        channels.push((format!("variance.{name}"), Content::Variance(channel)));
        for limb in 0..SUM_LIMBS {
            channels.push((format!("sum{limb}.{name}"), Content::Sum { channel, limb }));
        }
        for limb in 0..SQUARE_LIMBS {
            channels.push((format!("square{limb}.{name}"), Content::Square { channel, limb }));
        }
    }
    channels.sort_by(|a, b| a.0.cmp(&b.0));
    channels
}

/// See [`Film::to_exr`].
pub(super) fn encode(film: &Film) -> Result<Vec<u8>, Error> {
    write(film).map_err(|error| {
        Error::new(&film.identity.scene, "EXR encoder", error.to_string(), "a film that can be encoded")
    })
}

fn write(film: &Film) -> ::exr::error::Result<Vec<u8>> {
    let channels = channels();
    let headers: Headers = std::iter::once(header(film, &channels)).collect();
    let blocks: Vec<_> = block::enumerate_ordered_header_block_indices(&headers).collect();
    let chunks = blocks
        .into_par_iter()
        .map(|(index, block)| Ok((index, encode_block(film, &channels, &headers, block)?)))
        .collect::<::exr::error::Result<Vec<_>>>()?;
    let mut file = Cursor::new(Vec::new());
    block::write(&mut file, headers, true, |_, writer| {
        chunks.into_iter().try_for_each(|(index, chunk)| writer.write_chunk(index, chunk))
    })?;
    Ok(file.into_inner())
}

fn header(film: &Film, channels: &[(String, Content)]) -> Header {
    let list = channels
        .iter()
        .map(|(name, content)| ChannelDescription::new(text(name), content.sample_type(), false))
        .collect();
    let mut attributes = LayerAttributes {
        software_name: Some(text(&format!("Sheen {}", film.identity.version))),
        ..LayerAttributes::default()
    };
    attributes.other.insert(text(ATTRIBUTE), AttributeValue::Text(text(&description(film))));
    let size = (film.size[0] as usize, film.size[1] as usize);
    Header::new(text("film"), size, list)
        .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_attributes(attributes)
}

/// Text as its UTF-8 bytes; the crate itself would take Latin-1 only.
fn text(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

fn encode_block(
    film: &Film,
    channels: &[(String, Content)],
    headers: &Headers,
    index: BlockIndex,
) -> ::exr::error::Result<block::chunk::Chunk> {
    let count = film.samples_per_pixel();
    let width = film.size[0] as usize;
    let start = index.pixel_position.y() * width;
    let pixels = film.pixels.get(start..start + index.pixel_size.area()).unwrap_or_default();
    let derived: Vec<_> = pixels.iter().map(|sums| Derived::of(sums, count)).collect();
    let mut data = Vec::with_capacity(4 * channels.len() * pixels.len());
    for (row, derived) in pixels.chunks_exact(width).zip(derived.chunks_exact(width)) {
        for (_, content) in channels {
            for (sums, derived) in row.iter().zip(derived) {
                data.extend(content.of(sums, derived).to_ne_bytes());
            }
        }
    }
    UncompressedBlock { index, data }.compress_to_chunk(headers)
}

/// The keys of the attribute, in order.
const KEYS: [&str; 7] = ["format", "version", "scene", "fingerprint", "seed", "settings", "samples"];

/// The text of the attribute.
fn description(film: &Film) -> String {
    let Film { identity, size: _, samples, pixels: _ } = film;
    let values = [
        FORMAT.to_owned(),
        identity.version.clone(),
        identity.scene.clone(),
        identity.fingerprint_text(),
        identity.seed.to_string(),
        identity.settings.clone(),
        samples.to_string(),
    ];
    let lines: Vec<_> = KEYS.iter().zip(values).map(|(key, value)| format!("{key} {value}\n")).collect();
    lines.concat()
}

/// The identity and the samples that the attribute's text tells.
pub(super) fn parse_description(file: &str, text: &str) -> Result<(Identity, SampleRanges), Error> {
    let refused = |key: &str, found: String, expected: &str| {
        Error::new(file, format!("attribute {ATTRIBUTE}, {key}"), found, expected)
    };
    let mut lines = text.split_terminator('\n');
    let mut values = [""; KEYS.len()];
    for (value, key) in values.iter_mut().zip(KEYS) {
        let line = lines.next().unwrap_or_default();
        *value = line
            .strip_prefix(key)
            .and_then(|rest| rest.strip_prefix(' '))
            .ok_or_else(|| refused(key, excerpt(line), &format!("a line \"{key} ...\"")))?;
    }
    if let Some(line) = lines.next() {
        return Err(refused("end", excerpt(line), "no more lines"));
    }
    let [format, version, scene, fingerprint, seed, settings, samples] = values;
    if format != FORMAT {
        return Err(refused("format", excerpt(format), FORMAT));
    }
    let is_hexadecimal = fingerprint.len() == 32
        && fingerprint.bytes().all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f'));
    let fingerprint = Some(fingerprint)
        .filter(|_| is_hexadecimal)
        .and_then(|digits| u128::from_str_radix(digits, 16).ok())
        .ok_or_else(|| refused("fingerprint", excerpt(fingerprint), "32 hexadecimal digits"))?;
    let seed =
        seed.parse().map_err(|_| refused("seed", excerpt(seed), "a whole number from 0 to 2^64 - 1"))?;
    let samples = SampleRanges::parse(samples)
        .map_err(|refusal| refused("samples", refusal.found, &refusal.expected))?;
    let identity = Identity {
        scene: scene.into(),
        fingerprint,
        version: version.into(),
        seed,
        settings: settings.into(),
    };
    Ok((identity, samples))
}

/// The start of a text for a message.
fn excerpt(text: &str) -> String {
    let start: String = text.chars().take(60).collect();
    format!("{start:?}")
}
