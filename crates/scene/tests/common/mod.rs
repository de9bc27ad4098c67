//! What several tests share.
#![allow(dead_code, reason = "each test uses its own part")]

use std::path::{Path, PathBuf};

use scene::{Limits, Scene};
use serde_json::{Value, json};

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

/// A PNG of one colour.
pub(crate) fn png(width: u32, height: u32, rgba: [u8; 4]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_pixel(width, height, image::Rgba(rgba));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// Base64 with padding.
pub(crate) fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let bits =
            chunk.iter().fold(0_u32, |bits, &byte| bits << 8 | u32::from(byte)) << (8 * (3 - chunk.len()));
        for place in 0..4 {
            let character = ALPHABET[(bits >> (18 - 6 * place) & 63) as usize] as char;
            text.push(if place <= chunk.len() { character } else { '=' });
        }
    }
    text
}

/// Puts a glTF together: JSON that tests may change, and one buffer.
pub(crate) struct GltfBuilder {
    pub(crate) json: Value,
    pub(crate) buffer: Vec<u8>,
}

impl GltfBuilder {
    /// A file with nothing in it.
    pub(crate) fn new() -> Self {
        Self {
            json: json!({"asset": {"version": "2.0"}, "accessors": [], "bufferViews": []}),
            buffer: Vec::new(),
        }
    }

    /// A file with a scene of one node that has one triangle: (0,0,0), (1,0,0), (0,1,0).
    pub(crate) fn triangle() -> Self {
        let mut builder = Self::new();
        let positions = builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let indices = builder.accessor(5121, "SCALAR", 3, &[0, 1, 2]);
        builder.json["meshes"] = json!([{"name": "triangle", "primitives": [{"attributes": {"POSITION": positions}, "indices": indices}]}]);
        builder.json["nodes"] = json!([{"name": "node", "mesh": 0}]);
        builder.json["scenes"] = json!([{"nodes": [0]}]);
        builder
    }

    /// Adds a view of the bytes and returns its index.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        let view = json!({"buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len()});
        self.buffer.extend_from_slice(bytes);
        push(&mut self.json["bufferViews"], view)
    }

    /// Adds an accessor with a view of its own and returns its index.
    pub(crate) fn accessor(&mut self, component: u32, kind: &str, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let accessor = json!({"bufferView": view, "componentType": component, "type": kind, "count": count});
        push(&mut self.json["accessors"], accessor)
    }

    /// Adds an accessor of floats and returns its index.
    pub(crate) fn floats(&mut self, kind: &str, numbers: &[f32]) -> usize {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        let size = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 4,
        };
        self.accessor(5126, kind, numbers.len() / size, &bytes)
    }

    /// The first primitive of the first mesh.
    pub(crate) fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// As `.gltf`, the buffer inside it as base64.
    pub(crate) fn gltf(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        let uri = format!("data:application/octet-stream;base64,{}", base64(&self.buffer));
        json["buffers"] = json!([{"byteLength": self.buffer.len(), "uri": uri}]);
        serde_json::to_vec(&json).unwrap()
    }

    /// As `.glb`.
    pub(crate) fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.buffer.len()}]);
        let mut text = serde_json::to_vec(&json).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut buffer = self.buffer.clone();
        buffer.resize(buffer.len().next_multiple_of(4), 0);
        let word = |length: usize| u32::try_from(length).unwrap().to_le_bytes();
        let length = word(28 + text.len() + buffer.len());
        [
            &b"glTF\x02\0\0\0"[..],
            &length,
            &word(text.len()),
            b"JSON",
            &text,
            &word(buffer.len()),
            b"BIN\0",
            &buffer,
        ]
        .concat()
    }

    /// Loads the `.glb` and checks the scene.
    pub(crate) fn load(&self) -> Result<Scene, scene::Error> {
        let scene = scene::load::gltf_from_bytes("test.glb", &self.glb(), None, &Limits::default())?;
        scene.check().unwrap();
        Ok(scene)
    }
}

fn push(array: &mut Value, value: Value) -> usize {
    let array = array.as_array_mut().unwrap();
    array.push(value);
    array.len() - 1
}
