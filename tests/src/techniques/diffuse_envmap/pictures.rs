//! Whole pictures against the path tracer: with the technique's lobe and nothing in the way, which
//! is the technique's own integral; and with GGX and all light transport, which is what a real
//! surface would show.

use super::{grid::parallel, lab::Way, limits, maps, truth::Truth as Integral};
use crate::{
    Context, Scope, Shot, specular_reflectance,
    technique::{Comparison, Failure, Kind, Method, Picture, Role, Truth, TruthImage},
    truths::path_traced,
};
use compositor::Settings;
use diffuse_envmap::{
    Base, Horizon,
    model::{self, Map, Vec3 as Vec3d},
};
use glam::{Mat4, Vec3};
use image_error::Image;
use path_tracer::{Lobe, PixelFilter};
use scene::{Camera, Environment, Instance, Limits, Material, Scene, load, shapes};
use std::{cell::OnceCell, rc::Rc};

/// The methods of the pictures: those that light whole frames.
const WAYS: [Way; 5] = [Way::Sheen, Way::Paper, Way::Brute(1), Way::Brute(16), Way::Brute(1024)];

const SPHERES_SEEN: &str = "\
    Ours beside the truth: faint rings about the reflections of hard lamps, most from t = 0.2 to 0.4. The \
    published method: small lamps break into dots from t = 0.2 on, one for each ray, and from the sun a few \
    pixels are hit and all others get nothing.";

const FAR_FIELD_SEEN: &str = "\
    Ours beside the truth: the lenses are stippled, because the compositor draws what blends as an ordered \
    pattern of pixels where the truth mixes; single pixels sparkle along edges, seams and the strap, where the \
    compositor filters a normal map that the truth reads at a point. A thousandth of the picture's pixels \
    makes five sixths of the relMSE, and without the worst hundredth it is that of the truth's own noise.";

const TRANSPORT_SEEN: &str = "\
    Ours beside the truth: the lenses are bright where the truth shows the dark inside of the goggles; the sun \
    reaches the metal foot and the board behind the hose, the chin and the strap, which lie in shadow; the \
    leather's sheen is stronger where the goggles' shadow falls; edges are not smoothed; the lenses are \
    stippled. Everything is the lack of occlusion and of light between surfaces, except for the last two.";

/// A scene that is made on first use, and from where it is seen.
struct Stage {
    make: Box<dyn Fn() -> Result<(Scene, Camera), Failure>>,
    made: OnceCell<(Scene, Camera)>,
    size: [u32; 2],
}

impl Stage {
    fn new(size: [u32; 2], make: impl Fn() -> Result<(Scene, Camera), Failure> + 'static) -> Rc<Self> {
        Rc::new(Self { make: Box::new(make), made: OnceCell::new(), size })
    }

    fn get(&self) -> Result<&(Scene, Camera), Failure> {
        if let Some(made) = self.made.get() {
            return Ok(made);
        }
        let made = (self.make)()?;
        Ok(self.made.get_or_init(|| made))
    }
}

/// The compositor's settings for a method.
pub(super) fn frame_settings(way: Way) -> Settings {
    Settings { diffuse_envmap: Some(way.settings()), ..Settings::default() }
}

/// A row of metal spheres of t = 0, 0.1 ... 0.8, as in the paper's Fig. 6.
pub(super) fn row_of_spheres(environment: Environment) -> (Scene, Camera) {
    let metal = |step: u32| Material {
        base_color: Vec3::from(METAL).extend(1.0),
        metallic: 1.0,
        roughness: step as f32 / 10.0,
        ..Material::default()
    };
    let ball = |step: usize| Instance {
        name: format!("t = 0.{step}"),
        mesh: 0,
        material: step,
        world_from_local: Mat4::from_translation(Vec3::new(2.1 * (step as f32 - 4.0), 0.0, 0.0)),
    };
    let scene = Scene {
        name: "row of spheres".into(),
        meshes: vec![shapes::sphere(128)],
        materials: (0..9).map(metal).collect(),
        instances: (0..9).map(ball).collect(),
        environment: Some(environment),
        ..Scene::default()
    };
    let camera =
        Camera { eye: Vec3::new(0.0, 1.5, 60.0), target: Vec3::ZERO, up: Vec3::Y, fov_y_rad: 0.0367 };
    (scene, camera)
}

