//! A scene on the GPU: only what its instances use, checked before it is uploaded.

use crate::{
    Error, coat,
    environment::{EnvironmentGpu, next_revision},
    geometry::{self, Variant},
    mesh::{MeshGpu, buffer},
    passes::bind_group,
    relief::{self, HeightMapGpu, Parts, Relief},
    textures::Textures,
    uniforms::{self, CoatUniform, LightUniform, MaterialUniform},
    vertices::{InstanceVertex, is_mirrored},
    view::Bounds,
};
use gpu_context::Gpu;
use scene::{AlphaMode, Environment, Light, Material, Mesh, Scene, TextureRef, Warning};
use std::collections::{HashMap, hash_map::Entry};
use std::ops::Range;

/// A scene on the GPU.
#[derive(Debug, Default)]
pub struct SceneGpu {
    pub(crate) draws: Vec<Draw>,
    pub(crate) meshes: HashMap<usize, MeshGpu>,
    pub(crate) materials: HashMap<usize, wgpu::BindGroup>,
    pub(crate) coats: HashMap<usize, wgpu::BindGroup>,
    pub(crate) instances: Option<wgpu::Buffer>,
    pub(crate) lights: Option<wgpu::Buffer>,
    /// The lights in that buffer.
    pub(crate) lit_by: Vec<Light>,
    /// By map, and whether it is turned over.
    pub(crate) height_maps: HashMap<(usize, bool), HeightMapGpu>,
    /// By material and mesh.
    pub(crate) reliefs: HashMap<(usize, usize), Relief>,
    /// Differs between any two scenes and sets of lights.
    pub(crate) revision: u64,
    environment: Option<EnvironmentGpu>,
    bounds: Option<Bounds>,
    blended_draws: usize,
    max_roughness: f32,
    warnings: Vec<Warning>,
}

/// A run of instances that share everything else.
#[derive(Debug)]
pub(crate) struct Draw {
    pub(crate) variant: Variant,
    pub(crate) material: usize,
    pub(crate) mesh: usize,
    pub(crate) instances: Range<u32>,
}

impl SceneGpu {
    /// Uploads what the scene's instances use, its lights and its environment.
    ///
    /// [`Error::Scene`] names an index out of range or a value that is not finite where it must
    /// be; [`Error::Gpu`] a size beyond the device's limits. What could be mended is in
    /// [`warnings`](Self::warnings).
    pub fn upload(gpu: &Gpu, scene: &Scene) -> Result<Self, Error> {
        let mut uploaded = Self::default();
        uploaded.add_instances(gpu, scene)?;
        uploaded.set_lights(gpu, &scene.lights)?;
        uploaded.set_environment(gpu, scene.environment.as_ref())?;
        Ok(uploaded)
    }

    /// Replaces the environment; `None` takes it away.
    pub fn set_environment(&mut self, gpu: &Gpu, environment: Option<&Environment>) -> Result<(), Error> {
        let Some(environment) = environment else {
            self.environment = None;
            return Ok(());
        };
        let (environment, warning) = EnvironmentGpu::new(gpu, environment)?;
        self.environment = Some(environment);
        self.warnings.extend(warning);
        Ok(())
    }

    /// Changes the environment's intensity (0 or above) and its turn about +Y in radians without
    /// uploading anything. No effect without an environment.
    pub fn place_environment(&mut self, intensity: f32, rotation_rad: f32) {
        if let Some(environment) = &mut self.environment {
            environment.place(intensity, rotation_rad);
        }
    }

    /// Replaces the lights. Those that send nothing or stand nowhere are left out, with a warning.
    pub fn set_lights(&mut self, gpu: &Gpu, lights: &[Light]) -> Result<(), Error> {
        let usable = lights.iter().filter_map(|light| Some((*light, LightUniform::new(light)?)));
        let (lit_by, uniforms): (Vec<_>, Vec<_>) = usable.unzip();
        (self.lit_by, self.revision) = (lit_by, next_revision());
        if uniforms.len() < lights.len() {
            let message = format!("{} lights that send nothing were left out", lights.len() - uniforms.len());
            self.warn("", "lights", message);
        }
        self.lights = if uniforms.is_empty() {
            None
        } else {
            Some(buffer(gpu, "lights", wgpu::BufferUsages::STORAGE, bytemuck::cast_slice(&uniforms))?)
        };
        Ok(())
    }

    /// The environment, if there is one.
    pub fn environment(&self) -> Option<&EnvironmentGpu> {
        self.environment.as_ref()
    }

    /// A sphere around everything that is drawn, `None` where nothing is.
    pub fn bounds(&self) -> Option<Bounds> {
        self.bounds
    }

    /// An upper bound on the roughness that any pixel asks the environment for, 0..1: 1 where any
    /// surface is partly diffuse.
    pub fn max_roughness(&self) -> f32 {
        self.max_roughness
    }

