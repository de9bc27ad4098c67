//! horizon-shadow: shadows of bumps on curved surfaces, from horizon and distance maps.
//!
//! After Onoue, Max and Nishita, *Bumpmap Shadows on Curved Surfaces*.

mod error;
mod frame;
pub mod frames;
mod settings;
mod tables;
mod uniforms;

pub use error::Error;
pub use frame::{Frame, HeightMap, Surface};
pub use frames::VertexFrame;
pub use gpu_context::{Gpu, Skip, Work, wgpu};
pub use settings::{Method, Search, Settings, Tables};
pub use tables::{Contents, Precision, TableDesc, Wrap};
