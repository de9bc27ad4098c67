//! Loaders: everything that reads a file.

mod decode;
mod environment;
mod exr_image;
mod height_map;
pub mod texture;

pub use environment::{environment, environment_from_bytes};
pub use height_map::{height_map, height_map_from_bytes};

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::{Error, Limits};

/// The bytes of a file that is no larger than `limits.file_bytes`.
///
/// The size is checked before memory is taken, and again while reading, since a file can grow
/// meanwhile. Errors name the path, and what is there instead.
pub(crate) fn read_file(path: &Path, limits: &Limits) -> Result<Vec<u8>, Error> {
    let refuse = |found: String, expected: &str| Error::new(path.display().to_string(), "file", found, expected);
    let unreadable = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::NotFound => refuse("no such file".into(), "a file that exists"),
        _ => refuse(error.to_string(), "a readable file"),
    };
    let too_large = |bytes: u64| {
        refuse(format!("{bytes} bytes or more"), &format!("at most {} bytes (Limits::file_bytes)", limits.file_bytes))
    };
    let metadata = std::fs::metadata(path).map_err(unreadable)?;
    if metadata.is_dir() {
        return Err(refuse("a folder".into(), "a file"));
    }
    if !metadata.is_file() {
        return Err(refuse("a device, pipe or socket".into(), "a regular file"));
    }
    if metadata.len() > limits.file_bytes {
        return Err(too_large(metadata.len()));
    }
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    let mut file = File::open(path).map_err(unreadable)?.take(limits.file_bytes.saturating_add(1));
    file.read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > limits.file_bytes {
        return Err(too_large(bytes.len() as u64));
    }
    Ok(bytes)
}