    /// What was mended on the way to the GPU, in order.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// How many draws have a material that blends.
    pub fn blended_draws(&self) -> usize {
        self.blended_draws
    }

    fn warn(&mut self, file: &str, place: &str, message: String) {
        self.warnings.push(Warning { file: file.into(), place: place.into(), message });
    }

    fn add_instances(&mut self, gpu: &Gpu, scene: &Scene) -> Result<(), Error> {
        let mut textures = Textures::new(gpu, scene);
        let mut order: Vec<(Variant, usize, usize, usize)> = Vec::new();
        for (index, instance) in scene.instances.iter().enumerate() {
            let place = format!("instance {index} ({})", instance.name);
            let material = indexed(scene, &place, "material", &scene.materials, instance.material)?;
            let mesh = indexed(scene, &place, "mesh", &scene.meshes, instance.mesh)?;
            if !instance.world_from_local.is_finite() {
                let found = format!("{:?}", instance.world_from_local);
                return Err(scene::Error::new(&scene.name, place, found, "a finite matrix").into());
            }
            if !self.add_mesh(gpu, scene, instance.mesh)? {
                continue;
            }
            self.add_material(gpu, scene, &mut textures, instance.material)?;
            let has_relief = self.add_height_map(gpu, scene, &place, instance.material, mesh)?;
            let variant = Variant::new(material, is_mirrored(instance.world_from_local), has_relief);
            order.push((variant, instance.material, instance.mesh, index));
            if material.normal_texture.is_some() && mesh.tangents.is_empty() {
                self.warn(&scene.name, &place, "the normal map has no effect without tangents".into());
            }
            self.blended_draws += usize::from(material.alpha_mode == AlphaMode::Blend);
        }
        order.sort_unstable();
        self.bounds = bounds(scene);
        self.add_draws(gpu, scene, &order)?;
        self.add_reliefs(gpu, scene)
    }

    /// Uploads the height map of an instance's material once; false where it has none that can be
    /// used.
    fn add_height_map(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        place: &str,
        material: usize,
        mesh: &Mesh,
    ) -> Result<bool, Error> {
        let Some(height) = scene.materials.get(material).and_then(|material| material.height.as_ref()) else {
            return Ok(false);
        };
        let map = indexed(scene, place, "height map", &scene.height_maps, height.map)?;
        if mesh.uvs.is_empty() {
            let found = format!("the mesh \"{}\" without texture coordinates", mesh.name);
            let expected =
                format!("texture coordinates, which say where the height map \"{}\" lies", map.name);
            return Err(scene::Error::new(&scene.name, place, found, expected).into());
        }
        if !relief::is_usable(height) {
            let message = "its height map is left out: the scales must be finite, and uv_scale not 0";
            self.warn(&scene.name, place, message.into());
            return Ok(false);
        }
        let key = relief::key(height);
        if let Entry::Vacant(slot) = self.height_maps.entry(key) {
            let place = format!("height map {} ({})", height.map, map.name);
            let (uploaded, warning) = HeightMapGpu::new(gpu, scene, &place, map, key.1)?;
            slot.insert(uploaded);
            self.warnings.extend(warning);
        }
        Ok(true)
    }

    /// Lays the height maps on the meshes that are drawn with them.
    fn add_reliefs(&mut self, gpu: &Gpu, scene: &Scene) -> Result<(), Error> {
        for draw in self.draws.iter().filter(|draw| draw.variant.has_relief()) {
            let key = (draw.material, draw.mesh);
            let (Some(material), Some(mesh)) = (scene.materials.get(key.0), scene.meshes.get(key.1)) else {
                continue;
            };
            let Some(height) = &material.height else { continue };
            let maps = (scene.height_maps.get(height.map), self.height_maps.get(&relief::key(height)));
            let (Some(map), Some(map_gpu)) = maps else { continue };
            if self.reliefs.contains_key(&key) {
                continue;
            }
            let of_pair = scene.instances.iter().filter(|instance| (instance.material, instance.mesh) == key);
            let placements: Vec<_> = of_pair.map(|instance| instance.world_from_local).collect();
            let place = format!("mesh {} ({}) with height map {}", key.1, mesh.name, map.name);
            let parts = Parts { place: &place, mesh, height, map, map_gpu, placements: &placements };
            self.reliefs.insert(key, Relief::new(gpu, &parts)?);
        }
        Ok(())
    }

    fn add_draws(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        order: &[(Variant, usize, usize, usize)],
    ) -> Result<(), Error> {
        let mut vertices = Vec::with_capacity(order.len());
        for &(variant, material, mesh, index) in order {
            let Some(instance) = scene.instances.get(index) else { continue };
            let position = vertices.len() as u32;
            vertices.push(InstanceVertex::new(instance.world_from_local, position + 1));
            match self.draws.last_mut() {
                Some(draw) if (draw.variant, draw.material, draw.mesh) == (variant, material, mesh) => {
                    draw.instances.end = position + 1;
                }
                _ => self.draws.push(Draw { variant, material, mesh, instances: position..position + 1 }),
            }
        }
        if !vertices.is_empty() {
            let bytes = bytemuck::cast_slice(&vertices);
            self.instances = Some(buffer(gpu, "instances", wgpu::BufferUsages::VERTEX, bytes)?);
        }
        Ok(())
    }

