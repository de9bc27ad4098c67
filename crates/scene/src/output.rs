//! Files that are made: written whole or not at all.

use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use crate::Error;

/// Writes a file beside its final place and moves it there, so that nobody ever sees half of it: at
/// every moment, also after an interruption or on a full disk, the path shows what was there before
/// or the whole new file.
///
/// A symbolic link stays, and the file that it names is replaced. The error names the path and what
/// is wrong with it: its folder is missing or cannot be written, it is a folder or a device, the disk
/// is full; nothing is left behind then. Only a process that is killed in the middle leaves its
/// partial file, `.sheen-*.partial`.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let place = final_place(path)?;
    let (partial, mut file) = create_partial(path, &place)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    drop(file);
    written.and_then(|()| fs::rename(&partial, &place)).map_err(|error| {
        // The error that is told is the first one.
        fs::remove_file(&partial).ok();
        unwritable(path, &error)
    })
}

/// Whether [`write_whole`] would find its place, so that nobody waits for what cannot be kept: a file
/// is made beside the path and removed again. Errors as there, as far as they show without the bytes.
pub fn check_place(path: &Path) -> Result<(), Error> {
    let place = final_place(path)?;
    let (partial, _) = create_partial(path, &place)?;
    fs::remove_file(&partial).map_err(|error| unwritable(path, &error))
}

/// The path itself, or what it links to.
fn final_place(path: &Path) -> Result<PathBuf, Error> {
    let place = match fs::canonicalize(path) {
        Ok(place) => place,
        // There is no such file yet.
        Err(_) => path.to_owned(),
    };
    let folder = folder_of(&place);
    if !folder.is_dir() {
        let found = if folder.exists() { "no folder to be in" } else { "no such folder" };
        return Err(refused(path, found, "a folder that exists"));
    }
    match fs::metadata(&place) {
        Ok(metadata) if metadata.is_dir() => Err(refused(path, "a folder", "a file")),
        Ok(metadata) if !metadata.is_file() => {
            Err(refused(path, "a device, pipe or socket", "a regular file"))
        }
        _ => Ok(place),
    }
}

/// A new file in the same folder, since only there it can be moved from in one step. Its name does
/// not grow with the path's, which may be as long as names can be.
fn create_partial(path: &Path, place: &Path) -> Result<(PathBuf, File), Error> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let partial = folder_of(place).join(format!(".sheen-{}-{count}.partial", std::process::id()));
        match File::create_new(&partial) {
            Ok(file) => return Ok((partial, file)),
            // A process of the same number was killed here.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(unwritable(path, &error)),
        }
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

fn unwritable(path: &Path, error: &std::io::Error) -> Error {
    refused(path, &error.to_string(), "a place that can be written")
}

fn refused(path: &Path, found: &str, expected: &str) -> Error {
    Error::new(path.display().to_string(), "output", found, expected)
}
