//! Files that appear under their name only when they are whole.

use std::{
    fs::{self, File},
    io::{self, Write as _},
    path::Path,
};

/// Writes a file beside its final place and moves it there, after making its folder. The error
/// names the file; what was there before stays where anything fails.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let partial = folder.join(format!(".{name}.{}.partial", std::process::id()));
    let written = fs::create_dir_all(folder)
        .and_then(|()| File::create(&partial))
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(&partial, path));
    written.map_err(|error| {
        // Nothing to remove where it could not even be created.
        fs::remove_file(&partial).ok();
        io::Error::new(error.kind(), format!("{} cannot be written: {error}", path.display()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_cannot_be_written_leaves_nothing_behind() {
        let folder = std::env::temp_dir().join(format!("sheen-whole-file-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        // A folder under the final name makes the last step fail, after everything was written.
        let taken = folder.join("report.json");
        fs::create_dir_all(taken.join("inside")).unwrap();
        let error = write(&taken, b"{}").unwrap_err();
        assert!(error.to_string().contains("report.json cannot be written"), "{error}");
        let left: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(left, ["report.json"]);
        let fine = folder.join("new/page.html");
        write(&fine, b"a").unwrap();
        write(&fine, b"b").unwrap();
        assert_eq!(fs::read(&fine).unwrap(), b"b");
        fs::remove_dir_all(folder).unwrap();
    }
}
