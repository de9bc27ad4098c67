//! What each method costs on a screen of spheres from mirror to diffuse, and how wrong it is on the
//! tables of lobes.

use super::{
    accuracy::{self, Bench, SharedLab, with_lab},
    grid::Grid,
    lab::{Lab, Query, Surfaces, Way},
    maps,
};
use crate::{
    Context, Scope,
    technique::{Benchmark, Failure, Frame, Role, Running, SkipPair, Subject, Throughput, WorkDone},
};
use std::{cell::OnceCell, rc::Rc};

/// The methods that are timed; a quick run leaves out the slowest.
const WAYS: [Way; 14] = [
    Way::Sheen,
    Way::SheenFull,
    Way::Paper,
    Way::Mirror,
    Way::Harmonics,
    Way::Prefiltered(32),
    Way::Prefiltered(256),
    Way::Prefiltered(1024),
    Way::Brute(1),
    Way::Brute(4),
    Way::Brute(16),
    Way::Brute(64),
    Way::Brute(256),
    Way::Brute(1024),
];

/// Pixels a side.
pub(super) const fn side(scope: &Scope) -> u32 {
    if scope.quick { 128 } else { 512 }
}

/// Sixteen spheres of t = 0, 1/15 ... 1 seen from afar; between them a wall of the same roughness
/// that faces the eye.
pub(super) fn spheres(side: u32) -> Vec<Query> {
    let cell = side / 4;
    let pixel = |i: u32| {
        let (x, y) = (i % side, i / side);
        let at = |c: u32| (f64::from(c % cell) + 0.5) / f64::from(cell) * 2.2 - 1.1;
        let (u, v) = (at(x), -at(y));
        let squared = u * u + v * v;
        let normal = if squared < 1.0 { [u, v, (1.0 - squared).sqrt()] } else { [0.0, 0.0, 1.0] };
        let which = (y / cell).min(3) * 4 + (x / cell).min(3);
        Query { normal: normal.map(|c| c as f32), view: [0.0, 0.0, -1.0], roughness: which as f32 / 15.0 }
    };
    (0..side * side).map(pixel).collect()
}

/// What all subjects of a benchmark share.
struct Shared {
    bench: Rc<Bench>,
    lab: SharedLab,
    queries: Vec<Query>,
    surfaces: OnceCell<Surfaces>,
    grid: Grid,
    greatest_roughness: f32,
}

impl Shared {
    fn with<T>(
        &self,
        context: &Context,
        f: impl FnOnce(&mut Lab, &Surfaces) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        with_lab(&self.lab, context, self.bench.map()?, |lab| {
            lab.set_greatest_roughness(self.greatest_roughness);
            let surfaces = self.surfaces.get_or_init(|| lab.surfaces(&self.queries));
            f(lab, surfaces)
        })
    }
}

/// All benchmarks.
pub(super) fn benchmarks(scope: &Scope) -> Vec<Benchmark> {
    let lab = SharedLab::default();
    let mut all: Vec<Benchmark> =
        entries(scope).iter().map(|entry| on_map(scope, entry, &lab)).collect();
    if let Some(first) = all.first_mut() {
        first.skips = skips(scope, &lab);
    }
    all
}

/// The maps of the tables; in a quick run two of them.
fn entries(scope: &Scope) -> Vec<accuracy::Entry> {
    let keep = |entry: &accuracy::Entry| !scope.quick || ["studio", "sky"].contains(&entry.scene);
    accuracy::entries(scope).into_iter().filter(keep).collect()
}

fn on_map(scope: &Scope, entry: &accuracy::Entry, lab: &SharedLab) -> Benchmark {
    let side = side(scope);
    let grid = Rc::new(accuracy::grid(scope));
    let shared = Rc::new(Shared {
        bench: Rc::clone(&entry.bench),
        lab: Rc::clone(lab),
        queries: spheres(side),
        surfaces: OnceCell::new(),
        grid: (*grid).clone(),
        greatest_roughness: 1.0,
    });
    Benchmark {
        scene: entry.scene.into(),
        setting: "16 spheres, t = 0 ... 1".into(),
        size: [side, side],
        truth: Some(accuracy::truth(scope, entry, &grid)),
        subjects: WAYS
            .into_iter()
            .filter(|way| !scope.quick || !matches!(way, Way::Prefiltered(257..) | Way::Brute(257..)))
            .map(|way| subject(way, &shared))
            .collect(),
        skips: Vec::new(),
    }
}

fn subject(way: Way, shared: &Rc<Shared>) -> Subject {
    let shared = Rc::clone(shared);
    Subject {
        method: way.name(),
        role: way.role(),
        series: way.series(),
        start: Box::new(move |context| {
            // Compiles, and builds once.
            shared.with(context, |lab, surfaces| {
                lab.build(way)?;
                lab.frame(way, surfaces).map(drop)
            })?;
            Ok(running(way, &shared))
        }),
    }
}

