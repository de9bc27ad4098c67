//! Camera views of one mesh: which point of the surface each pixel shows, the technique's ready
//! pass, and a shadow map of the displaced mesh as a baseline.

use super::{
    lab::{Lab, Relief},
    ways::Way,
};
use crate::{bindings, technique::Failure};
use compositor::wgpu::{self, util::DeviceExt as _};
use glam::{Mat4, Vec3};
use gpu_context::{FloatImage, Gpu, readback};
use horizon_shadow::{Desc, HorizonShadow, Light, VertexFrame, View, VisibilityPass, Work, Wrap};

/// Triangles with frames; `displaced` is the same surface as dense triangles at the heights of the
/// relief.
pub(super) struct Model {
    pub(super) mesh: scene::Mesh,
    pub(super) frames: Vec<VertexFrame>,
    pub(super) displaced: scene::Mesh,
}

/// From where a picture is taken.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shot {
    pub(super) camera: scene::Camera,
    pub(super) size: [u32; 2],
    /// Unit, towards the light.
    pub(super) light_world: [f32; 3],
    /// Angular diameter of the light; 0 is a hard shadow.
    pub(super) angular_diameter_rad: f32,
}

impl Shot {
    fn clip_from_world(&self) -> Mat4 {
        let aspect = self.size[0] as f32 / self.size[1] as f32;
        self.camera.clip_from_world(aspect, self.camera.near_m())
    }
}

/// A vertex of the base mesh, in the order of the ready pass's shader locations.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
    uv: [f32; 2],
    frame: [f32; 9],
}

/// `View` of `drawing.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Uniforms {
    clip_from_world: [[f32; 4]; 4],
    light_clip_from_world: [[f32; 4]; 4],
    uv_scale: [f32; 2],
    size: [f32; 2],
    height_scale_m: f32,
    bias: f32,
    wrap: u32,
    pad: u32,
}

/// Rows of the identity and columns of its normals' matrix.
const IDENTITY: [[f32; 4]; 6] = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [1.0, 0.0, 0.0, 1.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
];

const VERTEX_ATTRIBUTES: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
    0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Float32x3, 4 => Float32x3, 5 => Float32x3
];
const INSTANCE_ATTRIBUTES: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
    6 => Float32x4, 7 => Float32x4, 8 => Float32x4, 9 => Float32x4, 10 => Float32x4, 11 => Float32x4
];
const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const COORDINATES: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Texels a side of the shadow map.
pub(super) const SHADOW_MAP_SIDE: u32 = 2048;

/// A mesh on the GPU and all that draws it.
pub(super) struct Drawing {
    gpu: Gpu,
    vertices: wgpu::Buffer,
    triangles: (wgpu::Buffer, u32),
    instance: wgpu::Buffer,
    displaced: (wgpu::Buffer, wgpu::Buffer, u32),
    /// Centre and radius of a ball around the displaced mesh.
    ball: (Vec3, f32),
    uniforms: wgpu::Buffer,
    group: wgpu::BindGroup,
    depth_group: wgpu::BindGroup,
    coordinates: wgpu::RenderPipeline,
    shadow_mapped: wgpu::RenderPipeline,
    depth_from_light: wgpu::RenderPipeline,
    shadow_map: wgpu::TextureView,
    ready: Option<VisibilityPass>,
    color: wgpu::Texture,
    depth: wgpu::TextureView,
    shot: Shot,
}

