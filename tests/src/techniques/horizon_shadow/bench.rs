//! What each method costs on one picture, and how wrong it is there.

use super::{
    accuracy::{SharedLab, image, parallel, with_lab},
    drawing::Drawing,
    lab::Lab,
    stages::{self, Entry, Stage},
    ways::{OURS, PAPER, Way},
};
use crate::{
    Context, Scope,
    technique::{Benchmark, Failure, Frame, Role, Running, SkipPair, Subject, Truth, TruthImage, WorkDone},
};
use horizon_shadow::{Precision, Tables, Work};
use image_error::Image;
use std::{cell::RefCell, rc::Rc};

/// The methods that are timed.
const WAYS: [Way; 16] = [
    OURS,
    Way::Sheen(1, Precision::Compact),
    Way::Sheen(3, Precision::Compact),
    Way::Sheen(4, Precision::Compact),
    Way::Sheen(2, Precision::Full),
    Way::Tiles,
    Way::Certified,
    PAPER,
    Way::Paper(Tables::DistanceAndHeight),
    Way::Flat,
    Way::Exact,
    Way::None,
    Way::Marched(16),
    Way::Marched(64),
    Way::Marched(256),
    Way::ShadowMap,
];

/// Pixels a side.
pub(super) const fn side(scope: &Scope) -> u32 {
    if scope.quick { 128 } else { 512 }
}

/// One scene, seen by a camera: what all its subjects share.
pub(super) struct Scenery {
    pub(super) entry: Rc<Entry>,
    lab: SharedLab,
    drawing: RefCell<Option<Drawing>>,
    side: u32,
}

impl Scenery {
    pub(super) fn new(entry: Rc<Entry>, lab: &SharedLab, side: u32) -> Rc<Self> {
        Rc::new(Self { entry, lab: Rc::clone(lab), drawing: RefCell::default(), side })
    }

    /// Runs `f` with the relief in the laboratory and the mesh on the GPU.
    pub(super) fn with<T>(
        &self,
        context: &Context,
        f: impl FnOnce(&mut Lab, &mut Drawing, &Stage) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let stage = self.entry.stage()?;
        let mut slot = self.drawing.borrow_mut();
        let mut drawing = if let Some(drawing) = slot.take() {
            drawing
        } else {
            let shot = stage.shot([self.side; 2]);
            Drawing::new(context.gpu(), &stage.model()?, &stage.relief, shot)?
        };
        let result = with_lab(&self.lab, context, &stage, |lab| f(lab, &mut drawing, &stage));
        *slot = Some(drawing);
        result
    }

    /// Visibility of every pixel as a method sees it.
    pub(super) fn picture(&self, context: &Context, way: Way) -> Result<Image, Failure> {
        let values = self.with(context, |lab, drawing, stage| {
            drawing.frame(lab, &stage.relief, way)?;
            drawing.visibility()
        })?;
        image([self.side as usize; 2], &values)
    }

    /// Visibility of every pixel by tracing, and which pixels show the surface.
    pub(super) fn truth(self: &Rc<Self>) -> Truth {
        let shared = Rc::clone(self);
        let key = format!("horizon-shadow picture {} {}", stages::TRUTH_VERSION, shared.entry.scene);
        Truth {
            key: Some(format!("{key} {}", shared.side)),
            make: Box::new(move |context: &mut Context| shared.traced(context)),
        }
    }

    fn traced(&self, context: &Context) -> Result<TruthImage, Failure> {
        let stage = self.entry.stage()?;
        let coordinates = self.with(context, |_, drawing, stage| drawing.coordinates(&stage.relief))?;
        let texels: Vec<&[f32]> = coordinates.values.chunks_exact(4).collect();
        let light = stage.shot([self.side; 2]).light_world.map(f64::from);
        let values = parallel(texels.len(), &context.stop_flag(), |i| {
            let covered = texels[i][3] > 0.5;
            let uv = [texels[i][0], texels[i][1]].map(f64::from);
            f32::from(covered && stage.is_lit(uv, light))
        })?;
        let mask = texels.iter().map(|texel| {
            let uv = [texel[0], texel[1]].map(f64::from);
            texel[3] > 0.5 && Stage::has_surroundings(uv)
        });
        Ok(TruthImage {
            image: image([self.side as usize; 2], &values)?,
            variance_of_mean: None,
            mask: Some(mask.collect()),
            how: "rays in f64 through the displaced surface, one for each pixel".into(),
        })
    }
}

