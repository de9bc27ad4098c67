//! Figures of `bench` that are no times of frames: lookups, smoothness, and what follows from two
//! times.

use super::{
    accuracy::{self, Bench, SharedLab, with_lab},
    bench::{side, spheres},
    grid::Grid,
    lab::{Lab, Query, Way},
    truth::Truth,
};
use crate::{
    Context, Scope,
    technique::{Fact, Failure, Measurement},
};
use diffuse_envmap::{Horizon, model};
use std::{rc::Rc, time::Instant};

/// All of them.
pub(super) fn measurements(scope: &Scope) -> Vec<Measurement> {
    let lab = SharedLab::default();
    let mut all = Vec::new();
    for entry in accuracy::entries(scope) {
        let interesting = ["studio", "sky", "park", "square"].contains(&entry.scene);
        if !interesting || (scope.quick && entry.scene != "studio") {
            continue;
        }
        let (scene, bench) = (entry.scene, entry.bench);
        let make = |f: fn(&mut Lab, u32) -> Result<Vec<Fact>, Failure>, name: &str, how: &str| {
            let (bench, lab, side) = (Rc::clone(&bench), Rc::clone(&lab), side(scope));
            Measurement {
                name: format!("diffuse-envmap {name}, {scene}"),
                how: how.into(),
                run: Box::new(move |context: &mut Context| {
                    with_lab(&lab, context, bench.map()?, |lab| f(lab, side))
                }),
            }
        };
        all.push(make(lookups, "lookups", "texture lookups of the map and the chain, counted in the shader"));
        all.push(make(break_even, "break-even", BREAK_EVEN));
        all.push(smoothness(scene, &bench, &lab));
    }
    all
}

const BREAK_EVEN: &str = "medians of five, in turns, of building what a method precomputes and of lighting the \
     screen of spheres: for how many frames a map has to stand until the prefiltered cube costs less in all";

fn fact(name: impl Into<String>, value: f64, unit: &str, note: &str) -> Fact {
    Fact { name: name.into(), value, unit: unit.into(), note: note.into() }
}

/// How many lookups a lobe takes.
fn lookups(lab: &mut Lab, _side: u32) -> Result<Vec<Fact>, Failure> {
    let steps: Vec<f32> = (0..=50).map(|i| i as f32 / 50.0).collect();
    let narrow = [0.004, 0.006, 0.008, 0.012, 0.016];
    let mut facts = Vec::new();
    for way in [Way::Sheen, Way::SheenFull] {
        for (what, roughness) in [("t = 0, 0.02 ... 1", &steps[..]), ("t = 0.004 ... 0.016", &narrow[..])] {
            let counts = lab.lookups(way, &Grid::new(roughness, &[0.0], 400).queries)?;
            let mean = counts.iter().map(|&count| f64::from(count)).sum::<f64>() / counts.len() as f64;
            let most = counts.iter().fold(0.0_f32, |most, &count| most.max(count));
            facts.push(fact(format!("{}: mean over {what}", way.name()), mean, "lookups", ""));
            facts.push(fact(format!("{}: most over {what}", way.name()), f64::from(most), "lookups", ""));
        }
    }
    Ok(facts)
}

/// When a prefiltered cube becomes cheaper than our chain.
fn break_even(lab: &mut Lab, side: u32) -> Result<Vec<Fact>, Failure> {
    let surfaces = lab.surfaces(&spheres(side));
    let ways = [Way::Sheen, Way::Prefiltered(32), Way::Prefiltered(256)];
    let mut times = vec![(Vec::new(), Vec::new()); ways.len()];
    for round in 0..6 {
        for (way, (builds, frames)) in ways.into_iter().zip(&mut times) {
            lab.touch();
            let started = Instant::now();
            lab.build(way)?;
            let built = started.elapsed().as_secs_f64();
            lab.frame(way, &surfaces)?;
            let started = Instant::now();
            lab.frame(way, &surfaces)?;
            // The first round compiles.
            if round > 0 {
                builds.push(1e3 * built);
                frames.push(1e3 * started.elapsed().as_secs_f64());
            }
        }
    }
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let medians: Vec<(f64, f64)> =
        times.iter_mut().map(|(builds, frames)| (median(builds), median(frames))).collect();
    let mut facts = Vec::new();
    let (own_build, own_frame) = medians[0];
    for (way, (build, frame)) in ways.into_iter().zip(medians) {
        facts.push(fact(format!("{}: build", way.name()), build, "ms", ""));
        facts.push(fact(format!("{}: frame", way.name()), frame, "ms", ""));
        if way != Way::Sheen {
            let all = (build + frame) / (own_build + own_frame);
            facts.push(fact(format!("{}: build and one frame, over ours", way.name()), all, "", "a map that changes every frame"));
            let frames = (build - own_build) / (own_frame - frame);
            facts.push(fact(format!("{}: cheaper from", way.name()), frames.max(0.0), "frames of one map", ""));
        }
    }
    Ok(facts)
}

