//! horizon-shadow: shadows of bumps on curved surfaces, from horizon and distance maps.
//!
//! After Onoue, Max and Nishita, *Bumpmap Shadows on Curved Surfaces*.

mod bake;
mod bindings;
pub mod codes;
mod error;
mod frame;
pub mod frames;
pub mod model;
mod settings;
mod tables;
mod uniforms;
mod visibility;

pub use bake::{Bake, BakedTables, Baker, Heights, Parts, cpu};
pub use error::Error;
pub use frame::{Frame, HeightMap, Surface};
pub use frames::VertexFrame;
pub use gpu_context::{Gpu, Skip, Work, wgpu};
pub use settings::{Method, Search, Settings, Tables};
pub use tables::{Contents, MOMENT_TEXELS, Precision, TILE_TEXELS, TableDesc, Wrap};
pub use visibility::{Desc, Light, MAX_LIGHTS, View, VisibilityPass};

use bindings::technique_layout;

/// The surface has no height map: nothing is made and nothing costs.
pub const NO_HEIGHT_MAP: Skip = Skip::new("the surface has no height map");
/// The tables stand from an earlier frame.
pub const TABLES_STAND: Skip = Skip::new("the tables stand");
/// All heights are the same, so that no bump casts a shadow: lit is what faces the light.
pub const CONSTANT_HEIGHT: Skip = Skip::new("all heights are the same: no bump casts a shadow");
/// The method reads no tables.
pub const NO_TABLES_NEEDED: Skip = Skip::new("the method reads no tables");
/// No azimuth is needed: no light reaches the surface.
pub const NO_AZIMUTH_NEEDED: Skip = Skip::new("no azimuth is needed");

/// How far a bake has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Azimuths that are finished.
    pub done: u32,
    /// Azimuths that were asked for.
    pub total: u32,
}

/// The technique for one surface: a height map on a mesh.
#[derive(Debug)]
pub struct HorizonShadow {
    layout: wgpu::BindGroupLayout,
    parameters: wgpu::Buffer,
    group: Option<wgpu::BindGroup>,
    method: Option<Method>,
    progress: Progress,
}

impl HorizonShadow {
    /// Makes the small fixed resources; pipelines and textures follow on first use.
    pub fn new(gpu: &Gpu) -> Result<Self, Error> {
        let bytes = size_of::<uniforms::Parameters>();
        let parameters = bindings::uniform_buffer(gpu, "horizon-shadow parameters", bytes)?;
        let layout = gpu.checked("horizon-shadow", technique_layout)?;
        Ok(Self { layout, parameters, group: None, method: None, progress: Progress::default() })
    }

    /// Brings the tables that the settings' method reads up to date and records what that takes,
    /// at most [`Settings::azimuths_per_prepare`] azimuths; then makes the bind group. The uniforms
    /// are written through the queue: prepare once per submission.
    ///
    /// `Work::passes` counts compute passes; `Work::skipped` says why none ran.
    pub fn prepare(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        settings: &Settings,
        frame: &Frame<'_>,
    ) -> Result<Work, Error> {
        let _ = (gpu, encoder, &self.parameters);
        self.group = None;
        self.method = frame.height_map.as_ref().map(|_| settings.method);
        Ok(Work::skipped(NO_HEIGHT_MAP))
    }

    /// The WGSL functions for a host's own shader, dependencies included.
    pub fn library() -> String {
        shaders::HORIZON_SHADOW_LIBRARY.source()
    }

    /// The layout of [`Self::bind_group`], visible to vertex, fragment and compute shaders:
    /// 0 `var<uniform>: HorizonShadowParameters`, 1 `texture_2d<f32>` heights, 2
    /// `texture_2d_array<f32>` published tables, 3 `texture_2d_array<u32>` candidates, 4
    /// `texture_2d_array<f32>` extents, 5 `texture_2d_array<f32>` moments, 6
    /// `texture_2d_array<f32>` ambient, 7 `sampler`.
    pub fn bind_group_layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// The bindings of the last `prepare`; `None` where it had no height map.
    pub fn bind_group(&self) -> Option<&wgpu::BindGroup> {
        self.group.as_ref()
    }

    /// The method of the last `prepare`; `None` where it had no height map.
    pub fn method(&self) -> Option<Method> {
        self.method
    }

    /// Bytes of GPU memory that the tables take.
    pub fn memory_bytes(&self) -> u64 {
        0
    }

    /// How far the bake has come: all azimuths that are needed are `total`.
    pub fn progress(&self) -> Progress {
        self.progress
    }

    /// Gives the tables and the bake up; the next `prepare` starts anew.
    pub fn cancel(&mut self) {
        self.progress = Progress::default();
    }
}
