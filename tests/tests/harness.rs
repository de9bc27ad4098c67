//! The harness itself: what it says of techniques that are good, bad, noisy, broken or stopped.

use image_error::Image;
use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
};
use validation::{
    Scope,
    program::{FAILED, INTERRUPTED, PASSED, Program, USAGE, run},
    technique::{
        Axis, Benchmark, Block, Comparison, Exemption, Figure, Frame, Input, Kind, Labelled, Method, Metric,
        Picture, Plot, Role, Running, Series, Shown, SkipPair, StressCase, Subject, Technique, Threshold,
        Tolerance, Truth, TruthImage, WorkDone,
    },
};

/// A technique that registers nothing.
const EMPTY: Technique = Technique {
    name: "test",
    summary: "",
    libraries: &[],
    exemptions: &[],
    comparisons: |_| Vec::new(),
    benchmarks: |_| Vec::new(),
    measurements: |_| Vec::new(),
    stress: |_| Vec::new(),
    hostile_scenes: |_| Vec::new(),
    figures: |_| Vec::new(),
};

/// A folder for the reports of one test, removed with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("sheen-harness-{name}-{}", std::process::id()));
        fs::remove_dir_all(&folder).ok();
        Self(folder)
    }

    fn run(&self, program: Program, technique: Technique, arguments: &[&str]) -> u8 {
        let out = ["--out", self.0.to_str().unwrap()];
        let arguments = arguments.iter().chain(&out).map(Into::into);
        run(program, &[technique], arguments, &Arc::new(AtomicBool::new(false)))
    }

    fn json(&self, file: &str) -> Value {
        serde_json::from_slice(&fs::read(self.0.join(file)).unwrap()).unwrap()
    }

    fn page(&self) -> String {
        fs::read_to_string(self.0.join("index.html")).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).ok();
    }
}

fn grey(value: f32) -> Image {
    let pixel = |index: usize| [value * (1.0 + index as f32 / 256.0); 3];
    Image::new(16, 16, (0..256).map(pixel).collect()).unwrap()
}

fn truth(variance: Option<f32>) -> Truth {
    Truth {
        key: None,
        make: Box::new(move |_| {
            Ok(TruthImage {
                image: grey(1.0),
                variance_of_mean: variance.map(|variance| vec![[variance; 3]; 256]),
                mask: None,
                how: "by hand".into(),
            })
        }),
    }
}

fn method(name: &str, role: Role, value: f32) -> Method {
    Method { name: name.into(), role, render: Box::new(move |_| Ok(grey(value))) }
}

fn limit(at_most: f64) -> Threshold {
    Threshold { method: "ours".into(), metric: Metric::MeanAbsolute, at_most, reason: "a test's" }
}

/// Ours is 1 % too bright, the paper's 10 %.
fn comparison(scene: &str) -> Comparison {
    Comparison {
        scene: scene.into(),
        setting: "t=0.3".into(),
        kind: Kind::Approximation,
        truth: truth(None),
        methods: vec![method("ours", Role::Ours, 1.01), method("paper", Role::Paper, 1.1)],
        metrics: Vec::new(),
        thresholds: vec![limit(0.011)],
        picture: Picture::Radiance { exposure_ev: None },
        seen: "",
    }
}

#[test]
fn a_limit_that_is_kept_ends_with_status_0() {
    let folder = Folder::new("kept");
    let technique = Technique { comparisons: |_| vec![comparison("ramp")], ..EMPTY };
    assert_eq!(folder.run(Program::Compare, technique, &[]), PASSED);
    let report = folder.json("report.json");
    assert_eq!((&report["passed"], &report["interrupted"]), (&true.into(), &false.into()));
    let compared = &report["comparisons"][0];
    assert_eq!(compared["thresholds"][0]["verdict"], "passed");
    let error = |method: usize| compared["methods"][method]["errors"]["mean_absolute"].as_f64().unwrap();
    assert!((error(0) - 0.01).abs() < 1e-6 && (error(1) - 0.1).abs() < 1e-6, "{compared}");
    assert!(
        !report["adapter"].as_str().unwrap().is_empty() && report["date"].as_str().unwrap().ends_with("UTC")
    );
    // Truth, two methods, and a FLIP map of each.
    assert_eq!(folder.page().matches("<img ").count(), 5);
}