/// How evenly the radiance changes with roughness and direction.
fn smoothness(scene: &'static str, bench: &Rc<Bench>, lab: &SharedLab) -> Measurement {
    let (bench, lab) = (Rc::clone(bench), Rc::clone(lab));
    let run = move |context: &mut Context| {
        let map = bench.map()?;
        let truth = Truth::new(&map.held);
        let mut facts = Vec::new();
        for way in [Way::Sheen, Way::Brute(64), Way::Prefiltered(1024)] {
            let by_roughness = change_by_roughness();
            let found = with_lab(&lab, context, map, |lab| lab.radiance(way, &by_roughness))?;
            let step = largest_step(&found, 961);
            facts.push(fact(format!("{}: largest change for 0.001 of t", way.name()), step, "of the value", ""));
            for t in [0.1, 0.3, 0.6] {
                let turn = slow_turn(t);
                let found = with_lab(&lab, context, map, |lab| lab.radiance(way, &turn))?;
                let exact: Vec<[f64; 3]> = turn
                    .iter()
                    .map(|query| {
                        let axis = model::normalize_or(query.normal.map(f64::from), [0.0, 1.0, 0.0]);
                        truth.radiance(axis, axis, f64::from(t), Horizon::Discard)
                    })
                    .collect();
                facts.push(fact(format!("{}: flicker at t = {t}", way.name()), flicker(&found, &exact), "of the value", ""));
            }
        }
        Ok(facts)
    };
    Measurement {
        name: format!("diffuse-envmap smoothness, {scene}"),
        how: "the largest relative change of a lobe from t to t + 0.001 for t from 0.04, over 20 directions; and under a \
              slow turn of 0.1 degrees a frame, the root mean square of how much more a lobe changes from frame to \
              frame than the integral does, over the root mean square of the integral"
            .into(),
        run: Box::new(run),
    }
}

/// Lobes of t = 0.04 ... 1 in steps of 0.001, for each of twenty directions.
fn change_by_roughness() -> Vec<Query> {
    let directions = Grid::new(&[0.0], &[0.0], 20).queries;
    let along = |query: &Query| {
        let query = *query;
        (0..=960).map(move |i| Query { roughness: 0.04 + i as f32 * 0.001, ..query })
    };
    directions.iter().flat_map(along).collect()
}

/// The largest change between neighbours of a run of values, over their sum.
fn largest_step(values: &[[f32; 3]], run: usize) -> f64 {
    let pairs = values.chunks(run).flat_map(|values| values.windows(2));
    let change = |pair: &[[f32; 3]]| {
        let sum = |value: [f32; 3]| value.into_iter().map(f64::from).sum::<f64>();
        let (before, after) = (sum(pair[0]), sum(pair[1]));
        (after - before).abs() / before.max(after).max(1e-9)
    };
    pairs.map(change).fold(0.0, f64::max)
}

/// A lobe that goes once through ninety degrees in steps of a tenth.
fn slow_turn(t: f32) -> Vec<Query> {
    let query = |i: u32| {
        let angle = (45.0 + 0.1 * f64::from(i)).to_radians();
        let normal = [0.8 * angle.cos(), 0.6, 0.8 * angle.sin()].map(|x| x as f32);
        Query { normal, view: normal.map(|x| -x), roughness: t }
    };
    (0..=300).map(query).collect()
}

fn flicker(found: &[[f32; 3]], exact: &[[f64; 3]]) -> f64 {
    let (mut excess, mut power) = (0.0, 0.0);
    for (found, exact) in found.windows(2).zip(exact.windows(2)) {
        for c in 0..3 {
            let change = f64::from(found[1][c]) - f64::from(found[0][c]);
            excess += (change - (exact[1][c] - exact[0][c])).powi(2);
            power += exact[0][c].powi(2);
        }
    }
    (excess / power.max(1e-30)).sqrt()
}
