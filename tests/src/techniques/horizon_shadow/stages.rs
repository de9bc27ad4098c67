//! The scenes: a ground, a height map on it, and from where it is seen.

mod entries;

pub(super) use entries::{
    bezier, constant, cylinders_on_sphere, dissected, dunes, entries, faint, pictured, reptile, rough_sphere,
};

use super::{
    drawing::{Model, Shot},
    grounds::{Ground, Point},
    lab::{Query, Relief},
    rays::{Displaced, Heights},
};
use crate::technique::Failure;
use glam::{DVec2, DVec3, Vec2, Vec3};
use horizon_shadow::{Surface, Wrap, frames::vertex_frames, model};
use scene::{Camera, HeightMap, Mesh};
use std::{cell::OnceCell, f64::consts::TAU, rc::Rc, sync::Arc};

/// Counts changes of the grounds, the maps and the rays.
pub(super) const TRUTH_VERSION: u32 = 4;

/// Length of a texel of the map where a ground is not stretched, metres.
const TEXEL_M: f64 = 1.0 / 128.0;

/// A scene that is made on first use.
pub(super) struct Entry {
    /// Its name in the reports.
    pub(super) scene: &'static str,
    /// Whether the curvature is the same everywhere and in all directions.
    pub(super) is_constant: bool,
    make: Box<dyn Fn() -> Result<Stage, Failure>>,
    made: OnceCell<Arc<Stage>>,
}

impl Entry {
    fn new(
        scene: &'static str,
        is_constant: bool,
        make: impl Fn() -> Result<Stage, Failure> + 'static,
    ) -> Rc<Self> {
        Rc::new(Self { scene, is_constant, make: Box::new(make), made: OnceCell::new() })
    }

    pub(super) fn stage(&self) -> Result<Arc<Stage>, Failure> {
        if let Some(made) = self.made.get() {
            return Ok(Arc::clone(made));
        }
        let made = Arc::new((self.make)()?);
        Ok(Arc::clone(self.made.get_or_init(|| made)))
    }
}

/// A horizon as it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrueHorizon {
    /// Sine of its elevation.
    pub(super) sin: f64,
    /// Curvature towards it, times the height of the place above the map's least.
    pub(super) kappa_h: f64,
    /// Curvature towards it, times its distance.
    pub(super) kappa_d: f64,
}

/// A height map on a ground.
#[derive(Debug)]
pub(super) struct Stage {
    pub(super) relief: Arc<Relief>,
    ground: Ground,
    heights: Heights,
    /// Middle of the windows, in u and v.
    center: DVec2,
    /// Elevation and azimuth of the pictures' light over the middle, degrees.
    light_deg: [f64; 2],
}

impl Stage {
    /// A map at a height, in texels of the map, on a ground; `repeats` of the map along u and v.
    fn new(name: &str, ground: Ground, map: HeightMap, height_texels: f64, repeats: f64) -> Self {
        let texels = DVec2::new(f64::from(map.width), f64::from(map.height)) * repeats;
        let middle = ground.point(DVec2::splat(0.5));
        let texel_m = (middle.along_u.length() / texels.x * middle.along_v.length() / texels.y).sqrt();
        let height_scale_m = height_texels * texel_m;
        let values_m: Vec<f64> =
            map.heights.iter().map(|&height| f64::from(height) * height_scale_m).collect();
        let heights = Heights {
            size: [map.width as usize, map.height as usize],
            greatest_m: values_m.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            values_m,
            wrap: [Wrap::Repeat; 2],
            uv_scale: DVec2::splat(repeats),
        };
        let relief = Relief {
            name: name.into(),
            map,
            height_scale_m: height_scale_m as f32,
            uv_scale: [repeats as f32; 2],
            wrap: heights.wrap,
            surface: Surface {
                texel_m: texel_m as f32,
                curvature_per_m: curvatures(&ground).map(|kappa| kappa as f32),
            },
            azimuths: 32,
            radius_texels: 64.0,
        };
        Self {
            relief: Arc::new(relief),
            ground,
            heights,
            center: DVec2::splat(0.5),
            light_deg: [20.0, 200.0],
        }
    }

    fn with_azimuths(self, azimuths: u32) -> Self {
        Self { relief: Arc::new(Relief { azimuths, ..(*self.relief).clone() }), ..self }
    }