/// All benchmarks.
pub(super) fn benchmarks(scope: &Scope) -> Vec<Benchmark> {
    let lab = SharedLab::default();
    let mut all: Vec<Benchmark> = stages::pictured(scope)
        .into_iter()
        .map(|entry| on_scene(&Scenery::new(entry, &lab, side(scope)), scope))
        .collect();
    if let Some(first) = all.first_mut() {
        first.skips = skips(scope, &lab);
    }
    all
}

fn on_scene(shared: &Rc<Scenery>, scope: &Scope) -> Benchmark {
    Benchmark {
        scene: shared.entry.scene.into(),
        setting: "visibility of one light".into(),
        size: [shared.side; 2],
        truth: Some(shared.truth()),
        subjects: WAYS
            .into_iter()
            .filter(|way| !scope.quick || !matches!(way, Way::Marched(256)))
            .map(|way| subject(way, shared))
            .collect(),
        skips: Vec::new(),
    }
}

fn subject(way: Way, shared: &Rc<Scenery>) -> Subject {
    let shared = Rc::clone(shared);
    Subject {
        method: way.name(),
        role: way.role(),
        series: way.series(),
        start: Box::new(move |context| {
            // Compiles, and builds once.
            frame(context, &shared, way)?;
            Ok(running(way, &shared))
        }),
    }
}

fn frame(context: &Context, shared: &Scenery, way: Way) -> Result<Frame, Failure> {
    let work = shared.with(context, |lab, drawing, stage| drawing.frame(lab, &stage.relief, way))?;
    Ok(Frame { gpu_ms: None, work: done(&work) })
}

/// The technique's passes, and the one that draws the mesh.
fn done(work: &Work) -> WorkDone {
    let skipped = work.skipped.map(|skip| format!("horizon-shadow: {}", skip.reason()));
    WorkDone { passes: work.passes + 1, skipped: skipped.into_iter().collect() }
}

fn running(way: Way, shared: &Rc<Scenery>) -> Running {
    let [preparing, framing, picturing, asking] = std::array::from_fn(|_| Rc::clone(shared));
    let precomputes = !matches!(way, Way::None | Way::Marched(_) | Way::ShadowMap);
    Running {
        prepare: precomputes.then(|| {
            let again = move |context: &mut Context| rebuilt(context, &preparing, way);
            Box::new(again) as _
        }),
        frame: Box::new(move |context| frame(context, &framing, way)),
        picture: Some(Box::new(move |context| picturing.picture(context, way))),
        memory_bytes: Some(Box::new(move |context| {
            asking.with(context, |lab, drawing, _| {
                Ok(if way == Way::ShadowMap { drawing.shadow_map_bytes() } else { lab.memory_bytes(way) })
            })
        })),
        throughput: None,
    }
}

/// The tables made anew.
fn rebuilt(context: &Context, shared: &Scenery, way: Way) -> Result<(), Failure> {
    shared.with(context, |lab, _, _| {
        lab.touch();
        lab.build(way).map(drop)
    })
}

/// The work that the technique leaves out, each against the same picture with the work done.
fn skips(scope: &Scope, lab: &SharedLab) -> Vec<SkipPair> {
    let scenery = |entry| Scenery::new(entry, lab, side(scope));
    let rough = scenery(stages::rough_sphere());
    // In laboratories of their own: with one for both, each frame would bring its map anew.
    let own = |entry| Scenery::new(entry, &SharedLab::default(), side(scope));
    let (constant, faint) = (own(stages::constant()), own(stages::faint()));
    vec![
        pair(
            "tiles decide plainly lit and dark ground",
            false,
            subject(Way::Tiles, &rough),
            subject(OURS, &rough),
        ),
        pair("the tables stand while the heights do", true, building(&rough, false), building(&rough, true)),
        pair("one height everywhere reads no tables", false, subject(OURS, &constant), subject(OURS, &faint)),
        pair("one height everywhere bakes none", true, building(&constant, true), building(&faint, true)),
    ]
}

fn pair(name: &str, in_prepare: bool, skipping: Subject, whole: Subject) -> SkipPair {
    SkipPair { name: name.into(), skipping, whole, in_prepare }
}

/// Our method's tables as the part that is timed: made anew each time, or standing.
fn building(shared: &Rc<Scenery>, is_new: bool) -> Subject {
    let shared = Rc::clone(shared);
    let start = move |context: &mut Context| {
        frame(context, &shared, OURS)?;
        let preparing = Rc::clone(&shared);
        let prepare = move |context: &mut Context| {
            if is_new {
                return rebuilt(context, &preparing, OURS);
            }
            preparing.with(context, |lab, _, _| lab.build(OURS).map(drop))
        };
        Ok(Running { prepare: Some(Box::new(prepare)), ..running(OURS, &shared) })
    };
    Subject { method: OURS.name(), role: Role::Ours, series: None, start: Box::new(start) }
}
