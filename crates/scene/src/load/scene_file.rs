//! TOML scene files.
//!
//! ```toml
//! [camera]
//! eye = [0, 1.5, 4]
//! target = [0, 0.5, 0]
//! up = [0, 1, 0]                # this is the default
//! fov_y_deg = 40                # this is the default
//!
//! [environment]
//! file = "sky.hdr"              # or: builtin = "studio"
//! intensity = 1.0
//! rotation_deg = 0              # about +Y, counter-clockwise seen from above
//!
//! [[light]]
//! direction = [1, 2, 1]         # from the scene towards the light; any length but 0
//! irradiance = [3, 3, 2.5]      # on a surface that faces it; one number for grey
//! angular_diameter_deg = 0.53   # 0, the default, for a point at infinity
//!
//! [[object]]
//! file = "car.glb"              # .gltf, .glb or .obj; or: shape = "sphere"
//! translation = [0, 0, 0]
//! rotation = [0, 90, 0]         # degrees about the fixed axes: X first, then Y, then Z
//! scale = 1.0                   # or [x, y, z]; scaled first, then turned, then moved
//! base_color = [1, 0, 0]        # with or without opacity
//! metallic = 1.0
//! roughness = 0.2
//! ks = 0.04                     # or [r, g, b]
//! shininess = 200
//! spread_deg = 3
//! height_map = "bricks.png"      # or: builtin_height_map = "craters"
//! height_scale = 0.05           # metres between the map's 0 and 1
//! uv_scale = 4                  # or [u, v]
//!
//! [glare]                       # also [diffuse-envmap], [glossy-planes], [horizon-shadow]
//! ```
//!
//! Every table and key is optional, except `eye` and `target` of a camera, `direction` and
//! `irradiance` of a light, and one of `file` and `shape` (or `builtin`). Paths are relative to
//! the scene file and may point anywhere. The material keys replace what the object's file says
//! about all its materials, textures included. An unknown key is an error that names the nearest
//! known one. Objects that name the same file share its meshes.

mod build;
mod keys;
mod nearest;

use std::path::Path;

use crate::{Error, Limits, Scene};

/// Loads a scene from the text of a scene file.
///
/// `name` stands in messages; `folder` is what its paths are relative to, `None` for a text that
/// names no files. Errors name the line.
pub fn scene_file_from_str(
    name: &str,
    text: &str,
    folder: Option<&Path>,
    limits: &Limits,
) -> Result<Scene, Error> {
    let keys: keys::SceneKeys = toml::from_str(text).map_err(|error| {
        let place = error.span().map_or_else(|| "scene file".to_owned(), |span| line_of(text, span.start));
        let (found, expected) = nearest::explain(error.message());
        Error::new(name, place, found, expected)
    })?;
    build::build(name, text, folder, limits, keys)
}

/// The line, counted from 1, in which a byte stands.
fn line_of(text: &str, byte: usize) -> String {
    let before = text.as_bytes().get(..byte).unwrap_or(text.as_bytes());
    format!("line {}", before.split(|&byte| byte == b'\n').count())
}
