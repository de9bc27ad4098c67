//! Loaders: everything that reads a file.
//!
//! [`load_scene`] takes any file that describes a scene and looks at its extension. What a glTF
//! or OBJ file names is read from that file's own folder and from nowhere else; a TOML scene file
//! is the user's own and may point anywhere. Sizes are checked against [`Limits`] before memory
//! is taken. What was repaired, ignored or approximated ends up in [`Scene::warnings`].

mod confined;
mod decode;
mod environment;
mod exr_image;
mod gltf;
mod height_map;
mod linear_image;
mod obj;
mod repair;
mod scene_file;
pub mod texture;
mod texture_budget;
mod warnings;

use std::fs::File;
use std::io::Read;
use std::path::Path;

pub use environment::{environment, environment_from_bytes};
pub use gltf::gltf_from_bytes;
pub use height_map::{height_map, height_map_from_bytes};
pub use linear_image::{LinearImage, linear_image_from_bytes};
pub use obj::obj_from_bytes;
pub use scene_file::scene_file_from_str;

use crate::{Error, Limits, Scene};

/// Extensions of files that [`load_scene`] takes, in lower case.
const SCENE_EXTENSIONS: [&str; 4] = ["toml", "gltf", "glb", "obj"];
/// Extensions of environment maps, in lower case.
const ENVIRONMENT_EXTENSIONS: [&str; 2] = ["hdr", "exr"];

/// Whether [`load_scene`] takes files with this path's extension (`.toml`, `.gltf`, `.glb`,
/// `.obj`, in upper or lower case). The file itself is not looked at.
pub fn is_scene(path: &Path) -> bool {
    SCENE_EXTENSIONS.contains(&extension(path).as_str())
}

/// Whether this path's extension is that of an environment map (`.hdr`, `.exr`, in upper or lower
/// case). The file itself is not looked at.
pub fn is_environment(path: &Path) -> bool {
    ENVIRONMENT_EXTENSIONS.contains(&extension(path).as_str())
}

/// Loads a scene: a TOML scene file, a glTF (`.gltf`, `.glb`) or an OBJ with its materials.
///
/// The error names the file and the place in it, what was found and what was expected.
pub fn load_scene(path: &Path, limits: &Limits) -> Result<Scene, Error> {
    let name = path.display().to_string();
    let extension = extension(path);
    if !SCENE_EXTENSIONS.contains(&extension.as_str()) {
        let found = if extension.is_empty() { "none".to_owned() } else { format!(".{extension}") };
        return Err(Error::new(name, "extension", found, "a scene: .toml, .gltf, .glb or .obj"));
    }
    let bytes = read_file(path, limits)?;
    let folder = path.parent();
    match extension.as_str() {
        "toml" => {
            let text = std::str::from_utf8(&bytes).map_err(|error| {
                let place = format!("byte {}", error.valid_up_to());
                Error::new(&name, place, "bytes that are not UTF-8", "a TOML text in UTF-8")
            })?;
            scene_file_from_str(&name, text, folder, limits)
        }
        "obj" => obj_from_bytes(&name, &bytes, folder, limits),
        _ => gltf_from_bytes(&name, &bytes, folder, limits),
    }
}

/// The path's extension in lower case, or nothing.
fn extension(path: &Path) -> String {
    path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// A file's name without its folder, for [`Scene::name`].
fn short_name(name: &str) -> String {
    Path::new(name).file_name().map_or_else(|| name.to_owned(), |short| short.to_string_lossy().into_owned())
}

/// The bytes of a file that is no larger than `limits.file_bytes`.
///
/// The size is checked before memory is taken, and again while reading, since a file can grow
/// meanwhile. Errors name the path, and what is there instead.
pub fn read_file(path: &Path, limits: &Limits) -> Result<Vec<u8>, Error> {
    let refuse =
        |found: String, expected: &str| Error::new(path.display().to_string(), "file", found, expected);
    let unreadable = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::NotFound => refuse("no such file".into(), "a file that exists"),
        _ => refuse(error.to_string(), "a readable file"),
    };
    let too_large = |bytes: u64| {
        refuse(
            format!("{bytes} bytes or more"),
            &format!("at most {} bytes (Limits::file_bytes)", limits.file_bytes),
        )
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
