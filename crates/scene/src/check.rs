//! What can be said about a whole scene: whether it is valid, how large it is, where to stand.

use glam::{Mat4, Vec3};

use crate::{Camera, Environment, Error, Light, Material, Mesh, Scene, Texture, TextureRef};

/// Result of one check: what is wrong, if anything.
type Check = Result<(), Error>;

impl Scene {
    /// Verifies what every user of a scene relies on: indices in range, arrays of equal length,
    /// finite numbers in their documented ranges, transforms that can be inverted. The error
    /// names the first thing that is wrong. Scenes made by this crate pass.
    pub fn check(&self) -> Check {
        for (index, mesh) in self.meshes.iter().enumerate() {
            self.check_mesh(&format!("meshes[{index}]"), mesh)?;
        }
        for (index, texture) in self.textures.iter().enumerate() {
            self.check_texture(&format!("textures[{index}]"), texture)?;
        }
        for (index, map) in self.height_maps.iter().enumerate() {
            let place = format!("height_maps[{index}]");
            self.check_size(&place, map.width, map.height, map.heights.len(), 1)?;
            self.expect(
                map.heights.iter().all(|height| height.is_finite()),
                &place,
                "a height",
                "finite heights",
            )?;
        }
        for (index, material) in self.materials.iter().enumerate() {
            self.check_material(&format!("materials[{index}]"), material)?;
        }
        for (index, instance) in self.instances.iter().enumerate() {
            let place = format!("instances[{index}]");
            self.check_index(&place, "mesh", instance.mesh, self.meshes.len())?;
            self.check_index(&place, "material", instance.material, self.materials.len())?;
            self.expect(
                is_usable(instance.world_from_local),
                &place,
                "its transform",
                "finite and invertible",
            )?;
        }
        for (index, light) in self.lights.iter().enumerate() {
            self.expect(
                light_is_valid(light),
                &format!("lights[{index}]"),
                &format!("{light:?}"),
                "a valid light",
            )?;
        }
        if let Some(camera) = &self.camera {
            self.expect(camera_is_valid(camera), "camera", &format!("{camera:?}"), "a valid camera")?;
        }
        self.environment.as_ref().map_or(Ok(()), |environment| self.check_environment(environment))
    }

