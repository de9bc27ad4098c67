//! The table of modules: one line per WGSL file.

use crate::Module;

/// Declares modules and lists them all in [`ALL`].
macro_rules! modules {
    ($($(#[$doc:meta])* $name:ident = $path:literal [$($dependency:ident),*];)*) => {
        $($(#[$doc])* pub static $name: Module = Module {
            path: $path,
            text: include_str!(concat!("../", $path)),
            dependencies: &[$(&$dependency),*],
        };)*
        /// Every module of the package.
        pub static ALL: &[&Module] = &[$(&$name),*];
    };
}

modules! {
    /// Constants and numerically careful helpers shared by all techniques.
    COMMON_MATH = "common/math.wgsl" [];
    /// A triangle that covers the target.
    COMMON_FULLSCREEN = "common/fullscreen.wgsl" [];
    /// The compositor's view, reconstruction of positions, and direct reflectance.
    COMPOSITOR_LIBRARY = "compositor/library.wgsl" [COMMON_MATH];
    /// Triangles with glTF materials to the surface buffer.
    COMPOSITOR_GEOMETRY = "compositor/geometry.wgsl" [COMPOSITOR_LIBRARY];
    /// The environment where no surface is.
    COMPOSITOR_BACKGROUND = "compositor/background.wgsl" [COMMON_FULLSCREEN, COMPOSITOR_LIBRARY];
    /// Directional, point and spot lights over the surface buffer.
    COMPOSITOR_DIRECT_LIGHT = "compositor/direct-light.wgsl" [COMMON_FULLSCREEN, COMPOSITOR_LIBRARY];
    /// HDR image to display.
    COMPOSITOR_TONE_MAP = "compositor/tone-map.wgsl" [COMMON_FULLSCREEN, COMPOSITOR_LIBRARY];
}
