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
}
