//! Reads the files of [`super::exr`], which may be anything.

use super::exr::{ATTRIBUTE, Content, Derived, channels, parse_description};
use super::{Film, check_size};
use ::exr::block::reader::ChunksReader;
use ::exr::block::{self, UncompressedBlock};
use ::exr::compression::Compression;
use ::exr::meta::attribute::{AttributeValue, ChannelDescription, SampleType, Text};
use ::exr::meta::header::Header;
use ::exr::meta::{BlockDescription, MetaData};
use scene::Error;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// No deflated data becomes more than about 1032 times as long.
const GREATEST_EXPANSION: u64 = 1100;

/// See [`Film::from_exr`].
///
/// The decoder is another crate, whose arithmetic relies on wrapping here and there while this
/// workspace checks for overflow. A file must not be able to end the program: a panic of the decoder
/// is one more way to be refused, and leaves nothing half-made behind.
pub(super) fn decode(bytes: &[u8], file: &str) -> Result<Film, Error> {
    if !bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        let start: Vec<String> = bytes.iter().take(4).map(|byte| format!("{byte:02x}")).collect();
        let found =
            if bytes.is_empty() { "an empty file".into() } else { format!("bytes {}", start.join(" ")) };
        return Err(Error::new(file, "byte 0", found, "an EXR file"));
    }
    catch_unwind(AssertUnwindSafe(|| decode_exr(bytes, file))).unwrap_or_else(|_| {
        Err(Error::new(file, "EXR data", "data that the decoder cannot follow", "a valid EXR file"))
    })
}

/// See [`Film::is_film`].
pub(super) fn is_film(bytes: &[u8]) -> bool {
    let has_attribute = |header: &Header| header.own_attributes.other.contains_key(&attribute());
    let read = || MetaData::read_from_buffered(Cursor::new(bytes), false);
    catch_unwind(AssertUnwindSafe(read))
        .is_ok_and(|read| read.is_ok_and(|meta_data| meta_data.headers.iter().any(has_attribute)))
}

fn attribute() -> Text {
    Text::from_slice_unchecked(ATTRIBUTE.as_bytes())
}

fn decode_exr(bytes: &[u8], file: &str) -> Result<Film, Error> {
    let meta_data = MetaData::read_from_buffered(Cursor::new(bytes), false)
        .map_err(|error| Error::new(file, "EXR header", error.to_string(), "a valid EXR header"))?;
    let [header] = meta_data.headers.as_slice() else {
        let found = format!("{} parts", meta_data.headers.len());
        return Err(Error::new(file, "EXR header", found, "one part"));
    };
    let text = description(header, file)?;
    let (identity, samples) = parse_description(file, text)?;
    check_layout(header, file)?;
    let channels = channels();
    check_channels(&header.channels.list, &channels, file)?;
    let size = check_header_size(header, bytes, file)?;
    // Messages about the film itself name the file.
    let mut film = Film::new(size, identity).map_err(|error| Error { file: file.into(), ..error })?;
    film.samples = samples;
    let contents: Vec<Content> = channels.into_iter().map(|(_, content)| content).collect();
    fill(&mut film, bytes, &contents, file)?;
    Ok(film)
}

/// The attribute's text.
fn description<'a>(header: &'a Header, file: &str) -> Result<&'a str, Error> {
    let place = format!("attribute {ATTRIBUTE}");
    let expected = "a film, as sheen reference writes it";
    match header.own_attributes.other.get(&attribute()) {
        Some(AttributeValue::Text(text)) => std::str::from_utf8(text.as_slice())
            .map_err(|_| Error::new(file, place, "bytes that are not UTF-8", expected)),
        Some(_) => Err(Error::new(file, place, "a value that is no text", expected)),
        None => Err(Error::new(file, place, "none", expected)),
    }
}

/// Refuses what no film has: tiles, depth, lossy compression, windows that differ.
fn check_layout(header: &Header, file: &str) -> Result<(), Error> {
    let is_plain = !header.deep
        && header.blocks == BlockDescription::ScanLines
        && header.compression == Compression::ZIP16;
    if !is_plain {
        let found = format!("{} compression or tiles", header.compression);
        return Err(Error::new(file, "EXR header", found, "scan lines in zip blocks"));
    }
    let (data, display) = (header.data_window(), header.shared_attributes.display_window);
    if data != display || data.position.0 != 0 || data.position.1 != 0 {
        let expected = "the same display and data window, from (0, 0)";
        return Err(Error::new(file, "EXR header", format!("{display:?} and {data:?}"), expected));
    }
    Ok(())
}