impl Drawing {
    /// Uploads a mesh with its relief.
    pub(super) fn new(gpu: &Gpu, model: &Model, relief: &Relief, shot: Shot) -> Result<Self, Failure> {
        let device = gpu.device();
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        let vertices = vertices(model);
        let map = &relief.map;
        let heights = gpu_context::upload::texture_2d(
            gpu,
            "heights",
            map.width,
            map.height,
            wgpu::TextureFormat::R32Float,
            bytemuck::cast_slice(&map.heights),
            None,
        )?;
        let heights = heights.create_view(&wgpu::TextureViewDescriptor::default());
        let shadow_map =
            texture(device, DEPTH, [SHADOW_MAP_SIDE; 2]).create_view(&wgpu::TextureViewDescriptor::default());
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("view"),
            size: size_of::<Uniforms>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layouts = [layout(device, 3), layout(device, 1)];
        let entries = [
            wgpu::BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&heights) },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(&shadow_map) },
        ];
        let group = |layout, entries| {
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries })
        };
        let indices = |mesh: &scene::Mesh| {
            (
                buffer(bytemuck::cast_slice(&mesh.triangles), wgpu::BufferUsages::INDEX),
                3 * mesh.triangles.len() as u32,
            )
        };
        let (dense_indices, dense_count) = indices(&model.displaced);
        let dense: Vec<[f32; 3]> = model.displaced.positions.iter().map(Vec3::to_array).collect();
        let [all, first] = &layouts;
        let (coordinates, shadow_mapped, depth_from_light) = gpu.checked("drawing", |device| {
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("drawing"),
                source: wgpu::ShaderSource::Wgsl(include_str!("drawing.wgsl").into()),
            });
            (
                pipeline(device, &module, all, "base_vertex", Some(("coordinates", COORDINATES))),
                pipeline(device, &module, all, "base_vertex", Some(("shadow_mapped", COLOR))),
                pipeline(device, &module, first, "depth_vertex", None),
            )
        })?;
        Ok(Self {
            vertices: buffer(bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
            triangles: indices(&model.mesh),
            instance: buffer(bytemuck::cast_slice(&IDENTITY), wgpu::BufferUsages::VERTEX),
            displaced: (
                buffer(bytemuck::cast_slice(&dense), wgpu::BufferUsages::VERTEX),
                dense_indices,
                dense_count,
            ),
            ball: ball(&model.displaced),
            group: group(all, &entries),
            depth_group: group(first, &entries[..1]),
            uniforms,
            coordinates,
            shadow_mapped,
            depth_from_light,
            shadow_map,
            ready: None,
            color: texture(device, COLOR, shot.size),
            depth: texture(device, DEPTH, shot.size).create_view(&wgpu::TextureViewDescriptor::default()),
            gpu: gpu.clone(),
            shot,
        })
    }

    /// Turns the light.
    pub(super) fn set_light(&mut self, light_world: [f32; 3], angular_diameter_rad: f32) {
        self.shot.light_world = light_world;
        self.shot.angular_diameter_rad = angular_diameter_rad;
    }

    /// Texture coordinates (red, green), depth and coverage (opacity) of each pixel.
    pub(super) fn coordinates(&self, relief: &Relief) -> Result<FloatImage, Failure> {
        self.write_uniforms(relief);
        let target = texture(self.gpu.device(), COORDINATES, self.shot.size);
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = begin(&mut encoder, Some(&view), &self.depth);
            pass.set_pipeline(&self.coordinates);
            pass.set_bind_group(0, &self.group, &[]);
            self.draw(&mut pass);
        }
        self.gpu.queue().submit([encoder.finish()]);
        Ok(readback::read_texture(&self.gpu, &target, 0, 0)?)
    }

    /// One frame of a method, waited for. The laboratory holds the relief.
    pub(super) fn frame(&mut self, lab: &mut Lab, relief: &Relief, way: Way) -> Result<Work, Failure> {
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut work = Work::default();
        if way == Way::ShadowMap {
            self.write_uniforms(relief);
            self.draw_shadow_map(&mut encoder);
        } else {
            work = lab.prepare(&mut encoder, way)?;
            self.prepare_pass(lab.technique(way)?)?;
        }
        let target = self.color.create_view(&wgpu::TextureViewDescriptor::default());
        {
            let mut pass = begin(&mut encoder, Some(&target), &self.depth);
            if way == Way::ShadowMap {
                pass.set_pipeline(&self.shadow_mapped);
                pass.set_bind_group(0, &self.group, &[]);
            } else {
                let technique = lab.technique(way)?;
                let ready = self.ready.as_ref().ok_or("the pass is not there")?;
                if !ready.set(&mut pass, technique) {
                    return Err("the pass drew nothing".into());
                }
            }
            self.draw(&mut pass);
        }
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.wait()?;
        Ok(work)
    }

    /// Visibility of each pixel of the last frame.
    pub(super) fn visibility(&self) -> Result<Vec<f32>, Failure> {
        let image = readback::read_texture(&self.gpu, &self.color, 0, 0)?;
        Ok(image.values.chunks_exact(image.channels as usize).map(|texel| texel[0]).collect())
    }

    /// Bytes of the shadow map and of the mesh that is drawn into it.
    pub(super) fn shadow_map_bytes(&self) -> u64 {
        4 * u64::from(SHADOW_MAP_SIDE).pow(2) + self.displaced.0.size() + self.displaced.1.size()
    }

    fn prepare_pass(&mut self, technique: &HorizonShadow) -> Result<(), Failure> {
        let mut ready = if let Some(ready) = self.ready.take() {
            ready
        } else {
            let desc = Desc {
                target_format: COLOR,
                depth_stencil: Some(depth_state()),
                vertex_buffers: &buffers(),
                primitive: wgpu::PrimitiveState::default(),
            };
            VisibilityPass::new(&self.gpu, &desc)?
        };
        let view = View { clip_from_world: self.shot.clip_from_world().to_cols_array_2d() };
        let light = Light::Directional {
            direction_world: self.shot.light_world,
            angular_diameter_rad: self.shot.angular_diameter_rad,
        };
        ready.prepare(&self.gpu, &view, &[light], [technique])?;
        self.ready = Some(ready);
        Ok(())
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_vertex_buffer(1, self.instance.slice(..));
        pass.set_index_buffer(self.triangles.0.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.triangles.1, 0, 0..1);
    }

    fn draw_shadow_map(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = begin(encoder, None, &self.shadow_map);
        pass.set_pipeline(&self.depth_from_light);
        pass.set_bind_group(0, &self.depth_group, &[]);
        pass.set_vertex_buffer(0, self.displaced.0.slice(..));
        pass.set_index_buffer(self.displaced.1.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.displaced.2, 0, 0..1);
    }

    fn write_uniforms(&self, relief: &Relief) {
        let (center, radius) = self.ball;
        let light = Vec3::from(self.shot.light_world);
        let right = light.any_orthonormal_vector();
        let up = light.cross(right);
        // The ball fills the map; depth is greatest towards the light, as in every reversed buffer.
        let row = |axis: Vec3, scale: f32, offset: f32| {
            (axis * (scale / radius)).extend(offset - axis.dot(center) * scale / radius)
        };
        let light_clip_from_world =
            Mat4::from_cols(row(right, 1.0, 0.0), row(up, 1.0, 0.0), row(light, 0.5, 0.5), glam::Vec4::W)
                .transpose();
        let repeats = |axis: usize| u32::from(relief.wrap[axis] == Wrap::Repeat) << axis;
        let uniforms = Uniforms {
            clip_from_world: self.shot.clip_from_world().to_cols_array_2d(),
            light_clip_from_world: light_clip_from_world.to_cols_array_2d(),
            uv_scale: relief.uv_scale,
            size: [relief.map.width as f32, relief.map.height as f32],
            height_scale_m: relief.height_scale_m,
            // Two texels of the shadow map.
            bias: 2.0 / SHADOW_MAP_SIDE as f32,
            wrap: repeats(0) | repeats(1),
            pad: 0,
        };
        self.gpu.queue().write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&uniforms));
    }
}

