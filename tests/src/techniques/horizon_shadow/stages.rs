//! The scenes: a ground, a height map on it, and from where it is seen.

use super::{
    drawing::{Model, Shot},
    grounds::{Ground, Point},
    lab::{Query, Relief},
    rays::{Displaced, Heights},
};
use crate::{Scope, technique::Failure};
use glam::{DVec2, DVec3, Vec2, Vec3};
use horizon_shadow::{Surface, Wrap, frames::vertex_frames, model};
use scene::{Camera, HeightMap, Limits, Mesh, builtin, load};
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

/// Least and greatest curvature of a ground, over places and directions.
fn curvatures(ground: &Ground) -> [f64; 2] {
    let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
    for i in 0..16 * 16 {
        let uv = DVec2::new(f64::from(i % 16) + 0.5, f64::from(i / 16) + 0.5) / 16.0;
        let point = ground.point(uv);
        let first = point.along_u.normalize_or(DVec3::X);
        for turn in 0..16 {
            let (sin, cos) = (TAU / 32.0 * f64::from(turn)).sin_cos();
            let kappa = curvature_along(&point, first * cos + point.normal.cross(first) * sin);
            (least, greatest) = (least.min(kappa), greatest.max(kappa));
        }
    }
    [least, greatest]
}

fn built_in(name: &str) -> Result<(HeightMap, f64), Failure> {
    let map = builtin::height_map(name).ok_or("no such height map")?;
    let texels = builtin::height_map_texels(name).ok_or("no such height map")?;
    Ok((map, f64::from(texels)))
}

/// Metres along a map's side, one texel each.
fn size_m(map: &HeightMap) -> DVec2 {
    TEXEL_M * DVec2::new(f64::from(map.width), f64::from(map.height))
}

/// A sphere of a curvature a texel.
fn sphere(map: &HeightMap, kappa: f64) -> Ground {
    Ground::Sphere(TEXEL_M / kappa, size_m(map))
}

/// A built-in map on a ground that is made to fit it.
fn on(
    scene: &'static str,
    is_constant: bool,
    map: &'static str,
    ground: impl Fn(&HeightMap) -> Ground + 'static,
    then: fn(Stage) -> Stage,
) -> Rc<Entry> {
    Entry::new(scene, is_constant, move || {
        let (map, texels) = built_in(map)?;
        let ground = ground(&map);
        Ok(then(Stage::new(scene, ground, map, texels, 1.0)))
    })
}

fn same(stage: Stage) -> Stage {
    stage
}

/// The paper's Figs. 4 and 5.
pub(super) fn cylinders_on_sphere(kappa: f64) -> Rc<Entry> {
    let scene = if kappa > 0.01 { "sphere-15-cylinders" } else { "sphere-5-cylinders" };
    on(scene, true, "cylinders", move |map| sphere(map, kappa), same)
}

/// The paper's Fig. 6.
pub(super) fn reptile() -> Rc<Entry> {
    on("sphere-reptile", true, "reptile_skin", |map| sphere(map, 0.006), |stage| stage.with_azimuths(16))
}

/// The paper's Fig. 7.
pub(super) fn bezier() -> Rc<Entry> {
    on("bezier-reptile", false, "reptile_skin", |map| patch(size_m(map)), |stage| stage.with_azimuths(16))
}

/// The paper's Figs. 8 and 9.
pub(super) fn dunes() -> Rc<Entry> {
    on("dunes-ripples", false, "ripples", |map| wave(size_m(map)), |stage| stage.with_light([14.0, 250.0]))
}

/// Rough ground on a sphere: what the goals are about.
pub(super) fn rough_sphere() -> Rc<Entry> {
    on("sphere-15-rough", true, "fbm", |map| sphere(map, 0.015), same)
}

/// One height everywhere, and the same with bumps that nobody sees.
pub(super) fn constant() -> Rc<Entry> {
    Entry::new("constant", true, || Ok(flat(0.0)))
}

pub(super) fn faint() -> Rc<Entry> {
    Entry::new("faint", true, || Ok(flat(1e-6)))
}

fn flat(bump: f32) -> Stage {
    let heights = (0..128 * 128).map(|i| 0.5 + bump * f32::from(i as u8 % 3)).collect();
    let map = HeightMap { name: "flat".into(), width: 128, height: 128, heights };
    let ground = sphere(&map, 0.005);
    Stage::new("flat", ground, map, 4.0, 1.0)
}

/// A bent patch as of the paper's Fig. 7.
fn patch(size: DVec2) -> Ground {
    const RISE: [[f64; 4]; 4] =
        [[0.0, 0.16, 0.1, -0.1], [0.1, 0.42, 0.34, 0.0], [0.06, 0.36, 0.3, -0.06], [-0.12, 0.1, 0.06, -0.2]];
    rising(size, RISE)
}