#[test]
fn a_limit_that_is_missed_ends_with_status_1() {
    let folder = Folder::new("missed");
    let comparisons = |_: &Scope| vec![Comparison { thresholds: vec![limit(0.009)], ..comparison("ramp") }];
    assert_eq!(folder.run(Program::Compare, Technique { comparisons, ..EMPTY }, &[]), FAILED);
    let report = folder.json("report.json");
    assert_eq!(report["passed"], false);
    assert_eq!(report["comparisons"][0]["thresholds"][0]["verdict"], "missed");
    assert!(folder.page().contains(" is beyond 0.00900 (a test&#39;s)"));
}

#[test]
fn a_truth_that_is_noisier_than_the_limit_proves_nothing() {
    let folder = Folder::new("noisy");
    // Noise of 5 % under a limit of 1.1 %, which the picture itself would keep.
    let comparisons = |_: &Scope| vec![Comparison { truth: truth(Some(0.0025)), ..comparison("ramp") }];
    assert_eq!(folder.run(Program::Compare, Technique { comparisons, ..EMPTY }, &[]), FAILED);
    let judged = &folder.json("report.json")["comparisons"][0]["thresholds"][0];
    assert_eq!(judged["verdict"], "refused");
    assert!(judged["noise"].as_f64().unwrap() > 0.011 && judged["found"].as_f64().unwrap() < 0.011);
    assert!(folder.page().contains("cannot be judged"));
}

#[test]
fn what_breaks_is_named_and_the_rest_is_measured() {
    let folder = Folder::new("broken");
    let comparisons = |_: &Scope| {
        let broken = |name: &str, render| Method { name: name.into(), role: Role::Baseline, render };
        let mut comparison = comparison("ramp");
        comparison.methods.push(broken("panics", Box::new(|_| panic!("no luck"))));
        comparison.methods.push(broken("fails", Box::new(|_| Err("no memory".into()))));
        comparison.methods.push(broken("small", Box::new(|_| Ok(Image::row(vec![[1.0; 3]])?))));
        comparison.methods.push(broken("nan", Box::new(|_| Ok(grey(f32::NAN)))));
        comparison.thresholds.push(Threshold { method: "gone".into(), ..limit(1.0) });
        vec![comparison]
    };
    assert_eq!(folder.run(Program::Compare, Technique { comparisons, ..EMPTY }, &[]), FAILED);
    let report = folder.json("report.json");
    let compared = &report["comparisons"][0];
    assert_eq!(compared["methods"].as_array().unwrap().len(), 2, "{compared}");
    let failures = compared["failures"].to_string();
    for part in
        ["panics: panicked: no luck", "fails: no memory", "small: the image has 1 x 1", "nan: none of"]
    {
        assert!(failures.contains(part), "{failures}");
    }
    assert_eq!(compared["thresholds"][1]["verdict"], "unknown");
}

#[test]
fn a_stopped_run_leaves_what_was_finished() {
    let folder = Folder::new("stopped");
    let comparisons = |_: &Scope| {
        let mut stopping = comparison("second");
        stopping.methods[0].render = Box::new(|context| {
            context.stop_flag().store(true, Ordering::Relaxed);
            Err("stopped".into())
        });
        vec![comparison("first"), stopping, comparison("third")]
    };
    assert_eq!(folder.run(Program::Compare, Technique { comparisons, ..EMPTY }, &[]), INTERRUPTED);
    let report = folder.json("report.json");
    assert_eq!((&report["interrupted"], &report["passed"]), (&true.into(), &false.into()));
    let scenes: Vec<&Value> =
        report["comparisons"].as_array().unwrap().iter().map(|compared| &compared["scene"]).collect();
    assert_eq!(scenes, ["first"]);
    assert_eq!(report["not_run"], serde_json::json!(["test second t=0.3", "test third t=0.3"]));
    assert!(folder.page().contains("This run was stopped") && folder.page().ends_with("</html>\n"));
}