/// A real model in the park with its low sun.
fn helmet() -> Result<(Scene, Camera), Failure> {
    let file = crate::test_data("gltf/FlightHelmet/FlightHelmet.gltf").ok_or("test data absent")?;
    let mut scene = load::load_scene(&file, &Limits::default())?;
    scene.environment = Some(maps::real(maps::REAL[0]).ok_or("test data absent")?.environment);
    let camera = scene.framing_camera(1.0);
    Ok((scene, camera))
}

pub(super) fn comparisons(scope: &Scope) -> Vec<Comparison> {
    let mut all: Vec<Comparison> = ["studio", "sky"].into_iter().map(|map| spheres(map, scope)).collect();
    if !scope.quick && crate::test_data("gltf/FlightHelmet/FlightHelmet.gltf").is_some() {
        let stage = Stage::new([512, 512], helmet);
        all.push(far_field("flight-helmet", &stage, 256));
        all.push(full_transport("flight-helmet", &stage, 256));
    }
    all
}

/// The row of spheres against the quadrature of every pixel's lobe. The path tracer with the
/// technique's lobe is one of the methods: the two truths have to agree within its noise.
fn spheres(map: &'static str, scope: &Scope) -> Comparison {
    let (width, size) = if scope.quick { (256, [288, 32]) } else { (1024, [432, 48]) };
    let stage = Stage::new(size, move || Ok(row_of_spheres(maps::built_in(map, width).environment)));
    let traced = far_field_settings(size, if scope.quick { 64 } else { 256 });
    let mut methods = methods(&stage);
    let tracing = Rc::clone(&stage);
    methods.push(Method {
        name: PATH_TRACER.into(),
        role: Role::Baseline,
        render: Box::new(move |context| {
            let (scene, camera) = tracing.get()?;
            Ok(path_traced(context, scene, camera, &traced)?.image)
        }),
    });
    let integrating = Rc::clone(&stage);
    let make = move |context: &mut Context| {
        let (scene, camera) = integrating.get()?;
        let shot = context.shot(scene, camera, size, &frame_settings(Way::Sheen))?;
        let held = maps::built_in(map, width).held;
        quadrature(context, &shot, &held, camera)
    };
    Comparison {
        scene: format!("spheres-{map}"),
        setting: "t = 0, 0.1 ... 0.8".into(),
        kind: Kind::Approximation,
        truth: Truth {
            key: Some(format!("diffuse-envmap spheres 1 {map} {width} {size:?}")),
            make: Box::new(make),
        },
        methods,
        metrics: Vec::new(),
        thresholds: limits::spheres(map, scope),
        picture: Picture::Radiance { exposure_ev: None },
        seen: SPHERES_SEEN,
    }
}

pub(super) const PATH_TRACER: &str = "path tracer with this lobe";
/// Colour of the spheres.
const METAL: [f32; 3] = [0.95, 0.93, 0.88];

