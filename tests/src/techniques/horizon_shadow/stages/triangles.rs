//! The second truth: the relief as a million triangles, through which the path tracer sends the same
//! rays. It shares neither the search nor the inversion of the ground with the rays in f64.

use super::*;
use path_tracer::PathTracer;
use rayon::prelude::*;
use scene::{Instance, Material, Scene};

/// Triangles' edges a texel, on maps up to 128 texels wide and on wider ones. Even, so that the lines
/// between the cells of bilinear heights are edges; a triangle is off the relief within a cell by 1/8
/// of the relief's twist over the square of this.
const EDGES_PER_TEXEL: [f64; 2] = [6.0, 4.0];
/// Rays begin this far above the relief, in texels: more than the triangles are off.
const LIFT_TEXELS: f64 = 0.02;
/// A ray grazes where a light higher or lower by this gets another answer: about what the triangles
/// are off, seen over a texel.
const GRAZING_DEG: f64 = 0.25;
/// Samples of a scene.
const SAMPLES: u32 = 5_000;

#[derive(Clone, Copy, Debug, Default)]
struct Agreement {
    compared: u32,
    lit: u32,
    differ: u32,
    grazing: u32,
}

impl Agreement {
    fn of(compared: bool, rays: bool, triangles: bool) -> Self {
        let count = |is_so: bool| u32::from(is_so);
        Self {
            compared: count(compared),
            lit: count(compared && rays),
            differ: count(compared && rays != triangles),
            grazing: count(!compared),
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            compared: self.compared + other.compared,
            lit: self.lit + other.lit,
            differ: self.differ + other.differ,
            grazing: self.grazing + other.grazing,
        }
    }
}

/// The displaced ground of a stage as triangles.
fn tracer(stage: &Stage) -> PathTracer {
    let texels = stage.texels_per_uv();
    let side = texels[0].max(texels[1]);
    let cells = (EDGES_PER_TEXEL[usize::from(side > 128.0)] * side) as u32;
    let mut mesh = stage.mesh(cells, |point, uv| point.position + point.normal * stage.heights.at(uv));
    mesh.uvs.clear();
    let material = Material { double_sided: true, ..Material::default() };
    let instance =
        Instance { name: "relief".into(), mesh: 0, material: 0, world_from_local: glam::Mat4::IDENTITY };
    let scene = Scene {
        meshes: vec![mesh],
        materials: vec![material],
        instances: vec![instance],
        ..Scene::default()
    };
    PathTracer::new(&scene).unwrap()
}

/// Both truths on places around the middle and lights of all azimuths, from 10 degrees below the
/// ground's tangent plane to 50 degrees above it.
fn agreement(stage: &Stage) -> Agreement {
    let tracer = tracer(stage);
    let texel_m = f64::from(stage.relief.surface.texel_m);
    let texels = stage.texels_per_uv();
    // The triangles end where the map does.
    let displaced = Displaced { longest_m: 0.28 * texels[0].min(texels[1]) * texel_m, ..stage.displaced() };
    let sample = |index: u32| {
        let turn = |step: f64| (step * f64::from(index) + 0.5).fract();
        let uv = stage.center + (DVec2::new(turn(0.754_877_666), turn(0.569_840_291)) - 0.5) * 0.3;
        let (azimuth_deg, elevation_deg) = (360.0 * turn(0.618_033_989), 60.0 * turn(0.414_213_562) - 10.0);
        let height_m = displaced.heights.at(uv) + LIFT_TEXELS * texel_m;
        let light = |above_deg: f64| {
            DVec3::from(stage.light_deg(uv.to_array(), elevation_deg + above_deg, azimuth_deg))
        };
        let rays = |above_deg: f64| displaced.hit_from_m(uv, height_m, light(above_deg)).is_none();
        let is_lit = rays(0.0);
        let compared = rays(GRAZING_DEG) == is_lit && rays(-GRAZING_DEG) == is_lit;
        let ground = stage.ground.point(uv);
        let hit = tracer.trace_distance(ground.position + ground.normal * height_m, light(0.0).normalize());
        let triangles = hit.is_none_or(|distance| distance > displaced.longest_m);
        Agreement::of(compared, is_lit, triangles)
    };
    (0..SAMPLES).into_par_iter().map(sample).reduce(Agreement::default, Agreement::plus)
}

/// Of the samples that do not graze, at most one in a thousand differs; what grazes is stated.
#[test]
fn both_truths_agree() {
    let scope = crate::Scope { quick: false, ..crate::Scope::default() };
    let ours = ["rough", "smooth", "cylinders", "craters", "reptile", "dunes"];
    for entry in entries(&scope) {
        if !ours.iter().any(|name| entry.scene.contains(name)) {
            continue;
        }
        let start = std::time::Instant::now();
        let found = agreement(&entry.stage().unwrap());
        println!("{}: {found:?}, {:.1} s", entry.scene, start.elapsed().as_secs_f64());
        assert!(found.lit > SAMPLES / 10 && found.compared - found.lit > SAMPLES / 20, "{found:?}");
        assert!(found.grazing < SAMPLES / 20, "{}: {found:?}", entry.scene);
        assert!(found.differ * 1000 <= found.compared, "{}: {found:?}", entry.scene);
    }
}