fn running(way: Way, shared: &Rc<Shared>) -> Running {
    let [preparing, framing, picturing, asking] = std::array::from_fn(|_| Rc::clone(shared));
    let precomputes = !matches!(way, Way::Mirror | Way::Brute(_) | Way::Independent(_) | Way::Paper);
    let rays = match way {
        Way::Brute(rays) => Some(rays),
        Way::Paper => Some(64),
        _ => None,
    };
    Running {
        prepare: precomputes.then(|| {
            let again = move |context: &mut Context| {
                preparing.with(context, |lab, _| {
                    lab.touch();
                    lab.build(way).map(drop)
                })
            };
            Box::new(again) as _
        }),
        frame: Box::new(move |context| framing.with(context, |lab, surfaces| frame(lab, way, surfaces))),
        picture: Some(Box::new(move |context| {
            picturing.with(context, |lab, _| picturing.grid.image(lab.radiance(way, &picturing.grid.queries)?))
        })),
        memory_bytes: Some(Box::new(move |context| asking.with(context, |lab, _| Ok(lab.memory_bytes(way))))),
        throughput: rays.map(|rays| Throughput {
            unit: "rays",
            per_frame: f64::from(rays) * shared.queries.len() as f64,
        }),
    }
}

fn frame(lab: &mut Lab, way: Way, surfaces: &Surfaces) -> Result<Frame, Failure> {
    let work = lab.frame(way, surfaces)?;
    let skipped = work.skipped.map(|skip| format!("diffuse-envmap: {}", skip.reason())).into_iter().collect();
    // The lighting itself is a pass of the laboratory's.
    // By the wall clock: software adapters write a dispatch's last timestamp before it has run.
    Ok(Frame { gpu_ms: None, work: WorkDone { passes: work.passes + 1, skipped } })
}

/// The work that the technique leaves out, each against the same picture with the work done.
fn skips(scope: &Scope, lab: &SharedLab) -> Vec<SkipPair> {
    let width = if scope.quick { 256 } else { 1024 };
    let studio = Bench::new(move || Some(maps::built_in("studio", width)));
    let side = side(scope);
    let shared = |bench: &Rc<Bench>, queries, greatest_roughness, lab: &SharedLab| {
        Rc::new(Shared {
            bench: Rc::clone(bench),
            lab: Rc::clone(lab),
            queries,
            surfaces: OnceCell::new(),
            grid: Grid::new(&[0.0], &[0.0], 1),
            greatest_roughness,
        })
    };
    let of_roughness = |roughness: f32| -> Vec<Query> {
        spheres(side).into_iter().map(|query| Query { roughness, ..query }).collect()
    };
    let all = shared(&studio, spheres(side), 1.0, lab);
    let lone_mirrors = shared(&studio, of_roughness(0.0), 0.0, lab);
    let mirrors = shared(&studio, of_roughness(0.0), 1.0, lab);
    // In a laboratory of its own: with one for both, each frame would bring its map anew.
    let own_lab = SharedLab::default();
    let constant = shared(&Bench::new(|| Some(maps::constant(128))), spheres(side), 1.0, &own_lab);
    let furnace = shared(&Bench::new(|| Some(maps::furnace(128))), spheres(side), 1.0, lab);
    let calm = shared(&Bench::new(move || Some(maps::calm(width))), spheres(side), 1.0, lab);
    vec![
        pair("the chain stands while the map does", true, building(&all, false), building(&all, true)),
        pair("mirrors alone build no chain", true, building(&lone_mirrors, true), building(&mirrors, true)),
        pair("a constant map takes no taps", false, lighting(Way::Sheen, &constant), lighting(Way::Sheen, &furnace)),
        pair(
            "one tap where a lobe sees little contrast",
            false,
            lighting(Way::Sheen, &calm),
            lighting(Way::SheenFull, &calm),
        ),
    ]
}

fn pair(name: &str, in_prepare: bool, skipping: Subject, whole: Subject) -> SkipPair {
    SkipPair { name: name.into(), skipping, whole, in_prepare }
}

/// Our method's chain as the part that is timed: made anew each time, or standing.
fn building(shared: &Rc<Shared>, is_new: bool) -> Subject {
    let shared = Rc::clone(shared);
    let start = move |_: &mut Context| {
        let (preparing, whole) = (Rc::clone(&shared), shown(Way::Sheen, &shared));
        let prepare = move |context: &mut Context| {
            preparing.with(context, |lab, _| {
                if is_new {
                    lab.touch();
                }
                lab.build(Way::Sheen).map(drop)
            })
        };
        Ok(Running { prepare: Some(Box::new(prepare)), ..whole })
    };
    Subject { method: "sheen".into(), role: Role::Ours, series: None, start: Box::new(start) }
}

/// A method's frame as the part that is timed, on what stands.
fn lighting(way: Way, shared: &Rc<Shared>) -> Subject {
    let shared = Rc::clone(shared);
    let start = move |_: &mut Context| Ok(shown(way, &shared));
    Subject { method: way.name(), role: way.role(), series: None, start: Box::new(start) }
}

/// Frames of a method, and the picture of the spheres.
fn shown(way: Way, shared: &Rc<Shared>) -> Running {
    let [framing, picturing] = std::array::from_fn(|_| Rc::clone(shared));
    Running {
        prepare: None,
        frame: Box::new(move |context| {
            framing.with(context, |lab, surfaces| frame(lab, way, surfaces))
        }),
        picture: Some(Box::new(move |context| {
            let values = picturing.with(context, |lab, surfaces| {
                lab.build(way)?;
                lab.frame(way, surfaces)?;
                lab.answers(surfaces)
            })?;
            let side = picturing.queries.len().isqrt();
            Ok(image_error::Image::new(side, side, values)?)
        })),
        memory_bytes: None,
        throughput: None,
    }
}

