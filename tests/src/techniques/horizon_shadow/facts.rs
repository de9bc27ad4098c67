//! Figures of `bench` that are no times of frames: bakes, memory, soft and prefiltered shadows, and
//! what the goals ask for.

use super::{
    accuracy::{Probes, SharedLab, answers, horizon_probes, parallel, with_lab},
    bench::{Scenery, side},
    lab::{Quantity, Query},
    metrics::{Classes, mean},
    stages::{self, Stage},
    tables::best_times_ms,
    ways::{OURS, PAPER, Way},
};
use crate::{
    Context, Scope,
    technique::{Fact, Failure, Measurement},
    truths,
};
use compositor::wgpu;
use gpu_context::{Gpu, upload};
use horizon_shadow::{
    Bake, Baker, Contents, Heights, Parts, Precision, Search, TableDesc, Tables, Wrap, cpu,
};
use scene::{HeightMap, builtin};
use std::{f64::consts::TAU, ops::ControlFlow, time::Instant};

/// All of them.
pub(super) fn measurements(scope: &Scope) -> Vec<Measurement> {
    let measurement = |name: &str, how: &str, run: fn(&mut Context) -> Result<Vec<Fact>, Failure>| {
        Measurement { name: format!("horizon-shadow {name}"), how: how.into(), run: Box::new(run) }
    };
    let mut all = vec![
        measurement("goals", GOALS, goals),
        measurement("memory", "bytes of the tables and three for height and normal", |_| Ok(memory())),
        measurement("soft shadows", SOFT, soft),
        measurement("minification", MINIFIED, minified),
        super::triangles::measurement(),
        measurement("bake, as far as 64 texels", BAKE, |context| bakes(context, 64.0)),
    ];
    if !scope.quick {
        all.push(measurement("bake, as far as 512 texels", BAKE, |context| bakes(context, 512.0)));
    }
    all
}

const GOALS: &str = "a picture of rough ground on a sphere (kappa 0.015): the best of several frames, pixels on the wrong \
     side, and bytes, ours over the others; goals: error 0.1 of the paper's at 2 times its memory and 1.3 times its \
     time, and the error of 256 steps at 1/20 of their time";
const SOFT: &str = "rough ground on a sphere, a light of 6 degrees: mean distance of the visibility from that of 256 \
     lights spread over its disc, each traced, where that is neither 0 nor 1, and in all";
const MINIFIED: &str = "rough ground on a sphere, pixels of 8 x 8 texels: mean distance of the visibility from that of \
     64 traced places of the pixel";
const BAKE: &str = "rough ground of 1,024 x 1,024 texels (256 x 256 in a quick run), 32 azimuths, two candidates of 16 \
     bits; brute force and CPU from single azimuths";

fn fact(name: impl Into<String>, value: f64, unit: &str, note: &str) -> Fact {
    Fact { name: name.into(), value, unit: unit.into(), note: note.into() }
}

fn goals(context: &mut Context) -> Result<Vec<Fact>, Failure> {
    let side = side(context.scope());
    let scenery = Scenery::new(stages::rough_sphere(), &SharedLab::default(), side);
    let truth = truths::get(context, &scenery.truth())?;
    let one = Way::Sheen(1, Precision::Compact);
    let ways = [OURS, PAPER, Way::Marched(256), one, Way::Certified];
    let times = best_times_ms(context, &scenery, &ways)?;
    let mut wrong = Vec::new();
    for way in ways {
        wrong.push(Classes::of(&scenery.picture(context, way)?, &truth).misclassified());
    }
    let bytes = |way| scenery.with(context, |lab, _, _| Ok(lab.memory_bytes(way) as f64));
    Ok(vec![
        fact("pixels on the wrong side, over the paper's", wrong[0] / wrong[1], "", "goal 0.1"),
        fact("time, over the paper's", times[0] / times[1], "", "goal 1.3"),
        fact(
            "memory, over the paper's",
            bytes(OURS)? / bytes(PAPER)?,
            "",
            "goal 2; one candidate, because the curvature is constant",
        ),
        fact("pixels on the wrong side, over those of 256 steps", wrong[0] / wrong[2], "", "goal 1"),
        fact("time, over that of 256 steps", times[0] / times[2], "", "goal 0.05"),
        fact("certified: pixels on the wrong side, over those of 256 steps", wrong[4] / wrong[2], "", ""),
        fact("certified: time, over that of 256 steps", times[4] / times[2], "", ""),
    ])
}

