//! diffuse-envmap
pub mod model;
pub mod settings;
pub mod taps;
