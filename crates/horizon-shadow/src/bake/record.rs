//! Recording the passes of a bake.

use std::ops::Range;

use gpu_context::{Gpu, wgpu};

use super::{
    Baker,
    parts::{Kind, Part},
    pipelines::STEP_STRIDE,
    plan::{Scratch, Strip},
    profile::ProfilePoint,
    uniforms::Step,
};
use crate::{Error, bindings::bind_group};

/// The buffers of a bake, which go when it is done.
#[derive(Debug)]
pub(super) struct Buffers {
    pub(super) relief: wgpu::Buffer,
    winners: wgpu::Buffer,
    encoded: wgpu::Buffer,
    points: wgpu::Buffer,
    links: wgpu::Buffer,
    sizes: Scratch,
}

impl Buffers {
    /// Buffers for a map of so many texels.
    pub(super) fn new(gpu: &Gpu, texels: u64) -> Result<Self, Error> {
        let sizes = Scratch::default();
        Ok(Self {
            relief: storage(gpu, "horizon-shadow relief", 4 * texels)?,
            winners: storage(gpu, "horizon-shadow winners", sizes.winners)?,
            encoded: storage(gpu, "horizon-shadow encoded", sizes.encoded)?,
            points: storage(gpu, "horizon-shadow points", sizes.points)?,
            links: storage(gpu, "horizon-shadow links", sizes.links)?,
            sizes,
        })
    }

    /// Makes those that are too small anew.
    pub(super) fn grow(&mut self, gpu: &Gpu, sizes: Scratch) -> Result<(), Error> {
        let needed = self.sizes.max(sizes);
        let grown = |buffer: &mut wgpu::Buffer, label, have: u64, need: u64| {
            if need > have {
                *buffer = storage(gpu, label, need)?;
            }
            Ok::<_, Error>(())
        };
        grown(&mut self.winners, "horizon-shadow winners", self.sizes.winners, needed.winners)?;
        grown(&mut self.encoded, "horizon-shadow encoded", self.sizes.encoded, needed.encoded)?;
        grown(&mut self.points, "horizon-shadow points", self.sizes.points, needed.points)?;
        grown(&mut self.links, "horizon-shadow links", self.sizes.links, needed.links)?;
        self.sizes = needed;
        Ok(())
    }
}

/// One batch of steps with their uniforms, ready to be recorded.
pub(super) struct Batch<'a> {
    baker: &'a Baker,
    buffers: &'a Buffers,
    group: wgpu::BindGroup,
    /// The step that is recorded next.
    next: u32,
    pub(super) passes: u32,
}

impl<'a> Batch<'a> {
    /// `steps` are recorded in this order.
    pub(super) fn new(
        gpu: &Gpu,
        baker: &'a Baker,
        buffers: &'a Buffers,
        steps: &[Step],
        profile: &[ProfilePoint],
    ) -> Result<Self, Error> {
        let mut bytes = vec![0; steps.len().max(1) * STEP_STRIDE as usize];
        for (slot, step) in bytes.chunks_exact_mut(STEP_STRIDE as usize).zip(steps) {
            slot[..size_of::<Step>()].copy_from_slice(bytemuck::bytes_of(step));
        }
        let uniforms = filled(gpu, "horizon-shadow steps", wgpu::BufferUsages::UNIFORM, &bytes)?;
        let empty = [[0.0_f32; 4]];
        let profile = if profile.is_empty() { &empty } else { profile };
        let profile = bytemuck::cast_slice(profile);
        let profile = filled(gpu, "horizon-shadow profile", wgpu::BufferUsages::STORAGE, profile)?;
        let step = wgpu::BufferBinding {
            buffer: &uniforms,
            offset: 0,
            size: wgpu::BufferSize::new(size_of::<Step>() as u64),
        };
        let group = gpu.checked("horizon-shadow's bake", |device| {
            let resources = [
                wgpu::BindingResource::Buffer(step),
                buffers.relief.as_entire_binding(),
                profile.as_entire_binding(),
                buffers.winners.as_entire_binding(),
                buffers.encoded.as_entire_binding(),
                buffers.points.as_entire_binding(),
                buffers.links.as_entire_binding(),
            ];
            bind_group(device, "horizon-shadow bake", &baker.layout, resources)
        })?;
        Ok(Self { baker, buffers, group, next: 0, passes: 0 })
    }

