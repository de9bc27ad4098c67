//! The paper's figures 5 and 6 made again, and the errors of all methods by roughness.

use super::{
    accuracy::{self, SharedLab, with_lab},
    grid::{Grid, mean_absolute, relative_mse},
    lab::Way,
    maps,
    pictures::frame_settings,
};
use crate::{
    Context, Scope,
    technique::{Axis, Block, Failure, Figure, Labelled, Plot, Series, Shown},
    truths,
};
use glam::{Affine2, Mat4, Quat, Vec2, Vec3};
use scene::{Camera, ColorSpace, Environment, Material, Mesh, Scene, Texture, TextureRef, Wrap, shapes};

/// All figures.
pub(super) fn figures(scope: &Scope) -> Vec<Figure> {
    let (quick, table_scope) = (scope.quick, scope.clone());
    vec![
        Figure {
            name: "diffuse-envmap-5",
            title: "Fig. 5: a checkerboard of roughness on a sphere",
            caption: FIGURE_5,
            make: Box::new(move |context| checkerboard(context, quick)),
        },
        Figure {
            name: "diffuse-envmap-6",
            title: "Fig. 6: t = 0, 0.1 ... 0.8 on one object",
            caption: FIGURE_6,
            make: Box::new(move |context| one_object(context, quick)),
        },
        Figure {
            name: "diffuse-envmap-errors",
            title: "The error of every method by roughness",
            caption: ERRORS,
            make: Box::new(move |context| errors(context, &table_scope)),
        },
    ]
}

const FIGURE_5: &str = "The roughness comes from a texture: a mirror in every other check and t = 0.6 between them. The \
     texture is read without a filter, so that checks end sharply, without a rim of a roughness that none of them has. \
     The sun lights the rough checks towards it up to the rim of their lobes. The paper's 64 rays, alike in each pixel, \
     show the sun once for each ray, as spots; 1,024 rays turned in each pixel hit it now and then, as white dots.";
const FIGURE_6: &str = "A metal teapot whose reflections lose their detail as t grows. With ours the sun's highlight spreads \
     from a point over the whole side; the paper's 64 rays break it into spots as soon as they are further apart than it is \
     wide, and between the spots the teapot has the colour of the sky.";
const ERRORS: &str = "Relative mean squared error against the integral over directions and incidences, one plot for each \
     map, and as numbers with the mean absolute error over the mean radiance in brackets.";

/// The real park, or the built-in sky where the test data is absent.
fn outdoors(quick: bool) -> Environment {
    let real = if quick { None } else { maps::real(maps::REAL[0]) };
    real.unwrap_or_else(|| maps::built_in("sky", 1024)).environment
}

fn picture(
    context: &mut Context,
    label: String,
    scene: &Scene,
    camera: &Camera,
    side: u32,
    way: Way,
    exposure_ev: f32,
) -> Result<Labelled, Failure> {
    let image = context.picture(scene, camera, [side, side], &frame_settings(way))?;
    Ok(Labelled { label, picture: Shown::Radiance { image, exposure_ev } })
}

fn checkerboard(context: &mut Context, quick: bool) -> Result<Vec<Block>, Failure> {
    let texel = |i: u32| [255, if (i % 16 + i / 16).is_multiple_of(2) { 0 } else { 153 }, 255, 255];
    let texture = Texture {
        name: "checkerboard".into(),
        width: 16,
        height: 8,
        rgba: (0..128).flat_map(texel).collect(),
        color_space: ColorSpace::Linear,
    };
    let reference = TextureRef {
        texture: 0,
        texture_from_vertex_uv: Affine2::from_scale(Vec2::ONE),
        wrap: [Wrap::Repeat; 2],
        nearest: true,
    };
    let material =
        Material { metallic: 1.0, metallic_roughness_texture: Some(reference), ..Material::default() };
    let sphere = crate::scene_of(shapes::sphere(128), material, Mat4::IDENTITY, outdoors(quick));
    let scene = Scene { textures: vec![texture], ..sphere };
    let camera = Camera { eye: Vec3::new(1.0, 0.8, 5.0), target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 0.5 };
    let side = if quick { 128 } else { 384 };
    let mut shown = |way: Way| picture(context, way.name(), &scene, &camera, side, way, 0.0);
    let pictures = [Way::Sheen, Way::Paper, Way::Brute(1024)].map(&mut shown);
    Ok(vec![Block::Pictures(pictures.into_iter().collect::<Result<_, _>>()?)])
}

