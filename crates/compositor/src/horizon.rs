//! horizon-shadow on every surface with a height map: shadows of its own bumps, and, where asked for,
//! how much of the sky they leave open.

mod ambient;

use crate::{
    Error, SceneGpu, View,
    geometry::{Variant, depth_state, primitive},
    relief::{HeightMapGpu, Relief},
    scene_gpu::Draw,
    surface::SurfaceBuffer,
    vertices::{InstanceVertex, Vertex},
    visibility::{MAX_SHADOWED_LIGHTS, MORE_LIGHTS, VISIBILITY_FORMAT, Visibility},
};
use ambient::Ambient;
use gpu_context::{Gpu, Skip, Work};
use horizon_shadow::{
    Desc, Frame, HeightMap, HorizonShadow, Method, Settings, VertexFrame, VisibilityPass, Wrap,
};
use scene::Light;
use std::collections::HashMap;

/// No material that is drawn has a height map.
pub const NO_HEIGHT_MAPS: Skip = Skip::new("no surface has a height map");

/// The settings leave horizon-shadow out.
pub const HORIZON_SHADOW_OFF: Skip = Skip::new("horizon-shadow is turned off");

/// The technique for every surface of a scene that has a height map; made when a frame first has
/// one.
pub(crate) struct Horizons {
    /// By material and mesh.
    surfaces: HashMap<(usize, usize), HorizonShadow>,
    /// For plain and for mirrored instances, made on first use.
    passes: [Option<VisibilityPass>; 2],
    ambient: Option<Ambient>,
}

/// What a frame asks for.
pub(crate) struct Request<'a> {
    pub(crate) settings: &'a Settings,
    pub(crate) view: &'a View,
    /// Whether any light's visibility counts.
    pub(crate) is_lit: bool,
}

impl Horizons {
    pub(crate) fn new() -> Self {
        Self { surfaces: HashMap::new(), passes: [None, None], ambient: None }
    }

    /// Brings the tables up to date, and draws what they say: visibility of the lights to the
    /// visibility buffer; the open share of the sky into the surface buffer's occlusion.
    pub(crate) fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneGpu,
        request: &Request<'_>,
        surface: &mut SurfaceBuffer,
        visibility: &mut Visibility,
    ) -> Result<Work, Error> {
        let mut work = self.prepare(gpu, encoder, scene, request.settings)?;
        if request.is_lit {
            self.draw_visibility(gpu, encoder, scene, request, surface, visibility)?;
            work.passes += 1;
            if scene.lit_by.len() > MAX_SHADOWED_LIGHTS {
                work.skipped = Some(MORE_LIGHTS);
            }
        }
        if request.settings.ambient {
            let mut ambient = match self.ambient.take() {
                Some(ambient) => ambient,
                None => Ambient::new(gpu)?,
            };
            ambient.draw(gpu, encoder, scene, request.view, &self.surfaces, surface)?;
            self.ambient = Some(ambient);
            work.passes += 1;
        } else {
            self.ambient = None;
        }
        Ok(work)
    }

    /// Bytes of GPU memory that the tables take.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.surfaces.values().map(HorizonShadow::memory_bytes).sum()
    }

    /// How far the bakes have come, together.
    pub(crate) fn progress(&self) -> horizon_shadow::Progress {
        self.surfaces.values().map(HorizonShadow::progress).fold(
            horizon_shadow::Progress::default(),
            |sum, one| horizon_shadow::Progress { done: sum.done + one.done, total: sum.total + one.total },
        )
    }

    /// Passes are added up; a reason is kept where none ran.
    fn prepare(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneGpu,
        settings: &Settings,
    ) -> Result<Work, Error> {
        self.surfaces.retain(|key, _| scene.reliefs.contains_key(key));
        let mut keys: Vec<_> = scene.reliefs.keys().copied().collect();
        keys.sort_unstable();
        let mut work = Work::default();
        for key in keys {
            let Some(relief) = scene.reliefs.get(&key) else { continue };
            let Some(map) = scene.height_maps.get(&relief.map) else { continue };
            let mut technique = match self.surfaces.remove(&key) {
                Some(technique) => technique,
                None => match self.surfaces.values().next() {
                    Some(other) => other.for_another_surface(gpu)?,
                    None => HorizonShadow::new(gpu)?,
                },
            };
            let one = technique.prepare(gpu, encoder, settings, &frame(relief, map))?;
            self.surfaces.insert(key, technique);
            work.passes += one.passes;
            work.skipped = work.skipped.or(one.skipped);
        }
        if work.passes > 0 {
            work.skipped = None;
        }
        Ok(work)
    }

    fn draw_visibility(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        scene: &SceneGpu,
        request: &Request<'_>,
        surface: &SurfaceBuffer,
        visibility: &mut Visibility,
    ) -> Result<(), Error> {
        let Some(instances) = &scene.instances else { return Ok(()) };
        let lights: Vec<_> = scene.lit_by.iter().take(MAX_SHADOWED_LIGHTS).map(light).collect();
        let view = horizon_shadow::View { clip_from_world: request.view.clip_from_world.to_cols_array_2d() };
        for (slot, mirrored) in self.passes.iter_mut().zip([false, true]) {
            let mut drawn = reliefs(scene).filter(|draw| is_mirrored(draw.variant) == mirrored).peekable();
            if drawn.peek().is_none() {
                continue;
            }
            let mut pass = match slot.take() {
                Some(pass) => pass,
                None => visibility_pass(gpu, mirrored)?,
            };
            let surfaces = drawn.filter_map(|draw| self.surfaces.get(&(draw.material, draw.mesh)));
            pass.prepare(gpu, &view, &lights, surfaces)?;
            *slot = Some(pass);
        }
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("horizon-shadow"),
            color_attachments: &[Some(visibility.attachment(gpu, surface)?)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &surface.depth.view,
                depth_ops: None,
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        for draw in reliefs(scene) {
            let key = (draw.material, draw.mesh);
            let pipelines = self.passes[usize::from(is_mirrored(draw.variant))].as_ref();
            let resources = (pipelines, self.surfaces.get(&key), scene.reliefs.get(&key));
            let ((Some(pipelines), Some(technique), Some(relief)), Some(mesh)) =
                (resources, scene.meshes.get(&draw.mesh))
            else {
                continue;
            };
            if !pipelines.set(&mut pass, technique) {
                continue;
            }
            pass.set_vertex_buffer(0, mesh.vertices.slice(..));
            pass.set_vertex_buffer(1, instances.slice(..));
            pass.set_vertex_buffer(2, relief.frames.slice(..));
            pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.index_count, 0, draw.instances.clone());
        }
        Ok(())
    }
}