fn vertices(model: &Model) -> Vec<Vertex> {
    let mesh = &model.mesh;
    let frame = |frame: &VertexFrame| bytemuck::cast::<VertexFrame, [f32; 9]>(*frame);
    let corners = mesh.positions.iter().zip(&mesh.normals).zip(&mesh.uvs).zip(&model.frames);
    corners
        .map(|(((position, normal), uv), of)| Vertex {
            position: position.to_array(),
            normal: normal.to_array(),
            uv: uv.to_array(),
            frame: frame(of),
        })
        .collect()
}

/// A ball around a mesh.
fn ball(mesh: &scene::Mesh) -> (Vec3, f32) {
    let (least, greatest) = mesh.bounds().unwrap_or_default();
    let center = 0.5 * (least + greatest);
    let radius = mesh.positions.iter().map(|&position| position.distance(center)).fold(0.0, f32::max);
    (center, radius)
}

fn buffers() -> [wgpu::VertexBufferLayout<'static>; 2] {
    [
        wgpu::VertexBufferLayout {
            array_stride: size_of::<Vertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &VERTEX_ATTRIBUTES,
        },
        wgpu::VertexBufferLayout {
            array_stride: size_of_val(&IDENTITY) as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &INSTANCE_ATTRIBUTES,
        },
    ]
}

fn depth_state() -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTH,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Greater),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// A uniform buffer and textures of floats, so many bindings in all.
fn layout(device: &wgpu::Device, count: u32) -> wgpu::BindGroupLayout {
    let entry = |binding| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty: if binding == 0 {
            bindings::uniform()
        } else {
            bindings::texture(false, wgpu::TextureViewDimension::D2)
        },
        count: None,
    };
    let entries: Vec<_> = (0..count).map(entry).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
}

/// A pipeline for the base mesh, or without a target for the displaced one.
fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    layout: &wgpu::BindGroupLayout,
    vertex: &str,
    target: Option<(&str, wgpu::TextureFormat)>,
) -> wgpu::RenderPipeline {
    const POSITION: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![0 => Float32x3];
    let dense = [wgpu::VertexBufferLayout {
        array_stride: 12,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &POSITION,
    }];
    let base = buffers();
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    let targets = target.map(|(_, format)| [Some(format.into())]);
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(vertex),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &(if target.is_some() { &base[..] } else { &dense[..] })
                .iter()
                .cloned()
                .map(Some)
                .collect::<Vec<_>>(),
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(depth_state()),
        multisample: wgpu::MultisampleState::default(),
        fragment: target.zip(targets.as_ref()).map(|((entry_point, _), targets)| wgpu::FragmentState {
            module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn texture(device: &wgpu::Device, format: wgpu::TextureFormat, [width, height]: [u32; 2]) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    color: Option<&wgpu::TextureView>,
    depth: &wgpu::TextureView,
) -> wgpu::RenderPass<'a> {
    let color = color.map(|view| {
        [Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: wgpu::StoreOp::Store,
            },
        })]
    });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: None,
        color_attachments: color.as_ref().map_or(&[], |color| &color[..]),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..wgpu::RenderPassDescriptor::default()
    })
}