    fn with_light(self, light_deg: [f64; 2]) -> Self {
        Self { light_deg, ..self }
    }

    fn around(self, u: f64, v: f64) -> Self {
        Self { center: DVec2::new(u, v), ..self }
    }

    /// Texels of the map over 0..1 of u and v.
    pub(super) fn texels_per_uv(&self) -> [f64; 2] {
        let Relief { map, uv_scale, .. } = &*self.relief;
        [f64::from(map.width) * f64::from(uv_scale[0]), f64::from(map.height) * f64::from(uv_scale[1])]
    }

    /// Least and greatest u and v of the places that are judged: 96 texels a side, inside the ground.
    pub(super) fn window(&self) -> [[f64; 2]; 2] {
        let texels = self.texels_per_uv();
        [-1.0, 1.0].map(|sign| {
            std::array::from_fn(|axis| (self.center[axis] + sign * 48.0 / texels[axis]).clamp(0.05, 0.95))
        })
    }

    /// The middle of the windows.
    pub(super) fn window_center(&self) -> [f64; 2] {
        self.center.to_array()
    }

    /// Unit vector from a point of the ground to a light: elevation above the ground, azimuth from
    /// u to v as the map's texels lie.
    pub(super) fn light_deg(&self, uv: [f64; 2], elevation_deg: f64, azimuth_deg: f64) -> [f64; 3] {
        let point = self.ground.point(uv.into());
        let [texels_u, texels_v] = self.texels_per_uv();
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        let across =
            (point.along_u * (cos / texels_u) + point.along_v * (sin / texels_v)).normalize_or(DVec3::X);
        let (up, out) = elevation_deg.to_radians().sin_cos();
        (across * out + point.normal * up).to_array()
    }

    /// The question that the library is asked.
    pub(super) fn query(&self, uv: [f64; 2], light_world: [f64; 3]) -> Query {
        let point = self.ground.point(uv.into());
        let wide = |v: DVec3| v.extend(0.0).as_vec4().to_array();
        Query {
            uv: uv.map(|x| x as f32),
            normal_world: wide(point.normal),
            along_u_world: wide(point.along_u),
            along_v_world: wide(point.along_v),
            second_form: wide(point.second_form),
            light_world: wide(light_world.into()),
            ..Query::default()
        }
    }