    /// Least and greatest corner of a box around everything that is placed, in world space;
    /// `None` for a scene without vertices. It is exact for meshes that are not turned.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let local: Vec<_> = self.meshes.iter().map(Mesh::bounds).collect();
        let boxes = self.instances.iter().filter_map(|instance| {
            let (low, high) = (*local.get(instance.mesh)?)?;
            let world_from_local = instance.world_from_local;
            let center = world_from_local.transform_point3(low * 0.5 + high * 0.5);
            // The farthest any corner reaches along each axis.
            let axes = [world_from_local.x_axis, world_from_local.y_axis, world_from_local.z_axis];
            let half = (high * 0.5 - low * 0.5).to_array();
            let reach: Vec3 = axes.iter().zip(half).map(|(axis, half)| axis.truncate().abs() * half).sum();
            Some((center - reach, center + reach))
        });
        boxes.reduce(|(low, high), (other_low, other_high)| (low.min(other_low), high.max(other_high)))
    }

    /// Triangles as placed: a mesh with two instances counts twice.
    pub fn triangle_count(&self) -> u64 {
        let of_instance = |instance: &crate::Instance| {
            self.meshes.get(instance.mesh).map_or(0, |mesh| mesh.triangles.len())
        };
        self.instances.iter().map(|instance| of_instance(instance) as u64).sum()
    }

    /// A camera that sees the whole scene from the front, a little from the right and from above,
    /// in a picture of the given width over height.
    pub fn framing_camera(&self, aspect: f32) -> Camera {
        const FOV_Y_RAD: f32 = 0.6;
        let (low, high) = self.bounds().filter(is_finite).unwrap_or((Vec3::NEG_ONE, Vec3::ONE));
        let target = 0.5 * (low + high);
        let backward = Vec3::new(0.55, 0.4, 1.0).normalize();
        let right = Vec3::Y.cross(backward).normalize();
        let up = backward.cross(right);
        let aspect = if aspect.is_finite() { aspect.clamp(0.01, 100.0) } else { 1.0 };
        let tan_y = (0.5 * FOV_Y_RAD).tan();
        // The distance at which a corner just touches the side or the top of the picture.
        let distance = |corner: Vec3| {
            let offset = corner - target;
            let sideways = (offset.dot(right).abs() / (tan_y * aspect)).max(offset.dot(up).abs() / tan_y);
            offset.dot(backward) + sideways
        };
        let corner = |index: usize| {
            Vec3::from([0, 1, 2].map(|axis| if index >> axis & 1 == 0 { low[axis] } else { high[axis] }))
        };
        let farthest = (0..8).map(|index| distance(corner(index))).fold(0.0, f32::max);
        // Some air around it, and some distance from a single point however far it is from 0.
        let least = 1e-3 * (1.0 + target.abs().max_element());
        Camera {
            eye: target + backward * (1.1 * farthest).max(least),
            target,
            up: Vec3::Y,
            fov_y_rad: FOV_Y_RAD,
        }
    }

    fn expect(&self, is_valid: bool, place: &str, found: &str, expected: &str) -> Check {
        if is_valid {
            Ok(())
        } else {
            Err(Error::new(&self.name, place, format!("{found} is not"), expected))
        }
    }

    fn check_index(&self, place: &str, what: &str, index: usize, count: usize) -> Check {
        let place = format!("{place}.{what}");
        self.expect(index < count, &place, &format!("index {index}"), &format!("an index below {count}"))
    }

    fn check_size(&self, place: &str, width: u32, height: u32, length: usize, per_pixel: u64) -> Check {
        let wanted =
            (width as u64).checked_mul(height as u64).and_then(|pixels| pixels.checked_mul(per_pixel));
        let found = format!("{width} x {height} with {length} numbers");
        self.expect(
            wanted == Some(length as u64) && length > 0,
            place,
            &found,
            "a full image of at least one pixel",
        )
    }

    fn check_mesh(&self, place: &str, mesh: &Mesh) -> Check {
        let count = mesh.positions.len();
        let optional = |length: usize| length == count || length == 0;
        let lengths =
            mesh.normals.len() == count && optional(mesh.uvs.len()) && mesh.tangents.len() == mesh.uvs.len();
        self.expect(lengths, place, "the length of its vertex arrays", "equal")?;
        let in_range = mesh.triangles.as_flattened().iter().all(|&index| (index as usize) < count);
        self.expect(in_range, place, "every index", "below the number of vertices")?;
        self.expect(
            mesh.positions.iter().all(|position| position.is_finite()),
            place,
            "every position",
            "finite",
        )?;
        let is_unit = |vector: Vec3| (vector.length_squared() - 1.0).abs() < 1e-3;
        self.expect(
            mesh.normals.iter().all(|&normal| is_unit(normal)),
            place,
            "every normal",
            "of unit length",
        )?;
        let tangents =
            mesh.tangents.iter().all(|tangent| is_unit(tangent.truncate()) && [-1.0, 1.0].contains(&tangent.w));
        self.expect(tangents, place, "every tangent", "of unit length with a sign of -1 or 1")?;
        self.expect(mesh.uvs.iter().all(|uv| uv.is_finite()), place, "every uv", "finite")
    }

    fn check_texture(&self, place: &str, texture: &Texture) -> Check {
        self.check_size(place, texture.width, texture.height, texture.rgba.len(), 4)
    }

    fn check_material(&self, place: &str, material: &Material) -> Check {
        let unit = |value: f32| (0.0..=1.0).contains(&value);
        let factors = [material.metallic, material.roughness, material.occlusion_strength]
            .into_iter()
            .chain(material.base_color.to_array())
            .chain([material.clearcoat.factor, material.clearcoat.roughness]);
        self.expect(factors.into_iter().all(unit), place, "every factor", "in 0..1")?;
        let emissive = material.emissive.is_finite() && material.emissive.min_element() >= 0.0;
        self.expect(
            emissive && material.normal_scale.is_finite(),
            place,
            "its emission or normal scale",
            "finite",
        )?;
        let positive = |value: Option<f32>| value.is_none_or(|value| value.is_finite() && value >= 0.0);
        let overrides = positive(material.shininess) && positive(material.spread_deg);
        let ks = material.ks.is_none_or(|ks| ks.is_finite() && ks.min_element() >= 0.0);
        self.expect(overrides && ks, place, "ks, shininess or spread_deg", "finite and at least 0")?;
        for reference in texture_refs(material) {
            self.check_index(place, "texture", reference.texture, self.textures.len())?;
            self.expect(
                reference.texture_from_vertex_uv.is_finite(),
                place,
                "a texture transform",
                "finite",
            )?;
        }
        let Some(height) = &material.height else { return Ok(()) };
        let finite = height.height_scale.is_finite() && height.uv_scale.iter().all(|scale| scale.is_finite());
        self.expect(finite, place, "the height map's scale", "finite")?;
        self.check_index(place, "height.map", height.map, self.height_maps.len())
    }

    fn check_environment(&self, environment: &Environment) -> Check {
        let Environment { width, height, pixels, .. } = environment;
        self.check_size("environment", *width, *height, pixels.len(), 1)?;
        let is_radiance = |value: f32| value.is_finite() && value >= 0.0;
        let valid =
            pixels.as_flattened().iter().copied().all(is_radiance) && is_radiance(environment.intensity);
        self.expect(valid, "environment", "every radiance", "finite and at least 0")?;
        self.expect(environment.rotation_rad.is_finite(), "environment", "its rotation", "finite")
    }
}