#[test]
fn scenes_and_techniques_are_chosen_by_name() {
    let folder = Folder::new("chosen");
    let technique = Technique { comparisons: |_| vec![comparison("a"), comparison("b")], ..EMPTY };
    assert_eq!(folder.run(Program::Compare, technique, &["--scene", "b", "--technique", "test"]), PASSED);
    let report = folder.json("report.json");
    assert_eq!(report["comparisons"].as_array().unwrap().len(), 1);
    assert_eq!(report["comparisons"][0]["scene"], "b");
    for wrong in [&["--scene", "c"][..], &["--technique", "glitter"], &["--fast"], &["word"]] {
        assert_eq!(folder.run(Program::Compare, technique, wrong), USAGE, "{wrong:?}");
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_an_error() {
    let folder = Folder::new("unwritable");
    fs::create_dir_all(&folder.0).unwrap();
    let file = folder.0.join("file");
    fs::write(&file, "mine").unwrap();
    let technique = Technique { comparisons: |_| vec![comparison("ramp")], ..EMPTY };
    let inside = file.join("inside");
    assert_eq!(folder.run(Program::Compare, technique, &["--quick"]), PASSED);
    let arguments = ["--out", inside.to_str().unwrap()].map(Into::into);
    assert_eq!(run(Program::Compare, &[technique], arguments, &Arc::default()), FAILED);
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
    let mut left: Vec<_> = fs::read_dir(&folder.0).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["file", "index.html", "report.json"]);
}

static LIBRARY: shaders::Module = shaders::Module {
    path: "test/library.wgsl",
    text: "fn test_square(x: f32) -> f32 { return x * x; }\nfn test_root(x: f32) -> f32 { return sqrt(x); }\n",
    dependencies: &[],
};
static LIBRARIES: &[&shaders::Module] = &[&LIBRARY];

fn case(function: &'static str, body: &'static str, model: fn(f64) -> f64) -> StressCase {
    StressCase {
        function,
        library: &LIBRARY,
        inputs: vec![Input::Real { least: 0.0, greatest: 100.0 }],
        body,
        outputs: &["value"],
        model: Box::new(move |x| vec![model(x[0])]),
        tolerance: Tolerance { absolute: 1e-30, relative: 1e-6, slack: None, reason: "a test's" },
        bindings: None,
        samples: None,
    }
}

fn square() -> StressCase {
    case("test_square", "y[0] = test_square(x[0]);", |x| x * x)
}

#[test]
fn functions_that_agree_with_their_models_hold() {
    let folder = Folder::new("functions");
    let stress = |_: &Scope| vec![square(), case("test_root", "y[0] = test_root(x[0]);", f64::sqrt)];
    let technique = Technique { libraries: LIBRARIES, stress, ..EMPTY };
    assert_eq!(folder.run(Program::Stress, technique, &["--quick"]), PASSED);
    let report = folder.json("report.json");
    let row = &report["functions"][0];
    assert_eq!((&row["passed"], &row["outputs"][0]["non_finite"]), (&true.into(), &0.into()));
    assert_eq!(row["random_inputs"], 32768);
    assert!(row["extreme_inputs"].as_u64().unwrap() > 30, "{row}");
    assert!(row["outputs"][0]["compared"].as_u64().unwrap() > 32768 + 30, "{row}");
}

#[test]
fn a_function_that_disagrees_with_its_model_fails() {
    let folder = Folder::new("wrong");
    let stress = |_: &Scope| {
        let off = case("test_root", "y[0] = test_root(x[0]) * 1.00001;", f64::sqrt);
        let infinite = case("test_root [0]", "y[0] = 1.0 / x[0];", |x| if x > 0.0 { 1.0 / x } else { 0.0 });
        vec![square(), off, infinite, case("test_root [broken]", "y[0] = no_such_function();", f64::sqrt)]
    };
    let technique = Technique { libraries: LIBRARIES, stress, ..EMPTY };
    assert_eq!(folder.run(Program::Stress, technique, &["--quick"]), FAILED);
    let functions = folder.json("report.json")["functions"].clone();
    let passed: Vec<&Value> = functions.as_array().unwrap().iter().map(|row| &row["passed"]).collect();
    assert_eq!(passed, [true, false, false, false]);
    assert!(functions[1]["outputs"][0]["beyond"].as_u64().unwrap() > 30000, "{}", functions[1]);
    let worst = functions[2]["outputs"][0]["worst"]["input"][0].as_str().unwrap();
    assert!(worst == "0e0" || worst == "-0e0", "{}", functions[2]);
    assert!(functions[3]["failure"].as_str().unwrap().contains("no_such_function"), "{}", functions[3]);
}

#[test]
fn a_function_without_a_case_fails_unless_there_is_a_reason() {
    let folder = Folder::new("gap");
    let technique = Technique { libraries: LIBRARIES, stress: |_| vec![square()], ..EMPTY };
    assert_eq!(folder.run(Program::Stress, technique, &["--quick"]), FAILED);
    assert_eq!(folder.json("report.json")["gaps"], serde_json::json!(["test: test_root has no stress case"]));
    let exemptions: &[Exemption] = &[Exemption { function: "test_root", reason: "the driver's own" }];
    assert_eq!(folder.run(Program::Stress, Technique { exemptions, ..technique }, &["--quick"]), PASSED);
    assert!(folder.page().contains("the driver&#39;s own"));
}

/// In which order frames ran, and which test is looking.
static ORDER: Mutex<Vec<&str>> = Mutex::new(Vec::new());
static LOOKING: Mutex<()> = Mutex::new(());

fn subject(name: &'static str, role: Role, value: f32) -> Subject {
    Subject {
        method: name.into(),
        role,
        series: None,
        start: Box::new(move |_| {
            Ok(Running {
                prepare: None,
                frame: Box::new(move |_| {
                    ORDER.lock().unwrap().push(name);
                    let work = WorkDone { passes: 2, skipped: vec!["nothing to do".into()] };
                    Ok(Frame { gpu_ms: Some(if role == Role::Ours { 2.0 } else { 6.0 }), work })
                }),
                picture: Some(Box::new(move |_| Ok(grey(value)))),
                memory_bytes: Some(Box::new(|_| Ok(4096))),
                throughput: None,
            })
        }),
    }
}

fn benchmark(skipping: f32) -> Benchmark {
    let skip = SkipPair {
        name: "left out".into(),
        skipping: subject("skipping", Role::Ours, skipping),
        whole: subject("whole", Role::Baseline, 1.0),
        in_prepare: false,
    };
    Benchmark {
        scene: "ramp".into(),
        setting: String::new(),
        size: [16, 16],
        truth: Some(truth(None)),
        subjects: vec![subject("paper", Role::Paper, 1.1), subject("ours", Role::Ours, 1.01)],
        skips: vec![skip],
    }
}

#[test]
fn subjects_take_turns_and_rows_have_ratios() {
    let folder = Folder::new("bench");
    let _alone = LOOKING.lock();
    ORDER.lock().unwrap().clear();
    let technique = Technique { benchmarks: |_| vec![benchmark(1.0)], ..EMPTY };
    assert_eq!(folder.run(Program::Bench, technique, &["--quick"]), PASSED);
    let rows = folder.json("results.json");
    let [paper, ours] = [&rows[0], &rows[1]];
    assert_eq!((&paper["method"], &ours["method"]), (&"paper".into(), &"ours".into()));
    assert_eq!((&paper["adapter_ms"]["median"], &ours["adapter_ms"]["p95"]), (&6.0.into(), &2.0.into()));
    let time = |row: &Value| row["time_ms"]["median"].as_f64().unwrap();
    assert_eq!(paper["ratio"], time(paper) / time(ours));
    assert_eq!(ours["ratio"], 1.0);
    // A software adapter's own clock is not believed.
    let clock = ours["clock"].as_str().unwrap();
    assert_eq!(paper["time_ms"], paper[format!("{clock}_ms")]);
    assert_eq!((&ours["size"], &ours["memory_bytes"]), (&serde_json::json!([16, 16]), &4096.into()));
    assert_eq!(ours["work"], serde_json::json!({ "passes": 2, "skipped": ["nothing to do"] }));
    assert!((paper["error"]["mean_absolute"].as_f64().unwrap() - 0.1).abs() < 1e-6);
    let order = ORDER.lock().unwrap();
    let rounds: Vec<&[&str]> = order.split(|name| *name == "skipping" || *name == "whole").collect();
    assert!(rounds[0].len() >= 8 && rounds[0].len().is_multiple_of(2), "{order:?}");
    for round in rounds[0].chunks(2) {
        assert!(round.contains(&"ours") && round.contains(&"paper"), "{order:?}");
    }
    assert!(folder.page().contains("<svg") && folder.page().contains("left out"));
}

#[test]
fn a_skip_that_changes_the_picture_fails() {
    let folder = Folder::new("skip");
    let _alone = LOOKING.lock();
    let technique = Technique { benchmarks: |_| vec![benchmark(1.05)], ..EMPTY };
    assert_eq!(folder.run(Program::Bench, technique, &["--quick"]), FAILED);
    assert!(folder.page().contains("skip &quot;left out&quot;: the picture changes by"));
}

fn figure(name: &'static str, block: fn() -> Block) -> Figure {
    Figure { name, title: name, caption: "what there is", make: Box::new(move |_| Ok(vec![block()])) }
}

#[test]
fn figures_show_pictures_tables_and_plots() {
    let folder = Folder::new("figures");
    let figures = |_: &Scope| {
        let picture = || {
            let shown = |picture| Labelled { label: "a ramp".into(), picture };
            let radiance = Shown::Radiance { image: grey(1.0), exposure_ev: 0.0 };
            Block::Pictures(vec![
                shown(radiance),
                shown(Shown::Display { width: 2, height: 1, rgb: vec![9; 6] }),
            ])
        };
        let table = || Block::Table { head: vec!["t".into()], rows: vec![vec!["0.3".into()]] };
        let plot = || {
            let points = vec![[1.0, 2.0], [2.0, 1.0]];
            let series = vec![Series { name: "line".into(), points, is_line: true }];
            let axis = |label: &str| Axis { label: label.into(), is_log: true };
            Block::Plot(Plot { title: "fall".into(), x: axis("x"), y: axis("y"), series })
        };
        vec![figure("pictures", picture), figure("table", table), figure("plot", plot)]
    };
    let technique = Technique { figures, ..EMPTY };
    assert_eq!(folder.run(Program::Figures, technique, &[]), PASSED);
    let page = folder.page();
    assert_eq!((page.matches("<img ").count(), page.matches("<svg ").count()), (2, 1));
    assert_eq!(folder.run(Program::Figures, technique, &["--scene", "table"]), PASSED);
    assert!(!folder.page().contains("<img "));
    let broken = Technique { figures: |_| vec![figure("broken", || Block::Plot(Plot::default()))], ..EMPTY };
    assert_eq!(folder.run(Program::Figures, broken, &[]), FAILED);
}

/// How often a truth was made.
static MADE: Mutex<u32> = Mutex::new(0);

#[test]
fn truths_are_kept_by_what_decides_them() {
    let folder = Folder::new("kept-truths");
    let comparisons = |_: &Scope| {
        let key = format!("a test of the harness, process {}", std::process::id());
        let make = truth(Some(1e-8)).make;
        let counted = Truth {
            key: Some(key),
            make: Box::new(move |context| {
                *MADE.lock().unwrap() += 1;
                make(context)
            }),
        };
        vec![Comparison { truth: counted, ..comparison("ramp") }]
    };
    let technique = Technique { comparisons, ..EMPTY };
    for (arguments, made) in [(&[][..], 1), (&[], 1), (&["--fresh"], 2)] {
        assert_eq!(folder.run(Program::Compare, technique, arguments), PASSED);
        assert_eq!(*MADE.lock().unwrap(), made, "{arguments:?}");
    }
    let target = std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../target"), PathBuf::from);
    for entry in fs::read_dir(target.join("references")).unwrap() {
        let path = entry.unwrap().path();
        let ours = format!("a test of the harness, process {}", std::process::id());
        if fs::read(&path).is_ok_and(|bytes| String::from_utf8_lossy(&bytes).contains(&ours)) {
            fs::remove_file(path).unwrap();
        }
    }
}
