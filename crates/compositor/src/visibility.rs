//! The visibility buffer: which share of each of the first four lights reaches each pixel.

use crate::{
    Error,
    surface::{SurfaceBuffer, Target, target},
};
use gpu_context::Gpu;

/// Lights that a visibility buffer holds: the first ones of the scene. Others shine through
/// everything.
pub const MAX_SHADOWED_LIGHTS: usize = 4;

/// More lights than the visibility buffer holds.
pub const MORE_LIGHTS: gpu_context::Skip = gpu_context::Skip::new("only the first four lights cast shadows");

/// Channel i is light i's: 0 in shadow, 1 lit.
pub const VISIBILITY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// The buffer of a frame, made by the first pass that has shadows to put into it.
#[derive(Default)]
pub(crate) struct Visibility {
    target: Option<(Target, [u32; 2])>,
    /// Whether a pass of this frame has drawn into it.
    is_used: bool,
}

impl Visibility {
    /// Begins a frame.
    pub(crate) fn begin(&mut self) {
        self.is_used = false;
    }

    /// The attachment of a pass: lit everywhere at first, then what the passes before have left.
    pub(crate) fn attachment(
        &mut self,
        gpu: &Gpu,
        surface: &SurfaceBuffer,
    ) -> Result<wgpu::RenderPassColorAttachment<'_>, Error> {
        let make = |device: &wgpu::Device| target(device, "visibility", surface.size, VISIBILITY_FORMAT);
        let standing = self.target.take().filter(|(_, size)| *size == surface.size);
        let target = if let Some(target) = standing {
            target
        } else {
            (gpu.checked("the visibility buffer", make)?, surface.size)
        };
        let load = if self.is_used { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(wgpu::Color::WHITE) };
        self.is_used = true;
        let (target, _) = self.target.insert(target);
        let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
        Ok(wgpu::RenderPassColorAttachment {
            view: &target.view,
            depth_slice: None,
            resolve_target: None,
            ops,
        })
    }

    /// Ends the shadows of a frame: the buffer goes where none was drawn.
    pub(crate) fn end(&mut self) {
        if !self.is_used {
            self.target = None;
        }
    }

    /// The buffer, where this frame has shadows.
    pub(crate) fn target(&self) -> Option<&Target> {
        self.target.as_ref().map(|(target, _)| target).filter(|_| self.is_used)
    }
}