/// The integral of every pixel that shows a sphere, times the reflectance; the map where none is.
fn quadrature(context: &Context, shot: &Shot, held: &Map, camera: &Camera) -> Result<TruthImage, Failure> {
    let truth = Integral::new(held);
    let eye = camera.eye.to_array().map(f64::from);
    let radiance = parallel(shot.pixels.len(), &context.stop_flag(), |i| {
        let pixel = &shot.pixels[i];
        let Some(step) = sphere_met(eye, pixel.view_world).filter(|_| pixel.is_covered) else {
            return held.sample(pixel.view_world);
        };
        let t = f64::from(step as f32 / 10.0);
        let normal = model::normalize_or(pixel.normal_world, [0.0, 1.0, 0.0]);
        let axis = model::base(model::mirror(pixel.view_world, normal), normal, t, Base::Lerp);
        let n_dot_v = -model::dot(normal, pixel.view_world);
        let lobe = truth.radiance(axis, normal, t, Horizon::Discard);
        std::array::from_fn(|c| lobe[c] * specular_reflectance(f64::from(METAL[c]), t, n_dot_v))
    })?;
    let pixels = radiance.iter().map(|value| value.map(|x| x as f32)).collect();
    Ok(TruthImage {
        image: Image::new(shot.size[0] as usize, shot.size[1] as usize, pixels)?,
        variance_of_mean: None,
        mask: Some(shot.mask()),
        how: "quadrature in f64 of every pixel's lobe, times the technique's reflectance".into(),
    })
}

/// Which sphere of the row a ray meets first.
fn sphere_met(eye: Vec3d, direction: Vec3d) -> Option<usize> {
    let met = |step: usize| {
        let to_centre = model::add_scaled([2.1 * (step as f64 - 4.0), 0.0, 0.0], eye, -1.0);
        let along = model::dot(to_centre, direction);
        let squared = model::dot(to_centre, to_centre) - along * along;
        (squared < 1.0).then(|| (along - (1.0 - squared).sqrt(), step))
    };
    (0..9).filter_map(met).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, step)| step)
}

fn far_field_settings(size: [u32; 2], samples: u32) -> path_tracer::Settings {
    path_tracer::Settings {
        lobe: Lobe::DiffusedEnvironment,
        occlusion: false,
        max_bounces: 1,
        pixel_filter: PixelFilter::Point,
        ..path_tracer::Settings::new(size, samples)
    }
}

/// Against the technique's own integral, by an independent program.
fn far_field(scene: &str, stage: &Rc<Stage>, samples: u32) -> Comparison {
    Comparison {
        scene: scene.into(),
        setting: "far field".into(),
        kind: Kind::Approximation,
        truth: truth(stage, far_field_settings(stage.size, samples)),
        methods: methods(stage),
        metrics: Vec::new(),
        thresholds: limits::helmet_far_field(),
        picture: Picture::Radiance { exposure_ev: None },
        seen: FAR_FIELD_SEEN,
    }
}

/// Against everything that the technique leaves out.
fn full_transport(scene: &str, stage: &Rc<Stage>, samples: u32) -> Comparison {
    Comparison {
        scene: scene.into(),
        setting: "full light transport".into(),
        kind: Kind::Model,
        truth: truth(stage, path_tracer::Settings::new(stage.size, samples)),
        methods: methods(stage),
        metrics: Vec::new(),
        thresholds: limits::helmet_model(),
        picture: Picture::Radiance { exposure_ev: None },
        seen: TRANSPORT_SEEN,
    }
}

/// The path tracer's picture; pixels without a surface do not count.
fn truth(stage: &Rc<Stage>, settings: path_tracer::Settings) -> Truth {
    let stage = Rc::clone(stage);
    let make = move |context: &mut Context| {
        let (scene, camera) = stage.get()?;
        let truth = path_traced(context, scene, camera, &settings)?;
        let mask = context.shot(scene, camera, stage.size, &frame_settings(Way::Sheen))?.mask();
        Ok(TruthImage { mask: Some(mask), ..truth })
    };
    Truth { key: None, make: Box::new(make) }
}

fn methods(stage: &Rc<Stage>) -> Vec<Method> {
    let method = |way: Way| {
        let stage = Rc::clone(stage);
        let render = move |context: &mut Context| {
            let (scene, camera) = stage.get()?;
            context.picture(scene, camera, stage.size, &frame_settings(way))
        };
        Method { name: way.name(), role: way.role(), render: Box::new(render) }
    };
    WAYS.into_iter().map(method).collect()
}
