//! The scenes by name.

use super::{Entry, Stage, TEXEL_M};
use crate::{Scope, technique::Failure, techniques::horizon_shadow::grounds::Ground};
use glam::{DVec2, DVec3};
use scene::{HeightMap, Limits, builtin, load};
use std::rc::Rc;

fn built_in(name: &str) -> Result<(HeightMap, f64), Failure> {
    let map = builtin::height_map(name).ok_or("no such height map")?;
    let texels = builtin::height_map_texels(name).ok_or("no such height map")?;
    Ok((map, f64::from(texels)))
}

/// Metres along a map's side, one texel each.
pub(super) fn size_m(map: &HeightMap) -> DVec2 {
    TEXEL_M * DVec2::new(f64::from(map.width), f64::from(map.height))
}

/// A sphere of a curvature a texel.
fn sphere(map: &HeightMap, kappa: f64) -> Ground {
    Ground::Sphere(TEXEL_M / kappa, size_m(map))
}

/// A built-in map on a ground that is made to fit it.
pub(super) fn on(
    scene: &'static str,
    is_constant: bool,
    map: &'static str,
    ground: impl Fn(&HeightMap) -> Ground + 'static,
    then: fn(Stage) -> Stage,
) -> Rc<Entry> {
    Entry::new(scene, is_constant, move || {
        let (map, texels) = built_in(map)?;
        let ground = ground(&map);
        Ok(then(Stage::new(scene, ground, map, texels, 1.0)))
    })
}

pub(super) fn same(stage: Stage) -> Stage {
    stage
}

/// The paper's Figs. 4 and 5.
pub(in crate::techniques::horizon_shadow) fn cylinders_on_sphere(kappa: f64) -> Rc<Entry> {
    let scene = if kappa > 0.01 { "sphere-15-cylinders" } else { "sphere-5-cylinders" };
    on(scene, true, "cylinders", move |map| sphere(map, kappa), same)
}

/// The paper's Fig. 6.
pub(in crate::techniques::horizon_shadow) fn reptile() -> Rc<Entry> {
    on("sphere-reptile", true, "reptile_skin", |map| sphere(map, 0.006), |stage| stage.with_azimuths(16))
}

/// The paper's Fig. 7.
pub(in crate::techniques::horizon_shadow) fn bezier() -> Rc<Entry> {
    on("bezier-reptile", false, "reptile_skin", |map| patch(size_m(map)), |stage| stage.with_azimuths(16))
}

/// The paper's Figs. 8 and 9.
pub(in crate::techniques::horizon_shadow) fn dunes() -> Rc<Entry> {
    on("dunes-ripples", false, "ripples", |map| wave(size_m(map)), |stage| stage.with_light([14.0, 250.0]))
}

/// Rough ground on a sphere: what the goals are about.
pub(in crate::techniques::horizon_shadow) fn rough_sphere() -> Rc<Entry> {
    on("sphere-15-rough", true, "fbm", |map| sphere(map, 0.015), same)
}

/// One height everywhere, and the same with bumps that nobody sees.
pub(in crate::techniques::horizon_shadow) fn constant() -> Rc<Entry> {
    Entry::new("constant", true, || Ok(flat(0.0)))
}

pub(in crate::techniques::horizon_shadow) fn faint() -> Rc<Entry> {
    Entry::new("faint", true, || Ok(flat(1e-6)))
}

fn flat(bump: f32) -> Stage {
    let heights = (0..128 * 128).map(|i| 0.5 + bump * f32::from(i as u8 % 3)).collect();
    let map = HeightMap { name: "flat".into(), width: 128, height: 128, heights };
    let ground = sphere(&map, 0.005);
    Stage::new("flat", ground, map, 4.0, 1.0)
}

/// A bent patch as of the paper's Fig. 7.
fn patch(size: DVec2) -> Ground {
    const RISE: [[f64; 4]; 4] =
        [[0.0, 0.16, 0.1, -0.1], [0.1, 0.42, 0.34, 0.0], [0.06, 0.36, 0.3, -0.06], [-0.12, 0.1, 0.06, -0.2]];
    rising(size, RISE)
}

/// Two dunes.
fn wave(size: DVec2) -> Ground {
    const RISE: [[f64; 4]; 4] =
        [[0.0, 0.1, -0.04, 0.06], [0.5, 0.4, 0.56, 0.44], [-0.36, -0.3, -0.44, -0.3], [0.16, 0.2, 0.1, 0.22]];
    rising(size, RISE)
}

