//! Meshes, height maps and pictures of the ready pass, as a host would draw them.

#![allow(dead_code, unreachable_pub, reason = "each test binary uses its own part of the stage")]

pub mod known;

use gpu_context::{HeadlessDesc, readback, upload};
use horizon_shadow::wgpu::{self, util::DeviceExt as _};
use horizon_shadow::{
    Desc, Error, Frame, Gpu, HeightMap, HorizonShadow, Light, Settings, Surface, VertexFrame, View,
    VisibilityPass, Work, Wrap,
};

/// Pixels along each side of a picture.
pub const SIDE: u32 = 64;

/// From the top left, the visibility of each light; `None` where nothing was drawn.
pub type Picture = Vec<Option<[f32; 4]>>;

/// What stands where nothing is drawn: four numbers that no four lights have together.
const NOTHING: [f32; 4] = [0.2, 0.4, 0.6, 0.8];

/// A height map and how it lies on the surface.
#[derive(Clone, Debug)]
pub struct Map {
    pub size: [u32; 2],
    pub values: Vec<f32>,
    pub range: [f32; 2],
    pub height_scale_m: f32,
    pub uv_scale: [f32; 2],
    pub wrap: [Wrap; 2],
}

impl Map {
    /// Heights of a function of the texel, in metres, repeated, in the range that they have.
    pub fn new(size: [u32; 2], height: impl Fn(u32, u32) -> f32) -> Self {
        let values: Vec<f32> = (0..size[0] * size[1]).map(|i| height(i % size[0], i / size[0])).collect();
        let finite = || values.iter().copied().filter(|x| x.is_finite());
        let range = [finite().fold(f32::MAX, f32::min), finite().fold(f32::MIN, f32::max)];
        let range = if range[0] <= range[1] { range } else { [0.0, 1.0] };
        Self { size, values, range, height_scale_m: 1.0, uv_scale: [1.0; 2], wrap: [Wrap::Repeat; 2] }
    }
}

/// A triangle grid over a parametrised surface, in its own space.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub vertices: Vec<Vertex>,
    pub indices: Vec<u32>,
    /// The extremes of the normal curvature, 1 / metre.
    pub curvature_per_m: [f32; 2],
    /// The length of a unit of u, metres, where it is greatest.
    pub metres_per_uv: f32,
}

/// Position, normal, uv, frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    pub uv: [f32; 2],
    pub frame: VertexFrame,
}

impl Mesh {
    /// A grid of `cells` x `cells` squares over uv in 0..1.
    pub fn grid(cells: u32, vertex: impl Fn(f32, f32) -> Vertex) -> Self {
        let row = cells + 1;
        let at = |i: u32| i as f32 / cells as f32;
        let vertices = (0..row * row).map(|i| vertex(at(i % row), at(i / row))).collect();
        let square = |i: u32| {
            let a = i / cells * row + i % cells;
            [a, a + row, a + 1, a + 1, a + row, a + row + 1]
        };
        let indices = (0..cells * cells).flat_map(square).collect();
        Self { vertices, indices, curvature_per_m: [0.0; 2], metres_per_uv: 1.0 }
    }

    /// The square -1..1 in x and z, facing +y; u along +x and v along +z.
    pub fn plane() -> Self {
        let mesh = Self::grid(1, |u, v| Vertex {
            position: [2.0 * u - 1.0, 0.0, 2.0 * v - 1.0],
            normal: [0.0, 1.0, 0.0],
            uv: [u, v],
            frame: VertexFrame { along_u: [2.0, 0.0, 0.0], along_v: [0.0, 0.0, 2.0], second_form: [0.0; 3] },
        });
        Self { metres_per_uv: 2.0, ..mesh }
    }

    /// A half sphere about the origin of radius 1 towards +y, seen from above; the uv are those of
    /// the plane, so that texels are largest at the rim.
    pub fn dome(cells: u32) -> Self {
        // Latitude and longitude with the poles on the z axis stay clear of the pole at the top.
        let mesh = Self::grid(cells, |u, v| {
            use std::f32::consts::PI;
            let (lon, lat) = (PI * (u - 0.5), PI * 0.98 * (v - 0.5));
            let normal = [lon.sin() * lat.cos(), lon.cos() * lat.cos(), lat.sin()];
            let along_u = [PI * lon.cos() * lat.cos(), -PI * lon.sin() * lat.cos(), 0.0];
            let q = PI * 0.98;
            let along_v = [-q * lon.sin() * lat.sin(), -q * lon.cos() * lat.sin(), q * lat.cos()];
            // On the unit sphere the second form is the first.
            let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let second_form = [dot(along_u, along_u), 0.0, dot(along_v, along_v)];
            Vertex {
                position: normal,
                normal,
                uv: [u, v],
                frame: VertexFrame { along_u, along_v, second_form },
            }
        });
        Self { curvature_per_m: [1.0; 2], metres_per_uv: std::f32::consts::PI, ..mesh }
    }

