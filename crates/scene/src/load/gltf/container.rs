//! Takes a `.glb` apart and parses the JSON.

use ::gltf::json;

use crate::{Error, Limits};

const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;

/// The JSON text, and the binary chunk if there is one.
pub(super) fn split<'a>(name: &str, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>), Error> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None));
    }
    let word = |offset: usize| {
        let word = offset
            .checked_add(4)
            .and_then(|end| bytes.get(offset..end))
            .and_then(|word| word.try_into().ok());
        word.map(u32::from_le_bytes)
            .ok_or_else(|| Error::new(name, format!("byte {offset}"), "the end of the file", "4 bytes"))
    };
    let version = word(4)?;
    if version != 2 {
        return Err(Error::new(name, "byte 4", format!("GLB version {version}"), "version 2"));
    }
    let length = word(8)? as usize;
    if length > bytes.len() {
        return Err(Error::new(name, "byte 8", format!("{} bytes", bytes.len()), format!("{length} bytes")));
    }
    let mut chunks = Vec::new();
    let mut offset = HEADER_BYTES;
    while offset < length {
        let chunk_length = word(offset)? as usize;
        let kind = word(offset + 4)?;
        let start = offset + CHUNK_HEADER_BYTES;
        let data =
            start.checked_add(chunk_length).and_then(|end| bytes.get(start..end)).ok_or_else(|| {
                let found = format!("a chunk of {chunk_length} bytes");
                Error::new(name, format!("byte {offset}"), found, "a chunk that ends within the file")
            })?;
        chunks.push((kind.to_le_bytes(), data));
        offset = start + chunk_length;
    }
    // Chunks of other kinds are to be skipped, wherever they stand after the first.
    let Some(((b"JSON", json), rest)) =
        chunks.split_first().map(|((kind, data), rest)| ((kind, *data), rest))
    else {
        return Err(Error::new(name, "byte 12", "no JSON chunk", "a JSON chunk first"));
    };
    let binary = rest.iter().find(|(kind, _)| kind == b"BIN\0").map(|(_, data)| *data);
    Ok((json, binary))
}

/// Parses the JSON. Numbers of objects are bounded first: a parsed object is far larger than its
/// two characters.
pub(super) fn parse(name: &str, json: &[u8], limits: &Limits) -> Result<json::Root, Error> {
    let objects = json.split(|&byte| byte == b'{').count() as u64;
    let most = limits.nodes.saturating_mul(16);
    if objects > most {
        return Err(Error::new(name, "JSON", format!("{objects} objects"), format!("at most {most}")));
    }
    let root: json::Root = json::deserialize::from_slice(json).map_err(|error| {
        let place = format!("JSON line {} column {}", error.line(), error.column());
        Error::new(name, place, error.to_string(), "glTF 2.0 JSON")
    })?;
    if !root.asset.version.starts_with("2.") {
        return Err(Error::new(name, "asset.version", format!("{:?}", root.asset.version), "\"2.0\""));
    }
    Ok(root)
}
