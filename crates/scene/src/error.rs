//! What can be wrong with an input, said so that its author can mend it.

use std::fmt;

/// Why an input was refused: the file, the place in it, what was found and what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {place}: found {found}, expected {expected}")]
pub struct Error {
    /// The file as the caller named it.
    pub file: String,
    /// Line, byte offset, node, accessor, key: as near as it is known.
    pub place: String,
    /// What stands there.
    pub found: String,
    /// What would have been accepted.
    pub expected: String,
}

impl Error {
    /// An error at a place in a file.
    pub fn new(
        file: impl Into<String>,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self { file: file.into(), place: place.into(), found: found.into(), expected: expected.into() }
    }
}

/// Something that was repaired, ignored or approximated; the input was still accepted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// The file as the caller named it.
    pub file: String,
    /// Where in the file.
    pub place: String,
    /// What was noticed and what was done about it.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {}: {}", self.file, self.place, self.message)
    }
}
