//! Reads files that an untrusted file names, from that file's folder and nowhere else.

use std::path::{Component, Path};

use super::read_file;
use crate::Limits;

/// Why a named file was not read; the caller knows where it was named.
#[derive(Debug)]
pub(super) struct Refused {
    pub(super) found: String,
    pub(super) expected: String,
}

impl Refused {
    fn new(found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { found: found.into(), expected: expected.into() }
    }
}

/// The bytes of `relative`, a path with `/` between its parts, inside `folder`.
///
/// Refused are absolute paths, drive letters and URLs, `..`, and links that lead out of the
/// folder. Without a folder (a scene that came from memory) every path is refused.
pub(super) fn read_within(
    folder: Option<&Path>,
    relative: &str,
    limits: &Limits,
) -> Result<Vec<u8>, Refused> {
    let inside = "a relative path inside the file's own folder";
    let refuse = || Refused::new(format!("{relative:?}"), inside);
    let folder =
        folder.ok_or_else(|| Refused::new(format!("{relative:?}"), "no other file: there is no folder"))?;
    let path = Path::new(relative);
    let plain = |component| matches!(component, Component::Normal(_) | Component::CurDir);
    // A colon is a URL's scheme or a drive letter; a backslash separates folders on Windows.
    if relative.is_empty() || relative.contains([':', '\\', '\0']) || !path.components().all(plain) {
        return Err(refuse());
    }
    // A bare file name has the empty path as its parent.
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let unreadable =
        |error: std::io::Error| Refused::new(format!("{relative:?}: {error}"), "a readable file");
    let folder = folder.canonicalize().map_err(unreadable)?;
    let path = folder.join(path).canonicalize().map_err(unreadable)?;
    if !path.starts_with(&folder) {
        return Err(Refused::new(format!("{relative:?}, a link that leads out of the folder"), inside));
    }
    read_file(&path, limits)
        .map_err(|error| Refused::new(format!("{relative:?}: {}", error.found), error.expected))
}