/// Refuses any other channels than a film's.
fn check_channels(
    found: &[ChannelDescription],
    expected: &[(String, Content)],
    file: &str,
) -> Result<(), Error> {
    for (name, content) in expected {
        let place = format!("channel {name}");
        let expected = type_name(content.sample_type());
        let Some(channel) = found.iter().find(|channel| channel.name.eq(name)) else {
            return Err(Error::new(file, place, "none", expected));
        };
        if channel.sample_type != content.sample_type() {
            return Err(Error::new(file, place, type_name(channel.sample_type), expected));
        }
        if channel.sampling.0 != 1 || channel.sampling.1 != 1 {
            return Err(Error::new(file, place, "fewer samples than pixels", "one sample a pixel"));
        }
    }
    let is_same = found
        .iter()
        .map(|channel| channel.name.as_slice())
        .eq(expected.iter().map(|(name, _)| name.as_bytes()));
    if is_same {
        return Ok(());
    }
    let count = format!("{} in all, or not by name", found.len());
    Err(Error::new(file, "channels", count, format!("the {} of a film, by name", expected.len())))
}

fn type_name(sample_type: SampleType) -> &'static str {
    match sample_type {
        SampleType::U32 => "UINT",
        SampleType::F16 => "HALF",
        SampleType::F32 => "FLOAT",
    }
}

/// The film's size, if it is within the limits and the file is long enough for it.
fn check_header_size(header: &Header, bytes: &[u8], file: &str) -> Result<[u32; 2], Error> {
    let side = |side: usize| u32::try_from(side).unwrap_or(u32::MAX);
    let size = [side(header.layer_size.0), side(header.layer_size.1)];
    check_size(file, size)?;
    let length = bytes.len() as u64;
    let pixel_bytes = u64::from(size[0]) * u64::from(size[1]) * header.channels.bytes_per_pixel as u64;
    // Each chunk has an eight-byte entry in the offset table.
    if pixel_bytes / GREATEST_EXPANSION > length || header.chunk_count as u64 > length / 8 {
        let found = format!("{} x {} pixels in {length} bytes", size[0], size[1]);
        return Err(Error::new(file, "film size", found, "a longer file"));
    }
    Ok(size)
}

/// Reads all blocks, each of whose rows has to come once.
fn fill(film: &mut Film, bytes: &[u8], contents: &[Content], file: &str) -> Result<(), Error> {
    let mut refusal = None;
    let mut rows_left = vec![true; film.size[1] as usize];
    let read = block::read(Cursor::new(bytes), false).and_then(|reader| reader.all_chunks(false)).and_then(
        |chunks| {
            chunks.decompress_sequential(false, |_, block| {
                place_block(film, &block, contents, &mut rows_left).map_err(|(place, found, expected)| {
                    refusal = Some(Error::new(file, place, found, expected));
                    ::exr::error::Error::Invalid("film".into())
                })
            })
        },
    );
    if let Some(error) = refusal {
        return Err(error);
    }
    read.map_err(|error| Error::new(file, "EXR pixels", error.to_string(), "all pixels"))?;
    match rows_left.iter().position(|&is_left| is_left) {
        None => Ok(()),
        Some(row) => Err(Error::new(file, format!("row {row}"), "no pixels", "all pixels")),
    }
}

/// Place, found and expected.
type Refused = (String, String, String);

/// Puts the sums of a block of whole rows into the film and compares what follows from them with
/// what the file says.
fn place_block(
    film: &mut Film,
    block: &UncompressedBlock,
    contents: &[Content],
    rows_left: &mut [bool],
) -> Result<(), Refused> {
    let (width, count) = (film.size[0] as usize, film.samples_per_pixel());
    let first_row = block.index.pixel_position.y();
    let row_bytes = 4 * width * contents.len();
    for (row, data) in (first_row..).zip(block.data.chunks_exact(row_bytes)) {
        let refused = |found: &str, expected: &str| (format!("row {row}"), found.into(), expected.into());
        let is_new = rows_left.get_mut(row).is_some_and(std::mem::take);
        let Some(pixels) = film.pixels.get_mut(row * width..(row + 1) * width).filter(|_| is_new) else {
            return Err(refused("the row twice, or beyond the picture", "each row once"));
        };
        let lines = || data.chunks_exact(4 * width).zip(contents);
        for (line, content) in lines() {
            for (sums, bits) in pixels.iter_mut().zip(line.as_chunks().0) {
                content.place(sums, u32::from_ne_bytes(*bits));
            }
        }
        if !pixels.iter().all(|sums| sums.is_possible(count)) {
            return Err(refused("greater sums", &format!("sums that {count} samples can have")));
        }
        let derived: Vec<_> = pixels.iter().map(|sums| Derived::of(sums, count)).collect();
        for (line, content) in lines() {
            let samples = line.as_chunks().0.iter().map(|bits| u32::from_ne_bytes(*bits));
            let expected = pixels.iter().zip(&derived).map(|(sums, derived)| content.of(sums, derived));
            if !samples.eq(expected) {
                return Err(refused("a mean or variance that was changed", "that of the sums"));
            }
        }
    }
    Ok(())
}
