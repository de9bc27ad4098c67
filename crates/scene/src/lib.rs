//! Scenes as plain data, and everything that makes one: loaders for models, images,
//! environments, height maps and scene files, procedural shapes, and built-in environments and
//! height maps.
//!
//! No GPU type appears here. Conventions: right-handed, Y up, metres, as in glTF; radiance is
//! linear RGB with Rec. 709 primaries; environments are latitude-longitude maps (see
//! [`Environment`]).
//!
//! Start at [`load::load_scene`], which takes any file that describes a scene, or at
//! [`builtin::scene`], which needs no file at all.

pub mod builtin;
mod camera;
mod check;
mod environment;
mod error;
mod height_map;
mod light;
mod limits;
pub mod load;
mod material;
mod mesh;
mod nearest;
pub mod output;
pub mod shapes;
mod texture;

pub use camera::Camera;
pub use environment::{Environment, Repairs};
pub use error::{Error, Warning};
pub use height_map::HeightMap;
pub use light::Light;
pub use limits::Limits;
pub use material::{AlphaMode, Clearcoat, HeightRef, Material, TextureRef, Wrap};
pub use mesh::{Instance, Mesh};
pub use nearest::suggestion;
pub use texture::{ColorSpace, Texture};

/// Everything that can be rendered, and what was noticed while it was loaded.
///
/// Indices (`Instance::mesh`, `Instance::material`, `TextureRef::texture`, `HeightRef::map`)
/// are valid in a scene made by this crate; [`Scene::check`] verifies one made by hand.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// What the scene is called: its file's name without the folder, or a built-in's name.
    pub name: String,
    /// Triangle meshes in local space.
    pub meshes: Vec<Mesh>,
    /// Surface descriptions, shared by instances.
    pub materials: Vec<Material>,
    /// Decoded 8-bit images, shared by materials.
    pub textures: Vec<Texture>,
    /// Height maps, shared by materials.
    pub height_maps: Vec<HeightMap>,
    /// Meshes placed in the world.
    pub instances: Vec<Instance>,
    /// Lights besides the environment.
    pub lights: Vec<Light>,
    /// The camera that the file names, if it names one; else see [`Scene::framing_camera`].
    pub camera: Option<Camera>,
    /// The surrounding radiance, if there is any.
    pub environment: Option<Environment>,
    /// One table of settings per technique, as the scene file has them, by technique name.
    pub technique_settings: std::collections::BTreeMap<String, toml::Table>,
    /// What was repaired, ignored or approximated while loading, in order.
    pub warnings: Vec<Warning>,
}