    fn displaced(&self) -> Displaced<'_> {
        let texel_m = f64::from(self.relief.surface.texel_m);
        let longest_m = f64::from(self.relief.radius_texels) * texel_m;
        Displaced { ground: &self.ground, heights: &self.heights, texel_m, longest_m }
    }

    /// Whether a light reaches the relief above u, v.
    pub(super) fn is_lit(&self, uv: [f64; 2], light_world: [f64; 3]) -> bool {
        self.displaced().hit_m(uv.into(), light_world.into()).is_none()
    }

    /// The horizon of the relief above u, v towards a light's azimuth.
    pub(super) fn horizon(&self, uv: [f64; 2], light_world: [f64; 3]) -> TrueHorizon {
        let point = self.ground.point(uv.into());
        let light = DVec3::from(light_world);
        let across = (light - point.normal * light.dot(point.normal)).normalize_or(DVec3::X);
        let displaced = self.displaced();
        // The relief has no overhangs: what lies below a blocked direction is blocked.
        let (mut blocked, mut free) = (-TAU / 4.0, TAU / 4.0);
        let mut distance_m = 0.0;
        for _ in 0..16 {
            let middle = 0.5 * (blocked + free);
            let (sin, cos) = middle.sin_cos();
            match displaced.hit_m(uv.into(), across * cos + point.normal * sin) {
                Some(distance) => (blocked, distance_m) = (middle, distance * cos),
                None => free = middle,
            }
        }
        let kappa = curvature_along(&point, across);
        TrueHorizon {
            sin: (0.5 * (blocked + free)).sin(),
            kappa_h: kappa * self.heights.at(uv.into()),
            kappa_d: kappa * distance_m,
        }
    }

    /// Sine of [`horizon`](Self::horizon).
    pub(super) fn sin_horizon(&self, uv: [f64; 2], light_world: [f64; 3]) -> f64 {
        self.horizon(uv, light_world).sin
    }

    /// Whether enough of the ground is around a place for its shadows to be those of an endless one.
    pub(super) fn has_surroundings(uv: [f64; 2]) -> bool {
        uv.iter().all(|x| (0.1..=0.9).contains(x))
    }

    /// Unit normal of the relief, by differences over a hundredth of a texel on both sides.
    pub(super) fn bump_normal(&self, uv: [f64; 2]) -> [f64; 3] {
        let texels = DVec2::from(self.texels_per_uv());
        let displaced = self.displaced();
        let change = |axis: DVec2| {
            let step = 0.5 * axis / texels;
            displaced.position(DVec2::from(uv) + step) - displaced.position(DVec2::from(uv) - step)
        };
        let normal = change(DVec2::Y).cross(change(DVec2::X));
        normal.normalize_or(self.ground.point(uv.into()).normal).to_array()
    }

    /// The ground as a mesh, and the displaced one.
    pub(super) fn model(&self) -> Result<Model, Failure> {
        let mesh = self.mesh(64, |point, _| point.position);
        let texels = self.texels_per_uv();
        // Two triangles' edges a texel, at most a million triangles.
        let dense = (2.0 * texels[0].max(texels[1])).min(768.0) as u32;
        let displaced = self.mesh(dense, |point, uv| point.position + point.normal * self.heights.at(uv));
        let array = |v: &Vec<Vec3>| v.iter().map(Vec3::to_array).collect::<Vec<_>>();
        let uvs: Vec<[f32; 2]> = mesh.uvs.iter().map(Vec2::to_array).collect();
        let frames = vertex_frames(&array(&mesh.positions), &array(&mesh.normals), &uvs, &mesh.triangles)?;
        Ok(Model { mesh, frames, displaced })
    }

    fn mesh(&self, cells: u32, position: impl Fn(&Point, DVec2) -> DVec3) -> Mesh {
        let mut mesh = Mesh { name: self.relief.name.clone(), ..Mesh::default() };
        for row in 0..=cells {
            for column in 0..=cells {
                let uv = DVec2::new(f64::from(column), f64::from(row)) / f64::from(cells);
                let point = self.ground.point(uv);
                mesh.positions.push(position(&point, uv).as_vec3());
                mesh.normals.push(point.normal.as_vec3());
                mesh.uvs.push(Vec2::new(uv.x as f32, uv.y as f32));
            }
        }
        let index = |column: u32, row: u32| row * (cells + 1) + column;
        for row in 0..cells {
            for column in 0..cells {
                let [a, b] = [index(column, row), index(column + 1, row)];
                let [c, d] = [index(column, row + 1), index(column + 1, row + 1)];
                mesh.triangles.extend([[a, c, b], [b, c, d]]);
            }
        }
        mesh
    }

    /// The whole ground, seen slantwise from over its middle.
    pub(super) fn shot(&self, size: [u32; 2]) -> Shot {
        const FOV_Y_RAD: f64 = 0.4;
        let ground = self.mesh(16, |point, _| point.position);
        let (least, greatest) = ground.bounds().unwrap_or_default();
        let target = (0.5 * (least + greatest)).as_dvec3();
        let radius = ground.positions.iter().map(|p| p.as_dvec3().distance(target)).fold(0.0, f64::max);
        let middle = self.ground.point(self.center);
        let up = -middle.along_v.normalize_or(DVec3::NEG_Z);
        let back = (middle.normal - 0.5 * up).normalize_or(DVec3::Y);
        let camera = Camera {
            eye: (target + back * (0.9 * radius / (0.5 * FOV_Y_RAD).sin())).as_vec3(),
            target: target.as_vec3(),
            up: up.as_vec3(),
            fov_y_rad: FOV_Y_RAD as f32,
        };
        let [elevation, azimuth] = self.light_deg;
        let light = self.light_deg(self.center.to_array(), elevation, azimuth);
        Shot { camera, size, light_world: light.map(|x| x as f32), angular_diameter_rad: 0.0 }
    }

    /// The horizon in a relief whose map is not stretched and whose curvature stays what it is at
    /// u, v: its sine, from the profile along a straight line of the map.
    pub(super) fn sin_profile(&self, profile: &model::Relief, uv: [f64; 2], azimuth_deg: f64) -> f64 {
        let point = self.ground.point(uv.into());
        let texels = DVec2::from(self.texels_per_uv());
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        let along = point.along_u * (cos / texels.x) + point.along_v * (sin / texels.y);
        let texel_m = along.length();
        let ray = model::Ray {
            relief: profile,
            at: (DVec2::from(uv) * texels - 0.5).to_array(),
            direction: [cos, sin],
            kappa: texel_m * curvature_along(&point, along / texel_m),
            texels_per_height: f64::from(self.relief.height_scale_m) / texel_m,
            radius_texels: f64::from(self.relief.radius_texels),
        };
        model::sine_of(ray.march_exact(8))
    }

    /// The heights as the model takes them.
    pub(super) fn profile(&self) -> model::Relief {
        let map = &self.relief.map;
        model::Relief::new([map.width, map.height], &map.heights, self.relief.range(), self.relief.wrap)
    }
}

