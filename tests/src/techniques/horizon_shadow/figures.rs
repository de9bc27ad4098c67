//! The paper's figures made again: bumps only, the flat horizon map, the published method, ours,
//! and the displaced surface traced, with the pixels on the wrong side marked.

use super::{
    accuracy::SharedLab,
    bench::Scenery,
    metrics::Classes,
    stages::{self, Entry, Stage},
    tables,
    ways::{OURS, PAPER, Way},
};
use crate::{
    Context, Scope,
    technique::{Block, Failure, Figure, Labelled, Shown, TruthImage},
    truths,
};
use image_error::Image;
use std::rc::Rc;

/// All figures.
pub(super) fn figures(scope: &Scope) -> Vec<Figure> {
    let side = if scope.quick { 160 } else { 320 };
    let figure = |name, title, caption, entry: fn() -> Rc<Entry>| Figure {
        name,
        title,
        caption,
        make: Box::new(move |context| beside(context, &entry(), side)),
    };
    let mut all = vec![
        figure("horizon-shadow-4", "Fig. 4: cylinders on a sphere, kappa = 0.015", FIGURE_4, || {
            stages::cylinders_on_sphere(0.015)
        }),
        figure("horizon-shadow-5", "Fig. 5: cylinders on a sphere, kappa = 0.005", FIGURE_5, || {
            stages::cylinders_on_sphere(0.005)
        }),
        figure("horizon-shadow-6", "Fig. 6: reptile skin", FIGURE_6, stages::reptile),
        figure("horizon-shadow-7", "Fig. 7: a Bezier patch", FIGURE_7, stages::bezier),
        figure("horizon-shadow-8", "Figs. 8 and 9: dunes with wind ripples", FIGURE_8, stages::dunes),
    ];
    all.push(Figure {
        name: "horizon-shadow-turn",
        title: "The light goes round: 24 frames",
        caption: TURN,
        make: Box::new(move |context| turntable(context, side / 2)),
    });
    all.extend(tables::figures(scope));
    all
}

const FIGURE_4: &str = "A sphere patch of 128 x 128 texels with 32 azimuths, its normal turning by 0.015 a texel. Bumps alone \
     stay lit where columns stand in the light's way and beyond the terminator. The flat horizon map ends the light \
     too early, because it lifts every horizon by what the sphere bends down. The published method has the right shadows \
     with torn edges; ours differs along the long straight edges, which turn in steps between the azimuths. Columns \
     beyond the terminator catch the light in all but the flat map.";
const FIGURE_5: &str = "The same with 0.005 a texel: the flat map's shadows are too long still. What is left of ours is at the \
     feet and the straight edges of the columns.";
const FIGURE_6: &str = "Scales in rows, 256 x 256 texels with 16 azimuths. Towards the terminator ever fewer crests are lit; the flat \
     map loses the last of them, the published method lights the grooves between them.";
const FIGURE_7: &str = "The same skin on a bent patch, whose curvature differs from place to place and direction to direction: two \
     candidates are stored.";
const FIGURE_8: &str = "Wind ripples on two dunes with a hollow between them, under a low sun: the curvature changes its sign. The \
     published method takes hollow ground for flat; like the flat map it leaves lit strips in the ripples' shadows. Most of \
     them are gone in ours.";
const TURN: &str = "Ours, the light at 24 degrees over the middle of the patch, turned by 15 degrees from frame to frame: between \
     the 16 azimuths of the tables nothing jumps.";

/// The methods of the figures.
const WAYS: [Way; 4] = [Way::None, Way::Flat, PAPER, OURS];

/// Methods and truth side by side, and below them what each has wrong.
fn beside(context: &mut Context, entry: &Rc<Entry>, side: u32) -> Result<Vec<Block>, Failure> {
    let scenery = Scenery::new(Rc::clone(entry), &SharedLab::default(), side);
    let stage = entry.stage()?;
    let truth = truths::get(context, &scenery.truth())?;
    let shading = Shading::new(context, &scenery, &stage, stage.shot([side; 2]).light_world)?;
    let (mut pictures, mut marks) = (Vec::new(), Vec::new());
    for way in WAYS {
        let found = scenery.picture(context, way)?;
        let bytes = scenery.with(context, |lab, _, _| Ok(lab.memory_bytes(way)))?;
        let classes = Classes::of(&found, &truth);
        let memory = if bytes == 0 { String::new() } else { format!(", {:.2} MB", 1e-6 * bytes as f64) };
        pictures.push(shown(format!("{}{memory}", way.name()), side, &shading.picture(&found)));
        let label = format!(
            "{:.2} % wrong: {:.2} % lit (orange), {:.2} % dark (blue)",
            100.0 * classes.misclassified(),
            100.0 * classes.falsely_lit,
            100.0 * classes.falsely_dark
        );
        marks.push(shown(label, side, &marked(&shading.picture(&truth.image), &found, &truth)));
    }
    pictures.push(shown("traced".into(), side, &shading.picture(&truth.image)));
    Ok(vec![Block::Pictures(pictures), Block::Pictures(marks)])
}

