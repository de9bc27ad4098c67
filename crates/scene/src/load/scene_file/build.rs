//! Makes a scene of a scene file's keys.

mod overrides;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::{Mat4, Quat, Vec3};
use toml::Spanned;

use super::keys::{CameraKeys, EnvironmentKeys, LightKeys, ObjectKeys, SceneKeys};
use super::line_of;
use crate::load::{environment, height_map, load_scene, short_name};
use crate::{
    Camera, Environment, Error, HeightMap, Instance, Light, Limits, Material, Scene, builtin, shapes,
};

/// Builds the scene that the keys describe.
pub(super) fn build(
    name: &str,
    text: &str,
    folder: Option<&Path>,
    limits: &Limits,
    keys: SceneKeys,
) -> Result<Scene, Error> {
    let scene = Scene { name: short_name(name), ..Scene::default() };
    let mut builder = Builder {
        name,
        text,
        folder,
        limits,
        place: (0, "scene file"),
        scene,
        models: HashMap::new(),
        height_maps: HashMap::new(),
        textures_with_channel: HashMap::new(),
    };
    if keys.object.len() as u64 > limits.nodes {
        let (found, expected) =
            (format!("{} objects", keys.object.len()), format!("at most {}", limits.nodes));
        return Err(Error::new(name, "[[object]]", found, expected));
    }
    builder.scene.camera = keys.camera.map(|camera| builder.camera(&camera)).transpose()?;
    builder.scene.environment = keys.environment.map(|keys| builder.environment(&keys)).transpose()?;
    for light in &keys.light {
        let light = builder.light(light)?;
        builder.scene.lights.push(light);
    }
    for object in &keys.object {
        builder.object(object)?;
    }
    let tables = [
        ("diffuse-envmap", keys.diffuse_envmap),
        ("glossy-planes", keys.glossy_planes),
        ("horizon-shadow", keys.horizon_shadow),
        ("glare", keys.glare),
    ];
    let settings = tables.into_iter().filter_map(|(technique, table)| Some((technique.to_owned(), table?)));
    builder.scene.technique_settings = settings.collect();
    Ok(builder.scene)
}

/// What a file or shape brought into the scene; its instances stand as they do in the file.
#[derive(Clone)]
struct Model {
    instances: Vec<Instance>,
    lights: Vec<Light>,
}

struct Builder<'a> {
    name: &'a str,
    text: &'a str,
    folder: Option<&'a Path>,
    limits: &'a Limits,
    /// First byte and name of the table that is being read, for errors.
    place: (usize, &'static str),
    scene: Scene,
    models: HashMap<PathBuf, Model>,
    height_maps: HashMap<PathBuf, usize>,
    textures_with_channel: HashMap<(usize, usize), usize>,
}

