//! What several tests share.
#![allow(dead_code, reason = "each test uses its own part")]

use std::path::{Path, PathBuf};

use scene::{Limits, Scene};

/// A file of the test data, or nothing (and a word about it) where the data is absent.
pub(crate) fn test_data(file: &str) -> Option<PathBuf> {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    let folder = std::env::var_os("SHEEN_TEST_DATA").map_or_else(beside, PathBuf::from);
    let path = folder.join(file);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: test data absent");
    None
}

/// Loads a file of the test data, checks the scene and prints how long loading took.
pub(crate) fn load_test_data(file: &str) -> Option<Scene> {
    let path = test_data(file)?;
    let start = std::time::Instant::now();
    let scene = scene::load::load_scene(&path, &Limits::default()).unwrap();
    println!("{file}: {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
    scene.check().unwrap();
    Some(scene)
}

/// An empty folder of a test's own.
pub(crate) fn empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}