/// Every texture that a material uses.
fn texture_refs(material: &Material) -> impl Iterator<Item = &TextureRef> {
    [
        &material.base_color_texture,
        &material.metallic_roughness_texture,
        &material.normal_texture,
        &material.occlusion_texture,
        &material.emissive_texture,
        &material.clearcoat.texture,
        &material.clearcoat.roughness_texture,
        &material.clearcoat.normal_texture,
    ]
    .into_iter()
    .flatten()
}

/// Whether a transform is finite, affine, and has a finite inverse.
pub(crate) fn is_usable(world_from_local: Mat4) -> bool {
    world_from_local.is_finite()
        && world_from_local.row(3) == glam::Vec4::W
        && world_from_local.determinant() != 0.0
        && world_from_local.inverse().is_finite()
}

fn is_finite((low, high): &(Vec3, Vec3)) -> bool {
    // The extent must be finite as well.
    low.is_finite() && high.is_finite() && (*high - *low).is_finite() && (*high + *low).is_finite()
}

pub(crate) fn camera_is_valid(camera: &Camera) -> bool {
    let view = camera.target - camera.eye;
    let finite = camera.eye.is_finite() && view.is_finite() && camera.up.is_finite();
    let has_directions = view != Vec3::ZERO && view.cross(camera.up) != Vec3::ZERO;
    finite && has_directions && camera.fov_y_rad > 0.0 && camera.fov_y_rad < std::f32::consts::PI
}

fn light_is_valid(light: &Light) -> bool {
    let strength = |color: Vec3| color.is_finite() && color.min_element() >= 0.0;
    let is_unit = |direction: Vec3| (direction.length_squared() - 1.0).abs() < 1e-3;
    match *light {
        Light::Directional { direction_world, irradiance, angular_diameter_rad } => {
            let diameter = (0.0..=std::f32::consts::PI).contains(&angular_diameter_rad);
            is_unit(direction_world) && strength(irradiance) && diameter
        }
        Light::Point { position_world, intensity, range } => {
            position_world.is_finite() && strength(intensity) && range > 0.0
        }
        Light::Spot {
            position_world,
            direction_world,
            intensity,
            range,
            inner_angle_rad,
            outer_angle_rad,
        } => {
            let cone =
                0.0 <= inner_angle_rad && inner_angle_rad < outer_angle_rad && outer_angle_rad.is_finite();
            position_world.is_finite()
                && is_unit(direction_world)
                && strength(intensity)
                && range > 0.0
                && cone
        }
    }
}
