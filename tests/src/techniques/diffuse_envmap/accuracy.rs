//! Every method on tables of lobes, against the integral.

use super::{
    grid::{Grid, mean_absolute, relative_mse},
    lab::{Lab, Way},
    limits,
    maps::{self, TestMap},
};
use crate::{
    Context, Scope,
    technique::{
        Comparison, CustomMetric, Failure, Kind, Method, Metric, Picture, Threshold, Truth, TruthImage,
    },
};
use image_error::Image;
use std::{
    cell::{OnceCell, RefCell},
    rc::Rc,
};

/// Roughnesses of the tables.
pub(super) const ROUGHNESS: [f32; 20] = [
    0.0, 0.006, 0.012, 0.02, 0.03, 0.045, 0.06, 0.08, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 0.85, 0.9,
    0.95, 1.0,
];
const QUICK_ROUGHNESS: [f32; 8] = [0.0, 0.02, 0.06, 0.1, 0.2, 0.4, 0.85, 1.0];
/// Incidence in degrees: at the last, lobes dip below the horizon.
const INCIDENCE_DEG: [f64; 3] = [0.0, 60.0, 88.0];

/// The methods of the tables.
pub(super) const WAYS: [Way; 15] = [
    Way::Sheen,
    Way::SheenFull,
    Way::Paper,
    Way::Mirror,
    Way::Brute(1),
    Way::Brute(4),
    Way::Brute(16),
    Way::Brute(64),
    Way::Brute(256),
    Way::Brute(1024),
    Way::Brute(4096),
    Way::Independent(1024),
    Way::Prefiltered(32),
    Way::Prefiltered(1024),
    Way::Harmonics,
];

/// A map that is made on first use, and a laboratory: shared by the closures of a comparison.
pub(super) struct Bench {
    source: Box<dyn Fn() -> Option<TestMap>>,
    map: OnceCell<Option<TestMap>>,
}

impl Bench {
    pub(super) fn new(source: impl Fn() -> Option<TestMap> + 'static) -> Rc<Self> {
        Rc::new(Self { source: Box::new(source), map: OnceCell::new() })
    }

    /// The map; fails where its file is absent.
    pub(super) fn map(&self) -> Result<&TestMap, Failure> {
        let map = self.map.get_or_init(|| (self.source)());
        map.as_ref().ok_or_else(|| "the environment could not be loaded".into())
    }
}