fn one_object(context: &mut Context, quick: bool) -> Result<Vec<Block>, Failure> {
    let side = if quick { 96 } else { 224 };
    let environment = outdoors(quick);
    let mesh: Mesh = shapes::teapot(if quick { 8 } else { 16 });
    let mut blocks = Vec::new();
    for way in [Way::Sheen, Way::Paper] {
        let mut pictures = Vec::new();
        for step in 0..9_u8 {
            let roughness = f32::from(step) / 10.0;
            let material = Material { metallic: 1.0, roughness, double_sided: true, ..Material::default() };
            let turned = Mat4::from_quat(Quat::from_rotation_y(-0.5));
            let scene = crate::scene_of(mesh.clone(), material, turned, environment.clone());
            let framing = scene.framing_camera(1.0);
            let camera = Camera { eye: framing.target + 0.5 * (framing.eye - framing.target), ..framing };
            pictures.push(picture(context, format!("t = 0.{step}"), &scene, &camera, side, way, 0.0)?);
        }
        blocks.push(Block::Text(way.name()));
        blocks.push(Block::Pictures(pictures));
    }
    Ok(blocks)
}

/// The methods that the plots show.
const PLOTTED: [Way; 8] = [
    Way::Sheen,
    Way::SheenFull,
    Way::Paper,
    Way::Brute(1024),
    Way::Independent(1024),
    Way::Prefiltered(1024),
    Way::Harmonics,
    Way::Mirror,
];

fn errors(context: &mut Context, scope: &Scope) -> Result<Vec<Block>, Failure> {
    let grid = std::rc::Rc::new(accuracy::grid(scope));
    let lab = SharedLab::default();
    let mut blocks = Vec::new();
    let mut goals = Vec::new();
    for entry in accuracy::entries(scope) {
        let truth = truths::get(context, &accuracy::truth(scope, &entry, &grid))?;
        let mut plot = Plot {
            title: entry.scene.into(),
            x: Axis { label: "roughness t".into(), is_log: true },
            y: Axis { label: "relMSE".into(), is_log: true },
            series: Vec::new(),
        };
        let mut by_method = Vec::new();
        let mut rows: Vec<Vec<String>> = distinct(&grid).iter().map(|t| vec![format!("{t}")]).collect();
        for way in PLOTTED {
            let map = entry.bench.map()?;
            let values = with_lab(&lab, context, map, |lab| lab.radiance(way, &grid.queries))?;
            let found = grid.image(values)?;
            let squared = grid.by_roughness(&found, &truth.image, relative_mse);
            let absolute = grid.by_roughness(&found, &truth.image, mean_absolute);
            for ((row, (_, squared)), (_, absolute)) in rows.iter_mut().zip(&squared).zip(&absolute) {
                row.push(format!("{squared:.1e} ({:.2} %)", 100.0 * absolute));
            }
            by_method.push(squared.iter().map(|&(_, error)| error).collect::<Vec<f64>>());
            let points = squared.iter().map(|&(t, error)| [f64::from(t), error]).collect();
            plot.series.push(Series { name: way.name(), points, is_line: true });
        }
        let head = ["t".to_owned()].into_iter().chain(PLOTTED.iter().map(|way| way.name())).collect();
        goals.push(goal_row(entry.scene, &by_method));
        blocks.push(Block::Plot(plot));
        blocks.push(Block::Table { head, rows });
    }
    let head = [
        "map",
        "relMSE of the worst t",
        "at most 1e-3",
        "1,024 spiral rays",
        "1,024 independent rays",
        "more accurate than the prefiltered cube at",
    ];
    let table = Block::Table { head: head.map(String::from).to_vec(), rows: goals };
    blocks.insert(0, table);
    Ok(blocks)
}

/// What a map says about the goals: errors by roughness, of the methods of [`PLOTTED`].
fn goal_row(scene: &str, by_method: &[Vec<f64>]) -> Vec<String> {
    // The mirror shows the map itself.
    let of = |way: Way| {
        let place = PLOTTED.iter().position(|&plotted| plotted == way);
        place.and_then(|place| by_method.get(place)).map_or(&[][..], |errors| errors.get(1..).unwrap_or(&[]))
    };
    let worst = |way| of(way).iter().copied().fold(0.0, f64::max);
    let ours = worst(Way::Sheen);
    let against = |way| {
        let other = worst(way);
        format!("{other:.1e}: {}", if ours <= other { "reached" } else { "not reached" })
    };
    let pairs = || of(Way::Sheen).iter().zip(of(Way::Prefiltered(1024)));
    let better = pairs().filter(|(ours, other)| ours <= other).count();
    vec![
        scene.into(),
        format!("{ours:.1e}"),
        if ours <= 1e-3 { "reached".into() } else { "not reached".into() },
        against(Way::Brute(1024)),
        against(Way::Independent(1024)),
        format!("{better} of {} roughnesses", pairs().count()),
    ]
}

/// The roughnesses of a table, each once.
fn distinct(grid: &Grid) -> Vec<f32> {
    let mut all = grid.roughness.clone();
    all.dedup();
    all
}