    /// Uploads a mesh once; false where it has no triangles.
    fn add_mesh(&mut self, gpu: &Gpu, scene: &Scene, index: usize) -> Result<bool, Error> {
        if self.meshes.contains_key(&index) {
            return Ok(true);
        }
        let Some(mesh) = scene.meshes.get(index) else { return Ok(false) };
        let place = format!("mesh {index} ({})", mesh.name);
        let uploaded = MeshGpu::new(gpu, &scene.name, &place, mesh)?;
        let has_triangles = uploaded.is_some();
        self.meshes.extend(uploaded.map(|mesh| (index, mesh)));
        Ok(has_triangles)
    }

    /// Uploads a material and the textures it uses once.
    fn add_material(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        textures: &mut Textures<'_>,
        index: usize,
    ) -> Result<(), Error> {
        if self.materials.contains_key(&index) {
            return Ok(());
        }
        let Some(material) = scene.materials.get(index) else { return Ok(()) };
        let place = format!("material {index} ({})", material.name);
        let (uniform, mut repaired) = MaterialUniform::new(material);
        self.max_roughness = self.max_roughness.max(max_roughness(material));
        let bytes = bytemuck::bytes_of(&uniform);
        let layout = geometry::material_layout(gpu.device());
        let bind_group =
            material_bind_group(gpu, &place, bytes, &uniforms::textures(material), &layout, textures)?;
        self.materials.insert(index, bind_group);
        if material.clearcoat.factor > 0.0 {
            let (uniform, coat_repaired) = CoatUniform::new(&material.clearcoat);
            repaired += coat_repaired;
            let bytes = bytemuck::bytes_of(&uniform);
            let layout = coat::coat_layout(gpu.device());
            let coat_textures = uniforms::coat_textures(&material.clearcoat);
            let bind_group = material_bind_group(gpu, &place, bytes, &coat_textures, &layout, textures)?;
            self.coats.insert(index, bind_group);
        }
        if repaired > 0 {
            self.warn(&scene.name, &place, format!("{repaired} values were brought into range"));
        }
        Ok(())
    }
}

fn indexed<'a, T>(
    scene: &Scene,
    place: &str,
    what: &str,
    list: &'a [T],
    index: usize,
) -> Result<&'a T, scene::Error> {
    list.get(index).ok_or_else(|| {
        let expected = format!("an index below {}", list.len());
        scene::Error::new(&scene.name, place, format!("{what} {index}"), expected)
    })
}

/// A uniform, then each texture with its sampler.
fn material_bind_group(
    gpu: &Gpu,
    place: &str,
    uniform: &[u8],
    references: &[Option<&TextureRef>],
    layout: &wgpu::BindGroupLayout,
    textures: &mut Textures<'_>,
) -> Result<wgpu::BindGroup, Error> {
    let uniform = buffer(gpu, place, wgpu::BufferUsages::UNIFORM, uniform)?;
    let mut bound = Vec::new();
    for &texture in references {
        bound.push(textures.get(place, texture)?);
    }
    let mut resources = vec![uniform.as_entire_binding()];
    for (view, sampler) in &bound {
        resources.push(wgpu::BindingResource::TextureView(view));
        resources.push(wgpu::BindingResource::Sampler(sampler));
    }
    Ok(gpu.checked(place, |device| bind_group(device, place, layout, &resources))?)
}

/// An upper bound on the roughness of the lobes of a material; a diffuse one has 1. The textures
/// can only lower roughness and metallic.
fn max_roughness(material: &Material) -> f32 {
    let is_metal = material.metallic >= 1.0 && material.metallic_roughness_texture.is_none();
    if is_metal && material.roughness < 1.0 { material.roughness.max(0.0) } else { 1.0 }
}

fn bounds(scene: &Scene) -> Option<Bounds> {
    let (least, greatest) = scene.bounds()?;
    let radius_m = 0.5 * least.distance(greatest) + farthest_relief_m(scene);
    radius_m.is_finite().then_some(Bounds { center_world: least.midpoint(greatest), radius_m })
}

/// How far any height map reaches above or below its surface.
fn farthest_relief_m(scene: &Scene) -> f32 {
    let of_instance = |instance: &scene::Instance| {
        let height = scene.materials.get(instance.material)?.height.as_ref()?;
        let heights = &scene.height_maps.get(height.map)?.heights;
        let largest =
            heights.iter().filter(|height| height.is_finite()).fold(0.0, |most: f32, h| most.max(h.abs()));
        Some(largest * height.height_scale.abs()).filter(|reach| reach.is_finite())
    };
    scene.instances.iter().filter_map(of_instance).fold(0.0, f32::max)
}
