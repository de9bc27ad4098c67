//! Buffers and buffer views.

use std::borrow::Cow;

use ::gltf::json;

use super::{Document, uri};
use crate::Error;

/// The bytes of every buffer, each of exactly its `byteLength`; together no more than
/// `Limits::file_bytes`.
pub(super) fn load<'a>(
    document: &Document<'a>,
    binary_chunk: Option<&'a [u8]>,
) -> Result<Vec<Cow<'a, [u8]>>, Error> {
    let mut total = 0_u64;
    let mut buffers = Vec::with_capacity(document.root.buffers.len());
    for (index, buffer) in document.root.buffers.iter().enumerate() {
        let place = format!("buffers[{index}]");
        total = total.saturating_add(buffer.byte_length.0);
        if total > document.limits.file_bytes {
            let expected = format!("at most {} bytes in all buffers", document.limits.file_bytes);
            return Err(document.error(place, format!("{total} bytes or more"), expected));
        }
        let bytes = match (&buffer.uri, binary_chunk) {
            (Some(uri), _) => Cow::Owned(uri::read(document, uri, &format!("{place}.uri"))?),
            (None, Some(chunk)) if index == 0 => Cow::Borrowed(chunk),
            (None, _) => return Err(document.error(place, "no uri", "a uri, or the binary chunk of a .glb")),
        };
        let length = buffer.byte_length.0 as usize;
        if bytes.len() < length {
            let found = format!("{} bytes", bytes.len());
            return Err(document.error(format!("{place}.byteLength"), found, format!("{length} bytes")));
        }
        buffers.push(match bytes {
            Cow::Borrowed(bytes) => Cow::Borrowed(bytes.get(..length).unwrap_or_default()),
            Cow::Owned(mut bytes) => {
                bytes.truncate(length);
                Cow::Owned(bytes)
            }
        });
    }
    Ok(buffers)
}

/// The bytes of a view, and its stride if it has one.
pub(super) fn view<'a>(
    document: &'a Document,
    index: json::Index<json::buffer::View>,
    place: &str,
) -> Result<(&'a [u8], Option<usize>), Error> {
    let view = document.get(&document.root.buffer_views, index, place)?;
    let place = format!("bufferViews[{}]", index.value());
    let buffer = document.buffers.get(view.buffer.value()).ok_or_else(|| {
        document.error(
            format!("{place}.buffer"),
            format!("index {}", view.buffer.value()),
            "the index of a buffer",
        )
    })?;
    let (offset, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
    let bytes = offset
        .checked_add(length)
        .and_then(|end| buffer.get(usize::try_from(offset).ok()?..usize::try_from(end).ok()?))
        .ok_or_else(|| {
            let found = format!("{length} bytes from byte {offset}");
            document.error(place, found, format!("a range within the buffer's {} bytes", buffer.len()))
        })?;
    Ok((bytes, view.byte_stride.map(|stride| stride.0)))
}
