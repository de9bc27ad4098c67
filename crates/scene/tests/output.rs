//! Files are written whole or not at all.

use scene::output::{check_place, write_whole};
use std::fs;
use std::path::{Path, PathBuf};

/// A folder that is removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("sheen-output-{}-{name}", std::process::id()));
        fs::create_dir(&path).unwrap();
        Self(path)
    }

    fn names(&self) -> Vec<String> {
        let names = fs::read_dir(&self.0).unwrap();
        let mut names: Vec<_> =
            names.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).ok();
    }
}

#[test]
fn a_file_is_made_and_replaced() {
    let folder = Folder::new("made");
    let path = folder.0.join("a.bin");
    check_place(&path).unwrap();
    assert!(folder.names().is_empty(), "looking leaves nothing");
    write_whole(&path, b"one").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"one");
    check_place(&path).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"one");
    write_whole(&path, b"").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"");
    let long = "x".repeat(255);
    write_whole(&folder.0.join(&long), b"two").unwrap();
    assert_eq!(folder.names(), ["a.bin", &long]);
}

#[test]
fn a_place_that_is_none_is_refused() {
    let folder = Folder::new("refused");
    fs::write(folder.0.join("file"), "old").unwrap();
    fs::create_dir(folder.0.join("folder")).unwrap();
    for (name, part) in [
        ("none/x", "no such folder"),
        ("file/x", "no folder to be in"),
        ("folder", "found a folder"),
        ("..", "found a folder"),
    ] {
        let path = folder.0.join(name);
        let written = write_whole(&path, b"new").unwrap_err();
        assert_eq!(written, check_place(&path).unwrap_err());
        let message = written.to_string();
        assert!(message.starts_with(&path.display().to_string()) && message.contains(part), "{message}");
    }
    assert!(write_whole(Path::new(""), b"new").is_err());
    let too_long = folder.0.join("x".repeat(256));
    write_whole(&too_long, b"new").unwrap_err();
    assert_eq!(folder.names(), ["file", "folder"]);
    assert_eq!(fs::read(folder.0.join("file")).unwrap(), b"old");
}

#[cfg(target_os = "linux")]
#[test]
fn what_is_no_file_is_left_alone() {
    for (path, part) in
        [("/dev/full", "a device"), ("/dev/null", "a device"), ("/proc/x", "a place that can be written")]
    {
        let message = write_whole(Path::new(path), b"new").unwrap_err().to_string();
        assert!(message.starts_with(path) && message.contains(part), "{message}");
        assert_eq!(check_place(Path::new(path)).unwrap_err().to_string(), message);
    }
}

#[cfg(unix)]
#[test]
fn a_link_stays_and_its_file_is_replaced() {
    let folder = Folder::new("link");
    fs::create_dir(folder.0.join("elsewhere")).unwrap();
    let (target, link) = (folder.0.join("elsewhere/a.bin"), folder.0.join("link.bin"));
    fs::write(&target, "old").unwrap();
    std::os::unix::fs::symlink("elsewhere/a.bin", &link).unwrap();
    write_whole(&link, b"new").unwrap();
    assert_eq!(fs::read(&target).unwrap(), b"new");
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(folder.names(), ["elsewhere", "link.bin"]);
}

#[test]
fn writers_at_once_leave_one_whole_file() {
    let folder = Folder::new("threads");
    let path = folder.0.join("a.bin");
    let write = &|value: u8| write_whole(&path, &vec![value; 100_000]).unwrap();
    std::thread::scope(|scope| {
        for value in 0..8 {
            scope.spawn(move || (0..5).for_each(|_| write(value)));
        }
        for _ in 0..200 {
            let Ok(bytes) = fs::read(&path) else { continue };
            assert_eq!(bytes.len(), 100_000);
            assert!(bytes.iter().all(|&value| value == bytes[0]));
        }
    });
    assert_eq!(folder.names(), ["a.bin"]);
}

#[test]
fn what_a_killed_process_left_is_no_obstacle() {
    let folder = Folder::new("left");
    for count in 0..400 {
        let name = format!(".sheen-{}-{count}.partial", std::process::id());
        fs::write(folder.0.join(name), "half").unwrap();
    }
    write_whole(&folder.0.join("a.bin"), b"new").unwrap();
    assert_eq!(fs::read(folder.0.join("a.bin")).unwrap(), b"new");
}
