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
    COMPOSITOR_GEOMETRY = "compositor/geometry.wgsl" [COMPOSITOR_VERTEX];
    /// The vertex stage of the passes that draw triangles, and the shading normal.
    COMPOSITOR_VERTEX = "compositor/vertex.wgsl" [COMPOSITOR_LIBRARY];
    /// Heights and bump-mapped normals of height maps.
    COMPOSITOR_RELIEF_LIBRARY = "compositor/relief-library.wgsl" [COMMON_MATH];
    /// The vertex stage of the passes that draw surfaces with a height map.
    COMPOSITOR_RELIEF_VERTEX = "compositor/relief-vertex.wgsl" [COMPOSITOR_VERTEX];
    /// Triangles with a height map to the surface buffer.
    COMPOSITOR_GEOMETRY_RELIEF = "compositor/geometry-relief.wgsl"
        [COMPOSITOR_GEOMETRY, COMPOSITOR_RELIEF_VERTEX, COMPOSITOR_RELIEF_LIBRARY];
    /// Ambient occlusion of height maps to the surface buffer.
    COMPOSITOR_HORIZON_AMBIENT = "compositor/horizon-ambient.wgsl"
        [COMPOSITOR_RELIEF_VERTEX, HORIZON_SHADOW_LIBRARY];
    /// Depth of the scene from lights.
    COMPOSITOR_SHADOW_CASTERS = "compositor/shadow-casters.wgsl" [COMPOSITOR_GEOMETRY];
    /// How much of each light reaches surfaces past others.
    COMPOSITOR_SHADOW_MAP = "compositor/shadow-map.wgsl" [COMPOSITOR_RELIEF_VERTEX, COMPOSITOR_RELIEF_LIBRARY];
    /// Clear coats of visible surfaces to their buffer.
    COMPOSITOR_COAT_SURFACE = "compositor/coat-surface.wgsl" [COMPOSITOR_VERTEX];
    /// What clear coats keep from their base, and highlights in them.
    COMPOSITOR_COAT_LAYER = "compositor/coat-layer.wgsl"
        [COMMON_FULLSCREEN, COMPOSITOR_LIGHTS, DIFFUSE_ENVMAP_LIBRARY];
    /// The environment in clear coats.
    COMPOSITOR_COAT_ENVIRONMENT = "compositor/coat-environment.wgsl"
        [COMMON_FULLSCREEN, COMPOSITOR_LIBRARY, DIFFUSE_ENVMAP_LIBRARY];
    /// Lights besides the environment.
    COMPOSITOR_LIGHTS = "compositor/lights.wgsl" [COMPOSITOR_LIBRARY];
    /// The environment where no surface is.
    COMPOSITOR_BACKGROUND = "compositor/background.wgsl" [COMMON_FULLSCREEN, COMPOSITOR_LIBRARY];
    /// Directional, point and spot lights over the surface buffer.
    COMPOSITOR_DIRECT_LIGHT = "compositor/direct-light.wgsl" [COMMON_FULLSCREEN, COMPOSITOR_LIGHTS];
    /// HDR image to display.
    COMPOSITOR_TONE_MAP = "compositor/tone-map.wgsl" [COMMON_FULLSCREEN, COMPOSITOR_LIBRARY];
    /// The functions of diffuse-envmap, for a host's own shader.
    DIFFUSE_ENVMAP_LIBRARY = "diffuse-envmap/library.wgsl" [COMMON_MATH];
    /// Light an entire surface buffer.
    DIFFUSE_ENVMAP_LIGHTING = "diffuse-envmap/lighting.wgsl" [COMMON_FULLSCREEN, DIFFUSE_ENVMAP_LIBRARY];
    /// Find the bright sources of an environment.
    DIFFUSE_ENVMAP_SOURCES = "diffuse-envmap/sources.wgsl" [COMMON_MATH];
    /// Build the chain of an environment without its bright sources.
    DIFFUSE_ENVMAP_CHAIN = "diffuse-envmap/chain.wgsl" [COMMON_MATH];
    /// Project the environment without its bright sources on spherical harmonics.
    DIFFUSE_ENVMAP_HARMONICS = "diffuse-envmap/harmonics.wgsl" [COMMON_MATH];
    /// Parameters, height maps and the codes of the tables: what baking and looking up share.
    HORIZON_SHADOW_TABLES = "horizon-shadow/tables-library.wgsl" [COMMON_MATH];
    /// The codes of horizon candidates.
    HORIZON_SHADOW_CODES = "horizon-shadow/codes-library.wgsl" [HORIZON_SHADOW_TABLES];
    /// The functions of horizon-shadow, for a host's own shader.
    HORIZON_SHADOW_LIBRARY = "horizon-shadow/library.wgsl"
        [HORIZON_SHADOW_PUBLISHED, HORIZON_SHADOW_HORIZON, HORIZON_SHADOW_BUMPS];
    /// A surface point, and what a light makes of it.
    HORIZON_SHADOW_SURFACE = "horizon-shadow/surface-library.wgsl" [HORIZON_SHADOW_CODES];
    /// The horizon of the published tables.
    HORIZON_SHADOW_PUBLISHED = "horizon-shadow/published-library.wgsl" [HORIZON_SHADOW_SURFACE];
    /// The horizon of the better methods.
    HORIZON_SHADOW_HORIZON = "horizon-shadow/horizon-library.wgsl" [HORIZON_SHADOW_SURFACE];
    /// Bump normals, heights and ambient visibility.
    HORIZON_SHADOW_BUMPS = "horizon-shadow/bumps-library.wgsl" [HORIZON_SHADOW_SURFACE];
    /// What the passes of a bake share: their bindings and the relief.
    HORIZON_SHADOW_BAKE = "horizon-shadow/bake.wgsl" [HORIZON_SHADOW_CODES];
    /// Bring heights into texels.
    HORIZON_SHADOW_BAKE_RELIEF = "horizon-shadow/bake-relief.wgsl" [HORIZON_SHADOW_BAKE];
    /// Find and encode the horizons of one azimuth.
    HORIZON_SHADOW_BAKE_SEARCH = "horizon-shadow/bake-search.wgsl" [HORIZON_SHADOW_BAKE];
    /// Make extents, moments and ambient occlusion from the candidates.
    HORIZON_SHADOW_BAKE_PARTS = "horizon-shadow/bake-parts.wgsl" [HORIZON_SHADOW_BAKE];
    /// Find where the horizons of one azimuth lie by a sweep along lines.
    HORIZON_SHADOW_BAKE_SWEEP = "horizon-shadow/bake-sweep.wgsl" [HORIZON_SHADOW_BAKE];
    /// Visibility of up to four lights, for meshes with a height map.
    HORIZON_SHADOW_VISIBILITY = "horizon-shadow/visibility.wgsl" [HORIZON_SHADOW_LIBRARY];
}