fn memory() -> Vec<Fact> {
    let bytes = |side: u32, azimuths: u32, contents: Contents| {
        let desc = TableDesc {
            size: [side; 2],
            azimuths,
            contents,
            wrap: [Wrap::Repeat; 2],
            curvature_per_texel: [-0.01, 0.015],
            texels_per_height: 5.0,
            radius_texels: 64.0,
        };
        desc.memory_bytes() as f64 / f64::from(1 << 20)
    };
    let published = Contents::Published(Tables::BetaAndDistance);
    let candidates = |count| Contents::Candidates { count, precision: Precision::Compact };
    let mut facts = Vec::new();
    for (figure, side, azimuths, said) in [("4", 128, 32, "1.0"), ("6", 256, 16, "2.2")] {
        let note = format!("{said} MB in the paper");
        facts.push(fact(format!("Fig. {figure}: paper"), bytes(side, azimuths, published), "MiB", &note));
        for count in [1, 2, 3, 4] {
            let name = format!("Fig. {figure}: sheen K={count}");
            facts.push(fact(name, bytes(side, azimuths, candidates(count)), "MiB", ""));
        }
    }
    facts
}

/// Mean distance of two lists of visibilities, of the places that `counts` takes.
fn apart(found: &[f32], truth: &[f64], counts: impl Fn(f64) -> bool) -> f64 {
    let pairs = found.iter().zip(truth).filter(|(_, truth)| counts(**truth));
    mean(&pairs.map(|(&found, truth)| (f64::from(found) - truth).abs()).collect::<Vec<_>>())
}

fn soft(context: &mut Context) -> Result<Vec<Fact>, Failure> {
    const RADIUS_RAD: f64 = 0.052_36;
    let entry = stages::rough_sphere();
    let stage = entry.stage()?;
    let probes = lit_probes(context.scope(), &stage);
    let truth = parallel(probes.uv.len(), &context.stop_flag(), |i| {
        let light = glam::DVec3::from(probes.light_world[i]);
        let (u, v) = light.any_orthonormal_pair();
        let lit = (0..256).filter(|&k| {
            let spread = ((f64::from(k) + 0.5) / 256.0).sqrt() * RADIUS_RAD.tan();
            let (sin, cos) = (TAU * 0.618_033_988_749_895 * f64::from(k)).sin_cos();
            let direction = (light + (u * cos + v * sin) * spread).normalize();
            stage.is_lit(probes.uv[i], direction.to_array())
        });
        lit.count() as f64 / 256.0
    })?;
    let lab = SharedLab::default();
    let hard = answers(context, &lab, &stage, OURS, Quantity::Visibility, &probes)?;
    let soft = with_lab(&lab, context, &stage, |lab| {
        let query = |(&uv, &light)| Query { light_radius_rad: RADIUS_RAD as f32, ..stage.query(uv, light) };
        let queries: Vec<Query> = probes.uv.iter().zip(&probes.light_world).map(query).collect();
        let queries = lab.queries(&queries);
        lab.answers(Quantity::Visibility, OURS, &queries)
    })?;
    let partly = |truth: f64| truth > 0.0 && truth < 1.0;
    Ok(vec![
        fact("soft, at the shadows' edges", apart(&soft, &truth, partly), "", ""),
        fact(
            "hard, at the shadows' edges",
            apart(&hard, &truth, partly),
            "",
            "the centre of the light alone",
        ),
        fact("soft, in all", apart(&soft, &truth, |_| true), "", ""),
        fact("hard, in all", apart(&hard, &truth, |_| true), "", ""),
    ])
}

/// Places with a light of 20 degrees, at the azimuths of the horizons' places.
fn lit_probes(scope: &Scope, stage: &Stage) -> Probes {
    let mut probes = horizon_probes(scope, stage);
    probes.uv.truncate(600);
    probes.light_world.truncate(600);
    let places = probes.uv.iter().zip(&mut probes.light_world).enumerate();
    for (i, (&uv, light)) in places {
        *light = stage.light_deg(uv, 20.0, 222.492 * i as f64);
    }
    probes
}

fn minified(context: &mut Context) -> Result<Vec<Fact>, Failure> {
    const TEXELS: f64 = 8.0;
    let entry = stages::rough_sphere();
    let stage = entry.stage()?;
    let probes = lit_probes(context.scope(), &stage);
    let step = stage.texels_per_uv().map(|texels| TEXELS / texels);
    let truth = parallel(probes.uv.len(), &context.stop_flag(), |i| {
        let lit = (0..64).filter(|&k| {
            let place = |part: i32| (f64::from(part) + 0.5) / 8.0 - 0.5;
            let [u, v] = probes.uv[i];
            stage.is_lit([u + place(k % 8) * step[0], v + place(k / 8) * step[1]], probes.light_world[i])
        });
        lit.count() as f64 / 64.0
    })?;
    let lab = SharedLab::default();
    let point = answers(context, &lab, &stage, OURS, Quantity::Visibility, &probes)?;
    let filtered = with_lab(&lab, context, &stage, |lab| {
        let query = |(&uv, &light)| Query {
            uv_dx: [step[0] as f32, 0.0],
            uv_dy: [0.0, step[1] as f32],
            ..stage.query(uv, light)
        };
        let queries: Vec<Query> = probes.uv.iter().zip(&probes.light_world).map(query).collect();
        lab.set_prefilter(true);
        let queries = lab.queries(&queries);
        lab.answers(Quantity::Visibility, OURS, &queries)
    })?;
    Ok(vec![
        fact("prefiltered", apart(&filtered, &truth, |_| true), "", ""),
        fact("one place of each pixel", apart(&point, &truth, |_| true), "", "what aliases"),
    ])
}

