//! Everything that a ray can meet, and what it finds there.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3};
use scene::{AlphaMode, Material, Mesh, Scene, TextureRef};

use crate::{
    Error, Lobe,
    bsdf::{Bsdf, Parameters},
    emitters::Emitters,
    environment::EnvironmentSampler,
    frame::Frame,
    geometry::{Geometry, Hit, Placement, Ray, RayFilter},
    lamps::Lamp,
    random,
    surface::Surface,
    textures::Textures,
};

/// A scene, ready to be traced.
pub(crate) struct World {
    pub(crate) geometry: Geometry,
    materials: Vec<Material>,
    textures: Textures,
    pub(crate) lamps: Vec<Lamp>,
    pub(crate) environment: Option<EnvironmentSampler>,
    pub(crate) emitters: Emitters,
}

/// A point of a triangle, with what is interpolated there.
struct Place<'a> {
    material: &'a Material,
    placement: &'a Placement,
    mesh: &'a Mesh,
    indices: [usize; 3],
    /// Weights of the mesh's corners in their own order.
    barycentric: [f64; 3],
    uv: DVec2,
}

impl World {
    /// An error where [`Scene::check`] has one, or where there are more triangles than are traced.
    pub(crate) fn new(scene: &Scene) -> Result<Self, Error> {
        scene.check()?;
        let geometry = Geometry::new(scene)?;
        let lamps = scene.lights.iter().filter_map(|light| Lamp::new(light, &geometry.space)).collect();
        let mut world = Self {
            geometry,
            materials: scene.materials.clone(),
            textures: Textures::new(&scene.textures),
            lamps,
            environment: scene.environment.as_ref().and_then(EnvironmentSampler::new),
            emitters: Emitters::default(),
        };
        world.emitters = Emitters::new(&world);
        Ok(world)
    }

    /// The surface that a ray has met.
    pub(crate) fn surface(&self, ray: &Ray, hit: &Hit, lobe: Lobe) -> Option<Surface> {
        let place = self.place(hit.triangle, hit.barycentric)?;
        let side = if hit.is_front { 1.0 } else { -1.0 };
        let normal_geometric = self.geometry.normal(hit.triangle) * side;
        let Material { normal_texture, normal_scale, clearcoat, .. } = place.material;
        // A back face, seen because the material is double-sided, is the same relief from behind.
        let smooth = place.normal(&self.textures, None, 1.0) * side;
        let relief = |texture: &Option<TextureRef>, scale| match texture {
            Some(texture) => place.normal(&self.textures, Some(texture), scale) * side,
            None => smooth,
        };
        let outgoing = -ray.direction;
        let normal = visible(relief(normal_texture, f64::from(*normal_scale)), outgoing);
        let frame = Frame::new(normal);
        let mut parameters = self.parameters(&place);
        if clearcoat.factor > 0.0 {
            // The coat has a relief of its own; the base's does not show in it.
            let coat = visible(relief(&clearcoat.normal_texture, 1.0), outgoing);
            parameters.clearcoat_normal = frame.local_from_world(coat);
        }
        let bsdf = Bsdf::new(&parameters, lobe);
        let outgoing = frame.local_from_world(outgoing);
        let transmitted = bsdf.transmitted_by_coat(outgoing);
        Some(Surface {
            triangle: hit.triangle,
            position: self.geometry.point(hit.triangle, hit.barycentric),
            normal_geometric,
            frame,
            outgoing,
            bsdf,
            emitted: self.emitted(&place).map(|value| value * transmitted),
        })
    }

    /// Mean radiance that a triangle emits, channels added up: an estimate from a few points, above
    /// 0 wherever the triangle's material and its texture emit anything at all.
    pub(crate) fn mean_emission(&self, triangle: u32) -> f64 {
        const POINTS: u32 = 16;
        let Some(place) = self.place(triangle, [1.0 / 3.0; 3]) else { return 0.0 };
        let factor = place.material.emissive.as_dvec3();
        if factor.max_element() <= 0.0 {
            return 0.0;
        }
        let texture = place.material.emissive_texture.as_ref();
        if texture.is_none() {
            return factor.element_sum();
        }
        let [r, g, b, _] = self.textures.mean(texture);
        let everywhere = (factor * DVec3::new(r, g, b)).element_sum();
        let at_points: f64 = (0..POINTS)
            .filter_map(|index| {
                // Points of a lattice of rank one.
                let fraction = (f64::from(index) * 0.618_033_988_749_895).fract();
                let barycentric = on_triangle([(f64::from(index) + 0.5) / f64::from(POINTS), fraction]);
                self.place(triangle, barycentric)
            })
            .map(|place| self.emitted(&place).iter().sum::<f64>())
            .sum();
        at_points / f64::from(POINTS) + 0.05 * everywhere
    }

    /// What a triangle's point emits towards a ray that has met it, transparency included.
    pub(crate) fn emitted_at(&self, ray: &Ray, hit: &Hit, lobe: Lobe) -> Option<[f64; 3]> {
        let place = self.place(hit.triangle, hit.barycentric)?;
        let opacity = self.opacity(&place);
        let emitted = if place.material.clearcoat.factor > 0.0 {
            self.surface(ray, hit, lobe)?.emitted
        } else {
            self.emitted(&place)
        };
        Some(emitted.map(|value| value * opacity))
    }

