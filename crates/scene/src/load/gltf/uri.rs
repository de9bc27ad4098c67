//! What a `uri` of a buffer or an image stands for.

use super::Document;
use crate::Error;
use crate::load::confined;

/// The bytes that a URI names: base64 data inside the URI, or a file in the document's folder.
pub(super) fn read(document: &Document, uri: &str, place: &str) -> Result<Vec<u8>, Error> {
    if let Some(data) = uri.strip_prefix("data:") {
        let Some((_, payload)) = data.split_once(";base64,") else {
            return Err(document.error(place, shorten(uri), "a data URI with ;base64,"));
        };
        return base64(payload).ok_or_else(|| document.error(place, shorten(uri), "base64 characters"));
    }
    let path = percent_decoded(uri)
        .ok_or_else(|| document.error(place, shorten(uri), "%-escapes of two digits that make UTF-8"))?;
    confined::read_within(document.folder, &path, document.limits)
        .map_err(|refused| document.error(place, refused.found, refused.expected))
}

/// The start of a URI, for messages.
fn shorten(uri: &str) -> String {
    let start: String = uri.chars().take(60).collect();
    if start.len() < uri.len() { format!("{start:?}...") } else { format!("{start:?}") }
}

/// Replaces `%41` by `A`; nothing where an escape is broken or the result is not UTF-8.
fn percent_decoded(uri: &str) -> Option<String> {
    let digit = |byte: Option<u8>| byte.and_then(|byte| (byte as char).to_digit(16)).map(|digit| digit as u8);
    let mut decoded = Vec::with_capacity(uri.len());
    let mut bytes = uri.bytes();
    while let Some(byte) = bytes.next() {
        let escaped = byte == b'%';
        decoded.push(if escaped { 16 * digit(bytes.next())? + digit(bytes.next())? } else { byte });
    }
    String::from_utf8(decoded).ok()
}

/// Decodes base64 in either alphabet, with or without padding; nothing on any other character.
fn base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=');
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut bits, mut bit_count) = (0_u32, 0);
    for character in text.bytes() {
        let value = match character {
            b'A'..=b'Z' => character - b'A',
            b'a'..=b'z' => character - b'a' + 26,
            b'0'..=b'9' => character - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return None,
        };
        bits = bits << 6 & 0xffff | u32::from(value);
        bit_count += 6;
        if bit_count >= 8 {
            bit_count -= 8;
            bytes.push((bits >> bit_count) as u8);
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::{base64, percent_decoded};

    #[test]
    fn base64_of_rfc_4648() {
        let pairs = [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYmE=", "fooba"),
            ("Zm9vYmFy", "foobar"),
        ];
        for (text, bytes) in pairs {
            assert_eq!(base64(text).as_deref(), Some(bytes.as_bytes()), "{text}");
        }
        assert_eq!(base64("-_8"), Some(vec![0xfb, 0xff]));
        assert_eq!(base64("Zm 9v"), None);
    }

    #[test]
    fn percent_escapes() {
        assert_eq!(percent_decoded("a%20b%C3%A9.png").as_deref(), Some("a bé.png"));
        assert_eq!(percent_decoded("a%2"), None);
        assert_eq!(percent_decoded("a%zz"), None);
        assert_eq!(percent_decoded("%ff"), None);
    }
}