/// Times of the searches on one large map.
fn bakes(context: &mut Context, radius_texels: f32) -> Result<Vec<Fact>, Failure> {
    const AZIMUTHS: u32 = 32;
    let quick = context.scope().quick;
    let side = if quick { 256 } else { 1024 };
    let map = builtin::height_map_sized("fbm", [side; 2]).ok_or("no such height map")?;
    let desc = TableDesc {
        size: [side; 2],
        azimuths: AZIMUTHS,
        contents: Contents::Candidates { count: 2, precision: Precision::Compact },
        wrap: [Wrap::Repeat; 2],
        curvature_per_texel: [-0.01, 0.015],
        texels_per_height: 60.0,
        radius_texels,
    };
    let gpu = context.gpu().clone();
    let bench = BakeBench::new(&gpu, &map, desc)?;
    // One along the axis, one beside it, one beside the diagonal.
    let some = [0, 2, 5];
    let mask = some.iter().fold(0_u64, |mask, azimuth| mask | 1 << azimuth);
    let share = f64::from(AZIMUTHS) / some.len() as f64;
    let all = u64::MAX >> (64 - AZIMUTHS);
    bench.time_s(Search::Sweep, 1)?;
    let sweep = bench.time_s(Search::Sweep, all)?;
    bench.time_s(Search::BruteForce, 1)?;
    let brute = share * bench.time_s(Search::BruteForce, mask)?;
    let field =
        cpu::HeightField { size: desc.size, values: &map.heights, range: [0.0, 1.0], wrap: desc.wrap };
    let started = Instant::now();
    cpu::bake(&field, &desc, mask, &|_| ControlFlow::Continue(()))?;
    let cpu = share * started.elapsed().as_secs_f64();
    let changed = bench.changed_s(side / 2..side / 2 + 16)?;
    let from_three = "from three azimuths";
    Ok(vec![
        fact("sweep", sweep, "s", ""),
        fact("brute force", brute, "s", from_three),
        fact("brute force, over the sweep", brute / sweep, "", "goal 20"),
        fact("CPU, brute force on all cores", cpu, "s", from_three),
        fact("16 rows changed", changed, "s", "sweep"),
        fact("16 rows changed, over everything", changed / sweep, "", ""),
    ])
}

/// A map on the GPU, to be baked again and again.
struct BakeBench<'a> {
    gpu: &'a Gpu,
    desc: TableDesc,
    view: wgpu::TextureView,
    baker: Baker,
}

impl<'a> BakeBench<'a> {
    fn new(gpu: &'a Gpu, map: &HeightMap, desc: TableDesc) -> Result<Self, Failure> {
        let format = wgpu::TextureFormat::R32Float;
        let bytes = bytemuck::cast_slice(&map.heights);
        let texture = upload::texture_2d(gpu, &map.name, map.width, map.height, format, bytes, None)?;
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self { gpu, desc, view, baker: Baker::new(gpu)? })
    }

    fn heights(&self) -> Heights<'_> {
        Heights { view: &self.view, range: [0.0, 1.0] }
    }

    /// Seconds that a bake of some azimuths takes, its textures included.
    fn time_s(&self, search: Search, azimuths: u64) -> Result<f64, Failure> {
        let started = Instant::now();
        let mut bake = self.baker.start(self.gpu, &self.desc, &self.heights(), Parts::default(), azimuths)?;
        self.finish(&mut bake, search)?;
        Ok(started.elapsed().as_secs_f64())
    }

    /// Seconds that all azimuths of some rows take after everything was baked.
    fn changed_s(&self, rows: std::ops::Range<u32>) -> Result<f64, Failure> {
        let mut bake = self.baker.start(self.gpu, &self.desc, &self.heights(), Parts::default(), u64::MAX)?;
        self.finish(&mut bake, Search::Sweep)?;
        let started = Instant::now();
        bake.rows_changed(&self.heights(), rows)?;
        self.finish(&mut bake, Search::Sweep)?;
        Ok(started.elapsed().as_secs_f64())
    }

    fn finish(&self, bake: &mut Bake, search: Search) -> Result<(), Failure> {
        while bake.progress().done < bake.progress().total {
            let mut encoder =
                self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            self.baker.record(self.gpu, &mut encoder, bake, search, 4)?;
            self.gpu.queue().submit([encoder.finish()]);
            self.gpu.wait()?;
        }
        Ok(())
    }
}