/// A patch over a rectangle, its control points raised by so much of its width.
fn rising(size: DVec2, rise: [[f64; 4]; 4]) -> Ground {
    let place = |index: usize| index as f64 / 3.0 - 0.5;
    Ground::Bezier(Box::new(std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            DVec3::new(size.x * place(column), size.x * rise[row][column], size.y * place(row))
        })
    })))
}

/// A real map, made smaller by whole factors, with white so many texels (of the smaller map) above
/// black.
fn real(scene: &'static str, file: &'static str, smaller: u32, texels: f64, kappa: f64) -> Option<Rc<Entry>> {
    crate::test_data(file)?;
    Some(Entry::new(scene, true, move || {
        let path = crate::test_data(file).ok_or("test data absent")?;
        let map = shrunk(&load::height_map(&path, &Limits::default())?.0, smaller);
        let range =
            map.heights.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[least, greatest], &height| {
                [least.min(height), greatest.max(height)]
            });
        let map = HeightMap {
            heights: map.heights.iter().map(|height| (height - range[0]) / (range[1] - range[0])).collect(),
            ..map
        };
        let ground = sphere(&map, kappa);
        Ok(Stage::new(scene, ground, map, texels, 1.0))
    }))
}

/// Means of `factor` by `factor` texels.
fn shrunk(map: &HeightMap, factor: u32) -> HeightMap {
    let (width, height) = (map.width / factor, map.height / factor);
    let texel = |i: u32| {
        let (x, y) = (i % width * factor, i / width * factor);
        let inside = |k: u32| map.heights[((y + k / factor) * map.width + x + k % factor) as usize];
        (0..factor * factor).map(inside).sum::<f32>() / (factor * factor) as f32
    };
    HeightMap { name: map.name.clone(), width, height, heights: (0..width * height).map(texel).collect() }
}

/// The scenes that this run judges on.
pub(in crate::techniques::horizon_shadow) fn entries(scope: &Scope) -> Vec<Rc<Entry>> {
    let saddle = |map: &HeightMap| Ground::Saddle(0.008 / TEXEL_M, size_m(map).x);
    let hollow = |map: &HeightMap| Ground::Cylinder(-TEXEL_M / 0.008, size_m(map));
    let round = |map: &HeightMap| Ground::Cylinder(TEXEL_M / 0.015, size_m(map));
    let ring = |map: &HeightMap| {
        let (ring, tube) = (250.0 * TEXEL_M, 100.0 * TEXEL_M);
        Ground::Torus(ring, tube, size_m(map) / DVec2::new(ring + tube, tube))
    };
    let mut all =
        vec![cylinders_on_sphere(0.015), rough_sphere(), on("saddle-rough", false, "fbm", saddle, same)];
    if scope.quick {
        return all;
    }
    all.extend([
        cylinders_on_sphere(0.005),
        on("sphere-5-rough", true, "fbm", |map| sphere(map, 0.005), same),
        on("sphere-15-smooth", true, "fbm_smooth", |map| sphere(map, 0.015), same),
        on("plane-rough", true, "fbm", |map| Ground::Plane(size_m(map)), same),
        on("cylinder-rough", false, "fbm", round, same),
        on("hollow-rough", false, "fbm", hollow, same),
        on("torus-craters", false, "craters", ring, |stage| stage.around(0.5, 0.35)),
        reptile(),
        bezier(),
        dunes(),
    ]);
    all.extend(real("sphere-brick", "height/brick_height_16.png", 4, 2.5, 0.01));
    all.extend(real("sphere-jacksboro", "height/jacksboro_dem_16.png", 1, 10.0, 0.004));
    all.extend(real("sphere-shapes", "height/plain_heightmap_8.png", 2, 12.0, 0.006));
    all
}

/// The scenes whose pictures are timed.
pub(in crate::techniques::horizon_shadow) fn pictured(scope: &Scope) -> Vec<Rc<Entry>> {
    let mut all = vec![rough_sphere()];
    if !scope.quick {
        all.extend([
            reptile(),
            on("saddle-rough", false, "fbm", |map| Ground::Saddle(0.008 / TEXEL_M, size_m(map).x), same),
        ]);
    }
    all
}

/// The scenes whose errors are taken apart.
pub(in crate::techniques::horizon_shadow) fn dissected() -> Vec<Rc<Entry>> {
    vec![rough_sphere(), on("sphere-15-smooth", true, "fbm_smooth", |map| sphere(map, 0.015), same)]
}