    /// The same with u turned round, so that texture and surface have opposite handedness.
    pub fn with_mirrored_uv(mut self) -> Self {
        for vertex in &mut self.vertices {
            vertex.uv[0] = 1.0 - vertex.uv[0];
            vertex.frame.along_u = vertex.frame.along_u.map(|x| -x);
            vertex.frame.second_form[1] *= -1.0;
        }
        self
    }
}

/// An instance: rows of `world_from_local`, columns of the normals' matrix.
pub type Instance = [[f32; 4]; 6];

/// The mesh where it is, times a factor.
pub fn scaled(factor: f32) -> Instance {
    diagonal([factor; 3])
}

/// The mesh scaled along its axes; factors may be negative.
pub fn diagonal([x, y, z]: [f32; 3]) -> Instance {
    [
        [x, 0.0, 0.0, 0.0],
        [0.0, y, 0.0, 0.0],
        [0.0, 0.0, z, 0.0],
        [1.0 / x, 0.0, 0.0, 0.0],
        [0.0, 1.0 / y, 0.0, 0.0],
        [0.0, 0.0, 1.0 / z, 0.0],
    ]
}

/// A camera above that looks down -y and sees -half..half in x (to the right) and z (down).
pub fn from_above(half_m: f32) -> View {
    let s = 1.0 / half_m;
    View {
        clip_from_world: [
            [s, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.25 * s, 0.0],
            [0.0, -s, 0.0, 0.0],
            [0.0, 0.0, 0.5, 1.0],
        ],
    }
}

/// A device, a pass and a surface whose picture is taken.
pub struct Stage {
    pub gpu: Gpu,
    pub surface: HorizonShadow,
    pub pass: VisibilityPass,
    format: wgpu::TextureFormat,
    heights: Option<(wgpu::Texture, Map)>,
    revision: u64,
}

const ATTRIBUTES: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3,
    2 => Float32x2, 3 => Float32x3, 4 => Float32x3, 5 => Float32x3];
const INSTANCE: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![6 => Float32x4, 7 => Float32x4,
    8 => Float32x4, 9 => Float32x4, 10 => Float32x4, 11 => Float32x4];

/// Where the stage's vertex buffers hold what the pass reads.
pub fn vertex_buffers() -> [wgpu::VertexBufferLayout<'static>; 2] {
    [
        wgpu::VertexBufferLayout {
            array_stride: size_of::<Vertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &ATTRIBUTES,
        },
        wgpu::VertexBufferLayout {
            array_stride: size_of::<Instance>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &INSTANCE,
        },
    ]
}

impl Stage {
    pub fn new() -> Self {
        Self::on(Gpu::headless(&HeadlessDesc::default()).expect("an adapter"))
    }

    pub fn on(gpu: Gpu) -> Self {
        Self::with(gpu, wgpu::TextureFormat::Rgba8Unorm, wgpu::FrontFace::Ccw)
    }