    fn place(&self, triangle: u32, barycentric: [f64; 3]) -> Option<Place<'_>> {
        let id = self.geometry.ids.get(triangle as usize)?;
        let placement = self.geometry.placements.get(id.placement as usize)?;
        let mesh = self.geometry.meshes.get(placement.mesh)?;
        let indices = mesh.triangles.get(id.triangle as usize)?.map(|index| index as usize);
        let barycentric = placement.wound(barycentric);
        let material = self.materials.get(placement.material)?;
        let uv = |index: usize| mesh.uvs.get(index).map_or(DVec2::ZERO, |uv| uv.as_dvec2());
        let uv = (0..3).map(|corner| uv(indices[corner]) * barycentric[corner]).sum();
        Some(Place { material, placement, mesh, indices, barycentric, uv })
    }

    /// The chance that a place is there at all.
    fn opacity(&self, place: &Place<'_>) -> f64 {
        let Material { alpha_mode, base_color, base_color_texture, .. } = place.material;
        let alpha =
            || f64::from(base_color.w) * self.textures.lookup(base_color_texture.as_ref(), place.uv)[3];
        match *alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask { cutoff } => f64::from(u8::from(alpha() >= f64::from(cutoff))),
            AlphaMode::Blend => alpha(),
        }
    }

    fn emitted(&self, place: &Place<'_>) -> [f64; 3] {
        let emissive = place.material.emissive.as_dvec3();
        if emissive == DVec3::ZERO {
            return [0.0; 3];
        }
        let [r, g, b, _] = self.textures.lookup(place.material.emissive_texture.as_ref(), place.uv);
        (emissive * DVec3::new(r, g, b)).to_array()
    }

    fn parameters(&self, place: &Place<'_>) -> Parameters {
        let Place { material, uv, .. } = place;
        let lookup = |texture: &Option<TextureRef>| self.textures.lookup(texture.as_ref(), *uv);
        let color = lookup(&material.base_color_texture);
        let base_color = material.base_color.to_array();
        let metallic_roughness = lookup(&material.metallic_roughness_texture);
        let occlusion = lookup(&material.occlusion_texture)[0];
        let mut parameters = Parameters {
            base_color: std::array::from_fn(|channel| f64::from(base_color[channel]) * color[channel]),
            metallic: f64::from(material.metallic) * metallic_roughness[2],
            roughness: f64::from(material.roughness) * metallic_roughness[1],
            ks: material.ks.map(|ks| ks.to_array().map(f64::from)),
            shininess: material.shininess.map(f64::from),
            spread_rad: material.spread_deg.map(|degrees| f64::from(degrees).to_radians().min(FRAC_PI_2)),
            ambient_occlusion: 1.0 + f64::from(material.occlusion_strength) * (occlusion - 1.0),
            ..Parameters::default()
        };
        if material.clearcoat.factor > 0.0 {
            let coat = &material.clearcoat;
            parameters.clearcoat = f64::from(coat.factor) * lookup(&coat.texture)[0];
            parameters.clearcoat_roughness = f64::from(coat.roughness) * lookup(&coat.roughness_texture)[1];
        }
        parameters
    }
}

impl RayFilter for World {
    fn is_present(&self, ray: &Ray, hit: &Hit) -> bool {
        let Some(place) = self.place(hit.triangle, hit.barycentric) else { return false };
        let opacity = self.opacity(&place);
        opacity >= 1.0 || (opacity > 0.0 && random::of_pair(ray.key, hit.triangle) < opacity)
    }
}

impl Place<'_> {
    /// The unit shading normal of the front: interpolated, or that of a normal texture.
    fn normal(&self, textures: &Textures, texture: Option<&TextureRef>, scale: f64) -> DVec3 {
        let Self { placement, mesh, indices, barycentric, uv, .. } = self;
        let sum = |at: &dyn Fn(usize) -> DVec3| -> DVec3 {
            (0..3).map(|corner| at(indices[corner]) * barycentric[corner]).sum()
        };
        let normal =
            sum(&|index| mesh.normals.get(index).map_or(DVec3::Y, |&normal| placement.normal_world(normal)));
        let smooth = normal.normalize_or(DVec3::Y);
        let (Some(texture), Some(first)) = (texture, mesh.tangents.get(indices[0])) else { return smooth };
        // mikktspace: the interpolated vectors are used as they are, neither normalised nor made
        // orthogonal, because the map was baked against them.
        let tangent = sum(&|index| {
            mesh.tangents.get(index).map_or(DVec3::X, |tangent| placement.tangent_world(tangent.truncate()))
        });
        let sign = f64::from(first.w).signum() * placement.handedness();
        let bitangent = normal.cross(tangent) * sign;
        let [x, y, z, _] = textures.lookup(Some(texture), *uv).map(|value| 2.0 * value - 1.0);
        (tangent * (x * scale) + bitangent * (y * scale) + normal * z).normalize_or(smooth)
    }
}

/// Bends a normal that faces away from the viewer (as interpolation and normal maps produce at
/// silhouettes) just so far that the surface can be seen.
fn visible(normal: DVec3, outgoing: DVec3) -> DVec3 {
    const LEAST_COSINE: f64 = 1.0 / 256.0;
    let cosine = normal.dot(outgoing);
    if cosine >= LEAST_COSINE {
        return normal;
    }
    (normal + outgoing * (LEAST_COSINE - cosine)).normalize_or(outgoing)
}

/// The barycentric weights of a point of a triangle, uniform over its area.
pub(crate) fn on_triangle([u, v]: [f64; 2]) -> [f64; 3] {
    let root = u.sqrt();
    [1.0 - root, root * (1.0 - v), root * v]
}