    /// Takes the relief of the next step's rows.
    pub(super) fn take_relief(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        heights: &wgpu::BindGroup,
        step: &Step,
    ) {
        let mut pass = self.begin(encoder, &self.baker.relief);
        pass.set_bind_group(1, heights, &[]);
        pass.dispatch_workgroups(step.size[0].div_ceil(64), step.rows[1] - step.rows[0], 1);
        drop(pass);
        self.next += 1;
    }

    /// Sweeps and searches a strip and copies it to its layer.
    pub(super) fn fill(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        strip: &Strip,
        target: &wgpu::Texture,
        layer: u32,
    ) {
        if !strip.sweeps.is_empty() {
            // Nodes that need no sweep have no winners.
            encoder.clear_buffer(&self.buffers.winners, 0, None);
        }
        for step in &strip.sweeps {
            let groups = step.invocations.div_ceil(32);
            let mut pass = self.begin(encoder, &self.baker.sweep);
            let rows = groups.div_ceil(32768);
            pass.dispatch_workgroups(groups.div_ceil(rows), rows, 1);
            drop(pass);
            self.next += 1;
        }
        let step = &strip.search;
        let rows = step.rows[1] - step.rows[0];
        let texels = step.unit_codes / step.nodes;
        let mut pass = self.begin(encoder, &self.baker.search);
        pass.dispatch_workgroups(step.size[0].div_ceil(texels).div_ceil(64), rows, 1);
        drop(pass);
        self.next += 1;
        self.copy(encoder, 0, step.pitch, target, [0, layer], &(step.rows[0]..step.rows[1]));
    }

    /// Makes a part. `textures` binds the candidates and the texture that is made coarser.
    pub(super) fn make(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        textures: &wgpu::BindGroup,
        part: &Part<'_>,
    ) {
        let pipeline = match part.kind {
            Kind::Extents => &self.baker.extents,
            Kind::Moments => &self.baker.moments,
            Kind::Ambient => &self.baker.ambient,
            Kind::Halve => &self.baker.halve,
        };
        let mut pass = self.begin(encoder, pipeline);
        pass.set_bind_group(1, textures, &[]);
        pass.dispatch_workgroups(part.groups[0], part.groups[1], 1);
        drop(pass);
        self.next += 1;
        let layer_bytes = 4 * u64::from(part.step.pitch) * part.rows.len() as u64;
        for (index, layer) in (0..).zip(part.layers.clone()) {
            let at = [part.level, layer];
            self.copy(encoder, index * layer_bytes, part.step.pitch, part.target, at, &part.rows);
        }
    }

    /// Copies encoded rows to those of a level and layer.
    fn copy(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        offset: u64,
        pitch_words: u32,
        target: &wgpu::Texture,
        [level, layer]: [u32; 2],
        rows: &Range<u32>,
    ) {
        let bytes_per_row = Some(4 * pitch_words);
        let source = wgpu::TexelCopyBufferInfo {
            buffer: &self.buffers.encoded,
            layout: wgpu::TexelCopyBufferLayout { offset, bytes_per_row, rows_per_image: None },
        };
        let target_rows = wgpu::TexelCopyTextureInfo {
            texture: target,
            mip_level: level,
            origin: wgpu::Origin3d { x: 0, y: rows.start, z: layer },
            aspect: wgpu::TextureAspect::All,
        };
        let width = (target.width() >> level).max(1);
        let extent = wgpu::Extent3d { width, height: rows.len() as u32, depth_or_array_layers: 1 };
        encoder.copy_buffer_to_texture(source, target_rows, extent);
    }

    fn begin<'e>(
        &mut self,
        encoder: &'e mut wgpu::CommandEncoder,
        pipeline: &wgpu::ComputePipeline,
    ) -> wgpu::ComputePass<'e> {
        self.passes += 1;
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.group, &[self.next * STEP_STRIDE as u32]);
        pass
    }
}

fn storage(gpu: &Gpu, label: &str, bytes: u64) -> Result<wgpu::Buffer, Error> {
    let desc = wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes.max(16),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    };
    gpu.checked(label, |device| device.create_buffer(&desc)).map_err(Error::from)
}

fn filled(gpu: &Gpu, label: &str, usage: wgpu::BufferUsages, bytes: &[u8]) -> Result<wgpu::Buffer, Error> {
    use wgpu::util::DeviceExt as _;
    let desc = wgpu::util::BufferInitDescriptor { label: Some(label), contents: bytes, usage };
    gpu.checked(label, |device| device.create_buffer_init(&desc)).map_err(Error::from)
}
