//! Mip chains by area averaging, for colour formats and all sizes.

use crate::{Error, Gpu};

/// Levels of a full mip chain down to 1 x 1.
pub fn mip_level_count(width: u32, height: u32) -> u32 {
    width.max(height).max(1).ilog2() + 1
}

/// Fills mip chains of one texture format. Make it once per format and keep it.
///
/// Each texel of a level is the mean of the area that it covers in the level above, with
/// fractional weights where a size is odd; the mean of the image is the same in every level. An
/// sRGB format is averaged in linear light. Every channel is averaged by itself: opacity is not
/// multiplied in and normals are not brought back to unit length.
#[derive(Clone, Debug)]
pub struct Mipmaps {
    format: wgpu::TextureFormat,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

impl Mipmaps {
    /// What a texture's usages must contain for its chain to be filled.
    pub const USAGES: wgpu::TextureUsages =
        wgpu::TextureUsages::TEXTURE_BINDING.union(wgpu::TextureUsages::RENDER_ATTACHMENT);

    /// Compiles the pass for a colour format that can be rendered to.
    ///
    /// [`Error::UnsupportedFormat`] for others (on OpenGL that includes those of 32-bit floats),
    /// [`Error::MissingFeature`] where the format itself needs a feature that the device lacks.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Result<Self, Error> {
        let what = format!("mip chain of {format:?}");
        gpu.require(&what, format.required_features())?;
        let sampled = format.sample_type(None, Some(gpu.device().features()));
        let is_float = matches!(sampled, Some(wgpu::TextureSampleType::Float { .. }));
        let unsupported = Error::UnsupportedFormat {
            what: what.clone(),
            format,
            supported: "colour formats of floats or normalized values that this adapter can render to",
        };
        if !format.has_color_aspect() || !is_float {
            return Err(unsupported);
        }
        gpu.checked(&what, |device| {
            let layout = bind_group_layout(device);
            let pipeline = pipeline(device, &layout, format);
            Self { format, layout, pipeline }
        })
        // Only the adapter knows what it can render to, and the format is all that varies here.
        .map_err(|error| if matches!(error, Error::Validation { .. }) { unsupported } else { error })
    }

    /// The format whose chains this fills.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.format
    }

    /// Records the passes that fill levels 1 and on from level 0, and returns how many those are.
    ///
    /// The texture is two-dimensional with one layer and one sample, of this format and has
    /// [`USAGES`](Self::USAGES); [`Error::Invalid`] otherwise. (Layers are left out because wgpu's
    /// OpenGL cannot sample one layer of an array as a plain texture.)
    pub fn generate(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        texture: &wgpu::Texture,
    ) -> Result<u32, Error> {
        self.check(texture)?;
        gpu.checked("mip chain", |device| {
            let views: Vec<_> =
                (0..texture.mip_level_count()).map(|level| level_view(texture, level)).collect();
            for (source, target) in views.iter().zip(views.iter().skip(1)) {
                self.halve(device, encoder, source, target);
            }
            texture.mip_level_count() - 1
        })
    }

    fn check(&self, texture: &wgpu::Texture) -> Result<(), Error> {
        if texture.format() != self.format {
            let (found, expected) = (format!("{:?}", texture.format()), format!("{:?}", self.format));
            return Err(Error::invalid("format for a mip chain", found, expected));
        }
        if !texture.usage().contains(Self::USAGES) {
            let (found, expected) = (format!("{:?}", texture.usage()), format!("{:?}", Self::USAGES));
            return Err(Error::invalid("usage for a mip chain", found, expected));
        }
        let (layers, samples) = (texture.depth_or_array_layers(), texture.sample_count());
        if texture.dimension() != wgpu::TextureDimension::D2 || layers != 1 || samples != 1 {
            let found = format!("{:?}, layers: {layers}, samples: {samples}", texture.dimension());
            return Err(Error::invalid("texture for a mip chain", found, "D2, layers: 1, samples: 1"));
        }
        Ok(())
    }

    fn halve(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        source: &wgpu::TextureView,
        target: &wgpu::TextureView,
    ) {
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("mipmap"),
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(source),
            }],
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("mipmap"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &bind_group, &[]);
        pass.draw(0..3, 0..1);
    }
}

fn level_view(texture: &wgpu::Texture, level: u32) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        label: Some("mipmap"),
        base_mip_level: level,
        mip_level_count: Some(1),
        ..wgpu::TextureViewDescriptor::default()
    })
}

fn bind_group_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("mipmap"),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        }],
    })
}

fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    format: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("mipmap.wgsl"));
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("mipmap"),
        bind_group_layouts: &[Some(layout)],
        ..wgpu::PipelineLayoutDescriptor::default()
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("mipmap"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("mipmap_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("mipmap_halve"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