/// Two dunes.
fn wave(size: DVec2) -> Ground {
    const RISE: [[f64; 4]; 4] =
        [[0.0, 0.1, -0.04, 0.06], [0.5, 0.4, 0.56, 0.44], [-0.36, -0.3, -0.44, -0.3], [0.16, 0.2, 0.1, 0.22]];
    rising(size, RISE)
}

/// A patch over a rectangle, its control points raised by so much of its width.
fn rising(size: DVec2, rise: [[f64; 4]; 4]) -> Ground {
    let place = |index: usize| index as f64 / 3.0 - 0.5;
    Ground::Bezier(Box::new(std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            DVec3::new(size.x * place(column), size.x * rise[row][column], size.y * place(row))
        })
    })))
}

/// A real map, made smaller by whole factors, with white so many texels (of the smaller map) above
/// black.
fn real(scene: &'static str, file: &'static str, smaller: u32, texels: f64, kappa: f64) -> Option<Rc<Entry>> {
    crate::test_data(file)?;
    Some(Entry::new(scene, true, move || {
        let path = crate::test_data(file).ok_or("test data absent")?;
        let map = shrunk(&load::height_map(&path, &Limits::default())?.0, smaller);
        let range =
            map.heights.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[least, greatest], &height| {
                [least.min(height), greatest.max(height)]
            });
        let map = HeightMap {
            heights: map.heights.iter().map(|height| (height - range[0]) / (range[1] - range[0])).collect(),
            ..map
        };
        let ground = sphere(&map, kappa);
        Ok(Stage::new(scene, ground, map, texels, 1.0))
    }))
}

/// Means of `factor` by `factor` texels.
fn shrunk(map: &HeightMap, factor: u32) -> HeightMap {
    let (width, height) = (map.width / factor, map.height / factor);
    let texel = |i: u32| {
        let (x, y) = (i % width * factor, i / width * factor);
        let inside = |k: u32| map.heights[((y + k / factor) * map.width + x + k % factor) as usize];
        (0..factor * factor).map(inside).sum::<f32>() / (factor * factor) as f32
    };
    HeightMap { name: map.name.clone(), width, height, heights: (0..width * height).map(texel).collect() }
}

/// The scenes that this run judges on.
pub(super) fn entries(scope: &Scope) -> Vec<Rc<Entry>> {
    let saddle = |map: &HeightMap| Ground::Saddle(0.008 / TEXEL_M, size_m(map).x);
    let hollow = |map: &HeightMap| Ground::Cylinder(-TEXEL_M / 0.008, size_m(map));
    let round = |map: &HeightMap| Ground::Cylinder(TEXEL_M / 0.015, size_m(map));
    let ring = |map: &HeightMap| {
        let (ring, tube) = (250.0 * TEXEL_M, 100.0 * TEXEL_M);
        Ground::Torus(ring, tube, size_m(map) / DVec2::new(ring + tube, tube))
    };
    let mut all =
        vec![cylinders_on_sphere(0.015), rough_sphere(), on("saddle-rough", false, "fbm", saddle, same)];
    if scope.quick {
        return all;
    }
    all.extend([
        cylinders_on_sphere(0.005),
        on("sphere-5-rough", true, "fbm", |map| sphere(map, 0.005), same),
        on("sphere-15-smooth", true, "fbm_smooth", |map| sphere(map, 0.015), same),
        on("plane-rough", true, "fbm", |map| Ground::Plane(size_m(map)), same),
        on("cylinder-rough", false, "fbm", round, same),
        on("hollow-rough", false, "fbm", hollow, same),
        on("torus-craters", false, "craters", ring, |stage| stage.around(0.5, 0.35)),
        reptile(),
        bezier(),
        dunes(),
    ]);
    all.extend(real("sphere-brick", "height/brick_height_16.png", 4, 2.5, 0.01));
    all.extend(real("sphere-jacksboro", "height/jacksboro_dem_16.png", 1, 10.0, 0.004));
    all.extend(real("sphere-shapes", "height/plain_heightmap_8.png", 2, 12.0, 0.006));
    all
}

/// The scenes whose pictures are timed.
pub(super) fn pictured(scope: &Scope) -> Vec<Rc<Entry>> {
    let mut all = vec![rough_sphere()];
    if !scope.quick {
        all.extend([
            reptile(),
            on("saddle-rough", false, "fbm", |map| Ground::Saddle(0.008 / TEXEL_M, size_m(map).x), same),
        ]);
    }
    all
}

/// The scenes whose errors are taken apart.
pub(super) fn dissected() -> Vec<Rc<Entry>> {
    vec![rough_sphere(), on("sphere-15-smooth", true, "fbm_smooth", |map| sphere(map, 0.015), same)]
}

#[cfg(test)]
mod tests {
    use super::*;

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