/// Twenty-four frames of our method with the light around the surface.
fn turntable(context: &mut Context, side: u32) -> Result<Vec<Block>, Failure> {
    let entry = stages::reptile();
    let scenery = Scenery::new(Rc::clone(&entry), &SharedLab::default(), side);
    let stage = entry.stage()?;
    let mut frames = Vec::new();
    for frame in 0..24 {
        let azimuth = 15.0 * f64::from(frame);
        let light = stage.light_deg(stage.window_center(), 24.0, azimuth).map(|x| x as f32);
        let values = scenery.with(context, |lab, drawing, stage| {
            drawing.set_light(light, 0.0);
            drawing.frame(lab, &stage.relief, OURS)?;
            drawing.visibility()
        })?;
        let found = super::accuracy::image([side as usize; 2], &values)?;
        let shading = Shading::new(context, &scenery, &stage, light)?;
        frames.push(shown(format!("{azimuth} degrees"), side, &shading.picture(&found)));
    }
    Ok(vec![Block::Pictures(frames)])
}

fn shown(label: String, side: u32, pixels: &[[f32; 3]]) -> Labelled {
    let byte = |value: f32| (255.0 * compositor::tone_map::srgb_encoded(value.clamp(0.0, 1.0))).round() as u8;
    let rgb = pixels.iter().flatten().map(|&value| byte(value)).collect();
    Labelled { label, picture: Shown::Display { width: side as usize, height: side as usize, rgb } }
}

/// What the light gives each pixel where nothing is in its way.
struct Shading {
    /// Cosine between the light and the normal of the bumps, 0 where it faces away; `None` where
    /// no surface is.
    cosine: Vec<Option<f32>>,
}

impl Shading {
    fn new(
        context: &Context,
        scenery: &Scenery,
        stage: &Stage,
        light_world: [f32; 3],
    ) -> Result<Self, Failure> {
        let coordinates = scenery.with(context, |_, drawing, stage| drawing.coordinates(&stage.relief))?;
        let light = light_world.map(f64::from);
        let cosine = |texel: &[f32]| {
            let normal = || stage.bump_normal([texel[0], texel[1]].map(f64::from));
            (texel[3] > 0.5)
                .then(|| normal().iter().zip(light).map(|(n, l)| n * l).sum::<f64>().max(0.0) as f32)
        };
        Ok(Self { cosine: coordinates.values.chunks_exact(4).map(cosine).collect() })
    }

    /// Lambert's law with a little light from everywhere.
    fn picture(&self, visibility: &Image) -> Vec<[f32; 3]> {
        const SURFACE: [f32; 3] = [0.78, 0.72, 0.62];
        const AROUND: f32 = 0.06;
        const BEHIND: [f32; 3] = [0.012, 0.014, 0.018];
        let pixel = |(cosine, visibility): (&Option<f32>, &[f32; 3])| match cosine {
            Some(cosine) => SURFACE.map(|albedo| albedo * (AROUND + cosine * visibility[0])),
            None => BEHIND,
        };
        self.cosine.iter().zip(visibility.pixels()).map(pixel).collect()
    }
}

/// The picture in grey, with what is falsely lit in orange and what is falsely dark in blue.
fn marked(picture: &[[f32; 3]], found: &Image, truth: &TruthImage) -> Vec<[f32; 3]> {
    const LIT: [f32; 3] = [0.665, 0.112, 0.0];
    const DARK: [f32; 3] = [0.0, 0.168, 0.445];
    let counts = |index: usize| truth.mask.as_ref().is_none_or(|mask| mask.get(index) == Some(&true));
    let mark = |(index, picture): (usize, &[f32; 3])| {
        let lit = |image: &Image| image.pixels().get(index).is_some_and(|pixel| pixel[0] > 0.5);
        match (lit(found), lit(&truth.image)) {
            (true, false) if counts(index) => LIT,
            (false, true) if counts(index) => DARK,
            _ => [0.5 * picture[1]; 3],
        }
    };
    picture.iter().enumerate().map(mark).collect()
}