    pub fn with(gpu: Gpu, format: wgpu::TextureFormat, front_face: wgpu::FrontFace) -> Self {
        let desc = Desc {
            target_format: format,
            depth_stencil: Some(wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            vertex_buffers: &vertex_buffers(),
            primitive: wgpu::PrimitiveState { front_face, ..Default::default() },
        };
        let pass = VisibilityPass::new(&gpu, &desc).expect("the pass");
        let surface = HorizonShadow::new(&gpu).expect("the technique");
        Self { gpu, surface, pass, format, heights: None, revision: 0 }
    }

    /// Uploads another map.
    pub fn set_map(&mut self, map: &Map) {
        let texture = upload::texture_2d(
            &self.gpu,
            "heights",
            map.size[0],
            map.size[1],
            wgpu::TextureFormat::R32Float,
            bytemuck::cast_slice(&map.values),
            None,
        )
        .expect("the map fits");
        self.heights = Some((texture, map.clone()));
        self.revision += 1;
    }

    /// Takes the map away.
    pub fn remove_map(&mut self) {
        self.heights = None;
    }

    /// Prepares the surface for a mesh, all azimuths.
    pub fn prepare(&mut self, settings: &Settings, mesh: &Mesh, instance: &Instance) -> Result<Work, Error> {
        self.prepare_with(settings, mesh, instance, |_| {})
    }

    /// The same with a frame that is changed first.
    pub fn prepare_with(
        &mut self,
        settings: &Settings,
        mesh: &Mesh,
        instance: &Instance,
        change: impl FnOnce(&mut Frame<'_>),
    ) -> Result<Work, Error> {
        let view = self
            .heights
            .as_ref()
            .map(|(texture, _)| texture.create_view(&wgpu::TextureViewDescriptor::default()));
        let map = self.heights.as_ref().zip(view.as_ref());
        let size_m = instance[0][0].abs();
        let texel_m = map.map_or(1.0, |((_, map), _)| {
            size_m * mesh.metres_per_uv / (map.uv_scale[0].abs() * map.size[0] as f32)
        });
        let mut frame = Frame {
            height_map: map.map(|((_, map), view)| HeightMap {
                view,
                revision: self.revision,
                changed_rows: None,
                range: map.range,
                height_scale_m: map.height_scale_m,
                uv_scale: map.uv_scale,
                wrap: map.wrap,
            }),
            surface: Surface { texel_m, curvature_per_m: mesh.curvature_per_m.map(|k| k / size_m) },
            needed_azimuths: u64::MAX,
        };
        change(&mut frame);
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let work = self.surface.prepare(&self.gpu, &mut encoder, settings, &frame)?;
        self.gpu.queue().submit([encoder.finish()]);
        Ok(work)
    }

    /// Prepares and draws `SIDE` x `SIDE` pixels.
    pub fn picture(
        &mut self,
        settings: &Settings,
        mesh: &Mesh,
        instance: &Instance,
        view: &View,
        lights: &[Light],
    ) -> Picture {
        self.prepare(settings, mesh, instance).expect("prepare");
        let picture = self.draw(mesh, instance, view, lights);
        assert_eq!(self.gpu.take_errors(), [], "the device reports no error");
        picture
    }

    /// Draws with what the last `prepare` left.
    pub fn draw(&mut self, mesh: &Mesh, instance: &Instance, view: &View, lights: &[Light]) -> Picture {
        self.pass.prepare(&self.gpu, view, lights, [&self.surface]).expect("prepare the pass");
        self.draw_with_the_pass_as_it_is(mesh, instance)
    }

    /// The same with the camera, lights and surfaces that the pass has.
    pub fn draw_with_the_pass_as_it_is(&self, mesh: &Mesh, instance: &Instance) -> Picture {
        let device = self.gpu.device();
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        let vertices = buffer(bytemuck::cast_slice(&mesh.vertices), wgpu::BufferUsages::VERTEX);
        let indices = buffer(bytemuck::cast_slice(&mesh.indices), wgpu::BufferUsages::INDEX);
        let instances = buffer(bytemuck::cast_slice(instance), wgpu::BufferUsages::VERTEX);
        let target = texture(device, self.format);
        let depth = texture(device, wgpu::TextureFormat::Depth32Float);
        let (target_view, depth_view) = (
            target.create_view(&wgpu::TextureViewDescriptor::default()),
            depth.create_view(&wgpu::TextureViewDescriptor::default()),
        );
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color {
                        r: NOTHING[0].into(),
                        g: NOTHING[1].into(),
                        b: NOTHING[2].into(),
                        a: NOTHING[3].into(),
                    }),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth_view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        if self.pass.set(&mut pass, &self.surface) {
            pass.set_vertex_buffer(0, vertices.slice(..));
            pass.set_vertex_buffer(1, instances.slice(..));
            pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.indices.len() as u32, 0, 0..1);
        }
        drop(pass);
        self.gpu.queue().submit([encoder.finish()]);
        let image = readback::read_texture(&self.gpu, &target, 0, 0).expect("the picture");
        let pixels = image.values.chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]);
        pixels.map(|pixel| (0..4).any(|i| (pixel[i] - NOTHING[i]).abs() > 1e-3).then_some(pixel)).collect()
    }
}

fn texture(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

/// The x and z in -1..1 that a pixel of [`from_above`] with a half of 1 shows.
pub fn place(pixel: usize) -> [f32; 2] {
    let side = SIDE as usize;
    [pixel % side, pixel / side].map(|i| (i as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0)
}

/// A hard directional light.
pub fn towards(direction_world: [f32; 3]) -> Light {
    Light::Directional { direction_world, angular_diameter_rad: 0.0 }
}

/// Pixels of a written picture along each side of a pixel.
const ZOOM: u32 = 3;

/// Writes the first channels of pictures side by side where the variable names a folder, for people
/// to look at.
pub fn save(name: &str, pictures: &[Picture]) {
    let Ok(folder) = std::env::var("SHEEN_TEST_PICTURES") else { return };
    let width = SIDE * ZOOM * pictures.len() as u32;
    let sheet = image::RgbImage::from_fn(width, SIDE * ZOOM, |x, y| {
        let (column, row) = (x / ZOOM, y / ZOOM);
        let picture = &pictures[(column / SIDE) as usize];
        let pixel = picture[(row * SIDE + column % SIDE) as usize];
        image::Rgb(pixel.map_or([40, 0, 80], |p| [(p[0] * 255.0).round() as u8; 3]))
    });
    sheet.save(format!("{folder}/{name}.png")).expect("the picture is written");
}
