//! Every method on windows of texture space and on tables of horizons, against tracing the
//! displaced surface.

use super::{
    bench::Scenery,
    lab::{Lab, Quantity},
    limits,
    metrics::{self, shadows},
    stages::{self, Entry, Stage},
    ways::{OURS, PAPER, Way},
};
use crate::{
    Context, Scope,
    technique::{Comparison, Failure, Kind, Method, Picture, Truth, TruthImage},
};
use image_error::Image;
use rayon::prelude::*;
use std::{
    cell::RefCell,
    rc::Rc,
    sync::atomic::{AtomicBool, Ordering},
};

/// Lights of the windows: elevation and azimuth in degrees over the middle of the window.
const LIGHTS_DEG: [[f64; 2]; 4] = [[8.0, 20.0], [18.0, 137.0], [32.0, 251.0], [55.0, 322.0]];

/// The laboratory of a run, made on first use.
pub(super) type SharedLab = Rc<RefCell<Option<Lab>>>;

/// Runs `f` in the laboratory with a stage's relief on the GPU.
pub(super) fn with_lab<T>(
    shared: &SharedLab,
    context: &Context,
    stage: &Stage,
    f: impl FnOnce(&mut Lab) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let mut slot = shared.borrow_mut();
    let lab = match slot.take() {
        Some(lab) => slot.insert(lab),
        None => slot.insert(Lab::new(context.gpu())?),
    };
    lab.hold(&stage.relief)?;
    f(lab)
}

/// Points of a surface, each with a light.
pub(super) struct Probes {
    /// Columns and rows of the picture.
    pub(super) size: [usize; 2],
    /// Texture coordinates of each point.
    pub(super) uv: Vec<[f64; 2]>,
    /// Unit vector towards each point's light.
    pub(super) light_world: Vec<[f64; 3]>,
}

/// A window of texture space under one light after the other, side by side.
pub(super) fn window(scope: &Scope, stage: &Stage) -> Probes {
    let (side, lights) = if scope.quick { (48, &LIGHTS_DEG[1..2]) } else { (128, &LIGHTS_DEG[..]) };
    let columns = side * lights.len();
    let texels = side as f64 / PIXELS_PER_TEXEL;
    let center = stage.window_center();
    let directions: Vec<[f64; 3]> =
        lights.iter().map(|&[elevation, azimuth]| stage.light_deg(center, elevation, azimuth)).collect();
    let at = |pixel: usize, center: f64, texels_per_uv: f64| {
        center + ((pixel as f64 + 0.5) / side as f64 - 0.5) * texels / texels_per_uv
    };
    let [texels_u, texels_v] = stage.texels_per_uv();
    let places = || (0..side).flat_map(move |row| (0..columns).map(move |column| (column, row)));
    Probes {
        size: [columns, side],
        uv: places().map(|(x, y)| [at(x % side, center[0], texels_u), at(y, center[1], texels_v)]).collect(),
        light_world: places().map(|(x, _)| directions[x / side]).collect(),
    }
}

/// Pixels of a window for each texel of the map.
const PIXELS_PER_TEXEL: f64 = 2.0;

/// Points and azimuths that are spread evenly and meet no texel's centre and no baked azimuth.
pub(super) fn horizon_probes(scope: &Scope, stage: &Stage) -> Probes {
    let side = if scope.quick { 24 } else { 56 };
    let [least, greatest] = stage.window();
    let mut probes = Probes { size: [side, side], uv: Vec::new(), light_world: Vec::new() };
    for i in 1..=side * side {
        // The additive recurrence of the plastic number's cousin in three dimensions.
        let [a, b, c] = [0.819_172_513, 0.671_043_607, 0.549_700_478].map(|step| (step * i as f64).fract());
        let uv = [least[0] + (greatest[0] - least[0]) * a, least[1] + (greatest[1] - least[1]) * b];
        probes.uv.push(uv);
        probes.light_world.push(stage.light_deg(uv, 10.0, 360.0 * c));
    }
    probes
}

/// The comparisons of this run: windows and horizons of every scene, and the pictures of some.
pub(super) fn comparisons(scope: &Scope) -> Vec<Comparison> {
    let lab = SharedLab::default();
    let pictures = stages::pictured(scope).into_iter().map(|entry| picture(scope, entry, &lab));
    stages::entries(scope)
        .into_iter()
        .flat_map(|entry| [Quantity::Visibility, Quantity::Horizon].map(|what| (entry.clone(), what)))
        .map(|(entry, quantity)| comparison(scope, &entry, quantity, &lab))
        .chain(pictures)
        .collect()
}

/// A mesh seen by a camera: the ready pass, interpolated frames, and a shadow map beside it.
fn picture(scope: &Scope, entry: Rc<Entry>, lab: &SharedLab) -> Comparison {
    let scenery = Scenery::new(entry, lab, if scope.quick { 128 } else { 320 });
    let method = |way: Way| {
        let shared = Rc::clone(&scenery);
        let render = move |context: &mut Context| shared.picture(context, way);
        Method { name: way.name(), role: way.role(), render: Box::new(render) }
    };
    let ways =
        [Way::None, Way::Flat, PAPER, Way::Exact, OURS, Way::Certified, Way::Marched(64), Way::ShadowMap];
    Comparison {
        scene: scenery.entry.scene.into(),
        setting: "picture".into(),
        kind: Kind::Approximation,
        truth: scenery.truth(),
        methods: ways.map(method).into(),
        metrics: metrics::classes(),
        thresholds: limits::picture(scope, scenery.entry.scene),
        picture: Picture::Table,
        seen: PICTURES_SEEN,
    }
}