/// Normal curvature along a unit vector in the ground.
fn curvature_along(point: &Point, across: DVec3) -> f64 {
    let (u, v, form) = (point.along_u, point.along_v, point.second_form);
    let (e, f, g) = (u.dot(u), u.dot(v), v.dot(v));
    let (x, y) = (across.dot(u), across.dot(v));
    let determinant = e * g - f * f;
    let (a, b) = ((g * x - f * y) / determinant, (e * y - f * x) / determinant);
    form.x * a * a + 2.0 * form.y * a * b + form.z * b * b
}

/// Range of a ground's normal curvatures over places and azimuths, without the outermost tenth at
/// either end: as `horizon_shadow::frames::surface` has it of a mesh.
fn curvatures(ground: &Ground) -> [f64; 2] {
    let mut all = Vec::new();
    for i in 0..16 * 16 {
        let uv = DVec2::new(f64::from(i % 16) + 0.5, f64::from(i / 16) + 0.5) / 16.0;
        let point = ground.point(uv);
        let area = point.along_u.cross(point.along_v).length();
        let first = point.along_u.normalize_or(DVec3::X);
        for turn in 0..8 {
            let (sin, cos) = (TAU / 16.0 * f64::from(turn)).sin_cos();
            let kappa = curvature_along(&point, first * cos + point.normal.cross(first) * sin);
            all.push((kappa, area));
        }
    }
    all.sort_by(|one, other| one.0.total_cmp(&other.0));
    let whole: f64 = all.iter().map(|(_, area)| area).sum();
    let value_at = |share: f64| {
        let mut below = 0.0;
        let is_there = |(_, area): &&(f64, f64)| {
            below += area;
            below >= share * whole
        };
        all.iter().find(is_there).map_or(0.0, |(kappa, _)| *kappa)
    };
    [0.1, 0.9].map(value_at)
}

#[cfg(test)]
mod tests {
    use super::{
        entries::{on, same, size_m},
        *,
    };

    /// Degrees between the rays' horizon and that of the profile along a straight line of the map,
    /// which is the same on a plane and nearly so on a sphere.
    fn apart_deg(stage: &Stage) -> Vec<f64> {
        let profile = stage.profile();
        let one = |i: u32| {
            let turn = |step: f64| (step * f64::from(i + 1)).fract();
            let uv = (DVec2::splat(0.5) + (DVec2::new(turn(0.755), turn(0.57)) - 0.5) * 0.2).to_array();
            let azimuth_deg = 360.0 * turn(0.618);
            let found = stage.sin_horizon(uv, stage.light_deg(uv, 10.0, azimuth_deg));
            (found.asin() - stage.sin_profile(&profile, uv, azimuth_deg).asin()).to_degrees().abs()
        };
        (0..200).map(one).collect()
    }

    #[test]
    fn rays_and_profiles_agree() {
        let plane = on("plane", true, "fbm", |map| Ground::Plane(size_m(map)), same).stage().unwrap();
        let apart = apart_deg(&plane);
        let worst = apart.iter().copied().fold(0.0, f64::max);
        assert!(worst < 0.5 && apart.iter().sum::<f64>() / 200.0 < 0.02, "{worst} {apart:?}");
        let apart = apart_deg(&rough_sphere().stage().unwrap());
        let mean = apart.iter().sum::<f64>() / 200.0;
        assert!(mean < 0.5, "{mean} {apart:?}");
    }
}