/// The laboratory of a run, made on first use, and the name of the map that it holds.
pub(super) type SharedLab = Rc<RefCell<Option<(Lab, &'static str)>>>;

/// Runs `f` in the laboratory with a map on the GPU.
pub(super) fn with_lab<T>(
    shared: &SharedLab,
    context: &Context,
    map: &TestMap,
    f: impl FnOnce(&mut Lab) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let mut slot = shared.borrow_mut();
    let (lab, held) = match slot.take() {
        Some(made) => slot.insert(made),
        None => slot.insert((Lab::new(context.gpu())?, "")),
    };
    if *held != map.name {
        lab.set_map(map)?;
        *held = map.name;
    }
    f(lab)
}

/// A map of the tables: its name in the reports, and how it is made.
pub(super) struct Entry {
    pub(super) scene: &'static str,
    pub(super) bench: Rc<Bench>,
}

/// The maps that this run judges on.
pub(super) fn entries(scope: &Scope) -> Vec<Entry> {
    let width = if scope.quick { 256 } else { 1024 };
    let entry = |scene, source: Box<dyn Fn() -> Option<TestMap>>| Entry { scene, bench: Bench::new(source) };
    let mut all = vec![
        entry("furnace", Box::new(|| Some(maps::furnace(128)))),
        entry("step-edge", Box::new(move || Some(maps::step(width)))),
        entry("sun-of-one-texel", Box::new(move || Some(maps::sun(width)))),
        entry("studio", Box::new(move || Some(maps::built_in("studio", width)))),
        entry("sky", Box::new(move || Some(maps::built_in("sky", width)))),
    ];
    let names = ["park", "square", "dark-studio", "hotel-room", "film-stage"];
    if !scope.quick {
        for (scene, which) in names.into_iter().zip(maps::REAL) {
            if crate::test_data(which.1).is_some() {
                all.push(entry(scene, Box::new(move || maps::real(which))));
            }
        }
    }
    all
}

/// The tables of this run.
pub(super) fn comparisons(scope: &Scope) -> Vec<Comparison> {
    let shared = SharedLab::default();
    let mut all: Vec<Comparison> = entries(scope).iter().map(|entry| table(scope, entry, &shared)).collect();
    all.extend(entries(scope).iter().map(|entry| mirror(entry, &shared)));
    all
}

pub(super) fn grid(scope: &Scope) -> Grid {
    if scope.quick {
        Grid::new(&QUICK_ROUGHNESS, &[0.0, 88.0], 48)
    } else {
        Grid::new(&ROUGHNESS, &INCIDENCE_DEG, 180)
    }
}

/// The integrals of a table, kept between runs.
pub(super) fn truth(scope: &Scope, entry: &Entry, grid: &Rc<Grid>) -> Truth {
    let (grid, bench) = (Rc::clone(grid), Rc::clone(&entry.bench));
    Truth {
        // The number counts changes of the table, of the maps and of the sum.
        key: Some(format!("diffuse-envmap table 3 {} quick {}", entry.scene, scope.quick)),
        make: Box::new(move |context: &mut Context| grid.truth(context, bench.map()?)),
    }
}

/// An error of some values, given the truth.
type RowError = fn(&[[f32; 3]], &[[f32; 3]]) -> f64;

fn table(scope: &Scope, entry: &Entry, shared: &SharedLab) -> Comparison {
    let grid = Rc::new(grid(scope));
    let methods = WAYS.into_iter().map(|way| method(way, &grid, &entry.bench, shared)).collect();
    let worst = |name, unit, error: RowError| {
        let grid = Rc::clone(&grid);
        let of = move |found: &Image, truth: &TruthImage| {
            let errors = grid.by_roughness(found, &truth.image, error);
            // The map itself decides what a mirror shows; lobes begin above.
            errors.into_iter().filter(|&(t, _)| t > 0.0).map(|(_, error)| error).fold(0.0, f64::max)
        };
        CustomMetric { name, unit, of: Box::new(of) }
    };
    let diffuse = {
        let grid = Rc::clone(&grid);
        let of = move |found: &Image, truth: &TruthImage| {
            let errors = grid.by_roughness(found, &truth.image, mean_absolute);
            errors.into_iter().find(|&(t, _)| t >= 1.0).map_or(0.0, |(_, error)| error)
        };
        CustomMetric { name: DIFFUSE, unit: "of the mean", of: Box::new(of) }
    };
    Comparison {
        scene: entry.scene.into(),
        setting: "roughness x incidence x direction".into(),
        kind: Kind::Approximation,
        truth: truth(scope, entry, &grid),
        methods,
        metrics: vec![
            worst(WORST_RELATIVE_MSE, "", relative_mse),
            worst(WORST_MEAN_ABSOLUTE, "of the mean", mean_absolute),
            diffuse,
        ],
        thresholds: limits::table(scope, entry.scene),
        picture: Picture::Table,
        seen: "",
    }
}

pub(super) const WORST_RELATIVE_MSE: &str = "relMSE of the worst t";
pub(super) const WORST_MEAN_ABSOLUTE: &str = "mean |error| of the worst t";
pub(super) const DIFFUSE: &str = "mean |error| at t = 1";

fn method(way: Way, grid: &Rc<Grid>, bench: &Rc<Bench>, shared: &SharedLab) -> Method {
    let (grid, bench, shared) = (Rc::clone(grid), Rc::clone(bench), Rc::clone(shared));
    let render = move |context: &mut Context| {
        let values = with_lab(&shared, context, bench.map()?, |lab| lab.radiance(way, &grid.queries))?;
        grid.image(values)
    };
    Method { name: way.name(), role: way.role(), render: Box::new(render) }
}

/// At t = 0 every method that claims it has to be the mirror lookup to the last bit: the truth is
/// the lookup on the same adapter.
fn mirror(entry: &Entry, shared: &SharedLab) -> Comparison {
    let grid = Rc::new(Grid::new(&[0.0], &INCIDENCE_DEG, 1000));
    let methods = [Way::Sheen, Way::SheenFull, Way::Paper, Way::Prefiltered(32)];
    let truth = method(Way::Mirror, &grid, &entry.bench, shared);
    let make = move |context: &mut Context| {
        Ok(TruthImage {
            image: (truth.render)(context)?,
            variance_of_mean: None,
            mask: None,
            how: "the map's own lookup in the mirror direction, on the same adapter".into(),
        })
    };
    let reason = "a mirror is the lookup to the last bit: one tap in the same place";
    let exact =
        |method: Way| Threshold { method: method.name(), metric: Metric::MeanAbsolute, at_most: 0.0, reason };
    Comparison {
        scene: entry.scene.into(),
        setting: "t=0".into(),
        kind: Kind::Approximation,
        truth: Truth { key: None, make: Box::new(make) },
        methods: methods.into_iter().map(|way| method(way, &grid, &entry.bench, shared)).collect(),
        metrics: Vec::new(),
        thresholds: vec![exact(Way::Sheen), exact(Way::SheenFull)],
        picture: Picture::Table,
        seen: "",
    }
}