const PICTURES_SEEN: &str = "\
    White is lit. Without shadows all is white; the flat horizon map ends the lit side where the smooth surface turns \
    away and lengthens shadows before it; the published method loses the thin shadows close to small bumps, and their \
    edges are torn; ours differs from the truth in single pixels along the shadows' edges; marching in 64 steps loses what is \
    thinner than a step; the shadow map has its texels' stairs, and dark spots where surfaces graze the light.";

fn probes(scope: &Scope, stage: &Stage, quantity: Quantity) -> Probes {
    match quantity {
        Quantity::Visibility => window(scope, stage),
        Quantity::Horizon => horizon_probes(scope, stage),
    }
}

fn comparison(scope: &Scope, entry: &Rc<Entry>, quantity: Quantity, lab: &SharedLab) -> Comparison {
    let ways = match entry.scene {
        _ if scope.quick => Way::few(),
        "sphere-15-cylinders" | "sphere-15-rough" | "saddle-rough" | "sphere-reptile" => {
            Way::all(entry.is_constant)
        }
        _ => Way::main(),
    };
    // Without a method's tables there is no horizon to speak of.
    let has = |way: &Way| quantity == Quantity::Visibility || !matches!(way, Way::None | Way::Certified);
    let (setting, metrics) = match quantity {
        Quantity::Visibility => ("shadows", shadows(PIXELS_PER_TEXEL)),
        Quantity::Horizon => ("horizons", metrics::horizons()),
    };
    Comparison {
        scene: entry.scene.into(),
        setting: setting.into(),
        kind: Kind::Approximation,
        truth: truth(scope, entry, quantity),
        methods: ways.into_iter().filter(has).map(|way| method(scope, way, entry, quantity, lab)).collect(),
        metrics,
        thresholds: limits::table(scope, entry.scene, quantity),
        picture: Picture::Table,
        seen: "",
    }
}

/// The displaced surface traced, kept between runs.
pub(super) fn truth(scope: &Scope, entry: &Rc<Entry>, quantity: Quantity) -> Truth {
    let (scope, entry) = (scope.clone(), Rc::clone(entry));
    Truth {
        key: Some(format!(
            "horizon-shadow {} {} {quantity:?} quick {}",
            stages::TRUTH_VERSION,
            entry.scene,
            scope.quick
        )),
        make: Box::new(move |context: &mut Context| {
            let stage = entry.stage()?;
            let probes = probes(&scope, &stage, quantity);
            let value = |i: usize| {
                let (uv, light) = (probes.uv[i], probes.light_world[i]);
                match quantity {
                    Quantity::Visibility => f32::from(stage.is_lit(uv, light)),
                    Quantity::Horizon => stage.sin_horizon(uv, light) as f32,
                }
            };
            let values = parallel(probes.uv.len(), &context.stop_flag(), value)?;
            let image = image(probes.size, &values)?;
            Ok(TruthImage {
                image,
                variance_of_mean: None,
                mask: None,
                how: "rays in f64 through the displaced surface".into(),
            })
        }),
    }
}

fn method(scope: &Scope, way: Way, entry: &Rc<Entry>, quantity: Quantity, lab: &SharedLab) -> Method {
    let (scope, entry, lab) = (scope.clone(), Rc::clone(entry), Rc::clone(lab));
    let render = move |context: &mut Context| {
        let stage = entry.stage()?;
        let probes = probes(&scope, &stage, quantity);
        image(probes.size, &answers(context, &lab, &stage, way, quantity, &probes)?)
    };
    Method { name: way.name(), role: way.role(), render: Box::new(render) }
}

/// What a method answers to probes of a stage.
pub(super) fn answers(
    context: &Context,
    lab: &SharedLab,
    stage: &Stage,
    way: Way,
    quantity: Quantity,
    probes: &Probes,
) -> Result<Vec<f32>, Failure> {
    with_lab(lab, context, stage, |lab| {
        let pairs = probes.uv.iter().zip(&probes.light_world);
        let queries: Vec<_> = pairs.map(|(&uv, &light)| stage.query(uv, light)).collect();
        let queries = lab.queries(&queries);
        lab.answers(quantity, way, &queries)
    })
}

pub(super) fn image([columns, rows]: [usize; 2], values: &[f32]) -> Result<Image, Failure> {
    Ok(Image::new(columns, rows, values.iter().map(|&value| [value; 3]).collect())?)
}

/// Evaluates `f` for 0..count on all cores; fails where the run was asked to stop.
pub(super) fn parallel<T: Send>(
    count: usize,
    stop: &AtomicBool,
    f: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, Failure> {
    let one = |i: usize| (!stop.load(Ordering::Relaxed)).then(|| f(i));
    let all: Option<Vec<T>> = (0..count).into_par_iter().map(one).collect();
    all.ok_or_else(|| "stopped before the end".into())
}