impl Builder<'_> {
    fn error(&self, key: &str, found: impl Into<String>, expected: impl Into<String>) -> Error {
        let (start, table) = self.place;
        Error::new(self.name, format!("{}, {table}: {key}", line_of(self.text, start)), found, expected)
    }

    fn enter<'k, T>(&mut self, table: &'static str, keys: &'k Spanned<T>) -> &'k T {
        self.place = (keys.span().start, table);
        keys.get_ref()
    }

    /// A number that must lie in a range, both ends included.
    fn in_range(&self, key: &str, value: f32, low: f32, high: f32) -> Result<f32, Error> {
        if value.is_finite() && (low..=high).contains(&value) {
            return Ok(value);
        }
        let expected =
            if high >= f32::MAX { format!("a number of at least {low}") } else { format!("{low} to {high}") };
        Err(self.error(key, value.to_string(), expected))
    }

    fn finite(&self, key: &str, value: [f32; 3]) -> Result<Vec3, Error> {
        let vector = Vec3::from(value);
        if vector.is_finite() {
            Ok(vector)
        } else {
            Err(self.error(key, vector.to_string(), "finite numbers"))
        }
    }

    fn color(&self, key: &str, value: [f32; 3]) -> Result<Vec3, Error> {
        for number in value {
            self.in_range(key, number, 0.0, f32::MAX)?;
        }
        Ok(Vec3::from(value))
    }

    fn path(&self, key: &str, file: &str) -> Result<PathBuf, Error> {
        let folder =
            self.folder.ok_or_else(|| self.error(key, format!("{file:?}"), "no file: there is no folder"))?;
        Ok(folder.join(file))
    }

    fn camera(&mut self, keys: &Spanned<CameraKeys>) -> Result<Camera, Error> {
        let keys = self.enter("[camera]", keys);
        let eye = self.finite("eye", keys.eye)?;
        let target = self.finite("target", keys.target)?;
        let up = self.finite("up", keys.up.unwrap_or([0.0, 1.0, 0.0]))?;
        let fov_y_deg = keys.fov_y_deg.unwrap_or(40.0);
        if !(fov_y_deg > 0.0 && fov_y_deg < 180.0) {
            return Err(self.error("fov_y_deg", fov_y_deg.to_string(), "more than 0 and less than 180"));
        }
        let camera = Camera { eye, target, up, fov_y_rad: fov_y_deg.to_radians() };
        if !crate::check::camera_is_valid(&camera) {
            let found = format!("eye {eye}, target {target}, up {up}");
            return Err(self.error(
                "eye, target, up",
                found,
                "a target apart from the eye, and an up that is not along the view",
            ));
        }
        Ok(camera)
    }

    fn environment(&mut self, keys: &Spanned<EnvironmentKeys>) -> Result<Environment, Error> {
        let keys = self.enter("[environment]", keys);
        let intensity = self.in_range("intensity", keys.intensity.unwrap_or(1.0), 0.0, f32::MAX)?;
        let rotation_deg =
            self.in_range("rotation_deg", keys.rotation_deg.unwrap_or(0.0), -36000.0, 36000.0)?;
        let map = match (&keys.file, &keys.builtin) {
            (Some(file), None) => {
                let (map, warnings) = environment(&self.path("file", file)?, self.limits)?;
                self.scene.warnings.extend(warnings);
                map
            }
            (None, Some(builtin)) => builtin::environment(builtin).ok_or_else(|| {
                let expected = format!("one of {}", builtin::ENVIRONMENT_NAMES.join(", "));
                self.error("builtin", format!("{builtin:?}"), expected)
            })?,
            (file, _) => {
                let found = if file.is_some() { "both" } else { "neither" };
                return Err(self.error("file or builtin", found, "one of them"));
            }
        };
        Ok(Environment { intensity, rotation_rad: rotation_deg.to_radians(), ..map })
    }

    fn light(&mut self, keys: &Spanned<LightKeys>) -> Result<Light, Error> {
        let keys = self.enter("[[light]]", keys);
        let direction_world = Vec3::from(keys.direction).try_normalize().ok_or_else(|| {
            self.error("direction", Vec3::from(keys.direction).to_string(), "a finite vector that is not 0")
        })?;
        let irradiance = self.color("irradiance", keys.irradiance.0)?;
        let diameter_deg = keys.angular_diameter_deg.unwrap_or(0.0);
        let angular_diameter_rad =
            self.in_range("angular_diameter_deg", diameter_deg, 0.0, 180.0)?.to_radians();
        Ok(Light::Directional { direction_world, irradiance, angular_diameter_rad })
    }

    fn object(&mut self, keys: &Spanned<ObjectKeys>) -> Result<(), Error> {
        let keys = self.enter("[[object]]", keys);
        let world_from_object = self.transform(keys)?;
        let model = match (&keys.file, &keys.shape) {
            (Some(file), None) => self.file_model(file)?,
            (None, Some(shape)) => self.shape_model(shape)?,
            (file, _) => {
                let found = if file.is_some() { "both" } else { "neither" };
                return Err(self.error("file or shape", found, "one of them"));
            }
        };
        let Model { mut instances, lights } = model;
        if (self.scene.instances.len() + instances.len()) as u64 > self.limits.nodes {
            let expected = format!("at most {} in all objects (Limits::nodes)", self.limits.nodes);
            return Err(self.error("file", format!("more than {} meshes", self.limits.nodes), expected));
        }
        self.override_materials(keys, &mut instances)?;
        for instance in &mut instances {
            instance.world_from_local = world_from_object * instance.world_from_local;
            if !crate::check::is_usable(instance.world_from_local) {
                return Err(self.error(
                    "scale",
                    "a transform too large or small to invert",
                    "a moderate one",
                ));
            }
        }
        self.scene.instances.extend(instances);
        self.scene.lights.extend(lights.iter().filter_map(|light| moved(light, world_from_object)));
        Ok(())
    }

    fn transform(&self, keys: &ObjectKeys) -> Result<Mat4, Error> {
        let translation = self.finite("translation", keys.translation.unwrap_or_default())?;
        let [x, y, z] =
            self.finite("rotation", keys.rotation.unwrap_or_default())?.to_array().map(f32::to_radians);
        let rotation = Quat::from_rotation_z(z) * Quat::from_rotation_y(y) * Quat::from_rotation_x(x);
        let scale = self.finite("scale", keys.scale.map_or([1.0; 3], |scale| scale.0))?;
        if scale.to_array().contains(&0.0) {
            return Err(self.error("scale", scale.to_string(), "numbers that are not 0"));
        }
        Ok(Mat4::from_scale_rotation_translation(scale, rotation.normalize(), translation))
    }

    /// What a file brings; its meshes, materials and textures join the scene at first sight.
    fn file_model(&mut self, file: &str) -> Result<Model, Error> {
        let path = self.path("file", file)?;
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
            return Err(self.error("file", format!("{file:?}"), "a model: .gltf, .glb or .obj"));
        }
        // Different spellings of one path are one file.
        let key = path.canonicalize().unwrap_or_else(|_| path.clone());
        if let Some(model) = self.models.get(&key) {
            return Ok(model.clone());
        }
        let loaded = load_scene(&path, &self.remaining_limits())?;
        let model = self.join(loaded);
        self.models.insert(key, model.clone());
        Ok(model)
    }

    fn shape_model(&mut self, shape: &str) -> Result<Model, Error> {
        let key = PathBuf::from(format!("shape:{shape}"));
        if let Some(model) = self.models.get(&key) {
            return Ok(model.clone());
        }
        let mesh = shapes::by_name(shape).ok_or_else(|| {
            self.error("shape", format!("{shape:?}"), format!("one of {}", shapes::NAMES.join(", ")))
        })?;
        let instance =
            Instance { name: shape.to_owned(), mesh: 0, material: 0, world_from_local: Mat4::IDENTITY };
        let material = Material { name: shape.to_owned(), ..Material::default() };
        let scene = Scene {
            meshes: vec![mesh],
            materials: vec![material],
            instances: vec![instance],
            ..Scene::default()
        };
        let model = self.join(scene);
        self.models.insert(key, model.clone());
        Ok(model)
    }

    /// What the limits leave for one more file.
    fn remaining_limits(&self) -> Limits {
        let scene = &self.scene;
        let vertices: usize = scene.meshes.iter().map(|mesh| mesh.positions.len()).sum();
        let triangles: usize = scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        Limits {
            vertices: self.limits.vertices.saturating_sub(vertices as u64),
            triangles: self.limits.triangles.saturating_sub(triangles as u64),
            texture_bytes: self.limits.texture_bytes.saturating_sub(self.texture_bytes()),
            textures: self.limits.textures.saturating_sub(scene.textures.len() as u64),
            materials: self.limits.materials.saturating_sub(scene.materials.len() as u64),
            ..*self.limits
        }
    }

    fn texture_bytes(&self) -> u64 {
        self.scene.textures.iter().map(|texture| texture.rgba.len() as u64).sum()
    }

    /// Moves a loaded scene's meshes, materials and textures into this one.
    fn join(&mut self, mut loaded: Scene) -> Model {
        let scene = &mut self.scene;
        for material in &mut loaded.materials {
            overrides::texture_refs(material).for_each(|reference| reference.texture += scene.textures.len());
        }
        for instance in &mut loaded.instances {
            instance.mesh += scene.meshes.len();
            instance.material += scene.materials.len();
        }
        scene.meshes.append(&mut loaded.meshes);
        scene.materials.append(&mut loaded.materials);
        scene.textures.append(&mut loaded.textures);
        scene.warnings.append(&mut loaded.warnings);
        Model { instances: loaded.instances, lights: loaded.lights }
    }

    /// The scene's index of a height map, loaded at first sight.
    fn height_map(&mut self, file: &str) -> Result<usize, Error> {
        let path = self.path("height_map", file)?;
        if let Some(&index) = self.height_maps.get(&path) {
            return Ok(index);
        }
        self.check_height_maps("height_map")?;
        let (map, warnings) = height_map(&path, self.limits)?;
        self.scene.warnings.extend(warnings);
        Ok(self.push_height_map(path, map))
    }

    /// The scene's index of a built-in height map, made at first sight.
    fn builtin_height_map(&mut self, name: &str) -> Result<usize, Error> {
        let key = PathBuf::from(format!("builtin:{name}"));
        if let Some(&index) = self.height_maps.get(&key) {
            return Ok(index);
        }
        self.check_height_maps("builtin_height_map")?;
        let map = builtin::height_map(name).ok_or_else(|| {
            let expected = format!("one of {}", builtin::HEIGHT_MAPS.join(", "));
            self.error("builtin_height_map", format!("{name:?}"), expected)
        })?;
        Ok(self.push_height_map(key, map))
    }

    /// An error where the scene may not have another height map.
    fn check_height_maps(&self, key: &str) -> Result<(), Error> {
        if self.scene.height_maps.len() as u64 >= self.limits.textures {
            let expected = format!("at most {} (Limits::textures)", self.limits.textures);
            return Err(self.error(key, "one map more", expected));
        }
        Ok(())
    }

    fn push_height_map(&mut self, key: PathBuf, map: HeightMap) -> usize {
        let index = self.scene.height_maps.len();
        self.scene.height_maps.push(map);
        self.height_maps.insert(key, index);
        index
    }
}

/// A light of a file, placed with its object. The strength does not change with the scale.
fn moved(light: &Light, world_from_object: Mat4) -> Option<Light> {
    let mut light = *light;
    match &mut light {
        Light::Directional { direction_world, .. } => {
            *direction_world = world_from_object.transform_vector3(*direction_world).try_normalize()?;
        }
        Light::Point { position_world, .. } => {
            *position_world = world_from_object.transform_point3(*position_world);
        }
        Light::Spot { position_world, direction_world, .. } => {
            *position_world = world_from_object.transform_point3(*position_world);
            *direction_world = world_from_object.transform_vector3(*direction_world).try_normalize()?;
        }
    }
    Some(light)
}