/// How far the technique knows the bumps of a height map; 0 where it casts no shadows.
pub(crate) fn radius_texels(settings: &Settings) -> f32 {
    if settings.method == Method::None { 0.0 } else { settings.radius_texels.clamp(0.0, 4096.0) }
}

/// The draws of surfaces with a height map.
fn reliefs(scene: &SceneGpu) -> impl Iterator<Item = &Draw> {
    scene.draws.iter().filter(|draw| draw.variant.has_relief())
}

fn is_mirrored(variant: Variant) -> bool {
    variant.faces().1
}

fn frame<'a>(relief: &Relief, map: &'a HeightMapGpu) -> Frame<'a> {
    let height_map = HeightMap {
        view: &map.view,
        revision: map.revision,
        changed_rows: None,
        range: map.range,
        height_scale_m: relief.height_scale_m,
        uv_scale: relief.uv_scale,
        wrap: [Wrap::Repeat; 2],
    };
    // Lights move and meshes turn: all azimuths are needed sooner or later.
    Frame { height_map: Some(height_map), surface: relief.surface, needed_azimuths: u64::MAX }
}

/// A light of the scene as the technique takes it; points are hard.
fn light(light: &Light) -> horizon_shadow::Light {
    match *light {
        Light::Directional { direction_world, angular_diameter_rad, .. } => {
            horizon_shadow::Light::Directional {
                direction_world: direction_world.to_array(),
                angular_diameter_rad,
            }
        }
        Light::Point { position_world, .. } | Light::Spot { position_world, .. } => {
            horizon_shadow::Light::Point { position_world: position_world.to_array(), radius_m: 0.0 }
        }
    }
}

fn visibility_pass(gpu: &Gpu, mirrored: bool) -> Result<VisibilityPass, Error> {
    let at = |shader_location, offset: usize, format| wgpu::VertexAttribute {
        format,
        offset: offset as u64,
        shader_location,
    };
    let [three, two, four] =
        [wgpu::VertexFormat::Float32x3, wgpu::VertexFormat::Float32x2, wgpu::VertexFormat::Float32x4];
    let vertex = [
        at(0, std::mem::offset_of!(Vertex, position), three),
        at(1, std::mem::offset_of!(Vertex, normal), three),
        at(2, std::mem::offset_of!(Vertex, uv), two),
    ];
    let instance: Vec<_> = (0..6).map(|index| at(6 + index, 16 * index as usize, four)).collect();
    let frame = wgpu::vertex_attr_array![3 => Float32x3, 4 => Float32x3, 5 => Float32x3];
    let layout = |array_stride: usize, step_mode, attributes| wgpu::VertexBufferLayout {
        array_stride: array_stride as u64,
        step_mode,
        attributes,
    };
    let vertex_buffers = [
        layout(size_of::<Vertex>(), wgpu::VertexStepMode::Vertex, &vertex),
        layout(size_of::<InstanceVertex>(), wgpu::VertexStepMode::Instance, &instance),
        layout(size_of::<VertexFrame>(), wgpu::VertexStepMode::Vertex, &frame),
    ];
    let desc = Desc {
        target_format: VISIBILITY_FORMAT,
        depth_stencil: Some(depth_state(false, wgpu::CompareFunction::Equal)),
        vertex_buffers: &vertex_buffers,
        primitive: primitive(true, mirrored),
    };
    Ok(VisibilityPass::new(gpu, &desc)?)
}
